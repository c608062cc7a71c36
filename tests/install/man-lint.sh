#!/bin/sh
# The manual pages are correct mdoc. Skipped without mandoc.
set -eu
: "${top_srcdir:?}"
command -v mandoc >/dev/null || { echo 'no mandoc here'; exit 77; }
# Whether pages that are named are installed here is no fault of ours (man.sh looks for our own).
mandoc -T lint "$top_srcdir"/man/*.[1-9] 2>/dev/null |
    grep -vE 'referenced manual not found|outdated mandoc\.db' && exit 1
# A page that lints clean may still be empty of what it should show.
for page in "$top_srcdir"/man/*.[1-9]; do
    [ "$(mandoc -T ascii "$page" | wc -l)" -ge 30 ] || { echo "$page: hardly anything in it"; exit 1; }
done

#!/bin/sh
# Every source is named in a fragment, or the tarball would lack it.
set -eu
: "${top_srcdir:=$(cd "$(dirname "$0")/.." && pwd)}"
cd "$top_srcdir"
status=0
for file in $(find core sdk plugins tests examples -name '*.[ch]' -o -name '*.sh' -o -name '*.py' \
    -o -name '*.json' -o -name '*.csv' -o -name 'README*' | sort); do
    name=$file
    case $file in tests/*.c) name=${file%.c} ;; esac
    cat Makefile.am ./*/fragment.am | grep -qwF -e "$name" || { echo "in no fragment: $file"; status=1; }
done
exit $status

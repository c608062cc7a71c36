#!/bin/sh
# usage: run.sh LOG BENCHMARK...
# Runs programs of the build and scripts of the sources one after the other, in the tests' environment
# (`make bench` sets it); what they print goes to the terminal and into LOG.
set -eu
: "${top_srcdir:?}" "${top_builddir:?}"
log=$1
shift
failed=$log.failed
rm -f "$failed"
{
    date
    for name; do
        echo
        echo "== $name"
        code=0
        case $name in
        *.sh) sh "$top_srcdir/$name" || code=$? ;;
        *.py) "${PYTHON:-python3}" "$top_srcdir/$name" || code=$? ;;
        *) "$top_builddir/$name" || code=$? ;;
        esac
        case $code in
        0) ;;
        77) echo "skipped: $name" ;;
        *)
            echo "FAILED with $code: $name"
            echo "$name" >>"$failed"
            ;;
        esac
    done
} 2>&1 | tee "$log"
[ ! -e "$failed" ] || { rm -f "$failed"; exit 1; }

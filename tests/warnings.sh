#!/bin/sh
# gcc compiles every source without a warning, and clang reads it without one. The flags are those of the build. What
# clang says when it makes code of it, `make check-clang` hears.
# PART_CPPFLAGS and PART_CFLAGS are set by tests/fragment.am.
set -eu
: "${top_srcdir:?}" "${top_builddir:?}"
case ${SPH_SANITIZED:-} in ?*) echo 'instrumented: the plain build does this'; exit 77 ;; esac
cd "$top_builddir"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
status=0
count=0
for compiler in gcc clang; do
    if ! command -v $compiler >/dev/null; then
        echo "no $compiler here: not tried"
        continue
    fi
    count=$((count + 1))
    output="-c -o $scratch/object.o"
    [ $compiler = gcc ] || output=-fsyntax-only
    find "$top_srcdir/core" "$top_srcdir/plugins" "$top_srcdir/tests" -name '*.c' | sort |
        while read -r source; do
            case $source in
            */plugins/*) flags="$PLUGIN_CPPFLAGS -I${source%/*} $PLUGIN_CFLAGS" ;;
            */tests/*) flags="$CORE_CPPFLAGS -I${source%/*} $CORE_CFLAGS $CMOCKA_CFLAGS" ;;
            *) flags="$CORE_CPPFLAGS $CORE_CFLAGS" ;;
            esac
            eval "$compiler $flags -Werror $output $source" >>"$scratch/$compiler" 2>&1 ||
                echo "$compiler: $source" >>"$scratch/failed"
        done
    if [ -s "$scratch/$compiler" ]; then
        cat "$scratch/$compiler"
        status=1
    fi
done
[ ! -s "$scratch/failed" ] || { cat "$scratch/failed"; status=1; }
[ $count -gt 0 ] || exit 77
exit $status

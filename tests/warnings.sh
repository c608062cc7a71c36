#!/bin/sh
# gcc and clang read every source without a warning. The flags are those of the build. What they say when they make code
# of it is an error in the builds of `make check-clang`, `check-without-mpi`, `check-without-opencl` and `distcheck`.
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
    find "$top_srcdir/core" "$top_srcdir/plugins" "$top_srcdir/tests" -name '*.c' | sort |
        while read -r source; do
            case $source in
            */plugins/*) flags="$PLUGIN_CPPFLAGS -I${source%/*} $PLUGIN_CFLAGS" ;;
            */tests/*) flags="$CORE_CPPFLAGS -I${source%/*} $CORE_CFLAGS $CMOCKA_CFLAGS" ;;
            *) flags="$CORE_CPPFLAGS $CORE_CFLAGS" ;;
            esac
            eval "$compiler $flags -Werror -fsyntax-only $source" >>"$scratch/$compiler" 2>&1 ||
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

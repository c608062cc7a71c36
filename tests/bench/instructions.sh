#!/bin/sh
# A build for any x86-64 (CFLAGS=-O2, as distributions do it) retires the same instructions in its sweeps
# as one for this processor (-O2 -march=native), within 5 %: who runs it chooses the instruction set, not
# who compiled it. AVX2 is counted by callgrind over short runs of gsph; AVX-512, which it cannot
# run, by the code of the sweeps and of their loops over pairs. By hand or by `make bench`; builds plugins
# two or three times in a scratch folder, or takes folders with plugins that are built already:
#   instructions.sh [GENERIC NATIVE NATIVE_WITHOUT_AVX512]
set -eu
: "${top_srcdir:=$(cd "$(dirname "$0")/../.." && pwd)}"
: "${SPH:=${top_builddir:-$top_srcdir/build}/sph}"
: "${PYTHON:=python3}" "${CC:=gcc}"
case ${SPH_SANITIZED:-} in ?*) echo 'instrumented: the plain build does this'; exit 77 ;; esac
[ "$(uname -m)" = x86_64 ] || { echo 'not x86-64'; exit 77; }
[ -x "$SPH" ] || { echo "no program $SPH"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
status=0

# build NAME CFLAGS: the plugins of the sources, in $scratch/NAME/plugins/.libs.
build() {
    echo "building the plugins with $2"
    mkdir "$scratch/$1"
    (
        cd "$scratch/$1"
        "$top_srcdir/configure" -q --without-mpi --without-opencl CC="$CC" CFLAGS="$2"
        # The makefile's own list of them.
        printf 'include Makefile\nonly-plugins: $(plugins_LTLIBRARIES)\n' >plugins.mk
        make -s -f plugins.mk only-plugins V=0
    ) >"$scratch/$1.said" 2>&1 || { tail -20 "$scratch/$1.said"; echo "no build with $2"; exit 1; }
}

# What -march=native has of AVX-512, as options that take it away.
no_avx512=$("$CC" -march=native -dM -E -x c /dev/null | sed -n 's/^#define __\(AVX512[^_]*\)__ 1$/-mno-\1/p' |
    tr 'A-Z\n' 'a-z ')
if [ $# -eq 3 ]; then
    generic=$1 native=$2 without=$3
else
    [ -x "$top_srcdir/configure" ] || { echo "no configure in $top_srcdir"; exit 77; }
    [ ! -f "$top_srcdir/config.status" ] || { echo 'configured within the sources: no second build'; exit 77; }
    generic=$scratch/generic/plugins/.libs native=$scratch/native/plugins/.libs without=$native
    build generic '-O2'
    build native '-O2 -march=native'
    if [ -n "$no_avx512" ]; then
        without=$scratch/without/plugins/.libs
        build without "-O2 -march=native $no_avx512"
    fi
fi

# count PLUGINS SCENE OPTION...: instructions of all sweeps for AVX2, and of what they call.
count() {
    rm -rf "$scratch/plugins"
    mkdir "$scratch/plugins"
    # Without debugging information: Debian 12's valgrind cannot read that of its clang.
    for plugin in "$1"/*.so; do
        strip --strip-debug -o "$scratch/plugins/${plugin##*/}" "$plugin"
    done
    scene=$2
    shift 2
    # OMP_WAIT_POLICY: else sph starts itself again, out of callgrind's sight.
    OMP_NUM_THREADS=1 OMP_WAIT_POLICY=passive SPH_PLUGIN_PATH="$scratch/plugins" \
        SPH_DATA_PATH="$top_srcdir/sdk" valgrind --tool=callgrind \
        --callgrind-out-file="$scratch/out" "$SPH" run "$top_srcdir/examples/$scene" --threads 1 \
        --quiet --out "$scratch/run" --set output.picture=false "$@" >"$scratch/said" 2>&1 ||
        { cat "$scratch/said" >&2; return 1; }
    callgrind_annotate --inclusive=yes --threshold=100 --auto=no "$scratch/out" |
        sed -n 's/^ *\([0-9,]*\) .*[^A-Za-z0-9_][A-Za-z0-9_]*_avx2_f[36][24]_[123]_[0-4]\( .*\)\{0,1\}$/\1/p' |
        tr -d , | awk '{ sum += $1 } END { printf "%.0f", sum }'
}

# both WHAT SCENE OPTION...: the two builds beside each other.
both() {
    what=$1
    shift
    a=$(count "$generic" "$@")
    b=$(count "$without" "$@")
    [ "${b:-0}" -gt 1000000 ] || { echo "no sweeps for AVX2 in $what"; exit 1; }
    awk -v what="$what" -v a="$a" -v b="$b" 'BEGIN {
        d = 100 * (a - b) / b
        miss = d > 5 || d < -5
        printf "%-34s %12.0f generic %12.0f native %+7.2f %%%s\n", what, a, b, d, miss ? "  MISS" : ""
        exit miss
    }' || status=1
}

if command -v valgrind >/dev/null; then
    echo 'instructions executed in the sweeps, AVX2; the bar is 5 %'
    both 'Noh in 2D, 1600 particles' noh.json --set particles.fluid.fill.spacing=0.05 --set time.end=0.002
    both 'Noh in 3D, 1000 particles' noh-3d.json --set particles.fluid.fill.spacing=0.2 --set time.end=0.002
else
    echo 'no valgrind here: what is executed was not counted'
fi
if [ -n "$no_avx512" ]; then
    echo 'instructions of the code, AVX-512: generic, native; the bar is 5 % for the loops over pairs'
    "$PYTHON" "$top_srcdir/tests/bench/sweep_code.py" "$generic" "$native" avx512 || status=1
fi
exit $status

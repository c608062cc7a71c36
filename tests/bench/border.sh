#!/bin/sh
# The cost of the border: instructions that a plugin's pass retires, called chunk by chunk through
# the ABI, are within 2 % of those of the same loop compiled into a program. Timings are printed.
set -eu
: "${top_builddir:?}"
case ${SPH_SANITIZED:-} in ?*) echo 'instrumented: the plain build does this'; exit 77 ;; esac
plugin=$top_builddir/tests/bench/.libs/border_plugin.so
border=$top_builddir/tests/bench/border
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

"$border" "$plugin"

if ! command -v valgrind >/dev/null; then
    echo 'no valgrind here: instructions were not counted'
    exit 77
fi
# Without debugging information: Debian 12's valgrind cannot read that of its clang.
strip --strip-debug -o "$scratch/border" "$border"
strip --strip-debug -o "$scratch/plugin.so" "$plugin"
# count SIDE CHUNK: instructions retired in measured_SIDE and what it calls.
count() {
    OMP_NUM_THREADS=1 valgrind --tool=callgrind \
        --toggle-collect="measured_$1" --callgrind-out-file="$scratch/out" \
        "$scratch/border" "$scratch/plugin.so" "$2" >"$scratch/said" 2>&1 ||
        { cat "$scratch/said" >&2; return 1; }
    sed -n 's/.*Collected : \([0-9]*\).*/\1/p' "$scratch/said"
}
inside=$(count inside 512)
through=$(count plugin 512)
often=$(count plugin 8)
echo "instructions of a pass: $inside inside, $through through the ABI;"
echo "$often with a call for every group of 8, which the core never does"
[ "${inside:-0}" -gt 1000000 ] || { echo 'that is no pass'; exit 1; }
awk "BEGIN { print 100 * ($through - $inside) / $inside }" |
    xargs printf 'difference: %+.4f %%; the bar is 2 %%\n'
[ "$often" -gt $((through + 504 * 50)) ] || { echo 'the count does not see calls'; exit 1; }
difference=$((through - inside))
[ $((${difference#-} * 50)) -le "$inside" ]

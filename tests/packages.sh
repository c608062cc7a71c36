#!/bin/sh
# The packages that configure names when it misses a library are those that ./bootstrap installs.
set -eu
: "${top_srcdir:=$(cd "$(dirname "$0")/.." && pwd)}"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# The last argument of each probe: SPH_MISSING([what], [package]), SPH_NEED([..], .., [package]). A
# call may go over two lines; several may stand on one.
tr '\n' ' ' <"$top_srcdir/configure.ac" | sed 's/SPH_\(MISSING\|NEED\|NEED_LIB\)(/\n&/g' |
    sed -n 's/^SPH_\(MISSING\|NEED\|NEED_LIB\)(\(\(\[[^]]*\], *\)*\)\[\([a-z0-9.+-]*\)\]).*/\4/p' |
    sort -u >"$scratch/probed"
sh "$top_srcdir/bootstrap" packages >"$scratch/packages"
awk '{ print $2 }' "$scratch/packages" | sort -u >"$scratch/listed"
awk '$1 == "lib" { print $2 }' "$scratch/packages" | sort -u >"$scratch/libraries"

[ "$(wc -l <"$scratch/probed")" -ge 9 ] || { echo 'no probes found in configure.ac'; exit 1; }
status=0
comm -23 "$scratch/probed" "$scratch/listed" >"$scratch/unlisted"
comm -13 "$scratch/probed" "$scratch/libraries" >"$scratch/unprobed"
sort "$scratch/packages" | awk 'seen[$2]++ { print $2 }' >"$scratch/twice"
while read -r name; do echo "configure asks for $name, which bootstrap does not install"; status=1; done <"$scratch/unlisted"
while read -r name; do echo "bootstrap installs the library $name, which configure does not probe"; status=1; done <"$scratch/unprobed"
while read -r name; do echo "bootstrap lists $name twice"; status=1; done <"$scratch/twice"
exit $status

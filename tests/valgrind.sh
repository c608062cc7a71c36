#!/bin/sh
# The program under valgrind: what it tells of itself, and a few steps of a small scene. Part of
# `make check-valgrind`, which sets VALGRIND.
set -eu
: "${SPH:?}" "${VALGRIND:?}" "${top_srcdir:?}"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
scene=$top_srcdir/examples/sod.json
$VALGRIND "$SPH" info
$VALGRIND "$SPH" check "$scene"
$VALGRIND "$SPH" plan "$scene"
$VALGRIND "$SPH" --load gsph.so "$scene" --steps 3 --threads 1 --out "$scratch/out"

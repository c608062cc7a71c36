#!/bin/sh
# Every bit of two plugins is flipped, and 10^5 descriptors of each kind are changed: a few minutes.
set -eu
: "${top_builddir:=$(pwd)}"
SPH_FUZZ_ALL=1 "$top_builddir/tests/unit/test_fuzz_files"
SPH_FUZZ_N=100000 SPH_FUZZ_SEED=2 "$top_builddir/tests/unit/test_fuzz_descriptors"

#!/bin/sh
# usage: variant.sh SOURCE BUILD NAME CONFIGURE-OPTION...
# Configure and build the sources once more, in BUILD/variants/NAME, and run all tests there.
set -eu
source=$1 build=$2 name=$3
shift 3
if [ -f "$source/config.status" ]; then
    echo "the sources were configured in their own folder: \`make distclean' first" >&2
    exit 1
fi
mkdir -p "$build/variants/$name"
cd "$build/variants/$name"
[ -f Makefile ] || "$source/configure" -q "$@"
jobs=$(getconf _NPROCESSORS_ONLN)
make -j "$jobs" --no-print-directory all
make -j "$jobs" --no-print-directory check VERBOSE=1

#!/bin/sh
# Makes the committed charts anew: tests/accuracy/charts/NAME.chart.json -> NAME.csv and the SVGs of NAME beside it.
# `make charts` runs it; with ONLY=sod,noh some of them. On a quiet machine: core-seconds are measured.
set -eu
: "${top_srcdir:=$(cd "$(dirname "$0")/../.." && pwd)}" "${top_builddir:=$top_srcdir/build}"
: "${SPH:=$top_builddir/sph}" "${SPH_PLUGIN_PATH:=$top_builddir/plugins/.libs}"
export SPH_PLUGIN_PATH
charts=$top_srcdir/tests/accuracy/charts
for file in "$charts"/*.chart.json; do
    name=$(basename "$file" .chart.json)
    case ",${ONLY:-$name}," in *",$name,"*) ;; *) continue ;; esac
    out=$top_builddir/tests/accuracy/charts/$name
    "$SPH" chart "$file" --out "$out"
    cp "$out/results.csv" "$charts/$name.csv"
    cp "$out"/*.svg "$charts"
done

#!/usr/bin/env python3
"""The tutorial's plugin, built from an installed tree alone, against the exact solution: erf, and two materials.

The method is of second order where there is one material, of first order where two touch: the interface is between
two particles. Heat: sum of m c T."""
import json
import os
import shutil
import subprocess
import sys
from math import log2

from staged import staged

source, folder = staged()
cwd = os.path.join(folder, "conduction")
shutil.copytree(os.path.join(source, "tests", "sdk", "conduction"), cwd)
os.chmod(cwd, 0o755)  # a source that is packed may be read only
os.environ["SPH_PLUGIN_PATH"] = cwd
missed = 0


def do(*words, **options):
    result = subprocess.run(words, cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)
    if result.returncode != 0:
        sys.exit(f"MISS {' '.join(words)}: exit status {result.returncode}\n{result.stdout}")
    return result.stdout


def run(scene, array, spacing, *options):
    out = os.path.join(folder, "out")
    spacing = f"particles.{array}.fill.spacing={spacing}"
    do("sph", "run", scene, "--out", out, "--quiet", "--set", spacing, *options)
    with open(os.path.join(out, "summary.json")) as file:
        summary = json.load(file)
    with open(os.path.join(out, "log.csv")) as file:
        rows = [line.split(",")[:6] for line in file]
    bar("  heat that was lost, of all", abs(summary["conservation"]["energy_drift"]), 1e-12)
    return summary["errors"][f"{array}.T"], rows


def bar(what, value, high, low=None):
    global missed
    good = value <= high and (low is None or value >= low)
    print(f"{'ok  ' if good else 'MISS'} {what}: {value:.4g} ({'' if low is None else f'{low:g} to '}{high:g})")
    missed += not good


do("make", "CFLAGS=-g -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wstrict-prototypes -Werror")

e = [run("scene.json", "bar", spacing)[0] for spacing in (0.02, 0.01, 0.005)]
for spacing, x, high in zip((0.02, 0.01, 0.005), e, (1.1e-3, 2.7e-4, 6.8e-5)):
    bar(f"1D, spacing {spacing}: l1_rel", x["l1_rel"], high)
bar("1D: order of l1_rel, first halving", log2(e[0]["l1_rel"] / e[1]["l1_rel"]), 2.05, low=1.95)
bar("1D: order of l1_rel, second halving", log2(e[1]["l1_rel"] / e[2]["l1_rel"]), 2.02, low=1.98)
bar("1D: order of linf, second halving", log2(e[1]["linf"] / e[2]["linf"]), 2.05, low=1.95)

one = '{"h": "spacing", "T": "x < 0 ? 1 : 0", "rho": 1}'
same = ["--set", f"particles.bodies.fields={one}", "--set", "compare.0.k_right=1"]
same += ["--set", "compare.0.rho_right=1", "--set", "compare.0.c_right=1"]
e = [run("contact.json", "bodies", spacing, *same)[0]["l1_rel"] for spacing in (0.02, 0.01)]
bar("2D, one material, spacing 0.01: l1_rel", e[1], 2.3e-4)
bar("2D, one material: order of l1_rel", log2(e[0] / e[1]), 2.5, low=1.9)

bar("2D, two materials, spacing 0.01: l1_rel", run("contact.json", "bodies", 0.01)[0]["l1_rel"], 3.6e-4)
line = ["--set", "dimensions=1", "--set", 'domain={"min":[-0.5],"max":[0.5],"sides":{"x":"mirror"}}']
e = [run("contact.json", "bodies", spacing, *line)[0] for spacing in (0.005, 0.0025)]
bar("1D, two materials, spacing 0.0025: l1_rel", e[1]["l1_rel"], 1.4e-4)
bar("1D, two materials: order of linf", log2(e[0]["linf"] / e[1]["linf"]), 1.1, low=0.9)

short = ["contact.json", "bodies", 0.02, "--steps", "20"]
first = run(*short, "--threads", "1", "--audit")[1]
bar("2D: rows of the log that differ between 1 and 3 threads",
    sum(a != b for a, b in zip(first, run(*short, "--threads", "3")[1])) + (len(first) < 20), 0)
sys.exit(1 if missed else 0)

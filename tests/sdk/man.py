#!/usr/bin/env python3
"""sph-plugin(7) is right: its example, built by its own commands from an installed tree, does what it says, and the
page names every kind, extension, error, type, access and list macro of the headers, and every member
of a batch."""
import glob
import json
import os
import re
import subprocess
import sys
from math import exp

from staged import staged

source, folder = staged()
page = open(os.path.join(source, "man", "sph-plugin.7"), encoding="utf-8").read().replace("\\e", "\\")
literal = re.findall(r"^\.Bd -literal.*?\n(.*?)^\.Ed", page, re.M | re.S)
missed = 0


def miss(sentence):
    global missed
    missed += 1
    print(f"MISS {sentence}")


# -- Names

headers = {os.path.basename(f): open(f).read() for f in glob.glob(os.path.join(source, "sdk", "sph", "*.h"))}
text = "".join(body for name, body in headers.items() if name != "pair-device.h")
names = set(re.findall(r"#define (SPH_(?:KIND|EXT|DST|SRC)_\w+|SPH_WORK|SPH_E_\w+)", text))
names |= set(re.findall(r"#define (SPH_(?:SCALAR|VECTOR|SYM|MATRIX|INT32|INT64|F32|F64|LANES|HAS|PLUGIN))\b", text))
public = "".join(body for name, body in headers.items()
                 if not name.startswith(("pair-", "point-")))
names |= set(re.findall(r"#define (SPH_\w+)\([^)]*\) *\\?\n *\{", public)) - {"SPH_LIST"}
names |= set(re.findall(r"\b(sph_\w+)\(", headers["lanes.h"].split("*/")[0]))
batch = re.search(r"typedef struct sph_batch \{(.*?)\} sph_batch;", headers["batch.h"], re.S).group(1)
batch = re.sub(r"/\*.*?\*/", "", batch, flags=re.S)
names |= set(re.findall(r"(\w+)\s*[,;]", batch))
names -= {"size", "reserved", "n_dst", "n_src", "n_columns", "n_params"}
if len(names) < 60:
    miss(f"the headers have only {len(names)} names: this test does not read them any more")
for name in sorted(names):
    if not re.search(rf"(?<!\w){name}(?!\w)", page):
        miss(f"sph-plugin.7 does not name {name}")
for name in re.findall(r"\.Dv (SPH_\w+)", page):
    if not re.search(rf"#(?:define|ifndef|ifdef|if.*defined\() ?{name}\b", text) and f"defined({name})" not in text:
        miss(f"sph-plugin.7 names {name}, which no header knows")

# -- The example

code = next(block for block in literal if "SPH_PLUGIN(" in block)
by_hand = next(block for block in literal if "pkg-config --cflags" in block)
scheme = json.loads("{" + next(block for block in literal if '"edit"' in block).strip() + "}")
with open(os.path.join(folder, "cooling.c"), "w") as file:
    file.write(code)
scene = {
    "dimensions": 1,
    "domain": {"min": [0], "max": [1], "sides": {"x": "periodic"}},
    "materials": {"gas": {"eos": {"name": "ideal-gas", "gamma": 1.4}}},
    "particles": {"fluid": {"material": "gas", "fill": {"lattice": "square", "spacing": 0.05},
                            "fields": {"rho": 1, "u": 1, "v": [0]}}},
    "time": {"end": 0.5},
    "probes": [{"name": "u", "array": "fluid", "mean": "u"}],
    **scheme,
}
with open(os.path.join(folder, "scene.json"), "w") as file:
    json.dump(scene, file)
commands = [
    by_hand.replace("conduction", "cooling"),
    "SPH_PLUGIN_PATH=. sph run scene.json --out out --quiet",
    "sph-plugin-check ./cooling.so",
]
for command in commands:
    result = subprocess.run(
        ["sh", "-euc", command],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
    )
    if result.returncode != 0:
        sys.exit(f"MISS {command}\n{result.stdout}")
with open(os.path.join(folder, "out", "summary.json")) as file:
    value = json.load(file)["probes"]["u"]["value"]
exact = exp(-0.5 / 2)
print(f"the example cools to {value:.7g}, exact {exact:.7g}; {len(names)} names of the headers")
if abs(value / exact - 1) > 1e-5:
    miss("the example does not cool as it should")
sys.exit(1 if missed else 0)

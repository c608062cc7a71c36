#!/usr/bin/env python3
"""Functions that a scene brings as texts, in an installed tree: they run on an OpenCL device as they are; made into
a plugin by `sph new-plugin --from` they build without a warning, pass sph-plugin-check and give the same numbers
natively, in all precisions. Those numbers are what is known exactly. What goes wrong is told by file and line."""
import filecmp
import json
import os
import shutil
import subprocess
import sys
from math import cos, exp, pi

from staged import staged

source, folder = staged()
examples = os.path.join(os.path.dirname(os.path.dirname(shutil.which("sph"))), "share", "sph", "examples")
cwd = os.path.join(folder, "texts")
shutil.copytree(os.path.join(source, "tests", "sdk", "text-bodies"), cwd)
for name in ("shear.json", "viscosity.body.h", "viscosity-step.body.h"):
    shutil.copy(os.path.join(examples, name), cwd)
for path, _, files in os.walk(cwd):  # a source that is packed may be read only
    os.chmod(path, 0o755)
    for name in files:
        os.chmod(os.path.join(path, name), 0o644)
os.environ["POCL_CACHE_DIR"] = os.path.join(folder, "pocl")
os.mkdir(os.environ["POCL_CACHE_DIR"])
missed = 0


def expect(what, good, detail=""):
    global missed
    if not good:
        missed += 1
        print(f"MISS {what}: {detail}")


def do(*words, where=cwd, **variables):
    done = subprocess.run(words, cwd=where, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          env={**os.environ, **variables})
    return done.returncode, done.stdout


def told(code, *words, status=2, where=cwd, **variables):
    """The command fails so, with this in its sentence."""
    result, said = do(*words, where=where, **variables)
    expect(" ".join(words), result == status and code in said, f"exit status {result}: {said}")


def probes(scene, *options, where=cwd):
    out = os.path.join(folder, "out")
    shutil.rmtree(out, ignore_errors=True)
    code, said = do("sph", scene, "--out", out, "--quiet", *options, where=where, SPH_PLUGIN_PATH=where)
    if code != 0:
        expect(f"{where}: {scene} {options}", False, f"exit status {code}: {said}")
        return {}
    with open(os.path.join(out, "summary.json")) as file:
        return {name: probe["value"] for name, probe in json.load(file)["probes"].items()}


def compare(what, values, exact, tolerance):
    for name, wanted in exact.items():
        far = abs(values.get(name, float("nan")) - wanted)
        expect(f"{what}: {name}", far <= tolerance * abs(wanted), f"{values.get(name)}, not {wanted}")


# -- What is known

# On a lattice the sum of viscosity takes off sin(k y) a constant share of it: sum_j m nu 2 / rho (1/r dW/dr)
# (1 - cos k y), with W = 7 / (4 pi h^2) (1 - q/2)^4 (1 + 2 q), dW/dq = -35 / (4 pi h^2) q (1 - q/2)^3. It comes to the
# exact k^2 nu as the lattice becomes finer.
SPACING, NU, K = 0.02, 0.02, 2 * pi
h = 1.3 * SPACING
share = 0
for i in range(-3, 4):
    for j in range(-3, 4):
        q = SPACING * (i * i + j * j) ** 0.5 / h
        if 0 < q < 2:
            slope = -35 / (4 * pi * h**4) * (1 - q / 2) ** 3
            share -= 2 * NU * SPACING**2 * slope * (1 - cos(K * SPACING * j))
SHEAR = {"largest v": 0.01 * exp(-share)}
print(f"the lattice's viscosity is {share / (NU * K * K):.4f} of the fluid's")
expect("the sum over the lattice", 0.95 < share / (NU * K * K) < 1, share)

# Of 50 particles in a row each has two neighbours to each side, those around x = 0 and 1/2 of another colour; with h of
# 1.3 spacings they lie within 1.54 h. The kernel is 5 / (8 h) (1 - q/2)^3 (1 + 3 q / 2) in one dimension.
def kernel(q):
    return 5 / (8 * h) * (1 - q / 2) ** 3 * (1 + 1.5 * q) if q < 2 else 0


row = [SPACING * i for i in range(-2, 3)]
ALL = {
    "v": (1 - exp(-2 * 0.5)) / 2, "age": 1, "neighbours": 4.75, "fewest": 4.75, "nearest": SPACING,
    "farthest": 2 * SPACING, "largest": (21 * 1 + 29 * 3) / 50, "spread": 2 / 1.3,
    "one": sum(SPACING * kernel(abs(x) / h) for x in row),
    "moment": sum(SPACING * x * x * kernel(abs(x) / h) for x in row),
}
# Steps in time (rk4, kdk), and what a float holds: coordinates in quanta, pairs in floats.
BARS = {"double": 2e-9, "mixed": 2e-6, "single": 2e-6}
SHEAR_BAR = 2e-3  # the liquid is compressible, and moves

# -- On the processor there is nothing to run, but all else is said

for scene in ("shear.json", "all.json"):
    code, said = do("sph", "check", scene, OCL_ICD_VENDORS=folder)
    expect(f"check {scene} without a device", code == 0 and " particles of " in said, said)
code, said = do("sph", "plan", "shear.json")
expect("plan", code == 0 and "viscosity(liquid)" in said and "viscous_dt" in said, said)
told('/scheme/edit/0: function "viscosity" of the scene has only a text: run with --device opencl, or make it a plugin '
     "with sph new-plugin NAME --from shear.json:viscosity", "sph", "shear.json", "--out", "never")
expect("a refused run leaves nothing", not os.path.exists(os.path.join(cwd, "never")))

# -- Plugins

code, said = do("sph", "new-plugin", "by-scene", "--from", "all.json")
expect("new-plugin --from SCENE", code == 0, said)
code, said = do("sph", "new-plugin", "by-function", "--from", "shear.json:viscosity")
expect("new-plugin --from SCENE:FUNCTION", code == 0, said)
code, said = do("sph", "new-plugin", "by-body", "--from", "viscosity.body.h")
expect("new-plugin --from BODY", code == 0, said)
for project, files in (("by-scene", [f"parts/{name}" for name in os.listdir(os.path.join(cwd, "parts"))]),
                       ("by-function", ["viscosity.body.h", "viscosity-step.body.h"])):
    for name in files:
        expect(f"{name} as it was", filecmp.cmp(os.path.join(cwd, name),
                                                os.path.join(cwd, project, os.path.basename(name)), shallow=False))
for name in os.listdir(os.path.join(cwd, "by-function")):
    texts = []
    for project in ("by-function", "by-body"):
        with open(os.path.join(cwd, project, name.replace("by-function", project))) as file:
            texts.append(file.read().replace("by-function", "by-body").replace("by_function", "by_body"))
    expect(f"the same by function and by body: {name}", texts[0] == texts[1])

STRICT = "-O1 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror"
for project in ("by-scene", "by-function"):
    at = os.path.join(cwd, project)
    code, said = do("make", "-s", "check", f"CFLAGS={STRICT}", where=at)
    expect(f"{project}: make check", code == 0 and "PASS: ./test.py" in said and "FAIL" not in said, said)
    print("\n".join(line for line in said.splitlines() if "apart" in line or line.endswith("notes")))
    code, said = do("make", "-s", "distcheck", f"CFLAGS={STRICT}", where=at)
    expect(f"{project}: make distcheck", code == 0, said)
for precision, bar in BARS.items():
    compare(f"all.json, a plugin, {precision}", probes("scene.json", "--precision", precision, where=os.path.join(cwd, "by-scene")),
            ALL, bar)
    compare(f"shear.json, a plugin, {precision}",
            probes("scene.json", "--precision", precision, where=os.path.join(cwd, "by-function")), SHEAR, SHEAR_BAR)

# One of several, the others stay texts: their files go along.
code, said = do("sph", "new-plugin", "of-one", "--from", "all.json:fall", "--build", "autotools")
expect("one of three", code == 0, said)
with open(os.path.join(cwd, "of-one", "scene.json")) as file:
    left = json.load(file)
expect("what is left", [f["name"] for f in left["functions"]] == ["look-around", "moments"]
       and left["functions"][0]["prelude"] == "look.macros.h" and left["plugins"] == ["kernels", "of-one"], left)
code, said = do("sh", "-ec", "autoreconf -fi && ./configure && make -s", where=os.path.join(cwd, "of-one"))
expect("built by autotools", code == 0, said)
code, said = do("sph", "check", "scene.json", where=os.path.join(cwd, "of-one"),
                SPH_PLUGIN_PATH=os.path.join(cwd, "of-one", ".libs"))
expect("the mixture is a scene", code == 0, said)
told('has only a text', "sph", "scene.json", where=os.path.join(cwd, "of-one"),
     SPH_PLUGIN_PATH=os.path.join(cwd, "of-one", ".libs"))

# -- new-plugin is refused

before = sorted(os.listdir(cwd))
told("nowhere.json: cannot be read", "sph", "new-plugin", "x", "--from", "nowhere.json")
told("nowhere.h: No such file", "sph", "new-plugin", "x", "--from", "nowhere.h")
told("parts is no file", "sph", "new-plugin", "x", "--from", "parts")
told('no scene beside parts/fall.body.h', "sph", "new-plugin", "x", "--from", "parts/fall.body.h")
told('brings no function "viscosty" (did you mean "viscosity"?)', "sph", "new-plugin", "x", "--from", "shear.json:viscosty")
told("--from and --kind do not go together", "sph", "new-plugin", "x", "--from", "shear.json", "--kind", "eos")
told('has no "functions"', "sph", "new-plugin", "x", "--from", os.path.join(examples, "sod.json"))
told("by-body is there already", "sph", "new-plugin", "by-body", "--from", "shear.json")
expect("nothing is left of those", sorted(os.listdir(cwd)) == before, os.listdir(cwd))
shutil.copy(os.path.join(cwd, "shear.json"), os.path.join(cwd, "twin.json"))
told("both shear.json and twin.json name viscosity.body.h", "sph", "new-plugin", "x", "--from", "viscosity.body.h")
os.remove(os.path.join(cwd, "twin.json"))

# -- On a device

code, said = do("sph", "info", "--devices")
device = "opencl:0" in said
print(said.splitlines()[0] if said else "no device")
if device:
    for scene, project in (("all.json", "by-scene"), ("shear.json", "by-function")):
        exact, bars = (ALL, BARS) if project == "by-scene" else (SHEAR, dict.fromkeys(BARS, SHEAR_BAR))
        for precision in BARS:
            options = ("--device", "opencl", "--device-only", "--precision", precision)
            text = probes(scene, *options)
            native = probes("scene.json", "--precision", precision, where=os.path.join(cwd, project))
            compiled = probes("scene.json", *options, where=os.path.join(cwd, project))
            compare(f"{scene}, a text on a device, {precision}", text, exact, bars[precision])
            compare(f"{scene}, a text and a plugin natively, {precision}", text, native, 1e-10 if precision == "double" else 1e-5)
            expect(f"{scene}, a text and a plugin on a device, {precision}", text and text == compiled, f"{text} {compiled}")
            print(f"{scene} {precision}: device and native are apart by",
                  max(abs(text[name] / native[name] - 1) for name in native if name in text), "at most")
    for name, wrong, line in (("viscosity.body.h", "pull *", 6), ("viscosity-step.body.h", "h *", 3)):
        path = os.path.join(cwd, name)
        with open(path) as file:
            right = file.read()
        with open(path, "w") as file:
            file.write(right.replace(wrong, "no_such_word *", 1))
        place = f"sph: {name}:{line}: does not compile on "
        told(place, "sph", "check", "shear.json")
        told("no_such_word", "sph", "check", "shear.json")
        told(place, "sph", "shear.json", "--device", "opencl", "--quiet", "--out", "broken")
        with open(path, "w") as file:
            file.write(right)
    told('it is too "old"', "sph", "all.json", "--device", "opencl", "--quiet", "--out", "failed", "--set",
         "particles.dust.fields.age=2000", status=1)
told('the expression of "age" is computed on the processor, but functions of the scene have only a text', "sph", "check",
     "all.json", "--set", 'scheme.edit.3={"operation": "assignment", "of": "age", "expression": "%s1%s"}' % ("(" * 70, ")" * 70))

sys.exit(1 if missed else 0)

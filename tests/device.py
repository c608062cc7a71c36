"""Whole runs on an OpenCL device against the same runs on the processor: what one evaluation gives, to rounding;
whole Sod and Noh, to their errors; several arrays, sides, smoothing lengths; the particles' order; a run that goes
on; and what is said when it cannot be. Norm: root of the sum of squares over all particles and components of a
column, of the difference over the processor's. Every scene has a program of its own to compile: `make check` runs
some, tests/device-long.py (`make check-long`) all."""
import os
import sys

import numpy

from boxes import box
from scenes import Scenes, changed, example

scenes = Scenes()
expect = scenes.expect
LONG = "SPH_DEVICE_LONG" in os.environ
ONLY = sys.argv[1:]  # precisions
# What a short test leaves out, of those below.
REST = {"noh 3D", "drop", "wave", "mirror 3D", "two arrays, summed", "kernel cubic-spline", "kernel quartic-spline",
        "kernel wendland-c2", "kernel wendland-c4", "kernel wendland-c6"}
ON = ("--device", "opencl", "--device-only")

scenes.need_device()


def norm_of_difference(a, b):
    scale = float(numpy.sqrt((b.astype(float) ** 2).sum()))
    off = float(numpy.sqrt(((a.astype(float) - b) ** 2).sum()))
    return off / scale if scale > 0 else off


# What a stiff equation of state makes of a density that hardly changes is worse conditioned than forces are: by
# rho c0^2 / p, some 1e4 in the drop.
STIFF = {"p": 10, "p_rho2": 10}


def compare(what, here, there, bar, columns=None):
    """Every real column of two snapshots in the norm; returns the largest difference."""
    worst, of = 0.0, ""
    for name, b in there.column.items():
        if name in ("array", "id") or (columns and name not in columns):
            continue
        a = here[name]
        expect(f"{what}: NaN in {name}", (numpy.isnan(a) == numpy.isnan(b)).all())
        good = ~numpy.isnan(b)
        found = norm_of_difference(a[good], b[good]) if good.any() else 0.0
        if found > worst:
            worst, of = found, name
        most = bar * STIFF.get(name, 1)
        expect(f"{what}: {name}", found <= most, f"{found:.2e} in the norm, bar {most:.0e}")
    print(f"{what}: {worst:.1e} in the norm ({of}; bar {bar:.0e})")
    return worst


def quiet(scene):
    """Without what takes time and is not looked at here."""
    scene = changed(scene)
    for key in ("compare", "probes", "profiles"):
        scene.pop(key, None)
    scene["output"] = {"picture": False}
    return scene


# -- Scenes ----------------------------------------------------------------------------------------------


def two_arrays(scheme):
    """Left and right halves as arrays of their own, with another spacing each."""
    scene = box(2, 24, scheme, {"x": "periodic", "y": "mirror"})
    left = scene["particles"].pop("fluid")
    right = changed(left)
    left["fill"]["in"] = {"box": {"min": [0, 0], "max": [0.5, 1]}}
    right["fill"]["in"] = {"box": {"min": [0.5, 0], "max": [1, 1]}}
    right["fill"]["spacing"] = 1 / 36
    scene["particles"] = {"left": left, "right": right}
    return scene


# At rest and even, a wave's forces are 0 but for rounding: jitter gives it some.
sod, noh, drop, wave, orbit = (quiet(example(f"{name}.json")) for name in ("sod", "noh", "drop", "wave", "orbit"))
noh["particles"]["fluid"]["fill"]["spacing"] = 0.05
drop["particles"]["drop"]["fill"]["spacing"] = 0.08
wave["particles"]["gas"]["fill"]["jitter"] = 0.2
noh3 = quiet(example("noh-3d.json"))
noh3["particles"]["fluid"]["fill"] = {"lattice": "square", "spacing": 0.16}

CASES = {
    "sod": sod,
    "noh": noh,
    "noh 3D": noh3,
    "drop": drop,
    "wave": wave,
    "orbit": orbit,
    "periodic 3D": box(3, 12, "wcsph", "periodic"),
    "mirror 3D": box(3, 12, "barotropic", "mirror"),
    "periodic and mirror 2D": box(2, 30, "barotropic-continuity", {"x": "periodic", "y": "mirror"}),
    "two arrays": two_arrays("wcsph"),
    "two arrays, summed": two_arrays("barotropic"),
    "exact Riemann solver": changed(sod, scheme={"name": "gsph", "riemann": "exact"}),
    "nearest, body-force": changed(
        box(2, 20, "wcsph", "periodic"),
        scheme={"name": "wcsph", "edit": [{"insert": "body-force", "gy": -1}, {"insert": "nearest"}]},
    ),
}
KERNELS = ("cubic-spline", "quartic-spline", "quintic-spline", "wendland-c2", "wendland-c4", "wendland-c6", "gaussian")
for kernel in KERNELS:
    dim = 1 if kernel == "gaussian" else 2
    CASES[f"kernel {kernel}"] = changed(box(2, 16, "wcsph", "periodic"), kernel=kernel)
for manager in ("boxes", "cells", "radix", "octree"):
    CASES[f"manager {manager}"] = changed(noh, neighbours={"manager": manager})

# -- One step: what the evaluations give -------------------------------------------------------------------

# After one step rates have been evaluated twice, of states that differ by rounding alone.
# "single" is "mixed" there: a device holds what is integrated in doubles.
BARS = {"double": 1e-12, "mixed": 1e-5, "single": 1e-5}
LIKE = {"double": "double", "mixed": "mixed", "single": "mixed"}
for name, scene in CASES.items():
    for precision, bar in BARS.items():
        if (ONLY and precision not in ONLY) or (not LONG and (name in REST or precision == "single")):
            continue
        if precision != "double" and name.startswith(("kernel", "manager")):
            continue
        here = scenes.good(scene, "--precision", precision, "--steps", "1", *ON)
        there = scenes.good(scene, "--precision", LIKE[precision], "--steps", "1")
        compare(f"{name}, {precision}, a step", here.last(), there.last(), bar)

# -- Many steps: lists, sorts, ghosts made anew -------------------------------------------------------------

for name in ("noh", "noh 3D", "drop", "periodic 3D", "mirror 3D", "two arrays"):
    if not LONG and name in REST:
        continue
    options = ("--precision", "double", "--steps", "60")
    here, there = scenes.good(CASES[name], *options, *ON), scenes.good(CASES[name], *options)
    compare(f"{name}, 60 steps", here.last(), there.last(), 1e-8, columns=("x", "v", "rho", "h", "u"))
    a, b = here.summary()["cost"], there.summary()["cost"]
    expect(f"{name}: list builds", abs(a["list_builds"] - b["list_builds"]) <= 2, (a["list_builds"], b["list_builds"]))
    expect(f"{name}: pairs", abs(a["pairs"] / b["pairs"] - 1) < 0.02, (a["pairs"], b["pairs"]))

# -- Neighbours in other places; what a pass writes and reads of others ------------------------------------------

framed = box(2, 30, "wcsph", {})
framed["plugins"].append(os.path.abspath(os.path.join(os.environ["top_builddir"], "tests/opencl/.libs/frames.so")))
framed["particles"]["fluid"]["fields"].update({"X": ["2*x", "y*y"], "q": "sin(7*x)"})
framed["scheme"]["edit"] = [{"insert": name} for name in ("followed", "frozen", "mix")]
framed["scheme"]["edit"].append({"insert": "turn", "at": "finish"})
for precision, bar in (("double", 1e-11), ("mixed", 1e-4)):
    options = ("--precision", precision, "--steps", "40")
    here, there = scenes.good(framed, *options, *ON), scenes.good(framed, *options)
    compare(f"frames, {precision}, 40 steps", here.last(), there.last(), bar, ("X", "followed", "frozen", "q", "dq"))

# -- All integrators ----------------------------------------------------------------------------------------

for integrator in ("euler", "kdk", "dkd", "symplectic", "verlet2", "pec", "pece", "rk2", "ssp-rk3", "rk4"):
    scene = changed(CASES["periodic and mirror 2D"], time={"end": 1, "integrator": integrator})
    options = ("--precision", "double", "--steps", "5")
    here, there = scenes.good(scene, *options, *ON), scenes.good(scene, *options)
    compare(f"{integrator}, 5 steps", here.last(), there.last(), 1e-10)

# -- Whole runs: errors against the exact solutions ------------------------------------------------------------

whole = {"sod": example("sod.json"), "noh": example("noh.json")}
whole["noh"]["particles"]["fluid"]["fill"]["spacing"] = 0.04
for name, scene in whole.items():
    for precision in ("double", "mixed") if LONG else ("double",):
        here = scenes.good(scene, "--precision", precision, *ON).summary()
        there = scenes.good(scene, "--precision", precision).summary()
        for what, norm in there["errors"].items():
            for kind in ("l1", "l2"):
                ratio = here["errors"][what][kind] / norm[kind]
                print(f"{name}, {precision}: {kind} of {what} {here['errors'][what][kind]:.6g}, {ratio:.6f} times the processor's")
                expect(f"{name}, {precision}: {kind} of {what}", abs(ratio - 1) < 0.01, ratio)

# -- A run that goes on -----------------------------------------------------------------------------------------

scene = changed(CASES["two arrays"], output={"picture": False, "checkpoint": {"steps": 20, "keep": 9}})
straight = scenes.good(scene, "--steps", "40", *ON)
first = scenes.good(scene, "--steps", "20", *ON)
again = scenes.command("--resume", first.path("checkpoint_00000020.h5"), "--steps", "40", "--quiet", *ON)
expect("resume", again.returncode == 0, again.stderr)
resumed = first.last()
same = all(numpy.array_equal(resumed[name], data, equal_nan=data.dtype.kind == "f")
           for name, data in straight.last().column.items())
expect("a resumed run is the same to the last bit", same)
refused = scenes.command("--resume", first.path("checkpoint_00000020.h5"), "--steps", "60", "--quiet")
expect("resumed elsewhere", refused.returncode == 2 and "--device opencl" in refused.stderr, refused.stderr)

# -- What cannot be -----------------------------------------------------------------------------------------------

refused = scenes.run(sod, "--device", "opencl:99")
expect("no such device", refused.code != 0 and "99" in refused.stderr, refused.stderr)
refused = scenes.run(sod, "--device", "cuda")
expect("no such word", refused.code == 2 and '"cuda" is neither' in refused.stderr, refused.stderr)

scenes.end()

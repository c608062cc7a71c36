"""Runs on several ranks, each with an OpenCL device, against the same runs on the processor on one rank: to rounding,
whoever holds which particle, whatever the domain's sides are, with several arrays and with neighbours looked for in
other places; which device a rank takes; programs built once for all ranks; one device that fails ends all, with its
own sentence. `make check-long' (tests/mpi/device-long.py) has it all. Norm: root of the sum of squares over all
particles and components of a column, of the difference over the processor's."""
import glob
import json
import os
import sys
import tempfile

import numpy

from launch import Job, Scenes, Snapshot, changed, example, need, wrapper
from boxes import box
from scenes import SPH

BUILD = os.path.abspath(os.environ["top_builddir"])
LONG = "SPH_DEVICE_LONG" in os.environ
ON = ("--device", "opencl", "--device-only")
BARS = {"double": 1e-11, "mixed": 1e-4}
# What a stiff equation of state, or a weak force, makes of rounding (tests/device.py).
STIFF = {"p": 10, "p_rho2": 10, "drho": 10, "a": 10, "du": 10}

need()
scenes = Scenes()
expect = scenes.expect
scenes.need_device()
ONLY = sys.argv[1:]  # names of parts


def part(name):
    return not ONLY or name in ONLY


def quiet(scene):
    scene = changed(scene)
    for key in ("compare", "probes", "profiles"):
        scene.pop(key, None)
    scene["output"] = {"picture": False}
    return scene


class Ranks:
    """A run on several of them."""

    count = 0

    def __init__(self, scene, ranks, *options, before=(), env=None):
        Ranks.count += 1
        self.out = os.path.join(scenes.scratch.name, f"ranks{Ranks.count}")
        path = scenes.write(scene, f"ranks{Ranks.count}.json")
        self.job = Job(ranks, *before, SPH, path, "--out", self.out, "--threads", "1", "--quiet", *options, env=env).end()

    def good(self, what):
        if self.job.returncode != 0:
            print(f"MISS {what}: exit code {self.job.returncode}, {self.job.stderr}")
            sys.exit(1)
        return self

    def last(self):
        return Snapshot(sorted(glob.glob(os.path.join(self.out, "snapshot_*")))[-1])

    def summary(self):
        with open(os.path.join(self.out, "summary.json")) as file:
            return json.load(file)


def compare(what, here, there, bar):
    worst, of = 0.0, ""
    if len(here["id"]) != len(there["id"]):
        expect(f"{what}: particles", False, (len(here["id"]), len(there["id"])))
        return
    for name, b in there.column.items():
        a = here[name]
        if name in ("array", "id"):
            expect(f"{what}: {name}", (a == b).all())
            continue
        expect(f"{what}: NaN in {name}", (numpy.isnan(a) == numpy.isnan(b)).all())
        good = ~numpy.isnan(b)
        a, b = a[good].astype(float), b[good].astype(float)
        scale = float(numpy.sqrt((b**2).sum()))
        found = float(numpy.sqrt(((a - b) ** 2).sum())) / (scale or 1.0)
        worst, of = max((worst, of), (found, name))
        most = bar * STIFF.get(name, 1)
        expect(f"{what}: {name}", found <= most, f"{found:.2e} in the norm, bar {most:.0e}")
    print(f"{what}: {worst:.1e} in the norm ({of}; bar {bar:.0e})")


# -- Scenes ----------------------------------------------------------------------------------------------------

noh, drop = quiet(example("noh.json")), quiet(example("drop.json"))
noh["particles"]["fluid"]["fill"].update({"spacing": 0.05, "jitter": 0.2})  # else halves never come to differ
drop["particles"]["drop"]["fill"]["spacing"] = 0.08

halves = box(2, 24, "wcsph", {"x": "periodic", "y": "mirror"})
left = halves["particles"].pop("fluid")
right = changed(left)
left["fill"]["in"] = {"box": {"min": [0, 0], "max": [0.5, 1]}}
right["fill"].update({"in": {"box": {"min": [0.5, 0], "max": [1, 1]}}, "spacing": 1 / 36})
halves["particles"] = {"left": left, "right": right}

framed = box(2, 30, "wcsph", {})
framed["plugins"].append(os.path.join(BUILD, "tests/opencl/.libs/frames.so"))
framed["particles"]["fluid"]["fields"].update({"X": ["2*x", "y*y"], "q": "sin(7*x)"})
framed["scheme"]["edit"] = [{"insert": name} for name in ("followed", "frozen", "mix")]
framed["scheme"]["edit"].append({"insert": "turn", "at": "finish"})

# More ranks than some arrays have particles; one has none for a while.
lone = quiet(example("orbit.json"))

# name: scene, ranks, steps, precisions; mixed on one number of ranks where time is short
CASES = {
    "noh": (noh, (2, 3), 60, ("double",)),
    "drop": (drop, (2, 3), 60, ("double",)),
    "periodic 3D": (box(3, 12, "wcsph", "periodic"), (2, 3), 40, ("double",)),
    "two arrays, periodic and mirror": (halves, (2, 3), 30, ("double", "mixed")),
    "frames": (framed, (3,), 40, ("double",)),
    "a lone particle": (lone, (3,), 20, ("double",)),
}
for name, (scene, ranks, steps, precisions) in CASES.items():
    # The domain is cut anew whenever particles are sorted.
    scene = changed(scene, ranks={"imbalance": 1.0})
    if name not in ("a lone particle", "frames"):  # what moves in a frozen frame needs its skin
        scene["neighbours"] = {"skin": 0.01}
    precisions = ("double", "mixed") if LONG and name != "a lone particle" else precisions
    for precision in precisions if part(name) else ():
        options = ("--precision", precision, "--steps", str(steps))
        there = scenes.good(scene, *options)
        for n in (2, 3, 4, 7) if LONG else ranks if precision == "double" else ranks[:1]:
            here = Ranks(scene, n, *options, *ON).good(name)
            compare(f"{name}, {precision}, {n} ranks", here.last(), there.last(), BARS[precision])
            shares = here.summary()["ranks"]
            expect(f"{name}: the domain is cut anew, and particles move", name in ("a lone particle", "frames") or
                   (shares["cuts"] > 1 and shares["moved"] > 0), (shares["cuts"], shares["moved"]))
            device = here.summary()["device"]
            expect(f"{name}: devices", len(device["of_ranks"]) == n and device["number"] == device["of_ranks"][0], device)
            a, b = here.summary()["cost"]["list_builds"], there.summary()["cost"]["list_builds"]
            expect(f"{name}: list builds", name == "frames" or abs(a - b) <= 3 + 0.1 * b, (a, b))

# -- Which device -----------------------------------------------------------------------------------------------

if part("device"):
    given = Ranks(noh, 2, "--steps", "2", "--device", "opencl:0", "--device-only").good("opencl:0")
    expect("the device given", given.summary()["device"]["of_ranks"] == [0, 0])
    none = Ranks(noh, 2, "--steps", "2", "--device", "opencl:99").job
    expect("no such device", none.returncode == 2 and len(none.said) == 1 and "no OpenCL device 99" in none.said[0], none.stderr)
    strict = Ranks(noh, 2, "--steps", "2", "--strict", *ON).job
    expect("--strict", strict.returncode == 2 and len(strict.said) == 1 and
           "--strict holds for several ranks on the processor only" in strict.said[0], strict.stderr)

# -- Programs are built once ------------------------------------------------------------------------------------

if LONG and part("cold"):
    with tempfile.TemporaryDirectory() as cold:
        os.mkdir(os.path.join(cold, "drivers"))
        env = {"SPH_CACHE_DIR": os.path.join(cold, "programs"), "POCL_CACHE_DIR": os.path.join(cold, "drivers")}
        first = Ranks(lone, 3, "--steps", "2", *ON, env=env).good("cold")
        left = [name for name in os.listdir(env["SPH_CACHE_DIR"]) if not name.endswith(".sphcl")]
        expect("cold: nothing is left behind", not left, left)
        second = Ranks(lone, 3, "--steps", "2", *ON, env=env).good("warm").summary()["device"]
        expect("warm: nothing is built", second["programs_built"] == 0, second["programs_built"])

# -- One fails ---------------------------------------------------------------------------------------------------

if part("fails"):
    faults = os.path.join(BUILD, "tests/opencl/.libs/faults.so")
    for rank, fault, words in ((0, "clEnqueueReadBuffer:60:-36", "fails to read"),
                               (2, "clEnqueueNDRangeKernel:400:-5", "fails to run"),
                               (1, "clCreateBuffer:5:-4", "gives no room")):
        script = wrapper(scenes.scratch.name, f"rank{rank}.sh",
                         f"if [ $rank = {rank} ]; then export LD_PRELOAD={faults} SPH_FAULT={fault}; fi")
        job = Ranks(noh, 3, "--steps", "500", *ON, before=(script,)).job
        said = [line for line in job.said if line.startswith("sph: ")]
        expect(f"rank {rank} fails", job.returncode == 1 and len(said) == 1 and f"rank {rank}: " in said[0]
               and words in said[0], (job.returncode, job.stderr))

scenes.end()

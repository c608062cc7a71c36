"""Checkpoints change nothing, and a run that goes on from any of them is the uninterrupted one to the last bit:
snapshots, rows of the log, numbers of the summary; in all precisions, with ghosts, particles that are sorted and
made, plugins with a state of their own, after a kill. What is no good checkpoint is told in one sentence."""
import glob
import os
import resource
import shutil
import signal
import subprocess
import time

import h5py
import numpy

from scenes import Result, Scenes, Snapshot, changed, example

scenes = Scenes()
expect = scenes.expect
MODULES = os.path.join(os.environ["top_builddir"], "tests", "abi", ".libs")
COSTS = ("particle_updates", "pairs", "list_builds", "sorts", "h_sweeps")
MANY = 1000


# -- What must be the same -----------------------------------------------------------------------

def columns(path):
    with h5py.File(path) as file:
        root = file["VTKHDF"]
        found = {name: data[:].tobytes() for name, data in root["PointData"].items()}
        found["Points"] = root["Points"][:].tobytes()
        found["Time"] = root["FieldData/Time"][:].tobytes()
        found["Step"] = root["FieldData/Step"][:].tobytes()
        return found


def rows(out):
    """Of the log, but for the seconds."""
    with open(os.path.join(out, "log.csv")) as file:
        return [line.rsplit(",", 1)[0] for line in file]


def numbers(result):
    summary = result.summary()
    cost = summary["cost"]
    kept = {key: value for key, value in summary.items() if key not in ("cost", "scene", "picture", "threads", "plan")}
    for one in summary["plan"]["passes"]:
        one.pop("seconds", None)
    return {**kept, "plan": summary["plan"], **{key: cost[key] for key in COSTS}}


def compare(what, whole, other):
    expect(f"{what}: exit status", other.code == 0, other.stderr)
    names = [os.path.basename(path) for path in whole.snapshots()]
    expect(f"{what}: snapshots", names == [os.path.basename(path) for path in other.snapshots()], other.snapshots())
    for name in names:
        a, b = columns(whole.path(name)), columns(other.path(name)) if other.has(name) else {}
        differing = [key for key in a if a[key] != b.get(key)]
        expect(f"{what}: bits of {name}", not differing and a.keys() == b.keys(), differing)
    a, b = rows(whole.out), rows(other.out)
    first = next((k for k, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b)))
    expect(f"{what}: the log", a == b, f"from row {first} on, {len(a)} and {len(b)} rows")
    for name in (os.path.basename(path) for path in glob.glob(whole.path("*.csv")) if not path.endswith("log.csv")):
        with open(whole.path(name)) as one, open(other.path(name)) as two:
            expect(f"{what}: {name}", one.read() == two.read())
    if other.has("summary.json"):
        a, b = numbers(whole), numbers(other)
        expect(f"{what}: the summary", a == b, [(key, a[key], b.get(key)) for key in a if a[key] != b.get(key)])
    else:
        expect(f"{what}: a summary", False)


def checkpoints(out):
    return sorted(glob.glob(os.path.join(out, "checkpoint_*.h5")))


def going_on(out, *words, **more):
    """Of a copy of a folder."""
    scenes.count += 1
    to = os.path.join(scenes.scratch.name, f"out{scenes.count}")
    shutil.copytree(out, to)
    return Result(scenes.command(*(word.replace("@", to) for word in words), "--quiet", **more), to)


def with_checkpoints(scene, steps, keep=MANY):
    return changed(scene, output={**scene.get("output", {}), "checkpoint": {"steps": steps, "keep": keep}})


# -- Runs ----------------------------------------------------------------------------------------

def tried(what, scene, steps, every, *options, sorts=2, least=16, threads=("1", "2")):
    """A run without checkpoints, one with, and one from each of them."""
    begin = time.time()
    options = (*options, "--steps", str(steps))
    whole = scenes.good(scene, *options)
    kept = with_checkpoints(scene, every)
    path = scenes.write(kept, f"scene{scenes.count}.json")
    other = scenes.good(kept, *options, "--threads", threads[-1])
    compare(f"{what}: with checkpoints", whole, other)
    cost = whole.summary()["cost"]
    expect(f"{what}: lists serve several steps", least < cost["list_builds"] < 0.8 * steps, cost["list_builds"])
    expect(f"{what}: is sorted", cost["sorts"] >= sorts, (cost["sorts"], cost["list_builds"]))
    files = checkpoints(other.out)
    expect(f"{what}: checkpoints", [int(file[-11:-3]) for file in files]
           == sorted({*range(every, steps + 1, every), steps}), files)
    for k, file in enumerate(files):
        name = os.path.basename(file)
        result = going_on(other.out, path, "--resume", f"@/{name}", "--threads", threads[k % len(threads)], *options)
        compare(f"{what}: from {name}", whole, result)
        expect(f"{what}: again the same checkpoints", len(checkpoints(result.out)) == len(files))
    print(f"{what}: {len(files)} checkpoints, {cost['list_builds']} lists, {cost['sorts']} sorts,"
          f" {time.time() - begin:.1f} s")
    return whole, other, path, options


def small(name, spacing=None, **top):
    scene = changed(example(name), **top)
    for key in ("compare", "probes"):
        scene.pop(key, None)
    scene["output"] = {"every": top.get("every", 0.05), "log": {"steps": 7}}
    if spacing:
        scene["particles"][next(iter(scene["particles"]))]["fill"]["spacing"] = spacing
    return scene


noh = small("noh.json", 0.1)
noh["compare"], noh["probes"] = example("noh.json")["compare"], example("noh.json")["probes"]
noh["compare"] = [{**noh["compare"][0], "every": 0.04}]
noh["probes"] += [{"name": "along", "array": "fluid", "at": [[0, 0], [0.5, 0.1]], "of": "rho", "steps": 3},
                  {"name": "most", "array": "fluid", "max": "rho", "every": 0.03}]
noh["profiles"] = [{"name": "shells", "array": "fluid", "of": "rho", "along": "r", "bins": 5, "max": 1, "every": 0.05,
                    "reference": {"exact": "noh"}}]
noh["neighbours"] = {"skin": 0.25}
first = tried("noh", noh, 90, 13)

sod = small("sod.json")
sod["neighbours"] = {"skin": 0.2}
tried("sod", sod, 180, 50)

box = changed(noh, domain={**noh["domain"], "sides": {"x": "periodic", "y": "mirror"}})
for word in ("mixed", "single"):
    tried(f"noh in a box, pec, {word}", changed(box, time={"end": 0.6, "integrator": "pec"}), 60, 17,
          "--precision", word)
tried("noh in a box, kdk, mixed", changed(box, time={"end": 0.6, "integrator": "kdk"}), 50, 17, "--precision", "mixed")

for word in ("euler", "dkd", "pece", "rk2", "ssp-rk3", "rk4", "symplectic", "verlet2"):
    tried(f"noh, {word}, mixed", changed(noh, time={"end": 0.6, "integrator": word, "cfl": 0.2}), 52, 23,
          "--precision", "mixed", sorts=1, least=0)

drop = small("drop.json", 0.1)
drop["output"]["every"] = 0.001
drop["neighbours"] = {"skin": 0.05}
tried("drop, mixed", drop, 60, 13, "--precision", "mixed")
tried("drop, double", drop, 60, 29, "--precision", "double")

cube = {
    "title": "Waves in a box",
    "dimensions": 3,
    "plugins": ["kernels", "eos", "wcsph"],
    "domain": {"min": [0, 0, 0], "max": [1, 1, 1], "sides": {"x": "mirror", "y": "periodic", "z": "periodic"}},
    "materials": {"water": {"eos": {"name": "tait", "c0": 10, "rho0": 1}}},
    "particles": {
        "fluid": {
            "material": "water",
            "fill": {"lattice": "square", "spacing": 0.125},
            "fields": {"rho": 1, "v": ["sin(2*3.14159265*y)", "cos(2*3.14159265*z)", "sin(3.14159265*x)"]},
        }
    },
    "neighbours": {"skin": 0.08},
    "scheme": {"name": "wcsph", "alpha": 0.1},
    "time": {"end": 1},
    "output": {"every": 0.05, "log": {"steps": 5}},
}
for word in ("mixed", "single", "double"):
    tried(f"3D, ghosts, {word}", cube, 60, 23, "--precision", word)
tried("3D, no sides, mixed", changed(cube, domain={"min": [0, 0, 0], "max": [1, 1, 1]}), 60, 23, "--precision", "mixed")

plugin = os.path.join(MODULES, "remembering.so")
scene = changed(noh, plugins=[*noh["plugins"], plugin])
scene["scheme"] = {"name": "gsph", "edit": [{"operation": "assignment", "function": "remember", "of": "u", "at": "finish"}]}
whole, _, _, _ = tried("a state of its own, particles made", scene, 60, 13)
expect("particles are made", whole.summary()["particles"]["fluid"] > 400, whole.summary()["particles"])

# -- Ends that are none --------------------------------------------------------------------------

kept, path = with_checkpoints(noh, MANY), scenes.write(with_checkpoints(noh, MANY), "ends.json")
whole = first[0]
part = scenes.good(kept, "--steps", "50")
expect("a checkpoint at the end", [file[-11:-3] for file in checkpoints(part.out)] == ["00000050"])
compare("on from --steps", whole, going_on(part.out, path, "--resume", "latest", "--out", "@", "--steps", "90"))
compare("without a scene", whole, going_on(part.out, "--resume", "latest", "--out", "@", "--steps", "90"))
result = going_on(part.out, "run", "--resume", "@/checkpoint_00000050.h5", "--steps", "90", cwd="/")
compare("from another folder", whole, result)
elsewhere = os.path.join(scenes.scratch.name, "elsewhere")
shutil.copytree(part.out, elsewhere)
done = scenes.command("--resume", checkpoints(elsewhere)[0], "--steps", "90", "-q", cwd="/")
compare("FILE's own folder", whole, Result(done, elsewhere))
other = os.path.join(scenes.scratch.name, "other")
done = scenes.command("--resume", checkpoints(part.out)[0], "--out", other, "--steps", "90", "-q")
names = [os.path.basename(one) for one in glob.glob(os.path.join(other, "*"))]
expect("into another folder", done.returncode == 0 and "log.csv" in names and "snapshot_0000.vtkhdf" not in names
       and rows(other)[1:] == [row for row in rows(whole.out)[1:] if int(row.split(",")[0]) >= 50], names)

# --until at a moment of output is a step's end in any case.
ends = changed(kept, time={"end": 0.15})
full = scenes.good(changed(noh, time={"end": 0.15}))
for options in (("--until", "0.1"), ("--set", "time.end=0.1")):
    part = scenes.good(ends, *options)
    expect(f"{options}: ends there", part.summary()["time"] == 0.1)
    path = scenes.write(ends, "ends.json")
    compare(f"on from {options}", full, going_on(part.out, path, "--resume", "latest", "--out", "@"))

# Other moments of output from here on.
part = scenes.good(kept, "--steps", "50")
result = going_on(part.out, path, "--resume", "latest", "--out", "@", "--set", "output.every=0.04", "--set",
                  "output.log.every=0.04", "--set", "output.log.steps=null", "--until", "0.3")
expect("null is no number", result.code == 2, result.stderr)
words = ("--set", 'output={"every": 0.04, "log": {"every": 0.04}}', "--until", "0.3")
result = going_on(part.out, path, "--resume", "latest", "--out", "@", *words)
found = [round(Snapshot(one).time, 12) for one in result.snapshots()]
old = [round(Snapshot(one).time, 12) for one in part.snapshots()[:-1]]
begin = part.summary()["time"]
wanted = [round(0.04 * k, 12) for k in range(1, 8) if 0.04 * k > begin]
expect("other moments of output", result.code == 0 and found == [*old, *wanted, 0.3], (found, old, wanted, result.stderr))
late = [row.split(",") for row in rows(result.out)[1:] if int(row.split(",")[0]) > 50]
expect("other moments of the log", [round(float(row[1]), 12) for row in late] == [*wanted, 0.3], late)

# Signals: one that asks, one that does not.
busy = changed(with_checkpoints(small("noh.json", 0.05), 5, 2), time={"end": 0.25})
path = scenes.write(busy, "busy.json")
full = scenes.good(changed(busy, output={**busy["output"], "checkpoint": {"steps": MANY}}))
for number in (signal.SIGINT, signal.SIGKILL, signal.SIGKILL):
    out = os.path.join(scenes.scratch.name, "killed")
    shutil.rmtree(out, ignore_errors=True)
    with subprocess.Popen([os.environ["SPH"], path, "--out", out, "-q", "--threads", "2"]) as process:
        end = time.time() + 60
        while time.time() < end and process.poll() is None and not any("00015" <= one[-8:-3] for one in checkpoints(out)):
            time.sleep(0.005)
        process.send_signal(number)
    left = checkpoints(out)
    expect(f"{number.name}: in the midst", process.returncode in (1, -number) and len(left) in (2, 3), (process.returncode, left))
    result = going_on(out, path, "--resume", "latest", "--out", "@")
    compare(f"after {number.name}", full, result)
    expect(f"{number.name}: two are kept", len(checkpoints(result.out)) == 2, checkpoints(result.out))
expect("nothing is left aside", not glob.glob(os.path.join(result.out, ".sph-*")), os.listdir(result.out))

every = scenes.good(changed(busy, output={"every": 0.1, "checkpoint": {"every": 0.05, "keep": 10}}))
found = []
for file in checkpoints(every.out):
    with h5py.File(file) as one:
        found.append(float(one["time"][0]))
expect("every", len(found) == 5 and all(0 <= t - 0.05 * (k + 1) < 0.02 for k, t in enumerate(found)), found)
fresh = scenes.command(scenes.write(noh), "--out", every.out, "-q", "--steps", "1")
expect("another run takes them away", fresh.returncode == 0 and not checkpoints(every.out), checkpoints(every.out))

# -- What is no good -----------------------------------------------------------------------------

whole, other, path, options = first
good = checkpoints(other.out)
scratch = os.path.join(scenes.scratch.name, "bad")


def refused(what, words, *parts, code=2, scene=path, more=()):
    """One sentence, the right exit status, and nothing is changed."""
    before = sorted(os.listdir(scratch))
    done = scenes.command(*([scene] if scene else []), *words, "--out", scratch, "-q", *more)
    lines = done.stderr.splitlines()
    expect(f"{what}: refused", done.returncode == code and len(lines) == 1 and all(part in lines[0] for part in parts),
           (done.returncode, done.stderr))
    expect(f"{what}: nothing changed", sorted(os.listdir(scratch)) == before, os.listdir(scratch))


def spoil(data, to="checkpoint_00000013.h5"):
    file = os.path.join(scratch, to)
    with open(file, "wb") as out:
        out.write(data)
    return file


os.mkdir(scratch)
refused("none there", ("--resume", "latest"), "no checkpoint is in the folder")
refused("no such file", ("--resume", os.path.join(scratch, "none.h5")), "none.h5", "No such file")
refused("no HDF5", ("--resume", spoil(b"step,time,dt\n")), "it is not an HDF5 file")
refused("empty", ("--resume", spoil(b"")), "it is not an HDF5 file")
refused("a snapshot", ("--resume", whole.snapshots()[0]), "is no checkpoint of sph")
with open(good[0], "rb") as file:
    data = file.read()
for part in (0.999, 0.5, 0.01):
    refused(f"{part} of it", ("--resume", spoil(data[: int(len(data) * part)])), "checkpoint_00000013.h5")
refused("latest is broken", ("--resume", "latest"), "no good checkpoint is in")
file = spoil(data)
with h5py.File(file, "r+") as one:
    one["format"][0] = 99
refused("a newer format", ("--resume", file), "is a checkpoint of format 99; this version reads format 3")
for name, bytes_, said in (
    ("version", b"9.9", "was made by sph 9.9; this is sph"),
    ("plugins", b"gsph\t77\n", 'was made with version 77 of the plugin "gsph"; here it is'),
    ("byte_order", b"\1\2\3\4", "was made on a machine with another order of bytes"),
    ("plugins", b"unheard-of\t1\n", 'was made with the plugin "unheard-of", which is not loaded'),
):
    file = spoil(data)
    with h5py.File(file, "r+") as one:
        del one[name]
        one[name] = numpy.frombuffer(bytes_, numpy.uint8)
    refused(f"another {name}", ("--resume", file), said)
file = spoil(data)
refused("precision", ("--resume", file, "--precision", "mixed"), 'was made in precision "double", not "mixed"')
refused("path", ("--resume", file, "--path", "base"), "was made with --path best, not base")
for setting, *parts in (
    ("time.cfl=0.1", "/time/cfl is 0.1 here and missing there"),
    ("particles.fluid.fill.spacing=0.2", "/particles/fluid/fill/spacing is 0.2 here and 0.1 there"),
    ("neighbours.skin=0.03", "/neighbours/skin is 0.03 here and 0.25 there"),
    ("scheme.beta=2", "/scheme/beta is 2 here and missing there"),
):
    refused(setting, ("--resume", file, "--set", setting), "whose scene differs", *parts)
refused("--steps before it", ("--resume", file, "--steps", "5"), "is at step 13, behind the last one, 5")
refused("--until before it", ("--resume", file, "--until", "0.001"), "behind the end 0.001")
done = scenes.command(path, "--resume", file, "--dry-run")
expect("--dry-run", done.returncode == 2 and "do not go together" in done.stderr, done.stderr)
done = scenes.command("--resume", "latest")
expect("latest of nothing", done.returncode == 2 and "give the scene, or the folder" in done.stderr, done.stderr)

# A bit anywhere: found, or of no consequence.
random = numpy.random.default_rng(1)
unharmed = columns(going_on(other.out, path, "--resume", "@/checkpoint_00000013.h5", "--steps", "13").snapshots()[-1])
told = 0
for place in random.integers(0, len(data), 40):
    one = bytearray(data)
    one[place] ^= 1 << int(random.integers(8))
    done = scenes.command(path, "--resume", spoil(one), "--out", scratch, "-q", "--steps", "13")
    told += done.returncode == 2
    expect(f"bit {place}", done.returncode == 0 or done.returncode == 2 and len(done.stderr.splitlines()) == 1,
           (done.returncode, done.stderr))
    if done.returncode == 0:
        expect(f"bit {place}: other bits", columns(Result(done, scratch).snapshots()[-1]) == unharmed)
expect("bits are told", told > 25, told)
print(f"one bit flipped: {told} of 40 told")

# The one before is taken.
two = os.path.join(scenes.scratch.name, "two")
shutil.copytree(other.out, two)
with open(checkpoints(two)[-1], "r+b") as file:
    file.truncate(5000)
done = scenes.command(path, "--resume", "latest", "--out", two, "-q", *options)
expect("the one before", "checkpoint_00000090.h5" in done.stderr and "the one before it is taken" in done.stderr
       and len(done.stderr.splitlines()) == 1, done.stderr)
compare("from the one before", whole, Result(done, two))


room = (os.path.getsize(good[0]) + max(os.path.getsize(one) for one in whole.snapshots())) // 2


def limit():
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))


full = os.path.join(scenes.scratch.name, "full")
done = scenes.command(path, "--out", full, "-q", *options, preexec_fn=limit)
expect("a full disk", done.returncode == 1 and "cannot write" in done.stderr and "checkpoint_00000013.h5" in done.stderr
       and len(done.stderr.splitlines()) == 1 and not checkpoints(full), (done.stderr, os.listdir(full)))
expect("nothing aside", not any(name.startswith(".sph-aside") for name in os.listdir(full)), os.listdir(full))
scenes.end()

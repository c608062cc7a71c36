"""What several ranks leave behind is gone on from by any number of them: with a strict order of sums to the bits of a
run on one rank that never stopped (snapshots, the log, what is measured), from one rank on several and back; without it
on as many ranks to the bits of these ranks never having stopped, however the domain is cut. Every file opens, those of
a run that failed on a rank as well."""
import csv
import glob
import os
import shutil
import sys
import time

import h5py

from launch import BOUND, ENVIRONMENT, MPIRUN, SPH, Job, Scenes, changed, example, need
from scenes import Result

need()
os.environ.update(ENVIRONMENT)
scenes = Scenes()
expect = scenes.expect
SCRATCH = scenes.scratch.name
MODULES = os.path.join(os.path.abspath(os.environ["top_builddir"]), "tests", "abi", ".libs")
EACH = ("--threads", "1", "--quiet")


def on(ranks, *words):
    """Ends the test if it fails."""
    before = (*MPIRUN, "-n", str(ranks)) if ranks > 1 else ()
    done = scenes.command(*words, *EACH, before=before)
    if done.returncode != 0:
        print(f"MISS {words} on {ranks} ranks: {done.stderr}")
        sys.exit(1)
    return done


def fresh():
    scenes.count += 1
    return os.path.join(SCRATCH, f"out{scenes.count}")


def run(ranks, path, *options):
    out = fresh()
    return Result(on(ranks, path, "--out", out, *options), out)


def open_all(what, out):
    """Every block of every file comes out of it; the smaller ones are read for their own sake by sph."""
    files = glob.glob(os.path.join(out, "*.vtkhdf")) + glob.glob(os.path.join(out, "*.h5"))
    read = []
    for path in files:
        with h5py.File(path) as file:
            file.visititems(lambda name, one: read.append(one[()]) if isinstance(one, h5py.Dataset) else None)
    expect(f"{what}: every file opens", len(read) > 20, files)
    expect(f"{what}: nothing aside", not glob.glob(os.path.join(out, ".sph-aside*")), os.listdir(out))


def columns(path, sort):
    """By who they are; or as they stand."""
    with h5py.File(path) as file:
        root = file["VTKHDF"]
        order = root["PointData/id"][:].argsort(kind="stable") if sort else slice(None)
        found = {name: data[:][order].tobytes() for name, data in root["PointData"].items()}
        found["x"] = root["Points"][:][order].tobytes()
        found["when"] = root["FieldData/Time"][0], root["FieldData/Step"][0]
        found["parts"] = None if sort else tuple(root["NumberOfPoints"][:])
        return found


def table(path):
    """But for what is about seconds and shares."""
    with open(path) as file:
        rows = list(csv.reader(file))
    skip = [k for k, name in enumerate(rows[0]) if name in ("wall_s", "imbalance")]
    return [[cell for k, cell in enumerate(row) if k not in skip] for row in rows]


def numbers(result):
    summary = result.summary()
    return {key: summary[key] for key in ("status", "steps", "time", "particles", "errors", "probes", "profiles",
                                          "conservation", "watch") if key in summary}


def same(what, one, two, sort=True):
    names = [os.path.basename(path) for path in one.snapshots()]
    expect(f"{what}: snapshots", names == [os.path.basename(path) for path in two.snapshots()], os.listdir(two.out))
    for name in names:
        if two.has(name):
            a, b = columns(one.path(name), sort), columns(two.path(name), sort)
            expect(f"{what}: bits of {name}", a == b, [key for key in a if a[key] != b.get(key)])
    for path in glob.glob(one.path("*.csv")):
        name = os.path.basename(path)
        if name != "ranks.csv":
            a, b = table(path), table(two.path(name)) if two.has(name) else []
            first = next((k for k, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b)))
            expect(f"{what}: {name}", a == b, f"from row {first} on, {len(a)} and {len(b)} rows")
    a, b = numbers(one), numbers(two)
    expect(f"{what}: the summary", a == b, [(key, a[key], b.get(key)) for key in a if a[key] != b.get(key)])


def goes_on(what, one, written, path, to, *options, sort=True):
    """From each of the checkpoints of `written` in turn, on as many ranks as `to` says."""
    files = sorted(glob.glob(written.path("checkpoint_*.h5")))[:-1]  # the last is of the end
    for k, ranks in enumerate(to):
        out = fresh()
        shutil.copytree(written.out, out)
        file = os.path.join(out, os.path.basename(files[k % len(files)]))
        result = Result(on(ranks, path, "--resume", file, "--out", out, *options), out)
        same(f"{what}, {os.path.basename(file)} on {ranks} ranks", one, result, sort)
        open_all(f"{what} on {ranks} ranks", out)


def kept(scene, steps):
    return changed(scene, output={**scene["output"], "checkpoint": {"steps": steps, "keep": 99}})


def strict(what, scene, steps, every, plan, *options):
    """plan: ranks that write, and those that go on from it."""
    begin = time.monotonic()
    options = ("--strict", "--steps", str(steps), *options)
    whole = run(1, scenes.write(scene), *options)
    path = scenes.write(kept(scene, every), f"kept{scenes.count}.json")
    for ranks, to in plan:
        written = run(ranks, path, *options)
        same(f"{what}, {ranks} ranks", whole, written)
        open_all(f"{what}, {ranks} ranks", written.out)
        goes_on(f"{what}, of {ranks} ranks", whole, written, path, to, *options)
    print(f"{what}: {plan}, {whole.summary()['cost']['list_builds']} lists, {time.monotonic() - begin:.1f} s")
    return written, path


def loose(what, scene, steps, every, ranks):
    """As many ranks, without a strict order; particles stand where they stood."""
    begin = time.monotonic()
    options = ("--steps", str(steps))
    whole = run(ranks, scenes.write(scene), *options)
    path = scenes.write(kept(scene, every), f"kept{scenes.count}.json")
    written = run(ranks, path, *options)
    same(f"{what}, with checkpoints", whole, written, False)
    goes_on(what, whole, written, path, (ranks, ranks), *options, sort=False)
    cost = whole.summary()["cost"]
    print(f"{what}: {ranks} ranks, {cost['list_builds']} lists, {cost['sorts']} sorts, {time.monotonic() - begin:.1f} s")
    return cost


# -- With a strict order ---------------------------------------------------------------------------

noh = changed(example("noh.json"), output={"every": 0.05, "log": {"steps": 3}, "picture": False}, ranks={"imbalance": 1.0})
noh["particles"]["fluid"]["fill"]["spacing"] = 0.1
noh["compare"] = [{**noh["compare"][0], "every": 0.04}]
noh["probes"] += [{"name": "along", "array": "fluid", "at": [[0, 0], [0.5, 0.1]], "of": "rho", "steps": 3}]
noh["profiles"] = [{"name": "shells", "array": "fluid", "of": "rho", "along": "r", "bins": 5, "max": 1, "every": 0.05}]
written, path = strict("Noh's implosion", noh, 60, 19, ((4, (1, 2, 3)), (1, (4,))))

box = {
    "title": "swirls in a periodic box",
    "dimensions": 3,
    "plugins": ["kernels", "eos", "wcsph"],
    "domain": {"min": [0, 0, 0], "max": [1, 1, 1], "sides": {"x": "periodic", "y": "mirror", "z": "periodic"}},
    "materials": {"water": {"eos": {"name": "tait", "c0": 10, "rho0": 1}}},
    "particles": {"fluid": {
        "material": "water", "fill": {"lattice": "square", "spacing": 0.125},
        "fields": {"rho": 1, "v": ["sin(2*3.14159265*y)", "cos(2*3.14159265*z)", "sin(3.14159265*x)"]}}},
    "neighbours": {"skin": 0.08},
    "scheme": {"name": "wcsph", "alpha": 0.1},
    "time": {"end": 1},
    "output": {"every": 0.05, "log": {"steps": 5}, "picture": False},
}
strict("a periodic box, mixed", box, 40, 17, ((3, (2, 7)),), "--precision", "mixed")
strict("a periodic box, single", box, 40, 17, ((2, (3,)),), "--precision", "single")

# -- Without it ------------------------------------------------------------------------------------

drop = changed(example("drop.json"), output={"every": 0.001, "log": {"steps": 5}, "picture": False},
               neighbours={"skin": 0.02}, ranks={"imbalance": 1.0})
drop.pop("probes")
drop["particles"]["drop"]["fill"]["spacing"] = 0.08
cost = loose("a drop", drop, 80, 33, 3)
expect("particles are sorted", cost["sorts"] > 3, cost)
loose("a drop in slabs", changed(drop, ranks={"imbalance": 1.0, "partition": "slab"}), 80, 33, 2)

# Its images: other ranks' and its own, edges and corners.
cost = loose("a box with sides", changed(box, neighbours={"skin": 0.02}, ranks={"imbalance": 1.0}), 40, 1, 2)
expect("a box with sides: particles are sorted", cost["sorts"] > 1, cost)

# -- What is refused -------------------------------------------------------------------------------

file = written.path("checkpoint_00000019.h5")
for words, said in ((("--resume", file), "was made with --strict; go on with it"),
                    (("--resume", file, "--strict", "--precision", "mixed"), 'was made in precision "double"'),
                    (("--resume", os.path.join(SCRATCH, "none.h5"), "--strict"), "No such file")):
    job = Job(3, SPH, path, *words, "--out", fresh(), *EACH).end(BOUND)
    expect(f"{words}: refused", job.returncode == 2 and len(job.said) == 1 and said in job.said[0],
           (job.returncode, job.stderr))
old = os.path.join(SCRATCH, "old.h5")
shutil.copy(file, old)
with h5py.File(old, "r+") as one:
    one["format"][0] = 1
job = Job(2, SPH, path, "--resume", old, "--out", fresh(), "--strict", *EACH).end(BOUND)
expect("an older format", job.returncode == 2 and len(job.said) == 1 and "is a checkpoint of format 1; this version reads"
       in job.said[0], job.stderr)

# The newest one is broken: said once, and all take the one before.
out = fresh()
shutil.copytree(written.out, out)
with open(sorted(glob.glob(os.path.join(out, "checkpoint_*.h5")))[-1], "r+b") as one:
    one.truncate(5000)
job = Job(3, SPH, path, "--resume", "latest", "--out", out, "--strict", "--steps", "60", *EACH).end(BOUND)
expect("the one before is taken", job.returncode == 0 and len(job.said) == 1 and "the one before it is taken" in job.said[0],
       (job.returncode, job.stderr))
same("from the one before", written, Result(job, out))

# -- A run that fails ------------------------------------------------------------------------------

bad = kept(changed(noh, plugins=[*noh["plugins"], os.path.join(MODULES, "failing_run.so")]), 1)
bad["scheme"] = {"name": "gsph", "edit": [
    {"insert": "fail-one"}]}
for key in ("compare", "probes", "profiles"):
    bad.pop(key)
out = fresh()
job = Job(3, SPH, scenes.write(bad), "--out", out, *EACH).end(BOUND)
print(f"a function fails on a rank: {job.said}")
expect("it fails", job.returncode == 1 and len(job.said) == 1 and job.said[0].startswith("sph: rank ")
       and "the last checkpoint is of step 2: --resume latest goes on from there" in job.said[0], job.stderr)
failed = Result(job, out)
expect("its summary", failed.has("summary.json") and failed.summary()["status"] == "failed"
       and job.said[0].endswith(failed.summary()["reason"]), failed.has("summary.json") and failed.summary().get("reason"))
expect("its state", failed.has("checkpoint_failed.h5"), os.listdir(out))
open_all("it", out)
with h5py.File(failed.path("checkpoint_failed.h5")) as one:
    total = sum(len(group["column0/data0"]) for group in (one["array0"], one["rank1/array0"], one["rank2/array0"]))
expect("its particles", total == 400, total)
job = Job(2, SPH, "--resume", failed.path("checkpoint_failed.h5"), "--out", out, *EACH).end(BOUND)
expect("nobody goes on from it", job.returncode == 2 and len(job.said) == 1 and "is the state of a run that failed" in
       job.said[0] and "checkpoint_00000002.h5" in job.said[0], job.stderr)
scenes.end()

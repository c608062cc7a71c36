"""What is told of all particles does not depend on the number of ranks: errors, probes, profiles, courses in time and
rows of the log have the same text with a strict order of sums, and are near without; functions that make and remove
particles give them the same ids; what the watch counts is the same, and what one rank's particle does ends the run with
one sentence that names it."""
import copy
import csv
import json
import math
import os

import numpy

from launch import BOUND, SPH, Job, Scenes, Snapshot, changed, example, need

need()
scenes = Scenes()
expect = scenes.expect
SOURCE = os.environ["top_srcdir"]
MODULES = os.path.abspath(os.path.join(os.environ["top_builddir"], "tests", "mpi", ".libs"))
FEW = ("--threads", "1", "--quiet")
count = 0


class Folder:
    def __init__(self, job, out):
        self.job, self.out = job, out

    def path(self, name):
        return os.path.join(self.out, name)

    def tables(self):
        """Text of every table but that of the ranks themselves; of the log all but the last column, which is the
        clock's."""
        found = {}
        for name in sorted(os.listdir(self.out)):
            if name.endswith(".csv") and name != "ranks.csv":
                with open(self.path(name), newline="") as file:
                    rows = list(csv.reader(file))
                found[name] = [row[:-1] for row in rows] if name == "log.csv" else rows
        return found

    def summary(self):
        with open(self.path("summary.json")) as file:
            return json.load(file)

    def snapshots(self):
        return [Snapshot(self.path(name)) for name in sorted(os.listdir(self.out)) if name.startswith("snapshot_")]


def run(scene, ranks, *options):
    """On so many ranks; 1: without mpirun."""
    global count
    count += 1
    out = os.path.join(scenes.scratch.name, f"o{count}")
    words = (scenes.write(scene, f"s{count}.json"), "--out", out, *FEW, *options)
    if ranks == 1:
        job = scenes.command(*words)
        job.said = job.stderr.splitlines()
    else:
        job = Job(ranks, SPH, *words).end(BOUND)
    return Folder(job, out)


def good(scene, ranks, *options):
    result = run(scene, ranks, *options)
    expect(f"{scene['title']} on {ranks}", result.job.returncode == 0, result.job.stderr)
    if result.job.returncode:
        scenes.end()
    return result


def differs(one, other):
    """Where two tables differ, or None."""
    if one.keys() != other.keys():
        return f"{sorted(one)} and {sorted(other)}"
    for name in one:
        for k, (a, b) in enumerate(zip(one[name], other[name])):
            if a != b:
                return f"{name}, line {k + 1}: {a} and {b}"
        if len(one[name]) != len(other[name]):
            return f"{name}: {len(one[name])} lines and {len(other[name])}"
    return None


def same_particles(what, one, other):
    expect(f"{what}: as many snapshots", len(one) == len(other) > 1, (len(one), len(other)))
    for a, b in zip(one, other):
        orders = [numpy.lexsort((s["id"], s["array"])) for s in (a, b)]
        for name in a.column:
            x, y = a[name][orders[0]], b[name][orders[1]]
            if x.shape != y.shape or x.tobytes() != y.tobytes():
                expect(f"{what}: {name} at step {a.step}", False, (x.shape, y.shape))
                break


MEASURES = ("errors", "probes", "profiles", "time", "steps", "conservation", "watch")


def difference(column, other):
    """The largest, of the column's largest value or 1."""
    def number(text):
        try:
            return float(text)
        except ValueError:
            return None
    pairs = [(number(a), number(b)) for a, b in zip(column, other) if a != b]
    if any(a is None or b is None for a, b in pairs):
        return math.inf
    scale = max([1.0] + [abs(number(a)) for a in column if number(a) is not None and math.isfinite(number(a))])
    return max((abs(a - b) / scale for a, b in pairs), default=0.0)


def alike(scene, ranks, near=()):
    """Every table of a strict run, and what its summary says, on these numbers of ranks; without `strict` numbers to
    rounding."""
    what = scene["title"]
    one = good(scene, 1, "--strict")
    told = {key: value for key, value in one.summary().items() if key in MEASURES}
    for n in ranks:
        other = good(scene, n, "--strict")
        where = differs(one.tables(), other.tables())
        expect(f"{what}, {n} ranks: the same tables", where is None, where)
        same = {key: value for key, value in other.summary().items() if key in MEASURES}
        expect(f"{what}, {n} ranks: the same summary", same == told, (told, same))
    for n in near:
        loose, other = (good(scene, k, "--precision", "double").tables() for k in (1, n))
        for name in loose:
            rows = len(loose[name]) == len(other[name]) and all(len(a) == len(b) for a, b in zip(loose[name], other[name]))
            expect(f"{what}, {n} ranks, not strict: {name} has as much", rows, (len(loose[name]), len(other[name])))
            most = max(map(difference, zip(*loose[name]), zip(*other[name]))) if rows else math.inf
            print(f"{what}, {n} ranks, not strict: {name} within {most:.1e}")
            expect(f"{what}, {n} ranks, not strict: {name}", most <= 1e-12, most)
    return one


# -- Two liquids between periodic and mirror sides; one particle of a third array, far from all -------

fill = {"lattice": "square", "spacing": 0.05, "jitter": 0.2}
points = [[0.013, 0.011], [0.99, 0.3], [0.5, 0.31], [0.52, 0.598], [0.5, 0.64], [0.5, 0.8], [0.0, 0.0], [1.0, 0.2]]
center = [0.45, 0.2]
table = {"y": [0.05, 0.2, 0.5], "rho": [1, 1.01, 1.02], "v.x": [0, 1, 0.5]}
block = {
    "title": "block", "dimensions": 2, "plugins": ["kernels", "eos", "wcsph"], "kernel": "wendland-c2",
    "domain": {"min": [0, 0], "max": [1, 1], "sides": {"x": "periodic", "y": ["mirror", "open"]}},
    "materials": {"water": {"eos": {"name": "tait", "c0": 20, "rho0": 1}}},
    "particles": {
        **{name: {"material": "water", "fill": {**fill, "in": {"box": {"min": [x, 0], "max": [x + 0.5, 0.6]}}},
                  "fields": {"rho": 1, "v": ["sin(2*pi*x) + y", "-y * (1 + x)"]}}
           for name, x in (("water", 0), ("oil", 0.5))},
        "stray": {"material": "water", "fill": {"lattice": "square", "spacing": 0.05,
                                                "in": {"box": {"min": [0.7, 0.9], "max": [0.75, 0.95]}}},
                  "fields": {"rho": 1, "v": [1, 0]}}},
    "scheme": {"name": "wcsph", "alpha": 0.1},
    "time": {"end": 0.03},
    "output": {"every": 0.01},
    "compare": [
        {"array": "water", "table": table, "along": "y", "every": 0.01},
        {"array": "oil", "table": table, "along": "y", "fields": {"v.y": "v.x"}, "where": "x < 0.8", "time": 0.012},
        {"array": "stray", "table": table, "along": "y", "fields": {"rho": "rho"}, "where": "y < 2", "every": 0.02},
    ],
    "probes": [
        {"name": "points", "array": ["water", "oil", "stray"], "at": points, "of": ["rho", "p", "v", "v.r", "v.phi", "x.x"],
         "center": center, "every": 0.01},
        {"name": "plain", "array": "water", "at": points[2], "of": "p", "plain": True, "steps": 3,
         "reference": {"table": {"t": [0, 0.03], "p": [0, 1]}}},
        {"name": "sum", "array": "water", "sum": "m", "every": 0.004, "where": "y < 0.3"},
        {"name": "mean", "array": "stray", "mean": "v.x", "every": 0.004},
        {"name": "most", "array": "oil", "max": "v.r", "center": center, "steps": 2},
        {"name": "least", "array": "oil", "min": "rho", "steps": 2},
        {"name": "nobody", "array": "oil", "min": "rho", "steps": 2, "where": "y > 2"},
        {"name": "where", "array": "water", "crossing": {"of": "rho", "shell": 0.1, "level": 1}, "center": center,
         "steps": 4},
    ],
    "profiles": [
        {"name": "line", "array": ["water", "oil"], "of": ["v.y"], "from": [0.1, 0.1], "to": [0.9, 0.5], "points": 9,
         "every": 0.02},
        {"name": "rings", "array": ["water", "oil"], "of": ["v.r", "rho"], "along": "r", "center": center, "bins": 7,
         "max": 0.35, "min": 0.05, "where": "y > 0.1", "every": 0.01},
        {"name": "columns", "array": "stray", "of": "rho", "along": "y", "bins": 4, "reference": {"table": table}},
    ],
}
result = alike(block, (2, 3, 5), near=(3,))
tables = result.tables()
wanted = ["errors.csv", "log.csv", *(f"probe_{name['name']}.csv" for name in block["probes"]),
          *(f"profile_{name['name']}.csv" for name in block["profiles"])]
expect("all tables are there", sorted(tables) == sorted(wanted), sorted(tables))
rows = {name: len(tables[name]) for name in tables}
expect("they have rows", min(rows.values()) > 2 and rows["probe_points.csv"] == 1 + 4 * len(points), rows)
nobody = numpy.array([row[-1] for row in tables["probe_nobody.csv"][1:]], float)
expect("of nobody there is nothing", numpy.isnan(nobody).all(), nobody)
found = numpy.array([row[-1] for row in tables["probe_where.csv"][1:]], float)
expect("a crossing is found", numpy.isfinite(found).any(), found)

# -- Noh's implosion: four of everything, so that the largest errors are equal --------------------------

noh = example("noh.json")
noh["particles"]["fluid"]["fill"]["spacing"] = 0.08
noh["time"] = {"end": 0.15}
noh["output"] = {"every": 0.05}
noh["compare"][0]["every"] = 0.05
alike(changed(noh, title="noh"), (2, 3))

# -- Particles are made and removed, and heated by a minimum of the same evaluation -------------------------------------------------------------------

breeding = copy.deepcopy(noh)
breeding.update(title="breeding", compare=[], output={"every": 0.05}, plugins=[*noh["plugins"], os.path.join(MODULES, "breeding.so")])
fluid = breeding["particles"].pop("fluid")
for name, x in (("west", -1), ("east", 0)):
    breeding["particles"][name] = {**fluid, "fill": {"lattice": "square", "spacing": 0.1,
                                                     "in": {"box": {"min": [x, -1], "max": [x + 1, 1]}}}}
breeding["scheme"] = {"name": "gsph", "edit": [
    {"operation": "assignment", "function": "breed", "of": "u", "at": "finish"},
    {"operation": "assignment", "function": "heed", "of": "u", "after": "gsph-rates"}]}
breeding["time"] = {"end": 0.6, "steps": 30}
breeding["probes"] = [{"name": "many", "array": name, "sum": "u", "steps": 1} for name in ("west",)]
one = good(breeding, 1, "--strict")
first, last = one.snapshots()[0], one.snapshots()[-1]
made = set(last["id"]) - set(first["id"])
gone = set(first["id"]) - set(last["id"])
expect("particles are made and go", len(made) > 100 and len(gone) > 50, (len(made), len(gone)))
expect("ids are those of life", len(set(last["id"])) == len(last["id"]))
for n in (2, 3, 4):
    other = good(breeding, n, "--strict")
    same_particles(f"breeding, {n} ranks", one.snapshots(), other.snapshots())
    where = differs(one.tables(), other.tables())
    expect(f"breeding, {n} ranks: the same tables", where is None, where)

# What all ranks would say, one does.
result = run(breeding, 3, "--device", "opencl:0", "--steps", "1")
expect("a warning is said once", len(result.job.said) == 1, result.job.stderr)

# -- The watch ----------------------------------------------------------------------------------------


def scene_of(cause):
    with open(os.path.join(SOURCE, "tests", "watch", f"{cause}.json")) as file:
        return json.load(file)


def stops(cause, scene, ranks, *options, alone=True):
    """As on one rank; alone: one particle is to blame, whoever holds it."""
    one, other = run(scene, 1, "--strict", *options), run(scene, ranks, "--strict", *options)
    failure, told = other.summary().get("failure"), one.summary()["failure"]
    expect(f"{cause}: exit code", one.job.returncode == other.job.returncode == 1, other.job.stderr)
    expect(f"{cause}: one sentence", len(other.job.said) == 1 and other.job.said[0].startswith("sph: rank " if alone else "sph: "),
           other.job.stderr)
    expect(f"{cause}: names its particle", f"particle {failure['particle']} of " in other.job.stderr
           and f"\"{failure['array']}\"" in other.job.stderr, other.job.stderr)
    expect(f"{cause}: as the summary", other.job.said[0] == f"sph: {other.summary()['reason']}", other.summary()["reason"])
    same = [key for key in told if key not in ("particle", "x")] if not alone else list(told)
    expect(f"{cause}: the same failure", all(failure[key] == told[key] for key in same), (failure, told))
    if alone:
        said = other.job.said[0].split(": ", 2)[2]
        expect(f"{cause}: the same sentence", said == one.job.said[0].split(": ", 1)[1], (said, one.job.said))


for cause in ("not-finite", "density", "internal-energy", "escaped", "time-step", "energy", "neighbours"):
    stops(cause, scene_of(cause), 3, alone=cause not in ("density", "internal-energy"))
# Seen in the rates alone, which those nearby have spoilt as well: still it is he who is named.
stops("not-finite", scene_of("not-finite"), 3, "--set", "output.log.steps=1000")
periodic = {"min": [-1, -1], "max": [1, 1], "sides": {"x": "periodic", "y": "periodic"}}
for above in (6000, 1e6):
    stops(f"neighbours above {above}", changed(scene_of("neighbours"), domain=periodic, watch={"neighbours": {"above": above}}), 3)


def counts(cause, scene, steps, ranks=3):
    scene = copy.deepcopy(scene)
    rule = scene.setdefault("watch", {}).get(cause)
    scene["watch"][cause] = {**rule, "action": "count"} if isinstance(rule, dict) else "count"
    scene["time"]["steps"] = steps
    one, other = (good(scene, n, "--strict").summary()["watch"][cause] for n in (1, ranks))
    expect(f"{cause}: counted", one["count"] == other["count"] > 0, (one, other))
    for key in ("step", "time", "array"):
        expect(f"{cause}: {key} of the first", one["first"][key] == other["first"][key], (one, other))


counts("escaped", scene_of("escaped"), 20)
counts("energy", scene_of("energy"), 16)
counts("time-step", scene_of("time-step"), 20)
counts("neighbours", scene_of("neighbours"), 14)
cold = changed(noh, title="cold", compare=[], probes=[])
cold["scheme"]["edit"] = [{"operation": "assignment", "of": "rho", "after": "gsph-rates",
                           "expression": "planted > 0 ? 0 - rho : rho"}]
cold["particles"]["fluid"]["columns"] = {"planted": "x > 0.9"}
counts("density", cold, 10)

scenes.end()

"""Operations and columns that a scene writes itself: carried, saved, restored, shown by `sph plan`; and
solutions that must not depend on how a problem is told: in one array or two, whole or as a mirrored half,
shifted through a periodic side, or taken up from a snapshot."""
import json
import os

import numpy

from scenes import Scenes, Snapshot, changed, example

scenes = Scenes()
expect = scenes.expect
noh, sod, wall = example("noh.json"), example("sod.json"), example("noh-1d.json")
for scene in (noh, sod, wall):
    for key in ("compare", "probes", "profiles", "output"):
        scene.pop(key, None)
noh["particles"]["fluid"]["fill"]["spacing"] = 0.1
noh["time"]["end"] = 5
GAS = {"gas": {"eos": {"name": "ideal-gas", "gamma": 1.4}}}


def with_edit(scene, *edits):
    return changed(scene, scheme={"name": "gsph", "edit": list(edits)})


def with_columns(scene, **columns):
    scene = changed(scene)
    scene["particles"]["fluid"]["columns"] = columns
    return scene


def plan(scene, *options):
    done = scenes.command("plan", "--json", scenes.write(scene), *options)
    return json.loads(done.stdout) if done.returncode == 0 else done.stderr


def passes(scene):
    """Names of a scene's passes."""
    found = plan(scene)
    return [one["name"] for one in found["passes"]] if isinstance(found, dict) else found


def same(what, a, b, tolerance, columns=("x", "v", "rho", "u", "p", "h")):
    """Columns as functions: pairs (name, values)."""
    for name in columns:
        scale = max(1e-3, float(numpy.abs(a[name]).max()))
        error = float(numpy.abs(a[name] - b[name]).max()) / scale
        expect(f"{what}: {name}", error <= tolerance, error)


# Columns of the user's own go with their particles through sorts and crossings, and into the file.
scene = with_columns(
    noh,
    tracer="x + 10 * y",
    label={"type": "int32", "value": "x > y"},
    arrow=["y", "-x"],
)
scene["domain"]["sides"] = {"x": "periodic", "y": "periodic"}
result = scenes.good(scene, "--steps", "150")
first, last = Snapshot(result.snapshots()[0]), result.last()
expect("the particles were sorted", result.summary()["cost"]["list_builds"] > 32)
x, y = first["x"][:, 0], first["x"][:, 1]
for what, snapshot in (("first", first), ("last", last)):
    expect(f"tracer, {what}", numpy.allclose(snapshot["tracer"], x + 10 * y, atol=1e-14))
    expect(f"label, {what}", (snapshot["label"] == (x > y)).all() and snapshot["label"].dtype.kind == "i")
    expect(f"arrow, {what}", numpy.allclose(snapshot["arrow"][:, :2], numpy.stack([y, -x], axis=1), atol=1e-14))

# ... and out of a snapshot: the state is what it was.
again = changed(scene)
again["particles"]["fluid"].pop("fields")
again["particles"]["fluid"]["fill"] = {"file": result.snapshots()[-1]}
again["time"]["begin"] = last.time
restarted = Snapshot(scenes.good(again, "--steps", "0").snapshots()[0])
expect("time of the restart", restarted.time == last.time, restarted.time)
expect("ids of the restart", len(restarted["id"]) == len(last["id"]))


def sort_by(snapshot, key):
    order = numpy.lexsort(key)
    return {name: data[order] for name, data in snapshot.column.items()}


before = sort_by(last, (last["x"][:, 0], last["x"][:, 1]))
after = sort_by(restarted, (restarted["x"][:, 0], restarted["x"][:, 1]))
same("restart", before, after, 0.0, ("x", "v", "u", "m", "tracer", "label", "arrow"))
same("restart", before, after, 1e-5, ("h", "rho"))

# Assignments by expression, of the state that they see.
scene = with_edit(
    with_columns(noh, label={"type": "int32", "value": 7}, twice=0, seen=0),
    {"operation": "assignment", "of": "label", "expression": "x > 0"},
    {"operation": "assignment", "of": "twice", "expression": "2 * rho + t", "after": "gsph-density"},
    {"operation": "assignment", "of": "seen", "expression": "seen + 1", "at": "finish"},
)
last = scenes.good(scene, "--steps", "30").last()
expect("label = x > 0", (last["label"] == (last["x"][:, 0] > 0)).all())
expect("twice = 2 rho + t", numpy.allclose(last["twice"], 2 * last["rho"] + last.time, rtol=1e-14))
expect("seen = steps", (last["seen"] == 30).all(), last["seen"])
expect(
    "plan with assignments",
    passes(scene)
    == [
        "gsph-density(fluid)", "twice(fluid)", "eos(fluid)", "gsph-gradients(fluid)", "gsph-rates(fluid)",
        "label(fluid)", "seen(fluid)",
    ],
    passes(scene),
)

# The scheme written out as operations of the scene is the scheme.
steps = ("gsph-density", "eos", "gsph-gradients", "gsph-rates")
scene = with_edit(
    sod,
    *({"delete": step} for step in steps),
    {"operation": "summation", "function": "gsph-density", "of": "rho", "to": ["fluid"], "from": ["fluid"]},
    {"operation": "assignment", "function": "eos", "of": "p", "to": "fluid"},
    {"operation": "summation", "function": "gsph-gradients", "of": "grad_p", "from": "fluid"},
    {"operation": "integration", "function": "gsph-rates", "of": "v", "to": ["fluid"], "from": ["fluid"]},
)
expect("plan of operations", passes(scene) == [f"{step}(fluid)" for step in steps], passes(scene))
one, other = scenes.good(sod, "--steps", "100").last(), scenes.good(scene, "--steps", "100").last()
same("operations", one.column, other.column, 0.0)

# A step replaced, with a parameter of its own; a step deleted that others need.
scene = with_edit(sod, {"replace": "gsph-rates", "with": "gsph-rates", "limiter": "none"})
other = scenes.good(scene, "--steps", "100").last()
expect("a limiter does something", numpy.abs(one["rho"] - other["rho"]).max() > 1e-4)
scene = changed(sod, scheme={"name": "gsph", "limiter": "none"})
same("parameter of the step", scenes.good(scene, "--steps", "100").last().column, other.column, 0.0)
result = scenes.run(with_edit(sod, {"delete": "gsph-gradients"}), "--steps", "1")
expect("gradients deleted", result.code == 2 and "nothing gives the initial" in result.stderr, result.stderr)
result = scenes.run(with_edit(sod, {"operation": "integration", "function": "gsph-density", "of": "rho"}))
expect("no integration", result.code == 2 and "declares no rate of" in result.stderr, result.stderr)

# A function that sets a rate anew which another has just set: the plan warns.
for scene, notes in ((with_edit(sod, {"insert": "gsph-rates", "after": "gsph-rates"}), 1), (sod, 0)):
    told = scenes.command("plan", scenes.write(scene)).stdout
    expect("rates set twice", told.count('note: gsph-rates(fluid) sets "du" anew;') == notes, told)
    expect("lines of 80 columns", max(map(len, told.splitlines())) <= 80, told)

# The path of a plugin is relative to the scene, not to where sph is started.
kernels = os.path.join(os.environ["SPH_PLUGIN_PATH"], "kernels.so")
os.symlink(kernels, os.path.join(scenes.scratch.name, "kernels.so"))
result = scenes.run(changed(sod, plugins=["./kernels.so", *sod["plugins"][1:]]), "--steps", "1")
expect("a plugin beside the scene", sod["plugins"][0] == "kernels" and result.code == 0, result.stderr)

# Sod's tube in two arrays, which see each other through all pairs.
one = scenes.good(sod, "--steps", "100").last()
scene = changed(sod)
fluid = scene["particles"].pop("fluid")
for name, fill in zip(("left", "right"), fluid["fill"]):
    scene["particles"][name] = {**fluid, "fill": fill}
two = scenes.good(scene, "--steps", "100").last()
expect("two arrays", two.names == ["left", "right"] and len(two.of("left", "m")) == 400, two.names)
expect("same time", abs(one.time - two.time) < 1e-12 * one.time, (one.time, two.time))
same("two arrays", one.column, two.column, 1e-11)
listed = plan(scene)["passes"]
expect("plan of two arrays", len(listed) == 8 and listed[1]["name"] == "gsph-density(right)", listed)

# "to" and "from": the right half left out of all sums but its own density is a wall that stands still.
still = with_edit(
    scene,
    {"replace": "gsph-density", "with": "gsph-density", "from": ["left", "right"]},
    {"replace": "gsph-gradients", "with": "gsph-gradients", "to": "left"},
    {"replace": "gsph-rates", "with": "gsph-rates", "to": "left", "from": "left"},
)
result = scenes.good(still, "--steps", "20")
first, last = Snapshot(result.snapshots()[0]), result.last()
expect("right stands still", (first.of("right", "x") == last.of("right", "x")).all())
expect("left expands", last.of("left", "v").max() > 0.1)
expect("columns that an array lacks", numpy.isnan(last.of("right", "du")).all())

# A mirrored half is the whole: in one dimension and two.
whole = changed(wall, domain={"min": [-1], "max": [1]})
whole["particles"]["fluid"]["fill"]["count"] = 200
whole["particles"]["fluid"]["fields"]["v"] = ["x > 0 ? -1 : 1"]
full, half = (scenes.good(scene, "--steps", "100").last() for scene in (whole, wall))
full = {name: data[full["x"][:, 0] > 0] for name, data in full.column.items()}
same("half of a line", full, half.column, 1e-11)
whole = changed(noh)
half = changed(noh, domain={"min": [0, -1], "max": [1, 1], "sides": {"x": ["mirror", "open"]}})
full, half = (scenes.good(scene, "--steps", "25").last() for scene in (whole, half))
full = {name: data[full["x"][:, 0] > 0] for name, data in full.column.items()}
order = numpy.lexsort((numpy.round(full["x"][:, 0], 9), numpy.round(full["x"][:, 1], 9)))
full = {name: data[order] for name, data in full.items()}
order = numpy.lexsort((numpy.round(half["x"][:, 0], 9), numpy.round(half["x"][:, 1], 9)))
half = {name: data[order] for name, data in half.column.items()}
same("half of a square", full, half, 1e-11)

# A periodic problem shifted by half a period.
def ring(inner, outer):
    def fill(low, high, state):
        box = {"box": {"min": [low], "max": [high]}}
        return {"lattice": "square", "in": box, "spacing": 0.01, "fields": state}

    return changed(
        sod,
        domain={"min": [0], "max": [1], "sides": {"x": "periodic"}},
        particles={
            "fluid": {
                "material": "gas",
                "fields": {"v": [0.5]},
                "fill": [fill(0, 0.25, outer), fill(0.25, 0.75, inner), fill(0.75, 1, outer)],
            }
        },
    )


dense, thin = {"rho": 1, "p": 1}, {"rho": 0.25, "p": 0.2}
one, other = (scenes.good(ring(*states), "--until", "0.3").last() for states in ((dense, thin), (thin, dense)))
place = {}
for name, snapshot, shift in (("one", one, 0.0), ("other", other, 0.5)):
    x = numpy.round((snapshot["x"][:, 0] + shift) % 1.0, 9) % 1.0
    order = x.argsort()
    place[name] = {key: data[order] for key, data in snapshot.column.items()}
    place[name]["x"] = x[order]
expect("something moved", abs(one["rho"] - 0.625).max() > 0.1 and numpy.ptp(one["v"][:, 0]) > 0.2)
same("shifted by half a period", place["one"], place["other"], 1e-10)

# The distance to the nearest, beside brute force: in periodic boxes, where some find none within their support.
def nearest(x, box, most):
    d = x[:, None] - x[None, :]
    d -= box * numpy.round(d / box)
    r = numpy.sqrt((d * d).sum(axis=2))
    numpy.fill_diagonal(r, numpy.inf)
    return numpy.minimum(r.min(axis=1), most)


for dim, n, h in ((1, 60, 2.0), (2, 12, 1.3), (2, 12, 0.3), (3, 7, 1.3)):
    scene = {
        "dimensions": dim,
        "plugins": ["kernels", "eos", "barotropic", "diagnostics"],
        "domain": {"min": [0] * dim, "max": [n] * dim, "sides": {side: "periodic" for side in "xyz"[:dim]}},
        "materials": {"gas": {"eos": {"name": "linear", "c0": 1, "rho0": 1}}},
        "particles": {
            "gas": {
                "material": "gas",
                "h_over_dx": h,
                "fill": {"lattice": "square", "spacing": 1, "jitter": 0.4},
                "fields": {"rho": 1, "v": [f"0.1 * sin({2 * numpy.pi / n} * x)"] + [0] * (dim - 1)},
            }
        },
        "scheme": {
            "name": "barotropic",
            "edit": [{"operation": "summation", "function": "nearest", "of": "nearest", "at": "finish"}],
        },
        "kernel": "wendland-c2",
        "time": {"integrator": "kdk", "dt": 0.1, "end": 2},
        "probes": [{"name": "least", "array": "gas", "min": "nearest"}],
    }
    for precision, tolerance in (("double", 1e-13), ("mixed", 1e-6)):
        what = f"nearest in {dim}D, h = {h} dx, {precision}"
        result = scenes.good(scene, "--precision", precision)
        last = result.last()
        brute = nearest(last["x"][:, :dim], n, 2 * h)
        alone = int((brute == 2 * h).sum())
        expect(f"{what}: some alone, some not", (0 < alone < len(brute)) == (h < 1), alone)
        error = float(numpy.abs(last["nearest"] - brute).max())
        expect(what, error <= tolerance * n, error)
        probed = result.summary()["probes"]["least"]["value"]
        expect(f"{what}, probed", abs(probed - brute.min()) <= tolerance * n, (probed, brute.min()))
scenes.end()

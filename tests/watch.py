#!/usr/bin/env python3
"""The watchdog: seven scenes built to fail, one for each cause (tests/watch). Each is stopped with a sentence
and a "failure" that name cause, particle, place, pass and step; what they say is compared with what is found
here from the failed state's snapshot, the log and what the scene has planted; checkpoint_failed.h5 holds
the same state, and is not gone on from. Then: what is counted or off goes on, and scenes that are well raise
nothing. With --device=opencl:N all of it there (device-watch.py)."""
import copy
import json
import math
import os
import resource
import sys

import h5py
import numpy

from scenes import Scenes, Snapshot, changed, example

scenes = Scenes(*sys.argv[1:])
expect = scenes.expect
folder = os.path.join(os.environ["top_srcdir"], "tests", "watch")
CAUSES = ("not-finite", "density", "internal-energy", "escaped", "time-step", "energy", "neighbours")


def scene_of(cause):
    with open(os.path.join(folder, f"{cause}.json")) as file:
        return json.load(file)


def fails(what, scene, cause, *options, said=()):
    """Runs a scene that is to fail: (failure, failed state, result). All that holds for any cause is checked."""
    result = scenes.run(scene, *options)
    summary = result.summary() if result.has("summary.json") else {}
    failure = summary.get("failure", {})
    expect(f"{what}: exit code", result.code == 1, (result.code, result.stderr))
    expect(f"{what}: status", summary.get("status") == "failed", summary.get("status"))
    expect(f"{what}: reason", result.stderr == f"sph: {summary.get('reason')}\n", (result.stderr, summary.get("reason")))
    expect(f"{what}: cause", failure.get("cause") == cause, failure)
    for part in (*said, f"step {failure.get('step')}, ", "likely ", "try " if cause != "neighbours" else "look "):
        expect(f"{what}: says {part!r}", part in result.stderr, result.stderr)
    state = result.last()
    expect(f"{what}: step of the state", state.step == failure.get("step") == summary["steps"], (state.step, failure))
    expect(f"{what}: time of the state", math.isclose(state.time, failure.get("time", -1), rel_tol=1e-14), (state.time, failure))
    if failure.get("array"):
        i = where(state, failure)
        at = state["x"][i][: len(failure["x"])]
        expect(f"{what}: place", numpy.allclose(at, failure["x"], rtol=1e-14, atol=0), (at, failure["x"]))
        expect(f"{what}: says the particle", f'particle {failure["particle"]} of ' in result.stderr
               and f'"{failure["array"]}"' in result.stderr, result.stderr)
        expect(f"{what}: says the place", "at x = (" + ", ".join(f"{x:g}" for x in at) + ")" in result.stderr,
               result.stderr)
        expect(f"{what}: says its values", f" m = {state['m'][i]:g};" in result.stderr, result.stderr)
    failed_state(what, scene, failure, state, result)
    return failure, state, result


def text(block):
    return block[:].tobytes().decode()


def columns(group, names):
    """Those that are held as plain floats, and ids."""
    found = {}
    for k, name in enumerate(names):
        column = group[f"column{k}"]
        if "low0" not in column and (column["data0"].dtype.kind == "f" or name == "id"):
            found[name] = numpy.array([column[f"data{c}"][:] for c in range(column["form"][1])])
    return found


def failed_state(what, scene, failure, state, result):
    """checkpoint_failed.h5 opens, tells the failure, holds the snapshot's numbers; the culprit's too."""
    path = result.path("checkpoint_failed.h5")
    if not os.path.exists(path):
        expect(f"{what}: the failed state", False, os.listdir(result.out))
        return
    with h5py.File(path) as file:
        told = [text(file["failed/cause"]), f'sph: {text(file["failed/reason"])}\n', file["failed/step"][0], file["failed/time"][0]]
        arrays = [(file[f"array{k}"], text(file[f"array{k}/columns"]).split()) for k in range(len(scene["particles"]))]
        held = [(columns(group, names), int(group["n"][0])) for group, names in arrays]
    expect(f"{what}: the file tells the failure",
           told == [failure.get("cause"), result.stderr, failure.get("step"), state.time], told)
    for name, (found, n) in zip(state.names, held):
        expect(f"{what}: {name} is held", n == len(state.of(name, "id")) and {"id", "m", "h"} <= found.keys(), found.keys())
        order = found["id"][0][:n].argsort(kind="stable")
        for key in found.keys() & state.column.keys():
            shown = state.of(name, key)
            same = numpy.array_equal(found[key][0][:n][order], shown if shown.ndim == 1 else shown[:, 0],
                                     equal_nan=found[key].dtype.kind == "f")
            expect(f"{what}: {key} of {name} is the snapshot's", same)
        if name == failure.get("array"):
            expect(f"{what}: the culprit is held", (found["id"][0][:n] == failure["particle"]).sum() == 1)
    done = scenes.command("--resume", path, "-q")
    expect(f"{what}: is not gone on from", done.returncode == 2 and len(done.stderr.splitlines()) == 1
           and f"the state of a run that failed ({failure.get('cause')}) at step {failure.get('step')}" in done.stderr
           and "to look at (h5py, h5ls)" in done.stderr and "no good checkpoint is beside it" in done.stderr,
           (done.returncode, done.stderr))


def where(state, failure):
    """Index of the particle that a failure names."""
    (found,) = numpy.nonzero(state["id"] == failure["particle"])
    return int(found[0])


def planted(state):
    (found,) = numpy.nonzero(state["planted"] == 1)
    assert len(found) == 1, found
    return int(found[0])


def begins(result):
    """Times at which the steps of the log begin, and their lengths."""
    names, rows = result.log()
    return [(row[names.index("time")], row[names.index("dt")]) for row in rows]


# -- Not finite: planted, at the first evaluation behind t = .05 ------------------------------------

for name, options in (("each step looked at", ()), ("rates alone", ("--set", "output.log.steps=1000"))):
    scene = scene_of("not-finite")
    failure, state, result = fails(f"not-finite, {name}", scene, "not-finite", *options,
                                   said=('p(fluid) made "p" not a number',))
    i = planted(state)
    expect("not-finite: particle", where(state, failure) == i, failure)
    expect("not-finite: pass", failure["pass"] == "p(fluid)", failure)
    expect("not-finite: the state has it", math.isnan(state["p"][i]) and numpy.isfinite(state["rho"]).all()
           and numpy.isnan(state["p"]).sum() == 1)
    expect("not-finite: when", state.time > 0.05)
    if not options:
        # The evaluation before it, of a leapfrog in mid-step, was not behind t = .05 yet.
        last, before = begins(result)[-1], begins(result)[-2]
        expect("not-finite: not later than it arose", last[0] - last[1] / 2 <= 0.05 < state.time, (last, before))

# -- Density ----------------------------------------------------------------------------------------

for name, options in (("double", ()), ("mixed", ("--precision", "mixed")), ("single", ("--precision", "single")),
                      ("no row of the log", ("--set", "output.log.steps=1000"))):
    failure, state, result = fails(f"density, {name}", scene_of("density"), "density", *options,
                                   said=("by the integrator with \"drho\" of wcsph-rates(drop)",))
    worst = int(state["rho"].argmin())
    expect(f"density, {name}: particle", state["rho"][where(state, failure)] == state["rho"][worst] <= 0, failure)
    expect(f"density, {name}: value", f"became {state['rho'][worst]:g} by" in result.stderr, result.stderr)
    expect(f"density, {name}: pass", failure["pass"] == "integrator", failure)
    expect(f"density, {name}: others", f"like {(state['rho'] <= 0).sum() - 1} others" in result.stderr, result.stderr)
expect("density: the state before was well", (Snapshot(result.snapshots()[0])["rho"] > 0).all())

# ... that a pass makes: one of the scheme's, followed by one of the scene's.
scene = scene_of("not-finite")
scene["scheme"]["edit"] = [{"operation": "assignment", "of": "rho", "after": "gsph-density",
                            "expression": "planted > 0 & t > 0.05 ? 0 - rho : rho"}]
failure, state, result = fails("density by a pass", scene, "density", said=("by pass rho(fluid)",))
expect("density by a pass: particle", where(state, failure) == planted(state), failure)
expect("density by a pass: pass", failure["pass"] == "rho(fluid)", failure)

# -- Internal energy --------------------------------------------------------------------------------

failure, state, result = fails("internal-energy", scene_of("internal-energy"), "internal-energy",
                               said=('by the integrator with "du" of gsph-rates(fluid)',))
worst = int(state["u"].argmin())
expect("internal-energy: particle", where(state, failure) == worst and state["u"][worst] < 0, (worst, failure))
expect("internal-energy: value", f"became {state['u'][worst]:g} by" in result.stderr, result.stderr)
expect("internal-energy: pass", failure["pass"] == "integrator", failure)

# -- Escaped: it flies alone, so where it is when is known -------------------------------------------

scene = scene_of("escaped")
failure, state, result = fails("escaped", scene, "escaped", said=("by the integrator", "out of "))
first = Snapshot(result.snapshots()[0])
size = (first["x"].max(axis=0) - first["x"].min(axis=0))[:2].max()
limit = first["x"][:, 0].max() + scene["watch"]["escaped"]["margin"] * size
start = first.of("stray", "x")[0, 0]
step = next(k for k in range(1000) if start + 100 * 0.01 * (k + 1) > limit)
expect("escaped: particle", failure["array"] == "stray" and failure["particle"] == first.of("stray", "id")[0], failure)
expect("escaped: step", failure["step"] == step, (failure, step))
expect("escaped: place", abs(failure["x"][0] - (start + step + 1)) < 1e-9 and failure["x"][0] > limit, failure)
expect("escaped: pass", failure["pass"] == "integrator", failure)

region = changed(scene, watch={"escaped": {"where": "x < 6.3"}})
failure, state, result = fails("escaped from a region", region, "escaped", said=("watch.escaped.where",))
expect("escaped from a region: step", failure["step"] == next(k for k in range(99) if start + k + 1 >= 6.3), failure)

# -- Time step --------------------------------------------------------------------------------------

failure, state, result = fails("time-step", scene_of("time-step"), "time-step",
                               said=("the time step collapsed to ", 'bounded by "dt" of pass gsph-rates(fluid)'))
expect("time-step: particle", where(state, failure) == planted(state), failure)
expect("time-step: pass", failure["pass"] == "gsph-rates(fluid)", failure)
expect("time-step: step", begins(result)[-1][0] > 0.05 and begins(result)[-2][0] <= 0.05 + begins(result)[-1][1],
       begins(result)[-2:])

# -- Energy -----------------------------------------------------------------------------------------

failure, state, result = fails("energy", scene_of("energy"), "energy", said=("the total energy went from ",))
names, rows = result.log()
total = [sum(row[names.index(name)] for name in ("kinetic", "internal", "potential")) for row in rows]
now = float((state["m"] * (state["u"] + 0.5 * (state["v"] ** 2).sum(axis=1))).sum())
expect("energy: the row before was within", abs(total[-1] - total[0]) <= 10 * total[0], total)
expect("energy: this is beyond", abs(now - total[0]) > 10 * total[0], now)
expect("energy: value", f"to {now:g}, " in result.stderr, (now, result.stderr))
expect("energy: step", failure["step"] == rows[-1][names.index("step")] + 1, failure)
fastest = int((state["m"] * (state["v"] ** 2).sum(axis=1)).argmax())
expect("energy: particle", where(state, failure) == fastest, failure)

# Of a scheme that tells the kinetic energy alone nothing is known, unless the scene says what is much.
scene = changed(scene_of("neighbours"), time={"end": 0.02}, watch={"energy": {"above": 1e-9}})
scene["scheme"].pop("edit")
result = scenes.good(scene)
kinetic = [row[result.log()[0].index("kinetic")] for row in result.log()[1]]
expect("energy: kinetic alone", len(kinetic) > 2 and abs(kinetic[-1] - kinetic[0]) > 1e-9 * kinetic[0], kinetic)
fails("energy, its scale given", changed(scene, watch={"energy": {"above": 1e-9, "scale": 1}}), "energy")

# -- Checkpoints beside the failed one ----------------------------------------------------------------

scene = changed(scene_of("energy"), output={"checkpoint": {"steps": 4, "keep": 9}})
path, result = scenes.write(scene, "beside.json"), scenes.run(scene)
failed, out = result.path("checkpoint_failed.h5"), ("--out", result.out, "-q", *scenes.always)
kept = [f"checkpoint_{step:08d}.h5" for step in (4, 8, 12)]


def left():
    return sorted(name for name in os.listdir(result.out) if name.startswith("checkpoint_") or name.startswith(".sph"))


expect("beside: not pruned, nothing aside", left() == [*kept, "checkpoint_failed.h5"], left())
# Under a checkpoint's name it is still none, and a broken one is not good.
with open(failed, "rb") as one, open(result.path("checkpoint_00000099.h5"), "wb") as two:
    two.write(one.read())
with open(result.path("checkpoint_00000013.h5"), "wb") as two:
    two.write(b"broken")
done = scenes.command("--resume", failed, "-q")
expect("beside: names the newest good one", done.returncode == 2 and len(done.stderr.splitlines()) == 1
       and done.stderr.endswith(f"the newest good checkpoint there is {result.path(kept[2])}\n"), done.stderr)
os.remove(result.path("checkpoint_00000013.h5"))
done = scenes.command("--resume", "latest", path, *out)
lines = done.stderr.splitlines()
expect("beside: latest passes it over", done.returncode == 1 and len(lines) == 2 and "checkpoint_00000099.h5 is the state of"
       in lines[0] and lines[0].endswith("; the one before it is taken") and lines[1] + "\n" == result.stderr, done.stderr)
expect("beside: it fails again, and is kept again", left() == [*kept, "checkpoint_failed.h5"], left())
done = scenes.command("--resume", "latest", path, *out, "--steps", "13")
expect("beside: one that goes on takes it away", done.returncode == 0 and left() == [*kept, "checkpoint_00000013.h5"],
       (done.stderr, left()))
done = scenes.command(path, *out)
expect("beside: there again", done.returncode == 1 and os.path.exists(failed), done.stderr)
done = scenes.command(path, *out, "--steps", "2")
expect("beside: one that begins anew takes it away", done.returncode == 0 and left() == ["checkpoint_00000002.h5"],
       (done.stderr, left()))

# No room for it: the first error is told, alone, and all else is there.
scene = scene_of("energy")
result = scenes.run(scene)
room = (os.path.getsize(result.path("checkpoint_failed.h5")) + os.path.getsize(result.snapshots()[-1])) // 2
expect("no room: for it, but for others", room > os.path.getsize(result.snapshots()[-1]), room)
full = os.path.join(scenes.scratch.name, "full")
done = scenes.command(scenes.write(scene), "--out", full, "-q", "--threads", "1", *scenes.always,
                      preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (room, room)))
expect("no room: the first error", done.returncode == 1 and done.stderr == result.stderr, done.stderr)
expect("no room: all but it", sorted(os.listdir(full)) == sorted(set(os.listdir(result.out)) - {"checkpoint_failed.h5"}),
       os.listdir(full))

# -- Neighbours -------------------------------------------------------------------------------------


def neighbours(state, i, support=2.0):
    """Within reach of i, or i within theirs."""
    r = numpy.sqrt(((state["x"] - state["x"][i]) ** 2).sum(axis=1))
    return int((r < support * numpy.maximum(state["h"], state["h"][i])).sum()) - 1


for name, options in (("one thread", ()), ("two", ("--threads", "2"))):
    failure, state, result = fails(f"neighbours, {name}", scene_of("neighbours"), "neighbours", *options,
                                   said=("its h set by pass h(drop)",))
    i = planted(state)
    expect("neighbours: particle", where(state, failure) == i, failure)
    expect("neighbours: number", f"has {neighbours(state, i)} neighbours" in result.stderr
           and neighbours(state, i) > 2000, (neighbours(state, i), result.stderr))
    expect("neighbours: it just became too large", neighbours({**state.column, "h": state["h"] / 1.2}, i) <= 2000)
    expect("neighbours: pass", failure["pass"] == "h(drop)", failure)

# Between closed sides it is stopped before its ghosts fill the memory, or reach across.
scene = changed(scene_of("neighbours"), domain={"min": [-1, -1], "max": [1, 1], "sides": {"x": "periodic", "y": "periodic"}})
for above in (6000, 1e6):
    failure, state, result = fails(f"neighbours, periodic, above {above}", changed(scene, watch={"neighbours": {"above": above}}),
                                   "neighbours", said=("by pass h(drop)",))
    expect("neighbours, periodic: particle", where(state, failure) == planted(state), failure)

# -- Counted, off -----------------------------------------------------------------------------------


def goes_on(what, scene, cause, action, *options):
    scene = copy.deepcopy(scene)
    rule = scene.setdefault("watch", {}).get(cause)
    scene["watch"][cause] = {**rule, "action": action} if isinstance(rule, dict) else action
    result = scenes.good(scene, *options)
    counts = result.summary()["watch"]
    expect(f"{what}: {action}", list(counts) == ([cause] if action == "count" else []), counts)
    return counts.get(cause, {}), result


scene = scene_of("escaped")
scene["time"]["steps"] = 20
count, result = goes_on("escaped", scene, "escaped", "count")
expect("escaped: counted", count["count"] == sum(start + k + 1 > limit for k in range(20)), count)
expect("escaped: first", count["first"]["step"] == step and count["first"]["array"] == "stray", count)
goes_on("escaped", scene, "escaped", "off")
table = scenes.run(changed(scene, watch={"escaped": {"margin": 5, "action": "count"}}), quiet=False)
expect("the table", f"escaped {count['count']} times, first at step {step}, " in table.stdout, table.stdout)
good = scenes.good(changed(scene, watch={"escaped": {"margin": 500, "action": "count"}}), quiet=False)
expect("a table without", "watch" not in good.stdout, good.stdout)
expect("a count of none", good.summary()["watch"] == {"escaped": {"count": 0}}, good.summary()["watch"])

scene = scene_of("energy")
scene["time"]["steps"] = 16
count, result = goes_on("energy", scene, "energy", "count")
expect("energy: counted", count["count"] == 3 and count["first"]["step"] == 14, count)
goes_on("energy", scene, "energy", "off")

scene = scene_of("time-step")
scene["time"].update(steps=20)
count, result = goes_on("time-step", scene, "time-step", "count")
expect("time-step: counted", count["count"] == 20 - count["first"]["step"], count)

scene = scene_of("neighbours")
scene["time"]["steps"] = 14
count, result = goes_on("neighbours", scene, "neighbours", "count")
expect("neighbours: counted", count["count"] >= 1 and count["first"]["step"] == 13, count)

# A density that is only carried along harms nobody: so many particles times steps.
scene = changed(example("noh.json"), compare=[], probes=[], watch={"density": "count"})
scene["particles"]["fluid"]["fill"]["spacing"] = 0.1
scene["time"] = {"end": 1, "steps": 10}
scene["scheme"]["edit"] = [{"operation": "assignment", "of": "rho", "after": "gsph-rates",
                            "expression": "planted > 0 ? 0 - rho : rho"}]
scene["particles"]["fluid"]["columns"] = {"planted": "x > 0.9"}
count, result = goes_on("density", scene, "density", "count")
expect("density: counted", count["count"] == 10 * 20, count)

all_off = scene_of("density")
all_off["watch"] = False
all_off["time"]["steps"] = 4
state = scenes.good(all_off).last()
expect("all off", (state["rho"] <= 0).any())
fails("not-finite is never off", changed(scene_of("not-finite"), watch=False), "not-finite")

# -- A gas that is cold, or whose energy is counted from elsewhere, is well ---------------------------

for what, begin, expression, bad in (("cold", 0, "0 * u", False), ("from elsewhere", "x", "u - 1", False),
                                     ("cooled to 0", 1, "max(0, u - 1)", False), ("below 0", 1, "u - 1", True)):
    scene = scene_of("neighbours")
    scene["particles"]["drop"]["columns"] = {"u": begin}
    scene["particles"]["drop"]["fill"]["spacing"] = 0.1
    scene["scheme"]["edit"] = [{"operation": "assignment", "of": "u", "expression": expression}]
    scene["time"]["steps"] = 5
    if bad:
        failure, *rest = fails(what, scene, "internal-energy", said=("became -1 by pass u(drop)",))
        expect(f"{what}: pass", failure["pass"] == "u(drop)", failure)
    else:
        scenes.good(scene)

# -- The examples raise nothing ----------------------------------------------------------------------

for name, options in (("noh.json", ("--set", "particles.fluid.fill.spacing=0.04")), ("noh-1d.json", ()), ("sod.json", ()),
                      ("drop.json", ("--set", "particles.drop.fill.spacing=0.04")), ("sod-pysph.json", ("--until", "0.05"))):
    scene = changed(example(name), watch={cause: "count" for cause in CAUSES[1:]})
    words = ["--set", "output.picture=false", *options]
    counts = scenes.good(scene, *words).summary()["watch"]
    expect(f"{name} raises nothing", counts == {cause: {"count": 0} for cause in CAUSES[1:]}, counts)

scenes.end()

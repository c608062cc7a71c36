"""What a scene has measured against numpy, computed from the snapshots of the same moments: norms against tables
and exact solutions, values at points with the images that sides make, profiles, courses in time. And that
measuring changes no bit of the run, whatever the number of threads."""
import csv
import itertools
import json
import math
import os

import numpy

from scenes import Scenes, Snapshot, changed, example

# summary.json has 15 digits of a number where these are it but for the last bit (cJSON); rows have all.
LAST_BIT = 3e-16
scenes = Scenes()
expect = scenes.expect


def near(what, found, wanted, tolerance=1e-11):
    found, wanted = numpy.asarray(found, float), numpy.asarray(wanted, float)
    same = found.shape == wanted.shape and numpy.allclose(found, wanted, rtol=tolerance, atol=tolerance,
                                                          equal_nan=True)
    expect(what, same, f"{found} is not {wanted}")


def rows(result, name):
    """The rows of a table as dictionaries; numbers where they are."""
    def value(cell):
        try:
            return float(cell)
        except ValueError:
            return cell
    with open(result.path(name), newline="", encoding="utf-8") as file:
        return [{key: value(cell) for key, cell in row.items()} for row in csv.DictReader(file)]


def at_step(table, step):
    return [row for row in table if row["step"] == step]


def wendland_c2(q, dim):
    """Wendland 1995, doi:10.1007/BF02123482; support 2 h."""
    if dim == 1:
        return numpy.where(q < 2, 5 / 8 * (1 - q / 2) ** 3 * (1.5 * q + 1), 0)
    norm = {2: 7 / (4 * math.pi), 3: 21 / (16 * math.pi)}[dim]
    return numpy.where(q < 2, norm * (1 - q / 2) ** 4 * (2 * q + 1), 0)


def images(x, v, low, high, sides):
    """The particles with all images of one layer; sides: of each axis "open", "periodic", "mirror", low and high.
    Also whose images they are."""
    which = numpy.arange(len(x))
    for axis, (a, b) in enumerate(sides):
        xs, vs, ws = [x], [v], [which]
        for side, place, sign in ((a, low[axis], -1), (b, high[axis], 1)):
            if side == "open":
                continue
            moved, turned = x.copy(), v.copy()
            if side == "periodic":
                moved[:, axis] += sign * (high[axis] - low[axis])
            else:
                moved[:, axis] = 2 * place - moved[:, axis]
                turned[:, axis] *= -1
            xs.append(moved), vs.append(turned), ws.append(which)
        x, v, which = numpy.concatenate(xs), numpy.concatenate(vs), numpy.concatenate(ws)
    return x, v, which


def interpolated(point, snapshot, names, low, high, sides, columns, plain=False):
    """Shepard's (or plain) values of columns(x, v, index) at a point, and sum V W."""
    index = numpy.flatnonzero(numpy.isin(snapshot["array"], [snapshot.names.index(name) for name in names]))
    dim = len(point)
    x, v, which = images(snapshot["x"][index, :dim], snapshot["v"][index, :dim], low, high, sides)
    which = index[which]
    h = snapshot["h"][which]
    w = wendland_c2(numpy.linalg.norm(x - point, axis=1) / h, dim) / h ** dim * snapshot["m"][which] / snapshot["rho"][which]
    total = w.sum()
    values = [(w * f).sum() for f in columns(x, v, which)]
    if not plain:
        values = [f / total if total >= 0.1 else math.nan for f in values]
    return values + [total]


# -- Points: two arrays, a free surface, periodic and mirror sides ---------------------------------

low, high = [0.0, 0.0], [1.0, 1.0]
sides = [["periodic", "periodic"], ["mirror", "open"]]
points = [[0.013, 0.011], [0.99, 0.3], [0.5, 0.31], [0.52, 0.598], [0.5, 0.64], [0.5, 0.8], [0.0, 0.0], [1.0, 0.2]]
fields = ["rho", "p", "v", "v.x", "v.y", "v.r", "v.phi", "x.x"]
center = [0.45, 0.2]
fill = {"lattice": "square", "spacing": 0.05, "jitter": 0.2}
block = {
    "title": "Block", "dimensions": 2, "plugins": ["kernels", "eos", "wcsph"], "kernel": "wendland-c2",
    "domain": {"min": low, "max": high, "sides": {"x": "periodic", "y": ["mirror", "open"]}},
    "materials": {"water": {"eos": {"name": "tait", "c0": 20, "rho0": 1}}},
    "particles": {
        name: {"material": "water", "fill": {**fill, "in": {"box": {"min": [x, 0], "max": [x + 0.5, 0.6]}}},
               "fields": {"rho": 1, "v": ["sin(2*pi*x) + y", "-y * (1 + x)"]}}
        for name, x in (("water", 0), ("oil", 0.5))},
    "scheme": {"name": "wcsph", "alpha": 0.1},
    "time": {"end": 0.03},
    "output": {"every": 0.01},
    "probes": [
        {"name": "both", "array": ["water", "oil"], "at": points, "of": fields, "center": center, "every": 0.01},
        {"name": "one", "array": "water", "at": points[2], "of": "p", "plain": True, "steps": 3, "expected": 2},
        {"name": "E k", "array": "water", "sum": "m", "every": 0.004, "where": "y < 0.3"},
        {"name": "highest", "array": "oil", "max": "v.r", "center": center},
    ],
    "profiles": [
        {"name": "line", "array": ["water", "oil"], "of": ["v.y"], "from": [0.1, 0.1], "to": [0.9, 0.5], "points": 9,
         "every": 0.02},
        {"name": "rings", "array": ["water", "oil"], "of": ["v.r", "rho"], "along": "r", "center": center, "bins": 7,
         "max": 0.35, "min": 0.05, "where": "y > 0.1", "every": 0.01},
        {"name": "columns", "array": "oil", "of": "p", "along": "x", "bins": 4},
    ],
}


def asked(snapshot):
    def columns(x, v, which):
        d = x - center
        r = numpy.linalg.norm(d, axis=1)
        return [snapshot["rho"][which], snapshot["p"][which], numpy.linalg.norm(v, axis=1), v[:, 0], v[:, 1],
                (v * d).sum(axis=1) / r, (v[:, 1] * d[:, 0] - v[:, 0] * d[:, 1]) / r, x[:, 0]]
    return columns


def binned(snapshot, index, at, columns, n, least, most):
    """Mean, standard deviation of each column and the number, in n bins."""
    volume = snapshot["m"][index] / snapshot["rho"][index]
    out = []
    for b in range(n):
        edge = least + (most - least) * b / n, least + (most - least) * (b + 1) / n
        here = (at >= edge[0]) & (at < edge[1])
        row = [0.5 * (edge[0] + edge[1])]
        for f in columns:
            mean = numpy.average(f[here], weights=volume[here]) if here.any() else math.nan
            row += [mean, math.sqrt(numpy.average((f[here] - mean) ** 2, weights=volume[here])) if here.any() else math.nan]
        out.append(row + [here.sum()])
    return out


for integrator in ("kdk", "pec"):
    scene = changed(block, time={"end": 0.03, "integrator": integrator})
    result = scenes.good(scene)
    summary = result.summary()
    snapshots = [Snapshot(path) for path in result.snapshots()]
    expect("snapshots", len(snapshots) == 4 and snapshots[-1].step > 12, [s.step for s in snapshots])
    both, line, rings = (rows(result, name) for name in ("probe_both.csv", "profile_line.csv", "profile_rings.csv"))
    expect("moments", sorted({row["step"] for row in both}) == [s.step for s in snapshots])
    for snapshot in snapshots:
        place = f"{integrator}, t = {snapshot.time}: "
        found = at_step(both, snapshot.step)
        expect(place + "points", len(found) == len(points))
        for point, row in zip(points, found):
            wanted = interpolated(point, snapshot, ["water", "oil"], low, high, sides, asked(snapshot))
            near(place + f"at {point}", [row[name] for name in [*fields, "sum"]], wanted, 1e-9)
            near(place + "coordinates", [row["x"], row["y"], row["time"]], [*point, snapshot.time], 0)
        expect(place + "nothing far above", math.isnan(found[5]["p"]) and found[5]["sum"] == 0)
        expect(place + "little above", found[4]["sum"] < 0.5, found[4]["sum"])
        # Across the periodic side the same; on the mirror nothing goes through.
        expect(place + "mirror", abs(found[6]["v.y"]) < 1e-12, found[6]["v.y"])
        index = numpy.flatnonzero(snapshot["x"][:, 1] > 0.1)
        d = snapshot["x"][index, :2] - center
        r = numpy.linalg.norm(d, axis=1)
        wanted = binned(snapshot, index, r, [(snapshot["v"][index, :2] * d).sum(axis=1) / r, snapshot["rho"][index]],
                        7, 0.05, 0.35)
        near(place + "rings", [[row[name] for name in ("r", "v.r", "v.r.std", "rho", "rho.std", "n")]
                               for row in at_step(rings, snapshot.step)], wanted, 1e-9)
    for snapshot in (snapshots[0], snapshots[2], snapshots[3]):
        found = at_step(line, snapshot.step)
        near("line", [row["s"] for row in found], numpy.linspace(0, math.hypot(0.8, 0.4), 9), 1e-14)
        wanted = [interpolated([row["x"], row["y"]], snapshot, ["water", "oil"], low, high, sides,
                               lambda x, v, which: [v[:, 1]]) for row in found]
        near("values on a line", [[row["v.y"], row["sum"]] for row in found], wanted, 1e-9)
    last = snapshots[-1]
    oil = numpy.flatnonzero(last["array"] == last.names.index("oil"))
    near("columns", [[row[name] for name in ("x", "p", "p.std", "n")] for row in
                     at_step(rows(result, "profile_columns.csv"), last.step)],
         binned(last, oil, last["x"][oil, 0], [last["p"][oil]], 4, 0, 1), 1e-9)
    one = rows(result, "probe_one.csv")
    expect("every third step", [row["step"] for row in one]
           == sorted({*range(0, last.step, 3), last.step}), [row["step"] for row in one])
    near("plain", [one[-1]["p"], one[-1]["sum"]],
         interpolated(points[2], last, ["water"], low, high, sides, lambda x, v, which: [last["p"][which]], True), 1e-9)
    near("value", summary["probes"]["one"]["value"], one[-1]["p"], LAST_BIT)
    near("values", summary["probes"]["one"]["values"]["sum"], one[-1]["sum"], LAST_BIT)
    expect("files", summary["probes"]["both"]["file"] == "probe_both.csv" and summary["probes"]["both"]["rows"] == len(both)
           and summary["probes"]["one"]["expected"] == 2, summary["probes"])
    near("several values", summary["probes"]["both"]["values"]["v.phi"][:3],
         [row["v.phi"] for row in both[-len(points):]][:3], LAST_BIT)
    expect("NaN is null", summary["probes"]["both"]["values"]["p"][5] is None)
    expect("profiles", summary["profiles"]["line"] == {"file": "profile_line.csv", "rows": 27}, summary["profiles"])
    # A sum in a region; its moments are the first steps at or after them.
    sums = rows(result, "probe_E_k.csv")
    times = [row[1] for row in result.log()[1]]
    wanted = [0.0] + [min(t for t in times if t >= 0.004 * k * (1 - 1e-9)) for k in range(1, 8)] + [last.time]
    near("moments between steps", [row["time"] for row in sums], wanted, 0)
    low_water = (last["array"] == last.names.index("water")) & (last["x"][:, 1] < 0.3)
    near("sum", sums[-1]["value"], last["m"][low_water].sum())
    d = last["x"][oil, :2] - center
    near("largest v.r", summary["probes"]["highest"]["value"],
         ((last["v"][oil, :2] * d).sum(axis=1) / numpy.linalg.norm(d, axis=1)).max())

    # Nothing of the run is changed, and any number of threads gives the same rows.
    bare = scenes.good({key: value for key, value in scene.items() if key not in ("probes", "profiles")})
    expect("as many steps", bare.summary()["steps"] == summary["steps"])
    for a, b in zip(bare.snapshots(), result.snapshots()):
        a, b = Snapshot(a), Snapshot(b)
        expect("same bits", all(numpy.array_equal(a[name], b[name], equal_nan=True) for name in a.column), integrator)
    parallel = scenes.good(scene, "--threads", "2")
    for name in ("probe_both.csv", "probe_one.csv", "probe_E_k.csv", "profile_line.csv", "profile_rings.csv"):
        with open(result.path(name), "rb") as a, open(parallel.path(name), "rb") as b:
            expect(f"{name} with two threads", a.read() == b.read(), integrator)

# -- Profiles beside their references ----------------------------------------------------------------

table = {"r": [0.0, 0.1, 0.4, 0.8], "dens": [16.0, 12.0, 2.0, 1.0], "v.r": [0.0, -0.5, -1.0, -0.8]}
scene = changed(example("noh.json"), compare=[], probes=[], time={"end": 0.1}, profiles=[
    {"name": "line", "array": "fluid", "of": ["rho", "h", "v.x", "v.r"], "from": [-0.5, 0], "to": [0.3, 0.4], "points": 5,
     "every": 0.05, "reference": {"exact": "noh"}},
    {"name": "falls", "array": "fluid", "of": ["v", "rho"], "along": "x", "center": [0, 0.3], "bins": 8, "max": 0.8, "min": -0.4,
     "reference": {"exact": "noh", "v0": 2}},
    {"name": "rings", "array": "fluid", "of": ["v.r", "u", "rho"], "along": "r", "center": [0.1, 0], "bins": 5, "max": 1,
     "reference": {"table": table, "fields": {"rho": "dens"}}},
    {"name": "along", "array": "fluid", "of": ["v.r", "rho"], "from": [0, 0], "to": [0.8, 0.8], "points": 9,
     "reference": {"table": table, "along": "r"}}])
scene["particles"]["fluid"]["fill"]["spacing"] = 0.1
result = scenes.good(scene)
bare = scenes.good(changed(scene, profiles=[]))
expect("references change no bit", all(
    numpy.array_equal(Snapshot(a)[name], Snapshot(b)[name]) for a, b in zip(bare.snapshots(), result.snapshots())
    for name in Snapshot(a).column))


def noh(x, time, v0=1.0, gamma=5 / 3):
    """Noh 1987: density, velocity in the plane."""
    r = math.hypot(*x)
    if r < (gamma - 1) / 2 * v0 * time:
        return ((gamma + 1) / (gamma - 1)) ** 2, numpy.zeros(2)
    return (1 + v0 * time / r, -v0 * numpy.array(x) / r) if r > 0 else (1.0, numpy.zeros(2))


line = rows(result, "profile_line.csv")
expect("columns of a line", list(line[0]) == ["step", "time", "s", "x", "y", "rho", "h", "v.x", "v.r", "sum", "rho.ref",
                                              "v.x.ref", "v.r.ref"], list(line[0]))
expect("rows of a line", len({row["time"] for row in line}) == 3, len(line))
for row in line:
    rho, v = noh((row["x"], row["y"]), row["time"])
    r = math.hypot(row["x"], row["y"])
    near("the exact solution on a line", [row["rho.ref"], row["v.x.ref"], row["v.r.ref"]],
         [rho, v[0], (v[0] * row["x"] + v[1] * row["y"]) / r if r > 0 else 0], 1e-12)
for row in rows(result, "profile_falls.csv"):
    rho, v = noh((row["x"], 0.3), row["time"], 2.0)
    near("the exact solution in bins", [row["v.ref"], row["rho.ref"]], [math.hypot(*v), rho], 1e-12)
rings, along = rows(result, "profile_rings.csv"), rows(result, "profile_along.csv")
expect("columns of rings", list(rings[0])[-2:] == ["n", "rho.ref"] and "v.r.ref" not in rings[0], list(rings[0]))
expect("columns along", list(along[0])[-2:] == ["sum", "v.r.ref"], list(along[0]))
near("a table in bins", [row["rho.ref"] for row in rings],
     [numpy.interp(row["r"], table["r"], table["dens"]) if row["r"] < 0.8 else math.nan for row in rings], 1e-12)
near("a table on a line", [row["v.r.ref"] for row in along],
     [numpy.interp(row["s"], table["r"], table["v.r"], right=math.nan) for row in along], 1e-12)
# -- Whether somebody looks after each step or not: what is held in floats is the same -----------------

for precision, integrator in itertools.product(("mixed", "single"), ("kdk", "dkd", "verlet2", "rk4")):
    tube = changed(example("sod.json"), time={"end": 0.2, "steps": 40, "integrator": integrator},
                   output={"log": {"steps": 1000}}, probes=[], compare=[])
    states = []
    for scene in (tube, {**tube, "probes": [{"name": "u", "array": "fluid", "mean": "u", "steps": 1}]},
                  changed(tube, output={"log": {"steps": 1}})):
        states.append(Snapshot(scenes.good(scene, "--precision", precision).snapshots()[-1]))
    for what, state in zip(("probes", "rows of the log"), states[1:]):
        differ = [name for name in state.column if not numpy.array_equal(states[0][name], state[name], equal_nan=True)]
        expect(f"{what} change no bit", not differ, f"{precision}, {integrator}: {differ}")

# -- Tables: along r, components, a region, what is beyond the ends ---------------------------------

radii = numpy.linspace(0.0, 0.8, 17)
table = numpy.column_stack([radii, 4 + 3 * radii, -numpy.cos(radii), 0.1 * radii])
path = os.path.join(scenes.scratch.name, "ref.csv")
numpy.savetxt(path, table, delimiter=",", header="r,density,u,v.phi", comments="")
noh = example("noh.json")
noh["particles"]["fluid"]["fill"]["spacing"] = 0.1
noh["time"] = {"end": 0.1}
noh["output"] = {"every": 0.025}
noh.pop("probes", None)
noh["compare"] = [
    {"array": "fluid", "table": "ref.csv", "along": "r", "fields": {"rho": "density", "v.r": "u", "v.phi": "v.phi"},
     "where": "x > 0", "every": 0.05},
    {"array": "fluid", "table": {"x": [-0.5, 0.25], "rho": [1, 2]}, "time": 0.025},
    {"array": "fluid", "exact": "noh", "where": "r < 0.45", "fields": ["rho", "v.y"], "at": [0, 0.05, 0.075]},
]
result = scenes.good(noh)
summary = result.summary()
errors = rows(result, "errors.csv")
snapshots = [Snapshot(path) for path in result.snapshots()]


def norms(volume, difference, reference):
    d, s = numpy.abs(difference), numpy.abs(reference)
    return [(volume * d).sum() / volume.sum(), (volume * d).sum() / (volume * s).sum(),
            math.sqrt((volume * d ** 2).sum() / volume.sum()),
            math.sqrt((volume * d ** 2).sum() / (volume * s ** 2).sum()), d.max(), len(d)]


NORMS = ["l1", "l1_rel", "l2", "l2_rel", "linf", "n"]


def errors_at(step, field, reference):
    found = [row for row in errors if row["step"] == step and row["field"] == field and row["reference"] == reference]
    expect(f"one row of {field} against {reference} at step {step}", len(found) == 1, found)
    return found[0]


for snapshot in (snapshots[2], snapshots[4]):
    x, v = snapshot["x"][:, :2], snapshot["v"][:, :2]
    r = numpy.linalg.norm(x, axis=1)
    half, volume = x[:, 0] > 0, snapshot["m"] / snapshot["rho"]
    inside = half & (r <= 0.8)
    values = {"rho": (snapshot["rho"], 1), "v.r": ((v * x).sum(axis=1) / r, 2),
              "v.phi": ((v[:, 1] * x[:, 0] - v[:, 0] * x[:, 1]) / r, 3)}
    for field, (value, column) in values.items():
        star = numpy.interp(r, radii, table[:, column])
        row = errors_at(snapshot.step, field, "ref.csv")
        wanted = norms(volume[inside], (value - star)[inside], star[inside])
        near(f"table, {field}, t = {snapshot.time}", [row[name] for name in NORMS], wanted)
        expect("which comparison", row["compare"] == 0 and row["array"] == "fluid", row)
        expect("beyond the ends", row["outside"] == (half & (r > 0.8)).sum() > 0, row)
        if snapshot is snapshots[4]:
            end = summary["errors"]["fluid." + field]
            near(f"summary, {field}", [end[name] for name in NORMS], wanted)
            worst = x[inside][numpy.abs(value - star)[inside].argmax()]
            near("where it is largest", numpy.abs(end["linf_at"]), numpy.abs(worst))
            near("and in its row", [row["linf_x"], row["linf_y"]], end["linf_at"], LAST_BIT)
            expect("reference", end["reference"] == "ref.csv" and "time" not in end, end)

timed = summary["errors"]["fluid.rho@scene"]
snapshot = snapshots[1]
x = snapshot["x"][:, 0]
inside = (x >= -0.5) & (x <= 0.25)
star = numpy.interp(x, [-0.5, 0.25], [1, 2])
wanted = norms((snapshot["m"] / snapshot["rho"])[inside], (snapshot["rho"] - star)[inside], star[inside])
near("a table for one time", [timed[name] for name in NORMS], wanted)
expect("its time", timed["time"] == 0.025 and timed["outside"] == (~inside).sum(), timed)
expect("once", len([row for row in errors if row["reference"] == "scene"]) == 1)

# Noh's exact solution in the outer part: rho = 1 + t / r, v = -e_r.
for snapshot in (snapshots[2], snapshots[3], snapshots[4]):
    x, v = snapshot["x"][:, :2], snapshot["v"][:, :2]
    r = numpy.linalg.norm(x, axis=1)
    inside, volume = r < 0.45, snapshot["m"] / snapshot["rho"]
    shocked = r < snapshot.time / 3
    rho = numpy.where(shocked, 16, 1 + snapshot.time / r)
    vy = numpy.where(shocked, 0, -x[:, 1] / r)
    for field, value, star in (("rho", snapshot["rho"], rho), ("v.y", v[:, 1], vy)):
        row = errors_at(snapshot.step, field, "noh")
        near(f"exact, {field}, t = {snapshot.time}", [row[name] for name in NORMS],
             norms(volume[inside], (value - star)[inside], star[inside]), 1e-9)
expect("at the start", errors_at(0, "rho", "noh")["time"] == 0)
expect("errors.csv holds these rows", len(errors) == 2 * 3 + 1 + 4 * 2, len(errors))

# -- A course in time against a reference ----------------------------------------------------------

numpy.savetxt(os.path.join(scenes.scratch.name, "course.csv"),
              [[-10, 0, 0.9], [10, 0, 1.3], [35, 0, 2.2], [70, 0, 2.0]], delimiter=",", header="ms,none,bar", comments="")
noh["compare"] = []
noh["probes"] = [
    {"name": "P", "array": "fluid", "at": [0.2, 0.1], "of": ["p", "rho"], "steps": 2,
     "reference": {"table": "course.csv", "of": "rho", "time": "ms", "value": "bar", "scale_time": 1e-3, "scale": 1.5}},
    {"name": "mean", "array": "fluid", "mean": "rho", "every": 0.03, "where": "r < 0.5",
     "reference": {"table": {"t": [0, 0.2], "v": [1, 1.4]}}},
]
result = scenes.good(noh)
summary = result.summary()


def course(t, f, at, star):
    begin, end = max(t[0], at[0]), min(t[-1], at[-1])
    both = numpy.unique(numpy.concatenate([t, at]))
    both = numpy.unique(numpy.concatenate([[begin], both[(both > begin) & (both < end)], [end]]))
    s = numpy.interp(both, at, star)
    d = numpy.abs(numpy.interp(both, t, f) - s)
    area = lambda y: ((y[1:] + y[:-1]) * numpy.diff(both)).sum() / 2
    return [begin, end, area(d) / (end - begin), area(d) / area(s), math.sqrt(area(d ** 2) / (end - begin)),
            math.sqrt(area(d ** 2) / area(s ** 2)), d.max()]


for name, column, at, star in (("P", "rho", [-0.01, 0.01, 0.035, 0.07], [1.35, 1.95, 3.3, 3.0]),
                               ("mean", "value", [0, 0.2], [1, 1.4])):
    found = rows(result, f"probe_{name}.csv")
    wanted = course([row["time"] for row in found], [row[column] for row in found], at, star)
    of = summary["probes"][name]["reference"]
    near(f"course of {name}", [of[key] for key in ("begin", "end", "l1", "l1_rel", "l2", "l2_rel", "linf")], wanted)
expect("its reference", summary["probes"]["P"]["reference"]["reference"] == "course.csv")

# -- Three dimensions: about an axis; mirrors on all sides -----------------------------------------

cube = {
    "title": "Cube", "dimensions": 3, "plugins": ["kernels", "eos", "wcsph"], "kernel": "wendland-c2",
    "domain": {"min": [0, 0, 0], "max": [1, 1, 1], "sides": {"x": "mirror", "y": "mirror", "z": ["mirror", "mirror"]}},
    "materials": {"water": {"eos": {"name": "tait", "c0": 20, "rho0": 1}}},
    "particles": {"water": {"material": "water", "fill": {"lattice": "square", "spacing": 0.125, "jitter": 0.1},
                            "fields": {"rho": 1, "v": ["z - 0.5", "y * (1 - y)", "0.5 - x"]}}},
    "scheme": {"name": "wcsph"},
    "time": {"end": 0.004},
    "probes": [{"name": "corner", "array": "water", "at": [[0.02, 0.97, 0.03], [0.3, 0.4, 0.5]],
                "of": ["v.x", "v.y", "v.z", "v.phi"], "center": [0.5, 0.5, 0.5], "axis": "y"}],
    "profiles": [{"name": "turn", "array": "water", "of": ["v.phi", "v.r"], "along": "r", "axis": "y",
                  "center": [0.5, 0.5, 0.5], "bins": 3, "max": 0.6}],
}
result = scenes.good(cube)
last = result.last()
x, v = last["x"], last["v"]


def about(x, v):
    d = (x - 0.5) * [1, 0, 1]
    r = numpy.linalg.norm(d, axis=1)
    return r, (v[:, 0] * d[:, 2] - v[:, 2] * d[:, 0]) / r, (v * d).sum(axis=1) / r


for row, point in zip(at_step(rows(result, "probe_corner.csv"), last.step), cube["probes"][0]["at"]):
    wanted = interpolated(numpy.array(point), last, ["water"], [0] * 3, [1] * 3, [["mirror"] * 2] * 3,
                          lambda x, v, which: [v[:, 0], v[:, 1], v[:, 2], about(x, v)[1]])
    near(f"3D, {point}", [row[name] for name in ("v.x", "v.y", "v.z", "v.phi", "sum")], wanted, 1e-9)
r, phi, radial = about(x, v)
near("about an axis", [[row[name] for name in ("r", "v.phi", "v.phi.std", "v.r", "v.r.std", "n")]
                       for row in at_step(rows(result, "profile_turn.csv"), last.step)],
     binned(last, numpy.arange(len(x)), r, [phi, radial], 3, 0, 0.6), 1e-9)
expect("it turns", phi.mean() > 0.1, phi.mean())

# -- Files: an earlier run's are taken away, others are not ----------------------------------------

again = scenes.command("run", scenes.write(changed(cube, probes=[], profiles=[])), "--out", result.out, "--quiet")
expect("again", again.returncode == 0 and not result.has("probe_corner.csv") and not result.has("profile_turn.csv"),
       again.stderr)
with open(result.path("probe_corner.csv"), "w", encoding="utf-8") as file:
    file.write("my,own\n")
again = scenes.command("run", scenes.write(cube), "--out", result.out, "--quiet")
expect("somebody else's", again.returncode == 2 and "probe_corner.csv is not of an earlier run" in again.stderr, again.stderr)

scenes.end()

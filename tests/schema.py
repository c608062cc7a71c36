#!/usr/bin/env python3
"""examples/scene.schema.json against every example, against scenes that are wrong, and against the keys
that core/scene knows: whoever adds a key to one must add it to the other."""
import copy
import glob
import json
import os
import re
import sys

try:
    import jsonschema
except ImportError:
    print("no jsonschema (Debian: python3-jsonschema)")
    sys.exit(77)

top = os.environ.get("top_srcdir") or os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")

with open(os.path.join(top, "examples/scene.schema.json"), encoding="utf-8") as file:
    schema = json.load(file)
jsonschema.Draft7Validator.check_schema(schema)
validator = jsonschema.Draft7Validator(schema)
failures = 0


def check(good, what):
    global failures
    if not good:
        failures += 1
        print("FAILED:", what)


# Every example is a scene.
examples = [p for p in sorted(glob.glob(os.path.join(top, "examples/*.json")))
            if not p.endswith((".schema.json", ".chart.json"))]
check(len(examples) >= 5, "examples are found")
for path in examples:
    with open(path, encoding="utf-8") as file:
        scene = json.load(file)
    for error in validator.iter_errors(scene):
        check(False, f"{path}: /{'/'.join(map(str, error.absolute_path))}: {error.message}")

# A scene with everything in it, and what makes it wrong.
whole = {
    "//": "why",
    "title": "T", "dimensions": 2, "plugins": ["a"], "units": "SI",
    "domain": {"min": [0, 0], "max": [1, 1], "sides": {"x": "periodic", "y": ["mirror", "open"]}},
    "materials": {"gas": {"eos": {"name": "some", "gamma": 1.4}}, "water": {"eos": "stiff"}},
    "particles": {
        "fluid": {
            "material": "gas", "h_over_dx": 1.5,
            "fill": [
                {"lattice": "square", "spacing": 0.1, "jitter": 0.2, "seed": 7, "fields": {"u": 2},
                 "in": {"difference": [{"box": {"min": [0, 0], "max": [1, 1]}},
                                       {"sphere": {"center": [0, 0], "radius": 1}}]}},
                {"glass": {"sweeps": 5, "noise": 0.1}, "count": 100},
                {"file": "a.csv", "rename": {"X": "x"}, "spacing": 0.1}],
            "fields": {"rho": 1, "v": ["-x/r", 0]},
            "columns": {"label": {"type": "int32", "value": "x > 0"}, "tracer": 1, "drift": [0, 1]}}},
    "boundaries": [{"name": "b", "array": "fluid", "with": ["fluid"], "on": "wall",
                    "path": {"t": [0, 1], "x": [0, 2]}}],
    "functions": [
        {"name": "pair", "doc": "d", "source": "s", "shape": "pair", "dimensions": [2, 3], "body": "a.h", "prelude": "b.h",
         "i": ["v", "rho"], "j": {"mass": "m"}, "sum": "a", "min": "q", "max": ["s"], "reach": "gather", "self": True,
         "reach_scale": 1.5, "floats": True, "before": {"body": "c.h", "out": "q"},
         "after": {"body": "d.h", "prelude": "b.h", "in": "q", "inout": ["a"], "fail": ["no"]},
         "properties": {"q": "scalar", "s": {"type": "scalar", "unit": "m", "doc": "d", "start": 0, "work": True}},
         "parameters": {"k": 0.1, "e": {"default": 1, "min": 0, "max": 2, "unit": "s", "doc": "d"}},
         "rates": {"v": "a", "X": {"rate": "V", "kind": "drift"}},
         "reductions": {"dt": {"min": "q", "use": "time-step"}, "n": {"sum": "s"}}},
        {"name": "point", "shape": "point", "body": "e.h", "sum": "a", "parameters": {"g": 9.81}, "fail": "no"},
        {"name": "other", "body": "e.h", "in": "q", "out": {"r": "s"}}],
    "scheme": {"name": "s", "alpha": 1, "edit": [
        {"insert": "f", "before": "g", "alpha": 2}, {"delete": "d"}, {"replace": "r", "with": "w"},
        {"operation": "summation", "function": "f", "of": "rho", "to": ["fluid"], "at": "finish"},
        {"operation": "assignment", "of": "label", "expression": "x > 0", "after": "g"}]},
    "kernel": {"name": "k"}, "limits": {"particles": 1000}, "neighbours": {"skin": 0.2},
    "watch": {"not-finite": "stop", "density": "count", "internal-energy": False,
              "escaped": {"action": "count", "margin": 1, "where": "r < 2"},
              "time-step": {"below": 1e-9}, "energy": {"action": "stop", "above": 5, "scale": 2},
              "neighbours": {"above": 300}},
    "time": {"integrator": "kdk", "begin": 0, "end": 2, "cfl": 0.3, "dt_max": 0.1, "steps": 9},
    "compare": [{"array": "fluid", "exact": "e", "where": "r < 1", "fields": ["rho"], "gamma": 1.4},
                {"array": "fluid", "table": "a.csv", "along": "r", "center": [0, 1], "fields": {"v.r": "u"},
                 "every": 0.1},
                {"array": "fluid", "table": {"x": [0, 1], "rho": [1, 2]}, "time": 0.1}],
    "probes": [{"name": "a", "array": "fluid", "mean": "rho", "expected": 16},
               {"name": "b", "array": "fluid", "crossing": {"of": "rho", "shell": 0.1, "level": 1}},
               {"name": "c", "array": ["fluid"], "at": [[0, 0], [1, 1]], "of": "p", "steps": 3, "plain": True},
               {"name": "d", "array": "fluid", "sum": "m", "every": 1,
                "reference": {"table": "p.csv", "time": "t", "value": "v", "scale": 2}}],
    "profiles": [{"name": "l", "array": "fluid", "of": ["rho", "v.x"], "from": [0, 0], "to": [1, 1], "points": 11,
                  "reference": {"table": "a.csv", "along": "r", "fields": {"rho": "density"}}},
                 {"name": "b", "array": "fluid", "of": "rho", "along": "r", "bins": 5, "max": 1, "every": 0.1,
                  "reference": {"exact": "e", "gamma": 1.4}},
                 {"name": "t", "array": "fluid", "of": "rho", "along": "x",
                  "reference": {"table": {"x": [0, 1], "rho": [1, 2]}}}],
    "output": {"every": 0.1, "log": {"steps": 10}, "checkpoint": {"steps": 50, "keep": 3}, "picture": {"field": "rho", "min": 0, "max": 1}},
}
for error in validator.iter_errors(whole):
    check(False, f"the whole scene: /{'/'.join(map(str, error.absolute_path))}: {error.message}")

ABSENT = object()
wrong = [
    ("titel", "T"), ("dimensions", ABSENT), ("dimensions", 4), ("dimensions", "2"),
    ("units", "metric"), ("particles", {}), ("particles", ABSENT), ("scheme", ABSENT), ("time", {}),
    ("time.end", "soon"), ("time.ende", 1), ("time.cfl", 0), ("domain.min", 0),
    ("watch", "off"), ("watch.density", "ignore"), ("watch.densty", "stop"), ("watch.not-finite", "off"),
    ("watch.escaped.margin", 0), ("watch.escaped.wher", "x"), ("watch.time-step.below", 1),
    ("watch.energy.action", "halt"), ("watch.neighbours.above", "many"),
    ("domain.sides.x", "perodic"), ("domain.sides.y", ["open"]), ("domain.sides.w", "open"),
    ("materials.gas.eos", {"gamma": 1.4}), ("materials.gas.eso", 1), ("particles.fluid.fill", ABSENT),
    ("particles.fluid.fill", []), ("particles.fluid.fill.0.spacing", -0.1),
    ("particles.fluid.fill.0.spacing", "fine"), ("particles.fluid.fill.0.count", 5),
    ("particles.fluid.fill.0.lattice", "sqare"), ("particles.fluid.fill.0.glass", {}),
    ("particles.fluid.fill.0.jitter", 3), ("particles.fluid.fill.1.jitter", 0.1),
    ("particles.fluid.fill.1.glass.sweeps", 0), ("particles.fluid.fill.0.in", {"bax": {}}),
    ("particles.fluid.fill.0.in.difference", []), ("particles.fluid.fields.rho", True),
    ("particles.fluid.fields.rho", ""), ("particles.fluid.columns.label.type", "int"),
    ("particles.fluid.h_over_dx", 0), ("boundaries", [{}]), ("scheme.edit.0.delete", "x"),
    ("functions", {}), ("functions.0.body", ABSENT), ("functions.0.name", "Pair"), ("functions.0.in", "q"),
    ("functions.0.shape", "point"), ("functions.0.dimensions", [4]), ("functions.0.reach", "far"), ("functions.0.self", 1),
    ("functions.0.before.i", "v"), ("functions.0.after.body", ABSENT), ("functions.0.properties.q", "number"),
    ("functions.0.properties.s.typ", "scalar"), ("functions.0.parameters.k", "much"), ("functions.0.parameters.e.least", 0),
    ("functions.0.rates.v", 3), ("functions.0.rates.X.rate", ABSENT), ("functions.0.reductions.dt.max", "q"),
    ("functions.0.reductions.dt.use", "step"), ("functions.1.shape", "pair"), ("functions.1.j", "m"), ("functions.2.reach", "gather"),
    ("scheme.edit.3.operation", "sum"), ("scheme.edit.3.at", "end"), ("scheme.edit.0.after", "x"),
    ("scheme.alpha", [1]), ("kernel.name", 1), ("limits.particles", 0), ("neighbours.skin", -1),
    ("compare.0.exact", ABSENT), ("probes.0.min", "rho"), ("probes.0.mean", ABSENT),
    ("compare.1.table", ABSENT), ("compare.1.exact", "e"), ("compare.1.along", "s"),
    ("compare.2.every", 1), ("compare.2.table.x", []), ("probes.2.of", ABSENT), ("probes.2.where", "x > 0"),
    ("probes.2.every", 1), ("probes.0.plain", True), ("probes.3.every", ABSENT), ("probes.3.reference.tabel", "t"),
    ("profiles.0.to", ABSENT), ("profiles.0.bins", 3), ("profiles.0.points", 1), ("profiles.1.along", ABSENT),
    ("profiles.0.reference.exact", "e"), ("profiles.0.reference.along", "s"), ("profiles.2.reference.along", "x"),
    ("profiles.1.reference.exact", ABSENT), ("profiles.1.reference.gamma", []), ("profiles.2.reference.fields", 3),
    ("profiles.1.plain", True), ("profiles.1.bins", 0), ("profiles.1.steps", 3),
    ("probes.1.crossing.shell", 0), ("output.every", 0), ("output.log.every", 1),
    ("output.picture.max", ABSENT), ("output.picture.map", "blue"), ("output.checkpiont", {}),
    ("output.checkpoint.every", 1), ("output.checkpoint.steps", 0), ("output.checkpoint.keep", 0),
]
for path, value in wrong:
    scene = copy.deepcopy(whole)
    *way, last = [int(p) if p.isdigit() else p for p in path.split(".")]
    at = scene
    for step in way:
        at = at[step]
    if value is ABSENT:
        del at[last]
    else:
        at[last] = value
    check(not validator.is_valid(scene), f"taken: {path} = {value!r}")

# The keys of the program: arrays of texts called ...keys, by the function that they stand in.
known = {}
for path in sorted(glob.glob(os.path.join(top, "core/scene/sc*.c")) + [os.path.join(top, "core/scene/shape.c")]):
    function = ""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    for match in re.finditer(r"^(?:static )?int (\w+)\(|(\w*keys)\[\] = \{([^}]*)\}", text, re.M):
        if match[1]:
            function = match[1]
        else:
            name = f"{os.path.basename(path)}:{function}:{match[2]}"
            known[name] = set(re.findall(r'"([^"]+)"', match[3]))

definitions = schema["definitions"]


def keys(*way):
    at = schema
    for step in way:
        at = at[step]
    return set(at["properties"])


def definition(name, *way):
    return keys("definitions", name, *way)


def watch_keys(cause):
    return keys("properties", "watch", "anyOf", 1, "properties", cause, "anyOf", 1)


fills = definition("lattice") | definition("glass") | definition("file")
expected = {
    "scene.c:compile:keys": keys(),
    "scene.c:compile_domain:keys": definition("domain"),
    "scene.c:compile_material:keys": definition("material"),
    "scene.c:compile_material:eos_keys": definition("named"),
    "scene.c:compile_boundaries:keys": keys("properties", "boundaries", "items"),
    "scene.c:compile_limits:keys": keys("properties", "limits"),
    "scene.c:compile_kernel:keys": keys("properties", "kernel", "anyOf", 1),
    "scene.c:compile_neighbours:keys": keys("properties", "neighbours"),
    "scene.c:compile_ranks:keys": keys("properties", "ranks"),
    "scene_particles.c:compile_array:keys": definition("array"),
    "scene_particles.c:compile_column:keys": definition("column", "anyOf", 1),
    "scene_fill.c:scene_fill:lattice_keys": definition("lattice"),
    "scene_fill.c:scene_fill:glass_keys": definition("glass"),
    "scene_fill.c:scene_fill:file_keys": definition("file"),
    "scene_fill.c:scene_fill:all_keys": fills,
    "scene_fill.c:compile_glass:keys": definition("glass", "properties", "glass"),
    "scene_scheme.c::edit_keys": definition("edit"),
    "scene_scheme.c:compile_verb:keys": {"delete"},
    "scene_scheme.c:scene_scheme:keys": definition("scheme", "anyOf", 1),
    "scene_output.c:scene_time:keys": definition("time"),
    "scene_measure.c:compile_exact:keys": definition("compare_exact"),
    "scene_measure.c:compile_table:keys": definition("compare_table"),
    "scene_measure.c:compile_crossing:keys": definition("probe", "properties", "crossing"),
    "scene_measure.c:compile_probe:keys": definition("probe"),
    "scene_measure.c:compile_profile:line_keys": definition("line"),
    "scene_measure.c:compile_profile:bin_keys": definition("bins"),
    "scene_measure.c:compile_reference:exact_keys": definition("reference_exact"),
    "scene_measure.c:compile_reference:line_keys": definition("reference_line"),
    "scene_measure.c:compile_reference:bin_keys": definition("reference_bins"),
    "scene_sample.c:scene_reference:keys": definition("probe", "properties", "reference"),
    "scene_output.c:compile_log:keys": definition("output", "properties", "log"),
    "scene_output.c:compile_checkpoint:keys": definition("output", "properties", "checkpoint"),
    "scene_output.c:compile_picture:keys": definition("picture"),
    "scene_output.c:scene_output:keys": definition("output"),
    "scene_watch.c::watch_keys": keys("properties", "watch", "anyOf", 1),
    "scene_watch.c:check_keys:keys": definition("watch-as"),
    "scene_watch.c:check_keys:escaped_keys": watch_keys("escaped"),
    "scene_watch.c:check_keys:time_step_keys": watch_keys("time-step"),
    "scene_watch.c:check_keys:energy_keys": watch_keys("energy"),
    "scene_watch.c:check_keys:neighbours_keys": watch_keys("neighbours"),
    "scene_functions.c:compile_point:keys": definition("point_body"),
    "scene_functions.c:check_keys:pair_keys": definition("pair_function"),
    "scene_functions.c:check_keys:point_keys": definition("point_function"),
    "scene_declared.c:compile_property:keys": definition("property", "anyOf", 1),
    "scene_declared.c:compile_parameter:keys": definition("own_parameter", "anyOf", 1),
    "scene_declared.c:compile_rate:keys": definition("rate", "anyOf", 1),
    "scene_declared.c:compile_reduction:keys": definition("reduction"),
    "shape.c:compile_box:keys": definition("shape", "properties", "box"),
    "shape.c:compile_sphere:keys": definition("shape", "properties", "sphere"),
    "shape.c:compile_cylinder:keys": definition("shape", "properties", "cylinder"),
    "shape.c:compile_half_space:keys": definition("shape", "properties", "half-space"),
}
for name, found in known.items():
    if name not in expected:
        check(False, f"{name}: which part of the schema is this? tests/schema.py does not know")
    else:
        check(found == expected[name],
              f"{name}: only the program knows {sorted(found - expected[name])}, "
              f"only the schema {sorted(expected[name] - found)}")
for name, wanted in expected.items():
    if name not in known:
        check(False, f"{name}: not found in core/scene")

# The integrators: those of the program, in the schema and in the manual.
with open(os.path.join(top, "core/integrators/integrator.c"), encoding="utf-8") as file:
    found = re.findall(r"&integrator_(\w+)", re.search(r"all\[\] = \{([^}]*)\}", file.read())[1])
names = [name.replace("_", "-") for name in found]
with open(os.path.join(top, "man/sph-scene.5"), encoding="utf-8") as file:
    page = file.read()
check(names == definitions["time"]["properties"]["integrator"]["enum"], f"integrators are {names}")
for name in names:
    check(f".Cm {name}" in page, f"sph-scene.5 does not name the integrator {name}")

print(f"{len(examples)} examples, {len(wrong)} wrong scenes, {len(known)} sets of keys")
sys.exit(1 if failures else 0)

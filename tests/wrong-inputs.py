#!/usr/bin/env python3
"""Wrong inputs: each is answered by one sentence on stderr that names the place, by the right exit status,
and leaves nothing half written. The scenes are files in tests/wrong-inputs, or its base.json with one
change; the program is $SPH (default build/sph)."""
import contextlib
import fcntl
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile

here = os.path.dirname(os.path.abspath(__file__))
top = os.environ.get("top_srcdir") or os.path.join(here, "..")
folder = os.path.join(top, "tests", "wrong-inputs")
sph = os.path.abspath(os.environ.get("SPH") or os.path.join(top, "build", "sph"))
if "SPH_PLUGIN_PATH" not in os.environ:
    os.environ["SPH_PLUGIN_PATH"] = os.path.join(os.path.dirname(sph), "plugins", ".libs")
with open(os.path.join(folder, "base.json"), encoding="utf-8") as file:
    base = file.read()

DONE, RUN, USAGE, REFUSED = 0, 1, 2, 3
cases = []


def case(name, arguments, code, *parts, **more):
    """Runs sph with `arguments` in a fresh folder; every part stands in the sentence."""
    cases.append((name, arguments, code, parts, more))


def text(name, place, *parts):
    """A file of tests/wrong-inputs, checked; `place` is line:column."""
    case(name, ["check", name], USAGE, f"sph: {name}:{place}: ", *parts, copy=[name])


def change(old, new, *parts, code=USAGE, without="", **more):
    """base.json with new in place of old (and without `without`), as scene.json; "@" in new is left out: there
    the message points."""
    assert base.count(old) == 1, f"{old!r} stands in base.json {base.count(old)} times"
    scene = base.replace(old, new)
    if without:
        scene = scene.replace(without, "")
    at = scene.find("@")
    place = ()
    if at >= 0:
        scene = scene.replace("@", "")
        line = scene.count("\n", 0, at) + 1
        place = (f"scene.json:{line}:{at - scene.rfind(chr(10), 0, at)}: ",)
    case(f"{old} -> {new}", ["check", "scene.json"], code, *place, *parts, scene=scene, **more)


def fill(new, *parts, **more):
    change('"fill": {"lattice": "square", "spacing": 0.02}', '"fill": ' + new, *parts, **more)


# -- Texts that are no scene ---------------------------------------------------------------------

text("empty.json", "1:1", "the text is empty")
text("blank.json", "3:1", "the text is empty")
text("number.json", "1:1", "a scene is an object")
text("no-keys.json", "1:1", "the scene is empty")
text("truncated.json", "4:43", "string that begins in line 4, column 39")
text("unclosed.json", "4:1", "object that begins in line 3, column 13")
text("deep.json", "1:410", "nested deeper than 64")
text("deeper.json", "1:65", "nested deeper than 64")
text("utf8.json", "3:18", "byte 0xe9 is not UTF-8")
text("duplicate.json", "4:5", "/time: ", "already, in line 3, column 5")
text("nan.json", "3:21", "NaN is not a number")
text("infinity.json", "3:22", "Infinity is not a number")
text("huge-number.json", "3:21", "1e999 is too large")
text("comma.json", "3:23", "comma")
text("quotes.json", "2:5", "double quotes")
text("comment.json", "2:5", "JSON has no comments")
text("line-break.json", "2:14", "not closed in its line")
text("tail.json", "2:1", "behind the end")
text("zero.json", "1:30", "control character 0x00")

# -- Files that are none -------------------------------------------------------------------------

case("no such scene", ["check", "nowhere.json"], USAGE, "nowhere.json: cannot be read: No such file")
case("a folder", ["check", "."], USAGE, ".: is a folder")
case("a dangling link", ["check", "link.json"], USAGE, "link.json: cannot be read",
     link=("nowhere", "link.json"))
case("a scene that is a program", ["check", "scene.json"], USAGE, "scene.json:", "UTF-8",
     binary=b"\x7fELF\x02\x01\x01\x00" + bytes(range(256)))

# -- Scenes --------------------------------------------------------------------------------------

change('"title":', '@"titel":', '/titel: unknown key "titel" (did you mean "title"?)')
change('"dimensions": 1', '"dimensions": @4', "/dimensions: 4 is too large")
change('"dimensions": 1', '"dimensions": @"one"', '/dimensions: "one" is not a whole number')
change('"dimensions": 1,', '"units": @"metric", "dimensions": 1,', '/units: unknown system of units "metric"')
change('"min": [0]', '"min": @[0, 0]', "/domain/min: 2 numbers in 1 dimension; give 1")
change('"domain": {"min": [0]', '"domain": @{"min": [2]', "/domain: the domain is empty: along x")
change('"mirror"', '@"miror"', '/domain/sides/x: "miror" is not a side (did you mean "mirror"?)')
change('"mirror"', '@["periodic", "open"]', "/domain/sides/x: one side is periodic")
change('"material": "gas"', '"material": @"gass"', 'unknown material "gass" (did you mean "gas"?)')
change('"name": "ideal-gas"', '"name": "ideal-gsa"', '"ideal-gsa"', '(did you mean "ideal-gas"?)')
change('"gamma": 1.4', '"gama": @1.4', '/materials/gas/eos/gama: ', '(did you mean "gamma"?)')
change('"gamma": 1.4', '"gamma": @-1.4', "/materials/gas/eos/gamma: ", "must lie between")
change('"gamma": 1.4', '"gamma": @"high"', "/materials/gas/eos/gamma: ")
change('"material": "gas"', '"material": "gas", @"colums": {}', 'unknown key "colums" (did you mean "columns"?)')
case("no particles", ["check", "scene.json", "--set", "particles={}"], USAGE,
     "--set particles={}: /particles: the scene is empty", scene=base)
fill('{"lattice": "square", "spacing": @-0.02}', "-0.02 is not a spacing; give a positive number")
fill('{"lattice": "square", "spacing": @0}', "0 is not a spacing; give a positive number")
fill('{"lattice": "square", "spacing": @"fine"}', '"fine" is not a number')
fill('{"lattice": "square", "spacing": @5}', "a spacing of 5 is too coarse")
fill('@{"lattice": "square"}', "the fill's size is missing")
fill('@{"lattice": "square", "spacing": 0.02, "count": 50}', "the fill's size is given twice")
fill('{"lattice": @"sqare", "spacing": 0.02}', 'unknown lattice "sqare" (did you mean "square"?)')
fill('{"lattice": @"fcc", "spacing": 0.02}', 'the lattice "fcc" needs 3 dimensions')
fill('@{"spacing": 0.02}', 'one of "lattice", "glass" and "file"')
fill("@[]", "/particles/fluid/fill: no fill")
fill('{"lattice": "square", "count": @1000000000}', "1e+09 particles", "GiB", '"limits"')
fill('{"lattice": "square", "spacing": @1e-9}', "1e+09 particles")
fill('{"glass": {}, "count": @1000000000}', "1e+09 particles")
fill('[{"lattice": "square", "spacing": 0.02}, @{"lattice": "square", "spacing": 0.02, '
     '"in": {"box": {"min": [0.4], "max": [0.6]}}}]',
     "/particles/fluid/fill/1: this fill overlaps /particles/fluid/fill/0")
fill('{"lattice": "square", "spacing": 0.02, "in": {@"ball": {}}}', 'unknown shape "ball"')
fill('{"lattice": "square", "spacing": 0.02, "in": {"box": @{"min": [1], "max": [0]}}}',
     "the box is empty: along x")
fill('{"lattice": "square", "spacing": 0.02, "in": @{"intersection": [{"box": {"min": [0], "max": '
     '[0.2]}}, {"box": {"min": [0.5], "max": [1]}}]}}', "there are no particles inside this shape")
fill('@{"lattice": "square", "spacing": 0.02, "in": {"box": {"min": [0], "max": [1.5]}}}',
     "lies outside the domain, beyond its mirror side")
change('"rho": 1, ', "", "the particles' mass is unknown")
change('"rho": 1', '"rho": @-1', "/particles/fluid/fields/rho: the density is -1")
change('"rho": 1', '"rho": @true', "true is neither a number nor an expression")
change('"rho": 1', '"rho": 1, @"rhoo": 1', 'unknown field "rhoo" (did you mean "rho"?)')
change('"rho": 1', '"rho": @"1 +"', '"1 +": the expression ends too early')
change('"rho": 1', '"rho": @"1 + q"', '"1 + q": column 5: unknown name "q"')
change('"rho": 1', '"rho": @"sqrt(x - 0.5)"', "gives rho = NaN at x = 0.01")
change('"rho": 1', '"rho": @"1 / (x - 0.01)"', "gives rho = infinity at x = 0.01")
change('"v": [0]', '"v": @[0, 0]', "/particles/fluid/fields/v: 2 components of a vector in 1 dimension")
change('"scheme": {"name": "gsph"},', "", 'the key "scheme" is missing', "scene.json:1:1: ")
change('"name": "gsph"', '"name": "gshp"', 'no scheme "gshp"', '(did you mean "gsph"?)')
change('"name": "gsph"', '"name": "gsph", "riemannn": @"exact"', "/scheme/riemannn: ", '"riemann"')
change('"name": "gsph"', '"name": "gsph", "riemann": @"exakt"', "/scheme/riemann: ", "exact")
change('"name": "gsph"', '"name": "gsph", "edit": [@{"delete": "nothing"}]', "/scheme/edit/0: ", '"nothing"')
change('"name": "gsph"', '"name": "gsph", "edit": [@{}]', "/scheme/edit/0: an edit has one of")
change('"wendland-c4"', '@"wendland-c3"', "/kernel: ", '"wendland-c3"', "did you mean")
change('"integrator": "kdk"', '"integrator": "kkd"', '"kkd"', '(did you mean "kdk"?)')
change('"end": 0.01', '"end": @-0.01', "/time/end: the end -0.01 is not after the begin 0")
change(', "end": 0.01', "", 'the key "end" is missing', "/time: ")
change('"end": 0.01', '"end": 0.01, "cfl": @-1', "/time/cfl: -1 is not a time-step number")
change('"dimensions": 1,', '"watch": {@"densty": "stop"}, "dimensions": 1,',
       '/watch/densty: unknown key "densty" (did you mean "density"?)')
change('"dimensions": 1,', '"watch": {"density": @"cout"}, "dimensions": 1,',
       '/watch/density: unknown action "cout" (did you mean "count"?)')
change('"dimensions": 1,', '"watch": {"density": @3}, "dimensions": 1,', "/watch/density: 3 is not an action")
change('"dimensions": 1,', '"watch": @"off", "dimensions": 1,', "/watch: ", "object")
change('"dimensions": 1,', '"watch": {"density": {@"below": 1}}, "dimensions": 1,', 'unknown key "below"')
change('"dimensions": 1,', '"watch": {"escaped": {"margin": @-1}}, "dimensions": 1,',
       "/watch/escaped/margin: -1 is not a margin; give a positive number")
change('"dimensions": 1,', '"watch": {"escaped": {"where": @"q < 1"}}, "dimensions": 1,',
       '/watch/escaped/where: "q < 1": column 1: unknown name "q"')
change('"dimensions": 1,', '"watch": {"time-step": {"below": @2}}, "dimensions": 1,',
       "/watch/time-step/below: 2 is not a fraction of the longest step")
change('"dimensions": 1,', '"watch": {"energy": {"above": @"much"}}, "dimensions": 1,', '/watch/energy/above: "much"')
change('"dimensions": 1,', '"watch": {"not-finite": @"off"}, "dimensions": 1,',
       "/watch/not-finite: a value that is not finite always stops the run")
change('"exact": "riemann"', '"exact": "rieman"', '"rieman"', '(did you mean "riemann"?)')
change('"where": "r > 0.1"', '"where": @"r >"', '/compare/0/where: "r >": the expression ends too early')
change('"array": "fluid", "mean"', '"array": @"fluit", "mean"', 'unknown array "fluit" (did you mean "fluid"?)')
change('"mean": "rho"', '"mean": "roh"', "/probes/0", '"roh"', '(did you mean "rho"?)')
# Of what is measured.
COMPARE, PROBE = '{"array": "fluid", "exact": "riemann", "where": "r > 0.1"}', '{"name": "a", "array": "fluid", "mean": "rho"}'
for new, parts in (
        ('{"array": "fluid", "table": @{"x": [0, 1], "y": [1, 2]}}', ("/compare/0/table: no column of the table is",)),
        ('{"array": "fluid", "table": @{"x": [0, 0.5, 0.5], "rho": [1, 1, 1]}}',
         ("/compare/0/table: column \"x\" of the table does not rise: 0.5, 0.5 in rows 2, 3",)),
        ('{"array": "fluid", "table": {"x": [0, 1], "rho": @[1]}}', ("/compare/0/table/rho: ", "as long as the others")),
        ('{"array": "fluid", "table": @"none.csv"}', ("/compare/0/table: ", "none.csv: cannot be read")),
        ('{"array": "fluid", "table": @3}', ("/compare/0/table: ", "name of a file or an object of columns")),
        ('{"array": "fluid", "table": {"x": [0, 1], "d": [1, 1]}, "fields": {"rho": @"dd"}}',
         ("/compare/0/fields/rho: the table has no column \"dd\" (did you mean \"d\"?)",)),
        ('{"array": "fluid", "table": {"x": [0, 1], "rho": [1, 1]}, "fields": {"v.y": @"rho"}}',
         ("/compare/0/fields/v.y: ", "components of \"v\" are x, r")),
        ('{"array": "fluid", "table": {"x": [0, 1], "d": [1, 1]}, "fields": [@"rho"]}',
         ("/compare/0/fields/0: the table has no column \"rho\"",)),
        ('{"array": "fluid", "table": {"x": [0, 1], "rho": [1, 1]}, "along": @"y"}',
         ("/compare/0/along: there is no y in 1 dimension",)),
        ('{"array": "fluid", "table": {"x": [0, 1], "rho": [1, 1]}, "along": @"s"}', ("/compare/0/along: ",)),
        ('{"array": "fluid", "table": {"x": [0, 1], "rho": [1, 1]}, "axis": @"x"}', ("/compare/0/axis: an axis is for 3",)),
        ('{"array": "fluid", "table": {"x": [0, 1], "rho": [1, 1]}, @"gamma": 2}', ('/compare/0/gamma: unknown key',)),
        ('{"array": "fluid", "table": {"x": [0, 1], "rho": [1, 1]}, "time": @1}',
         ("/compare/0/time: the run goes from 0 to 0.01; 1 is outside",)),
        ('{"array": "fluid", "table": {"x": [0, 1], "rho": [1, 1]}, "every": 1, "time": @0}',
         ("/compare/0/time: a table for one time is compared then",)),
        ('@{"array": "fluid", "table": "a.csv", "exact": "riemann"}', ("/compare/0: give \"exact\" or \"table\"",)),
        ('{"array": "fluid", "exact": "riemann", "every": @0}', ("/compare/0/every: 0 is not a time interval",)),
        ('{"array": "fluid", "exact": "riemann", "at": [0.001, @0.001]}', ("/compare/0/at/1: times must rise",)),
        ('{"array": "fluid", "exact": "riemann", "at": @"now"}', ('/compare/0/at: "now" is not a time',)),
        ('{"array": "fluid", "exact": "riemann", "fields": [@"h"]}',
         ("/compare/0/fields/0: the exact solution \"riemann\" does not give \"h\"",)),
        ('{"array": "fluid", "exact": "riemann", "fields": @"v.r"}', ("/compare/0/fields: the exact solution",))):
    change(COMPARE, new, *parts)
AT = '"array": "fluid", "of": "rho", "at": [0.5]'
REFERRED = '{"name": "a", "array": "fluid", "of": "rho", "along": "x", "reference": %s}'
for new, parts in (
        ('{"name": "a", "array": "fluid", "of": "rho", "at": [@1.5]}'.replace("[@", "@["),
         ("/probes/0/at: the point lies outside of the domain: x = 1.5 is not within 0 to 1",)),
        ('{"name": "a", "array": "fluid", "of": "rho", "at": [[0.5], @[-1]]}', ("/probes/0/at/1: the point lies outside",)),
        ('{"name": "a", "array": "fluid", "of": "rho", "at": [[0.5], @[0.5, 1]]}', ("/probes/0/at/1: a point is an array of 1 number",)),
        ('{"name": "a", "array": "fluid", "of": "rho", "at": @0.5}', ("/probes/0/at: ", "array of numbers")),
        ('@{"name": "a", "array": "fluid", "at": [0.5]}', ('/probes/0: the key "of" is missing',)),
        ('{"name": "a", "array": "fluid", "at": [0.5], "of": ["rho", @"roh"]}', ("/probes/0/of/1: ", '(did you mean "rho"?)')),
        ('{"name": "a", "array": "fluid", "at": [0.5], "of": @"v.phi"}', ("/probes/0/of: ", "components of \"v\" are x, r")),
        ('{"name": "a", "array": "fluid", "at": [0.5], "of": @"rho.x"}', ("/probes/0/of: ", "components of \"rho\" are none")),
        ('{"name": "a", "array": "fluid", "at": [0.5], "of": @["rho", "rho"]}', ('/probes/0/of: "rho" stands there twice',)),
        ('{"name": "a", "array": ["fluid", @"wall"], "at": [0.5], "of": "rho"}', ("/probes/0/array/1: ", '"wall"')),
        ('{"name": "a", %s, @"where": "x > 0"}' % AT, ("/probes/0/where: ", "leave out \"where\"")),
        ('{"name": "a", "array": "fluid", "mean": "rho", @"of": "p"}', ("/probes/0/of: ", "is for a probe \"at\" points")),
        ('@{"name": "a", %s, "mean": "rho"}' % AT, ("/probes/0: a probe has one of",)),
        ('@{"name": "a", %s, "every": 1, "steps": 2}' % AT, ('/probes/0: give "steps" or "every", not both',)),
        ('{"name": "a", %s, "steps": @0}' % AT, ("/probes/0/steps: ",)),
        ('{"name": "a", %s}, {"name": @"a", %s}' % (AT, AT), ("/probes/1/name: an earlier probe has this name",)),
        ('{"name": "a b", %s}, {"name": @"a/b", %s}' % (AT, AT), ("/probes/1/name: ", "their files' names would be one")),
        ('{"name": @"%s", %s}' % ("a" * 201, AT), ("/probes/0/name: a name has at most",)),
        ('{"name": "a", %s, "reference": @{"table": "p.csv"}}' % AT, ("/probes/0/reference: ", 'give "every" or "steps"')),
        ('{"name": "a", %s, "steps": 1, "reference": @{}}' % AT, ('/probes/0/reference: the key "table" is missing',)),
        ('{"name": "a", %s, "steps": 1, "reference": {"table": {"t": [0, 1], "v": [0, 1]}, "value": @"u"}}' % AT,
         ('/probes/0/reference/value: the table has no column "u"',)),
        ('{"name": "a", %s, "steps": 1, "reference": {"table": @{"t": [1, 0], "v": [0, 1]}}}' % AT,
         ('/probes/0/reference/table: column "t" of the table does not rise',)),
        ('{"name": "a", %s, "steps": 1, "reference": {"table": @{"t": [1, 0]}}}' % AT, ("the table has one column",)),
        ('{"name": "a", %s, "steps": 1, "reference": {"table": {"t": [0, 1], "v": [0, 1]}, "of": @"p"}}' % AT,
         ('/probes/0/reference/of: the probe does not measure "p"',)),
        ('{"name": "a", "array": "fluid", "of": "p", "at": [[0.1], [0.2]], "steps": 1, "reference": @{"table": {"t": [0, 1], "v": [0, 1]}}}',
         ("/probes/0/reference: a probe with a reference is at one point",))):
    change(PROBE, new, *parts)
for new, parts in (
        ('@{"name": "a", "array": "fluid", "of": "rho"}', ('/profiles/0: a profile goes "from" a point "to" another',)),
        ('@{"name": "a", "array": "fluid", "of": "rho", "from": [0]}', ('/profiles/0: the key "to" is missing',)),
        ('{"name": "a", "array": "fluid", "of": "rho", "from": [0], "to": @[2]}', ("/profiles/0/to: the point lies outside",)),
        ('{"name": "a", "array": "fluid", "of": "rho", "from": [0], "to": [1], "points": @1}', ("/profiles/0/points: ",)),
        ('{"name": "a", "array": "fluid", "of": "rho", "from": [0], "to": [1], @"bins": 3}', ("/profiles/0/bins: unknown key",)),
        ('{"name": "a", "array": "fluid", "of": "rho", "along": "x", @"plain": true}', ("/profiles/0/plain: unknown key",)),
        ('@{"name": "a", "array": "fluid", "of": "rho", "along": "r"}', ('/profiles/0: the key "max" is missing',)),
        ('@{"name": "a", "array": "fluid", "of": "rho", "along": "x", "min": 2}', ("/profiles/0: min 2 is not below max 1",)),
        ('{"name": "a", "array": "fluid", "of": @"rhoo", "along": "x"}', ("/profiles/0/of: ", '(did you mean "rho"?)')),
        ('{"name": "a", "array": "fluid", "of": "rho", "along": "x"}, {"name": @"a", "array": "fluid", "of": "rho", "along": "x"}',
         ("/profiles/1/name: an earlier profile has this name",)),
        (REFERRED % '@3', ('/profiles/0/reference: a profile\'s reference is an object with "exact" or "table"',)),
        (REFERRED % '@{"exact": "noh", "table": "a.csv"}', ('/profiles/0/reference: a profile\'s reference is',)),
        (REFERRED % '@{"exact": "nho"}', ('/profiles/0/reference: ', '(did you mean "noh"?)')),
        (REFERRED % '{"exact": "noh", "gama": @2}', ("/profiles/0/reference/gama: ",)),
        (REFERRED % '{"table": {"x": [0, 1], "rho": [1, 1]}, @"along": "x"}', ("/profiles/0/reference/along: unknown key",)),
        (REFERRED % '{"table": @{"x": [1, 0], "rho": [1, 1]}}', ("/profiles/0/reference/table: ", "does not rise")),
        (REFERRED % '{"table": {"x": [0, 1], "q": [1, 1]}, "fields": {"rho": @"r"}}', ("/profiles/0/reference/fields/rho: ", 'no column "r"')),
        (REFERRED % '{"table": {"x": [0, 1], "q": [1, 1]}, "fields": {"u": @"q"}}', ("/profiles/0/reference/fields/u: ", 'the profile is not of "u"')),
        (REFERRED % '@{"table": {"x": [0, 1], "q": [1, 1]}}', ("/profiles/0/reference: ", 'gives nothing that the profile is "of"')),
        ('{"name": "a", "array": "fluid", "of": "h", "along": "x", "reference": @{"exact": "noh"}}',
         ("/profiles/0/reference: ", 'gives nothing that the profile is "of"')),
        ('@3', ("/profiles/0: ",))):
    change('"output":', '"profiles": [%s], "output":' % new, *parts)
change('"output":', '"profiles": @{}, "output":', "/profiles: give an array of profiles")
# Of neighbours and precision.
for word, hint in (("mixt", '(did you mean "mixed"?)'), ("Mixed", '(did you mean "mixed"?)'), ("Single", "single"),
                   ("quadruple-precise", "double, mixed, single"), ("", "the text is empty")):
    change('"output":', f'"precision": @"{word}", "output":', "/precision: ", hint)
change('"output":', '"precision": @32, "output":', "/precision: ")
change('"output":', '"neighbours": {"manager": @"boxs"}, "output":', "/neighbours/manager: ", '"boxs"',
       '(did you mean "boxes"?)')
change('"output":', '"neighbours": {"manager": @"tree"}, "output":', "/neighbours/manager: ", '"tree"')
change('"output":', '"neighbours": {"manager": @3}, "output":', "/neighbours/manager: ")
change('"output":', '"neighbours": {@"manger": "boxes"}, "output":', "/neighbours/manger: ",
       '(did you mean "manager"?)')
# Of ranks.
change('"output":', '"ranks": {"partition": @"rbc"}, "output":', "/ranks/partition: ", '"rbc"', '(did you mean "rcb"?)')
change('"output":', '"ranks": {"partition": @"metis"}, "output":', "/ranks/partition: ", "rcb, rib, hsfc, slab")
change('"output":', '"ranks": {"partition": @2}, "output":', "/ranks/partition: ")
change('"output":', '"ranks": {"imbalance": @0.9}, "output":', "/ranks/imbalance: ", "0.9 is no bound", "1")
change('"output":', '"ranks": {"imbalance": @"low"}, "output":', "/ranks/imbalance: ")
change('"output":', '"ranks": {@"partitions": "rcb"}, "output":', "/ranks/partitions: ", '(did you mean "partition"?)')
change('"output":', '"ranks": @4, "output":', "/ranks: ")
change('"name": "gsph"', '"name": "gsph", "fuse": @"no"', "/scheme/fuse: ")
change('"every": 0.005', '"every": @0', "/output/every: 0 is not a time interval")
for wrong, hint in (('@{"steps": 10, "every": 1}', 'give "steps" or "every", not both'), ("@{}", 'give "steps" or "every"'),
                    ('{"steps": @0}', "0 is too small"), ('{"every": @-1}', "-1 is not a time interval"),
                    ('{"steps": 5, "keep": @0}', "0 is too small"), ("@10", "10 is not an object"),
                    ('{@"step": 5}', 'unknown key "step" (did you mean "steps"?)')):
    change('"every": 0.005', f'"checkpoint": {wrong}', "/output/checkpoint", hint)
for words, *parts in ((["--resume", "latest", "--out", "x"], "cannot read the folder x"),
                      (["--resume", "latest"], "give the scene, or the folder by --out"),
                      (["--resume", "none.h5"], "cannot read none.h5: No such file"),
                      (["--resume", "."], "is not a file"), (["--resume", "base.json"], "it is not an HDF5 file")):
    case(" ".join(words), words, USAGE, *parts, copy=["base.json"])
change('"output":', '"boundaries": [{"name": "wall"}], "output":', "/boundaries/0", '"wall"')

# -- Functions that the scene brings -----------------------------------------------------------------

DRAG = ('{"name": "drag", "body": "drag.body.h", "i": "v", "j": ["m", "rho", "v"], "sum": "a", "rates": {"v": "a"}, '
        '"parameters": {"k": 0.1}}')
HALF = '{"name": "half", "body": "half.body.h", "in": ["q", "h"], "out": "half_q", "properties": {"q": "scalar", "half_q": "scalar"}}'


def function(of, old, new, *parts, path="/functions/0", **more):
    """One change in the declaration of a function that is right."""
    assert of.count(old) == 1, f"{old!r} stands {of.count(old)} times"
    change('"output":', f'"functions": [{of.replace(old, new)}], "output":', path, *parts,
           copy=["drag.body.h", "half.body.h", "blank.body", "latin1.body"], **more)


ONLY_TEXT = ('function "drag" of the scene has only a text: run with --device opencl, or make it a plugin with '
             "sph new-plugin NAME --from scene.json:drag")
case("a function that has only a text", ["run", "scene.json"], USAGE, "/scheme/edit/0: ", ONLY_TEXT,
     scene=base.replace('"output":', f'"functions": [{DRAG}], "output":').replace(
         '"name": "gsph"', '"name": "gsph", "edit": [{"insert": "drag", "after": "gsph-rates"}]'), copy=["drag.body.h"])
change('"output":', '"functions": @{}, "output":', "/functions: give an array of functions")
change('"output":', '"functions": [@3], "output":', '/functions/0: a function is an object with "name" and "body"')
function(DRAG, '{"name": "drag", ', "@{", 'the key "name" is missing')
function(DRAG, '"drag"', '@"Drag"', '"Drag" is no name for a function', path="/functions/0/name: ")
function(DRAG, DRAG, DRAG + ', ' + DRAG.replace('"drag"', '@"drag"'), "an earlier function has the name",
         path="/functions/1/name: ")
function(DRAG, '{"name": "drag"', '@{"name": "gsph-rates"', 'function "gsph-rates" is registered already, by ')
function(DRAG, '{"name": "drag", "body": "drag.body.h"', '@{"name": "drag"', 'the key "body" is missing')
for new, part in (("nowhere.body.h", "nowhere.body.h: cannot be read: No such file"), (".", ".: is no file"),
                  ("blank.body", "blank.body: the text is empty"), ("", "the text is empty"),
                  ("latin1.body", "latin1.body:2:12: byte 0xe9 is not UTF-8")):
    function(DRAG, '"drag.body.h"', f'@"{new}"', part, path="/functions/0/body: ")
function(DRAG, '"drag.body.h"', '"drag.body.h", "prelude": @"nowhere.h"', "cannot be read", path="/functions/0/prelude: ")
function(DRAG, '"sum": "a"', '"summ": "a"'.replace('"s', '@"s', 1), 'unknown key "summ" (did you mean "sum"?)', path="/functions/0/summ: ")
function(DRAG, '"sum": "a"', '@"out": "a"', "unknown key", path="/functions/0/")
function(DRAG, '"sum": "a"', '"sum": @7', "7 is not the name of a property", path="/functions/0/sum: ")
function(DRAG, '"sum": "a"', '"sum": {@"1st": "a"}', '"1st" is no name for a body', path="/functions/0/sum/1st: ")
function(DRAG, '"sum": "a"', '"sum": {"r": @"a"}', 'the body has another "r" already', path="/functions/0/sum/r: ")
function(DRAG, '"sum": "a"', '"sum": ["a", @"a"]', '"a" is named in "sum" already', path="/functions/0/sum/1: ")
function(DRAG, '"i": "v"', '"i": ["v", @"rho"]', 'drag.body.h does not use "rho_i": leave it out of "i"', path="/functions/0/i/1: ")
function(DRAG, '"sum": "a"', '"sum": {"a": @"dv_of_mine"}', 'no plugin that is loaded declares "dv_of_mine"',
         '"properties": {"dv_of_mine": "scalar"}', path="/functions/0/sum/a: ")
function(DRAG, '"sum": "a"', '"sum": "a", "properties": {@"q": "scalar"}', 'no list of the function has the property "q"',
         path="/functions/0/properties/q: ")
function(DRAG, '"sum": "a"', '"sum": "a", "properties": {"a": @"scalar"}', '"a" is declared by others already, and is of another type',
         path="/functions/0/properties/a: ")
function(DRAG, '"sum": "a"', '"sum": "a", "properties": {"a": @"vektor"}', 'unknown type "vektor" (did you mean "vector"?)',
         path="/functions/0/properties/a: ")
function(DRAG, '"sum": "a"', '"sum": "a", "properties": {"a": {@"typ": "vector"}}', '(did you mean "type"?)',
         path="/functions/0/properties/a/typ: ")
function(DRAG, '"sum": "a"', '"sum": "a", "reach": @"symetric"', '(did you mean "symmetric"?)', path="/functions/0/reach: ")
function(DRAG, '"sum": "a"', '"sum": "a", "shape": @"pairs"', '(did you mean "pair"?)', path="/functions/0/shape: ")
function(DRAG, '"sum": "a"', '"sum": "a", "dimensions": [1, @4]', "4 is no number of dimensions", path="/functions/0/dimensions/1: ")
function(DRAG, '"sum": "a"', '"sum": "a", "reach_scale": @0', "0 is not a factor", path="/functions/0/reach_scale: ")
function(DRAG, '"sum": "a"', '"sum": "a", "self": @1', "1 is not true or false", path="/functions/0/self: ")
function(DRAG, '"sum": "a"', '"sum": "a", "after": @"half.body.h"', 'give an object with "body"', path="/functions/0/after: ")
function(DRAG, '"sum": "a"', '"sum": "a", "after": {"body": "half.body.h", @"i": "v"}', "unknown key", path="/functions/0/after/i: ")
function(DRAG, "0.1", '@"much"', "give the parameter's default, a number", path="/functions/0/parameters/k: ")
function(DRAG, "0.1", '{"default": @2, "max": 1}', "the default 2 is not within -inf and 1", path="/functions/0/parameters/k/default: ")
function(DRAG, "0.1", '@{"min": 2, "max": 1}', "min 2 is above max 1", path="/functions/0/parameters/k: ")
function(DRAG, '"k"', '@"k-1"', '"k-1" is not a name', path="/functions/0/parameters/k-1: ")
function(DRAG, '"k"', '@"r"', 'the body has another "r" already', path="/functions/0/parameters/r: ")
function(DRAG, '"k"', '@"a"', '"a" is named in "sum" already', path="/functions/0/parameters/a: ")
function(DRAG, '{"v": "a"}', '{"v": @3}', "give the name of the property that is its rate", path="/functions/0/rates/v: ")
function(DRAG, '{"v": "a"}', '{"v": {"rate": "a", "kind": @"kik"}}', '(did you mean "kick"?)', path="/functions/0/rates/v/kind: ")
function(DRAG, '"rates"', '"reductions": {"d": @{"use": "time-step"}}, "rates"', 'one of "min", "max" and "sum"', path="/functions/0/reductions/d: ")
function(DRAG, '"rates"', '"reductions": {"d": {"min": "a", "use": @"timestep"}}, "rates"', '(did you mean "time-step"?)',
         path="/functions/0/reductions/d/use: ")
function('@' + DRAG, '"rates"', '"reductions": {"d": {"min": "a"}}, "rates"', 'reduction "d" is of "a", which is not a scalar')
function('@' + DRAG, '{"v": "a"}', '{"v": "b"}', 'rate of "v" is "b", which is not declared as written')
function('@' + DRAG, '"sum": "a"', '"sum": "a", "min": {"a_least": "a"}'.replace("a_least", "weight"), "access of property \"a\" is more than one of write, sum, max and min")
function(HALF, '"out": "half_q"', '@"sum2": "half_q"', "unknown key", path="/functions/0/sum2: ")
function(HALF, '"q": "scalar", ', "", 'no plugin that is loaded declares "q"', path="/functions/0/in/0: ")

# -- Particles out of files ----------------------------------------------------------------------

for name, parts in (
        ("cell.csv", ('cell.csv:3:5: "one" in column "m" is not a number',)),
        ("ragged.csv", ("ragged.csv:3: 2 cells for 3 columns",)),
        ("headless.csv", ("headless.csv:1:1: 0.1 is a number; a line of column names",)),
        ("stranger.csv", ('column "rhoo" is no property (did you mean "rho"?)',)),
        ("no-x.csv", ('no column "x"',)),
        ("no-rows.csv", ("no particles",)),
        ("twins.csv", ("same place",)),
        ("nowhere.csv", ("nowhere.csv: cannot be read: No such file",)),
        ("base.json", ("base.json:2:", "not a number")),
        (".", ("is a folder",))):
    fill('{"file": @"%s"}' % name, "/particles/fluid/fill/file: ", *parts, without='"rho": 1, ',
         copy=[name] if os.path.isfile(os.path.join(folder, name)) else [])
fill('{"file": "a.csv", @"spacin": 1}', '(did you mean "spacing"?)')
fill('{"file": "no-x.csv", "rename": {@"X": "x"}}', 'the file has no column "X"', copy=["no-x.csv"])

# -- Plugins -------------------------------------------------------------------------------------

change('["kernels", "eos", "gsph", "exact"]', "[]", 'no scheme "gsph"', "--load")
change('["kernels", "eos", "gsph", "exact"]', '["kernels", "eos", "exact"]', 'no scheme "gsph"')
change('["kernels", "eos", "gsph", "exact"]', '["kernels", "eos", "gshp"]', '"gshp"', code=REFUSED)
change('["kernels", "eos", "gsph", "exact"]', '["eos", @7]', "/plugins/1: 7 is not a name")
case("a plugin that is a text", ["check", "scene.json", "--load", "./scene.json"], REFUSED, "scene.json",
     scene=base)
case("a plugin that is a folder", ["check", "scene.json", "--load", "./"], REFUSED, scene=base)

# -- The command line ----------------------------------------------------------------------------

case("no argument", [], USAGE, "no scene is given")
case("no scene", ["run"], USAGE, "no scene is given")
case("two scenes", ["run", "a.json", "b.json"], USAGE, "one scene at a time")
case("unknown command", ["rnu"], USAGE, '"rnu"', 'did you mean "run"?')
case("unknown option", ["run", "scene.json", "--thread-count=2"], USAGE, "--thread-count", scene=base)
case("negative threads", ["run", "scene.json", "--threads=-2"], USAGE, "threads", "-2", scene=base)
case("no threads", ["run", "scene.json", "--threads=0"], USAGE, "threads", "0", scene=base)
case("threads in words", ["run", "scene.json", "--threads=two"], USAGE, "threads", "two", scene=base)
case("negative steps", ["run", "scene.json", "--steps=-1"], USAGE, "steps", "-1", scene=base)
case("until before begin", ["run", "scene.json", "--until=-1"], USAGE, "-1", "begin", scene=base)
case("until NaN", ["run", "scene.json", "--until=nan"], USAGE, "nan", scene=base)
for command in ("run", "check", "plan"):
    case(f"{command} with a precision unknown", [command, "scene.json", "--precision=mixt"], USAGE, "--precision",
         "mixt", "double", "mixed", "single", scene=base)
case("path unknown", ["run", "scene.json", "--path=avx513"], USAGE, "--path", '"avx513"', "best, reference",
     scene=base)
case("path empty", ["run", "scene.json", "--path="], USAGE, "--path", scene=base)
case("no such device", ["run", "scene.json", "--device=abacus"], USAGE, "abacus", scene=base)
case("set without a value", ["run", "scene.json", "--set", "time.end"], USAGE,
     "--set time.end: give PATH=VALUE", scene=base)
case("set of nothing", ["run", "scene.json", "--set", "time.end="], USAGE, "a value is missing", scene=base)
case("set of an unknown key", ["run", "scene.json", "--set", "time.ende=1"], USAGE,
     "--set time.ende=1: /time/ende: unknown key", '(did you mean "end"?)', scene=base)
case("set within a number", ["run", "scene.json", "--set", "dimensions.x=1"], USAGE,
     "--set dimensions.x=1: ", "has no members", scene=base)
case("set of half a value", ["run", "scene.json", "--set", "time={\"end\":"], USAGE, "--set time=", scene=base)
case("set beyond an array", ["run", "scene.json", "--set", "compare.5.exact=a"], USAGE, "not an index",
     scene=base)
case("set of a wrong value", ["run", "scene.json", "--set", "time.end=soon"], USAGE,
     '--set time.end=soon: /time/end: "soon" is not a number', scene=base)
case("render nothing", ["render", "nowhere.vtkhdf"], USAGE, "nowhere.vtkhdf")
case("render a text", ["render", "scene.json"], USAGE, "scene.json", scene=base)
case("info of nothing", ["info", "gshp"], USAGE, "gshp")

# -- Output --------------------------------------------------------------------------------------

case("output into a file", ["run", "scene.json", "--out", "scene.json"], USAGE, "scene.json", "folder",
     scene=base)
case("output below a file", ["run", "scene.json", "--out", "scene.json/out"], USAGE, "scene.json", scene=base)
case("output where nothing can be", ["run", "scene.json", "--out", "/proc/sph-out"], USAGE, "/proc/sph-out",
     scene=base)
case("output without a name", ["run", "scene.json", "--out", ""], USAGE, "empty name", scene=base)
case("output in use", ["run", "scene.json", "--out", "out"], USAGE, "out", "in use", scene=base, held=True)
case("files may be 4 KiB", ["run", "scene.json", "--out", "out"], RUN, "out", scene=base, file_size=4096)
# Less, and the OpenMP library of clang cannot start: it takes a page of its own.
case("files may be 1500 bytes", ["run", "scene.json", "--out", "out"], RUN, "out", scene=base, file_size=1500)
case("disk full", ["run", "scene.json", "--out", "full/out"], RUN, "full/out", "No space left",
     scene=base, disk="size=24k")
case("disk full at once", ["run", "scene.json", "--out", "full/out"], (RUN, USAGE), "full/out",
     "No space left", scene=base, disk="size=4k,nr_inodes=2")
case("standard output full", ["check", "scene.json"], RUN, "standard output", scene=base,
     stdout="/dev/full")


class Failure(Exception):
    pass


def expect(good, what):
    if not good:
        raise Failure(what)


@contextlib.contextmanager
def small_disk(options, where):
    """A small file system at `where`; yields False where none can be made."""
    os.mkdir(where)
    made = subprocess.run(["mount", "-t", "tmpfs", "-o", options, "sph-test", where],
                          stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    try:
        yield made.returncode == 0
    finally:
        if made.returncode == 0:
            subprocess.run(["umount", where], check=False)


def prepare(work, more):
    for name in more.get("copy", []):
        shutil.copy(os.path.join(folder, name), work)
    if "scene" in more:
        with open(os.path.join(work, "scene.json"), "w", encoding="utf-8") as out:
            out.write(more["scene"])
    if "binary" in more:
        with open(os.path.join(work, "scene.json"), "wb") as out:
            out.write(more["binary"])
    if "link" in more:
        os.symlink(more["link"][0], os.path.join(work, more["link"][1]))


def check_message(stderr, parts):
    lines = stderr.splitlines()
    # argp adds where help is to be had.
    if len(lines) == 2 and lines[1].startswith("Try `sph"):
        lines.pop()
    expect(len(lines) == 1, f"{len(lines)} lines on stderr:\n{stderr}")
    expect(lines[0].startswith("sph"), f"the line does not begin with the program's name: {lines[0]}")
    for part in parts:
        expect(part in lines[0], f"{part!r} is not in: {lines[0]}")


def check_rest(out, started):
    """Nothing half written: no files aside, no lock, no results if it never started."""
    names = sorted(os.listdir(out)) if os.path.isdir(out) else []
    if not started:
        expect(not names, f"left behind: {names}")
        return
    for name in names:
        path = os.path.join(out, name)
        expect(not name.startswith("."), f"left behind: {names}")
        if name.endswith(".vtkhdf"):
            with open(path, "rb") as snapshot:
                expect(snapshot.read(8) == b"\x89HDF\r\n\x1a\n", f"{name} is damaged")
        if name == "summary.json":
            with open(path, encoding="utf-8") as summary:
                expect(json.load(summary)["status"] != "done", "the summary says that all went well")


def run_case(name, arguments, code, parts, more, work):
    prepare(work, more)
    before = sorted(os.listdir(work))

    def limit():
        if "file_size" in more:
            resource.setrlimit(resource.RLIMIT_FSIZE, (more["file_size"], more["file_size"]))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    with contextlib.ExitStack() as stack:
        if "disk" in more and not stack.enter_context(
                small_disk(more["disk"], os.path.join(work, "full"))):
            return False
        if "held" in more:
            os.mkdir(os.path.join(work, "out"))
            lock = stack.enter_context(open(os.path.join(work, "out", ".sph-lock"), "w", encoding="utf-8"))
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        stdout = stack.enter_context(open(more.get("stdout", os.devnull), "w", encoding="utf-8"))
        done = subprocess.run([sph, *arguments], cwd=work, stdout=stdout, stderr=subprocess.PIPE,
                              preexec_fn=limit, timeout=120, check=False)
        stderr = done.stderr.decode("utf-8", "backslashreplace")
        codes = code if isinstance(code, tuple) else (code,)
        expect(done.returncode in codes, f"exit status {done.returncode}, not {code}:\n{stderr}")
        check_message(stderr, parts)
        if "held" in more:
            expect(os.listdir(os.path.join(work, "out")) == [".sph-lock"], "the folder in use was touched")
            return True
        check_rest(os.path.join(work, "full/out" if "disk" in more else "out"), done.returncode == RUN)
        left = [n for n in os.listdir(work) if n not in before + ["out", "full"]]
        expect(not left, f"left behind: {left}")
    return True


def main():
    if not os.access(sph, os.X_OK):
        print(f"{sph} is not there")
        return 1
    failures = skipped = 0
    for name, arguments, code, parts, more in cases:
        with tempfile.TemporaryDirectory(prefix="sph-wrong-") as work:
            try:
                if not run_case(name, arguments, code, parts, more, work):
                    skipped += 1
                    print(f"skipped: {name}: no file system can be mounted here")
            except (Failure, subprocess.TimeoutExpired) as problem:
                failures += 1
                print(f"FAILED: {name}: {problem}")
    print(f"{len(cases)} wrong inputs, {failures} not answered as they should be, {skipped} skipped")
    return 1 if failures else 0


sys.exit(main())

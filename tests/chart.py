"""sph chart: the runs and their order, results.csv against summary.json, failures as rows and marks, going on
after it was killed at any moment, pictures, the cheapest run, peers, and wrong charts."""
import csv
import json
import math
import os
import random
import re
import shutil
import signal
import subprocess
import time
import xml.etree.ElementTree as xml

from scenes import EXAMPLES, SPH, Scenes, changed, example

scenes = Scenes()
expect = scenes.expect
top = scenes.scratch.name
TIMING = {"core_seconds", "wall_s", "peak_rss_bytes", "ns_per_pair"}
sod = example("sod.json")
sod["output"] = {}
sod["probes"] = [{"name": "mean density", "array": "fluid", "mean": "rho", "expected": 0.6},
                 {"name": "least u", "array": "fluid", "min": "u"}]
scenes.write(sod)


def mass(value):
    return {f"particles.fluid.fill.{i}.mass": value for i in (0, 1)}


chart = {
    "title": "A <tube> & its cost", "scene": "scene.json", "set": {"time.end": 0.02},
    "axes": [
        {"name": "particles", "values": [{"label": "56", "set": mass(0.01)}, {"label": "113", "set": mass(0.005)}]},
        {"name": "kernel", "set": "kernel", "values": ["cubic-spline", {"label": "c4", "value": "wendland-c4"}]},
        {"name": "C", "set": "time.cfl", "values": [0.3, 2]},
        {"name": "threads", "option": "threads", "values": [1]}],
    "skip": [{"kernel": "c4", "C": 2}],
    "error": {"of": "fluid.rho"},
    "charts": [
        {"name": "cost", "kind": "cost", "series": ["kernel"]},
        {"name": "order", "kind": "convergence", "series": ["kernel", "C"]},
        {"name": "map", "kind": "map", "x": "C", "y": "particles", "select": {"kernel": "cubic-spline"}}],
}


def run(made, *options, out=None, name="some.chart.json", **others):
    """sph chart: of an object, into a folder of the scratch."""
    path = scenes.write(made, name)
    words = ["chart", path, "--out", os.path.join(top, out or "some"), *options]
    return scenes.command(*words, cwd=top, **others)


def rows(out="some"):
    with open(os.path.join(top, out, "results.csv"), newline="") as file:
        return list(csv.DictReader(file))


def without_timing(out):
    return [{key: value for key, value in row.items() if key not in TIMING} for row in rows(out)]


def picture(name, out="some"):
    """The SVG's texts; both files are whole."""
    path = os.path.join(top, out, name)
    with open(path + ".png", "rb") as file:
        png = file.read()
    expect(f"{name}.png", png[:8] == b"\x89PNG\r\n\x1a\n" and png[-8:-4] == b"IEND" and len(png) > 5000)
    expect(f"{name}.svg is small", 2000 < os.path.getsize(path + ".svg") < 150_000)
    root = xml.parse(path + ".svg").getroot()
    return root, [text.text for text in root.iter("{http://www.w3.org/2000/svg}text")]


def leftovers(out):
    """Files that are no result: of writers, of runs."""
    found = []
    for folder, _, names in os.walk(os.path.join(top, out)):
        inside = os.path.basename(os.path.dirname(folder)) == "runs"
        found += [os.path.join(folder, name) for name in names
                  if name.startswith(".") or (inside and name != "summary.json")]
    return found


def processes(path):
    """Living processes with this path among their arguments."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{pid}/cmdline", "rb") as file:
                if path.encode() in file.read():
                    found.append(int(pid))
        except OSError:
            pass
    return found


# -- The runs and their results ---------------------------------------------------------------------

wanted = [(n, kernel, c) for n in ("56", "113") for kernel in ("cubic-spline", "c4") for c in ("0.3", "2")
          if (kernel, c) != ("c4", "2")]
done = run(chart, "--list")
expect("--list", done.returncode == 0 and re.findall(r"particles=(\S+) kernel=(\S+) C=(\S+) threads=1", done.stdout)
       == wanted and "--set kernel=\"wendland-c4\"" in done.stdout, done.stdout + done.stderr)
expect("--list runs nothing", not os.path.exists(os.path.join(top, "some")))

done = run(chart, "--keep-runs")
expect("a chart", done.returncode == 0 and done.stderr == "", done.stderr)
expect("its table", "6 of 6 runs: 6 done" in done.stdout and "order.png" in done.stdout, done.stdout)
table = rows()
expect("the product in order", [(r["axis.particles"], r["axis.kernel"], r["axis.C"]) for r in table] == wanted, table)
for row in table:
    with open(os.path.join(top, "some/runs", row["id"], "summary.json")) as file:
        summary = json.load(file)
    cost = summary["cost"]
    same = {
        "status": summary["status"], "reason": "", "error": summary["errors"]["fluid.rho"]["l1_rel"],
        "particles": summary["particles"]["fluid"], "steps": summary["steps"], "time": summary["time"],
        "core_seconds": cost["loop_s"], "wall_s": cost["wall_s"], "particle_updates": cost["particle_updates"],
        "pairs": cost["pairs"], "bytes_per_particle": cost["bytes_per_particle"],
        "peak_rss_bytes": cost["peak_rss_bytes"], "ns_per_pair": cost["ns_per_pair"],
        "energy_drift": summary["conservation"]["energy_drift"],
        "fluid.p.linf": summary["errors"]["fluid.p"]["linf"],
        "fluid.p.l2_rel": summary["errors"]["fluid.p"]["l2_rel"],
        "probe.mean density": summary["probes"]["mean density"]["value"],
        "probe.mean density.expected": 0.6, "probe.least u": summary["probes"]["least u"]["value"]}
    for key, value in same.items():
        good = row[key] == value if isinstance(value, str) else float(row[key]) == value
        expect(f"{row['id']} {key}", good, f"{row[key]} and {value}")
    expect("labels are settings", summary["particles"]["fluid"] == int(row["axis.particles"]) and summary["time"] == 0.02)
expect("--keep-runs keeps", all(any(name.endswith(".vtkhdf") for name in os.listdir(
    os.path.join(top, "some/runs", row["id"]))) for row in table))

before = open(os.path.join(top, "some/results.csv")).read()
done = run(chart, "--quiet")
expect("nothing is run twice", done.returncode == 0 and open(os.path.join(top, "some/results.csv")).read() == before
       and done.stdout == "", done.stdout + done.stderr)
expect("without --keep-runs summaries stay", not leftovers("some") and len(os.listdir(
    os.path.join(top, "some/runs"))) == 6, leftovers("some"))

# -- Pictures -----------------------------------------------------------------------------------------

root, texts = picture("cost")
expect("title and axes", {"A <tube> & its cost", "l1_rel of fluid.rho", "core-seconds"} <= set(texts), texts)
expect("what it shows", any("lower left is better; 6 runs" in text for text in texts), texts)
expect("series and slopes", {"cubic-spline", "c4"} <= set(texts) and
       sum(text.startswith("slope ") for text in texts) == 2, texts)
root, texts = picture("order")
expect("the order in the spacing", sum(text.startswith("order ") for text in texts) == 3, texts)
# Two runs in one dimension: the fit is the ratio of the errors.
coarse, fine = (float(r["error"]) for r in table if r["axis.kernel"] == "c4")
ratio = math.log(coarse / fine) / math.log(113 / 56)
expect("its value", f"order {ratio:.2f}" in [text.replace("−", "-") for text in texts], (ratio, texts))
root, texts = picture("map")
expect("errors in the cells", {f"{float(r['error']):.2g}" for r in table if r["axis.kernel"] == "cubic-spline"}
       <= set(texts), texts)

os.rename(os.path.join(top, "some/cost.svg"), os.path.join(top, "cost.svg"))
shutil.rmtree(os.path.join(top, "some/runs"))
done = run(chart, "--redraw")
expect("--redraw", done.returncode == 0 and not os.path.exists(os.path.join(top, "some/runs")), done.stderr)
expect("the same picture", open(os.path.join(top, "cost.svg")).read() == open(os.path.join(top, "some/cost.svg")).read())
done = run(chart, "--redraw", out="nothing")
expect("--redraw of nothing", done.returncode == 2 and "holds no results" in done.stderr, done.stderr)

# -- Failures are rows and marks ------------------------------------------------------------------------

failing = changed(chart, axes=[
    {"name": "case", "values": [
        {"label": "good", "set": {}},
        {"label": "refused", "set": {"kernel": "no-such"}},
        {"label": "tiny", "set": {"time.dt": 1e-40}},
        {"label": "wild", "set": {"time.dt": 0.02, "time.end": 0.6}},
        {"label": "endless", "set": {"time.dt": 1e-9}}]},
    {"name": "N", "values": [{"label": 56, "set": mass(0.01)}, {"label": 28, "set": mass(0.02)}]},
    {"name": "threads", "option": "threads", "values": [1]}],
    limit={"seconds": 1.5}, unstable=0.03, skip=[{"case": ["refused", "tiny", "wild", "endless"], "N": 28}],
    charts=[{"name": "cost", "kind": "cost", "series": ["case"], "x": "wall_s"},
            {"name": "map", "kind": "map", "x": "case", "y": "N"}])
done = run(failing, out="failing")
expect("failures are results", done.returncode == 0, done.stderr)
table = {(row["axis.case"], row["axis.N"]): row for row in rows("failing")}
expect("statuses", {key: row["status"] for key, row in table.items()} == {
    ("good", "56"): "done", ("good", "28"): "unstable", ("refused", "56"): "refused", ("tiny", "56"): "dt",
    ("wild", "56"): "u", ("endless", "56"): "timeout"}, {key: (row["status"], row["reason"], row["error"])
                                                           for key, row in table.items()})
for case, words in {("good", "28"): "is above 0.03", ("refused", "56"): "no-such", ("tiny", "56"): "time step",
                    ("wild", "56"): "became -", ("endless", "56"): "no end within 1.5 s"}.items():
    expect(f"reason of {case}", words in table[case]["reason"], table[case]["reason"])
late = table["endless", "56"]
expect("the cost so far of a timeout", 1 < float(late["wall_s"]) < 12 and float(late["particle_updates"]) > 0
       and late["error"] == "", late)
root, texts = picture("cost", "failing")
expect("marks at the top", any("6 runs, 5 failed (triangles at the top)" in text for text in texts) and
       "failed: 1 unstable, 1 dt, 1 u, 1 timeout, 1 refused" in texts, texts)
_, texts = picture("map", "failing")
expect("words in the cells", {"refused", "dt", "u", "timeout", "unstable", "skipped"} <= set(texts), texts)
kept = {row["id"]: row["wall_s"] for row in rows("failing")}
done = run(changed(failing, limit={"seconds": 1.6}, unstable=0.5), out="failing")
table = {(row["axis.case"], row["axis.N"]): row for row in rows("failing")}
expect("another bound needs no run", table["good", "28"]["status"] == "done" and
       kept[table["good", "28"]["id"]] == table["good", "28"]["wall_s"])
expect("another limit is tried", "1.6 s" in table["endless", "56"]["reason"])
expect("failures are not tried again", kept[table["wild", "56"]["id"]] == table["wild", "56"]["wall_s"])

# A crash.
done = run(changed(chart, load=[os.path.join(os.environ["top_builddir"], "tests/abi/.libs/crashing_init.so")],
                   axes=chart["axes"][3:], skip=[], charts=[]), out="crash")
if not os.environ.get("SPH_SANITIZED"):  # which would tell it in its own words
    expect("a crash", rows("crash")[0]["status"] == "crash" and "crashed" in rows("crash")[0]["reason"], rows("crash"))

# -- Killed at any moment -----------------------------------------------------------------------------

done = run(chart, out="whole")
random.seed(4)
kills = partial = 0
for attempt in range(60):
    path = scenes.write(chart, "some.chart.json")
    process = subprocess.Popen([SPH, "chart", path, "--out", os.path.join(top, "killed")], cwd=top,
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    try:
        said = process.communicate(timeout=random.uniform(0.01, 0.1 + 0.02 * attempt))[1]
        expect("the last one ends well", process.returncode == 0, said)
        break
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        kills += 1
        if os.path.exists(os.path.join(top, "killed/results.csv")):
            partial += 0 < len(rows("killed")) < 6  # whole whenever it is read
    if kills >= 12 and partial >= 3:
        break
for _ in range(100):
    if not processes(os.path.join(top, "killed")):
        break
    time.sleep(0.05)
expect("no child outlives it", not processes(os.path.join(top, "killed")))
expect("killed", kills >= 3 and partial >= 1, (kills, partial))
done = run(chart, out="killed")
expect("the same results", without_timing("killed") == without_timing("whole"))
expect("nothing is left over", not leftovers("killed"), leftovers("killed"))
for name in ("order.svg", "map.svg"):
    expect(f"the same {name}", open(os.path.join(top, "killed", name)).read()
           == open(os.path.join(top, "whole", name)).read())

# Between a run's end and its row: the run is not lost; a half one is.
shutil.copytree(os.path.join(top, "whole"), os.path.join(top, "between"))
table = rows("whole")
with open(os.path.join(top, "between/results.csv"), "w") as file:
    file.write("".join(open(os.path.join(top, "whole/results.csv")).readlines()[:3]))
half = os.path.join(top, "between/runs", table[2]["id"])
os.remove(os.path.join(half, "summary.json"))
for name in (os.path.join(half, "snapshot_0000.vtkhdf"), os.path.join(top, "between/.sph-aside-123-x.png")):
    open(name, "w").close()
done = run(chart, out="between")
again = rows("between")
expect("between", done.returncode == 0 and without_timing("between") == without_timing("whole"), done.stderr)
expect("finished runs are taken up", [row["wall_s"] for row in again[3:]] == [row["wall_s"] for row in table[3:]])
expect("the half one is made anew", again[2]["wall_s"] != table[2]["wall_s"] and not leftovers("between"))

# An interrupt says how to go on.
slow = changed(chart, set={"time.dt": 1e-9, "time.end": 0.02}, charts=[])
path = scenes.write(slow, "slow.json")
process = subprocess.Popen([SPH, "chart", path], cwd=top, stderr=subprocess.PIPE, text=True)
time.sleep(1)
process.send_signal(signal.SIGINT)
said = process.communicate(timeout=20)[1]
expect("an interrupt", process.returncode == 1 and "6 runs are left" in said and "sph chart" in said, said)
expect("its folder", not leftovers("slow.chart") and not processes(os.path.join(top, "slow.chart")))

# -- What was changed ------------------------------------------------------------------------------------

more = changed(chart)
more["axes"][2]["values"] = [0.3, 1, 2]
more["error"] = {"probe": "mean density"}
done = run(more, "--only", "particles=56", "--only", "C=1", "--only", "C=0.30", out="whole")
table = {(r["axis.particles"], r["axis.kernel"], r["axis.C"]): r for r in rows("whole")}
old = {(r["axis.particles"], r["axis.kernel"], r["axis.C"]): r for r in again}
expect("only what is new and wanted", set(table) - set(old) == {("56", "cubic-spline", "1"), ("56", "c4", "1")}
       and done.returncode == 0, (done.stderr, set(table) - set(old)))
expect("another error of the same runs", all(
    float(r["error"]) == abs(float(r["probe.mean density"]) - 0.6) for r in table.values()))
path = changed(more, error={"path": "conservation.momentum_drift.0"})
done = run(path, "--only", "C=1", "--only", "particles=56", out="whole")
with open(os.path.join(top, "whole/runs", rows("whole")[1]["id"], "summary.json")) as file:
    drift = json.load(file)["conservation"]["momentum_drift"][0]
expect("an error by its path", float(rows("whole")[1]["error"]) == abs(drift), done.stderr)

# -- The best, and others beside ---------------------------------------------------------------------------

table = rows("some")
errors = sorted(float(row["error"]) for row in table)
limit = (errors[2] + errors[3]) / 2
cheapest = min((row for row in table if float(row["error"]) <= limit), key=lambda r: float(r["core_seconds"]))
done = run(chart, "--best", "--error", f"{100 * limit}%", "--output-scene", os.path.join(top, "deeper.json"))
lines = done.stdout.splitlines()
expect("--best", done.returncode == 0 and len(lines) == 5 and lines[1].endswith(
    f"particles={cheapest['axis.particles']} kernel={cheapest['axis.kernel']} C={cheapest['axis.C']} threads=1"),
       done.stdout + done.stderr)
again = scenes.command("run", os.path.join(top, "deeper.json"), "--threads", "1", "--out", os.path.join(top, "deeper"), "-q")
expect("its scene runs", again.returncode == 0, again.stderr)
with open(os.path.join(top, "deeper/summary.json")) as file:
    expect("with the same error", json.load(file)["errors"]["fluid.rho"]["l1_rel"] == float(cheapest["error"]))
done = run(chart, "--best", "--error", str(limit), "--output-scene", "-")
expect("its scene alone", json.loads(done.stdout)["time"]["cfl"] == float(cheapest["axis.C"]), done.stdout)
done = run(chart, "--best", "--error", "1e-9")
expect("none is good enough", done.returncode == 1 and "the nearest" in done.stderr and f"{errors[0]:.4g}" in done.stderr,
       done.stderr)

with open(os.path.join(top, "peer.csv"), "w") as file:
    file.write("error,core_seconds\n0.04,0.1\n0.01,2\n")
peers = changed(chart, peers=[{"file": "peer.csv", "label": "Other 1.0", "source": "its manual"}])
done = run(peers, "--redraw")
_, texts = picture("cost")
expect("peers", {"Other 1.0", "Other 1.0: its manual", "no run of ours is better in both"} <= set(texts), texts)
_, texts = picture("order")
expect("peers only where they have an x", "Other 1.0" not in texts, texts)

# -- Wrong charts ------------------------------------------------------------------------------------------

ABSENT = object()
wrong = [
    ("titel", "T", "/titel: unknown key \"titel\" (did you mean \"title\"?)"), ("scene", ABSENT, "\"scene\" is missing"),
    ("scene", "no.json", "no.json"), ("axes", ABSENT, "\"axes\" is missing"), ("axes", [], "at least one axis"),
    ("axes.0.name", "a=b", "no \"=\""), ("axes.1.name", "C", "already"), ("axes.1.option", "threads", "not both"),
    ("axes.3.option", "thread", "did you mean \"threads\""), ("axes.3.values.0", 1.5, "/axes/3/values/0: 1.5"),
    ("axes.2.values", [], "without values"), ("axes.2.values.1", 0.3, "stands twice"),
    ("axes.2.values.1", [1], "no label"), ("axes.0.values.0", 56, "\"label\""),
    ("axes.0.values.0.set", {"particles.fluid.fill.7.x": 1}, "not an index"), ("set", [], "paths and values"),
    ("axes.1.values.1.valeu", 1, "unknown key"), ("skip.0.C", 5, "no label of axis \"C\""),
    ("skip.0.kernle", "c4", "did you mean \"kernel\""), ("skip.0", {}, "skips all"), ("error", ABSENT, "\"error\""),
    ("error.norm", "l1rel", "did you mean \"l1_rel\""), ("error.probe", "x", "one of"),
    ("error", {"path": "a.b", "norm": "l1"}, "only \"of\" has a norm"), ("limit", {"seconds": 0}, "positive"),
    ("unstable", -1, "positive"), ("charts.0.kind", "costs", "did you mean \"cost\""),
    ("charts.0.x", "core_second", "did you mean \"core_seconds\""), ("charts.0.x", "kernel", "positive numbers"),
    ("charts.0.y", "C", "only a map"), ("charts.0.series.0", "kernal", "did you mean \"kernel\""),
    ("charts.2.y", "C", "same axis"), ("charts.2.select", {}, "would hold 2 runs"), ("charts.1.name", "cost", "already"),
    ("charts.1.name", "a/b", "no name of a file"), ("peers", [{"file": "no.csv", "label": "x"}], "no.csv"),
    ("peers", [{"file": "scene.json", "label": "x"}], "scene.json"), ("load", "x", "list of plugins")]
for where, value, words in wrong:
    made = json.loads(json.dumps(chart))
    *way, last = [int(part) if part.isdigit() else part for part in where.split(".")]
    at = made
    for step in way:
        at = at[step]
    if value is ABSENT:
        del at[last]
    elif isinstance(at, list) and last == len(at):
        at.append(value)
    else:
        at[last] = value
    done = run(made, out="wrong", name="wrong.json")
    expect(f"{where} = {value}", done.returncode == 2 and words in done.stderr and done.stderr.count("\n") == 1
           and "wrong.json" in done.stderr and not os.path.exists(os.path.join(top, "wrong")), done.stderr)
done = run(changed(chart, error={"of": "fluid.roh"}), out="misspelt")
expect("an error that runs do not have", done.returncode == 2 and "/error/of:" in done.stderr and
       "did you mean \"fluid.rho" in done.stderr, done.stderr)
done = run(changed(chart), out="misspelt")
expect("mended", done.returncode == 0 and len(rows("misspelt")) == 6, done.stderr)
os.mkdir(os.path.join(top, "foreign"))
with open(os.path.join(top, "foreign/results.csv"), "w") as file:
    file.write("mine\n1\n")
done = run(chart, out="foreign")
expect("foreign results", done.returncode == 2 and "would be overwritten" in done.stderr and
       open(os.path.join(top, "foreign/results.csv")).read() == "mine\n1\n", done.stderr)
for words, sentence in {("--only", "C=7"): "no label \"7\"", ("--only", "D=7"): "no axis \"D\"", ("--only", "C"): "AXIS=LABEL",
                        ("--best",): "wants --error", ("--error", "1%"): "goes with --best",
                        ("--best", "--list", "--error", "1"): "exclude"}.items():
    done = run(chart, *words)
    expect(f"{words}", done.returncode == 2 and sentence in done.stderr, done.stderr)

# -- The schema, the manual, the program know the same keys ---------------------------------------------------

with open(os.path.join(EXAMPLES, "chart.schema.json")) as file:
    schema = json.load(file)
try:
    import jsonschema
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    with open(os.path.join(EXAMPLES, "sod.chart.json")) as file:
        shipped = json.load(file)
    for valid in (chart, failing, peers, path, shipped):
        for error in validator.iter_errors(valid):
            expect("the schema", False, error.message)
    for broken in ({**chart, "titel": 1}, {**chart, "error": {}}, {**chart, "axes": []}, {**chart, "skip": [{}]},
                   {**chart, "charts": [{"name": "a", "kind": "map", "x": "C"}]},
                   {**chart, "axes": [{"name": "a", "values": [1]}]}, {**chart, "error": {"path": "a", "norm": "l1"}}):
        expect("the schema refuses", not validator.is_valid(broken), broken)
except ImportError:
    print("no jsonschema: the schema is not tried")
source = ""
for name in ("read.c", "read_axes.c", "read_pictures.c"):
    with open(os.path.join(os.environ["top_srcdir"], "core/chart", name)) as file:
        source += file.read()
known = set(re.findall(r'"([^"]+)"', "".join(re.findall(r"keys\[\] = \{([^}]*)\}", source))))
parts = schema["definitions"]
described = set(schema["properties"]) | set(schema["properties"]["limit"]["properties"])
for part in ("axis", "labelled", "settings", "error", "picture", "peer"):
    described |= set(parts[part]["properties"])
expect("keys of program and schema", known == described, known ^ described)
with open(os.path.join(os.environ["top_srcdir"], "man/sph-chart.5")) as file:
    page = set(re.findall(r"^\.It Ic (\S+)", file.read(), re.M))
expect("keys of the manual", page == set(schema["properties"]), page ^ set(schema["properties"]))
done = scenes.command("chart", os.path.join(EXAMPLES, "sod.chart.json"), "--list")
expect("the example", done.returncode == 0 and done.stdout.count("particles=") >= 16, done.stderr)

print(f"{kills} kills, {partial} of them with some results, {len(wrong)} wrong charts")
scenes.end()

"""What a run leaves behind: the columns and rows of log.csv, the keys of summary.json, snapshots on time, the
options that shorten a run, one that is interrupted, ones that fail, and mpirun."""
import json
import math
import os
import shlex
import signal
import subprocess
import time

import numpy

from scenes import SPH, Scenes, Snapshot, changed, example

scenes = Scenes()
expect = scenes.expect
noh, sod = example("noh.json"), example("sod.json")
noh["particles"]["fluid"]["fill"]["spacing"] = 0.1
for scene in (noh, sod):
    scene["output"].pop("picture", None)
    scene.pop("profiles", None)
sod.pop("probes")

# -- A run to the end -----------------------------------------------------------------------------

result = scenes.good(changed(sod, time={"end": 0.03}, output={"every": 0.01, "log": {"steps": 7}}), quiet=False)
summary = result.summary()
expect("a table", "energy drift" in result.stdout and len(result.stdout.splitlines()) > 5, result.stdout)
expect("no progress in a pipe", result.stderr == "", result.stderr)
expect(
    "files",
    sorted(name for name in os.listdir(result.out) if not name.startswith("."))
    == ["log.csv", *(f"snapshot_{n:04}.vtkhdf" for n in range(4)), "summary.json"],
    os.listdir(result.out),
)
contract = {
    "": {"status", "scene", "particles", "steps", "time", "errors", "conservation", "cost", "plan", "versions",
         "plugins"},
    "conservation": {"energy_drift", "momentum_drift", "mass_drift"},
    "cost": {"wall_s", "loop_s", "neighbour_s", "pass_s", "io_s", "mpi_s", "particle_updates", "pairs",
             "ns_per_pair", "us_per_particle_update", "peak_rss_bytes", "bytes_per_particle"},
    "plan": {"arrays", "passes"},
}
for key, wanted in contract.items():
    part = summary[key] if key else summary
    expect(f"summary.json {key}", wanted <= part.keys(), sorted(wanted - part.keys()))
expect("status", summary["status"] == "done" and "reason" not in summary)
expect("particles", summary["particles"] == {"fluid": 450}, summary["particles"])
expect("time", summary["time"] == 0.03, summary["time"])
expect("errors", set(summary["errors"]) == {"fluid.rho", "fluid.p", "fluid.v"} | set(summary["errors"]))
for field in ("fluid.rho", "fluid.p", "fluid.v"):
    error = summary["errors"].get(field, {})
    expect(f"errors of {field}", {"l1", "l1_rel", "l2", "linf", "reference"} <= error.keys(), error)
    expect(f"sizes of {field}", 0 < error["l1"] < error["l2"] < error["linf"], error)
    expect(f"reference of {field}", error["reference"] == "riemann", error["reference"])
expect("plugins", {one["name"] for one in summary["plugins"]} == {"kernels", "eos", "gsph", "exact"})
expect("plugins' keys", all({"name", "version", "abi", "file"} <= one.keys() for one in summary["plugins"]))
expect("pass_s", set(summary["cost"]["pass_s"]) == {one["name"] for one in summary["plan"]["passes"]})
for key in ("pairs", "ns_per_pair", "us_per_particle_update", "loop_s", "bytes_per_particle"):
    expect(f"cost of {key}", summary["cost"][key] > 0, summary["cost"][key])
expect("updates", summary["cost"]["particle_updates"] == 450 * summary["steps"])
expect("sweeps that iterate", summary["cost"]["h_sweeps"] > summary["steps"], summary["cost"]["h_sweeps"])
expect("mass_drift", summary["conservation"]["mass_drift"] == 0)

names, rows = result.log()
expect(
    "columns of the log",
    names[:8] == ["step", "time", "dt", "kinetic", "internal", "potential", "momentum_x", "mass"]
    and names[-1] == "wall_s" and {"rho_max", "u_min"} <= set(names[8:-1]),
    names,
)
column = {name: [row[k] for row in rows] for k, name in enumerate(names)}
steps = summary["steps"]
expect("rows of the log", column["step"] == [*range(0, steps, 7), steps], column["step"])
expect("end of the log", column["time"][-1] == 0.03 and column["step"][-1] == steps)
expect("numbers of the log", all(math.isfinite(value) for row in rows for value in row))
last = result.last()
m, u, v = last["m"], last["u"], last["v"][:, 0]
for name, value in (
    ("kinetic", (m * v * v).sum() / 2), ("internal", (m * u).sum()), ("momentum_x", (m * v).sum()), ("mass", m.sum()),
):
    expect(f"{name} of the log", abs(column[name][-1] - value) < 1e-12 * max(1, abs(value)), value)
energy = [k + i + p for k, i, p in zip(column["kinetic"], column["internal"], column["potential"])]
worst = max(abs(one / energy[0] - 1) for one in energy)
drift = abs(summary["conservation"]["energy_drift"])
expect("energy drift", worst <= drift * (1 + 1e-6) + 1e-15 and drift < 1e-3, (worst, drift))
times = [Snapshot(path).time for path in result.snapshots()]
expect("times of the snapshots", times == [0.0, 0.01, 0.02, 0.03], times)
expect("steps of the snapshots", last.step == steps, last.step)

names, rows = scenes.good(noh, "--steps", "2").log()
expect(
    "columns of the log in 2D",
    names[6:10] == ["momentum_x", "momentum_y", "angular_z", "mass"],
    names,
)
expect("rows of the log in 2D", [row[0] for row in rows] == [0, 1, 2], rows)

# -- Options --------------------------------------------------------------------------------------

result = scenes.good(noh, "--until", "0.05")
expect("--until", result.summary()["time"] == 0.05 and result.last().time == 0.05, result.summary()["time"])
expect("--quiet", result.stdout == "" and result.stderr == "", result.stdout + result.stderr)
result = scenes.good(noh, "--steps", "3")
expect("--steps", result.summary()["steps"] == 3 and result.summary()["status"] == "done")
result = scenes.good(noh, "--steps", "0")
expect("--steps 0", result.summary()["steps"] == 0 and len(result.snapshots()) >= 1)
result = scenes.run(noh, "--until", "-1")
expect("--until before the begin", result.code == 2 and not os.path.exists(result.out), result.stderr)
result = scenes.run(noh, "--dry-run")
expect("--dry-run", result.code == 0 and "gsph-rates(fluid)" in result.stdout, result.stdout)
expect("--dry-run leaves nothing", not os.path.exists(result.out))
result = scenes.run(noh, "--steps", "many")
expect("--steps many", result.code == 2 and "many" in result.stderr, result.stderr)
result = scenes.run(noh, "--threads", "0")
expect("--threads 0", result.code == 2, result.stderr)

folder = os.path.join(scenes.scratch.name, "here")
os.mkdir(folder)
done = scenes.command(scenes.write(noh, "some.scene.json"), "--steps", "1", "-q", cwd=folder)
expect("folder by default", done.returncode == 0 and os.listdir(folder) == ["some.scene"], os.listdir(folder))
out = os.path.join(folder, "some.scene")
with open(os.path.join(out, "note.txt"), "w") as file:
    file.write("kept")
with open(os.path.join(out, "snapshot_0777.vtkhdf"), "wb") as file, open(
    os.path.join(out, "snapshot_0000.vtkhdf"), "rb"
) as old:
    file.write(old.read())
done = scenes.command("run", scenes.write(noh, "some.scene.json"), "--steps", "1", "-q", cwd=folder)
expect(
    "a second run cleans up after the first, and only that",
    done.returncode == 0 and os.path.exists(os.path.join(out, "note.txt"))
    and not os.path.exists(os.path.join(out, "snapshot_0777.vtkhdf")),
    os.listdir(out),
)

# -- Interrupted ----------------------------------------------------------------------------------

for number in (signal.SIGINT, signal.SIGTERM):
    out = os.path.join(scenes.scratch.name, f"stopped{number}")
    scene = changed(noh, time={"end": 1000.0, "dt_max": 1e-6})
    process = subprocess.Popen(
        [SPH, scenes.write(scene), "--out", out, "-q"], stderr=subprocess.PIPE, stdout=subprocess.PIPE
    )
    log = os.path.join(out, "log.csv")
    for _ in range(600):
        if os.path.exists(log) and os.path.getsize(log) > 2000:
            break
        time.sleep(0.05)
    process.send_signal(number)
    said = process.communicate(timeout=60)
    expect(f"exit code of {number!r}", process.returncode == 1, (process.returncode, said))
    with open(os.path.join(out, "summary.json")) as file:
        summary = json.load(file)
    expect(f"status of {number!r}", summary["status"] == "stopped" and summary["steps"] > 0, summary["status"])
    names = sorted(name for name in os.listdir(out) if name.startswith("snapshot_"))
    last = Snapshot(os.path.join(out, names[-1]))
    expect(
        f"snapshot of {number!r}",
        abs(last.time / summary["time"] - 1) < 1e-14 and last.step == summary["steps"],
        (last.time, summary["time"], last.step, summary["steps"]),
    )
    expect(f"values of {number!r}", numpy.isfinite(last["rho"]).all())
    with open(log) as file:
        tail = file.read().splitlines()[-1]
    expect(f"last row of {number!r}", int(tail.split(",")[0]) == summary["steps"], tail)

# -- Failed ---------------------------------------------------------------------------------------

wild = changed(noh)
wild["time"] = {"end": 0.6, "dt": 0.2}
wild["output"]["every"] = 0.2
# Numbers that no gas has: as a scene gives them, and as they come out of a step that is far too long.
bad = changed(noh)
bad["particles"]["fluid"]["fields"]["u"] = "0/0 + x"
result = scenes.run(bad, "--steps", "5")
expect("u is no number", result.code in (1, 2) and len(result.stderr.splitlines()) == 1, result.stderr)
failed = changed(sod, time={"end": 50, "cfl": 50}, output={"every": 0.01})
result = scenes.run(failed)
lines = result.stderr.splitlines()
expect("cfl = 50 fails", result.code == 1 and len(lines) == 1 and lines[0].startswith("sph: "), result.stderr)
if result.code == 1:
    summary = result.summary()
    expect("status of a failure", summary["status"] == "failed" and summary["reason"], summary["status"])
    expect("reason of a failure", summary["reason"] in result.stderr, (summary["reason"], result.stderr))
    for path in result.snapshots():
        Snapshot(path)
    expect("snapshot of a failure", len(result.snapshots()) > 0)
    expect("first snapshot of a failure", numpy.isfinite(Snapshot(result.snapshots()[0])["rho"]).all())
    expect("log of a failure", len(result.log()[1]) > 0)

# -- mpirun ---------------------------------------------------------------------------------------

mpirun = shlex.split(os.environ.get("MPIRUN") or "")
build = scenes.command("info", "--build").stdout
if mpirun and any(line.startswith("MPI ") and "not built in" not in line for line in build.splitlines()):
    # Open MPI's own memory, which it never gives back, is not ours to answer for.
    os.environ["ASAN_OPTIONS"] = "detect_leaks=0"
    result = scenes.run(noh, "--steps", "2", before=(*mpirun, "-n", "1"))
    expect("one rank", result.code == 0 and result.summary()["steps"] == 2, result.stderr)
    alone = scenes.good(noh, "--steps", "2")
    expect("one rank is no rank", (alone.last()["rho"] == result.last()["rho"]).all())
    result = scenes.run(noh, "--steps", "2", before=(*mpirun, "-n", "2"))
    expect("two ranks", result.code == 0 and result.summary()["steps"] == 2, result.stderr)
scenes.end()

"""Runs on a device that is not there, is not good enough, or fails: what cannot be begun is refused before a file is
touched; what fails in mid-run is told in one sentence with step and time, all that was written before is good, and
the run that goes on from the last checkpoint comes to the same bits. The faults are made by tests/opencl/faults.c."""
import glob
import json
import os
import re
import subprocess
import sys
import time

import h5py
import numpy

from scenes import Scenes, Snapshot, changed

scenes = Scenes()
expect = scenes.expect
ONLY = sys.argv[1:]  # parts
BUILD = os.environ["top_builddir"]
FAULTS = os.path.join(BUILD, "tests/opencl/.libs/faults.so")
ON = ("--device", "opencl", "--device-only")
DEVICE = r'device "[^"]+" '

scenes.need_device()

SCENE = {
    "title": "a flow between a periodic and a mirror side",
    "dimensions": 2,
    "plugins": ["kernels", "eos", "wcsph", "diagnostics"],
    "domain": {"min": [0, 0], "max": [1, 1], "sides": {"x": "periodic", "y": "mirror"}},
    "materials": {"m": {"eos": {"name": "linear", "c0": 1, "rho0": 1, "p0": 1}}},
    "particles": {"fluid": {
        "material": "m", "h_over_dx": 1.3, "fill": {"lattice": "square", "spacing": 0.05, "jitter": 0.2},
        "fields": {"rho": 1, "v": ["0.1 * sin(2*pi*x)*cos(2*pi*y)", "-0.1 * cos(2*pi*x)*sin(2*pi*y)"]}}},
    "scheme": {"name": "wcsph"},
    "time": {"end": 1, "steps": 60},
    "output": {"picture": False, "every": 0.1, "checkpoint": {"steps": 10, "keep": 9}},
}


def faulty(*faults):
    # A build with the address sanitizer wants its library to come first; it need not.
    asan = ":".join(filter(None, [os.environ.get("ASAN_OPTIONS"), "verify_asan_link_order=0"]))
    return {**os.environ, "SPH_FAULT": ",".join(faults), "LD_PRELOAD": FAULTS, "ASAN_OPTIONS": asan}


def part(name):
    return not ONLY or name in ONLY


def one_sentence(what, done, code, *parts):
    """Exit code and one line on stderr that has all parts, which are regular expressions."""
    expect(f"{what}: exit code", done.returncode == code, (done.returncode, done.stderr))
    expect(f"{what}: one sentence", done.stderr.startswith("sph: ") and done.stderr.count("\n") == 1 and not done.stdout,
           (done.stderr, done.stdout))
    for words in parts:
        expect(f"{what}: says {words}", re.search(words, done.stderr), done.stderr)
    return done


def refused(what, code, *parts, options=ON, scene=SCENE, faults=()):
    """What an earlier run has left stays as it is, and no new folder is made if `clean`."""
    path = scenes.write(scene, "refused.json")
    new = os.path.join(scenes.scratch.name, "new")
    for out in (new, good.out):
        before = listing(out)
        done = scenes.command(path, "--out", out, "-q", *options, env=faulty(*faults) if faults else None)
        one_sentence(what, done, code, *parts)
        expect(f"{what}: nothing is written", listing(out) == before, listing(out))
    if os.path.isdir(new):
        os.rmdir(new)


def listing(out):
    return {name: os.stat(os.path.join(out, name)).st_mtime_ns for name in os.listdir(out)} if os.path.isdir(out) else {}


def same(a, b):
    """Two snapshots, to the bit."""
    a, b = Snapshot(a), Snapshot(b)
    return a.time == b.time and a.column.keys() == b.column.keys() and all(
        a[name].tobytes() == b[name].tobytes() for name in a.column)


good = scenes.good(SCENE, *ON)
expect("the run is of several of everything", len(good.snapshots()) > 4 and good.summary()["cost"]["list_builds"] > 3,
       (good.snapshots(), good.summary()["cost"]))


# -- Refused before it begins ------------------------------------------------------------------------------

if part("refused"):
    refused("no device", 2, "no OpenCL device: install", "--device cpu needs none", faults=["no-devices"])
    refused("no such device", 2, "no OpenCL device 7: there (is|are) ", "sph info --devices",
            options=("--device", "opencl:7"))
    refused("no double precision", 2, DEVICE + "has no double precision", "--device cpu", faults=["no-fp64"])
    refused("no memory", 1, r"the scene needs about [0-9.]+ MB on " + DEVICE[:-1] + ", which has 2 MB",
            r"and [0-9.]+ MB in one buffer \(\w+\), which may have 2 MB", faults=["memory:2000000"])
    refused("a context that cannot be", 1, DEVICE + r"fails to open a context: CL_OUT_OF_HOST_MEMORY \(-6\)",
            faults=["clCreateContext:1:-6"])
    refused("a driver that builds nothing", 1, DEVICE + r"fails to build .*: CL_BUILD_PROGRAM_FAILURE \(-11\)",
            faults=["clBuildProgram:0:-11"])
    for n in (1, 2, 8, 12):
        refused(f"buffer {n}", 1, DEVICE + r"gives no room for [a-z].*: CL_MEM_OBJECT_ALLOCATION_FAILURE \(-4\)",
                faults=[f"clCreateBuffer:{n}:-4"])
    for n in (1, 9, 17, 18, 25, 30):
        refused(f"kernel {n}", 1, DEVICE + r"has no kernel \w+: CL_OUT_OF_RESOURCES \(-5\)",
                faults=[f"clCreateKernel:{n}:-5"])
    for option in (("--path", "reference"), ("--path", "avx2")):
        refused(" ".join(option), 2, "--path chooses among the processor's pair loops: leave --device out",
                options=(*ON, *option))
    refused("--audit", 2, "--audit watches what plugins do on the processor: leave --device out",
            options=(*ON, "--audit"))
    # What a plugin brings and does not compile: where, and whose.
    broken = changed(SCENE, scheme={"name": "wcsph", "edit": [{"insert": "no-such-word"}]})
    wrong = ("--load", os.path.join(BUILD, "tests/check/.libs/wrong_device.so"))
    refused("a body that does not compile", 3, '"no-such-word" of plugin "wrong-device": broken.body.h:3: does not '
            'compile on "', "no_such_word", scene=broken, options=(*ON, *wrong))

# -- On the processor instead -------------------------------------------------------------------------------

if part("processor"):
    alone = changed(SCENE, scheme={"name": "wcsph", "edit": [{"insert": "idle"}]})
    load = ("--load", os.path.join(BUILD, "tests/abi/.libs/good.so"), "--steps", "5")
    why = 'function "idle" of plugin "good" has no device body'
    path = scenes.write(alone)
    out = os.path.join(scenes.scratch.name, "alone")
    done = scenes.command(path, "--out", out, "-q", "--device", "opencl", *load)
    one_sentence("on the processor", done, 0, f"^sph: {why}: the scene runs on the processor\n$")
    there = scenes.good(alone, *load)
    expect("on the processor: its numbers", same(glob.glob(out + "/snapshot_*")[-1], there.snapshots()[-1])
           or len(there.snapshots()) != len(glob.glob(out + "/snapshot_*")))
    refused("on the device only", 2, f"^sph: --device-only: {why}, so that this scene can not run on a device",
            scene=alone, options=(*ON, *load))
    strict = scenes.good(SCENE, "--strict", *ON)
    expect("--strict", same(strict.snapshots()[-1], good.snapshots()[-1]))

# -- In mid-run ----------------------------------------------------------------------------------------------


def fails(what, fault, words):
    """One run with a fault in mid-run; then the same without it, from the last checkpoint."""
    path = scenes.write(SCENE, "fails.json")
    scenes.count += 1
    out = os.path.join(scenes.scratch.name, f"out{scenes.count}")
    done = scenes.command(path, "--out", out, "-q", "--threads", "1", *ON, env=faulty(*fault))
    one_sentence(what, done, 1, words)
    said = re.match(r"sph: step (\d+), t = ([0-9.e-]+): ", done.stderr)
    expect(f"{what}: says when", said, done.stderr)
    if not said:
        return None
    with open(os.path.join(out, "summary.json")) as file:
        summary = json.load(file)
    step = int(said[1])
    expect(f"{what}: the summary", summary["status"] == "failed" and summary["steps"] == step
           and f"sph: {summary['reason']}\n" == done.stderr, summary)
    names = sorted(os.listdir(out))
    expect(f"{what}: nothing is half written", not [name for name in names if name.startswith(".")], names)
    for name in names:
        if name.startswith("snapshot_") and name != sorted(n for n in names if n.startswith("snapshot_"))[-1]:
            expect(f"{what}: {name}", same(os.path.join(out, name), good.path(name)))
        if name.endswith(".h5"):
            h5py.File(os.path.join(out, name)).close()
    snapshots = [name for name in names if name.startswith("snapshot_")]
    if snapshots:  # the last may be of the state that failed
        last = Snapshot(os.path.join(out, snapshots[-1]))
        expect(f"{what}: the last snapshot", last.step <= step and (last.step == step or same(
            os.path.join(out, snapshots[-1]), good.path(snapshots[-1]))), (last.step, step))
    with open(os.path.join(out, "log.csv")) as file, open(good.path("log.csv")) as other:
        rows, whole = file.read().splitlines(), other.read().splitlines()
    # All but the last column: the clock.
    clock = [row.rsplit(",", 1)[0] for row in whole]
    expect(f"{what}: rows of the log", [row.rsplit(",", 1)[0] for row in rows] == clock[: len(rows)]
           and len(rows) <= step + 2, rows[-1:])
    kept = [name for name in names if re.match(r"checkpoint_\d", name)]
    expect(f"{what}: checkpoints", kept == [f"checkpoint_{s:08d}.h5" for s in range(10, step + 1, 10)][: len(kept)]
           and len(kept) >= (step - 1) // 10, (step, kept))
    if not kept:
        return step
    expect(f"{what}: says the checkpoint", f"the last checkpoint is of step {int(kept[-1][11:19])}: --resume latest "
           in done.stderr, done.stderr)
    done = scenes.command("--resume", "latest", path, "--out", out, "-q", "--threads", "1", *ON)
    expect(f"{what}: goes on", done.returncode == 0 and not done.stderr, done.stderr)
    again = sorted(glob.glob(os.path.join(out, "snapshot_*")))
    expect(f"{what}: as without a fault", [os.path.basename(name) for name in again] ==
           [os.path.basename(name) for name in good.snapshots()] and same(again[-1], good.snapshots()[-1]))
    expect(f"{what}: the failed state has gone", not os.path.exists(os.path.join(out, "checkpoint_failed.h5")))
    return step


def calls(function):
    """How many the whole run makes: the largest N that fails, by halves."""
    low, high = 1, 20000
    while high - low > 1:
        middle = (low + high) // 2
        done = scenes.command(scenes.write(SCENE), "--out", os.path.join(scenes.scratch.name, "calls"), "-q", *ON,
                              env=faulty(f"{function}:{middle}:-5"))
        low, high = (middle, high) if done.returncode else (low, middle)
    return low


if part("mid-run"):
    LOSES = {"clEnqueueNDRangeKernel": "fails to run [a-z]", "clEnqueueReadBuffer": r"fails to read \d+ bytes",
             "clEnqueueWriteBuffer": r"fails to write \d+ bytes", "clEnqueueCopyBuffer": r"fails to copy \d+ bytes",
             "clEnqueueFillBuffer": r"(fails to fill \d+ bytes|gives no room for )"}
    for function, words in LOSES.items():
        begun = time.time()
        n = calls(function)
        steps = [fails(f"{function} {k}", [f"{function}:{k}:-5"], DEVICE + words + r".*: CL_OUT_OF_RESOURCES \(-5\)")
                 for k in sorted({n // 3, *range(n // 2, min(n // 2 + 12, n), 2), n - 2, n})]
        print(f"{function}: {n} calls; failed at steps {steps}; {time.time() - begun:.0f} s")
    # Waiting for events: once in so many commands.
    fails("clWaitForEvents", ["clWaitForEvents:1:-14"], DEVICE + "fails to do ")

# -- Memory --------------------------------------------------------------------------------------------------


def estimate(scene, *options):
    """What `sph plan` says [bytes]; a device is not needed for it."""
    done = scenes.command("plan", scenes.write(scene), "--device", "opencl", *options, env=faulty("no-devices"))
    found = re.search(r"^device memory: about ([0-9.e+]+) MB: columns ([0-9.e+]+), neighbour lists ([0-9.e+]+), search "
                      r"([0-9.e+]+)\n +the largest buffer ([0-9.e+]+) \([^)]+\)$", done.stdout, re.MULTILINE)
    expect("the plan tells the memory", done.returncode == 0 and found, (done.stdout[-300:], done.stderr))
    return [1e6 * float(word) for word in found.groups()]


if part("memory"):
    fine = changed(SCENE, output={"picture": False, "checkpoint": {"steps": 5, "keep": 99}})
    fine["particles"]["fluid"]["fill"]["spacing"] = 0.02
    cube = changed(fine, dimensions=3, domain={"min": [0] * 3, "max": [1] * 3, "sides": {"x": "periodic", "y": "mirror"}})
    cube["particles"]["fluid"]["fill"]["spacing"] = 0.05
    cube["particles"]["fluid"]["fields"]["v"] = [0.1, 0, 0]
    open_sides = changed(cube, domain={"min": [0] * 3, "max": [1] * 3})
    for name, scene in (("2D", fine), ("3D", cube), ("open", open_sides)):
        for precision in ("double", "mixed"):
            total, columns, lists, search, largest = estimate(scene, "--precision", precision)
            expect(f"{name}: its parts", abs(columns + lists + search - total) < 0.01 * total and 0 < largest < total)
            # As much as is said is enough ...
            out = os.path.join(scenes.scratch.name, f"enough-{name}-{precision}")
            words = (scenes.write(scene), "--out", out, "-q", "--precision", precision, *ON)
            done = scenes.command(*words, "--steps", "25", env=faulty(f"memory:{int(1.02 * total)}"))
            expect(f"{name}, {precision}: is enough", done.returncode == 0, done.stderr)
            # ... and a little less is refused.
            done = scenes.command(*words, "--steps", "2", env=faulty(f"memory:{int(0.95 * total)}"))
            one_sentence(f"{name}, {precision}: less", done, 1, "the scene needs about ")
    # Lists that grow beyond what there is.
    grows = changed(fine, domain={"min": [0, 0], "max": [1, 1]}, scheme={"name": "wcsph", "edit": [{"operation": "assignment", "of": "h", "expression": "1.04 * h"}]},
                    watch=False)
    path, out = scenes.write(grows), os.path.join(scenes.scratch.name, "grows")
    total = estimate(grows)[0]
    done = scenes.command(path, "--out", out, "-q", "--threads", "1", *ON, env=faulty(f"memory:{int(1.1 * total)}"))
    one_sentence("lists that grow", done, 1, r"^sph: step \d+, t = [0-9.]+: neighbours of \"fluid\": device .* has no room "
                 r"for neighbour lists: \d+ bytes beside the \d+ in use, of \d+; the last checkpoint is of step \d+: ")
    step = int(re.match(r"sph: step (\d+)", done.stderr)[1])
    names = sorted(os.listdir(out))
    expect("lists that grow: the failed state", "checkpoint_failed.h5" in names and step > 5
           and Snapshot(os.path.join(out, [n for n in names if n.startswith("snapshot")][-1])).step == step, names)
    done = scenes.command("--resume", "latest", path, "--out", out, "-q", "--threads", "1", "--steps", str(step + 3), *ON)
    whole = scenes.good(grows, "--steps", str(step + 3), *ON)
    expect("lists that grow: goes on where there is room", done.returncode == 0
           and same(sorted(glob.glob(out + "/snapshot_*"))[-1], whole.snapshots()[-1]), done.stderr)
    print(f"lists grew until step {step}")

# -- Several devices, and a part of one ------------------------------------------------------------------------

if part("several"):
    two = {**os.environ, "POCL_DEVICES": "pthread pthread"}
    listed = re.findall(r"^opencl:(\d+)", scenes.command("info", "--devices", env=two).stdout, re.MULTILINE)
    if len(listed) < 2:
        print("this driver makes no second device of the processor")
    else:
        expect("listed", listed == ["0", "1"], listed)
        path, outs, runs = scenes.write(SCENE), [], []
        # Both build all programs at once, into one empty cache.
        two["SPH_CACHE_DIR"] = os.path.join(scenes.scratch.name, "cache")
        for round_ in range(2):
            runs = []
            for number in (0, 1):
                out = os.path.join(scenes.scratch.name, f"two{round_}{number}")
                words = [path, "--out", out, "-q", "--device", f"opencl:{number}", "--device-only"]
                runs.append((out, subprocess.Popen([os.environ["SPH"], *words], env=two, stderr=subprocess.PIPE, text=True)))
            for number, (out, run) in enumerate(runs):
                said = run.communicate(timeout=300)[1]
                expect(f"device {number} of two", run.returncode == 0 and not said, (run.returncode, said))
                expect(f"device {number} of two: its numbers",
                       same(sorted(glob.glob(out + "/snapshot_*"))[-1], good.snapshots()[-1]))
        left = [name for _, _, names in os.walk(two["SPH_CACHE_DIR"]) for name in names]
        expect("the cache", left and not [name for name in left if ".tmp" in name or name.startswith(".")], left)

def busy_threads(process):
    """How many of a process's threads beside the main one have worked, each more than a quarter of all, and all
    their ticks. PoCL gives copies to any of its threads, one at a time."""
    ticks = []
    while process.poll() is None:
        found = []
        for name in set(glob.glob(f"/proc/{process.pid}/task/*/stat")) - {f"/proc/{process.pid}/task/{process.pid}/stat"}:
            try:
                with open(name) as file:
                    found.append(sum(int(word) for word in file.read().rsplit(")", 1)[1].split()[11:13]))
            except OSError:
                pass  # it has ended
        ticks = found if sum(found) > sum(ticks) else ticks
        time.sleep(0.02)
    return sum(t > 0.25 * sum(ticks) for t in ticks), sum(ticks)


if part("threads") and os.cpu_count() > 1 and "pthread" in scenes.command("info", "--devices").stdout:
    large = changed(SCENE, output={"picture": False})
    large["particles"]["fluid"]["fill"]["spacing"] = 0.005
    large["time"]["steps"] = 150
    path, states = scenes.write(large), []
    for threads in (1, 2):
        out = os.path.join(scenes.scratch.name, f"threads{threads}")
        words = [os.environ["SPH"], path, "--out", out, "-q", *ON, "--threads", str(threads)]
        with subprocess.Popen(words) as process:
            busy, ticks = busy_threads(process)
        print(f"--threads {threads}: {busy} threads busy, {ticks} ticks")
        expect(f"{threads} threads", process.returncode == 0 and ticks > 20 and busy == threads, (busy, ticks))
        states.append(sorted(glob.glob(out + "/snapshot_*"))[-1])
    expect("threads: the same bits", same(*states))

scenes.end()

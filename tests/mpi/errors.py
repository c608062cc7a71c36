"""An error on any rank ends the run on all of them, with one sentence, the exit code of the error and within a bound:
on the command line, in the scene, with a plugin, the output folder, a function in mid-step, a number that is none,
memory that is refused at any call of a rank, a full disk. A signal to any rank, or to mpirun, ends the run after a step,
with its results whole. What is no run the first rank does alone. SPH_TRIES: how many calls for memory (6)."""
import fcntl
import json
import math
import os
import resource
import shutil
import signal
import sys
import time

import h5py

from launch import BOUND, SPH, Job, Scenes, Snapshot, changed, example, need, wrapper

need()
scenes = Scenes()
expect = scenes.expect
ONLY = sys.argv[1:]  # parts
BUILD = os.environ["top_builddir"]
SOURCE = os.environ["top_srcdir"]
MODULES = os.path.join(BUILD, "tests", "abi", ".libs")
SCRATCH = scenes.scratch.name
FEW = ("--threads", "1", "--quiet")
TRIES = int(os.environ.get("SPH_TRIES", "6"))
count = 0

# It goes on for as long as it is let.
LONG = {
    "title": "a flow that goes round and round",
    "dimensions": 2,
    "plugins": ["kernels", "eos", "wcsph"],
    "domain": {"min": [0, 0], "max": [1, 1], "sides": {"x": "periodic", "y": "mirror"}},
    "materials": {"m": {"eos": {"name": "linear", "c0": 1, "rho0": 1, "p0": 1}}},
    "particles": {"fluid": {
        "material": "m", "h_over_dx": 1.3, "fill": {"lattice": "square", "spacing": 0.05, "jitter": 0.2},
        "fields": {"rho": 1, "v": ["0.1 * sin(2*pi*x)*cos(2*pi*y)", "-0.1 * cos(2*pi*x)*sin(2*pi*y)"]}}},
    "scheme": {"name": "wcsph"},
    "time": {"end": 1000},
    "output": {"picture": False, "every": 0.1, "log": {"steps": 10}},
}


def part(name):
    return not ONLY or name in ONLY


def path(*names):
    return os.path.join(SCRATCH, *names)


def fresh():
    global count
    count += 1
    return path(f"o{count}")


def whole(out):
    """Nothing is half written in a folder."""
    names = os.listdir(out) if os.path.isdir(out) else []
    for name in sorted(name for name in names if name.endswith((".vtkhdf", ".h5"))):
        try:
            read = []
            if name.endswith(".vtkhdf"):
                Snapshot(os.path.join(out, name))
            with h5py.File(os.path.join(out, name)) as file:
                file.visititems(lambda _, one: read.append(one[()]) if isinstance(one, h5py.Dataset) else None)
            if not read:
                return f"{name}: holds nothing"
        except (OSError, RuntimeError, KeyError, ValueError) as error:
            return f"{name}: {error}"
    return ", ".join(name for name in names if name.startswith(".sph-aside"))


def ended(what, job, code, *words, out=None):
    """With this code, in time, and with one sentence that has all the words."""
    job.end(BOUND)
    good = job.returncode == code and len(job.said) == 1 and all(word in job.said[0] for word in words)
    good = good and job.seconds < BOUND and not job.stdout
    print(f"{'ok  ' if good else 'bad '} {what}: exit code {job.returncode}, {job.seconds:.1f} s, {job.said}")
    expect(what, good, job.stderr + job.stdout)
    if out:
        expect(f"{what}: nothing is half written", not whole(out), whole(out))


def fails(what, code, *words, ranks=3, scene="noh-1d.json", options=(), before=(), left=False, env=None):
    out = fresh()
    file = scenes.write(scene, f"s{count}.json") if isinstance(scene, dict) else os.path.join(SOURCE, "examples", scene)
    job = Job(ranks, *before, SPH, file, "--out", out, *FEW, *options, env=env)
    ended(what, job, code, *words, out=out)
    if not left:
        expect(f"{what}: nothing is left", not os.path.exists(out) or not os.listdir(out))
    return out


# -- Before it begins --------------------------------------------------------------------------------------------

if part("begin"):
    noh = example("noh-1d.json")
    fails("no such scene", 2, "none.json: cannot be read", scene="none.json")
    fails("a wrong scene", 2, "/time/end", scene=changed(noh, time={"end": -1}))
    fails("a scene of no known scheme", 2, '"none"', scene=changed(noh, scheme={"name": "none"}))
    fails("fields that do not compile", 2, "nosuch", scene=changed(noh, particles={
        "fluid": {**noh["particles"]["fluid"], "fields": {"rho": "nosuch(x)"}}}))
    fails("an end before the begin", 2, "--until -1", options=("--until", "-1"))
    fails("no checkpoint", 2, "cannot read the folder", options=("--resume", "latest"))
    fails("a wrong path of pair loops", 2, "--path", options=("--path", "none"))
    job = Job(3, SPH, "run", "--none").end(BOUND)
    lines = [line for line in job.stderr.splitlines() if "unrecognized" in line]
    expect("an unknown option", job.returncode == 2 and len(lines) == 1, job.stderr)
    for k in range(5):  # whichever rank is first
        ended("no command", Job(3, SPH, "none"), 2, '"none" is neither a command nor a scene file')

    # One rank's scene, or plugin, is not as the others'.
    good = os.path.join(SOURCE, "examples", "noh-1d.json")
    own = wrapper(SCRATCH, "own.sh", f'[ $rank != 1 ] || cd {path("elsewhere")}')
    os.mkdir(path("elsewhere"))
    shutil.copy(good, path("scene.json"))
    job = Job(3, own, SPH, "scene.json", "--out", fresh(), *FEW, options=("--wdir", SCRATCH))
    ended("a scene that one rank cannot read", job, 2, "rank 1: scene.json: cannot be read")
    shutil.copytree(os.path.join(BUILD, "plugins", ".libs"), path("plugins"), symlinks=True)
    with open(path("plugins", "gsph.so"), "r+b") as file:
        file.truncate(2000)
    cut = wrapper(SCRATCH, "cut.sh", f'[ $rank != 2 ] || export SPH_PLUGIN_PATH={path("plugins")}')
    fails("a plugin that is cut short on one rank", 3, "rank 2: ", path("plugins", "gsph.so"), before=[cut])
    fails("a plugin whose init fails", 3, "the moon is not full",
          options=("--load", os.path.join(MODULES, "failing_init.so")))

    # The output folder.
    out = path("locked")
    os.mkdir(out)
    with open(os.path.join(out, ".sph-lock"), "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        ended("a locked folder", Job(3, SPH, good, "--out", out, *FEW), 2, f"rank 0: the output folder {out} is in use")
    with open(path("file"), "w"):
        pass
    ended("a file for a folder", Job(3, SPH, good, "--out", path("file"), *FEW), 2, "rank 0: ", "is not a folder")
    out = fresh()
    os.mkdir(out)
    with open(os.path.join(out, "log.csv"), "w") as file:
        file.write("mine\n")
    ended("a folder with what is not ours", Job(3, SPH, good, "--out", out, *FEW), 2, "rank 0: ", "log.csv is not of")
    with open(os.path.join(out, "log.csv")) as file:
        expect("a folder with what is not ours: it stays", file.read() == "mine\n" and os.listdir(out) == ["log.csv"])

# -- In mid-run --------------------------------------------------------------------------------------------------


def function(module, name):
    return ("--load", os.path.join(MODULES, module + ".so"), "--set", f'scheme.edit=[{{"insert":"{name}"}}]')


def reason(what, out, words):
    try:
        with open(os.path.join(out, "summary.json")) as file:
            text = file.read()
    except OSError:
        text = ""
    expect(f"{what}: the summary tells", '"failed"' in text and words in text, text)


if part("step"):
    for ranks in (2, 3):
        what = f"a function fails for one particle, {ranks} ranks"
        words = "fail-one(fluid) at step 2"
        reason(what, fails(what, 1, "rank ", words, ranks=ranks, options=function("failing_run", "fail-one"), left=True),
               words)
        what = f"a function fails everywhere, {ranks} ranks"
        words = "fail-all(fluid) at step 2"
        reason(what, fails(what, 1, words, ranks=ranks, options=function("failing_run", "fail-all"), left=True), words)
    for name in ("nan-rate", "nan-aside"):
        what = f"{name} for one particle"
        words = "for particle 7 of array"
        reason(what, fails(what, 1, words, options=function("nan_result", name), left=True), words)

# -- Memory ------------------------------------------------------------------------------------------------------

# A sanitizer has a malloc of its own.
if part("memory") and not os.environ.get("SPH_SANITIZED", "").strip():
    library = os.path.join(BUILD, "tests", "mpi", ".libs", "no_memory.so")
    refuse = wrapper(SCRATCH, "refuse.sh",
                     f'[ $rank != "$SPH_POOR" ] || LD_PRELOAD={library} SPH_NO_MEMORY=$SPH_FROM '
                     f'SPH_MEMORY_CALLS={path("calls")}\n'
                     '[ -z "$LD_PRELOAD" ] || export LD_PRELOAD SPH_NO_MEMORY SPH_MEMORY_CALLS')
    scene = changed(LONG, time={"end": 0.12}, output={"picture": False, "every": 0.05, "checkpoint": {"steps": 10}})
    for poor in (0, 2):
        job = Job(3, refuse, SPH, scenes.write(scene), "--out", fresh(), *FEW,
                  env={"SPH_POOR": str(poor), "SPH_FROM": "0"}).end(BOUND)
        with open(path("calls")) as file:
            calls = int(file.read())
        expect("memory: a run that has it", job.returncode == 0 and calls > 100, (job.stderr, calls))
        print(f"rank {poor} asks {calls} times for memory")
        silent = 0
        # One call, or all from one on.
        tries = [(1 + (calls - 1) * k // (TRIES - 1), 1) for k in range(TRIES)]
        tries += [(calls * k // (TRIES // 3), calls) for k in range(1, TRIES // 3)]
        for n, few in tries:
            out = fresh()
            job = Job(3, refuse, SPH, scenes.write(scene), "--out", out, *FEW,
                      env={"SPH_POOR": str(poor), "SPH_FROM": str(n), "SPH_FEW": str(few)}).end(BOUND)
            what = f"memory: call {n}{' and on' if few > 1 else ''} of rank {poor}"
            # What can do without goes on.
            done = job.returncode == 0 and not job.said
            silent += done
            told = job.returncode in (1, 2, 3) and len(job.said) == 1 and f"rank {poor}: " in job.said[0]
            told = told and "memory" in job.said[0]
            print(f"{what}: exit code {job.returncode}, {job.seconds:.1f} s, {job.said}")
            expect(what, done or told, job.stderr)
            expect(f"{what}: nothing is half written", not whole(out), whole(out))
        expect("memory: it matters", silent <= len(tries) // 3, silent)

# -- Disk --------------------------------------------------------------------------------------------------------


def under_way(job, out, what):
    """Waits until the run has made a snapshot after its first."""
    while not os.path.exists(os.path.join(out, "snapshot_0001.vtkhdf")):
        if job.process.poll() is not None or time.monotonic() > job.begin + BOUND:
            expect(f"{what}: it runs", False, job.end(1).stderr)
            return {}
        time.sleep(0.01)
    return job.ranks()


if part("disk"):
    out = fresh()
    job = Job(3, SPH, scenes.write(LONG), "--out", out, *FEW)
    ranks = under_way(job, out, "a full disk")
    if ranks:
        # A limit that the next snapshot meets, as a full disk would be.
        resource.prlimit(ranks[0], resource.RLIMIT_FSIZE, (4096, resource.RLIM_INFINITY))
        job.begin = time.monotonic()
    ended("a full disk", job, 1, "rank 0: cannot write ", out, out=out)

    # One that fails as files are made safe: at the end of a snapshot or a checkpoint, which only one rank does.
    library = os.path.join(BUILD, "tests", "mpi", ".libs", "no_sync.so")
    fail = wrapper(SCRATCH, "fail.sh", f'[ $rank != 0 ] || export LD_PRELOAD="{library} $LD_PRELOAD"')
    scene = changed(LONG, time={"end": 0.12}, output={"picture": False, "every": 0.05, "checkpoint": {"steps": 5}})
    failed = 0
    for call in range(1, 9):
        out = fresh()
        job = Job(3, fail, SPH, scenes.write(scene), "--out", out, *FEW, env={"SPH_NO_SYNC": str(call)}).end(BOUND)
        print(f"fsync {call} fails: exit code {job.returncode}, {job.seconds:.1f} s, {job.said}")
        failed += job.returncode == 1
        expect(f"fsync {call} fails: all end, with one sentence", job.returncode == 1 and len(job.said) == 1, job.stderr)
        expect(f"fsync {call} fails: nothing is half written", not whole(out), whole(out))
    expect("a disk that fails: it matters", failed > 4, failed)

# -- Signals -----------------------------------------------------------------------------------------------------


def stopped(number, whom):
    what = f"{signal.Signals(number).name} to {whom}"
    out = fresh()
    job = Job(3, SPH, scenes.write(LONG), "--out", out, *FEW)
    ranks = under_way(job, out, what)
    for rank, pid in ranks.items():
        if whom == "all ranks" or whom == f"rank {rank}":
            os.kill(pid, number)
    if whom == "mpirun":
        os.kill(job.process.pid, number)
    job.begin = time.monotonic()
    job.end(BOUND)
    names = os.listdir(out)
    try:
        with open(os.path.join(out, "summary.json")) as file:
            status = file.read()
    except OSError:
        status = ""
    last = Snapshot(os.path.join(out, max(name for name in names if name.endswith(".vtkhdf"))))
    print(f"{what}: exit code {job.returncode}, {job.seconds:.1f} s, {job.said}, step {last.step}, t = {last.time:g}")
    expect(f"{what}: ends", job.returncode not in (None, 0) and job.seconds < BOUND, (job.returncode, job.stderr))
    expect(f"{what}: says nothing more", not job.said, job.stderr)
    expect(f"{what}: stopped", '"stopped"' in status, status[:40])
    expect(f"{what}: nothing is half written", not whole(out), whole(out))
    told = json.loads(status or "{}")
    expect(f"{what}: a snapshot of its end", last.step == told.get("steps") and math.isclose(last.time, told.get("time")),
           (last.step, last.time, told.get("steps"), told.get("time")))


if part("signal"):
    for number in (signal.SIGTERM, signal.SIGINT):
        for whom in ("rank 0", "rank 2", "all ranks", "mpirun"):
            stopped(number, whom)

# -- What is no run ----------------------------------------------------------------------------------------------

if part("alone"):
    noh = os.path.join(SOURCE, "examples", "noh-1d.json")
    out = fresh()
    scenes.command(noh, "--out", out, *FEW, "--steps", "2")
    snapshot = os.path.join(out, "snapshot_0001.vtkhdf")
    for words in (["--version"], ["--help"], ["info", "gsph"], ["check", noh], ["run", "--help"]):
        alone = scenes.command(*words)
        job = Job(3, SPH, *words).end(BOUND)
        expect(f"on ranks: {words}", (job.returncode, job.stdout, job.stderr) == (0, alone.stdout, alone.stderr),
               job.stderr + job.stdout)
    alone, job = scenes.command("plan", noh), Job(3, SPH, "plan", noh).end(BOUND)
    expect("on ranks: plan, and how they share the domain",
           (job.returncode, job.stderr) == (0, "") and job.stdout.startswith(alone.stdout + "ranks: 3, cut by rcb\n") and
           job.stdout.count("ranks: 3") == 1, job.stderr + job.stdout)
    job = Job(3, SPH, "render", snapshot, "--field", "rho", "--out", path("picture.png")).end(BOUND)
    expect("on ranks: render", job.returncode == 0 and os.path.exists(path("picture.png")), job.stderr)
    job = Job(3, SPH, "new-plugin", "mine", options=("--wdir", SCRATCH)).end(BOUND)
    expect("on ranks: new-plugin", job.returncode == 0 and os.path.isdir(path("mine")), job.stderr)
    ended("on ranks: chart", Job(3, SPH, "chart", noh), 2, "`sph chart' starts runs of its own", "on 3 ranks")
    dry = scenes.command(noh, "--dry-run")
    job = Job(3, SPH, noh, "--dry-run").end(BOUND)
    expect("on ranks: --dry-run", (job.returncode, job.stdout) == (0, dry.stdout), job.stderr + job.stdout)

scenes.end()

"""A run on several ranks of which one is killed, at moments that nobody chooses: all end at once, no file under its own
name is torn, and the run goes on from its last checkpoint on another number of ranks to the bits of a run that was left
alone. A plain start in the folder says from where one could go on, and keeps that until it has come as far. A launcher
that is killed takes its ranks with it. SPH_KILLS: how often (3); SPH_SEED: which moments."""
import glob
import os
import random
import re
import signal
import time

import h5py

from launch import BOUND, SPH, Job, Scenes, Snapshot, gone, need

need()
scenes = Scenes()
expect = scenes.expect
KILLS = int(os.environ.get("SPH_KILLS", "3"))
SEED = int(os.environ.get("SPH_SEED") or random.SystemRandom().randrange(10**6))
print(f"SPH_SEED={SEED}")
chance = random.Random(SEED)
EACH = ("--threads", "1", "--quiet", "--strict")

SCENE = scenes.write({
    "title": "a flow that is cut off",
    "dimensions": 2,
    "plugins": ["kernels", "eos", "wcsph"],
    "domain": {"min": [0, 0], "max": [1, 1], "sides": {"x": "periodic", "y": "mirror"}},
    "materials": {"m": {"eos": {"name": "linear", "c0": 1, "rho0": 1, "p0": 1}}},
    "particles": {"fluid": {
        "material": "m", "h_over_dx": 1.3, "fill": {"lattice": "square", "spacing": 0.03125, "jitter": 0.2},
        "fields": {"rho": 1, "v": ["0.1 * sin(2*pi*x)*cos(2*pi*y)", "-0.1 * cos(2*pi*x)*sin(2*pi*y)"]}}},
    "scheme": {"name": "wcsph"},
    "time": {"end": 1},
    "output": {"picture": False, "every": 0.05, "checkpoint": {"steps": 5, "keep": 2}},
}, "cut.json")


def fresh():
    scenes.count += 1
    return os.path.join(scenes.scratch.name, f"out{scenes.count}")


def run(ranks, out, *words):
    return Job(ranks, SPH, *words, "--out", out, *EACH)


def newest(out):
    """The step of the last checkpoint; 0: none."""
    steps = [int(name[-11:-3]) for name in glob.glob(os.path.join(out, "checkpoint_0*.h5"))]
    return max(steps, default=0)


def torn(out):
    """The first file that cannot be read to its end."""
    for path in sorted(glob.glob(os.path.join(out, "*.vtkhdf")) + glob.glob(os.path.join(out, "checkpoint_*.h5"))):
        try:
            read = []
            with h5py.File(path) as file:
                file.visititems(lambda name, one: read.append(one[()]) if isinstance(one, h5py.Dataset) else None)
            if not read:
                return f"{path}: holds nothing"
        except (OSError, RuntimeError) as error:
            return f"{path}: {error}"
    return ""


def differ(a, b):
    """The first snapshot of two folders that is not the same to the bit."""
    names = [sorted(os.path.basename(path) for path in glob.glob(os.path.join(out, "*.vtkhdf"))) for out in (a, b)]
    if names[0] != names[1]:
        return names
    for name in names[0]:
        one, other = (Snapshot(os.path.join(out, name)) for out in (a, b))
        if one.time != other.time or one.step != other.step or one.column.keys() != other.column.keys() or any(
                one[key].tobytes() != other[key].tobytes() for key in one.column):
            return name
    return ""


def kill(job, out, what, whom=None):
    """Kills a rank at any moment; whether the run was still going on."""
    rank = chance.randrange(3) if whom is None else whom
    moment = chance.uniform(0.0, 1.0) * length
    ranks = {}
    while rank not in ranks or time.monotonic() < job.begin + moment:
        ranks = ranks or job.ranks()
        if job.process.poll() is not None or time.monotonic() > job.begin + BOUND:
            break
        time.sleep(0.003)
        if rank not in ranks:
            ranks = {}
    begun = newest(out)
    try:
        os.kill(ranks[rank], signal.SIGKILL)
        killed = True
    except (KeyError, ProcessLookupError):
        killed = False
    job.begin = time.monotonic()
    job.end(BOUND)
    killed = killed and job.returncode != 0
    print(f"{what}: rank {rank} after {moment:.2f} s, at step {begun}: exit code {job.returncode} after {job.seconds:.1f} s")
    expect(f"{what}: all end", job.returncode is not None and job.seconds < BOUND, job.stderr)
    if killed:
        left = gone(ranks, job.begin + BOUND)
        expect(f"{what}: no rank is left", not left, left)
    expect(f"{what}: nothing is torn", not torn(out), torn(out))
    return killed


def goes_on(what, out, ranks):
    """From the last checkpoint, if there is one yet, to the same bits."""
    begun = newest(out)
    words = ("--resume", "latest") if begun else (SCENE,)
    job = run(ranks, out, *words).end()
    expect(f"{what}: goes on from step {begun} on {ranks} ranks", job.returncode == 0, job.stderr)
    if job.returncode == 0:
        expect(f"{what}: the same bits", not differ(out, whole.out), differ(out, whole.out))
        expect(f"{what}: nothing is left aside", not glob.glob(os.path.join(out, ".sph*")), os.listdir(out))


whole = scenes.good(SCENE, "--strict")
out = fresh()
job = run(3, out, SCENE).end()
length = job.seconds
expect("three ranks", job.returncode == 0, job.stderr)
expect("three ranks: the same bits", not differ(out, whole.out), differ(out, whole.out))
print(f"a run of {whole.summary()['steps']} steps, {length:.1f} s")

# -- A rank ------------------------------------------------------------------------------------------------------

k = 0
while k < KILLS:
    out = fresh()
    ranks = chance.choice((3, 4))
    what = f"kill {k + 1}"
    if not kill(run(ranks, out, SCENE), out, what):
        continue
    k += 1
    if newest(out) and chance.random() < 0.3:
        # Once more on the way.
        kill(run(ranks, out, "--resume", "latest"), out, f"{what}, then")
    goes_on(what, out, chance.choice([n for n in (1, 2, 3, 4) if n != ranks]))

# -- A plain start after it --------------------------------------------------------------------------------------

out = fresh()
job = run(3, out, SCENE)
while newest(out) < 20 and job.process.poll() is None and time.monotonic() < job.begin + BOUND:
    time.sleep(0.005)
os.kill(job.ranks()[1], signal.SIGKILL)
job.end(BOUND)
step = newest(out)
earlier = os.path.join(out, "checkpoint_earlier.h5")
job = run(2, out, SCENE, "--steps", "12").end()
said = re.findall(r"holds a checkpoint of step (\d+), t = [0-9.e-]+, of a run that did not end; .* --resume (\S+) ", job.stderr)
expect("a plain start says from where one can go on", job.returncode == 0 and said == [(str(step), earlier)]
       and len(job.said) == 1, job.stderr)
expect("a run that comes to its end needs no earlier one", not os.path.exists(earlier) and newest(out) == 12, os.listdir(out))

# -- The launcher ------------------------------------------------------------------------------------------------

LONGER = ("--until", "5")
longer = scenes.good(SCENE, "--strict", *LONGER)
out = fresh()
job = run(3, out, SCENE, *LONGER)
while newest(out) < 40 and job.process.poll() is None and time.monotonic() < job.begin + BOUND:
    time.sleep(0.005)
ranks = job.ranks()
os.kill(job.process.pid, signal.SIGKILL)
begin = time.monotonic()
left = gone(ranks, begin + BOUND)
print(f"the launcher is killed: its ranks end after {time.monotonic() - begin:.1f} s")
expect("the launcher is killed: its ranks end", len(ranks) == 3 and not left, (ranks, left))
for pid in left:
    os.kill(pid, signal.SIGKILL)
job.end(BOUND)
expect("the launcher is killed: nothing is torn", not torn(out), torn(out))
# A start that is stopped before it has come as far keeps the checkpoint, from which the run goes on to its end.
step = newest(out)
job = run(2, out, SCENE, *LONGER)
earlier = os.path.join(out, "checkpoint_earlier.h5")
while not os.path.exists(earlier) and job.process.poll() is None and time.monotonic() < job.begin + BOUND:
    time.sleep(0.001)
for pid in job.ranks().values():
    os.kill(pid, signal.SIGTERM)
job.end(BOUND)
expect("a start that has not come as far", newest(out) < step, (newest(out), step))
if newest(out) < step:
    expect("an earlier checkpoint is kept", os.path.exists(earlier), os.listdir(out))
    job = run(3, out, "--resume", earlier, *LONGER).end()
    last = longer.snapshots()[-1]
    one, other = Snapshot(last), Snapshot(os.path.join(out, os.path.basename(last))) if job.returncode == 0 else None
    expect("an earlier checkpoint is gone on from", other and one.step == other.step and all(
        one[key].tobytes() == other[key].tobytes() for key in one.column), job.stderr)
    expect("an earlier checkpoint has had its time", not os.path.exists(earlier), os.listdir(out))

scenes.end()

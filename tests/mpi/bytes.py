"""What ranks send in a step is what the plan says: by MPI's profiling interface (pmpi_bytes.c), by the run's own count,
and by `sph plan` under mpirun, to the byte and to the message. Several sweeps, passes that repeat themselves, other
frames, floats, periodic and mirror sides, two arrays, all kinds of integrators; on 2, 3 and 4 ranks."""
import json
import os
import sys

from launch import MPIRUN, Scenes, changed, example, need

need()
BUILD = os.environ["top_builddir"]
SHIM = os.path.join(BUILD, "tests", "mpi", ".libs", "pmpi_bytes.so")
scenes = Scenes()
expect = scenes.expect
ONLY = sys.argv[1:]  # names of scenes


def before(ranks, **env):
    words = [*MPIRUN, "-n", str(ranks)]
    for name, value in env.items():
        words += ["-x", f"{name}={value}"]
    return words


def run(scene, ranks, steps):
    """A run with what was counted from outside, on the communicator of ours: (messages, bytes)."""
    out = os.path.join(scenes.scratch.name, f"pmpi{scenes.count}")
    result = scenes.run(scene, "--steps", str(steps), before=before(ranks, LD_PRELOAD=SHIM, SPH_PMPI_OUT=out))
    if result.code != 0:
        print(f"MISS {scene['title']} on {ranks} ranks: {result.stderr}")
        sys.exit(1)
    total = [0, 0]
    for rank in range(ranks):
        with open(f"{out}.{rank}") as file:
            for line in file:
                messages, number, name = line.rstrip("\n").split(" ", 2)
                if name == "sph":
                    total[0] += int(messages)
                    total[1] += int(number)
    return result.summary(), total


def planned(scene, ranks):
    """`sph plan`'s "ranks"."""
    done = scenes.command("plan", scenes.write(scene), "--json", before=before(ranks))
    if done.returncode:
        print(f"MISS plan of {scene['title']} on {ranks} ranks: {done.stderr}")
        sys.exit(1)
    return json.loads(done.stdout)["ranks"]


def evaluations(summary):
    return {"pece": 2, "symplectic": 2, "rk2": 2, "ssp-rk3": 3, "rk4": 4}.get(summary["plan"]["integrator"], 1)


def check(what, scene, ranks, steps, long):
    """One step more: what it sends. Then a longer run, in which lists are made again and again."""
    if ONLY and what not in ONLY:
        return
    for n in ranks:
        name = f"{what} on {n} ranks"
        plan = planned(scene, n)
        a, outside_a = run(scene, n, steps)
        b, outside_b = run(scene, n, steps + 1)
        ea, eb = a["ranks"]["exchange"], b["ranks"]["exchange"]
        expect(f"{name}: a step in which no lists are made", eb["steps"] == ea["steps"] + 1, (ea["steps"], eb["steps"]))
        outside = [outside_b[k] - outside_a[k] for k in (0, 1)]
        inside = [eb[k] - ea[k] for k in ("messages", "bytes")]
        says = [eb[k] - ea[k] for k in ("planned_messages", "planned_bytes")]
        whole = [b["ranks"]["sent"]["all"][k] for k in ("messages", "bytes")]
        print(f"{name}: {outside[1]} bytes in {outside[0]} messages a step, {whole[1]} in all")
        expect(f"{name}: something is sent", says[0] > 0 and says[1] > 0, says)
        expect(f"{name}: the profiling interface and the plan agree of a step", outside == says, (outside, says))
        expect(f"{name}: the run and the plan agree of a step", inside == says, (inside, says))
        expect(f"{name}: the profiling interface and the run agree of all", outside_b == whole, (outside_b, whole))
        # What `sph plan` has said before, of the first ghosts; with what passes send that repeat themselves.
        step = dict(plan["partitions"][plan["partition"]]["step"])
        for exchange in plan["exchanges"]:
            sweeps = [summary["cost"]["pass_sweeps"][exchange["pass"]] for summary in (a, b)]
            more = sweeps[1] - sweeps[0] - evaluations(a) if exchange["again"] else 0
            for k in ("messages", "bytes"):
                step[k] += more * exchange[k]
        expect(f"{name}: as sph plan says", outside == [step["messages"], step["bytes"]], (outside, step))
        whole = run(scene, n, long)[0]["ranks"]["exchange"]
        print(f"{name}: {whole['steps']} of {long} steps between lists, {whole['bytes']} bytes")
        expect(f"{name}, {long} steps: as planned", whole["steps"] > 0 and whole["bytes"] == whole["planned_bytes"] and
               whole["messages"] == whole["planned_messages"], whole)


QUIET = {"picture": False, "log": {"steps": 1}}
NOH = changed(example("noh.json"), output=QUIET, compare=[], probes=[])
NOH["particles"]["fluid"]["fill"]["spacing"] = 0.04
check("noh", NOH, (2, 3, 4), 3, 40)
check("rk2", changed(NOH, time={"end": 0.1, "integrator": "rk2"}), (2,), 3, 20)
check("mixed", changed(NOH, precision="mixed"), (3,), 3, 40)
DROP = changed(example("drop.json"), output=QUIET, compare=[], probes=[])
check("drop", DROP, (2, 3, 4), 3, 40)
check("drop in floats", changed(DROP, precision="mixed"), (3,), 3, 30)
for integrator in ("dkd", "symplectic", "verlet2", "pece", "rk4"):
    check(integrator, changed(DROP, time={"end": 1e-3, "integrator": integrator}), (2,), 3, 30)
BOX = {
    "title": "two gases between walls and periodic sides", "dimensions": 3,
    "plugins": ["kernels", "eos", "gsph"],
    "domain": {"min": [0, 0, 0], "max": [1, 1, 1], "sides": {"x": "periodic", "y": "mirror", "z": "periodic"}},
    "materials": {"gas": {"eos": {"name": "ideal-gas", "gamma": 1.4}}},
    "particles": {
        name: {"material": "gas", "fields": {"rho": 1, "p": 1, "v": ["0.2*sin(2*pi*x)", 0, 0.1]},
               "fill": {"lattice": "cubic", "spacing": 0.1, "in": {"box": {"min": [x, 0, 0], "max": [x + 0.5, 1, 1]}}}}
        for name, x in (("left", 0), ("right", 0.5))},
    "scheme": {"name": "gsph"}, "time": {"end": 0.3}, "output": QUIET}
check("box", BOX, (2, 3, 4), 3, 20)
FRAMES = changed(NOH, title="sums over other places", time={"end": 0.02})
FRAMES["plugins"].append(os.path.abspath(os.path.join(BUILD, "tests", "opencl", ".libs", "frames.so")))
FRAMES["particles"]["fluid"]["fields"].update({"X": ["2*x", "y*y"], "q": "sin(7*x)"})
FRAMES["scheme"]["edit"] = [{"insert": name} for name in ("followed", "frozen", "mix")]
FRAMES["scheme"]["edit"].append({"insert": "turn", "at": "finish"})
check("frames", FRAMES, (2, 3), 3, 30)
scenes.end()

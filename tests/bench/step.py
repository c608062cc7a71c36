#!/usr/bin/env python3
"""Whole steps: where the time goes in weakly compressible and in gas dynamics, in each precision, with one and
with two threads; whether the order of the particles in a file matters; what precision costs and gives.

    step.py [--rounds N] [--only WORD] [--short]

All runs of a scene take their turn in every round. Of each the one with the shortest loop is shown: what
else the machine does only slows a run. --only takes part of a name (wcsph-3d, wcsph-2d, gsph-2d, gsph-3d,
order, precision); --short makes small scenes, to try the program itself. Always ends with 0: figures
that have a bar say OK or MISS."""
import argparse
import csv
import os
import random
import tempfile

from step_run import Program, split, table
from step_precision import precision

PRECISIONS = ("double", "mixed", "single")
THREADS = (1, 2)
# Bars that are known to be missed, and what was measured. The faster the pair passes, the less of a step
# they are: these have got faster, and the whole steps with them.
KNOWN = {
    ("wcsph-3d", "mixed", 2): "1.42 to 1.60",
    ("wcsph-3d", "single", 1): "1.48 to 1.52",
    ("wcsph-3d", "single", 2): "1.50 to 1.57",
    ("wcsph-2d", "mixed", 1): "1.52 to 1.58",
    ("wcsph-2d", "mixed", 2): "1.56 to 1.64",
    ("wcsph-2d", "single", 1): "1.55 to 1.60",
    ("wcsph-2d", "single", 2): "1.60 to 1.65",
}


def water(dim, side):
    """A box of weakly compressible fluid, all sides open, with a smooth flow of Mach 0.1 in it."""
    waves = {
        2: ["sin(2*pi*x)*cos(2*pi*y)", "-cos(2*pi*x)*sin(2*pi*y)"],
        3: ["sin(2*pi*x)*cos(2*pi*y)*cos(2*pi*z)", "-cos(2*pi*x)*sin(2*pi*y)*cos(2*pi*z)", "0"],
    }
    return {
        "title": f"water, {dim}D",
        "dimensions": dim,
        "plugins": ["kernels", "eos", "wcsph"],
        "domain": {"min": [0] * dim, "max": [1] * dim},
        "materials": {"water": {"eos": {"name": "tait", "c0": 10, "rho0": 1}}},
        "particles": {
            "fluid": {
                "material": "water",
                "fill": {"lattice": "cubic", "spacing": 1 / side, "jitter": 0.1},
                "fields": {"rho": 1, "v": waves[dim]},
                "h_over_dx": 1.3,
            }
        },
        "scheme": {"name": "wcsph", "alpha": 0.1},
        "kernel": "wendland-c2",
        "time": {"end": 100},
        "output": {"picture": False, "log": {"steps": 10}},
    }


def from_file(scene, side, folder, shuffled):
    """The same box with its particles out of a file: row by row, or in any order."""
    rng = random.Random(1)
    step = 1 / side
    rows = []
    for i in range(side**3):
        at = [(i // side**k % side + 0.5 + rng.uniform(-0.1, 0.1)) * step for k in range(3)]
        rows.append([repr(x) for x in at])
    if shuffled:
        rng.shuffle(rows)
    name = "shuffled.csv" if shuffled else "in-order.csv"
    with open(os.path.join(folder, name), "w", newline="") as file:
        csv.writer(file).writerows([["x", "y", "z"], *rows])
    scene["particles"]["fluid"]["fill"] = {"file": name, "spacing": step}
    return scene


def cases(program, short):
    """Name: scene, steps."""
    noh = program.example("noh.json")
    noh["particles"]["fluid"]["fill"]["spacing"] = 0.02 if short else 0.008
    sod = program.example("sod-3d.json")
    for scene in (noh, sod):
        scene["output"] = {"picture": False, "log": {"steps": 10}}
    for fill in sod["particles"]["fluid"]["fill"]:
        fill["glass"] = {"sweeps": 10}  # as even as that need not be here, and each run makes it
    width = 0.05 if short else 0.075
    sod["domain"]["max"][1:] = [width, width]
    for fill in sod["particles"]["fluid"]["fill"]:
        fill["in"]["box"]["max"][1:] = [width, width]
    return {
        "wcsph-3d": (water(3, 20 if short else 63), 40 if short else 100),
        "wcsph-2d": (water(2, 60 if short else 500), 40 if short else 100),
        "gsph-2d": (noh, 10 if short else 30),
        "gsph-3d": (sod, 4 if short else 8),
    }


def best_of(program, rounds, runs):
    """runs: {key: (scene, options)}, in turn, several times; the summary with the shortest loop of each."""
    best = {}
    for _ in range(rounds):
        for key, (scene, options) in runs.items():
            summary = program.run(scene, *options)
            if key not in best or summary["cost"]["loop_s"] < best[key]["cost"]["loop_s"]:
                best[key] = summary
    return best


def measure(program, rounds, name, scene, steps):
    runs = {
        (precision, threads): (
            scene,
            ["--precision", precision, "--threads", str(threads), "--steps", str(steps)],
        )
        for precision in PRECISIONS
        for threads in THREADS
    }
    best = best_of(program, rounds, runs)
    print(f"\n{name}: {scene['title']}, {sum(best['double', 1]['particles'].values())} particles, {steps} steps")
    columns = {f"{p} x{t}": split(best[p, t]) for p in PRECISIONS for t in THREADS}
    table(columns)
    for p in PRECISIONS:
        one, two = (best[p, t]["cost"]["loop_s"] for t in THREADS)
        pairs = [columns[f"{p} x{t}"]["pair passes"] for t in THREADS]
        print(f"  {p}: two threads {one / two:.2f}, in the pair passes alone {pairs[0] / pairs[1]:.2f}")
    for p in PRECISIONS:
        for t in THREADS:
            ratio = columns[f"{p} x{t}"]["step / pair passes"]
            known = KNOWN.get((name, p, t), "")
            print(f"  {'OK  ' if ratio <= 1.5 else 'MISS'} {name}, {p} x{t}: "
                  f"whole step / pair passes {ratio:.3f} (<= 1.5){known and '; known: '}{known}")


def order(program, rounds, short):
    """Particles that stand in any order in a file: the engine sorts them, once."""
    side = 20 if short else 63
    runs = {}
    for shuffled in (False, True):
        scene = from_file(water(3, side), side, program.scratch, shuffled)
        runs[shuffled] = (scene, ["--threads", "1", "--precision", "double", "--steps", "20" if short else "40"])
    best = best_of(program, rounds, runs)
    loop = [best[key]["cost"]["loop_s"] for key in (False, True)]
    wall = [best[key]["cost"]["wall_s"] for key in (False, True)]
    print(f"\norder: 3D, double, particles from a file in order and shuffled: steps {loop[0]:.3f} s and "
          f"{loop[1]:.3f} s, ratio {loop[1] / loop[0]:.3f}; with reading and sorting {wall[1] / wall[0]:.3f}")


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--only", default="")
    parser.add_argument("--short", action="store_true")
    a = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        program = Program(scratch)
        for name, (scene, steps) in cases(program, a.short).items():
            if a.only in name:
                measure(program, a.rounds, name, scene, steps)
        if a.only in "order":
            order(program, a.rounds, a.short)
        if a.only in "precision":
            precision(program, a.rounds, a.short)


if __name__ == "__main__":
    main()

"""iteration.py -- the smoothing length's iteration where it is hardest: points at random, with a jump of 10^6 in
their density."""

import os
import tempfile

import numpy as np

import linear
from battery import Report, base, forget, put, run

JUMP, SWEEPS, LAST = 1e6, 30, 50


def cloud(path, seed, guess):
    """3000 points in a cube of side 1/2 beside 1000 in a room 10^6 times as thin. h: of the true mean density, times
    guess."""
    random = np.random.default_rng(seed)
    dense, thin = 3000, 1000
    room = (0.125 / dense * thin * JUMP) ** (1 / 3)
    x = np.concatenate([random.random((dense, 3)) * 0.5, (random.random((thin, 3)) - 0.5) * room])
    spacing = np.concatenate([np.full(dense, (0.125 / dense) ** (1 / 3)), np.full(thin, room / thin ** (1 / 3))])
    rows = np.column_stack([x, np.full(len(x), 1.0 / dense), 1.5 * spacing * guess])
    np.savetxt(path, rows, delimiter=",", header="x,y,z,m,h", comments="", fmt="%.17g")
    return room


def trial(seed, guess, tolerance):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "cloud.csv")
        room = cloud(path, seed, guess)
        scene = base("gas")
        scene["domain"] = {"min": [-room] * 3, "max": [room] * 3}
        put(scene, "particles.gas", {"material": "gas", "fill": {"file": path}, "fields": {"rho": 1, "u": 1e-3}})
        scene["scheme"]["h_tolerance"] = tolerance
        scene["time"].update(end=1e-6, dt=1e-9, steps=1)
        outcome = run(scene)
    last = outcome.last()
    summary = outcome.summary()
    h, x, m, rho = last["h"], last["x"], last["m"], last["rho"]
    support = linear.Kernel("wendland-c4", 3).support
    count = [np.sum(np.sum((x - p) ** 2, axis=1) < (support * r) ** 2) for p, r in zip(x, h)]
    # What the iteration solves: h = eta (m / rho)^(1/3).
    off = np.abs(h / (1.5 * (m / rho) ** (1 / 3)) - 1)
    # Of the first evaluation, if that of the step took one: no evaluation takes more than LAST.
    sweeps = min(summary["cost"]["h_sweeps"] - summary["steps"], LAST)
    forget(outcome)
    return outcome, sweeps, np.array(count), off


def main():
    report = Report(
        "Iteration of h",
        "gsph's density: 4000 points at random (Poisson) in space, 3000 of them in a cube that "
        "is 10^6 times as dense as the "
        "room about it; eta = 1.5 and Wendland C4, about 113 neighbours on a lattice. h begins "
        "right in the mean, or "
        "wrong by a factor. Sweeps: of the first evaluation; 50 are the most that the host grants.\n\n"
        "Newton's step is that of h^d rho(h), which grows with h wherever the others stand. That of rho(h) less "
        "what fits, which was tried first, turns its sign where all of the cube is within a thin point's support, "
        "and used up the 50 sweeps on four of these five.",
    )
    rows = []
    for job in JOBS:
        seed, guess, tolerance = job
        outcome, sweeps, count, off = trial(*job)
        many = int(np.sum(count > MANY))
        rows.append(
            [
                seed,
                guess,
                f"{tolerance:g}",
                sweeps,
                int(np.min(count)),
                int(np.median(count)),
                int(np.max(count)),
                many,
                np.max(off),
            ]
        )
        name = f"seed {seed}, h {guess:g} times right, tolerance {tolerance:g}"
        report.rule(f"{name}: sweeps", f"{sweeps}", f"at most {SWEEPS}", outcome.done and sweeps <= SWEEPS)
        report.rule(
            f"{name}: h = eta (m / rho)^(1/3)",
            f"at most {np.max(off):.1e} off",
            f"10 times the tolerance, {10 * tolerance:g}",
            np.max(off) < 10 * tolerance,
        )
        report.rule(
            f"{name}: neighbours",
            f"{np.min(count)} to {np.max(count)}, {many} particles above {MANY}",
            f"20 to {MANY}",
            20 <= np.min(count) and many == 0,
            RIM,
        )
    report.table(
        [
            "seed",
            "h at first",
            "tolerance",
            "sweeps",
            "least neighbours",
            "median",
            "most",
            f"above {MANY}",
            "h off by",
        ],
        rows,
    )
    return report


MANY = 500
JOBS = ((1, 1, 1e-3), (2, 1, 1e-3), (1, 0.2, 1e-3), (1, 5, 1e-3), (1, 1, 1e-10))
RIM = "the thin points beside the cube have its rim within their support, whatever the iteration: h solves for a mean"

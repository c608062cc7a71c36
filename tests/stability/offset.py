"""offset.py -- what precision costs far from the origin and in long domains: places after a run in mixed and
single precision against double."""

import numpy as np

from battery import Report, base, each, forget, put, run

# What single-precision positions alone cost, in dx (half a unit in the last place at L / dx).
PLAIN = {1e3: 6e-5, 1e4: 6e-4}
STEPS = 50


def long_box(precision, size):
    """A periodic line of so many dx: the domain is what is large."""
    scene = base("lattice")
    scene["dimensions"] = 1
    scene["domain"] = {"min": [0], "max": [size], "sides": {"x": "periodic"}}
    put(scene, "particles.gas.fields.v", ["0.05 * sin(2 * pi * x / 50) + 0.03 * sin(3 * x)"])
    return scene


def far_box(precision, size):
    """20 x 20 dx, periodic, that far from the origin."""
    scene = base("lattice")
    scene["domain"].update(min=[size, size], max=[size + 20, size + 20])
    put(
        scene,
        "particles.gas.fields.v",
        [
            f"0.05 * sin(2 * pi * (y - {size}) / 20)",
            f"0.05 * sin(2 * pi * (x - {size}) / 20) + 0.03 * sin(3 * (x - {size}))",
        ],
    )
    return scene


KINDS = {"long domain": long_box, "domain far off": far_box}


def places(job):
    kind, precision, size = job
    scene = KINDS[kind](precision, size)
    scene["precision"] = precision
    put(scene, "particles.gas.fill.jitter", 0.1)
    put(scene, "materials.gas.eos.p0", 0.6)
    scene["time"] = {"integrator": "kdk", "end": 1e9, "dt": 0.4, "steps": STEPS}
    scene["output"]["log"]["steps"] = STEPS
    outcome = run(scene)
    shot = outcome.last()
    forget(outcome)
    return shot["x"], shot["v"]


def main():
    report = Report(
        "Precision",
        f"Barotropic waves of .05 c on a shaken lattice (10 %), {STEPS} steps: rms difference of "
        f"the places to those in double "
        "precision, in dx, in a periodic line of L dx, and in a box of 20 x 20 dx at a distance "
        "L from the origin. The bar is what "
        "positions in single precision would cost in one step; a run of that many steps stays "
        "below it, as sweeps take "
        "positions in whole numbers of about 2^-32 of the domain (2.3e-6 dx in one of 10^4 dx), "
        "wherever it lies.",
    )
    jobs = [(k, p, s) for k in KINDS for p in ("double", "mixed", "single") for s in PLAIN]
    got = dict(zip(jobs, each(places, jobs)))
    rows = []
    for kind, precision, size in jobs:
        if precision == "double":
            continue
        x, v = got[kind, precision, size]
        x0, v0 = got[kind, "double", size]
        span = size if kind == "long domain" else 20
        d = x - x0
        d -= span * np.round(d / span)
        off = np.sqrt(np.mean(np.sum(d * d, axis=1)))
        speed = np.sqrt(np.mean(np.sum((v - v0) ** 2, axis=1)))
        rows.append([kind, precision, f"{size:g}", off, np.max(np.abs(d)), speed])
        report.rule(
            f"{kind}, {precision}, L/dx = {size:g}", f"{off:.1e} dx", f"{PLAIN[size]:.0e} dx", off < PLAIN[size]
        )
    report.table(["where", "precision", "L/dx", "rms error / dx", "largest / dx", "rms error of v / c"], rows)
    return report

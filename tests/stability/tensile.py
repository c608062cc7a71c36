"""tensile.py -- negative pressure: a liquid that is pulled stays whole. Gaps: the widest circle without a
particle in it."""

import numpy as np

import pairing
from battery import Report, base, each, forget, put, run

GAP = 1.6


def widest(x, box, step=0.1):
    """Diameter of the widest empty circle of a periodic box, to about a step."""
    n = np.ceil(box / step).astype(int)
    grid = np.stack(np.meshgrid(*[(np.arange(k) + 0.5) * b / k for k, b in zip(n, box)], indexing="ij"), -1).reshape(
        -1, 2
    )
    least = np.full(len(grid), np.inf)
    for p in x:
        d = grid - p
        d -= box * np.round(d / box)
        np.minimum(least, np.sum(d * d, axis=1), out=least)
    return 2 * np.sqrt(np.max(least))


def pulled(job):
    kernel, h, stretch = job
    scene = base("pressed")
    scene["domain"]["max"] = pairing.BOX.tolist()
    scene["kernel"] = kernel
    put(scene, "particles.liquid.h_over_dx", h)
    # As if at rest at a density higher by that factor: p = c^2 (1 - stretch).
    put(scene, "materials.liquid.eos.p0", 1 - stretch)
    scene["time"]["end"] = 200
    outcome = run(scene)
    x = outcome.last()["x"][:, :2]
    rho = outcome.last()["rho"]
    forget(outcome)
    return widest(x, pairing.BOX), np.min(pairing.nearest(x, pairing.BOX)) / pairing.A, np.std(rho)


CLUMPS = "no artificial stress, no shifting: see above"
JOBS = [
    (k, h, s)
    for k, h in (("cubic-spline", 1.3), ("wendland-c2", 1.3), ("wendland-c2", 2.0), ("quintic-spline", 1.3))
    for s in (1.02, 1.1)
]
HOLDS = set()


def main():
    report = Report(
        "Tensile instability",
        "wcsph, hexagonal lattice of 20 x 22 particles with 1 % noise in a periodic box, "
        "stretched: p = -.02 and -.1 c^2 rho; "
        "viscosity alpha = .1, to t = 200 dx/c. Gap: diameter of the widest empty circle, in dx "
        "(perfect lattice: 1.24).\n\n"
        "With p < 0 the pair force attracts, and where W'' > 0 at the neighbours' distance a "
        "pair that comes nearer is "
        "attracted more (Swegle, Hicks & Attaway 1995, J. Comput. Phys. 116, 123): particles "
        "draw together in clumps with holes "
        "between, of every kernel. Cures are artificial stress (Gray, Monaghan & Swift 2001), "
        "shifting, or a total Lagrangian "
        "form; no plugin has one of them yet.",
    )
    for job, (gap, least, noise) in zip(JOBS, each(pulled, JOBS)):
        kernel, h, stretch = job
        report.rule(
            f"{kernel}, h/dx {h:g}, p = -{stretch - 1:.2g} c^2 rho",
            f"gap {gap:.2f} dx, least distance {least:.2f}, noise of rho {noise:.1e}",
            f"gap < {GAP} dx",
            gap < GAP,
            "" if job in HOLDS else CLUMPS,
        )
    return report

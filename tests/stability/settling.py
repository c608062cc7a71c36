"""settling.py -- a tank at rest: does it come to rest, and stay? With sides that mirror as walls."""

import numpy as np

from battery import Report, base, each, forget, put, run

BAR = 1e-6


def tank(job):
    """Kinetic energy over E0 = M g H / 2 in windows of time; error of the pressure below the surface."""
    integrator, alpha = job
    scene = base("tank")
    scene["time"]["integrator"] = integrator
    put(scene, "scheme.alpha", alpha)
    outcome = run(scene)
    log, last = outcome.log, outcome.last()
    forget(outcome)
    ratio = log["kinetic"] / (0.5 * log["mass"][0])

    def mean(a, b):
        return np.mean(ratio[(log["time"] >= a) & (log["time"] <= b)])

    y = last["x"][:, 1]
    off = np.abs(last["p"] - (1 - y))[(y > 0.1) & (y < 0.9)]
    return mean(2, 4), mean(8, 10), mean(18, 20), np.mean(off), np.max(y)


def main():
    report = Report(
        "Settling",
        "wcsph, 20 x 20 particles, depth H = 1 between a mirror at the bottom and a free "
        "surface, periodic along x, g = 1, "
        "c0 = 10; begins with the hydrostatic density on a square lattice, not in equilibrium as "
        "a discrete system. E0 = M g H / 2; "
        "t* = (H/g)^.5; means of Ek/E0 over t/t* of 2 to 4, 8 to 10, 18 to 20.\n\n"
        "A square lattice under pressure is no minimum of energy. Rows slide some time, sooner "
        "with less viscosity and with an "
        "integrator that feeds the shortest waves; after that the liquid settles again. alpha = "
        ".1 holds it for 20 t*.",
    )
    jobs = [("kdk", 0.1), ("symplectic", 0.1), ("verlet2", 0.1), ("kdk", 0.02), ("symplectic", 0.02), ("ssp-rk3", 0.02)]
    rows = []
    for job, got in zip(jobs, each(tank, jobs)):
        early, middle, late, off, top = got
        rows.append([*job, early, middle, late, off, top])
        name = f"{job[0]}, alpha {job[1]:g}"
        report.rule(f"{name}: Ek/E0 after 20 t*", f"{late:.1e}", f"{BAR:g}", late < BAR, KNOWN.get((*job, "level"), ""))
        report.rule(
            f"{name}: not rising",
            f"{late / middle:.2f} of that at 8 to 10 t*",
            "<= 1",
            late <= middle,
            KNOWN.get((*job, "rise"), ""),
        )
    report.table(["integrator", "alpha", "Ek/E0, 2-4", "8-10", "18-20", "mean error of p / (rho g H)", "surface"], rows)
    return report


SLIDES = (
    "the rows of the square lattice slide over each other (.3 to .8 dx, from t* = 10 on), which "
    "frees energy: see above"
)
KNOWN = {
    ("verlet2", 0.1, "level"): SLIDES,
    ("verlet2", 0.1, "rise"): SLIDES,
    (
        "kdk",
        0.02,
        "level",
    ): "with density by continuity kdk grows by theta^4/4 a step, which so little viscosity does not make up for",
    ("symplectic", 0.02, "level"): SLIDES,
    ("ssp-rk3", 0.02, "level"): SLIDES,
    ("ssp-rk3", 0.02, "rise"): SLIDES,
}

"""knee.py -- the largest time-step number that is of use where there is dissipation: error against C for twelve
values and all integrators, on a shock tube, Noh's implosion and a weakly compressible box without order."""

import os

import numpy as np

import linear
from battery import Report, base, each, example, forget, put, run

VALUES = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.25, 1.5, 2.0)
WITHIN = 0.05
MARGIN = 0.7


def sod():
    scene = example("sod.json")
    for fill in scene["particles"]["fluid"]["fill"]:
        fill["mass"] = 0.0025
    scene["output"] = {"log": {"steps": 100000}}
    return scene


def noh_1d():
    scene = example("noh-1d.json")
    scene.pop("probes", None)
    scene["output"] = {"log": {"steps": 100000}}
    return scene


def noh_2d():
    scene = example("noh.json")
    scene.pop("probes", None)
    put(scene, "particles.fluid.fill.spacing", 0.05)
    put(scene, "compare.0.where", "r < 0.3")
    scene["time"]["end"] = 0.3
    scene["output"] = {"log": {"steps": 100000}}
    return scene


def stirred():
    """Energy that is left of a stirred liquid after .5 crossings; its error is that of the loss."""
    scene = base("box")
    scene["plugins"] = ["kernels", "eos", "wcsph"]
    put(scene, "materials.fluid.eos", {"name": "tait", "gamma": 7, "c0": 1, "rho0": 1, "p0": 0.1})
    scene["scheme"] = {"name": "wcsph", "alpha": 0.1}
    scene["time"] = {"end": 2}
    scene["output"] = {"log": {"steps": 100000}}
    return scene


CASES = {"Sod 1D (gsph)": sod, "Noh 1D (gsph)": noh_1d, "Noh 2D (gsph)": noh_2d, "stirred box (wcsph)": stirred}


def trial(job):
    """The error of a run, NaN if it broke down."""
    case, integrator, c = job
    scene = CASES[case]()
    scene["time"].update(integrator=integrator, cfl=c)
    scene["precision"] = "double"
    outcome = run(scene, timeout=600)
    value = np.nan
    if outcome.done and case.startswith("stirred"):
        kinetic = outcome.log["kinetic"]
        value = kinetic[-1] / kinetic[0]
    elif outcome.done:
        errors = outcome.summary()["errors"]
        value = next(e["l1"] for f, e in errors.items() if f.split("@")[0].endswith("rho"))
    forget(outcome)
    return value


def main():
    report = Report(
        "The knee: largest C of use, with dissipation",
        f"C is the scene's cfl: of gsph in h / (c_i + c_j + closing speed), about twice the C of "
        f"the lattice; of wcsph in "
        f"h / (c + viscosity). Twelve values of C from .05 to 2, ten integrators. Error: L1 of "
        f"the density (Sod, Noh r < .3 in "
        f"2D), or the loss of kinetic energy of a stirred box in two units of time. The knee is "
        f"the largest C up to which every "
        f"error is within {100 * WITHIN:.0f} % of that of rk4 at C = .05, above or below; 0: none "
        f'is. "breaks": not a number, or no end.',
    )
    integrators = list(linear.INTEGRATORS)
    jobs = [(case, i, c) for case in CASES for i in integrators for c in VALUES]
    # Long ones first, so that both cores end together.
    order = sorted(range(len(jobs)), key=lambda k: (not jobs[k][0].startswith("Noh 2D"), jobs[k][2]))
    got = dict(zip([jobs[k] for k in order], each(trial, [jobs[k] for k in order])))
    knee = {}
    for case in CASES:
        best = got[case, "rk4", VALUES[0]]
        rows = []
        for i in integrators:
            values = [got[case, i, c] for c in VALUES]
            if case.startswith("stirred"):
                off = (1 - np.array(values)) / (1 - best) - 1
            else:
                off = np.array(values) / best - 1
            off = np.where(np.isfinite(off), off, np.inf)
            good = np.abs(off) <= WITHIN
            n = len(VALUES) if np.all(good) else int(np.argmin(good))
            knee[case, i] = VALUES[n - 1] if n else 0.0
            rows.append([i, *["breaks" if np.isinf(o) else f"{100 * o:+.1f}" for o in off], knee[case, i]])
        what = "loss of kinetic energy" if case.startswith("stirred") else "L1 of rho"
        report.text(
            f"{case}: {what} at rk4, C = .05: "
            f"{best if not case.startswith('stirred') else 1 - best:.4g}; of all, in per cent above it."
        )
        report.table(["integrator", *[f"C = {c:g}" for c in VALUES], "knee"], rows)
    report.text(f"""
The default factor that follows: the least knee of an integrator over the cases, times a margin of {MARGIN}, over that
of kdk; an integrator of several evaluations a step pays where C an evaluation is above kdk's.""")
    rows = []
    for i in integrators:
        each_case = [knee[case, i] for case in CASES]
        least, of_kdk = min(each_case), min(knee[case, "kdk"] for case in CASES)
        evaluations = {"ssp-rk3": 3, "rk4": 4, "pece": 2, "rk2": 2, "symplectic": 2}.get(i, 1)
        rows.append(
            [
                i,
                *each_case,
                least,
                MARGIN * least,
                least / of_kdk if of_kdk else np.nan,
                evaluations,
                least / evaluations,
            ]
        )
    report.table(
        ["integrator", *CASES, "least", f"times {MARGIN}", "over kdk's", "evaluations", "C an evaluation"], rows
    )
    for case in CASES:
        report.rule(
            f"kdk, {case}: knee",
            f"C = {knee[case, 'kdk']:g}",
            "at least the default, .3",
            knee[case, "kdk"] >= 0.3,
        )
    return report

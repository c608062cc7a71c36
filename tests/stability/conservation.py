"""conservation.py -- 10^4 steps of a random periodic box: momentum in each precision, energy under kdk."""

import numpy as np

from battery import Report, base, each, forget, put, run

DOUBLE, SINGLE = 1e-13, 1e-6


def box(job):
    """Of a run: drift of the momentum, mean energies of its tenths over the kinetic energy at first."""
    scheme, precision, integrator = job
    scene = base("box")
    scene["precision"] = precision
    scene["time"]["integrator"] = integrator
    scene["scheme"] = {"name": scheme}
    if scheme == "gsph":
        scene["plugins"] = ["kernels", "eos", "gsph"]
        put(scene, "materials.fluid.eos", {"name": "ideal-gas"})
        put(scene, "particles.fluid.fields.p", 0.6)
    if scheme == "wcsph":
        scene["plugins"] = ["kernels", "eos", "wcsph"]
        put(scene, "materials.fluid.eos", {"name": "tait", "gamma": 1, "c0": 1, "rho0": 1, "p0": 0.6})
    if scheme.startswith("barotropic"):
        # The step in all, so that the leapfrog keeps its own energy.
        scene["time"]["dt"] = 0.3 * 1.3 * 0.05
        del scene["time"]["cfl"]
    outcome = run(scene)
    log, last = outcome.log, outcome.last()
    forget(outcome)
    p = np.stack([log["momentum_x"], log["momentum_y"]], 1)
    drift = np.max(np.linalg.norm(p - p[0], axis=1))
    mass = np.sum(last["m"])
    flow = drift / np.sum(last["m"] * np.linalg.norm(last["v"], axis=1))
    energy = (log["kinetic"] + log["internal"]) / log["kinetic"][0]
    parts = np.array_split(energy[1:], 10)
    return (drift / mass, flow), [np.mean(q) for q in parts], [np.std(q) for q in parts], outcome.done


def trend_of(means):
    """Of a line through all tenths but the first: what it changes over ten, and the standard error of that."""
    (slope, _), covariance = np.polyfit(np.arange(1, len(means)), means[1:], 1, cov=True)
    return 10 * slope, 10 * np.sqrt(covariance[0, 0])


def main():
    report = Report(
        "Conservation",
        "400 particles without order (a glass) in a periodic square, stirred with .15 c; 10^4 "
        "steps. The drift of the momentum "
        "is the largest there was: over M c, which the bar is for, and over the sum of m |v|. In "
        "floats it is a walk at random "
        "about 1e-6 of the latter, as both halves of a pair round for themselves. Energy: means "
        "over tenths of the run, but "
        "the first, in which the box relaxes; a secular trend is a line through them whose ends "
        "differ by more than three "
        "standard errors and by more than 1e-5 of the kinetic energy at first.",
    )
    jobs = [("barotropic", p, "kdk") for p in ("double", "mixed", "single")]
    control = ("barotropic", "double", "rk2")
    jobs += [("barotropic-continuity", "double", "rk4"), ("wcsph", "double", "kdk"), ("wcsph", "mixed", "kdk")]
    jobs += [("gsph", "double", "kdk"), ("gsph", "mixed", "kdk")]
    got = dict(zip([*jobs, control], each(box, [*jobs, control])))
    for job in jobs:
        scheme, precision, integrator = job
        bar = DOUBLE if precision == "double" else SINGLE
        report.rule(
            f"momentum, {scheme}, {integrator}, {precision}",
            f"{got[job][0][0]:.1e} M c, {got[job][0][1]:.1e} sum m abs v",
            f"{bar:g} M c",
            got[job][0][0] < bar and got[job][3],
        )
    _, means, spread, _ = got["barotropic", "double", "kdk"]
    n = np.arange(10)
    trend, error = trend_of(means)
    report.table(
        ["tenth", *map(str, n + 1)],
        [["mean - that of all, 1e-6", *[f"{1e6 * (m - np.mean(means)):.0f}" for m in means]]],
    )
    report.rule(
        "energy, barotropic, kdk: secular trend over 10^4 steps",
        f"{trend:.1e} +- {error:.1e} of the kinetic energy (within a tenth it swings by {np.mean(spread):.0e})",
        "none: < 3 standard errors, or < 1e-5",
        abs(trend) < max(3 * error, 1e-5),
    )
    trend, error = trend_of(got["barotropic", "double", "rk2"][1])
    report.rule(
        "the same under rk2, which grows by theta^4/8 a step: the trend shows",
        f"{trend:.1e} +- {error:.1e}",
        "> 3 standard errors and > 1e-3",
        trend > max(3 * error, 1e-3),
    )
    _, means, _, _ = got["gsph", "double", "kdk"]
    report.rule(
        "energy, gsph, kdk: drift from the first to the last tenth",
        f"{means[-1] - means[0]:.1e} of the kinetic energy at first",
        "reported: < 1e-2",
        abs(means[-1] - means[0]) < 1e-2,
    )
    return report

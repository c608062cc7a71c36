"""robustness.py -- what breaks codes: rarefactions to near vacuum, expansion into vacuum, cold collapse, blasts
into gas without energy, density ratios of 1000. Density and energy stay above 0, and the run comes to its end."""

import numpy as np

from battery import Report, Snapshot, base, each, forget, put, run


def sides(scene, left, right):
    for k, state in enumerate((left, right)):
        put(scene, f"particles.gas.fill.{k}.fields", dict(zip(("rho", "v", "p"), (state[0], [state[1]], state[2]))))
    del scene["particles"]["gas"]["fields"]
    return scene


def exact(left, right, **others):
    names = ("rho_l", "u_l", "p_l"), ("rho_r", "u_r", "p_r")
    numbers = {n: v for side, state in zip(names, (left, right)) for n, v in zip(side, state)}
    return [{"array": "gas", "exact": "riemann", "gamma": 1.4, "x0": 0, **numbers, **others}]


def rarefactions():
    left, right = (1, -2, 0.4), (1, 2, 0.4)
    scene = sides(base("tube"), left, right)
    scene["domain"] = {"min": [-4], "max": [4]}
    scene["compare"] = exact(left, right, where="x > -0.5 & x < 0.5")
    return scene


def slab():
    """The 123 problem without a middle: the states run apart faster than they expand."""
    left, right = (1, -8, 0.4), (1, 8, 0.4)
    scene = sides(base("tube"), left, right)
    scene["domain"] = {"min": [-9], "max": [9]}
    scene["time"]["end"] = 0.1
    return scene


def disc():
    scene = put(base("blast"), "particles.gas.fill.in", {"sphere": {"center": [0, 0], "radius": 0.5}})
    put(scene, "particles.gas.fields.u", 1)
    scene["time"]["end"] = 2
    scene["output"]["every"] = 0.1
    return scene


def collapse(u):
    scene = put(base("blast"), "particles.gas.fields", {"rho": 1, "u": u, "v": ["-x/r", "-y/r"]})
    return scene


def blast(u):
    fields = {"rho": 1, "u": f"r < 0.06 ? 1 / (pi * 0.06^2) : {u}", "v": [0, 0]}
    scene = put(base("blast"), "particles.gas.fields", fields)
    scene["time"]["end"] = 0.3
    scene["output"]["every"] = 0.01
    return scene


def ratio(left_spacing, right_spacing, low):
    left, right = (1, 0, 1), (low, 0, 0.1 * low)
    scene = sides(base("tube"), left, right)
    put(scene, "particles.gas.fill.0.spacing", left_spacing)
    put(scene, "particles.gas.fill.1.spacing", right_spacing)
    scene["time"]["end"] = 0.1
    scene["compare"] = exact(left, right, where="x > -0.8 & x < 0.8")
    return scene


CASES = {
    "123 problem, 400 particles, t = .15": rarefactions(),
    "states that part at 8 (vacuum between), t = .1": slab(),
    "disc expands into vacuum, 2D, t = 2": disc(),
    "cold collapse (Noh 2D), u = 1e-6": collapse(1e-6),
    "cold collapse (Noh 2D), u = 0": collapse(0),
    "blast (Sedov 2D) into u = 1e-10": blast(1e-10),
    "blast (Sedov 2D) into u = 0": blast(0),
    "density ratio 1000, equal spacing": ratio(0.005, 0.005, 1e-3),
    "density ratio 1000, masses 1 : 10": ratio(0.0005, 0.05, 1e-3),
}
COLD = (
    "gsph takes gamma as rho c^2 / p of either side, which is 0/0 where p = 0; without sound "
    "both impedances are 0, too"
)
KNOWN = {"cold collapse (Noh 2D), u = 0": COLD, "blast (Sedov 2D) into u = 0": COLD}


def trial(name):
    """(reached the end, least rho, least u, counts of rho <= 0 and u <= 0 over all snapshots, "
    "energy drift, L1)"""
    outcome = run(CASES[name], timeout=600)
    shots = [Snapshot(p) for p in outcome.result.snapshots()]
    rho = np.concatenate([s["rho"] for s in shots[1:]] or [[np.nan]])
    u = np.concatenate([s["u"] for s in shots[1:]] or [[np.nan]])
    summary = outcome.summary() if outcome.result.has("summary.json") else {}
    l1 = next((e["l1"] for f, e in summary.get("errors", {}).items() if f.endswith("rho")), None)
    drift = summary.get("conservation", {}).get("energy_drift")
    forget(outcome)
    return outcome.done, np.min(rho), np.min(u), int(np.sum(~(rho > 0))), int(np.sum(~(u > 0))), drift, l1, outcome.said


def main():
    report = Report(
        "Robustness",
        "gsph as it is by default. Snapshots through the whole run (20 to 30) are searched for "
        "density and energy that "
        "are not above 0. A gas that begins with u = 0 keeps it where nothing has come yet: "
        "there u >= 0 is asked for.",
    )
    rows = []
    for name, got in zip(CASES, each(trial, list(CASES))):
        done, rho, u, bad_rho, bad_u, drift, l1, said = got
        rows.append([name, "yes" if done else "no", f"{rho:.2e}", f"{u:.2e}", bad_rho, bad_u, drift, l1])
        still = name.endswith("u = 0")
        good = done and bad_rho == 0 and (bad_u == 0 or (still and u >= 0))
        what = f"least rho {rho:.1e}, u {u:.1e}" if done else said[:160]
        report.rule(name, what, "ends; rho > 0, u >= 0" if still else "ends; rho > 0, u > 0", good, KNOWN.get(name, ""))
    report.table(["case", "ends", "least rho", "least u", "rho <= 0", "u <= 0", "energy drift", "L1 of rho"], rows)
    return report

"""cfl.py -- the largest stable step of each integrator with each kernel, on a perfect lattice and without
dissipation, against linear theory (linear.py) and its table. A plane wave of small amplitude on the mode of
the box that is fastest by theory; its energy (kinetic and of compression) tells growth."""

import numpy as np

import linear
from battery import Report, base, changed, each, forget, put, run

KERNELS = linear.KERNELS
# kdk and its kin with density by summation; verlet2 is the leapfrog where all is kicked.
WITH_ALL = ["kdk", "ssp-rk3", "rk4", "verlet2"]  # with every kernel; the others with one
SUMMATION = ["kdk", "dkd", "symplectic", "pec", "pece", "ssp-rk3", "rk4"]
NARROW = 0.01  # a limit is bisected to this, relative
AMPLITUDE = 1e-6
# Growth a step that counts. Above its limit by e the leapfrog grows by (8 e)^.5, and just below its energy swings;
# Runge-Kutta methods grow by some e. verlet2's coupling every 40 steps lets it grow below its limit, too.
NOISE = {"verlet2": 0.03, "ssp-rk3": 2e-4, "rk4": 2e-4}
LEAPFROGS = 5e-3


def lattice_of(dim):
    return {1: "1d", 2: "2d_square", 3: "3d_cubic"}[dim]


class Mode:
    """The fastest wave that fits a box of n particles an axis, and the scene that has it alone."""

    def __init__(self, kernel, h, continuity=False, dim=2, n=24):
        x = linear.Lattice(lattice_of(dim), kernel, h, continuity=continuity)
        f = np.arange(n // 2 + 1) * 2 * np.pi / n
        k = np.stack(np.meshgrid(*[f] * dim, indexing="ij"), -1).reshape(-1, dim)
        w = x.omega(k)
        best = np.argmax(w)
        self.omega, self.k, self.h = w[best], k[best], h
        along = x.g(k[best : best + 1])[0]
        along = along / np.linalg.norm(along)
        scene = base("lattice")
        scene["dimensions"] = dim
        scene["domain"] = {"min": [0] * dim, "max": [n] * dim, "sides": {a: "periodic" for a in "xyz"[:dim]}}
        put(scene, "materials.gas.eos.rho0", float(x.rho))
        phase = " + ".join(f"{k!r} * {a}" for k, a in zip(self.k.tolist(), "xyz"))
        # Away from the nodes of a wave of length 2.
        v = [f"{AMPLITUDE * e!r} * cos({phase} + 0.7)" for e in along.tolist()]
        put(scene, "particles.gas.fields.v", v)
        put(scene, "particles.gas.h_over_dx", h)
        scene["kernel"] = kernel
        scene["scheme"] = "barotropic-continuity" if continuity else "barotropic"
        self.scene = scene

    def growth(self, integrator, theta, steps=160):
        """Growth a step of the amplitude, as ln: a line through ln E / 2."""
        time = {"integrator": integrator, "end": 1e9, "dt": theta / self.omega, "steps": steps}
        outcome = run(changed(self.scene, time=time))
        log = outcome.log
        energy = log["kinetic"] + log["internal"]
        forget(outcome)
        first = steps // 8
        # Until it is no longer small.
        last = first + int(np.argmax(np.append(energy[first:] > 1e8 * energy[1], True)))
        if last - first < 4:
            first = 1
        n = np.arange(first, last)
        return np.polyfit(n, 0.5 * np.log(energy[n]), 1)[0]

    def limit(self, integrator, theory):
        """Largest stable theta by bisection from .92 and 1.08 of theory; None: not between them."""
        noise = NOISE.get(integrator, LEAPFROGS)
        low, high = 0.92 * theory, 1.08 * theory
        if self.growth(integrator, low) > noise or self.growth(integrator, high) <= noise:
            return None
        while high - low > NARROW * theory:
            middle = (low + high) / 2
            low, high = (low, middle) if self.growth(integrator, middle) > noise else (middle, high)
        return (low + high) / 2

    def frequency(self):
        """Of the kinetic energy, over two: rk4 at a small step, which is behind by theta^4 / 120."""
        theta, steps = 0.05, 400
        time = {"integrator": "rk4", "end": 1e9, "dt": theta / self.omega, "steps": steps}
        outcome = run(changed(self.scene, time=time))
        log = outcome.log
        forget(outcome)
        t, kinetic = log["time"], log["kinetic"] / log["kinetic"][0]

        def rest(w):
            a = np.stack([np.ones_like(t), np.cos(2 * w * t), np.sin(2 * w * t)], 1)
            return np.linalg.lstsq(a, kinetic, rcond=None)[1][0]

        step, w = 0.02 * self.omega, self.omega
        while step > 1e-8:
            w = min((w + s * step for s in (-1, -0.5, 0, 0.5, 1)), key=rest)
            step *= 0.7
        return w


def sound(job):
    kernel, h, continuity = job
    mode = Mode(kernel, h, continuity)
    return mode.frequency() / mode.omega - 1


def stable(job):
    kernel, h, integrator, continuity, dim = job
    mode = Mode(kernel, h, continuity, dim, 24 if dim == 2 else 12)
    theory = linear.limit(integrator, continuity, NOISE["verlet2"] if integrator == "verlet2" else 1e-9)
    found = mode.limit(integrator, theory)
    return found, theory, mode.omega


def grows(job):
    integrator, continuity, theta = job
    mode = Mode("wendland-c2", 1.3, continuity)
    return mode.growth(integrator, theta, 600 if theta < 0.5 else 200)


def noisy(job):
    """Whether noise on all modes grows at this factor of the limit by theory."""
    kernel, factor = job
    h = 1.3
    mode = Mode(kernel, h)
    x = linear.Lattice("2d_square", kernel, h)
    scene = put(mode.scene, "particles.gas.fields.v", [0, 0])
    put(scene, "particles.gas.fill.jitter", 1e-7)
    scene["time"] = {"integrator": "kdk", "end": 1e9, "dt": factor * 2 / x.fastest()[0], "steps": 600}
    outcome = run(scene)
    energy = outcome.log["kinetic"]
    forget(outcome)
    if factor > 1:
        return np.max(energy) / energy[5]
    return np.max(energy[300:]) / np.max(energy[10:300])


def table_rows():
    names = {linear.table_name(k): k for k in KERNELS}
    return {(r["lattice"], names[r["kernel"]], float(r["h_over_dx"])): r for r in linear.rows("linear_cfl_limits.csv")}


COLUMN = {"ssp-rk3": "CFL_RK3", "rk4": "CFL_RK4", "verlet2": "CFL_verlet2"}


def more(least):
    """Largest excess of the summed density over 1, of the table's rows with so large an h/dx."""
    return max(linear.Lattice(lattice, k, h).rho - 1 for lattice, k, h in table_rows() if h >= least)


def tell_sound(report):
    jobs = [(k, h, c) for k in KERNELS for h in (1.3, 1.5) for c in (False, True)]
    off = np.abs(each(sound, jobs))
    worst = int(np.argmax(off))
    report.rule(
        "frequency of the fastest wave, 7 kernels x h/dx 1.3, 1.5 x both densities",
        f"at most {off[worst]:.1e} off ({jobs[worst][0]})",
        "linear theory of this lattice, 1e-6",
        off[worst] < 1e-6,
    )


def tell_limits(report):
    table = table_rows()
    every = [(k, h) for k in KERNELS for h in (1.3, 1.5)]
    jobs = [(k, h, i, i == "verlet2", 2) for k, h in every for i in WITH_ALL]
    jobs += [("wendland-c2", h, i, False, 2) for h in (1.3, 1.5) for i in SUMMATION if i not in WITH_ALL]
    jobs += [("wendland-c2", h, i, True, 2) for h in (1.3, 1.5) for i in ("ssp-rk3", "rk4")]
    jobs += [("wendland-c2", 1.3, i, False, 3) for i in ("kdk", "rk4")]
    found = dict(zip(jobs, each(stable, jobs)))

    def c_of(job):
        theta, _, omega = found[job]
        return None if theta is None else theta / (omega * job[1])

    report.text("Largest stable C = c dt / h, two-dimensional square lattice; in brackets the table's.")
    rows = []
    for k in KERNELS:
        for h in (1.3, 1.5):
            cells = [k, h]
            for i in WITH_ALL:
                job = (k, h, i, i == "verlet2", 2)
                theirs = float(table["2d_square", k, h][COLUMN.get(i, "CFL_leapfrog")])
                mine = c_of(job)
                cells.append(f"{mine:.3f} ({theirs:.3f})" if mine else f"none near {theirs:.3f}")
            rows.append(cells)
    report.table(["kernel", "h/dx", "kdk", "ssp-rk3", "rk4", "verlet2, continuity"], rows)
    for i in [*SUMMATION, "verlet2"]:
        mine = [j for j in jobs if j[2] == i and j[4] == 2]
        for continuity in (False, True):
            some = [j for j in mine if j[3] == continuity]
            if not some:
                continue
            off = [np.inf if found[j][0] is None else abs(found[j][0] / found[j][1] - 1) for j in some]
            print_off = [
                (
                    np.inf
                    if found[j][0] is None
                    else abs(c_of(j) / float(table["2d_square", j[0], j[1]][COLUMN.get(i, "CFL_leapfrog")]) - 1)
                )
                for j in some
            ]
            density = "continuity" if continuity else "summation"
            report.rule(
                f"{i}, density by {density}: limit, {len(some) // 2} " f"kernel{'s' * (len(some) > 2)} x h/dx 1.3, 1.5",
                f"omega dt = {np.mean([found[j][0] or np.nan for j in some]):.3f}, at most "
                f"{100 * max(off):.1f} % off",
                f"omega dt = {found[some[0]][1]:.3f}, 3 %",
                max(off) < 0.03,
            )
            report.rule(
                f"{i}, density by {density}: C of the table",
                f"at most {100 * max(print_off):.1f} % off",
                "linear_cfl_limits.csv, 10 %",
                max(print_off) < 0.1,
            )
    for j in jobs:
        if j[4] == 3:
            theirs = float(table["3d_cubic", j[0], j[1]][COLUMN.get(j[2], "CFL_leapfrog")])
            mine = c_of(j) or np.nan
            report.rule(
                f"{j[2]}, 3D cubic lattice, {j[0]}, h/dx {j[1]}",
                f"C = {mine:.3f}",
                f"C = {theirs:.3f}, 10 %",
                abs(mine / theirs - 1) < 0.1,
            )


def tell_noise(report):
    jobs = [(k, f) for k in KERNELS for f in (0.98, 1.02)]
    got = dict(zip(jobs, each(noisy, jobs)))
    below, above = max(got[k, 0.98] for k in KERNELS), min(got[k, 1.02] for k in KERNELS)
    report.rule(
        "kdk, noise on all modes at .98 of the limit, 7 kernels",
        f"energy times {below:.2g} in 300 steps",
        "no other wave grows: < 3",
        below < 3,
    )
    report.rule("the same at 1.02 of the limit", f"at least times {above:.2g}", "grows: > 1e4", above > 1e4)


# What linear theory says of small theta, for the table.
LEADING = {
    ("euler", False): "theta^2/2",
    ("euler", True): "theta^2/2",
    ("rk2", False): "theta^4/8",
    ("rk2", True): "theta^4/8",
    ("kdk", True): "theta^4/4",
    ("dkd", True): "theta^4/4",
    ("pec", True): "theta^4/4",
    ("pece", True): "theta^4/8",
    ("symplectic", True): "theta^4/8",
    ("verlet2", True): "theta^2/80 at most",
    ("verlet2", False): "theta^4/16 and more",
    ("ssp-rk3", False): "-theta^4/24",
    ("ssp-rk3", True): "-theta^4/24",
    ("rk4", False): "-theta^6/144",
    ("rk4", True): "-theta^6/144",
}


def tell_growth(report):
    report.text("""
Growth of the amplitude a step, ln, measured and as the integrator's own matrix has it (linear.py), for
theta = omega dt. A minus sign: it damps. Wendland C2, h/dx 1.3.""")
    thetas = (0.3, 0.6)
    jobs = [(i, c, t) for i in linear.INTEGRATORS for c in (False, True) for t in thetas]
    got = dict(zip(jobs, each(grows, jobs)))
    rows, off = [], {}
    for i in linear.INTEGRATORS:
        for c in (False, True):
            cells = [i, "continuity" if c else "summation", LEADING.get((i, c), "0")]
            for t in thetas:
                mine, theory = got[i, c, t], linear.growth(i, t, c)
                off[i, c, t] = abs(mine - theory) / max(abs(theory), 2e-4)
                cells.append(f"{mine:.3e} ({theory:.3e})")
            rows.append(cells)
    report.table(["integrator", "density by", "theory, small theta", "theta = .3", "theta = .6"], rows)
    plain = {j: o for j, o in off.items() if j[0] != "verlet2"}
    worst = max(plain, key=plain.get)
    report.rule(
        "growth or damping a step, 9 integrators x both densities",
        f"at most {100 * plain[worst]:.1f} % off ({worst[0]}, theta {worst[2]})",
        "the integrator's matrix, 5 % (or 1e-5)",
        plain[worst] < 0.05,
    )
    for c, name in ((False, "summation"), (True, "continuity")):
        value = max(got["verlet2", c, t] for t in thetas)
        report.rule(
            f"verlet2, density by {name}: growth below its limit",
            f"{value:.1e} a step",
            "leapfrog: 0 (< 1e-4)",
            value < 1e-4,
            (
                "the coupling every 40 steps is an Euler step, which grows by theta^2/2: theta^2/80 a step"
                if c
                else "x follows the coupled velocity by Taylor's formula: the pair grows at any step"
            ),
        )


def main(report=None):
    report = Report(
        "Largest stable step on a lattice",
        "The barotropic scheme (no dissipation, p = 0 at rest) on a perfect periodic lattice, a plane wave of "
        "velocity 1e-6 c on the fastest mode of the box (24 x 24; 12^3), double precision, fixed "
        "steps. Limits are "
        "bisected to 1 %. theta = omega dt; C = c dt / h. With density by summation a wave is "
        "an oscillator of x and v, "
        "with density by continuity one of rho and v: integrators differ in which of the two "
        "they are good for.",
    )
    total, bad, excess = linear.compare_limits()
    report.rule(
        "linear.py against linear_cfl_limits.csv", f"{total - len(bad)} of {total} rows to the digit", "all", not bad
    )
    report.text(f"""
The table takes density 1 (its limits are those of a density by continuity), where the summation on the lattice gives
more: up to {100 * more(1.3):.1f} % at h/dx of 1.3 and above, {100 * more(1.0):.0f} % at 1. Its maxima are over coarse
grids of wave vectors, up to {100 * excess:.1f} % below the true ones. Its rows in one dimension take Wendland's function of one dimension for C2, those of two and three for C4 and C6; the plugin
`kernels` has the functions of one dimension throughout.""")
    tell_sound(report)
    tell_limits(report)
    tell_noise(report)
    tell_growth(report)
    return report

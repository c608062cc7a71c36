"""Integrators, each against what it claims. Orders: a Kepler orbit, whose solution is known, and waves on one and
the same lattice against a far smaller step. Energy over 10^4 orbits. Growth of oscillations, and up to which
step they are stable, for x and v (a spring; density by summation) and for kicked properties alone (density by
continuity): the figures of core/integrators/README."""
import math
import os
import sys

import numpy

sys.path.insert(0, os.path.join(os.environ["top_srcdir"], "tests"))
from scenes import Scenes, Snapshot, changed, example  # noqa: E402

scenes = Scenes()
# Some runs are to grow: not watched.
orbit, wave, spring = (changed(example(name), watch=False) for name in ("orbit.json", "wave.json", "orbit.json"))
for scene in (orbit, wave, spring):
    scene.pop("probes")
    scene["output"] = {"log": {"steps": 100000000}}
spring["scheme"]["edit"][0]["n"] = -1
spring["particles"]["planet"]["fields"]["v"] = [0, 0]

ORDER = {"kdk": 2, "dkd": 2, "symplectic": 2, "verlet2": 2, "pec": 2, "pece": 2, "rk2": 2, "ssp-rk3": 3, "rk4": 4,
         "euler": 1}


# verlet2 couples its two sequences of steps again every 40: its errors compare in series of whole cycles, and fall
# as they should where a cycle is short beside the period.


def bar(what, value, low=-math.inf, high=math.inf):
    """Prints a figure beside its bar."""
    good = low <= value <= high
    print(f"{'ok  ' if good else 'MISS'} {what}: {value:.5g} ({low:.5g} to {high:.5g})")
    scenes.missed += not good


def run(scene, integrator, dt, steps):
    """First and last snapshot of `steps` steps. A dt that is a power of 2 leaves no rounding in the time."""
    scene = changed(scene, time={"integrator": integrator, "end": steps * dt, "dt": dt})
    result = scenes.good(scene, "--steps", str(steps))
    assert result.summary()["steps"] == steps
    return [Snapshot(result.snapshots()[k]) for k in (0, -1)]


def order(what, counts, errors, expected):
    """Of errors after so many steps."""
    found = -numpy.polyfit(numpy.log(counts), numpy.log(errors), 1)[0]
    bar(f"order of {what}, errors {' '.join(f'{e:.2g}' for e in errors)}", found, expected - 0.15, expected + 0.15)


def kepler(x, v, t):
    """After t, about a centre of mu = 1: Lagrange's f and g (Danby 1988, Fundamentals of Celestial
    Mechanics), Kepler's equation by Newton's method."""
    r = math.hypot(*x)
    a = 1 / (2 / r - v @ v)
    c, s, m = 1 - r / a, x @ v / math.sqrt(a), t / a**1.5
    e = m
    for _ in range(50):
        e -= (e - c * math.sin(e) + s * (1 - math.cos(e)) - m) / (1 - c * math.cos(e) + s * math.sin(e))
    assert abs(e - c * math.sin(e) + s * (1 - math.cos(e)) - m) < 1e-12
    return (1 - a / r * (1 - math.cos(e))) * x + (t - a**1.5 * (e - math.sin(e))) * v


def orbit_errors(name, end, counts):
    errors = []
    for n in counts:
        first, last = run(orbit, name, end / n, n)
        exact = kepler(first["x"][0, :2], first["v"][0, :2], end)
        errors.append(math.hypot(*(last["x"][0, :2] - exact)))
    return errors


def orbits():
    """Somewhat less than a turn."""
    counts = {1: (24576, 49152, 98304), 2: (768, 1536, 3072), 3: (384, 768, 1536), 4: (384, 768, 1536)}
    for name, expected in ORDER.items():
        n = (1920, 3840, 7680) if name == "verlet2" else counts[expected]
        order(f"{name}, orbit", n, orbit_errors(name, 6, n), expected)


def waves():
    """The same particles with a far smaller step: the errors in space cancel."""
    counts = {1: (512, 1024, 2048), 2: (128, 256, 512), 3: (32, 64, 128), 4: (64, 128, 256)}
    for scheme in ("barotropic", "barotropic-continuity"):
        scene = changed(wave, scheme=scheme)
        scene["particles"]["gas"]["fill"]["spacing"] = 1 / 32
        scene["particles"]["gas"]["fields"]["v"] = ["0.02 * sin(2 * pi * x)"]
        exact = run(scene, "rk4", 2**-13, 2**12)[1]
        for name, expected in ORDER.items():
            errors = []
            n = (2560, 5120, 10240) if name == "verlet2" else counts[expected]
            for steps in n:
                last = run(scene, name, 0.5 / steps, steps)[1]
                errors.append(math.sqrt(((last["x"] - exact["x"]) ** 2 + (last["v"] - exact["v"]) ** 2).sum()))
            order(f"{name}, {scheme}", n, errors, expected)


def energies(name, turns, steps):
    """Relative errors of the energy, some 2000 in all."""
    dt = 2 * math.pi / steps
    scene = changed(orbit, time={"integrator": name, "end": turns * 2 * math.pi, "dt": dt})
    scene["output"] = {"log": {"steps": turns * steps // 2000 + 1}}
    names, rows = scenes.good(scene).log()
    rows = numpy.array(rows)
    energy = rows[:, names.index("kinetic")] + rows[:, names.index("potential")]
    return rows[:, names.index("time")], energy / energy[0] - 1


def drift():
    """The trend over a run in units of the scatter about it: of noise alone about 0.08."""
    for name, turns, symplectic in (("kdk", 10000, True), ("symplectic", 1000, True), ("rk2", 1000, False),
                                    ("rk4", 1000, False)):
        t, error = energies(name, turns, 100)
        line = numpy.polyfit(t, error, 1)
        rest = (error - numpy.polyval(line, t)).std()
        trend = abs(line[0]) * (t[-1] - t[0]) / rest
        bar(f"energy, {name}, {turns} turns: largest error {abs(error).max():.2g}, trend", trend,
            *((0, 0.3) if symplectic else (1, math.inf)))


def spring_size(snapshot):
    return math.hypot(snapshot["x"][0, 0], snapshot["v"][0, 0])


def wave_size(snapshot):
    """In units of the speed of sound and of the density, which are 1."""
    return math.sqrt((snapshot["v"] ** 2).sum() + ((snapshot["rho"] - 1) ** 2).sum())


def coupled(w, kicked):
    """Growth of verlet2 a step, over a cycle of 40 steps of which the first is Euler's: the largest eigenvalue."""
    if kicked:  # of (rho, v), and of the step before
        turn, one, none = numpy.array([[0, w], [-w, 0]]), numpy.eye(2), numpy.zeros((2, 2))
        two_step = numpy.block([[2 * turn, one], [one, none]])
        euler = numpy.block([[one + turn, none], [one, none]])
    else:  # of x, v and v of the step before
        two_step = numpy.array([[1 - w * w / 2, w, 0], [-2 * w, 0, 1], [0, 1, 0]])
        euler = numpy.array([[1 - w * w / 2, w, 0], [-w, 1, 0], [0, 1, 0]])
    cycle = numpy.linalg.matrix_power(two_step, 39) @ euler
    return abs(numpy.linalg.eigvals(cycle)).max() ** (1 / 40) - 1


def polynomial(w, order):
    """Growth of a Runge-Kutta method of as many stages as its order, a step."""
    return abs(sum((1j * w) ** k / math.factorial(k) for k in range(order + 1))) - 1


def bashforth(w):
    """Of Adams' and Bashforth's second-order method."""
    return abs(numpy.roots([1, -1 - 1.5j * w, 0.5j * w])).max() - 1


def growth(what, scene, frequency, size, expected):
    """Growth a step of w = 0.2, over 800 steps."""
    for name, wanted in expected.items():
        first, last = run(scene, name, 0.2 / frequency, 800)
        found = (size(last) / size(first)) ** (1 / 800) - 1
        room = 0.02 * abs(wanted) + 5e-8
        bar(f"growth of {name}, {what}", found, wanted - room, wanted + room)


def limits(what, scene, frequency, size, expected):
    """1 per cent below the largest stable step nothing has grown in 400 steps, 1 per cent above it much."""
    for name, limit in expected.items():
        for factor in (0.99, 1.01):
            first, last = run(scene, name, factor * limit / frequency, 400)
            found = size(last) / size(first)
            bar(f"{name}, {what}, w = {factor * limit:.3f}: size after 400 steps", found,
                *((0, 2) if factor < 1 else (10, math.inf)))


def oscillations():
    w = 0.2
    one_step = {"rk2": polynomial(w, 2), "ssp-rk3": polynomial(w, 3), "rk4": polynomial(w, 4), "euler": polynomial(w, 1)}
    # x and v: position and velocity Verlet neither grow nor decay.
    growth("x and v", spring, 1, spring_size,
           {"kdk": 0, "dkd": 0, "pec": 0, "symplectic": 0, "pece": 0, "verlet2": coupled(w, False), **one_step})
    limits("x and v", spring, 1, spring_size,
           {"kdk": 2, "dkd": 2, "pec": 2, "symplectic": 2, "pece": 2, "ssp-rk3": math.sqrt(3), "rk4": math.sqrt(8)})
    # rho and v, both kicked: the fastest wave that the lattice has, so that no other one overtakes it.
    scene = changed(wave, scheme="barotropic-continuity")
    scene["materials"]["gas"]["eos"]["p0"] = 0
    scene["particles"]["gas"]["fill"]["spacing"] = 1 / 32
    scene["particles"]["gas"]["fields"]["v"] = ["1e-6 * sin(12 * pi * x)"]
    first, last = run(scene, "rk4", 2**-12, 128)
    frequency = math.acos(math.sqrt((last["v"] ** 2).sum() / (first["v"] ** 2).sum())) * 32
    print(f"     largest frequency of the lattice: {frequency * 1.3 / 32:.3f} c / h")
    growth("rho and v", scene, frequency, wave_size,
           {"kdk": bashforth(w), "dkd": bashforth(w), "pec": bashforth(w), "symplectic": polynomial(w, 2),
            "pece": polynomial(w, 2), "verlet2": coupled(w, True), **{n: one_step[n] for n in ("rk2", "ssp-rk3", "rk4")}})
    limits("rho and v", scene, frequency, wave_size, {"ssp-rk3": math.sqrt(3)})


def floats():
    """State in two floats each, with steps that grow: what is kept of them is no worse. The bar: pairs of pressure
    p0 = 1 push with about 1 / h = 25 from either side, summed to 6e-7 of that; over t = 0.25."""
    scene = changed(wave, scheme="barotropic-continuity", time={"end": 0.25, "cfl": 0.1})
    scene["particles"]["gas"]["fields"]["v"] = ["0.02 * sin(2 * pi * x)"]
    for name in ORDER:
        scene["time"]["integrator"] = name
        double, mixed = (scenes.good(changed(scene, precision=p)).last() for p in ("double", "mixed"))
        bar(f"mixed precision, {name}: difference of v", abs(double["v"] - mixed["v"]).max(), 1e-15, 6e-7 * 2 * 25 * 0.25)


orbits()
waves()
floats()
oscillations()
drift()
scenes.end()

"""linear.py -- linear theory of SPH on a perfect lattice: which waves run, how fast, and which step an
integrator can follow them with. Nothing of sph is used; kernels are the literature's formulas once more.

Displacements xi = A exp(i (k.x - w t)) on a lattice of particles of volume 1 (dx = 1), at fixed h. With
r = x_i - x_j, sums over the neighbours j, m = rho0 = 1 and rho the density that the summation gives,

    G(k) = sum sin(k.r) grad W,                   drho = i A.G,
    w^2 A = D A,   D = (c^2 - 2 P/rho) / rho^2 G G^T + 2 P/rho^2 sum (1 - cos k.r) grad grad W

(Price 2012, J. Comput. Phys. 231, 759, eq. 30, linearised; Monaghan 2005, Rep. Prog. Phys. 68, 1703,
sect. 3.5; Violeau & Leroy 2014, J. Comput. Phys. 256, 388). At P = 0 there is one branch,
w = c |G| / rho: the sound. With P > 0 the longitudinal branch softens for wavelengths near 2 dx, and where
w^2 < 0 particles pair.

As a program: prints what it makes of tests/reference/linear_*.csv and fails where digits differ (but for OTHER).
"""

import csv
import os
import sys

try:
    import numpy as np
except ImportError as missing:
    print(f"{missing}: not tried (package python3-numpy)")
    sys.exit(77)

PI = np.pi

# -- Kernels: value and first two derivatives of W(q), h = 1 ----------------------------------------


def _clamped(terms):
    """Sum of c max(0, k - q)^n, and its derivatives."""

    def w(q, order):
        total = np.zeros_like(q)
        for c, k, n in terms:
            t = np.maximum(k - q, 0.0)
            for i in range(order):
                c = -c * (n - i)
            total += c * t ** (n - order)
        return total

    return w


def _wendland(power, coefficients):
    """(1 - r)^power (c0 + c1 r + ...), r = q / 2."""
    poly = np.polynomial.polynomial.Polynomial(coefficients)
    whole = np.polynomial.polynomial.Polynomial([1.0, -1.0]) ** power * poly

    def w(q, order):
        p = whole.deriv(order) if order else whole
        return np.where(q < 2.0, p(0.5 * q) / 2.0**order, 0.0)

    return w


def _gauss(q, order):
    return np.exp(-q * q) * (1.0, -2.0 * q, 4.0 * q * q - 2.0)[order]


_spline = {
    "cubic-spline": (2.0, [(0.25, 2, 3), (-1.0, 1, 3)]),
    "quartic-spline": (2.5, [(1, 2.5, 4), (-5, 1.5, 4), (10, 0.5, 4)]),
    "quintic-spline": (3.0, [(1, 3, 5), (-6, 2, 5), (15, 1, 5)]),
}
_wendlands = {
    "wendland-c2": ((3, [1, 3]), (4, [1, 4])),
    "wendland-c4": ((5, [1, 5, 8]), (6, [1, 6, 35 / 3])),
    "wendland-c6": ((7, [1, 7, 19, 21]), (8, [1, 8, 25, 32])),
}
KERNELS = [*_spline, *_wendlands, "gaussian"]


class Kernel:
    """W(q) of a dimension, normalised here by quadrature. same_polynomial: the polynomial of two and
    three dimensions for Wendland's functions in one, too."""

    def __init__(self, name, dim, same_polynomial=False):
        self.dim = dim
        if name in _spline:
            self.support, terms = _spline[name]
            self._w = _clamped(terms)
        elif name == "gaussian":
            self.support, self._w = 3.0, _gauss
        else:
            self.support = 2.0
            self._w = _wendland(*_wendlands[name][0 if dim == 1 and not same_polynomial else 1])
        node, weight = np.polynomial.legendre.leggauss(24)
        area = (0, 2, 2 * PI, 4 * PI)[dim]
        total, pieces = 0.0, int(round(2 * self.support))
        for i in range(pieces):
            q = (i + 0.5 + 0.5 * node) * 0.5
            total += 0.25 * np.sum(weight * self._w(q, 0) * q ** (dim - 1))
        self.norm = 1.0 / (area * total)

    def w(self, q, order=0):
        return np.where(q < self.support, self.norm * self._w(q, order), 0.0)


# -- Lattices of one particle a volume 1 ------------------------------------------------------------

LATTICES = {
    "1d": np.array([[1.0]]),
    "2d_square": np.eye(2),
    "2d_hex": np.sqrt(2 / np.sqrt(3)) * np.array([[1.0, 0.0], [0.5, np.sqrt(3) / 2]]),
    "3d_cubic": np.eye(3),
    "3d_fcc": 4 ** (1 / 3) / 2 * np.array([[0.0, 1, 1], [1, 0, 1], [1, 1, 0]]),
    "3d_bcc": 2 ** (1 / 3) / 2 * np.array([[-1.0, 1, 1], [1, -1, 1], [1, 1, -1]]),
}


class Lattice:
    """Neighbours on a lattice with the kernel's values on them; rows of `a` are its vectors."""

    def __init__(self, lattice, kernel, h, same_polynomial=False, continuity=False):
        a = LATTICES[lattice]
        self.dim = len(a)
        self.h = h
        self.reciprocal = 2 * PI * np.linalg.inv(a).T
        k = Kernel(kernel, self.dim, same_polynomial)
        self.reach = k.support * h
        n = int(np.ceil(self.reach / np.min(np.linalg.svd(a)[1]))) + 1
        grid = np.stack(np.meshgrid(*[np.arange(-n, n + 1)] * self.dim, indexing="ij"), -1)
        r = grid.reshape(-1, self.dim) @ a
        far = np.linalg.norm(r, axis=1)
        r, far = r[(far > 0) & (far < self.reach)], far[(far > 0) & (far < self.reach)]
        self.r, self.neighbours = r, len(r)
        q, d = far / h, self.dim
        self.rho = 1.0 if continuity else (np.sum(k.w(q)) + k.w(np.zeros(1))[0]) / h**d
        first, second = k.w(q, 1) / h ** (d + 1), k.w(q, 2) / h ** (d + 2)
        e = r / far[:, None]
        self.gradient = first[:, None] * e
        across = (first / far)[:, None, None] * np.eye(d)
        along = (second - first / far)[:, None, None] * e[:, :, None] * e[:, None, :]
        self.hessian = across + along

    def g(self, k):
        """G at wave vectors k (n x dim)."""
        return np.sin(k @ self.r.T) @ self.gradient

    def omega(self, k, c=1.0):
        """Of sound at P = 0, without a sign."""
        return c * np.linalg.norm(self.g(k), axis=1) / self.rho

    def matrix(self, k, gamma=5 / 3, c=1.0):
        """D at wave vectors k, for P = c^2 rho / gamma."""
        p = c * c * self.rho / gamma
        g = self.g(k)
        stiff = np.tensordot(1 - np.cos(k @ self.r.T), self.hessian, axes=(1, 0))
        return (c * c - 2 * p / self.rho) / self.rho**2 * g[:, :, None] * g[:, None, :] + (2 * p / self.rho**2 * stiff)

    def longitudinal(self, k, gamma=5 / 3):
        """w^2 / (c k)^2 of the eigenvector that is nearest to k."""
        value, vector = np.linalg.eigh(self.matrix(k, gamma))
        unit = k / np.linalg.norm(k, axis=1)[:, None]
        best = np.argmax(np.abs(np.einsum("nij,ni->nj", vector, unit)), axis=1)
        return value[np.arange(len(k)), best] / np.sum(k * k, axis=1)

    def zone(self, n):
        """Wave vectors of the first Brillouin zone, about n an axis: half of it, as -k is k."""
        s = (np.arange(n) + 0.5) / n - 0.5
        s = np.append(s, 0.5)
        f = np.stack(np.meshgrid(*[s] * self.dim, indexing="ij"), -1).reshape(-1, self.dim)
        k = f @ self.reciprocal
        near = np.stack(np.meshgrid(*[[-1, 0, 1]] * self.dim, indexing="ij"), -1)
        shifts = near.reshape(-1, self.dim) @ self.reciprocal
        size = np.sum((k[:, None, :] - shifts[None]) ** 2, axis=2)
        k = k - shifts[np.argmin(size, axis=1)]
        return k[(k[:, 0] >= -1e-12) & (np.sum(k * k, axis=1) > 1e-12)]

    def cartesian(self, n):
        """Wave vectors of the first Brillouin zone on a grid of positive components."""
        s = np.linspace(0, np.max(np.abs(self.reciprocal)), n)
        k = np.stack(np.meshgrid(*[s] * self.dim, indexing="ij"), -1).reshape(-1, self.dim)
        near = np.stack(np.meshgrid(*[[-1, 0, 1]] * self.dim, indexing="ij"), -1)
        shifts = near.reshape(-1, self.dim) @ self.reciprocal
        far = np.min(np.sum((k[:, None, :] - shifts[None]) ** 2, axis=2), axis=1)
        size = np.sum(k * k, axis=1)
        return k[(size <= far + 1e-9) & (size > 1e-9)]

    def fastest(self):
        """(w, k) of the fastest sound: a grid over the zone, then smaller ones about the best."""
        k = self.zone({1: 256, 2: 48, 3: 16}[self.dim])
        w = self.omega(k)
        best, k = np.max(w), k[np.argmax(w)]
        step = np.linalg.norm(self.reciprocal) / 16
        cube = np.stack(np.meshgrid(*[np.linspace(-1, 1, 9)] * self.dim, indexing="ij"), -1)
        cube = cube.reshape(-1, self.dim)
        while step > 1e-9:
            near = k + step * cube
            w = self.omega(near)
            best, k = max(best, np.max(w)), near[np.argmax(w)]
            step *= 0.4
        return best, k


# -- Integrators on an oscillator -------------------------------------------------------------------
# One mode of frequency w, theta = w dt, as two real numbers. Density by summation: x and v, where x drifts
# with v and v is kicked by a(x) = -theta^2 x (dt = 1). Density by continuity: density and velocity, both
# kicked: d/dt (rho, v) = theta (-v, rho), while x only follows. A step is linear, so that its matrix on
# (x, kicked, kicked of the step before, last rates) and that matrix's largest root are found by stepping
# unit vectors. The formulas: Springel (2005, MNRAS 364, 1105), Monaghan (1989, J. Comput. Phys. 82, 1),
# Shu & Osher (1988, J. Comput. Phys. 77, 439), Dominguez et al. (2022, Comput. Part. Mech. 9, 867).

TWIST = np.array([[0.0, -1.0], [1.0, 0.0]])


class Oscillator:
    """x: what drifts; y: what is kicked (two numbers, of which summation uses the first)."""

    def __init__(self, theta, continuity):
        self.theta, self.continuity = theta, continuity

    def rate(self, x, y):
        return self.theta * TWIST @ y if self.continuity else np.array([-self.theta**2 * x, 0.0])

    def speed(self, y):
        return 0.0 if self.continuity else y[0]


def euler(o, x, y, old, r, count):
    x, y = x + o.speed(y), y + r
    return x, y, y, o.rate(x, y)


def kdk(o, x, y, old, r, count):
    x = x + o.speed(y + r / 2)
    end = o.rate(x, y + r)
    return x, y + (r + end) / 2, y, end


def dkd(o, x, y, old, r, count):
    x = x + o.speed(y) / 2
    r = o.rate(x, y + r / 2)
    return x + o.speed(y + r) / 2, y + r, y, r


def symplectic(o, x, y, old, r, count):
    middle = x + o.speed(y) / 2
    r = o.rate(middle, y + r / 2)
    x, y = middle + o.speed(y + r) / 2, y + r
    return x, y, y, o.rate(x, y)


def pec(o, x, y, old, r, count):
    r = o.rate(x + o.speed(y) / 2, y + r / 2)
    return x + o.speed(y + r / 2), y + r, y, r


def pece(o, x, y, old, r, count):
    x, y, old, r = pec(o, x, y, old, r, count)
    return x, y, old, o.rate(x, y)


def rk2(o, x, y, old, r, count):
    v = o.speed(y + r / 2)
    y = y + o.rate(x + o.speed(y) / 2, y + r / 2)
    return x + v, y, y, o.rate(x + v, y)


def ssp_rk3(o, x, y, old, r, count):
    x1, y1 = x + o.speed(y), y + r
    x2, y2 = 0.75 * x + 0.25 * (x1 + o.speed(y1)), 0.75 * y + 0.25 * (y1 + o.rate(x1, y1))
    x, y = (x + 2 * (x2 + o.speed(y2))) / 3, (y + 2 * (y2 + o.rate(x2, y2))) / 3
    return x, y, y, o.rate(x, y)


def rk4(o, x, y, old, r, count):
    v1, r1 = o.speed(y), o.rate(x, y)
    v2, r2 = o.speed(y + r1 / 2), o.rate(x + v1 / 2, y + r1 / 2)
    v3, r3 = o.speed(y + r2 / 2), o.rate(x + v2 / 2, y + r2 / 2)
    v4, r4 = o.speed(y + r3), o.rate(x + v3, y + r3)
    x, y = x + (v1 + 2 * v2 + 2 * v3 + v4) / 6, y + (r1 + 2 * r2 + 2 * r3 + r4) / 6
    return x, y, y, o.rate(x, y)


def verlet2(o, x, y, old, r, count):
    """Two steps from the step before; every 40th couples both halves: one step from this one."""
    x = x + o.speed(y) + (0.0 if o.continuity else r[0] / 2)
    new = y + r if count % 40 == 0 else old + 2 * r
    return x, new, y, o.rate(x, new)


INTEGRATORS = {
    "euler": euler,
    "kdk": kdk,
    "dkd": dkd,
    "symplectic": symplectic,
    "pec": pec,
    "pece": pece,
    "rk2": rk2,
    "ssp-rk3": ssp_rk3,
    "rk4": rk4,
    "verlet2": verlet2,
}


def growth(integrator, theta, continuity=False):
    """ln of the largest factor that a mode's amplitude takes in a step (of 40, for verlet2)."""
    o = Oscillator(theta, continuity)
    steps = 40 if integrator == "verlet2" else 1
    # Of the seven numbers those that the oscillator has: what nothing acts on has a root of 1.
    mine = [1, 2, 3, 4, 5, 6] if continuity else [0, 1, 3, 5]
    columns = []
    for unit in np.eye(7)[mine]:
        x, y, old, r = unit[0], unit[1:3], unit[3:5], unit[5:7]
        for count in range(steps):
            x, y, old, r = INTEGRATORS[integrator](o, x, y, old, r, count)
        columns.append(np.concatenate([[x], y, old, r])[mine])
    root = np.max(np.abs(np.linalg.eigvals(np.array(columns).T)))
    return np.log(max(root, 1e-300)) / steps


def limit(integrator, continuity=False, tolerance=1e-9):
    """Largest theta up to which nothing grows; 0: everything grows."""
    grid = np.arange(1, 601) * 0.005 + 1e-4
    bad = [t for t in grid if growth(integrator, t, continuity) > tolerance]
    if not bad:
        return grid[-1]
    low, high = max(bad[0] - 0.005, 0.0), bad[0]
    while low > 0 and high - low > 1e-9:
        middle = (low + high) / 2
        low, high = (low, middle) if growth(integrator, middle, continuity) > tolerance else (middle, high)
    return low


# The table's limits.
LIMITS = {"kdk": 2.0, "ssp-rk3": np.sqrt(3.0), "rk4": 2 * np.sqrt(2.0), "verlet2": 1.0}


def table_name(kernel):
    return "gaussian_3h" if kernel == "gaussian" else kernel.replace("-", "_")


def own_polynomial(kernel):
    """The table's rows in 1D: C2 is the function of one dimension, C4 and C6 are not."""
    return kernel == "wendland-c2"


# -- Against the tables -----------------------------------------------------------------------------


def rows(name):
    folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "reference")
    with open(os.path.join(folder, name)) as file:
        return list(csv.DictReader(line for line in file if line[0] != "#"))


# The tables' wave vectors: so many fractions of half a reciprocal vector, 0 to 1. Coarse in 3D: the
# true maximum (Lattice.fastest) is up to 1.1 % above.
TABLE_GRID = {1: 100, 2: 24, 3: 9}


def table_omega(x):
    f = np.arange(TABLE_GRID[x.dim] + 1) / (2 * TABLE_GRID[x.dim])
    k = np.stack(np.meshgrid(*[f] * x.dim, indexing="ij"), -1).reshape(-1, x.dim) @ x.reciprocal
    return np.max(x.omega(k))


def same_digits(mine, text):
    """Within one unit of the last digit printed: a figure that falls on half of one goes either way."""
    digits = len(text.partition(".")[2])
    return abs(mine - float(text)) <= 1.001 * 10.0**-digits


def compare_limits():
    """(rows, those that differ in a digit, largest excess of the true maximum)."""
    names = {table_name(k): k for k in KERNELS}
    differ, excess, table = [], 0.0, rows("linear_cfl_limits.csv")
    for row in table:
        h, kernel = float(row["h_over_dx"]), names[row["kernel"]]
        x = Lattice(row["lattice"], kernel, h, not own_polynomial(kernel), continuity=True)
        omega = table_omega(x)
        mine = [omega, omega * h] + [LIMITS[i] / (omega * h) for i in ("kdk", "ssp-rk3", "rk4", "verlet2")]
        theirs = list(row.values())[4:]
        if x.neighbours != int(row["neighbours"]) or not all(map(same_digits, mine, theirs)):
            differ.append(f"{row['lattice']} {kernel} {h}: {mine} not {theirs}")
        excess = max(excess, x.fastest()[0] / omega - 1)
    return len(table), differ, excess


# Thresholds: h in these steps from 1 as far as the number of neighbours that the table prints, wave vectors
# of a Cartesian grid within the zone (3D; coarse) or of fractions of the reciprocal vectors.
PAIRING_STEP = {1: 0.025, 2: 0.025, 3: 0.05}
PAIRING_END = {1: 0.35, 2: 0.45, 3: 0.5}


def pairing_scan(lattice, kernel, n_max):
    """(first h with w_L^2 < -1e-3 c^2 k^2 or None, the least w_L^2, where, volume of the support at h = 1)."""
    dim = len(LATTICES[lattice])
    volume = (0, 2, PI, 4 * PI / 3)[dim] * Kernel(kernel, dim).support ** dim
    h_max = ((n_max + PAIRING_END[dim]) / volume) ** (1 / dim)
    first, worst, at, k = None, np.inf, 0.0, None
    for i in range(1, int((h_max - 1) / PAIRING_STEP[dim] + 1e-9) + 1):
        h = 1 + PAIRING_STEP[dim] * i
        x = Lattice(lattice, kernel, h, not own_polynomial(kernel), continuity=True)
        if k is None:
            k = x.cartesian(14) if dim == 3 else x.zone({1: 400, 2: 64}[dim])
        w = np.min(x.longitudinal(k))
        first = h if first is None and w < -1e-3 else first
        worst, at = (w, h) if w < worst else (worst, at)
    return first, worst, at, volume


# Its least value is not the one printed: 1e-4 at h/dx 1.25 on these wave vectors, not 2e-4 at 1.55. Both: stable.
OTHER = "3d_fcc quartic-spline"


def compare_pairing():
    """(rows, those that differ)."""
    names = {table_name(k): k for k in KERNELS}
    differ, table = [], rows("linear_pairing_thresholds.csv")
    for row in table:
        kernel = names[row["kernel"]]
        first, worst, at, volume = pairing_scan(row["lattice"], kernel, float(row["N_max_scanned"]))
        theirs = row["h_over_dx_threshold"]
        same = (first is None) == (theirs == "") and same_digits(worst, row["worst_omega2_over_c2k2"])
        if first and theirs:
            n = volume * first ** int(row["lattice"][0])
            same = same and abs(first - float(theirs)) < 1e-9 and same_digits(n, row["N_threshold"])
        # Where the least value is 0 to the digits printed, where it is found says nothing.
        if abs(worst) >= 1e-4 and abs(at - float(row["worst_at_h_over_dx"])) > 0.0051:
            same = False
        if not same:
            differ.append(f"{row['lattice']} {kernel}: {first} {worst:.5f} {at} not {list(row.values())[2:]}")
    return len(table), differ


if __name__ == "__main__":
    total, bad, excess = compare_limits()
    print(f"linear_cfl_limits.csv: {total - len(bad)} of {total} rows to the digit")
    print(f"the true maximum of omega is up to {100 * excess:.2f} % above that of the table's wave vectors")
    total, worse = compare_pairing()
    print(f"linear_pairing_thresholds.csv: {total - len(worse)} of {total} rows to the digit")
    print(*bad, *worse, sep="\n")
    sys.exit(1 if bad or [w.split(":")[0] for w in worse] != [OTHER] else 0)

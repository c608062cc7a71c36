"""What the plugins of tests/sdk must give: figures of runs against exact values, each beside its bar."""
import csv
import glob
import json
import math
import os
import subprocess
import sys

import h5py
import numpy


class Snapshot:
    """Columns of one array by name, in the order of x."""

    def __init__(self, path, array):
        with h5py.File(path) as file:
            root = file["VTKHDF"]
            field = root["FieldData"]
            self.time = float(field["Time"][0])
            names = [name.decode() for name in field["array_names"]]
            data = {name: column[:] for name, column in root["PointData"].items()}
            data["x"], data["y"] = root["Points"][:, 0], root["Points"][:, 1]
        here = numpy.flatnonzero(data["array"] == names.index(array))
        here = here[data["x"][here].argsort()]
        self.column = {name: column[here] for name, column in data.items()}
        self.column["v"] = self.column["v"][:, 0]

    def __getitem__(self, name):
        return self.column[name]


class Run:
    """What a run left."""

    def __init__(self, out):
        self.out = out
        with open(os.path.join(out, "summary.json"), encoding="utf-8") as file:
            self.summary = json.load(file)

    def error(self, field, norm="l1_rel", array="fluid"):
        return self.summary["errors"][f"{array}.{field}"][norm]

    def probe(self, name):
        return self.summary["probes"][name]["value"]

    def snapshots(self, array="fluid"):
        return [Snapshot(path, array) for path in sorted(glob.glob(os.path.join(self.out, "snapshot_*")))]

    def log(self):
        with open(os.path.join(self.out, "log.csv"), newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        return {name: numpy.array([float(row[name]) for row in rows]) for name in rows[0]}


class Physics:
    def __init__(self, source, folder, plugins):
        self.source, self.folder = source, folder
        self.environment = dict(os.environ, SPH_PLUGIN_PATH=f"{plugins}:")
        self.missed = self.count = 0

    # -- Runs and bars

    def sph(self, *words, path=None):
        environment = dict(self.environment)
        if path:
            environment["SPH_PLUGIN_PATH"] = path + ":" + environment["SPH_PLUGIN_PATH"]
        return subprocess.run(["sph", *words], env=environment, capture_output=True, text=True)

    def run(self, scene, *settings, options=(), path=None):
        """Runs a file of tests/sdk, or an installed example with plugins of ours added."""
        self.count += 1
        out = os.path.join(self.folder, f"out{self.count}")
        sets = [word for one in settings for word in ("--set", one)]
        done = self.sph(self.scene(scene), "--out", out, "--quiet", *sets, *options, path=path)
        if done.returncode:
            sys.exit(f"MISS {scene} {settings} {options}: exit status {done.returncode}: {done.stderr}")
        return Run(out)

    def scene(self, name):
        own = os.path.join(self.source, name)
        if os.path.exists(own):
            return own
        example = os.path.join(self.folder, "prefix", "share", "sph", "examples", name)
        with open(example, encoding="utf-8") as file:
            scene = json.load(file)
        scene["plugins"] += ["stiffened-gas", "stiffened-riemann", "poly6", "reordered"]
        example = os.path.join(self.folder, name)
        with open(example, "w", encoding="utf-8") as file:
            json.dump(scene, file)
        return example

    def bar(self, what, value, low=None, high=None):
        good = (low is None or value >= low) and (high is None or value <= high)
        bounds = (f">= {low:g}" if low is not None else "", f"<= {high:g}" if high is not None else "")
        print(f"{'ok  ' if good else 'MISS'} {what}: {value:.6g} ({' '.join(word for word in bounds if word)})")
        self.missed += not good

    def same(self, what, value, exact, tolerance):
        """Relative; absolute where the exact value is 0."""
        self.bar(f"{what}: {value:.9g}, exact {exact:.9g}, off by", abs(value - exact) / (abs(exact) or 1), high=tolerance)

    # -- stiffened-gas: its shock tube, with each build of the plugin

    def tube(self, builds):
        scene = "stiffened-gas/scene.json"
        run = self.run(scene)
        for field, high in (("rho", 0.005), ("p", 0.009), ("v", 0.022)):
            self.bar(f"stiffened gas, 900 particles: l1_rel of {field}", run.error(field), high=high)
        self.bar("its energy drift", abs(run.summary["conservation"]["energy_drift"]), high=1e-5)
        first = run.snapshots()[0]
        state = (first["p"] + 2 * 0.5) / first["rho"]
        self.bar("u = (p + gamma p_inf) / ((gamma - 1) rho)", abs(first["u"] / state - 1).max(), high=1e-14)
        state = 2 * (first["p"] + 0.5) / first["rho"]
        self.bar("cs^2 = gamma (p + p_inf) / rho", abs(first["cs"] ** 2 / state - 1).max(), high=1e-14)
        coarse = [f"particles.fluid.fill.{k}.mass=0.00125" for k in (0, 1)]
        reference = self.run(scene, *coarse)
        ratio = reference.error("rho") / run.error("rho")
        self.bar("error of rho with 450 over that with 900 particles", ratio, low=1.6)
        for field in ("rho", "p", "v"):
            wrong = self.run(scene, *coarse, "compare.0.p_inf=0").error(field) / reference.error(field)
            self.bar(f"error of {field} against an ideal gas, over that against the right one", wrong, low=3)
        # Water, in SI units: 10^9 Pa against 10^5.
        water = ["materials.liquid.eos.gamma=4.4", "materials.liquid.eos.p_inf=6e8", "compare.0.gamma=4.4",
                 "compare.0.p_inf=6e8", "time.end=1.4e-4"]
        for k, side, p in ((0, "l", 1e9), (1, "r", 1e5)):
            fill = f"particles.fluid.fill.{k}"
            water += [f"{fill}.fields.rho=1000", f"{fill}.fields.p={p}", f"{fill}.mass=2",
                      f"compare.0.rho_{side}=1000", f"compare.0.p_{side}={p}"]
        run = self.run(scene, *water)
        for field, high in (("rho", 0.002), ("p", 0.012), ("v", 0.016)):
            self.bar(f"water, 500 particles: l1_rel of {field}", run.error(field), high=high)
        first = None
        for way, path in builds.items():
            other = self.run(scene, *coarse, "time.end=0.02", path=path)
            found = [one["file"] for one in other.summary["plugins"] if one["name"] == "stiffened-gas"]
            if [os.path.dirname(os.path.realpath(one)) for one in found] != [os.path.realpath(path)]:
                sys.exit(f"MISS stiffened-gas of {path} was not the one loaded, but {found}")
            first = first or other
            off = max(abs(other.error(field) / first.error(field) - 1) for field in ("rho", "p", "v", "u"))
            self.bar(f"norms of the build by {way} beside those of the first", off, high=1e-12)
        wrong = self.sph("run", self.scene(scene), "--dry-run", "--set", "materials.liquid.eos.p_inf=-1")
        self.bar("exit status of a negative p_inf", wrong.returncode, low=2, high=2)

    # -- stiffened-riemann: against the ideal gas's solver, which is not of its making

    def solver(self):
        """At one moment of many problems, without a step: the distance from gas at rest is the same for both."""
        problems = (  # rho, v, p of the left and the right, gamma, time
            (1, 0, 1, 0.125, 0, 0.1, 1.4, 0.2),  # Sod
            (1, -2, 0.4, 1, 2, 0.4, 1.4, 0.15),  # two rarefactions, almost a vacuum
            (1, 0, 1000, 1, 0, 0.01, 1.4, 0.012),  # strong shock to the right
            (1, 0, 0.01, 1, 0, 100, 1.4, 0.035),  # to the left
            (5.99924, 19.5975, 460.894, 5.99242, -6.19633, 46.095, 1.4, 0.035),  # two shocks
            (1, 3, 2, 2, 3, 2, 1.1, 0.05),  # a contact alone
        )
        worst = {0: 0.0, 7.5: 0.0}
        still = ["time.steps=0", "scheme.h_tolerance=1e-15", "compare.0.x0=0.45", 'particles.fluid.fill=[{"lattice": "square", "spacing": 0.005}]']
        for problem in problems:
            keys = ("rho_l", "{}_l", "p_l", "rho_r", "{}_r", "p_r", "gamma")
            *values, time = problem

            def norms(exact, velocity, shift):
                given = [f"compare.0.{key.format(velocity)}={value - (shift if key[0] == 'p' else 0)}"
                         for key, value in zip(keys, values)]
                # The gas, at rest, whose pressure is shifted alike.
                gas = [f"time.begin={time}", f"time.end={time * 2}"]
                gas += ['particles.fluid.fields={"rho": 1, "p": %.17g, "v": [0]}' % (1 - shift)]
                if shift:
                    gas += ['materials.gas.eos={"name": "stiffened-gas", "gamma": 1.4, "p_inf": %g}' % shift]
                    given += [f"compare.0.p_inf={shift}"]
                run = self.run("sod.json", 'compare=[{"array": "fluid", "exact": "%s"}]' % exact, *still, *given, *gas)
                return [run.error(field, "l1") for field in ("rho", "v", "p")]

            ideal = norms("riemann", "u", 0)
            for shift in worst:
                for one, other in zip(norms("stiffened-riemann", "v", shift), ideal):
                    worst[shift] = max(worst[shift], abs(one - other) / max(other, 1e-12))
        self.bar("norms of six problems beside those of the solver of ideal gases", worst[0], high=1e-9)
        self.bar("the same with p_inf = 7.5 and every pressure less by as much", worst[7.5], high=1e-9)
        words = ["--dry-run", "--set", 'compare=[{"array": "fluid", "exact": "stiffened-riemann"}]',
                 *(word for key, value in zip(("rho_l", "p_l", "rho_r", "p_r", "v_r"), (1, 1, 1, 1, 100))
                   for word in ("--set", f"compare.0.{key}={value}"))]
        wrong = self.sph("run", self.scene("sod.json"), *words)
        self.bar("exit status of two states that part", wrong.returncode, low=2, high=2)

    # -- piston: Rankine and Hugoniot; a simple wave where it speeds up slowly

    def piston(self):
        gamma, rho0, p0, speed, dx = 1.4, 1.0, 1.0, 1.0, 0.005
        c2, k = gamma * p0 / rho0, (gamma + 1) / 4 * speed
        shock = k + math.sqrt(k * k + c2)
        rho1, p1 = rho0 * shock / (shock - speed), p0 + rho0 * shock * speed
        run = self.run("piston/scene.json", "output.every=0.1")
        for field, high in (("rho", 0.006), ("p", 0.007), ("v", 0.008)):
            self.bar(f"piston, 200 particles: l1_rel of {field}", run.error(field), high=high)
        last = run.snapshots()[-1]
        x, t = last["x"], last.time
        crossing = numpy.flatnonzero(last["rho"] > (rho0 + rho1) / 2)[-1]
        above, below = last["rho"][crossing], last["rho"][crossing + 1]
        place = x[crossing] + (x[crossing + 1] - x[crossing]) * (above - (rho0 + rho1) / 2) / (above - below)
        self.same("speed of the shock", place / t, shock, dx / (shock * t))
        behind = (x > speed * t + 10 * dx) & (x < shock * t - 6 * dx)
        self.same("density behind it, mean", last["rho"][behind].mean(), rho1, 2e-3)
        self.same("pressure behind it, mean", last["p"][behind].mean(), p1, 2e-3)
        self.same("pressure at the piston", last["p"][:5].mean(), p1, 0.01)
        gained = (last["m"] * (last["u"] + last["v"] ** 2 / 2)).sum() - p0 / (gamma - 1)
        self.same("energy that the gas has taken up: the piston's work", gained, p1 * speed * t, 0.01)
        walls = run.snapshots("piston")
        off = max(abs(wall["x"] - walls[0]["x"] - speed * wall.time).max() for wall in walls)
        self.bar("piston's place beside speed * t", off, high=1e-15)

        wide = self.run("piston/scene.json", "time.end=0.03", "boundaries.0.step=1").log()["dt"].max()
        narrow = self.run("piston/scene.json", "time.end=0.03", "boundaries.0.step=0.01").log()["dt"].max()
        self.bar("time step that step = 0.01 allows, over 0.01 h / speed", narrow * speed / (0.01 * 1.5 * dx), high=1)
        self.bar("it is the piston's bound: without it the step is longer by", wide / narrow, low=3)

        # Along a table of speeds, slowly: no shock yet, but a simple wave. Where the piston was at time s with
        # speed 2 s, gas of that speed begins to run along x = s^2 + (c + 2 s) (t - s), c = c0 + (gamma - 1) s.
        run = self.run("piston/scene.json", "boundaries.0.speed=9", "time.end=0.2", "compare=[]",
                       'boundaries.0.path={"t": [0, 0.1, 1], "v": [0, 0.2, 2]}', "particles.piston.fill.spacing=0.0036")
        last, wall = run.snapshots()[-1], run.snapshots("piston")
        s = numpy.linspace(0.2, 0, 2001)
        c = math.sqrt(c2) + (gamma - 1) * s
        v = numpy.interp(last["x"], s**2 + (c + 2 * s) * (0.2 - s), 2 * s)
        p = p0 * (1 + (gamma - 1) / 2 * v / math.sqrt(c2)) ** (2 * gamma / (gamma - 1))
        self.bar("a piston that speeds up: l1_rel of v", abs(last["v"] - v).sum() / v.sum(), high=0.01)
        self.bar("and of p - p0", abs(last["p"] - p).sum() / (p - p0).sum(), high=0.02)
        self.same("pressure at its face", last["p"][:5].mean(), p[:5].mean(), 0.02)
        self.bar("its place beside t^2", abs(wall[-1]["x"] - wall[0]["x"] - 0.04).max(), high=1e-15)
        self.bar("its speed beside 2 t", abs(wall[-1]["v"] - 0.4).max(), high=1e-15)
        # In a plane, and with the other integrator: it goes along x alone, just as far.
        box = '{"min": [-0.2, 0], "max": [0.4, 0.2], "sides": {"x": ["open", "mirror"], "y": "periodic"}}'
        fills = ["particles.fluid.fill.in.box={'min': [0, 0], 'max': [0.4, 0.2]}",
                 "particles.piston.fill.in.box={'min': [-0.1, 0], 'max': [0, 0.2]}"]
        run = self.run("piston/scene.json", "dimensions=2", f"domain={box}", *(one.replace("'", '"') for one in fills),
                       "particles.fluid.fill.spacing=0.02", "particles.piston.fill.spacing=0.02", "compare=[]",
                       "particles.fluid.fields.v=[0, 0]", "time.integrator=pec", "time.end=0.05")
        first, last = (run.snapshots("piston")[k] for k in (0, -1))
        order, others = first["id"].argsort(), last["id"].argsort()
        self.bar("in 2D: its place along x", abs(last["x"][others] - first["x"][order] - 0.05).max(), high=1e-15)
        self.bar("and along y", abs(last["y"][others] - first["y"][order]).max(), high=0)
        for path in ('{"t": [0, 1]}', '{"t": [0, 0], "v": [1, 1]}'):
            wrong = self.sph("run", self.scene("piston/scene.json"), "--dry-run", "--set", f"boundaries.0.path={path}")
            self.bar(f"exit status of path {path}", wrong.returncode, low=2, high=2)
        self.run("piston/scene.json", options=("--audit", "--steps", "10"))

    # -- poly6 and gauss: moments in closed form, Sod's tube

    def kernels(self):
        erf, exp = math.erf(3), math.exp(-9)
        # The integral of exp(-q^2) q^(d + 1) over that of exp(-q^2) q^(d - 1), from 0 to 3.
        root = math.sqrt(math.pi)
        gauss = {1: (root / 4 * erf - 1.5 * exp) / (root / 2 * erf), 2: (1 - 10 * exp) / (1 - exp),
                 3: (3 * root / 8 * erf - 15.75 * exp) / (root / 4 * erf - 1.5 * exp)}
        # What is missing of the integral of -q W' / d, by parts: W at the end, on the sphere around.
        ends = {1: 3 * exp / (root / 2 * erf), 2: 9 * exp / (1 - exp),
                3: 9 * exp / (root / 4 * erf - 1.5 * exp)}
        spacing = {1: (0.005, 50), 2: (0.05, 6), 3: (0.1, 3)}
        bars = {1: 1e-6, 2: 3e-4, 3: 1e-3}
        for kernel in ("poly6", "gauss"):
            for d in (1, 2, 3):
                second = gauss[d] if kernel == "gauss" else 4 * d / (d + 8)
                slope = 1 - ends[d] if kernel == "gauss" else 1
                dx, h = spacing[d]
                sides = ", ".join(f'"{axis}": "periodic"' for axis in "xyz"[:d])
                box = f'{{"min": {[-1] * d}, "max": {[1] * d}, "sides": {{{sides}}}}}'
                run = self.run("poly6/scene.json", f"kernel={kernel}", f"dimensions={d}", f"domain={box}",
                               f"particles.lattice.fill.spacing={dx}", f"particles.lattice.h_over_dx={h}")
                what = f"{kernel} in {d}D: "
                self.same(what + "integral", run.probe("integral_0"), 1, 1e-11)
                self.same(what + "second moment", run.probe("integral_2"), second, 1e-11)
                self.same(what + "sum over a lattice", run.probe("lattice_0"), 1, bars[d])
                self.same(what + "second moment there", run.probe("lattice_2"), second, bars[d])
                self.same(what + "slope there", run.probe("lattice_slope"), slope, bars[d])
        run = self.run("sod.json", "kernel=gauss")
        for field, high in (("rho", 0.012), ("p", 0.012), ("v", 0.028)):
            self.bar(f"Sod with gauss, 450 particles: l1_rel of {field}", run.error(field), high=high)
        run = self.run("sod.json", "kernel=poly6", "scheme.eta=1")
        for field, high in (("rho", 0.02), ("p", 0.025), ("v", 0.07)):
            self.bar(f"Sod with poly6, eta 1: l1_rel of {field}", run.error(field), high=high)
        pairs = self.run("sod.json", "kernel=poly6", "scheme.eta=1.5").error("rho") / run.error("rho")
        self.bar("eta 1.5, where its particles pair: error of rho over that at eta 1", pairs, low=2)

    # -- reordered: its order, and Sod's tube

    def order(self):
        done = self.sph("plan", "--json", self.scene("sod.json"), "--set", "scheme.name=reordered")
        order = [one["name"].split("(")[0] for one in json.loads(done.stdout)["passes"]]
        good = order == ["gsph-gradients", "gsph-density", "eos", "gsph-rates"]
        print(f"{'ok  ' if good else 'MISS'} order of the plan: {', '.join(order)}")
        self.missed += not good
        run, plain = self.run("sod.json", "scheme.name=reordered"), self.run("sod.json")
        for field, high in (("rho", 0.012), ("p", 0.012), ("v", 0.028)):
            self.bar(f"Sod reordered, 450 particles: l1_rel of {field}", run.error(field), high=high)
            other = abs(run.error(field) / plain.error(field) - 1)
            self.bar(f"its difference from gsph's, of {field}", other, low=1e-6, high=0.05)

    # -- fountain: what is counted

    def fountain(self):
        for step in (0.003, 0.0041, 0.15):  # the last one: further in a step than the reservoir is long
            run = self.run("fountain/scene.json", f"time.dt={step}", "output.every=0.2", options=("--threads", "2"))
            off = count = mass = ids = 0
            for snapshot in run.snapshots():
                reach = 1.5 * snapshot.time
                every = -0.1 + 0.01 * (numpy.arange(-200, 10) + 0.5) + reach
                exact = every[(every >= -0.1) & (every < 1)]
                x = snapshot["x"]
                count = max(count, abs(len(x) - len(exact)))
                if len(x) == len(exact):
                    off = max(off, abs(x - exact).max())
                mass = max(mass, abs(snapshot["m"].sum() / (0.02 * len(exact)) - 1))
                made = (every >= -0.1).sum() - len(every) + 200
                ids = max(ids, abs(snapshot["id"].max() + 1 - 10 - made), len(x) - len(set(snapshot["id"])))
            what = f"fountain, steps of {step}: "
            self.bar(what + "particles too many or too few", count, high=0)
            self.bar(what + "their places", off, high=1e-13)
            self.bar(what + "their mass, relative", mass, high=1e-13)
            self.bar(what + "ids: one each, and one for each that was made", ids, high=0)
        self.run("fountain/scene.json", options=("--audit", "--steps", "100"))

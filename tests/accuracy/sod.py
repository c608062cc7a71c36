"""Sod's tube: error norms against the exact solution, convergence, energy, the walls' momentum.

Bars: the battery's set-up on [0, 1] with 450 particles in l1_rel; as PySPH ships it, with 720, in l1
(its GSPH: .0047, .0072, .0026 for density, velocity, pressure)."""
import csv
import os

from runs import Runs

runs = Runs()
s, out = runs.run("sod.json")
for field, high in (("rho", 0.012), ("p", 0.012), ("v", 0.028)):
    runs.bar(f"l1_rel of {field}, 450 particles", s["errors"][f"fluid.{field}"]["l1_rel"], high=high)
runs.bar("energy drift", abs(s["conservation"]["energy_drift"]), high=1e-4)

# Total momentum changes by the walls' push alone: (p_left - p_right) t, as long as no wave has
# reached them.
with open(os.path.join(out, "log.csv")) as file:
    rows = list(csv.DictReader(file))
worst = max(abs(float(r["momentum_x"]) - 0.9 * float(r["time"])) for r in rows)
runs.bar("momentum beside the walls' push of 0.9 t (0.18 at the end)", worst, high=1e-3)

s, _ = runs.run("sod-pysph.json")
for field, high in (("rho", 0.0047), ("v", 0.0072), ("p", 0.0026)):
    runs.bar(f"l1 of {field}, 720 particles", s["errors"][f"fluid.{field}"]["l1"], high=high)
s, _ = runs.run("sod-pysph.json", "--set", "scheme.riemann=exact")
runs.bar("l1 of rho, 720 particles, exact Riemann solver", s["errors"]["fluid.rho"]["l1"], high=0.0047)

error = {}
for factor in (1, 2, 4):
    mass = 0.00125 / factor
    s, _ = runs.run(
        "sod.json", "--set", f"particles.fluid.fill.0.mass={mass}", "--set", f"particles.fluid.fill.1.mass={mass}"
    )
    error[factor] = s["errors"]["fluid.rho"]["l1"]
    print(f"     {s['particles']['fluid']} particles: l1 of rho {error[factor]:.6g}")
runs.bar("error of 450 over that of 900 particles", error[1] / error[2], low=1.6)
runs.bar("error of 900 over that of 1800 particles", error[2] / error[4], low=1.6)
runs.end()

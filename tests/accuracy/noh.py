"""Noh's implosion in two dimensions, 100 x 100, with both Riemann solvers, and in one against a wall.

Bars: mean density for .05 < r < .15 beside PySPH's best (15.35) and the exact 16; the radius at which the
mean of shells one spacing wide crosses 10 beside .2; plain mean of the density's error in one dimension, as
Spheral's tests take it (its GSPH .048, SPH .054)."""
import glob

import h5py
import numpy

from runs import Runs

runs = Runs()
for solver in ("hllc", "exact"):
    s, _ = runs.run("noh.json", "--set", f"scheme.riemann={solver}")
    runs.bar(f"{solver}: plateau density", s["probes"]["plateau density"]["value"], low=15.35)
    runs.bar(f"{solver}: shock radius", s["probes"]["shock radius"]["value"], low=0.192, high=0.208)
    runs.bar(f"{solver}: density at the centre", s["probes"]["density at the centre"]["value"])
    runs.bar(f"{solver}: l1 of rho, r < .45", s["errors"]["fluid.rho"]["l1"])
    runs.bar(f"{solver}: energy drift", abs(s["conservation"]["energy_drift"]), high=1e-3)

s, out = runs.run("noh-1d.json")
with h5py.File(sorted(glob.glob(f"{out}/snapshot_*.vtkhdf"))[-1]) as file:
    data = file["VTKHDF"]
    x = data["Points"][:, 0]
    rho = data["PointData/rho"][:]
exact = numpy.where(x < 0.2, 4.0, 1.0)
runs.bar("1D: plain mean of the density's error", float(numpy.mean(numpy.abs(rho - exact))), high=0.055)
runs.bar("1D: energy drift", abs(s["conservation"]["energy_drift"]), high=1e-3)
runs.end()

#!/usr/bin/env python3
"""Sod's shock tube with this scheme, against the exact solution: between contact and shock the
density is .2655737, and the pressure is .3031302 from the rarefaction to the shock (E. F. Toro,
Riemann Solvers, chapter 4). Each pair gives one particle what it takes from the other: energy
is kept to the error of the time steps."""
from runs import check, run

summary = run("scene.json")
value = {name: probe["value"] for name, probe in summary["probes"].items()}
check("density", value["density"], 0.2655737, 0.01)
check("pressure", value["pressure"], 0.3031302, 0.01)
check("mean error of rho", summary["errors"]["fluid.rho"]["l1_rel"], 0, 0.02)
check("drift of the energy", summary["conservation"]["energy_drift"], 0, 2e-3)

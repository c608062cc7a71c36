#!/usr/bin/env python3
"""Sod's shock tube with this kernel, against the exact solution: between rarefaction and contact
the density is .4263194, and the pressure is .3031302 up to the shock (E. F. Toro, Riemann
Solvers, chapter 4). That the kernel integrates to 1 is checked when it is loaded."""
from runs import check, run

summary = run("scene.json")
value = {name: probe["value"] for name, probe in summary["probes"].items()}
check("density", value["density"], 0.4263194, 0.01)
check("pressure", value["pressure"], 0.3031302, 0.01)
check("mean error of rho", summary["errors"]["fluid.rho"]["l1_rel"], 0, 0.02)

#!/usr/bin/env python3
"""Two bodies that touch, against the exact solution: the error, its order, and the heat that is kept."""
from math import log2

from runs import check, run


def error(scene, field, spacing):
    summary = run(scene, "--set", f"particles.{field.split('.')[0]}.fill.spacing={spacing}")
    check("heat that was lost, of all", summary["conservation"]["energy_drift"], 0, 1e-12)
    return summary["errors"][field]["l1_rel"]


coarse, fine = error("scene.json", "bar.T", 0.01), error("scene.json", "bar.T", 0.005)
check("error, one material", fine, 0, 7e-5)
check("order, one material", log2(coarse / fine), 2, 0.05)
check("error, two materials", error("contact.json", "bodies.T", 0.01), 0, 4e-4)

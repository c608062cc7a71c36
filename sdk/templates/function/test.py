#!/usr/bin/env python3
"""A wave 1 + cos(2 pi x) that spreads with D and decays with tau is, after a time t, exp(-t / tau)
(1 + exp(-D (2 pi)^2 t) cos(2 pi x)). Its mean falls by the decay alone: spreading moves the
substance and makes none."""
from math import exp, pi

from runs import check, run

D, TAU = 0.01, 2
summary = run("scene.json")
value = {name: probe["value"] for name, probe in summary["probes"].items()}
t = summary["time"]
check("mean", value["mean"], exp(-t / TAU), 1e-5)
check("wave", value["max"] - value["min"], 2 * exp(-t / TAU - D * (2 * pi) ** 2 * t), 2e-3)

#!/usr/bin/env python3
"""Particles carry what they hold: a cloud in a uniform stream arrives as it was, to rounding. An
exact solution that runs with another speed, or spreads, is another one: its difference from the
particles' is known too."""
from math import exp

from runs import check, run

WIDTH, TIME = 0.03, 0.5


def error(norm, *options):
    return run("scene.json", *options)["errors"]["fluid.c"][norm]


check("largest error", error("linf"), 0, 1e-12)
# The peak lies .0125 from the nearest particles along each axis.
s2 = WIDTH**2 + 2 * 0.001 * TIME
r2 = 2 * 0.0125**2
lower = exp(-r2 / 2 / WIDTH**2) - WIDTH**2 / s2 * exp(-r2 / 2 / s2)
wide = error("linf", "--set", "compare.0.diffusivity=0.001")
check("difference of the peak", wide, lower, 1e-6)

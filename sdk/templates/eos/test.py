#!/usr/bin/env python3
"""Cold gas that runs against a wall with speed 1 is brought to rest by a shock. Conservation of
mass, momentum and energy (Rankine and Hugoniot) and the equation of state give, for the volume
1 / rho = v,

    v - b = (v0 - b) (gamma - 1) / (gamma + 1),  p = 1 / (v0 - v),  speed of shock v / (v0 - v)."""
from runs import check, run

GAMMA, B, V0 = 1.4, 0.25, 1.0
summary = run("scene.json")
value = {name: probe["value"] for name, probe in summary["probes"].items()}
v = B + (V0 - B) * (GAMMA - 1) / (GAMMA + 1)
check("density", value["density"], 1 / v, 0.01)
check("pressure", value["pressure"], 1 / (V0 - v), 0.01)
check("place of the shock", value["shock"], v / (V0 - v) * summary["time"], 0.02)

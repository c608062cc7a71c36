#!/usr/bin/env python3
"""The scene runs natively: ten steps. (That loops of the processor and the text for devices give the same
numbers is checked by sph-plugin-check, where there is a device.) Compare with what is known here, for a probe
called "wave": check("wave", run("scene.json")["probes"]["wave"]["value"], 0.5, 1e-3)."""
from runs import run

summary = run("scene.json", "--steps", "10")
print(f"t = {summary['time']:.9g} after ten steps")

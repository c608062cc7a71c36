#!/usr/bin/env python3
"""A fluid that moves as a whole within the layer slows down as exp(-t / tau). And of a pulse of
sound that runs into the layer less than a sixth comes back: without the layer all of it does."""
from math import exp

from runs import check, run


def fastest(*options):
    return run("scene.json", *options)["probes"]["fastest"]["value"]


stream = ["domain.sides.x=periodic", "particles.fluid.fields.v=[1]", "time.end=0.1",
          "boundaries.0.from=-2", "boundaries.0.to=-1"]
check("stream", fastest(*(word for item in stream for word in ("--set", item))), exp(-1), 1e-9)
# Half of the pulse runs each way; the scheme itself takes some of it on the way.
pulse = fastest("--set", "boundaries=[]")
check("pulse without the layer", pulse, 0.0005, 0.2)
check("pulse with the layer", fastest(), 0, pulse / 6)

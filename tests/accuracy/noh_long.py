"""Noh's implosion at length: 200 x 200 and a hexagonal lattice in two dimensions, 50^3 in three."""
from runs import Runs

runs = Runs()
s, _ = runs.run(
    "noh.json", "--set", "particles.fluid.fill.spacing=0.01", "--set", "probes.1.crossing.shell=0.01"
)
runs.bar("200 x 200: plateau density", s["probes"]["plateau density"]["value"], low=15.6)
runs.bar("200 x 200: shock radius", s["probes"]["shock radius"]["value"], low=0.195, high=0.205)
runs.bar("200 x 200: l1 of rho, r < .45", s["errors"]["fluid.rho"]["l1"])
runs.bar("200 x 200: energy drift", abs(s["conservation"]["energy_drift"]), high=1e-3)
# The defaults were chosen on the square lattice; this one had no say.
s, _ = runs.run("noh.json", "--set", "particles.fluid.fill.lattice=hexagonal")
runs.bar("hexagonal lattice, 10 000: plateau density", s["probes"]["plateau density"]["value"], low=15.35)
runs.bar("hexagonal lattice, 10 000: shock radius", s["probes"]["shock radius"]["value"], low=0.192, high=0.208)
s, _ = runs.run("noh-3d.json")
for name, probe in s["probes"].items():
    runs.bar(f"50^3: {name}", probe["value"])
runs.bar("50^3: energy drift", abs(s["conservation"]["energy_drift"]), high=1e-3)
runs.end()

"""Scenes that several tests of whole runs share: boxes with any sides."""


def box(dim, side, scheme, sides, jitter=0.2, **scheme_more):
    """A box of barotropic gas or of water with a flow in it; sides: one word for all, or by axis."""
    if isinstance(sides, str):
        sides = {axis: sides for axis in "xyz"[:dim]}
    waves = {
        1: ["0.1 * sin(2*pi*x)"],
        2: ["0.1 * sin(2*pi*x)*cos(2*pi*y)", "-0.1 * cos(2*pi*x)*sin(2*pi*y)"],
        3: ["0.1 * sin(2*pi*x)*cos(2*pi*y)", "-0.1 * cos(2*pi*x)*sin(2*pi*y)", "0.05 * sin(2*pi*z)"],
    }
    return {
        "title": f"{scheme}, {dim}D, {sides}",
        "dimensions": dim,
        "plugins": ["kernels", "eos", scheme.split("-")[0], "forces", "diagnostics"],
        "domain": {"min": [0] * dim, "max": [1] * dim, "sides": sides},
        "materials": {"m": {"eos": {"name": "linear", "c0": 1, "rho0": 1, "p0": 1}}},
        "particles": {
            "fluid": {
                "material": "m",
                "fill": {"lattice": "square", "spacing": 1 / side, "jitter": jitter},
                "fields": {"rho": 1, "v": waves[dim]},
                "h_over_dx": 1.3,
            }
        },
        "scheme": {"name": scheme, **scheme_more},
        "time": {"end": 1},
        "output": {"picture": False},
    }

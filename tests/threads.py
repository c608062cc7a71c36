"""Any number of threads gives the same bits in every column of the last snapshot."""
from scenes import Scenes

scenes = Scenes()


def columns(result):
    """Every column's bytes, as they stand in the file."""
    import h5py

    with h5py.File(result.snapshots()[-1]) as file:
        root = file["VTKHDF"]
        found = {name: data[:].tobytes() for name, data in root["PointData"].items()}
        found["Points"] = root["Points"][:].tobytes()
        return found


for name, options in (
    ("noh.json", ("--set", "particles.fluid.fill.spacing=0.04", "--steps", "40")),
    ("sod.json", ("--steps", "300")),
    (
        "noh.json",
        (
            *("--set", "particles.fluid.fill.spacing=0.05", "--steps", "25", "--set", "time.integrator=pec"),
            *("--set", 'domain.sides={"x": "periodic", "y": "mirror"}', "--set", "scheme.riemann=exact"),
        ),
    ),
):
    one = columns(scenes.good(name, "--threads", "1", *options))
    scenes.expect(f"{name}: columns", {"rho", "u", "v", "h", "Points", "id"} <= one.keys(), sorted(one))
    for threads in ("2", "3", "5"):
        many = columns(scenes.good(name, "--threads", threads, *options))
        scenes.expect(f"{name}, {threads} threads: columns", many.keys() == one.keys())
        differing = [column for column in one if many.get(column) != one[column]]
        scenes.expect(f"{name}, {threads} threads: other bits", not differing, differing)
scenes.end()

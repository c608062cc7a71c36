"""A snapshot of several ranks is one file, a partition of each: VTK's reader and h5py see the same particles, which are
those of a run on one rank; ranks without particles have an empty one. Pictures and other scenes are made from it as from
any. A rank, or the first alone, that meets a full disk ends the run with one sentence and no half file."""
import glob
import os
import sys

import h5py
import numpy

from launch import BOUND, ENVIRONMENT, MPIRUN, SPH, Job, Scenes, Snapshot, changed, example, need, wrapper

need()
os.environ.update(ENVIRONMENT)
try:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkFileOutputWindow, vtkLogger, vtkOutputWindow
    from vtkmodules.vtkIOHDF import vtkHDFReader
except ImportError as missing:
    print(f"{missing}: VTK is not tried (package python3-vtk9)")
    vtkHDFReader = None

scenes = Scenes("--strict")
expect = scenes.expect
SCRATCH = scenes.scratch.name


def on(ranks, scene, *options):
    result = scenes.run(scene, *options, before=(*MPIRUN, "-n", str(ranks)) if ranks > 1 else ())
    if result.code != 0:
        print(f"MISS {scene['title']} on {ranks} ranks: {result.stderr}")
        sys.exit(1)
    return result


def check_parts(what, grid, ranks):
    """What VTK reads of it: numbers of each partition count from 0."""
    points = grid["NumberOfPoints"][:]
    total = len(grid["Points"])
    expect(f"{what}: a partition a rank", len(points) == ranks and points.sum() == total and (points >= 0).all(), points)
    for name in ("NumberOfCells", "NumberOfConnectivityIds"):
        expect(f"{what}: {name}", (grid[name][:] == points).all(), grid[name][:])
    count = [numpy.arange(n) for n in points]
    expect(f"{what}: Connectivity", (grid["Connectivity"][:] == numpy.concatenate(count)).all())
    ends = numpy.concatenate([numpy.arange(n + 1) for n in points])
    expect(f"{what}: Offsets", grid["Offsets"].shape == ends.shape and (grid["Offsets"][:] == ends).all())
    expect(f"{what}: Types", grid["Types"].shape == (total,) and (grid["Types"][:] == 1).all())
    sizes = numpy.bincount(grid["PointData/array"][:], minlength=len(grid["FieldData/array_names"]))
    expect(f"{what}: array_sizes", (grid["FieldData/array_sizes"][:] == sizes).all(), grid["FieldData/array_sizes"][:])
    return points


def check_vtk(what, path, grid):
    if not vtkHDFReader:
        return
    log = os.path.join(SCRATCH, "vtk.log")
    window = vtkFileOutputWindow()
    window.SetFileName(log)
    window.FlushOn()
    vtkOutputWindow.SetInstance(window)
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    reader = vtkHDFReader()
    reader.SetFileName(path)
    reader.Update()
    vtkOutputWindow.SetInstance(None)
    said = open(log).read() if os.path.exists(log) else ""
    seen = reader.GetOutput()
    expect(f"{what}: VTK is content", not said, said)
    n = len(grid["Points"])
    if not seen.GetPoints() or seen.GetNumberOfPoints() != n or seen.GetNumberOfCells() != n:
        expect(f"{what}: VTK sees all", False, (seen.GetNumberOfPoints(), seen.GetNumberOfCells(), n))
        return
    expect(f"{what}: VTK's points", (vtk_to_numpy(seen.GetPoints().GetData()) == grid["Points"][:]).all())
    cells = [(seen.GetCellType(k), seen.GetCell(k).GetPointId(0)) for k in range(n)]
    expect(f"{what}: VTK's cells", cells == [(1, k) for k in range(n)])
    for name, column in grid["PointData"].items():
        array = seen.GetPointData().GetArray(name)
        expect(f"{what}: VTK's {name}", array and numpy.array_equal(
            vtk_to_numpy(array).reshape(column.shape), column[:], equal_nan=column.dtype.kind == "f"))
    expect(f"{what}: VTK's time", seen.GetFieldData().GetArray("Time").GetValue(0) == grid["FieldData/Time"][0])


def differs(a, b):
    one, two = Snapshot(a), Snapshot(b)
    bad = [name for name in one.column if one[name].tobytes() != two.column[name].tobytes()]
    return bad + [name for name in ("time", "step", "names") if getattr(one, name) != getattr(two, name)]


def attributes(path):
    """All that a file says of itself."""
    found = {}

    def note(name, thing):
        found.update({(name, key): str(value) for key, value in thing.attrs.items()})
        if "FieldData/" in name:
            found[name] = thing[()].tobytes()

    with h5py.File(path) as file:
        note("", file)
        file.visititems(note)
    return found


def same(what, scene, ranks, *options):
    """As one rank writes it, but for the order."""
    one, many = on(1, scene, *options), on(ranks, scene, *options)
    names = [os.path.basename(path) for path in one.snapshots()]
    expect(f"{what}: files", names == [os.path.basename(path) for path in many.snapshots()], os.listdir(many.out))
    expect(f"{what}: nothing aside", not glob.glob(many.path(".sph-aside*")), os.listdir(many.out))
    for name in names:
        expect(f"{what}: {name}", not differs(one.path(name), many.path(name)), differs(one.path(name), many.path(name)))
        expect(f"{what}: what {name} says", attributes(one.path(name)) == attributes(many.path(name)))
        with h5py.File(many.path(name)) as file:
            points = check_parts(f"{what}: {name}", file["VTKHDF"], ranks)
            check_vtk(f"{what}: {name}", many.path(name), file["VTKHDF"])
    print(f"{what} on {ranks} ranks: {len(names)} snapshots, particles of the last: {points}")
    return one, many, points


# -- The same particles ---------------------------------------------------------------------------

output = {"every": 0.1, "log": {"steps": 20}, "picture": False}
noh = changed(example("noh.json"), output=output, time={"end": 0.2})
for key in ("compare", "probes", "profiles"):
    noh.pop(key, None)
noh["particles"]["fluid"]["fill"]["spacing"] = 0.1
_, spread, _ = same("Noh's implosion", noh, 4)

# Slabs larger than are written at once, of two arrays that differ in their columns, and 7 ranks.
walls = changed(example("sod.json"), output={**output, "every": 1}, time={"end": 1})
for key in ("compare", "probes", "profiles"):
    walls.pop(key, None)
walls["particles"]["dust"] = {"material": "gas", "fill": {"lattice": "square", "spacing": 0.02},
                              "fields": {"rho": 1, "p": 1, "v": [0]}}
same("two arrays", walls, 7, "--steps", "2")

many = changed(noh, output={**output, "every": 1})
many["particles"]["fluid"]["fill"]["spacing"] = 0.005
_, _, points = same("many particles", many, 2, "--steps", "0")
expect("more than a slab each", (points > 1 << 15).all(), points)

few = changed(example("orbit.json"), output={**output, "every": 100}, time={**example("orbit.json")["time"], "end": 100})
few.pop("probes", None)
_, _, points = same("a particle", few, 5, "--steps", "3")
expect("ranks without particles", (points == 0).sum() == 4, points)

# -- Read again -----------------------------------------------------------------------------------

picture = os.path.join(SCRATCH, "noh.png")
done = scenes.command("render", spread.snapshots()[-1], "--field", "rho", "--out", picture)
expect("a picture", done.returncode == 0 and os.path.getsize(picture) > 1000, done.stderr)
again = changed(noh, time={"end": 0.01}, output={**output, "every": 1})
again["particles"]["fluid"].pop("fields")
again["particles"]["fluid"]["fill"] = {"file": spread.snapshots()[-1]}
one, three = on(1, again, "--steps", "3"), on(3, again, "--steps", "3")
was, now = ({name: s[name][numpy.lexsort(s["x"].T)] for name in ("x", "v", "m")}
            for s in (Snapshot(spread.snapshots()[-1]), Snapshot(one.snapshots()[0])))
expect("a scene from it", all((was[name] == now[name]).all() for name in was),
       {name: abs(was[name] - now[name]).max() for name in was})
expect("on ranks as well", not differs(one.snapshots()[-1], three.snapshots()[-1]))

# -- A full disk ----------------------------------------------------------------------------------

size = os.path.getsize(spread.snapshots()[0])
kept = changed(noh, output={**output, "checkpoint": {"steps": 5}})
path = scenes.write(kept, "kept.json")
whole = on(3, kept, "--steps", "12")
checkpoint = os.path.getsize(whole.path("checkpoint_00000010.h5"))

limit = wrapper(SCRATCH, "limit.sh", 'test "$WHO" -ge 0 && test "$WHO" != $rank || ulimit -f $BLOCKS')
for what, blocks, who, file in (("a snapshot", size // 1024, -1, "snapshot_0000.vtkhdf"),
                                ("a checkpoint, first rank", size // 512 + 16, -1, "checkpoint_00000005.h5"),
                                ("a checkpoint, last rank", checkpoint // 512 - 16, -1, "checkpoint_00000005.h5"),
                                ("a rank's part of a snapshot", size // 1024, 1, "snapshot_0000.vtkhdf")):
    out = os.path.join(SCRATCH, f"full{blocks}_{who}")
    job = Job(3, limit, SPH, path, "--out", out, "--strict", "--threads", "1", "--quiet", "--steps", "12",
              env={"WHO": str(who), "BLOCKS": str(blocks)}).end(BOUND)
    print(f"no room for {what}: {job.said}")
    expect(f"no room for {what}", job.returncode == 1 and len(job.said) == 1 and "cannot write" in job.said[0]
           and file in job.said[0] and (who < 0 or f"rank {who}:" in job.said[0]), (job.returncode, job.stderr))
    left = os.listdir(out)
    expect(f"no room for {what}: no half file", not any(name.startswith(".sph-aside") for name in left), left)
    for name in left:
        if name.endswith((".vtkhdf", ".h5")):
            with h5py.File(os.path.join(out, name)) as file:
                expect(f"no room for {what}: {name}", len(file) > 0)
scenes.end()

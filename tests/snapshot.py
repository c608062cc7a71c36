"""Snapshots open in h5py and in VTK's own HDF reader, and both see the same numbers.

Runs $MAKE_SNAPSHOT (tests/unit/make_snapshot), whose contents are known in closed form.
"""

import os
import subprocess
import sys
import tempfile

try:
    import h5py
    import numpy as np
    from vtkmodules.vtkIOHDF import vtkHDFReader
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkFileOutputWindow, vtkLogger, vtkOutputWindow
except ImportError as missing:
    print(f"{missing}: not tried (packages python3-h5py, python3-vtk9)")
    sys.exit(77)

TITLE = "Größe"


def expected(dim, n):
    """The arrays of make_snapshot.c, joined: fluid, then wall."""
    total = n**dim
    i = np.arange(total)
    x = np.zeros((total + n, 3))
    for k in range(dim):
        x[:total, k] = (i // n**k % n + 0.5) / n
    v = np.full((total + n, 3), np.nan)
    v[:total] = x[:total] * np.arange(1, 4)
    x[total:, 0] = (np.arange(n) + 0.5) / n
    if dim > 1:
        x[total:, 1] = -0.5 / max(n, 1)
    nothing = np.full(n, np.nan)
    none = np.full(n, -1)

    def tensor(start, step, count):
        rows = np.full((total + n, count), np.nan)
        rows[:total] = start * i[:, None] + step * np.arange(count)
        return rows[:, 0] if count == 1 else rows

    return x, {
        "v": v,
        "m": np.r_[np.full(total, 1.0 / max(total, 1)), nothing],
        "rho": np.r_[1 + (x[:total] ** 2).sum(axis=1), np.full(n, 3.0)],
        "stress": tensor(1, 0.125, dim * (dim + 1) // 2),
        "grad": tensor(-1, -0.125, dim * dim),
        "id": np.r_[2**60 + i, none],
        "kind": np.r_[i % 3, none],
        "array": np.r_[np.zeros(total, int), np.ones(n, int)],
    }


def same(name, got, want):
    assert got.shape == want.shape, (name, got.shape, want.shape)
    if want.dtype.kind == "f":
        np.testing.assert_allclose(got, want, rtol=1e-15, atol=0, err_msg=name)
    else:
        np.testing.assert_array_equal(got, want, err_msg=name)


def check_h5py(path, x, columns):
    with h5py.File(path) as f:
        grid = f["VTKHDF"]
        assert grid.attrs["Type"] == b"UnstructuredGrid"
        assert grid.attrs["Version"].dtype == np.int64 and list(grid.attrs["Version"]) == [1, 0]
        same("Points", grid["Points"][()], x)
        assert grid["Points"].dtype == np.float64
        assert set(grid["PointData"]) == set(columns)
        for name, want in columns.items():
            same(name, grid["PointData"][name][()], want)
        n = len(x)
        for name in "NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds":
            assert grid[name][()] == [n]
        same("Connectivity", grid["Connectivity"][()], np.arange(n))
        same("Offsets", grid["Offsets"][()], np.arange(n + 1))
        same("Types", grid["Types"][()], np.ones(n, np.uint8))
        rho = grid["PointData/rho"]
        assert rho.attrs["unit"] == "kg/m^d" and rho.attrs["doc"] == "density"
        assert grid["Points"].attrs["unit"] == "m"
        assert (f.attrs["title"], f.attrs["units"], f.attrs["version"]) == (TITLE, "SI", "0.1")
        assert (f.attrs["time"], f.attrs["step"]) == (0.6, 812)
        assert f.attrs["dimensions"] in (1, 2, 3)
        field = grid["FieldData"]
        assert list(field["array_names"][()]) == [b"fluid", b"wall"]
        assert list(field["array_sizes"][()]) == [np.sum(columns["array"] == k) for k in (0, 1)]
        assert field["scene"][0].decode() == '{"title": "Größe"}\n'


def read_vtk(path, log):
    """What VTK makes of the file; `log` takes its warnings."""
    window = vtkFileOutputWindow()
    window.SetFileName(log)
    window.FlushOn()
    vtkOutputWindow.SetInstance(window)
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    reader = vtkHDFReader()
    assert reader.CanReadFile(path)
    reader.SetFileName(path)
    reader.Update()
    vtkOutputWindow.SetInstance(None)
    complaints = open(log).read() if os.path.exists(log) else ""
    assert not complaints, complaints
    return reader.GetOutput()


def check_vtk(grid, x, columns):
    n = len(x)
    assert grid.GetNumberOfPoints() == n and grid.GetNumberOfCells() == n
    if n:
        same("points", vtk_to_numpy(grid.GetPoints().GetData()), x)
        assert all(grid.GetCellType(i) == 1 for i in range(n))
        data = grid.GetPointData()
        names = {data.GetArrayName(i) for i in range(data.GetNumberOfArrays())}
        assert names == set(columns), names
        for name, want in columns.items():
            same(name, vtk_to_numpy(data.GetArray(name)), want)
    field = grid.GetFieldData()

    def texts(name):
        array = field.GetAbstractArray(name)
        return [array.GetValue(i) for i in range(array.GetNumberOfValues())]

    for name in "TimeValue", "Time":
        assert field.GetArray(name).GetValue(0) == 0.6
    assert field.GetArray("Step").GetValue(0) == 812
    assert texts("array_names") == ["fluid", "wall"]
    assert texts("title") == [TITLE]
    assert texts("scene") == ['{"title": "Größe"}\n']
    units = dict(zip(texts("column_names"), texts("column_units")))
    assert units["v"] == "m/s" and units["x"] == "m"


def main():
    program = os.environ.get("MAKE_SNAPSHOT") or os.path.join(
        os.environ.get("top_builddir", "."), "tests/unit/make_snapshot"
    )
    with tempfile.TemporaryDirectory() as scratch:
        for dim, n in (1, 7), (2, 10), (3, 5), (2, 300), (2, 0):
            path = os.path.join(scratch, f"snapshot_{dim}_{n}.vtkhdf")
            subprocess.run([program, path, str(dim), str(n)], check=True)
            x, columns = expected(dim, n)
            check_h5py(path, x, columns)
            check_vtk(read_vtk(path, os.path.join(scratch, "vtk.log")), x, columns)
            print(f"{dim}D, {len(x)} particles: h5py and VTK agree, {os.path.getsize(path)} bytes")


if __name__ == "__main__":
    main()

"""What the tests of whole runs share: run a scene, read its folder, count what is missed."""
import copy
import csv
import glob
import json
import os
import subprocess
import sys
import tempfile

import h5py
import numpy

SPH = os.environ["SPH"]
EXAMPLES = os.path.join(os.environ["top_srcdir"], "examples")


def example(name):
    """A scene of examples/ as an object to change."""
    with open(os.path.join(EXAMPLES, name)) as file:
        return json.load(file)


def changed(scene, **top):
    """A copy of a scene with other values for some of its top-level keys."""
    scene = copy.deepcopy(scene)
    scene.update(copy.deepcopy(top))
    return scene


class Snapshot:
    """A snapshot in memory: time, step, arrays' names, columns by name (x: the points), in the order of the
    particles' ids; piece: the rank that wrote a particle."""

    def __init__(self, path):
        with h5py.File(path) as file:
            root = file["VTKHDF"]
            field = root["FieldData"]
            self.time = float(field["Time"][0])
            self.step = int(field["Step"][0])
            self.names = [name.decode() for name in field["array_names"]]
            columns = {name: data[:] for name, data in root["PointData"].items()}
            columns["x"] = root["Points"][:]
            pieces = root["NumberOfPoints"][:]
        order = columns["id"].argsort(kind="stable")
        self.piece = numpy.repeat(numpy.arange(len(pieces)), pieces)[order]
        self.column = {name: data[order] for name, data in columns.items()}

    def __getitem__(self, name):
        return self.column[name]

    def of(self, array, name):
        """One array's part of a column."""
        return self.column[name][self.column["array"] == self.names.index(array)]


class Result:
    """What a run left: exit code, what it said, the folder."""

    def __init__(self, done, out):
        self.code, self.stdout, self.stderr, self.out = done.returncode, done.stdout, done.stderr, out

    def path(self, name):
        return os.path.join(self.out, name)

    def has(self, name):
        return os.path.exists(self.path(name))

    def summary(self):
        with open(self.path("summary.json")) as file:
            return json.load(file)

    def snapshots(self):
        return sorted(glob.glob(self.path("snapshot_*.vtkhdf")))

    def last(self):
        return Snapshot(self.snapshots()[-1])

    def log(self):
        """(names, rows of numbers)"""
        with open(self.path("log.csv"), newline="") as file:
            rows = list(csv.reader(file))
        return rows[0], [[float(cell) for cell in row] for row in rows[1:]]


class Scenes:
    """Runs in a scratch folder; end() exits with 1 if any expectation was missed."""

    def __init__(self, *always):
        self.always = always  # options of every run
        self.scratch = tempfile.TemporaryDirectory()
        self.missed = self.count = 0

    def expect(self, what, good, detail=""):
        if not good:
            self.missed += 1
            print(f"MISS {what}{': ' if detail != '' else ''}{detail}")

    def write(self, scene, name="scene.json"):
        path = os.path.join(self.scratch.name, name)
        with open(path, "w") as file:
            json.dump(scene, file)
        return path

    def command(self, *words, before=(), **options):
        """Runs sph; nothing is expected of it."""
        options = {"capture_output": True, "text": True, "timeout": 120, **options}
        return subprocess.run([*before, SPH, *words], **options)

    def need_device(self):
        """Ends a test that is for a device where there is none, or where sph is built without OpenCL."""
        done = self.command("info", "--devices")
        if done.returncode or "No OpenCL device" in done.stdout:
            print("no OpenCL device here")
            sys.exit(77)

    def run(self, scene, *options, before=(), quiet=True):
        """Runs a scene (an object, or a file of examples/) into a folder of its own."""
        self.count += 1
        out = os.path.join(self.scratch.name, f"out{self.count}")
        path = os.path.join(EXAMPLES, scene) if isinstance(scene, str) else self.write(scene)
        words = [path, "--out", out, "--threads", "1", *self.always, *(["--quiet"] if quiet else []), *options]
        return Result(self.command(*words, before=before), out)

    def good(self, scene, *options, **others):
        """As run(); a failure is a miss and ends the test."""
        result = self.run(scene, *options, **others)
        if result.code != 0:
            print(f"MISS {scene if isinstance(scene, str) else scene.get('title')} {options}: {result.stderr}")
            sys.exit(1)
        return result

    def end(self):
        sys.exit(1 if self.missed else 0)

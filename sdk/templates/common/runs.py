"""What the tests share: run a scene of this folder, compare a number with the exact one."""
import json
import os
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))


def run(scene, *options):
    """Runs a scene; gives back its summary.json."""
    with tempfile.TemporaryDirectory() as out:
        path = os.path.join(HERE, scene)
        words = [os.environ.get("SPH", "sph"), path, "--out", out, "--quiet", *options]
        if subprocess.run(words).returncode != 0:
            sys.exit(f"failed: {' '.join(words)}")
        with open(os.path.join(out, "summary.json")) as file:
            return json.load(file)


def check(what, value, exact, tolerance):
    """tolerance: of the difference, relative to the exact value where that is not 0."""
    print(f"{what}: {value:.9g}, exact {exact:.9g}")
    if not abs(value - exact) <= tolerance * (abs(exact) or 1):
        sys.exit(f"{what} is further than {tolerance:g} from the exact value")

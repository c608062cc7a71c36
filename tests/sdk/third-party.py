#!/usr/bin/env python3
"""Plugins of strangers, one of each kind: built from an installed tree alone (with a bare compiler, with the make
include, with autotools), each gives the physics that its README says. Every figure stands beside its bar; one
that is missed says MISS."""
import glob
import os
import re
import shutil
import subprocess
import sys

from staged import staged
from third_party_physics import Physics

source, folder = staged()
work = os.path.join(folder, "work")
plugins = os.path.join(folder, "plugins")
# Name: how it is built. The first way gives the one that runs.
WAYS = {
    "stiffened-gas": ("autotools", "cc", "make"),
    "stiffened-riemann": ("make",),
    "piston": ("make",),
    "poly6": ("cc",),
    "reordered": ("cc",),
    "fountain": ("make",),
}


def run(*words, cwd):
    """A build's command; its output is of interest only if it fails."""
    done = subprocess.run(words, cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        sys.exit(f"MISS {' '.join(words)} in {cwd}: exit status {done.returncode}\n{done.stdout}")
    return done.stdout


def copied(name, way):
    """A folder of its own for each way, as if nothing else had ever been done there."""
    to = os.path.join(work, way, name)
    shutil.copytree(os.path.join(source, "tests", "sdk", name), to)
    for at, _, files in os.walk(to):
        for path in (at, *(os.path.join(at, file) for file in files)):
            os.chmod(path, os.stat(path).st_mode | 0o200)  # the source may be read-only
    return to


def by_cc(name, at):
    run("./build.sh", cwd=at)
    return os.path.join(at, f"{name}.so")


def by_make(name, at):
    run("make", cwd=at)
    # What the compiler has read: the plugin's own files, the installed headers and the system's.
    for listing in glob.glob(os.path.join(at, "build", "*.d")):
        with open(listing, encoding="utf-8") as file:
            for path in file.read().replace("\\\n", " ").split():
                if path.startswith(os.path.join(os.path.abspath(source), "")):
                    sys.exit(f"MISS {name} was built with {path}, which is not installed")
    return os.path.join(at, f"{name}.so")


def by_autotools(name, at):
    build = os.path.join(at, "build")
    os.mkdir(os.path.join(at, "m4"))
    os.mkdir(build)
    run("autoreconf", "-fi", cwd=at)
    run("../configure", "-q", cwd=build)
    run("make", cwd=build)
    run("make", "install", f"DESTDIR={build}/dest", cwd=build)
    found = glob.glob(os.path.join(build, "dest", "**", f"{name}.so"), recursive=True)
    left = glob.glob(os.path.join(build, "dest", "**", "*.la"), recursive=True)
    if len(found) != 1 or left or not os.path.dirname(found[0]).endswith(plugins_dir()):
        sys.exit(f"MISS make install of {name}: {found} {left}, not into {plugins_dir()}")
    return found[0]


def plugins_dir():
    """Where sph of this tree looks for plugins."""
    words = ["pkg-config", "--variable=pluginsdir", "sph-plugin"]
    return os.path.realpath(subprocess.run(words, stdout=subprocess.PIPE, check=True, text=True).stdout.strip())


def examine(name, path):
    """One symbol is exported; no library of ours is linked."""
    symbols = [line.split()[-1] for line in run("nm", "-D", "--defined-only", path, cwd=folder).splitlines()]
    if symbols != ["sph_plugin_entry"]:
        sys.exit(f"MISS {path} exports {symbols}")
    needed = re.findall(r"NEEDED.*\[(.*)\]", run("readelf", "-d", path, cwd=folder))
    if [one for one in needed if not re.match(r"(libc|libm|ld-linux.*|libgcc_s)\.", one)]:
        sys.exit(f"MISS {path} needs {needed}")
    run("sph", "info", "--exists", f"plugin/{name}", "--load", path, cwd=folder)


os.makedirs(plugins)
built = {}
for name, ways in WAYS.items():
    for way in ways:
        built[name, way] = {"cc": by_cc, "make": by_make, "autotools": by_autotools}[way](name, copied(name, way))
        examine(name, built[name, way])
        print(f"ok   {name}: built by {way}, one symbol, no library of ours")
    shutil.copy(built[name, ways[0]], plugins)
    run("sph-plugin-check", os.path.join(plugins, f"{name}.so"), cwd=folder)
    print(f"ok   {name}: sph-plugin-check has nothing against it")

# A table for a parameter of what is checked, and one that cannot be had.
table = ["sph-plugin-check", os.path.join(plugins, "piston.so"), "--set"]
run(*table, 'piston-place.path={"t": [0, 1], "v": [0, 1]}', cwd=folder)
missing = subprocess.run([*table, "piston-place.path=no.csv"], cwd=folder, capture_output=True, text=True)
if missing.returncode != 2 or "/piston-place/path: no.csv: cannot be read" not in missing.stderr:
    sys.exit(f"MISS a table that is not there: {missing.returncode}, {missing.stderr}")
print("ok   piston: sph-plugin-check takes a table")

physics = Physics(os.path.join(source, "tests", "sdk"), folder, plugins)
physics.tube({way: os.path.dirname(built["stiffened-gas", way]) for way in WAYS["stiffened-gas"]})
physics.solver()
physics.piston()
physics.kernels()
physics.order()
physics.fountain()
sys.exit(1 if physics.missed else 0)

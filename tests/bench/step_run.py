"""What step.py's parts share: running scenes, and what a summary says of a step's time and memory."""
import copy
import json
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.environ.get("top_srcdir", os.path.join(HERE, "..", ".."))
BUILD = os.environ.get("top_builddir", os.path.join(SOURCE, "build"))


class Program:
    """sph, with a scratch folder."""

    def __init__(self, scratch):
        self.scratch, self.count = scratch, 0
        self.sph = os.environ.get("SPH", os.path.join(BUILD, "sph"))
        self.env = {
            "SPH_PLUGIN_PATH": os.path.join(BUILD, "plugins", ".libs"),
            "SPH_DATA_PATH": os.path.join(SOURCE, "sdk"),
            **os.environ,
        }

    @staticmethod
    def example(name):
        with open(os.path.join(SOURCE, "examples", name)) as file:
            return json.load(file)

    def run(self, scene, *options):
        """The summary of a run, with the folder that it left as "folder"."""
        self.count += 1
        path = os.path.join(self.scratch, f"{self.count}.json")
        out = os.path.join(self.scratch, str(self.count))
        with open(path, "w") as file:
            json.dump(copy.deepcopy(scene), file)
        words = [self.sph, "run", path, "--out", out, "--quiet", *options]
        done = subprocess.run(words, capture_output=True, text=True, env=self.env)
        if done.returncode:
            sys.exit(f"{' '.join(words)}: {done.stderr}")
        with open(os.path.join(out, "summary.json")) as file:
            return dict(json.load(file), folder=out)


def numbers(tree, prefix=""):
    """All numbers of a tree, by path."""
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from numbers(value, f"{prefix}{key}.")
        elif isinstance(value, (int, float)):
            yield prefix + key, value


def split(summary):
    """Figures by name: seconds of the parts of all steps, and what follows from them."""
    cost = summary["cost"]
    n = sum(summary["particles"].values())
    steps, updates = summary["steps"], cost["particle_updates"]
    # sph counts each particle as its own neighbour: its pairs are n an evaluation more than true ones.
    pairs = {name for name, count in cost["pass_pairs"].items() if count}
    pair = sum(s for name, s in cost["pass_s"].items() if name in pairs)
    point = sum(s for name, s in cost["pass_s"].items() if name not in pairs)
    rest = cost["loop_s"] - pair - point - cost["neighbour_s"] - cost["integrate_s"]
    builds = cost["list_builds"]
    sweeps = pair / (steps + 1)  # of all pair passes, an evaluation a step
    out = {
        "us / particle update": cost["us_per_particle_update"],
        "ns / pair": cost["ns_per_pair"],
        "pairs / particle / pass": cost["pairs"] / updates / len(pairs) if updates and pairs else 0.0,
        "seconds": cost["loop_s"],
        "pair passes": pair,
        **{f"  {name}": cost["pass_s"][name] for name in sorted(pairs)},
        "point passes": point,
        "lists, sorting, ghosts": cost["neighbour_s"],
        "integration": cost["integrate_s"],
        "rest (totals, reductions)": rest,
        "io, not in the seconds": cost["io_s"],
        "step / pair passes": cost["loop_s"] / pair,
        "list builds / step": builds / steps,
        "list build / pair passes": cost["neighbour_s"] / builds / sweeps if builds else 0.0,
        "bytes / particle": cost["bytes_per_particle"],
    }
    if "sorts" in cost:
        out["sorts"] = cost["sorts"]
    for name, value in numbers(cost.get("memory", summary.get("memory", {}))):
        each = name.endswith("per_particle")
        out[f"  {name}" if each else f"  {name} / particle"] = value if each else value / n
    return out


def table(columns):
    """{heading: {figure: value}}"""
    names = list(dict.fromkeys(name for figures in columns.values() for name in figures))
    print(f"  {'':30s}" + "".join(f"{heading:>12s}" for heading in columns))
    for name in names:
        cells = (figures.get(name) for figures in columns.values())
        print(f"  {name:30s}" + "".join(f"{'-':>12s}" if c is None else f"{c:12.4g}" for c in cells))

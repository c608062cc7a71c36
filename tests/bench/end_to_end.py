#!/usr/bin/env python3
"""Whole runs with one build of sph, or with two beside each other: where the time goes, and how much less.

    end_to_end.py [options] BEFORE_SPH BEFORE_PLUGINS [AFTER_SPH AFTER_PLUGINS]

Runs Noh's implosion (100 x 100, to t = .6) and Sod's tube in three dimensions (77 760 particles, to t = .04)
with each build in turn, several times, and shows medians. `process` is the processor's time of the
whole process, the rest is seconds on the wall from summary.json; io: snapshots and logs in the loop."""
import argparse
import json
import os
import resource
import statistics
import subprocess
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
EXAMPLES = os.path.join(os.environ.get("top_srcdir", os.path.join(HERE, "..", "..")), "examples")
# Scene, end time: None for the scene's own.
SCENES = {"noh": ("noh.json", None), "sod-3d": ("sod-3d.json", 0.04)}


class Build:
    def __init__(self, name, program, plugins):
        self.name, self.program, self.plugins = name, program, plugins

    def run(self, scene, until, threads, out):
        """One run: its figures by name [s, and what follows from them]."""
        command = [self.program, "run", os.path.join(EXAMPLES, scene), "--out", out, "--quiet"]
        command += ["--threads", str(threads)]
        if until is not None:
            command += ["--set", f"time.end={until}"]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        wall = time.perf_counter()
        subprocess.run(command, check=True, env=dict(os.environ, SPH_PLUGIN_PATH=self.plugins))
        wall = time.perf_counter() - wall
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        with open(os.path.join(out, "summary.json")) as file:
            summary = json.load(file)
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return figures(summary, wall, cpu)


def figures(summary, wall, cpu):
    cost = summary["cost"]
    seconds = {"process": cpu, "wall": wall, "loop": cost["loop_s"], "  neighbours": cost["neighbour_s"]}
    for name, value in cost["pass_s"].items():
        seconds[f"  {name}"] = value
    seconds["  integrate"] = cost["integrate_s"]
    seconds["  io"] = cost["io_s"]
    seconds["  mpi"] = cost["mpi_s"]
    parts = sum(value for name, value in seconds.items() if name.startswith("  "))
    seconds["  rest"] = cost["loop_s"] - parts
    updates, pairs = cost["particle_updates"], cost["pairs"]
    counts = {
        "steps": summary["steps"],
        "particle updates": updates,
        "pairs": pairs,
        "list builds": cost["list_builds"],
    }
    each = {
        "us per update, process": 1e6 * cpu / updates,
        "us per update, loop": 1e6 * cost["loop_s"] / updates,
        "ns per pair, passes": 1e9 * sum(cost["pass_s"].values()) / pairs,
    }
    for name, number in cost["pass_pairs"].items():
        if number:
            each[f"ns per pair, {name}"] = 1e9 * cost["pass_s"][name] / number
    # No relative error of what is 0 everywhere.
    checks = {
        f"l1_rel of {name}": error["l1_rel"]
        for name, error in summary["errors"].items()
        if error["l1_rel"] is not None
    }
    return {"seconds": seconds, "counts": counts, "each": each, "errors": checks}


def medians(runs):
    return {
        group: {name: statistics.median(run[group][name] for run in runs) for name in runs[0][group]}
        for group in runs[0]
    }


def show(name, builds, results):
    """A table: a column a build, and how many times less the second one takes."""
    table = [medians(results[build.name]) for build in builds]
    head = "".join(f"{build.name:>14}" for build in builds) + (f"{'ratio':>9}" if len(builds) == 2 else "")
    print(f"\n{name:36}{head}")
    for group, form in (("seconds", ".3f"), ("counts", ".0f"), ("each", ".3f"), ("errors", ".5f")):
        # A pass that only one of them has keeps its line.
        rows = list(dict.fromkeys(row for one in table for row in one[group]))
        for row in rows:
            values = [one[group].get(row) for one in table]
            cells = "".join(f"{'-':>14}" if v is None else f"{v:14{form}}" for v in values)
            ratio = ""
            if len(values) == 2 and None not in values and values[1] > 0:
                ratio = f"{values[0] / values[1]:9.2f}"
            print(f"{row:36}{cells}{ratio}")
    spread = ", ".join(
        f"{build.name} {min(times):.2f} to {max(times):.2f}"
        for build in builds
        for times in [[run["seconds"]["process"] for run in results[build.name]]]
    )
    print(f"process time of all runs: {spread} s", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("builds", nargs="+", metavar="SPH PLUGINS", help="a program, its plugins' folder")
    parser.add_argument("--scenes", default="noh,sod-3d", help="of noh, sod-3d, or a file")
    parser.add_argument("--until", type=float, help="end all of them at this time")
    parser.add_argument("--repeat", type=int, default=3, help="runs with each build (3)")
    parser.add_argument("--threads", type=int, default=1, help="(1)")
    options = parser.parse_args()
    if len(options.builds) not in (2, 4):
        parser.error("one program and its plugins' folder, or two of each")
    words = options.builds
    builds = [Build("before" if len(words) == 4 else "sph", words[0], words[1])]
    if len(words) == 4:
        builds.append(Build("after", words[2], words[3]))
    threads = options.threads
    print(f"{options.repeat} runs each, in turn, {threads} thread{'s' if threads > 1 else ''}; medians")
    with tempfile.TemporaryDirectory() as scratch:
        for name in options.scenes.split(","):
            scene, until = SCENES.get(name, (os.path.abspath(name), None))
            until = options.until if options.until is not None else until
            results = {build.name: [] for build in builds}
            for turn in range(options.repeat):
                # The order changes, so that neither is always the first.
                for build in builds if turn % 2 == 0 else builds[::-1]:
                    results[build.name].append(build.run(scene, until, threads, scratch))
            show(f"{name}, to t = {until}" if until is not None else name, builds, results)


if __name__ == "__main__":
    main()

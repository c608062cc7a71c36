"""battery.py -- what the families of tests/stability share: base scenes, runs on two cores, rules with the
verdict that is expected of them, and their tables for RESULTS.md."""

import json
import multiprocessing
import os
import shutil
import sys
import textwrap

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, ".."))
from scenes import Result, Scenes, Snapshot, changed, example  # noqa: E402, F401

_scenes = None


def base(name):
    """tests/stability/NAME.json as an object to change."""
    with open(os.path.join(HERE, name + ".json")) as file:
        scene = json.load(file)
    scene.pop("//", None)
    return scene


def put(scene, path, value):
    """scene["a"]["b"] = value for path a.b; numbers are indices. Returns the scene."""
    *way, last = [int(w) if w.isdigit() else w for w in path.split(".")]
    at = scene
    for word in way:
        at = at[word]
    at[last] = value
    return scene


class Outcome:
    """A run: whether it went through, its log as arrays by name, its folder."""

    def __init__(self, result):
        self.result = result
        self.done = result.code == 0
        self.said = (result.stderr.strip().splitlines() or [""])[-1]
        self.log = {}
        if result.has("log.csv") and os.path.getsize(result.path("log.csv")):
            names, rows = result.log()
            self.log = dict(zip(names, np.array(rows).T)) if rows else {}

    def summary(self):
        return self.result.summary()

    def last(self):
        return self.result.last()


def run(scene, *options, timeout=900):
    """Runs a scene on one thread, unwatched: what goes wrong is what is measured. A scene that is wrong ends
    everything: that is our fault."""
    global _scenes
    if _scenes is None or _scenes.owner != os.getpid():
        _scenes = Scenes()
        _scenes.owner = os.getpid()
    _scenes.count += 1
    out = os.path.join(_scenes.scratch.name, f"out{_scenes.count}")
    words = [_scenes.write({"watch": False, **scene}), "--out", out, "--threads", "1", "--quiet", *options]
    done = _scenes.command(*words, timeout=timeout)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{scene.get('title')}: {done.stderr}")
    return Outcome(Result(done, out))


def forget(outcome):
    """Removes what a run left."""
    shutil.rmtree(outcome.result.out, ignore_errors=True)


def each(function, jobs):
    """[function(job) for job in jobs], two at a time."""
    with multiprocessing.get_context("fork").Pool(2) as pool:
        return pool.map(function, jobs, chunksize=1)


def number(value):
    """Short, for a table."""
    if value is None:
        return "-"
    if isinstance(value, str):
        return value
    if isinstance(value, (int, np.integer)):
        return str(value)
    return f"{value:.4g}"


class Report:
    """One family's section of RESULTS.md, and how many verdicts are not what is expected."""

    def __init__(self, title, about):
        self.title, self.lines, self.rules, self.surprises = title, [], [], []
        self.text(about)

    def text(self, words):
        """Paragraphs, of lines as they come."""
        for part in words.strip().split("\n\n"):
            self.lines += [textwrap.fill(" ".join(part.split()), 110), ""]

    def table(self, head, rows):
        """Plain figures, no verdict."""
        self.lines.append("| " + " | ".join(head) + " |")
        self.lines.append("|" + "---|" * len(head))
        self.lines += ["| " + " | ".join(number(c) for c in row) + " |" for row in rows]
        self.lines.append("")

    def rule(self, case, measured, bar, good, fails=""):
        """A rule: what is measured, its theory or bar, whether it holds. fails: why it is known not to;
        then holding is a surprise."""
        expected = not fails
        verdict = "OK" if good else "FAILS"
        note = fails if not good else ""
        if bool(good) != expected:
            self.surprises.append(case)
            verdict += ", not expected"
            note = note or ("was known to fail: " + fails if fails else "")
        elif not good:
            verdict += " (known)"
        self.rules.append([case, measured, bar, verdict, note])

    def written(self, date, seconds):
        held = sum(r[3].startswith("OK") for r in self.rules)
        lines = [f"## {self.title}", "", f"{date}, {seconds:.0f} s. {held} of {len(self.rules)} rules hold.", ""]
        lines += self.lines
        lines += ["| rule | measured | theory or bar | verdict | why it fails |", "|---|---|---|---|---|"]
        lines += ["| " + " | ".join(number(c) for c in row) + " |" for row in self.rules]
        return "\n".join(lines) + "\n"

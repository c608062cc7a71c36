"""What the accuracy tests share: run a scene, read its summary, hold figures against bars."""
import json
import os
import subprocess
import sys
import tempfile

SPH = os.environ["SPH"]
EXAMPLES = os.path.join(os.environ["top_srcdir"], "examples")


class Runs:
    """Runs scenes into a scratch folder; counts the bars that are missed."""

    def __init__(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.missed = 0
        self.count = 0

    def run(self, scene, *options):
        """Runs examples/SCENE with gsph; returns (summary, folder)."""
        self.count += 1
        out = os.path.join(self.scratch.name, str(self.count))
        command = [SPH, "--load", "gsph.so", os.path.join(EXAMPLES, scene), "--out", out, "--quiet"]
        subprocess.run(command + list(options), check=True)
        with open(os.path.join(out, "summary.json")) as file:
            summary = json.load(file)
        assert summary["status"] == "done", summary["status"]
        return summary, out

    def bar(self, what, value, low=None, high=None):
        """Prints a figure beside its bar."""
        good = (low is None or value >= low) and (high is None or value <= high)
        bounds = " ".join(
            word
            for word in (f">= {low:g}" if low is not None else "", f"<= {high:g}" if high is not None else "")
            if word
        )
        print(f"{'ok  ' if good else 'MISS'} {what}: {value:.6g} ({bounds or 'reported'})")
        self.missed += not good

    def end(self):
        sys.exit(1 if self.missed else 0)

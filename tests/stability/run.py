"""run.py -- the stability battery: runs its families and writes RESULTS.md. Families, one file each: those of
FAMILIES below. Exit status 1 if a verdict is not the one that the family's file expects: a regression, or
something that is known to fail and no longer does.

    make check-stability                     all
    make check-stability ONLY=cfl,pairing    some; the sections of the others stay
"""

import argparse
import importlib
import os
import re
import sys
import time

from battery import HERE

FAMILIES = ["cfl", "pairing", "conservation", "robustness", "knee", "iteration", "offset", "tensile", "settling"]
HEAD = """# Stability: what was run, what came of it

Written by `make check-stability` (tests/stability/run.py); not to be edited. Every rule has a theory or a bar.
FAILS (known): the method, as it stands, does not keep the rule; the last column says why. The target fails
only where a verdict is not the one that the family's file expects.
"""


def sections(path):
    """The sections of an earlier RESULTS.md by family."""
    if not os.path.exists(path):
        return {}
    with open(path) as file:
        parts = re.split(r"<!-- (\w+) -->\n", file.read())
    return dict(zip(parts[1::2], (p.strip() + "\n" for p in parts[2::2])))


def overview(text):
    """A row a family: its title, its date, how many rules hold."""
    lines = ["", "| family | | run | rules that hold |", "|---|---|---|---|"]
    for family in FAMILIES:
        found = re.match(r"## (.*)\n\n(\S+), .*?(\d+ of \d+) rules", text.get(family, ""))
        if found:
            lines.append(f"| {family} | {found[1]} | {found[2]} | {found[3]} |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--only", default="", help="families, separated by commas")
    parser.add_argument("--results", default=os.path.join(HERE, "RESULTS.md"))
    options = parser.parse_args()
    only = [name for name in options.only.split(",") if name] or FAMILIES
    unknown = [name for name in only if name not in FAMILIES]
    if unknown:
        sys.exit(f"no family {unknown[0]}; there are {', '.join(FAMILIES)}")
    text, surprises = sections(options.results), []
    for name in only:
        begin = time.time()
        report = importlib.import_module(name).main()
        text[name] = report.written(time.strftime("%Y-%m-%d"), time.time() - begin)
        print(text[name], flush=True)
        surprises += [f"{name}: {case}" for case in report.surprises]
        with open(options.results + ".new", "w") as file:
            file.write(HEAD + overview(text))
            for family in FAMILIES:
                if family in text:
                    file.write(f"\n<!-- {family} -->\n{text[family]}")
        os.replace(options.results + ".new", options.results)
    for case in surprises:
        print(f"not expected: {case}")
    sys.exit(1 if surprises else 0)


if __name__ == "__main__":
    main()

"""sph-plugin-check: our plugins pass; every deliberately wrong module is caught by a line that names item and
fault; right items beside them pass; JSON, options and exit codes are as documented."""
import json
import os
import subprocess
import sys

BUILD = os.environ["top_builddir"]
CHECK = os.path.join(BUILD, "sph-plugin-check")
# A sanitizer says in its own words, on stderr, what would else be a signal.
SANITIZED = bool(os.environ.get("SPH_SANITIZED"))

missed = 0


def module(name, folder="check"):
    return os.path.join(BUILD, "tests", folder, ".libs", name + ".so")


def run(*arguments):
    done = subprocess.run([CHECK, *arguments], capture_output=True, text=True, timeout=300)
    return done.returncode, done.stdout, done.stderr


def expect(what, good, detail=""):
    global missed
    if not good:
        missed += 1
        print(f"MISS {what}: {detail}")


# Ours.
for plugin in ("gsph", "wcsph", "barotropic", "diagnostics", "eos", "exact", "forces", "kernels"):
    code, out, err = run(plugin)
    expect(plugin, code == 0 and "FAIL" not in out and " 0 failed" in out.splitlines()[-1] and not err, out + err)
code, out, err = run("kernels", "gsph", "--only", "gsph", "-q")
expect("two plugins, quiet", code == 0 and len(out.splitlines()) == 1, out + err)

# What is found of each wrong item; None: nothing.
POINT = {
    "writes-read-only": 'touches "rho", which it declares only to read',
    "keeps": None,
    "reads-undeclared": 'touches "rho", a column of an earlier batch',
    "takes-third-column": "touches batch->dst, beyond its end",
    "writes-past-range": 'writes "seen" of particle 504, outside its destinations 496 to 503',
    "ignores-range": 'writes "seen" of particle 0, outside its destinations 496 to 503',
    "overruns": 'touches "seen", which it may write, but not beyond its end',
    "leaves-unset": '"seen", which is declared as written, is not set at particle 5',
    "counts-calls": 'called again, "seen" of particle 0 is 2, but was 1',
    "shares-scratch": 'on 4 threads, "seen" of particle',
    "crashes-on-none": "run in 1 dimension, 0 particles, in one piece: divides an integer by zero",
    "gives-nan": '"seen" of particle 0 is nan, at rho = 0.98',
    "changes-rounding": "run changes the floating point mode",
    "exits": "ended the process, with exit status 0",
    "aborts": "aborts",
    "prints": 'prints, which is the host\'s affair: "seven"',
    "fails": "fails with status -5: no luck today",
    "leaks": "behind",
}
PAIR = {
    "right": None,
    "reads-own-mass": 'touches "m", which it declares for the sources only, at a destination',
    "reads-sources-density": "follows a NULL pointer",
    "reads-past-begin": "touches batch->begin, beyond its end",
    "divides-by-none": "divides an integer by zero",
    "depends-on-pieces": '"sum" of particle 496 is 2, but was 4 in one piece',
}
PATH = {
    "right-in-both": None,
    "drops-bits": "by the best loop in floats, by the plain loop in long doubles",
    "takes-floats-for-doubles": 'touches x, beyond its end',
    "other-on-old-processors": "by base in doubles, by the plain loop in long doubles",
    "refuses-floats": "the best loop in floats fails with status",
    "depends-on-pieces-in-floats": 'in floats and pieces of 56, "sum" of particle 56 is',
}
EOS = {
    "right-gas": None,
    "stiff-gas": None,
    "right-liquid": None,
    "wrong-sound": "cs^2 differs from dp/drho + p/rho^2 dp/du at rho = 0.001, u = ",
    "wrong-inverse": "inverse gives u = ",
    "wrong-liquid": "cs^2 differs from dp/drho at rho = 500:",
    "never-a-number": "run gives no number at any of 81 states",
}
RECIPE = {
    "bell": None,
    "cut-bell": None,
    "lost": 'steps[0] names function "no-such-function"',
    "remembers": None,
    "forgets": "saved, restored and saved again",
    "splits": None,
    "splits-wrongly": 'born, 1 dimension, 1000 particles: "m" of particle 0 is nan',
    "takes-any-format": "restore takes format 1003, which it has never written",
}
for name, items in (("wrong_point", POINT), ("wrong_pair", PAIR), ("wrong_path", PATH), ("wrong_eos", EOS), ("wrong_recipe", RECIPE)):
    code, out, err = run(module(name))
    expect(f"{name}: exit code", code == 1, f"{code}: {out}{err}")
    lines = out.splitlines()
    for item, fault in items.items():
        found = [line for line in lines if line.startswith("FAIL ") and line.split()[2] == item]
        said = [line for line in lines if len(line.split()) > 2 and line.split()[2] == item]
        if fault is None:
            expect(f"{item} is right", said and not found, "\n".join(found or said))
        else:
            caught = any(fault in line or SANITIZED and "runtime error" in line for line in found)
            expect(item, caught, f"wanted {fault!r}, found " + "\n".join(found or said))
    expect(f"{name}: the count", lines and lines[-1].split()[0] == str(sum(l[:4] in ("ok  ", "FAIL") for l in lines)),
           lines[-1] if lines else "")
    if name == "wrong_recipe":
        for fault in (
            'kernel is "no-such-kernel"', 'integrator is "no-such-integrator"',
            "note kernel cut-bell  W jumps to 0 at the support in 1 dimensions, from 0.25 W(0)",
        ):
            expect(fault, fault in out, out)
    if name == "wrong_eos":
        expect("the value that is made up", "parameter c0 has no default" in out, out)

code, out, err = run(module("wrong_endless"), "--timeout", "0.5")
expect("never-returns", code == 1 and "run in 1 dimension" in out and "does not return within 0.5 s" in out, out)

# JSON holds the same.
code, out, err = run(module("wrong_eos"), "--json", "--only", "wrong-sound", "--only", "right-gas")
try:
    verdicts = json.loads(out)
except ValueError:
    verdicts = []
failed = [v for v in verdicts if v["verdict"] == "fail"]
expect("JSON", code == 1 and len(failed) == 1 and failed[0]["item"] == "wrong-sound" and failed[0]["kind"] == "eos"
       and failed[0]["check"] == "eos" and "cs^2" in failed[0]["text"], out)

# Values of the user's own.
code, out, err = run(module("wrong_eos"), "--only", "right-liquid", "--set", "right-liquid.c0=1500")
expect("--set", code == 0 and "has no default" not in out, out + err)
code, out, err = run(module("wrong_point"), "--only", "gives-nan", "--set", "gives-nan.rho=0.1:0.2")
expect("--set of a property", code == 0, out + err)

# The command line, and what the loader refuses.
for code_wanted, text, *arguments in (
    (2, "no plugin is given"),
    (2, 'did you mean "ideal-gas"', "eos", "--only", "ideal-gaz"),
    (2, 'did you mean "gamma"', "eos", "--set", "ideal-gas.gama=2"),
    (2, "ITEM.NAME=VALUE", "eos", "--set", "gamma"),
    (2, "called \"gas\"", "eos", "--set", "gas.gamma=2"),
    (2, "LOW:HIGH", "eos", "--set", "ideal-gas.rho=dense"),
    (2, "--timeout", "eos", "--timeout", "soon"),
    (3, "no plugin \"no-such-plugin\"", "no-such-plugin"),
    (3, "no plugin \"no-such-plugin\"", "eos", "--load", "no-such-plugin"),
    (3, "it was built for the plugin ABI", module("newer_minor", "abi")),
    (3, "null pointer of type" if SANITIZED else "follows a NULL pointer", module("wrong_init")),
    (3, "ideal-gas", "eos", module("newer_minor", "abi")),
    (2, "gamma must lie between", "eos", "--set", "ideal-gas.gamma=0.5"),
    (0, "kernels: integral", "--list"),
):
    code, out, err = run(*arguments)
    expect(" ".join(arguments) or "no argument", code == code_wanted and text in out + err, f"{code}: {out}{err}")

sys.exit(1 if missed else 0)

"""`sph run --audit`: the examples' plugins touch only what they declare; a function that does more is caught
with one sentence that names the pass and the column, and exit code 1."""
import os
import subprocess
import sys
import tempfile

SPH = os.environ["SPH"]
EXAMPLES = os.path.join(os.environ["top_srcdir"], "examples")
TRESPASS = os.path.join(os.environ["top_builddir"], "tests", "abi", ".libs", "trespass.so")

missed = 0


def expect(what, good, detail=""):
    global missed
    if not good:
        missed += 1
        print(f"MISS {what}: {detail}")


def run(scene, *options):
    with tempfile.TemporaryDirectory() as scratch:
        command = [SPH, os.path.join(EXAMPLES, scene), "--out", os.path.join(scratch, "out"), "--quiet"]
        command += ["--audit", "--threads", "2", *options]
        return subprocess.run(command, capture_output=True, text=True, timeout=300)


def edit(*steps):
    return "scheme.edit=[" + ",".join(steps) + "]"


# The examples pass, with both integrators, with ghosts and without.
COARSE = ("--set", "particles.fluid.fill.spacing=0.1", "--steps", "30")
LONG = ("--steps", "30", "--set", "particles.fluid.fill.0.mass=0.005", "--set", "particles.fluid.fill.1.mass=0.005")
for scene, options in (
    ("noh.json", COARSE),
    ("noh.json", (*COARSE, "--set", "time.integrator=pec", "--set", "scheme.riemann=exact")),
    ("noh-1d.json", ("--steps", "30")),
    ("noh-3d.json", ("--steps", "2", "--set", "particles.fluid.fill.spacing=0.4")),
    ("sod.json", LONG),
    ("sod.json", (*LONG, "--precision", "mixed")),
    ("wave.json", ("--steps", "20", "--precision", "mixed")), # the core corrects v within a pass that reads it
    ("sod.json", (*LONG, "--set", "domain.sides.x=periodic")),
    (
        "sod.json",
        (*LONG, "--set", 'scheme.edit=[{"operation": "assignment", "of": "seen", "expression": "2 * rho"}]',
         "--set", "particles.fluid.columns.seen=0"),
    ),
):
    done = run(scene, *options)
    expect(f"{scene} {' '.join(options)}", done.returncode == 0 and not done.stderr, done.stderr)

# Each trespass is caught.
KEEP = '{"insert": "trespass-keep", "after": "gsph-density"}'
for steps, pass_name, column in (
    (('{"insert": "trespass-write", "after": "gsph-density"}',), "trespass-write(fluid)", "rho"),
    ((KEEP, '{"insert": "trespass-read", "after": "trespass-keep"}'), "trespass-read(fluid)", "rho"),
    (('{"insert": "trespass-leave"}',), "trespass-leave(fluid)", "seen"),
    (('{"insert": "trespass-leave", "at": "finish"}',), "trespass-leave(fluid)", "seen"),
    (('{"insert": "trespass-pair"}',), "trespass-pair(fluid)", "m"),
    (('{"insert": "trespass-overrun"}',), "trespass-overrun(fluid)", "seen"),
):
    options = ("--load", TRESPASS, "--set", edit(*steps), "--steps", "3")
    done = run("noh-1d.json", *options)
    lines = done.stderr.splitlines()
    expect(
        pass_name,
        done.returncode == 1 and len(lines) == 1 and "audit" in lines[0] and pass_name in lines[0]
        and f'"{column}"' in lines[0] and '"fluid"' in lines[0],
        f"exit code {done.returncode}, says {done.stderr!r}",
    )

# A column that was not asked for is not there.
done = run("noh-1d.json", "--load", TRESPASS, "--set", edit('{"insert": "trespass-source"}'), "--steps", "3")
expect("trespass-source", done.returncode == 1 and len(done.stderr.splitlines()) == 1
       and "trespass-source(fluid) followed a NULL pointer" in done.stderr, done.stderr)

# The keeper alone does nothing wrong; nor is anything of it seen without the audit.
done = run("noh-1d.json", "--load", TRESPASS, "--set", edit(KEEP), "--steps", "3")
expect("trespass-keep", done.returncode == 0 and not done.stderr, done.stderr)

sys.exit(1 if missed else 0)

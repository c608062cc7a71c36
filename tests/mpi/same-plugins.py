"""Under mpirun every rank proves that it loaded the same bytes as the first: a plugin that is missing on a rank,
has another size or one other byte ends the run at once, with exit code 3 and one sentence from one rank, which
names the rank, the plugin, both files and what differs. Skipped without MPI."""
import os
import shlex
import shutil
import stat
import subprocess
import sys
import tempfile
import time

SPH = os.environ["SPH"]
BUILD = os.environ["top_builddir"]
SCENE = os.path.join(os.environ["top_srcdir"], "examples", "noh-1d.json")
PLUGINS = os.path.join(BUILD, "plugins", ".libs")

mpirun = shlex.split(os.environ.get("MPIRUN") or "")
info = subprocess.run([SPH, "info", "--build"], capture_output=True, text=True).stdout
if not mpirun or not any(line.startswith("MPI ") and "not built in" not in line for line in info.splitlines()):
    print("no mpirun, or built without MPI")
    sys.exit(77)

# Open MPI's own memory, which it never gives back, is not ours to answer for.
os.environ["ASAN_OPTIONS"] = "detect_leaks=0"
missed = 0
scratch = tempfile.TemporaryDirectory()


def path(*parts):
    return os.path.join(scratch.name, *parts)


def folder(name):
    """A copy of the plugins that the scene asks for."""
    os.mkdir(path(name), 0o755)
    for plugin in os.listdir(PLUGINS):
        if plugin.endswith(".so"):
            shutil.copyfile(os.path.join(PLUGINS, plugin), path(name, plugin))
            os.chmod(path(name, plugin), 0o644)
    return path(name)


# Every rank takes the plugins of a folder of its own.
WRAPPER = path("rank.sh")
with open(WRAPPER, "w") as file:
    file.write('#!/bin/sh\nSPH_PLUGIN_PATH=$1/$OMPI_COMM_WORLD_RANK\nexport SPH_PLUGIN_PATH\nshift\nexec "$@"\n')
os.chmod(WRAPPER, stat.S_IRWXU)


def run(case, ranks):
    begin = time.monotonic()
    done = subprocess.run(
        [*mpirun, "-n", str(ranks), WRAPPER, path(case), SPH, SCENE, "--out", path("out"), "--quiet"],
        capture_output=True, text=True, timeout=120)
    return done, time.monotonic() - begin


def expect(what, done, seconds, code, *words):
    global missed
    lines = [line for line in done.stderr.splitlines() if line.startswith("sph: ")]
    good = done.returncode == code and len(lines) == 1 and seconds < 60
    good = good and all(word in lines[0] for word in words) and not os.path.exists(path("out"))
    print(f"{'ok  ' if good else 'MISS'} {what}: exit code {done.returncode}, {seconds:.1f} s, {lines}")
    if not good:
        missed += 1
        print(done.stderr)


def flip(file, at):
    with open(file, "r+b") as f:
        f.seek(at)
        byte = f.read(1)
        f.seek(at)
        f.write(bytes([byte[0] ^ 1]))


def case(name, ranks):
    os.mkdir(path(name), 0o755)
    for rank in range(ranks):
        folder(os.path.join(name, str(rank)))


# Copies of the same bytes are the same.
case("same", 3)
done, seconds = run("same", 3)
good = done.returncode == 0 and os.path.exists(path("out", "summary.json"))
print(f"{'ok  ' if good else 'MISS'} equal copies: exit code {done.returncode}, {seconds:.1f} s")
missed += not good
shutil.rmtree(path("out"), ignore_errors=True)

# One byte of a section that is not loaded: nothing but the comparison can see it.
case("byte", 3)
with open(path("byte", "1", "gsph.so"), "rb") as file:
    content = file.read()
at = content.rindex(b"GCC: ") if b"GCC: " in content else len(content) - 1
flip(path("byte", "1", "gsph.so"), at)
done, seconds = run("byte", 3)
expect("one byte differs", done, seconds, 3, "rank 1: ", '"gsph"', path("byte", "1", "gsph.so"),
       path("byte", "0", "gsph.so"), f"at byte {at}")

# Two ranks differ: the lower one speaks.
case("size", 3)
for rank in "12":
    with open(path("size", rank, "gsph.so"), "ab") as file:
        file.write(b"\0" * int(rank))
done, seconds = run("size", 3)
expect("more bytes", done, seconds, 3, "rank 1: ", '"gsph"', "bytes", path("size", "0", "gsph.so"))

# The first rank is the odd one.
case("first", 2)
with open(path("first", "0", "eos.so"), "ab") as file:
    file.write(b"\0")
done, seconds = run("first", 2)
expect("the first has more", done, seconds, 3, "rank 1: ", '"eos"', path("first", "1", "eos.so"))

# A rank that cannot load at all says why; the others do not wait for it.
case("missing", 2)
os.remove(path("missing", "1", "gsph.so"))
done, seconds = run("missing", 2)
expect("missing", done, seconds, 3, "rank 1: ", 'no plugin "gsph"', path("missing", "1"))

# A file of the same name that is another plugin.
case("other", 2)
shutil.copyfile(os.path.join(BUILD, "tests", "abi", ".libs", "good.so"), path("other", "1", "eos.so"))
done, seconds = run("other", 2)
expect("another plugin", done, seconds, 3, "rank 1: ", '"eos"', "not here", path("other", "0", "eos.so"))

# All alike: one speaks, and no rank is named.
case("none", 2)
for rank in "01":
    os.remove(path("none", rank, "gsph.so"))
done, seconds = run("none", 2)
expect("missing everywhere", done, seconds, 3, 'sph: no plugin "gsph"', path("none", "0"))

scratch.cleanup()
sys.exit(1 if missed else 0)

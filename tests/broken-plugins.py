"""Plugins with one fault each: `sph run` refuses every one with exit code 3 and exactly one sentence that names the
file and, where there is one, item and field, and leaves nothing behind; what only shows while it runs ends the run
with exit code 1 and one sentence that names pass, property and particle. Beside them good plugins keep working:
`sph info` lists these, and tells of each broken one."""
import os
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile

SPH = os.environ["SPH"]
SOURCE = os.environ["top_srcdir"]
BUILD = os.environ["top_builddir"]
MODULES = os.path.join(BUILD, "tests", "abi", ".libs")
SCENE = os.path.join(SOURCE, "examples", "noh-1d.json")

missed = 0
scratch = tempfile.TemporaryDirectory()
folder = os.path.join(scratch.name, "broken")
os.mkdir(folder, 0o755)
environment = {**os.environ, "XDG_DATA_HOME": scratch.name}
with open(os.path.join(SOURCE, "sdk", "sph", "abi.h")) as header:
    words = header.read().split()
    MAJOR, MINOR = (int(words[words.index(f"SPH_ABI_{part}") + 1].rstrip("u")) for part in ("MAJOR", "MINOR"))


def expect(what, good, detail=""):
    global missed
    print(f"{'ok  ' if good else 'MISS'} {what}: {detail}")
    missed += not good


def place(name):
    return os.path.join(folder, name)


def module(name):
    with open(os.path.join(MODULES, name + ".so"), "rb") as file:
        return file.read()


def put(name, data, mode=0o644):
    with open(place(name), "wb") as file:
        file.write(data)
    os.chmod(place(name), mode)
    return place(name)


def copy(name):
    return put(name + ".so", module(name))


def patched(name, offset, data):
    """The good module with other bytes in its header."""
    good = module("good")
    return put(name, good[:offset] + data + good[offset + len(data):])


def sph(*words, **more):
    return subprocess.run([SPH, *words], capture_output=True, text=True, timeout=120,
                          env={**environment, **more})


def run(*options):
    out = os.path.join(scratch.name, "out")
    done = sph(SCENE, "--out", out, "--quiet", "--threads", "1", *options)
    left = os.path.exists(out)
    shutil.rmtree(out, ignore_errors=True)
    return done, left


def sentence(done):
    lines = done.stderr.splitlines()
    return lines[0] if len(lines) == 1 and lines[0].startswith("sph: ") else None


def refused(what, path, *words, load=()):
    """Loaded after `load`."""
    done, left = run("--steps", "1", *(word for name in (*load, path) for word in ("--load", name)))
    said = sentence(done)
    good = done.returncode == 3 and said is not None and path in said and not left
    expect(what, good and all(word in said for word in words), done.stderr.strip() or done.returncode)


def failed(what, module_name, edit, *words, options=()):
    done, left = run("--steps", "5", "--load", os.path.join(MODULES, module_name + ".so"),
                     "--set", f"scheme.edit=[{edit}]", *options)
    said = sentence(done)
    good = done.returncode == 1 and said is not None and left
    expect(what, good and all(word in said for word in words), done.stderr.strip() or done.returncode)


def library():
    """The good module made by a linker that is told -ffast-math; None where that adds nothing to it."""
    path = place("fast_math.so")
    command = [*shlex.split(os.environ["CC"]), *shlex.split(os.environ["PLUGIN_CPPFLAGS"]), "-shared", "-fPIC",
               "-ffast-math", "-o", path, os.path.join(SOURCE, "tests", "abi", "good.c")]
    subprocess.run(command, check=True)
    os.chmod(path, 0o755)
    symbols = subprocess.run(["nm", path], capture_output=True, text=True).stdout
    if "fast_math" in symbols:
        return path
    os.remove(path)
    return None


here = f"but this sph has {MAJOR}.{MINOR}"

# -- The twenty ------------------------------------------------------------------------------------

refused("no entry", copy("no_entry"), "it has no function sph_plugin_entry")
refused("wrong magic", copy("wrong_magic"), "magic number 0x12345678, not 0x4c504853")
refused("other major", copy("other_major"), f"built for the plugin ABI {MAJOR + 1}.0, {here}")
refused("newer minor", copy("newer_minor"), f"built for the plugin ABI {MAJOR}.{MINOR + 1}, {here}")
refused("small struct", copy("small_struct"), "size of the plugin's descriptor is 16 bytes")
refused("huge struct", copy("huge_struct"), "size of the plugin's descriptor is 2147483647 bytes", "absurd")
refused("NULL entry", copy("null_entry"), "its sph_plugin_entry returns NULL")
refused("failing init", copy("failing_init"), "its init failed: the moon is not full")
if not os.environ.get("SPH_SANITIZED"):  # which would tell it in its own words
    refused("crashing init", copy("crashing_init"), "it crashed (segmentation fault) while it was being loaded")
    os.remove(place("crashing_init.so"))  # the one after which the program does not go on
refused("undefined symbol", copy("undefined_symbol"), "undefined symbol: nobody_has_this_function")
refused("not ELF", put("not_elf.so", b"#!/bin/sh\necho hello\n"), "it is not an ELF file")
refused("truncated", put("truncated.so", module("good")[:5000]), "it is truncated")
machine, name = (40, "32-bit ARM") if os.uname().machine != "armv7l" else (62, "x86-64")
refused("other architecture", patched("other_machine.so", 18, struct.pack("=H", machine)), f"built for {name}")
good = put("a_good.so", module("good"))
refused("duplicate id", copy("duplicate"), 'function "idle" is registered already, by ' + good, load=(good,))
refused("unknown kind", copy("unknown_kind"), 'kind "sph.telepathy/0" is unknown to this sph')
refused("contradictory descriptor", copy("contradiction"), 'function "at-odds": reach is 0')
refused("world-writable file", put("writable.so", module("good"), 0o666), "others may write to the file (mode 666")
os.mkdir(place("open"), 0o755)
inner = put("open/plugin.so", module("good"))
os.chmod(place("open"), 0o777)
refused("writable folder", inner, f"others may write to its folder {place('open')} (mode 777")
os.chmod(place("open"), 0o755)
os.symlink(place("loop2.so"), place("loop1.so"))
os.symlink(place("loop1.so"), place("loop2.so"))
refused("symbolic-link loop", place("loop1.so"), "Too many levels of symbolic links")
refused("floating point mode", copy("flush_to_zero"), "changes the floating point mode", "-ffast-math")
failed("undeclared write", "trespass", '{"insert": "trespass-write", "after": "gsph-density"}', "audit",
       "trespass-write(fluid)", '"rho"', '"fluid"', "declares only to read", options=("--audit",))
failed("NaN in a rate", "nan_result", '{"insert": "nan-rate"}', "nan-rate(fluid)", '"a" not a number',
       "particle 7 ", '"fluid"', "x = (", "step 2")
failed("NaN beside it", "nan_result", '{"insert": "nan-aside"}', "nan-aside(fluid)", '"aside" not a number',
       "particle 7 ", '"fluid"', "x = (", "step 2")
failed("NaN in a rate, other integrator", "nan_result", '{"insert": "nan-rate"}', "nan-rate(fluid)",
       '"a" not a number', "particle 7 ", options=("--set", "time.integrator=pec"))

# -- And some more ---------------------------------------------------------------------------------

fast = library()
if fast:
    refused("linked with -ffast-math", fast, "changes the floating point mode")
refused("rounding at entry", copy("fp_entry"), "its sph_plugin_entry changes the floating point mode")
refused("precision at init", copy("fp_init"), "its init changes the floating point mode")
refused("wild pointer", copy("wild_pointer"), "pointer to the item is 0x7f00dead0000, where nothing is")
refused("empty", put("empty.so", b""), "it is empty")
os.mkdir(place("folder.so"), 0o755)
refused("a folder", place("folder.so"), "it is not a regular file")
os.mkfifo(place("fifo.so"), 0o644)
refused("a pipe", place("fifo.so"), "it is not a regular file")
os.symlink(place("nowhere"), place("dangling.so"))
refused("dangling link", place("dangling.so"), "No such file")
os.mkdir(place("above"), 0o755)
os.mkdir(place("above/between"), 0o755)
inner = put("above/between/plugin.so", module("good"))
os.chmod(place("above"), 0o777)
refused("writable folder above", inner, f"others may write to its folder {place('above')} (mode 777")
os.symlink(inner, place("leads_there.so"))
refused("link into a writable folder", place("leads_there.so"), f"others may write to its folder {place('above')}")
os.symlink(good, place("above/leads_out.so"))
refused("link in a writable folder", place("above/leads_out.so"), f"others may write to its folder {place('above')}")
os.chmod(place("above"), 0o1777)
done = sph("info", inner)
expect("a sticky folder will do", done.returncode == 0 and not done.stderr, done.stderr)
os.chmod(place("above"), 0o755)
if os.geteuid() == 0:
    strangers = put("strangers.so", module("good"))
    os.chown(strangers, 12345, 12345)
    refused("another owner", strangers, "the file belongs to user 12345")
    os.mkdir(place("theirs"), 0o755)
    inner = put("theirs/plugin.so", module("good"))
    os.chown(place("theirs"), 12345, 0)
    refused("another owner's folder", inner, f"its folder {place('theirs')} belongs to user 12345")
    os.symlink(good, place("their_link.so"))
    os.chown(place("their_link.so"), 12345, 12345, follow_symlinks=False)
    refused("another owner's link", place("their_link.so"), "the symbolic link", "belongs to user 12345")

# -- The host goes on ------------------------------------------------------------------------------

os.remove(place("leads_there.so"))
broken = [name for name in sorted(os.listdir(folder)) if name.endswith(".so") and name != "a_good.so"]
done = sph("info", SPH_PLUGIN_PATH=folder + ":" + os.environ["SPH_PLUGIN_PATH"])
lines = done.stderr.splitlines()
expect("good ones are listed", done.returncode == 0 and " idle " in done.stdout and "gsph-rates" in done.stdout,
       done.returncode)
expect("each broken one has a sentence",
       all(sum(line.startswith(f"sph: plugin {place(name)}: ") for line in lines) == 1 for name in broken)
       and len(lines) == len(broken), f"{len(lines)} lines, {len(broken)} broken plugins")
done, left = run("--steps", "1")
expect("a run that names none of them", done.returncode == 0 and not done.stderr, done.stderr)

scratch.cleanup()
sys.exit(1 if missed else 0)

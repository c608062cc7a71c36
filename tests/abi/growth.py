#!/usr/bin/env python3
"""Growth without break: plugins and hosts of two versions of the ABI, in all four directions. The
versions are copies of the SDK's headers that say 1.0, and 1.1 with a member appended to every
struct that may grow (major 0 loads equal minors only). The host is the core's own registry. All is
built with the address sanitizer where there is one: reading past an older struct shows; and it is
shown that it would."""
import glob
import os
import re
import shlex
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
import abi_text

HERE = os.path.dirname(os.path.abspath(__file__))
TOP = os.environ["top_srcdir"]
BUILD = os.environ["top_builddir"]
CC = os.environ.get("CC", "cc").split()
# Those of the core, whose -I come after ours; they name folders seen from the build's own.
CPPFLAGS = shlex.split(os.environ["CORE_CPPFLAGS"])


def build(*arguments):
    done = subprocess.run(arguments, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          cwd=BUILD)
    if done.returncode:
        sys.exit("cannot build:\n" + done.stdout[:2000])


def versions(scratch):
    """The two sets of headers."""
    for minor in (0, 1):
        sdk = os.path.join(scratch, f"sdk{minor}")
        abi_text.copy_tree(os.path.join(TOP, "sdk/sph"), os.path.join(sdk, "sph"))
        abi_text.set_version(sdk, 1, minor)
        if minor == 1:
            with open(os.path.join(sdk, "sph/abi.h"), "a", encoding="utf-8") as file:
                file.write("#define SPH_GROWN 1\n")
            found = abi_text.structs(abi_text.flat(sdk))
            for struct in found.keys() - abi_text.embedded(found):
                abi_text.append(sdk, struct, "double added")


class Rig:
    def __init__(self, scratch):
        self.scratch = scratch
        self.sanitize = []
        probe = os.path.join(scratch, "probe.c")
        with open(probe, "w", encoding="utf-8") as file:
            file.write("int main(void) { return 0; }\n")
        flags = ["-fsanitize=address", "-fno-omit-frame-pointer"]
        done = subprocess.run([*CC, *flags, "-o", probe + ".x", probe], capture_output=True)
        if done.returncode == 0:
            self.sanitize = flags
        else:
            print("no address sanitizer here: sizes are tested by their effects alone")

    def path(self, name):
        return os.path.join(self.scratch, name)

    def compile(self, *arguments):
        build(*CC, "-std=gnu11", "-g", *self.sanitize, *arguments)

    def plugin(self, name, minor, *flags):
        self.compile("-shared", "-fPIC", "-I", self.path(f"sdk{minor}"), *flags, "-o",
                     self.path(name), os.path.join(HERE, "growth/plugin.c"))

    def host(self, name, minor, core):
        flags = ["-I", self.path(f"sdk{minor}"), "-I", core, *CPPFLAGS]
        archive = self.path(name + ".a")
        objects = []
        # Of an archive the linker takes what the registry needs, and leaves the loader of files.
        for source in glob.glob(os.path.join(core, "registry/*.c")) + glob.glob(
                os.path.join(core, "base/*.c")):
            objects.append(self.path(name + "-" + os.path.basename(source) + ".o"))
            self.compile(*flags, "-c", "-o", objects[-1], source)
        build("ar", "crs", archive, *objects)
        self.compile(*flags, "-o", self.path(name), os.path.join(HERE, "growth/host.c"), archive,
                     "-lm", "-ldl", "-lpthread")

    def run(self, host, plugin):
        """Exit status, output, and what the sanitizer said."""
        done = subprocess.run([self.path(host), self.path(plugin)], capture_output=True, text=True)
        return done.returncode, done.stdout, done.stderr


def same_without_numbers(a, b):
    """Two outputs that differ in nothing but the appended members."""
    def strip(text):
        return re.sub(r"(\w+ ?=).*?(?=$|\w+ ?=)", r"\1", text, flags=re.M)
    return strip(a) == strip(b)


def numbers(text):
    """What the host saw in the appended members: all of them."""
    return [float(value) for value in re.findall(r"(?!reach_scale)\b\w+=(\S+)", text)]


def directions(rig):
    bad = []

    def expect(truth, what, *seen):
        if not truth:
            bad.append(what)
            print("NOT SO:", what, *seen, sep="\n  ")

    rig.host("host0", 0, os.path.join(TOP, "core"))
    rig.host("host1", 1, os.path.join(TOP, "core"))
    rig.plugin("old.so", 0)
    rig.plugin("new.so", 1)
    rig.plugin("asks.so", 1, "-DSPH_ABI_WANTED_MINOR=1u")
    seen = {}
    for host in ("host0", "host1"):
        for plugin in ("old.so", "new.so", "asks.so"):
            seen[host, plugin] = rig.run(host, plugin)

    def loads(host, plugin, y):
        code, out, err = seen[host, plugin]
        expect(code == 0 and not err, f"{plugin} loads in {host}", code, out, err)
        expect(f"y = {y}\n" in out, f"{plugin} in {host} gives y = {y}", out)
        expect("reach_scale=1\n" in out, "a member left out has its default", out)
        return out

    # y = 2 x, and where both sides know the appended members: + batch 100 + host 1000 + kernel 0.5
    old_old = loads("host0", "old.so", "2 4 6")
    old_new = loads("host1", "old.so", "2 4 6")
    new_old = loads("host0", "new.so", "2 4 6")
    new_new = loads("host1", "new.so", "1102.5 1104.5 1106.5")
    asks_new = loads("host1", "asks.so", "1102.5 1104.5 1106.5")
    if bad:
        return bad
    expect(not any(numbers(old_old)) and not any(numbers(new_old)),
           "a host of 1.0 sees nothing of 1.1", old_old, new_old)
    expect(not any(numbers(old_new)), "what an old plugin lacks is 0 in a new host", old_new)
    expect(all(numbers(new_new)) and len(numbers(new_new)) > 40,
           "a new host sees every new member of a new plugin", new_new)
    expect(all(" " + word in new_new for word in ("inverse1=19", "sum0=32", "step1=9", "param1=2")),
           "elements of lists have their own numbers", new_new)
    expect(same_without_numbers(old_old, new_new), "nothing else has changed", old_old, new_new)
    expect(new_old.startswith("plugin 1.0:") and new_new.startswith("plugin 1.0:"),
           "by default a plugin asks for the oldest minor", new_old, new_new)
    expect(asks_new.startswith("plugin 1.1:"), "one that asks for 1.1 says so", asks_new)
    code, out, err = seen["host0", "asks.so"]
    expect(code == 3 and not err and "1.1" in out and "1.0" in out and out.count("\n") == 1,
           "a plugin that asks for 1.1 is refused by 1.0 in one sentence", code, out, err)
    print(old_new, new_new, out, sep="")
    return bad


def breaches(rig):
    """Reading beyond the other side's struct is noticed: by a plugin, by a host."""
    bad = []
    rig.plugin("reckless.so", 1, "-DRECKLESS")
    core = rig.path("core")
    abi_text.copy_tree(os.path.join(TOP, "core"), core)
    path = os.path.join(core, "registry/copy.c")
    with open(path, encoding="utf-8") as file:
        text = file.read()
    spoilt = text.replace("memcpy(out, in, size < host ? size : host);", "memcpy(out, in, host);")
    assert spoilt != text, "copy_struct is not what it was: edit this test"
    with open(path, "w", encoding="utf-8") as file:
        file.write(spoilt)
    rig.host("spoilt", 1, core)
    for host, plugin in (("host0", "reckless.so"), ("spoilt", "old.so")):
        code, _, err = rig.run(host, plugin)
        if code == 0 or "AddressSanitizer" not in err:
            bad.append(f"{plugin} in {host}: a breach is not noticed")
            print(bad[-1])
    return bad


def main():
    with tempfile.TemporaryDirectory() as scratch:
        versions(scratch)
        rig = Rig(scratch)
        bad = directions(rig)
        if rig.sanitize:
            bad += breaches(rig)
        return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())

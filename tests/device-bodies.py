"""Bodies of pair functions on an OpenCL device: what sph-plugin-check says of them. Ours and one that uses every
word give the native numbers; each whose text or lists are not those of the native loop is caught; what does
not compile is reported with file and line; and the text that is embedded is that of the file."""
import json
import os
import subprocess
import sys

BUILD = os.environ["top_builddir"]
SOURCE = os.environ["top_srcdir"]
CHECK = os.path.join(BUILD, "sph-plugin-check")
WRONG = os.path.join(BUILD, "tests/check/.libs/wrong_device.so")

WCSPH = {name: ("ok", f'"{file}.body.h" gives the native numbers in 1, 2, 3 dimensions')
         for name, file in (("wcsph-continuity", "continuity"), ("wcsph-momentum", "momentum"),
                            ("wcsph-rates", "continuity"))}
OURS = {"gsph-density": ("ok", '"density.body.h" gives the native numbers in 1, 2, 3 dimensions'),
        "gsph-gradients": ("ok", '"gradients.body.h" gives the native numbers in 1, 2, 3 dimensions'),
        "gsph-rates": ("ok", '"rates.body.h" gives the native numbers in 1, 2, 3 dimensions')}
DIFFER = 'the device body "device.body.h" and the native one differ in '
THEIRS = {"every-word": ("ok", '"device.body.h" gives the native numbers in 1, 2, 3 dimensions'),
          "with-self": ("ok", '"device.body.h" gives the native numbers in 1, 2, 3 dimensions'),
          "other-factor": ("fail", DIFFER + "2 dimensions, 1000 particles, with a kernel of powers: mass of particle 0"),
          "other-reach": ("fail", DIFFER + "3 dimensions, 1000 particles, with a kernel of powers: edges of"),
          "without-self": ("fail", DIFFER + "1 dimension, 1000 particles, with a kernel of powers: mass of"),
          "swapped-values": ("fail", DIFFER + "2 dimensions"),
          "no-maximum": ("fail", DIFFER + "2 dimensions"),
          "no-such-word": ("fail", 'its device body "broken.body.h" does not compile on ')}

missed = 0


def expect(what, good, detail=""):
    global missed
    if not good:
        missed += 1
        print(f"MISS {what}: {detail}")


def verdicts(plugin):
    """{item: [(verdict, text), ...]} of the check `device`."""
    done = subprocess.run([CHECK, "--json", plugin], capture_output=True, text=True, timeout=300)
    found = {}
    for line in json.loads(done.stdout):
        if line["check"] == "device":
            found.setdefault(line["item"], []).append((line["verdict"].lower(), line["text"]))
    return found


def compared():
    """Is there a device?"""
    for plugin, wanted in (("gsph", OURS), ("wcsph", WCSPH), (WRONG, THEIRS)):
        found = verdicts(plugin)
        expect(f"items of {plugin}", set(found) == set(wanted), sorted(found))
        for item, (verdict, words) in wanted.items():
            said = found.get(item, [])
            if len(said) == 1 and "is not compared with the native one: " in said[0][1]:
                expect(item, said[0][0] == "note", said)
                print(said[0][1])
                return False
            expect(item, len(said) == 1 and said[0][0] == verdict and words in said[0][1], said)
            for text in said if item == "no-such-word" else []:
                expect("file and line", "broken.body.h:3" in text[1] and "no_such_word" in text[1], text)
            for text in said if verdict == "ok" else []:
                print(f"{item}: {text[1][text[1].index('apart'):]}")
    return True


def embedded(library, *files):
    with open(library, "rb") as file:
        held = file.read()
    for name in files:
        with open(os.path.join(SOURCE, name), "rb") as file:
            text = file.read()
        expect(f"{name} in {library}", held.count(text + b"\0") >= 1)


embedded(os.path.join(BUILD, "plugins/.libs/gsph.so"), "plugins/gsph/density.body.h",
         "plugins/gsph/gradients.body.h", "plugins/gsph/rates.body.h", "plugins/gsph/rates.macros.h")
embedded(os.path.join(BUILD, "plugins/.libs/wcsph.so"), "plugins/wcsph/continuity.body.h",
         "plugins/wcsph/momentum.body.h")
embedded(WRONG, "tests/check/device.body.h", "tests/check/device.macros.h")
there = compared()
sys.exit(1 if missed else 0 if there else 77)

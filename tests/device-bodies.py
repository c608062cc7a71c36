"""Bodies of pairs and of points on an OpenCL device: what sph-plugin-check says of them. Ours and those that use every
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

GIVES = ' gives the native numbers in 1, 2, 3 dimensions'


def pair(file):
    return ("ok", f'"{file}.body.h"{GIVES}')


def point(file, part):
    return ("ok", f'"{file}.body.h" of {part}{GIVES}')


# What is said of each item, in order.
OURS = {
    "gsph": {"gsph-density": [pair("density"), point("update", "after")],
             "gsph-gradients": [pair("gradients"), point("correct", "after")],
             "gsph-rates": [pair("rates"), point("finish", "after")]},
    "wcsph": {"wcsph-pressure": [point("pressure", "run")],
              "wcsph-continuity": [pair("continuity")],
              "wcsph-momentum": [pair("momentum"), point("finish", "after")],
              "wcsph-rates": [pair("continuity"), point("finish", "after")]},
    "barotropic": {"barotropic-density": [pair("density")],
                   "barotropic-continuity": [pair("continuity")],
                   "barotropic-pressure": [point("pressure", "run")],
                   "barotropic-energy": [point("energy", "run")],
                   "barotropic-momentum": [pair("momentum"), point("finish", "after")]},
    "eos": {"ideal-gas": [point("ideal_gas", "run")], "linear": [point("linear", "run")],
            "tait": [point("tait", "run")]},
    "forces": {"body-force": [point("uniform", "run")], "central-force": [point("central", "run")]},
    "diagnostics": {"nearest": [pair("nearest"), point("finish", "after")]},
}
DIFFER = 'the device body "device.body.h" and the native one differ in '
ALONE = 'the device body "point.body.h" of run and the native one differ in '
THEIRS = {
    "every-word": [pair("device")],
    "with-self": [pair("device")],
    "other-factor": [("fail", DIFFER + "2 dimensions, 1000 particles, with a kernel of powers: mass of particle 0")],
    "other-reach": [("fail", DIFFER + "3 dimensions, 1000 particles, with a kernel of powers: edges of")],
    "without-self": [("fail", DIFFER + "1 dimension, 1000 particles, with a kernel of powers: mass of")],
    "swapped-values": [("fail", DIFFER + "2 dimensions")],
    "no-maximum": [("fail", DIFFER + "2 dimensions")],
    "no-such-word": [("fail", 'its device body "broken.body.h" does not compile on ')],
    "alone-every-word": [point("point", "run")],
    "alone-other-factor": [("fail", ALONE + "2 dimensions, 1000 particles: energy of particle 0")],
    "alone-swapped-values": [("fail", ALONE + "3 dimensions, 1000 particles: pull of particle 0")],
    "alone-failing": [("fail", 'the device body "point.body.h" of run fails where the native one does not: '
                               "wrong-device: nothing is long")],
    "alone-no-such-word": [("fail", "broken.body.h:2: does not compile on ")],
}

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
    for plugin, wanted in (*OURS.items(), (WRONG, THEIRS)):
        found = verdicts(plugin)
        expect(f"items of {plugin}", set(found) == set(wanted), sorted(found))
        for item, lines in wanted.items():
            said = found.get(item, [])
            if said and "is not compared with the native one: " in said[0][1]:
                expect(item, said[0][0] == "note", said)
                print(said[0][1])
                return False
            expect(item, len(said) == len(lines), said)
            for (verdict, text), (wanted_verdict, words) in zip(said, lines):
                expect(item, verdict == wanted_verdict and words in text, said)
                if "no-such-word" in item:
                    expect("file and line", f"broken.body.h:{2 if item.startswith('alone') else 3}" in text and "no_such_word" in text, text)
                if verdict == "ok":
                    print(f"{item}: {text[text.index('apart'):]}")
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
embedded(os.path.join(BUILD, "plugins/.libs/eos.so"), "plugins/eos/tait.body.h")
embedded(WRONG, "tests/check/device.body.h", "tests/check/device.macros.h", "tests/check/point.body.h")
there = compared()
sys.exit(1 if missed else 0 if there else 77)

#!/usr/bin/env python3
"""The tutorial of the SDK, done as a reader would: its files are written, its commands run in their order in an
installed tree, and what it says of their output compared. The files are those of tests/sdk/conduction.

In sdk/tutorial.md: ```sh is run by a shell that goes on from block to block; with status=N its last command must
end so, all others with 0. ```text behind it: each line must be in its output, "..." stands for anything, blanks
count as one. ```LANGUAGE title="FILE" is a piece of FILE; the first one replaces what was there."""
import filecmp
import os
import re
import subprocess
import sys

from staged import staged

source, folder = staged()
block = re.compile(r"^```(\w+)(?: title=\"([^\"]+)\")?(?: status=(\d))?\n(.*?)^```$", re.M | re.S)
with open(os.path.join(source, "sdk", "tutorial.md"), encoding="utf-8") as file:
    text = file.read()

cwd = os.path.join(folder, "tutorial")
os.mkdir(cwd)
output, written, count = "", [], {"sh": 0, "text": 0}


def fail(what, code):
    sys.exit(f"MISS {what}:\n{code}\n-- its output:\n{output}")


def shell(code, expected):
    """Runs a block as one typed line by line: it ends at the first failure, which must be its last command's."""
    global cwd, output
    *before, last = code.strip().split("\n")
    script = "\n".join(["set -e", *before, "set +e", last, "status=$?", "pwd >&3", "exit $status"])
    read, write = os.pipe()
    result = subprocess.run(
        ["bash", "-c", f"exec 3>&{write}\n{script}"],
        cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, pass_fds=[write],
    )
    os.close(write)
    with os.fdopen(read) as pipe:
        left = pipe.read().strip()
    output = result.stdout
    if not left or result.returncode != expected:
        fail(f"exit status {result.returncode}, not {expected}", code)
    cwd = left


def shown(line):
    pattern = r"\s+".join(re.escape(word).replace(r"\.\.\.", ".*") for word in line.split())
    return re.search(pattern, " ".join(output.split()) if "..." not in line else output)


for language, title, status, code in block.findall(text):
    if title:
        path = os.path.join(cwd, title)
        with open(path, "a" if title in written else "w", encoding="utf-8") as file:
            file.write(code)
        if not title in written:
            written.append(title)
    elif language == "sh":
        shell(code, int(status or 0))
        count["sh"] += len(code.strip().split("\n"))
    elif language == "text":
        for line in code.strip().split("\n"):
            if not shown(line):
                fail(f'no line "{line}"', code)
            count["text"] += 1
    else:
        sys.exit(f'MISS a block of "{language}" without title or meaning:\n{code}')
if text.count("\n```") != 2 * len(block.findall(text)):
    sys.exit("MISS a block that this test does not understand")

same = os.path.join(source, "tests", "sdk", "conduction")
for name in written:
    if not filecmp.cmp(os.path.join(cwd, name), os.path.join(same, name), shallow=False):
        sys.exit(f"MISS {name}: not the same in sdk/tutorial.md and in tests/sdk/conduction")
if not written or count["sh"] < 30 or count["text"] < 20:
    sys.exit(f"MISS too little was found: {written}, {count}")
left = [f for _, _, files in os.walk(os.environ["XDG_DATA_HOME"]) for f in files]
if left:
    sys.exit(f"MISS the user's folder still has {left}")
print(f"{count['sh']} commands, {count['text']} lines of output, {len(written)} files")

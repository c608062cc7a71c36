"""The ABI as text, for the tests that freeze it and let it grow: what the SDK's headers declare,
and edits of copies of them.

    abi_text.py freeze SDK FOLDER    writes sph-abi.txt and offsets.def to FOLDER (make update-abi)
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile


def text_of(name, sdk):
    with open(os.path.join(sdk, name), encoding="utf-8") as file:
        return file.read()


def without_comments(text):
    return re.sub(r"/\*.*?\*/", " ", text, flags=re.S)


def flat(sdk, name="sph/plugin.h", seen=None):
    """One C text without comments: the header and all of the SDK that it includes."""
    seen = set() if seen is None else seen
    if name in seen:
        return ""
    seen.add(name)
    lines = []
    for line in without_comments(text_of(name, sdk)).splitlines():
        include = re.match(r"\s*#\s*include\s*<(sph/[^>]*)>", line)
        line = flat(sdk, include[1], seen) if include else line.rstrip()
        if line.strip():
            lines.append(re.sub(r"(\S)\s+\\$", r"\1 \\", line))
    return "\n".join(lines)


def structs(text):
    """{struct: [(member, type as written), ...]} in the order of the text."""
    found = {}
    for name, body in re.findall(r"\bstruct (sph_\w+)\s*\{(.*?)\n\}", text, flags=re.S):
        members = []
        for declaration in filter(str.strip, body.split(";")):
            words = " ".join(declaration.split())
            function = re.match(r"(.*?)\(\*(\w+)\)\(.*\)$", words)
            if function:
                members.append((function[2], words))
                continue
            base = re.match(r"((?:const |struct )*\w+)", words)[1]
            for part in words[len(base):].split(","):
                member = re.search(r"(\w+)\s*(\[\w+\])?$", part)
                members.append((member[1], base + " " + part.strip()))
        found[name] = members
    return found


def embedded(found):
    """The structs that stand by value in others: these can never grow."""
    names = set()
    for members in found.values():
        for _, declared in members:
            words = declared.split()
            if words[0] in found and "*" not in declared:
                names.add(words[0])
    return names


def constants(text, compiler, folder):
    """{macro: its text}: the values a plugin is compiled with. Not those of the build: versions,
    and what a macro with arguments expands to."""
    path = os.path.join(folder, "constants.c")
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    out = subprocess.run([*compiler, "-E", "-dM", path], check=True, capture_output=True, text=True)
    found = dict(re.findall(r"^#define (SPH_\w+) (.*)$", out.stdout, flags=re.M))
    for name in list(found):
        if re.fullmatch(r"SPH_(\w*_H|ABI_(MAJOR|MINOR|WANTED_MINOR)|(BEGIN|END)_DECLS)", name):
            del found[name]
    return found


def table(sdk, compiler, folder):
    """Offsets and sizes of all that crosses the border, on this machine."""
    found = structs(flat(sdk))
    fixed = embedded(found)
    source = os.path.join(folder, "table.c")
    program = os.path.join(folder, "table")
    with open(source, "w", encoding="utf-8") as file:
        file.write("#include <stdio.h>\n#include <sph/plugin.h>\nint main(void)\n{\n")
        for name, members in found.items():
            for member, _ in members:
                file.write(f'printf("AT({name}, {member}, %zu)\\n", offsetof({name}, {member}));\n')
            word = "FIXED" if name in fixed else "GROWS"
            file.write(f'printf("{word}({name}, {members[-1][0]}, %zu)\\n", sizeof({name}));\n')
        file.write("return 0;\n}\n")
    subprocess.run([*compiler, "-I", sdk, "-o", program, source], check=True)
    return subprocess.run([program], check=True, capture_output=True, text=True).stdout


# -- Edits of a copy of the headers --------------------------------------------------------------


def copy_tree(source, to):
    """A copy that may be written to, also of a source that may not."""
    for folder, _, names in os.walk(source):
        target = os.path.join(to, os.path.relpath(folder, source))
        os.makedirs(target, exist_ok=True)
        for name in names:
            shutil.copyfile(os.path.join(folder, name), os.path.join(target, name))


def edit(sdk, struct, change):
    """Rewrites the body of a struct, wherever in the copy `sdk` it stands: change(body) -> body."""
    pattern = re.compile(r"(\bstruct " + struct + r"\s*\{\n)(.*?)(\n\}[^;]*;)", re.S)
    for name in sorted(os.listdir(os.path.join(sdk, "sph"))):
        text = text_of("sph/" + name, sdk)
        match = pattern.search(text)
        if match:
            body = change(match[2])
            assert body != match[2], (struct, "is not changed")
            text = text[:match.start(2)] + body + text[match.end(2):]
            with open(os.path.join(sdk, "sph", name), "w", encoding="utf-8") as file:
                file.write(text)
            return
    raise AssertionError("no struct " + struct)


def append(sdk, struct, declaration):
    edit(sdk, struct, lambda body: f"{body}\n    {declaration};")


def set_version(sdk, major, minor):
    path = os.path.join(sdk, "sph/abi.h")
    text = text_of("sph/abi.h", sdk)
    for word, value in (("MAJOR", major), ("MINOR", minor)):
        text = re.sub(rf"(#define SPH_ABI_{word}) \d+u", rf"\1 {value}u", text)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def freeze(sdk, folder):
    compiler = os.environ.get("CC", "cc").split()
    with open(os.path.join(folder, "sph-abi.txt"), "w", encoding="utf-8") as file:
        file.write(flat(sdk) + "\n")
    with tempfile.TemporaryDirectory() as scratch:
        made = table(sdk, compiler, scratch)
    with open(os.path.join(folder, "offsets.def"), "w", encoding="utf-8") as file:
        file.write("/* Offsets and sizes of the ABI on 64-bit machines, for offsets.c. Made by\n"
                   " * `make update-abi`, never by hand. */\n" + made)


if __name__ == "__main__":
    if len(sys.argv) != 4 or sys.argv[1] != "freeze":
        sys.exit(__doc__)
    freeze(sys.argv[2], sys.argv[3])

#!/usr/bin/env python3
"""The gate of the ABI: today's headers against the frozen ones (frozen/). Members may be appended
to structs, and structs, constants and functions added; whatever else changes fails, in three ways:
by static assertions on offsets, by the values of constants, and by libabigail on types.

The gate is then shown copies of the headers with one edit each: it must let through an appended
member, and stop one that is inserted, removed or re-typed, in every struct that is tried."""
import os
import re
import shutil
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
import abi_text

HERE = os.path.dirname(os.path.abspath(__file__))
SDK = os.path.join(os.environ["top_srcdir"], "sdk")
FROZEN = os.path.join(HERE, "frozen")
CC = os.environ.get("CC", "cc").split()
ABIDIFF = shutil.which("abidiff")

def run(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def first_errors(said):
    lines = [line for line in said.splitlines() if "error" in line]
    return "\n".join(lines[:3]) or said


def cut(text, old):
    """The text with each struct cut off behind the members that it has in `old`. (abidiff has a
    suppression for appended members, but libabigail 2.2 applies it to re-typed ones too.)"""
    for name, members in abi_text.structs(text).items():
        kept = members[:len(old.get(name, members))]
        if len(kept) < len(members):
            body = "".join(f"    {declared};\n" for _, declared in kept)
            text = re.sub(rf"(\bstruct {name}\s*\{{\n).*?\n\}}", rf"\g<1>{body}}}", text,
                          flags=re.S)
    return text


class Gate:
    """The frozen ABI, and what it takes to compare with it."""

    def __init__(self, scratch):
        self.scratch = scratch
        self.text = abi_text.text_of("sph-abi.txt", FROZEN)
        self.structs = abi_text.structs(self.text)
        self.constants = abi_text.constants(self.text, CC, scratch)
        done = self.library("old.so", self.text)
        assert done.returncode == 0, done.stdout

    def path(self, name):
        return os.path.join(self.scratch, name)

    def library(self, name, text):
        """A shared object in which every struct can be reached: a function each hands one out."""
        with open(self.path(name + ".c"), "w", encoding="utf-8") as file:
            file.write(text)
            for struct in self.structs:
                file.write(f"\n{struct} *reach_{struct}(void);\n"
                           f"{struct} *reach_{struct}(void) {{ return 0; }}\n")
        return run(*CC, "-g", "-O0", "-shared", "-fPIC", "-o", self.path(name),
                   self.path(name + ".c"))

    def complaint(self, sdk):
        """What is wrong with the headers in `sdk`, or ""."""
        done = run(*CC, "-I", sdk, "-fsyntax-only", os.path.join(HERE, "offsets.c"))
        if done.returncode:
            return first_errors(done.stdout)
        text = abi_text.flat(sdk)
        new = abi_text.constants(text, CC, self.scratch)
        for name, value in self.constants.items():
            if new.get(name) != value:
                return f"{name} was {value}, is {new.get(name, 'gone')}"
        if not ABIDIFF:
            return ""
        done = self.library("new.so", cut(text, self.structs))
        if done.returncode:
            return first_errors(done.stdout)
        done = run(ABIDIFF, "--harmless", self.path("old.so"), self.path("new.so"))
        return done.stdout.strip() or "abidiff fails" if done.returncode else ""


def append(body):
    return body + "\n    uint64_t appended;"


def insert(body):
    """A member before the second one."""
    first, rest = body.split(";", 1)
    return f"{first};\n    uint64_t inserted;{rest}"


def remove(body):
    """Without the last member; its comment may stay."""
    head, last, tail = re.match(r"(.*;)(.*?);([^;]*)$", body, re.S).groups()
    if "(" not in last and "," in last:
        tail = f"{last[:last.rindex(',')]};{tail}"
    return head + tail


def retype(body):
    """The last member of the first type that is found, given another of the same size."""
    for old, new in (("uint32_t", "float"), ("const char *", "char *"), ("double", "uint64_t")):
        at = body.rfind(f"    {old}")
        if at >= 0:
            return body[:at] + f"    {new}" + body[at + 4 + len(old):]
    raise AssertionError(body)


def edited(scratch, struct, change):
    sdk = os.path.join(scratch, "sdk")
    shutil.rmtree(sdk, ignore_errors=True)
    abi_text.copy_tree(os.path.join(SDK, "sph"), os.path.join(sdk, "sph"))
    # Comments hold commas and semicolons of their own.
    abi_text.edit(sdk, struct, lambda body: change(abi_text.without_comments(body)))
    return sdk


def stops_what_it_should(gate, scratch):
    """The number of edits that are not judged as they should be."""
    found = abi_text.structs(abi_text.flat(SDK))
    fixed = abi_text.embedded(found)
    bad = 0
    for struct in found:
        for what in (append, insert, remove, retype):
            if what is retype and not ABIDIFF:
                continue
            wrong = gate.complaint(edited(scratch, struct, what))
            passes = what is append and struct not in fixed
            if bool(wrong) == passes:
                verdict = "is stopped: " + wrong if wrong else "is let through"
                print(f"{struct}: {what.__name__} {verdict}")
                bad += 1
    others = [("item.h", "SPH_SRC_READ 0x02u", "SPH_SRC_READ 0x80u"),
              ("eos.h", '"sph.eos/0"', '"sph.eos/1"')]
    if ABIDIFF:
        others.append(("batch.h", "(*sph_range_fn)(const sph_batch *)",
                       "(*sph_range_fn)(const sph_batch *, uint32_t)"))
    for name, old, new in others:
        sdk = edited(scratch, "sph_eos", append)
        text = abi_text.text_of("sph/" + name, sdk)
        assert old in text, old
        with open(os.path.join(sdk, "sph", name), "w", encoding="utf-8") as file:
            file.write(text.replace(old, new))
        if not gate.complaint(sdk):
            print(f"{new} in place of {old} is let through")
            bad += 1
    print(f"{len(found)} structs, {len(fixed)} of them fixed for good: {', '.join(sorted(fixed))}")
    return bad


def main():
    if sys.maxsize < 2**32:
        print("what is frozen is the layout of 64-bit machines")
        return 77
    with tempfile.TemporaryDirectory() as scratch:
        gate = Gate(scratch)
        wrong = gate.complaint(SDK)
        if wrong:
            print("today's headers break the frozen ABI:\n" + wrong)
            print("members are only appended; while major is 0 `make update-abi` freezes anew")
            return 1
        frozen = abi_text.text_of("offsets.def", FROZEN)
        if abi_text.table(SDK, CC, scratch) != re.sub(r"/\*.*?\*/\n", "", frozen, flags=re.S):
            print("the ABI has grown: `make update-abi` freezes what is new")
            return 1
        if stops_what_it_should(gate, scratch):
            return 1
    if not ABIDIFF:
        print("no abidiff here (package abigail-tools): types were not compared")
        return 77
    return 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Compares the machine code of sweeps in two builds of the same plugins, function by function: how many
instructions it has, and its loop over pairs. Exits with 1 if these loops together differ by more than 5 %.

    sweep_code.py PLUGINS_A PLUGINS_B ISA"""
import glob
import os
import re
import subprocess
import sys

BAR = 0.05


def functions(path, isa):
    """(name, instructions: (address, text)) of every sweep for an instruction set, by name: compilers put
    those of one object in an order of their own, the linker those of one name in the order of objects."""
    command = ["objdump", "-d", "--no-show-raw-insn", path]
    listing = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    found, inside = [], False
    for line in listing.splitlines():
        head = re.match(r"[0-9a-f]+ <(.+)>:$", line)
        if head:
            inside = re.search(rf"_{isa}_f(64|32)_[123]_[0-4]\b", head[1]) is not None
            if inside:
                found.append((head[1], []))
        elif inside and "\t" in line:
            address, text = line.split("\t", 1)
            # Padding is never executed.
            if not re.match(r"(data16 |cs |xchg +%ax,%ax|nop)", text):
                found[-1][1].append((int(address.strip().rstrip(":"), 16), text))
    return sorted(found, key=lambda one: one[0])


def pair_loop(code):
    """Instructions of the loop over pairs: the one around the distance's square root. Loops within it (a
    kernel's powers, iterations with roots of their own) are part of it; where the root of a pair is begun
    while the pair before it is worked on, so is the loop over spans, in which the first one's stands."""
    place = {address: k for k, (address, _) in enumerate(code)}
    end = {}  # of the loop with this first instruction: a body may jump back from several places
    for k, (address, text) in enumerate(code):
        jump = re.match(r"j\w+\s+([0-9a-f]+)", text)
        target = int(jump[1], 16) if jump else address + 1
        if target <= address and target in place:
            end[place[target]] = k
    roots = [k for k, (_, text) in enumerate(code) if re.match(r"v?r?sqrt", text)]
    around = [[last - first + 1 for first, last in end.items() if first <= k <= last] for k in roots]
    return max((min(lengths) for lengths in around if lengths), default=0)


def percent(a, b):
    return f"{a:5} {b:5} {100 * (a / b - 1) if b else 0:+7.2f} %"


def main():
    one, other, isa = sys.argv[1:4]
    total = [0, 0]
    for path in sorted(glob.glob(os.path.join(one, "*.so"))):
        name = os.path.basename(path)
        mine, theirs = functions(path, isa), functions(os.path.join(other, name), isa)
        if [f[0] for f in mine] != [f[0] for f in theirs]:
            sys.exit(f"{name}: other functions")
        for k, ((symbol, a), (_, b)) in enumerate(zip(mine, theirs)):
            loops = pair_loop(a), pair_loop(b)
            total = [total[0] + loops[0], total[1] + loops[1]]
            print(f"{f'{name} {k} {symbol}':34} all {percent(len(a), len(b))}   pair loop {percent(*loops)}")
    if not total[1]:
        sys.exit(f"no sweep for {isa}")
    miss = abs(total[0] - total[1]) > BAR * total[1]
    print(f"{'pair loops together':34}{'':37}{percent(*total)}{'  MISS' if miss else ''}")
    sys.exit(miss)


main()

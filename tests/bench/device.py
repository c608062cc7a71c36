#!/usr/bin/env python3
"""Whole runs on an OpenCL device. Where that is the processor (PoCL) beside native runs on the same cores: whole steps,
sweeps, lists; functions of three plugins, which share a sweep there; what it takes to compile. On a GPU (--gpu):
large runs, what they reach of its limits, where their time goes.

    device.py [--device opencl:N] [--rounds N] [--threads N] [--only WORD] [--short]
    device.py --gpu [--device opencl:N] [--short]

All runs of a scene take their turn in every round; of each the one with the shortest loop is shown. --only takes part
of a name (wcsph-3d, wcsph-2d, gsph-2d, gsph-3d, plugins, compile). Always ends with 0: figures that have a bar say
OK or MISS. Exit status 77 without a device."""
import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time

from step import cases, water
from step_run import BUILD, Program

PRECISIONS = ("double", "mixed")
STEP_BAR, SWEEP_BAR = 1.4, 1.2  # times the native
COLD_BAR, WARM_BAR = 10.0, 1.0  # seconds


def say(name, what, value, bar, less=True):
    good = value <= bar if less else value >= bar
    print(f"  {'OK  ' if good else 'MISS'} {name}: {what} {value:.3f} ({'<=' if less else '>='} {bar:g})")


# -- Beside native runs ------------------------------------------------------------------------------------


def best_of(program, rounds, runs):
    """{key: (scene, options)}, in turn; of each the summary with the shortest loop, and apart from it the least of
    each part of the time, as company disturbs them one by one."""
    best = {}
    for _ in range(rounds):
        for key, (scene, options) in runs.items():
            summary = program.run(scene, *options)
            parts = parts_of(summary)
            if key not in best:
                best[key] = [summary, parts]
                continue
            if summary["cost"]["loop_s"] < best[key][0]["cost"]["loop_s"]:
                best[key][0] = summary
            best[key][1] = {name: min(value, parts[name]) for name, value in best[key][1].items()}
    return best


def parts_of(summary):
    """Seconds of a run's parts."""
    cost = summary["cost"]
    sweeps = sum(seconds for name, seconds in cost["pass_s"].items() if cost["pass_pairs"][name])
    points = sum(cost["pass_s"].values()) - sweeps
    parts = {
        "whole": cost["loop_s"],
        "pair sweeps": sweeps,
        "point passes": points,
        "lists, sorting, ghosts": cost["neighbour_s"],
        "integration": cost["integrate_s"],
    }
    parts["rest"] = cost["loop_s"] - sum(value for name, value in parts.items() if name != "whole")
    return parts


def beside(program, a, name, scene, steps):
    runs = {}
    for precision in PRECISIONS:
        options = ["--precision", precision, "--threads", str(a.threads), "--steps", str(steps)]
        runs[precision, "native"] = (scene, options)
        runs[precision, "device"] = (scene, [*options, "--device", a.device, "--device-only"])
    best = best_of(program, a.rounds, runs)
    n = sum(best["double", "native"][0]["particles"].values())
    print(f"\n{name}: {scene['title']}, {n} particles, {steps} steps, {a.threads} thread(s); seconds")
    print(f"  {'':26s}" + "".join(f"{p + ' ' + w:>15s}" for p, w in runs))
    for part in best["double", "native"][1]:
        print(f"  {part:26s}" + "".join(f"{best[key][1][part]:15.4g}" for key in runs))
    print(f"  {'ns / pair':26s}" + "".join(f"{best[key][0]['cost']['ns_per_pair']:15.4g}" for key in runs))
    for precision in PRECISIONS:
        here, there = best[precision, "device"][1], best[precision, "native"][1]
        for what, part, bar in (("whole step", "whole", STEP_BAR), ("pair sweeps", "pair sweeps", SWEEP_BAR)):
            say(name, f"{precision}, {what} / native", here[part] / there[part], bar)
        lists = here["lists, sorting, ghosts"] / there["lists, sorting, ghosts"]
        print(f"       {name}: {precision}, lists, sorting, ghosts / native {lists:.3f}")


def plugins(program, a):
    """Pair functions of three plugins: three sweeps natively, one there."""
    scene = water(3, 16 if a.short else 48)
    plugin = os.path.join(os.path.abspath(BUILD), "tests", "bench", ".libs", "xsph_plugin.so")
    if not os.path.exists(plugin):
        sys.exit(f"{plugin}: not there: make tests/bench/xsph_plugin.la")
    scene["plugins"] += ["diagnostics", plugin]
    scene["scheme"]["edit"] = [{"insert": "nearest"}, {"insert": "xsph"}]
    steps = "20"
    runs = {}
    for precision in PRECISIONS:
        options = ["--precision", precision, "--threads", str(a.threads), "--steps", steps]
        runs[precision, "native"] = (scene, options)
        runs[precision, "device"] = (scene, [*options, "--device", a.device, "--device-only"])
    best = best_of(program, a.rounds, runs)
    print(f"\nplugins: {sum(best['double', 'native'][0]['particles'].values())} particles, pair functions of three "
          "plugins")
    for precision in PRECISIONS:
        native, device = best[precision, "native"], best[precision, "device"]
        sweeping = [s for s in device[0]["device"]["stages"] if s["pairs"]]
        passes = [name for name, pairs in native[0]["cost"]["pass_pairs"].items() if pairs]
        print(f"  {precision}: natively {len(passes)} sweeps an evaluation ({', '.join(passes)}), "
              f"{native[1]['pair sweeps']:.3g} s; on the device {len(sweeping)}, {device[1]['pair sweeps']:.3g} s")
        say("plugins", f"{precision}, pair time / native", device[1]["pair sweeps"] / native[1]["pair sweeps"], 1.0)


# -- Compiling ---------------------------------------------------------------------------------------------


def seconds_to_first_step(program, scene, *options):
    """From the start of the process to the end of a run of one step; the processor's, which company disturbs less;
    and the summary. Writing, and the measurement of the device where it is new, come after the step."""

    def processor():
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime

    begin, before = time.monotonic(), processor()
    summary = program.run(scene, "--steps", "1", *options)
    return time.monotonic() - begin, processor() - before, summary


def compiling(program, a):
    noh = program.example("noh.json")
    noh["output"] = {"picture": False}
    on = ("--device", a.device, "--device-only", "--precision")
    print("\ncompile: Noh, a run of one step")
    for precision in PRECISIONS:
        cold, work, warm, native = [], [], [], []
        for round in range(a.rounds):
            folder = os.path.join(program.scratch, f"cache-{precision}-{round}")
            kept = dict(program.env)
            program.env["SPH_CACHE_DIR"] = os.path.join(folder, "sph")
            program.env["POCL_CACHE_DIR"] = os.path.join(folder, "pocl")
            os.makedirs(program.env["POCL_CACHE_DIR"])
            _, used, summary = seconds_to_first_step(program, noh, *on, precision)
            cold.append(summary["device"]["build_s"])
            work.append(used)
            built = summary["device"]["programs_built"]
            for _ in range(3):
                warm.append(seconds_to_first_step(program, noh, *on, precision)[0])
                native.append(seconds_to_first_step(program, noh, "--precision", precision)[0])
            program.env = kept
        say("compile", f"{precision}, {built} programs, caches empty, seconds", min(cold), COLD_BAR)
        print(f"       the processor's, of the whole run: {min(work):.3f}")
        say("compile", f"{precision}, from the cache, seconds beyond a native run", min(warm) - min(native), WARM_BAR)


# -- A GPU ---------------------------------------------------------------------------------------------------


def cube(side):
    """A periodic box of water, uniform but for a jitter."""
    scene = water(3, side)
    scene["title"] = f"periodic box, {side}^3"
    scene["domain"]["sides"] = {axis: "periodic" for axis in "xyz"}
    return scene


def noh_3d(program, side):
    noh = program.example("noh-3d.json")
    noh["output"] = {"picture": False, "log": {"steps": 10}}
    fill = noh["particles"]["fluid"]["fill"]
    fill.update({"lattice": "cubic", "spacing": 2 * noh["domain"]["max"][0] / side if "domain" in noh else 2 / side})
    return noh


def report(summary):
    device, cost = summary["device"], summary["cost"]
    n = sum(summary["particles"].values())
    sweeps = device["sweeps"]
    updates = cost["particle_updates"] / cost["loop_s"]
    print(f"    {cost['loop_s']:.3g} s for {summary['steps']} steps, {n} particles: {updates / 1e6:.4g} M particle updates/s; "
          f"{device['bytes_most'] / 1e9:.3g} GB there, programs {device['build_s']:.3g} s")
    percent = [100 * (sweeps[key] or 0) for key in ("share_of_rate", "share_of_bandwidth")]
    print(f"    sweeps: {sweeps['ns_per_pair']:.4g} ns/pair, {percent[0]:.1f} % of the rate, {percent[1]:.1f} % of the "
          f"bandwidth; whole loop {1e9 * cost['loop_s'] / cost['pairs']:.4g} ns/pair; the device busy "
          f"{100 * device['busy_s'] / cost['loop_s']:.0f} % of the loop")
    for stage in device["stages"]:
        if stage["seconds"] > 0.01 * cost["loop_s"] and stage["pairs"]:
            print(f"      {'+'.join(stage['passes']):44s} {stage['ns_per_pair']:8.4f} ns/pair "
                  f"{stage['flops_per_s'] / 1e9:9.1f} Gflop/s {stage['bytes_per_s'] / 1e9:8.1f} GB/s  {stage.get('limit', '')}")
    for kernel in device["kernels"][:12]:
        print(f"      {kernel['name']:44s} {kernel['seconds']:8.3f} s {100 * kernel['share']:5.1f} % "
              f"{kernel['launches']:7d} launches")
    for name, moved in device["transfers"].items():
        print(f"      {name:44s} {moved['seconds']:8.3f} s {moved['bytes'] / 1e6:10.2f} MB {moved['count']:7d} times")


def memory_of(a):
    """Bytes of the device, as `sph info --devices` tells them."""
    done = subprocess.run([a.sph, "info", "--devices"], capture_output=True, text=True)
    print(done.stdout.rstrip())
    number = int(a.device.partition(":")[2] or 0)
    lines = [line for line in done.stdout.splitlines() if "GB" in line or "GiB" in line]
    try:
        words = lines[number].replace(",", " ").split()
        at = next(k for k, word in enumerate(words) if word in ("GB", "GiB"))
        return float(words[at - 1]) * (1e9 if words[at] == "GB" else 2**30)
    except (IndexError, StopIteration, ValueError):
        return float("inf")


def gpu(program, a):
    memory = memory_of(a)
    #       name, scene, particles, steps, whether the processor does the same
    if a.short:
        runs = [("noh-3d", noh_3d(program, 24), 24**3, 4, True), ("box", cube(20), 20**3, 4, True),
                ("box", cube(32), 32**3, 2, False)]
    else:
        runs = [("noh-3d", noh_3d(program, 100), 100**3, 20, True), ("box", cube(100), 100**3, 20, True),
                ("noh-3d", noh_3d(program, 200), 200**3, 10, False), ("box", cube(200), 200**3, 10, False)]
    begin = time.monotonic()
    for name, scene, n, steps, reference in runs:
        if n * 1000 > memory:
            print(f"\n{name}, {n} particles: need more than the device's {memory / 1e9:.3g} GB")
            continue
        print(f"\n{name}: {scene['title']}, {n} particles")
        for precision in PRECISIONS:
            options = ["--precision", precision, "--steps", str(steps)]
            summary = program.run(scene, *options, "--device", a.device, "--device-only")
            print(f"  {precision} [{time.monotonic() - begin:.0f} s]")
            report(summary)
            if reference and precision == "double":
                native = program.run(scene, "--precision", precision, "--steps", str(min(steps, 3)))
                each = [s["cost"]["loop_s"] / s["cost"]["particle_updates"] for s in (native, summary)]
                print(f"    the processor, {native['cost']['threads']} threads: {native['cost']['ns_per_pair']:.4g} ns/pair, "
                      f"{1e-6 / each[0]:.4g} M particle updates/s; the device is {each[0] / each[1]:.1f} times as fast")
                drift = [s["conservation"]["energy_drift"] for s in (native, summary)]
                print(f"    energy drift {drift[1]:.2e}, of the processor's run of {native['steps']} steps {drift[0]:.2e}")


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--device", default="opencl")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--only", default="")
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--gpu", action="store_true")
    a = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        program = Program(scratch)
        a.sph = program.sph
        program.env.update(POCL_MAX_PTHREAD_COUNT=str(a.threads), POCL_MAX_COMPUTE_UNITS=str(a.threads))
        done = subprocess.run([a.sph, "info", "--devices"], capture_output=True, text=True)
        if done.returncode or "No OpenCL device" in done.stdout:
            print("no OpenCL device here")
            return 77
        if a.gpu:
            gpu(program, a)
            return 0
        for name, (scene, steps) in cases(program, a.short).items():
            if a.only in name:
                beside(program, a, name, scene, steps)
        if a.only in "plugins":
            plugins(program, a)
        if a.only in "compile":
            compiling(program, a)
    return 0


if __name__ == "__main__":
    sys.exit(main())

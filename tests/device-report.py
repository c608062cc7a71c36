"""What a run on an OpenCL device says of its cost: "device" and "cost" of summary.json agree with each other, with
the processor's pairs, and with the plan; the table at the end; `sph plan` with stages and kernels. Of times only what
holds on a busy machine is asked."""
import json

from boxes import box
from scenes import Scenes, changed, example

scenes = Scenes()
expect = scenes.expect
ON = ("--device", "opencl", "--device-only")

scenes.need_device()

noh = example("noh.json")
noh["particles"]["fluid"]["fill"]["spacing"] = 0.02
noh["output"] = {"picture": False, "log": {"steps": 10}}
water = box(2, 60, "wcsph", {"x": "periodic", "y": "mirror"})
CASES = {
    "noh": noh,
    "water": water,
    "two schemes' functions": changed(
        water, scheme={"name": "wcsph", "edit": [{"insert": "body-force", "gy": -1}, {"insert": "nearest"}]}
    ),
    "a step a kernel": changed(water, scheme={"name": "wcsph", "fuse": False}),
}
STEPS = ("--steps", "20")


def near(what, a, b, tolerance):
    expect(what, abs(a - b) <= tolerance * abs(b), f"{a} and {b}")


def plan_of(scene, *options):
    done = scenes.command("plan", scenes.write(scene), "--json", *options)
    expect("plan", done.returncode == 0, done.stderr)
    return json.loads(done.stdout)


def consistent(name, scene, precision):
    name = f"{name}, {precision}"
    here = scenes.good(scene, "--precision", precision, *STEPS, *ON).summary()
    there = scenes.good(scene, "--precision", precision, *STEPS).summary()
    device, cost = here["device"], here["cost"]
    expect(f"{name}: only of a device", "device" not in there and "pass_in" not in there["cost"])
    for key in ("name", "platform", "driver", "type"):
        expect(f"{name}: {key}", isinstance(device[key], str) and device[key])
    expect(f"{name}: programs", device["programs_built"] + device["programs_from_cache"] >= 4, device)
    expect(f"{name}: build", 0 < device["build_s"] < cost["wall_s"], device["build_s"])
    expect(f"{name}: bytes", device["bytes_most"] > 0)

    # Kernels: all of the device's time, and no more than there was.
    kernels = {one["name"]: one for one in device["kernels"]}
    busy = sum(one["seconds"] for one in device["kernels"])
    expect(f"{name}: kernels within the loop", busy <= 1.02 * cost["loop_s"], (busy, cost["loop_s"]))
    near(f"{name}: shares of kernels", sum(one["share"] for one in device["kernels"]), 1, 1e-9)
    near(f"{name}: busy", busy + sum(one["seconds"] for one in device["transfers"].values()), device["busy_s"], 1e-9)
    expect(f"{name}: kernels by time",
           [one["seconds"] for one in device["kernels"]] == sorted((one["seconds"] for one in device["kernels"]), reverse=True))
    for what in ("neighbour lists", "integrate"):
        expect(f"{name}: {what}", kernels[what]["launches"] > 0 and kernels[what]["seconds"] > 0)
    columns = sum(one["bytes_per_particle"] for one in here["plan"]["arrays"].values())
    written = device["transfers"]["write"]
    most = 3 * columns * sum(here["particles"].values())
    expect(f"{name}: columns go there once", 0 < written["bytes"] < most, (written["bytes"], most))

    # Stages: the plan's, and their kernels' time.
    stages = device["stages"]
    plan = plan_of(scene, "--precision", precision, "--device", "opencl")["device"]
    expect(f"{name}: the plan's stages", [s["passes"] for s in plan["stages"]] == [s["passes"] for s in stages])
    expect(f"{name}: every pass in one stage",
           sorted(p for s in stages for p in s["passes"]) == sorted(p["name"] for p in here["plan"]["passes"]))
    for label in {"+".join(s["passes"]) for s in stages}:
        near(f"{name}: time of {label}", sum(s["seconds"] for s in stages if "+".join(s["passes"]) == label),
             kernels[label]["seconds"], 1e-9)
    sweeping = [s for s in stages if s["pairs"]]
    for s in sweeping:
        label = "+".join(s["passes"])
        near(f"{name}: ns per pair of {label}", s["ns_per_pair"], 1e9 * s["seconds"] / s["pairs"], 1e-9)
        near(f"{name}: operations of {label}", s["flops_per_pair"] * s["pairs"], s["flops_per_s"] * s["seconds"], 1e-9)
        expect(f"{name}: operations of a pair of {label}", 5 < s["flops_per_pair"] < 1000, s["flops_per_pair"])
        expect(f"{name}: sums of {label}", s["sums_in"] == ("floats" if precision == "mixed" else "doubles"))
        for share in ("share_of_rate", "share_of_bandwidth"):
            expect(f"{name}: {share} of {label}", 0 < s[share] <= 1.2, s[share])
        expect(f"{name}: limit of {label}",
               s["limit"] == ("rate" if s["share_of_rate"] > s["share_of_bandwidth"] else "bandwidth"))
    total = device["sweeps"]
    expect(f"{name}: all pairs", total["pairs"] == sum(s["pairs"] for s in sweeping) == cost["pairs"])
    near(f"{name}: all seconds", total["seconds"], sum(s["seconds"] for s in sweeping), 1e-9)

    # Costs: a stage's time stands with its first pass that sweeps.
    passes, shared = cost["pass_s"], cost["pass_in"]
    for s in stages:
        timed = [p for p in s["passes"] if p not in shared]
        expect(f"{name}: one pass has the time of {s['passes']}", len(timed) >= 1)
        for p in s["passes"]:
            expect(f"{name}: time of {p}", (passes[p] == 0) == (p in shared), passes[p])
            expect(f"{name}: shared time of {p}", p not in shared or shared[p] in s["passes"])
    near(f"{name}: ns per pair", cost["ns_per_pair"],
         1e9 * sum(passes[p] for p, n in cost["pass_pairs"].items() if n) / cost["pairs"], 1e-9)
    parts = sum(passes.values()) + cost["neighbour_s"] + cost["integrate_s"]
    expect(f"{name}: parts within the loop", parts <= 1.02 * cost["loop_s"], (parts, cost["loop_s"]))
    expect(f"{name}: lists, integration", cost["neighbour_s"] > 0 and cost["integrate_s"] > 0)
    for p, n in there["cost"]["pass_pairs"].items():
        near(f"{name}: pairs of {p}", cost["pass_pairs"][p], n, 0.01)
    memory = cost["memory_per_particle"]
    expect(f"{name}: memory", memory["lists"] > 0 and memory["places"] > 0, memory)
    return device


for name, scene in CASES.items():
    for precision in ("double", "mixed"):
        consistent(name, scene, precision)

# Functions of two plugins share one sweep, unless the scene forbids it.
together = consistent("together", CASES["two schemes' functions"], "double")["stages"]
apart = consistent("apart", changed(CASES["two schemes' functions"], scheme={
    **CASES["two schemes' functions"]["scheme"], "fuse": False}), "double")["stages"]
expect("fewer sweeps together", sum(s["sweeps"] for s in together if s["pairs"]) < sum(s["sweeps"] for s in apart if s["pairs"]))

# From the cache nothing is built.
again = scenes.good(noh, *STEPS, *ON).summary()["device"]
again = scenes.good(noh, *STEPS, *ON).summary()["device"]
expect("programs of the cache", again["programs_built"] == 0 and again["programs_from_cache"] >= 4, again["programs_built"])

# Costs of a run that goes on are those of all of it.
scene = changed(water, output={"picture": False, "checkpoint": {"steps": 10, "keep": 9}})
first = scenes.good(scene, "--steps", "20", *ON)
before = first.summary()["cost"]
done = scenes.command("--resume", first.path("checkpoint_00000020.h5"), "--steps", "22", "--quiet", *ON)
expect("goes on", done.returncode == 0, done.stderr)
after = first.summary()["cost"]
for key in ("neighbour_s", "integrate_s", "pairs"):
    expect(f"{key} of the whole run", before[key] * 0.9 < after[key], (before[key], after[key]))
for p, seconds in before["pass_s"].items():
    expect(f"seconds of {p} of the whole run", 0.9 * seconds <= after["pass_s"][p], (seconds, after["pass_s"][p]))

# The table.
out = scenes.run(noh, *STEPS, *ON, quiet=False).stdout
expect("table", "\ndevice " in out and "% of its rate" in out and max(map(len, out[out.index("device") :].splitlines())) <= 80, out)

# The plan in words, and kernels.
path = scenes.write(CASES["two schemes' functions"])
text = scenes.command("plan", path, "--device", "opencl").stdout
expect("plan in words", "one sweep for all over fluid, in floats" in text and "\ntransfers\n" in text, text)
expect("width of the plan", max(map(len, text[text.index("device opencl") :].splitlines())) <= 80, text)
expect("no stages on the processor", "transfers" not in scenes.command("plan", path).stdout)
for form, word in (("", "f64x8"), ("=gpu", "get_global_id(0)")):
    done = scenes.command("plan", path, "--device", "opencl", f"--kernels{form}")
    expect(f"kernels{form}", done.returncode == 0 and "__kernel void stage_0(" in done.stdout and word in done.stdout)
    expect(f"bodies of kernels{form}", "body.h" in done.stdout)
for options, said in (
    (("--kernels",), "--device opencl"),
    (("--device", "opencl", "--kernels=fpga"), "neither cpu nor gpu"),
):
    done = scenes.command("plan", path, *options)
    expect(f"{options}", done.returncode == 2 and said in done.stderr, done.stderr)

scenes.end()

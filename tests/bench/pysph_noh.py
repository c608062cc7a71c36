#!/usr/bin/env python3
"""Noh's implosion, 100 x 100 particles to t = .6, by PySPH's GSPH and by sph, in one run: the cost of a
particle's update, their ratio, and the errors. By hand only; about ten minutes, or less:

    pysph_noh.py [--until .1] [--solver N] [--threads 1,2] [--python /usr/bin/python3] [--report FILE]

PySPH runs its own example as it ships it, in Cython on one core; timed is its loop over the steps:
neither imports nor the compilation of its equations. Now and then it is stopped for a run of sph, so that
both see the same machine. Of sph the whole process is timed, start, loop, snapshots and picture, and the
median counts. PySPH's other Riemann solvers: with van Leer's (--solver 1) particles clump, with the exact
one (2) and HLLC (3) it fails."""
import argparse
import json
import os
import resource
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
TOP = os.environ.get("top_srcdir", os.path.join(HERE, "..", ".."))
SCENE = os.path.join(TOP, "examples", "noh.json")
END = 0.6


def peer(out, until, solver):
    """In PySPH's interpreter: runs the example, prints one line of JSON."""
    import contextlib

    import numpy
    from pysph.base.nnps import LinkedListNNPS
    from pysph.examples.gas_dynamics.noh import NohImplosion
    from cyarray.api import UIntArray

    def neighbours(fluid):
        """The mean number of particles, ghosts included, in a kernel's reach: 3 h of a Gaussian."""
        search = LinkedListNNPS(dim=2, particles=[fluid], radius_scale=3.0)
        found, total = UIntArray(), 0
        real = fluid.get_number_of_particles(real=True)
        for i in range(real):
            search.get_nearest_particles(0, 0, i, found)
            total += found.length
        return total / real

    out_file = sys.stdout
    with contextlib.redirect_stdout(sys.stderr):
        app = NohImplosion(fname="noh", output_dir=out)
        app.setup(
            ["--scheme", "gsph", "--rsolver", str(solver), "--no-openmp", "-q", "--tf", str(until)]
        )
        fluid = app.particles[0]
        at_start = neighbours(fluid)
        print("solving", file=out_file, flush=True)
        wall, cpu = time.perf_counter(), time.process_time()
        app.solver.solve(show_progress=False)
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    n = fluid.get_number_of_particles(real=True)
    x, y, rho, m = (fluid.get(name)[:n] for name in ("x", "y", "rho", "m"))
    r = numpy.hypot(x, y)
    t = app.solver.t
    volume = m / rho
    exact = numpy.where(r < t / 3, 16, 1 + t / numpy.maximum(r, 1e-9))
    near = r < 0.45
    error = (volume * abs(rho - exact))[near].sum()
    print(
        json.dumps(
            {
                "particles": int(n),
                "steps": int(app.solver.count),
                "time": float(t),
                "wall": wall,
                "cpu": cpu,
                "neighbours": [at_start, neighbours(fluid)],
                "plateau": float(rho[(r > 0.05) & (r < 0.15)].mean()),
                "centre": float(rho[r < 0.03].mean()),
                "l1": float(error / volume[near].sum()),
                "l1_rel": float(error / (volume * exact)[near].sum()),
                "finite": bool(numpy.isfinite(rho).all()),
            }
        )
    )


def run_peer(options, scratch, between):
    """Runs peer() in PySPH's interpreter, with one thread whatever the libraries would like. Now and then it
    is stopped, and between() is called: both see the same machine, whatever else it does meanwhile."""
    environment = dict(os.environ, OMP_NUM_THREADS="1", PYTHONDONTWRITEBYTECODE="1")
    command = [options.python, os.path.abspath(__file__), "--peer", scratch]
    command += ["--until", str(options.until), "--solver", str(options.solver)]
    stopped = 0.0
    with open(os.path.join(scratch, "said"), "w+") as said:
        # Its example and compyle write where they stand.
        child = subprocess.Popen(
            command, cwd=scratch, env=environment, stdout=subprocess.PIPE, stderr=said, text=True
        )
        try:
            while child.stdout.readline() not in ("solving\n", ""):
                pass
            while True:
                try:
                    rest, _ = child.communicate(timeout=options.every)
                    break
                except subprocess.TimeoutExpired:
                    child.send_signal(signal.SIGSTOP)
                    since = time.perf_counter()
                    between()
                    stopped += time.perf_counter() - since
                    child.send_signal(signal.SIGCONT)
        finally:
            # A stopped one dies, too.
            child.kill()
        said.seek(0)
        if child.returncode != 0:
            sys.exit(f"PySPH failed ({child.returncode}):\n{said.read()[-600:]}")
    result = json.loads(rest.splitlines()[-1])
    result["wall"] -= stopped
    return result


def run_sph(options, scratch, threads):
    """Runs sph once; its summary, with the time of the whole process."""
    out = os.path.join(scratch, "sph")
    command = [options.sph, "run", SCENE, "--out", out, "--quiet", "--threads", str(threads)]
    if options.until != END:
        command += ["--set", f"time.end={options.until}"]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    wall = time.perf_counter()
    subprocess.run(command, check=True)
    wall = time.perf_counter() - wall
    # Children that have ended: not the peer.
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(os.path.join(out, "summary.json")) as file:
        summary = json.load(file)
    summary["wall"] = wall
    summary["cpu"] = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return summary


def say(report, text=""):
    for file in (sys.stdout, report):
        if file:
            print(text, file=file, flush=True)


def row(tell, name, particles, steps, wall, cpu):
    each = 1e6 / (particles * steps)
    tell(f"{name:24}{steps:6}{wall:11.2f}{cpu:11.2f}{wall * each:14.3f}{cpu * each:14.3f}")


def named(threads):
    return f"{threads} thread{'s' if threads > 1 else ''}"


def context(tell, whole, pysph, sph):
    """What the particles' time bought."""
    cost = sph["cost"]
    pairs = cost["pairs"] / cost["particle_updates"]
    start, end = pysph["neighbours"]
    tell(f"neighbours: PySPH {start:.0f} at the start, {end:.0f} at the end, ghosts included")
    tell(f"interactions of an update, all passes and iterations for h: sph {pairs:.0f}")
    if not whole:
        tell("(errors only at t = .6)")
        return
    error = sph["errors"]["fluid.rho"]
    probe = {name: value["value"] for name, value in sph["probes"].items()}
    tell(f"{'at t = .6':40}{'PySPH':>10}{'sph':>10}")
    tell(f"{'density of the plateau (16)':40}{pysph['plateau']:10.3f}{probe['plateau density']:10.3f}")
    tell(f"{'density at the centre (16)':40}{pysph['centre']:10.3f}{probe['density at the centre']:10.3f}")
    tell(f"{'l1 of density, r < .45':40}{pysph['l1']:10.4f}{error['l1']:10.4f}")
    tell(f"{'l1_rel of density, r < .45':40}{pysph['l1_rel']:10.4f}{error['l1_rel']:10.4f}")


def compare(options):
    with tempfile.TemporaryDirectory() as scratch:
        report = open(options.report, "w") if options.report else None
        threads = [int(word) for word in options.threads.split(",")]
        runs = {count: [] for count in threads}

        def median(count, what):
            return statistics.median(run[what] for run in runs[count])

        def tell(text=""):
            say(report, text)

        def runs_of_sph():
            for count in threads:
                runs[count].append(run_sph(options, scratch, count))

        runs_of_sph()
        pysph = run_peer(options, scratch, runs_of_sph)
        runs_of_sph()
        if not pysph["finite"]:
            sys.exit("PySPH's densities are not finite: try another --solver")

        tell(f"Noh's implosion, {pysph['particles']} particles, to t = {options.until:g}")
        tell(f"{'':24}{'steps':>6}{'wall s':>11}{'CPU s':>11}{'wall us/upd.':>14}{'CPU us/upd.':>14}")
        row(tell, "PySPH GSPH, one core", pysph["particles"], pysph["steps"], pysph["wall"], pysph["cpu"])
        for count in threads:
            n, steps = runs[count][0]["particles"]["fluid"], runs[count][0]["steps"]
            row(tell, f"sph gsph, {named(count)}", n, steps, median(count, "wall"), median(count, "cpu"))
            loop = statistics.median(run["cost"]["us_per_particle_update"] for run in runs[count])
            tell(f"{'    its loop alone':41}{'':11}{loop:14.3f}")
        theirs = pysph["particles"] * pysph["steps"]
        for count in threads:
            ours = runs[count][0]["cost"]["particle_updates"]
            wall, cpu = median(count, "wall"), median(count, "cpu")
            tell(
                f"PySPH / sph with {named(count)}: an update {pysph['wall'] / theirs * ours / wall:.1f} (wall), "
                f"{pysph['cpu'] / theirs * ours / cpu:.1f} (CPU); the run {pysph['wall'] / wall:.1f} (wall)"
            )
        context(tell, options.until == END, pysph, runs[threads[0]][0])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--until", type=float, default=END, help="end both at this time (.6)")
    parser.add_argument("--solver", type=int, default=7, help="PySPH's Riemann solver (7)")
    parser.add_argument("--threads", default="1,2", help="of sph (1,2)")
    parser.add_argument("--every", type=float, default=60, help="seconds of PySPH between runs of sph (60)")
    parser.add_argument("--sph", default=os.environ.get("SPH", "sph"))
    parser.add_argument("--python", default="/usr/bin/python3", help="an interpreter with PySPH")
    parser.add_argument("--report", help="a file for what is printed")
    parser.add_argument("--peer", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.peer:
        peer(options.peer, options.until, options.solver)
        return
    has = [options.python, "-c", "import pysph.examples.gas_dynamics.noh"]
    try:
        found = subprocess.run(has, capture_output=True, text=True)
        lack = found.stderr.strip().splitlines()[-1] if found.returncode else None
    except OSError as error:
        lack = str(error)
    if lack:
        print(f"no PySPH for {options.python} (Debian: python3-pysph): {lack}")
        sys.exit(77)
    if not shutil.which(options.sph):
        parser.error(f"no program {options.sph}: set SPH, or give --sph")
    compare(options)


if __name__ == "__main__":
    main()

"""What precision gives and costs: errors against exact solutions, drift, how far a run ends from the same in
long double; against the time of a particle's update. A table, a CSV file and a chart."""
import csv
import math
import os
import sys

from step_run import BUILD, SOURCE

PRECISIONS = ("double", "mixed", "single")
COLOURS = {"double": "#3b528b", "mixed": "#21918c", "single": "#d1495b"}
MARKS = "osd^"


def cases(program, short):
    """Name: scene, with its time."""
    sod, noh = program.example("sod.json"), program.example("noh.json")
    noh["particles"]["fluid"]["fill"]["spacing"] = 0.1 if short else 0.05
    noh.pop("probes")
    vortex = {
        "title": "vortices of Taylor and Green",
        "dimensions": 2,
        "plugins": ["kernels", "eos", "wcsph"],
        "domain": {"min": [0, 0], "max": [1, 1], "sides": {"x": "periodic", "y": "periodic"}},
        "materials": {"water": {"eos": {"name": "tait", "c0": 10, "rho0": 1}}},
        "particles": {
            "fluid": {
                "material": "water",
                "fill": {"lattice": "square", "spacing": 0.05 if short else 0.0125, "jitter": 0.1},
                "fields": {"rho": 1, "v": ["sin(2*pi*x)*cos(2*pi*y)", "-cos(2*pi*x)*sin(2*pi*y)"]},
            }
        },
        "scheme": {"name": "wcsph", "alpha": 0.1},
        "kernel": "wendland-c2",
        "time": {"end": 0.02 if short else 0.1},
    }
    for scene in (sod, noh, vortex):
        scene["output"] = {"picture": False}
    return {"sod": sod, "noh": noh, "vortex": vortex}


def snapshot_reader():
    """Class that reads snapshots, or None without h5py."""
    sys.path.insert(0, os.path.join(SOURCE, "tests"))
    os.environ.setdefault("SPH", "")
    os.environ.setdefault("top_srcdir", SOURCE)
    try:
        from scenes import Snapshot
    except ImportError:
        return None
    return Snapshot


def last_velocity(reader, folder):
    snapshots = sorted(name for name in os.listdir(folder) if name.endswith(".vtkhdf"))
    return reader(os.path.join(folder, snapshots[-1]))["v"]


def apart(reader, summary, exact):
    """rms difference of the velocities, relative; NaN where it cannot be told."""
    if reader is None:
        return math.nan
    a, b = (last_velocity(reader, x["folder"]) for x in (summary, exact))
    return float(((a - b) ** 2).sum() / (b**2).sum()) ** 0.5


def row(name, precision, summary, distance):
    drift = summary["conservation"]
    errors = {field.split(".")[1]: e["l1_rel"] for field, e in summary["errors"].items()}
    return {
        "case": name,
        "precision": precision,
        "us_per_update": summary["cost"]["us_per_particle_update"],
        "bytes_per_particle": summary["cost"]["bytes_per_particle"],
        "l1_rho": errors.get("rho"),
        "l1_p": errors.get("p"),
        "l1_v": errors.get("v") or errors.get("v.x"),
        "energy_drift": abs(drift["energy_drift"]),
        "momentum_drift": max(abs(x) for x in drift["momentum_drift"]),
        "apart_v": distance,
    }


def chart(rows, path):
    """Error against cost, both logarithmic: a colour a precision, a row of marks a scene."""
    rows = [r for r in rows if r["apart_v"] > 0.0]
    if not rows:
        return False
    width, height, left, bottom = 720, 460, 80, 60
    scales = []
    for key, low, high in (("us_per_update", left, width - 170), ("apart_v", height - bottom, 40)):
        logs = [math.log10(r[key]) for r in rows]
        first, last = math.floor(min(logs) * 2) / 2, math.ceil(max(logs) * 2) / 2
        last = last if last > first else first + 1
        scales.append((first, last, low, high))

    def place(scale, value):
        first, last, low, high = scale
        return low + (math.log10(value) - first) / (last - first) * (high - low)

    svg = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
           'font-family="sans-serif" font-size="12">',
           f'<rect width="{width}" height="{height}" fill="white"/>',
           f'<text x="{left}" y="22" font-size="15">Precision: distance from the run in long double, and cost</text>',
           f'<text x="{(left + width - 170) / 2}" y="{height - 16}" text-anchor="middle">'
           'microseconds a particle update</text>',
           f'<text transform="translate(18 {height / 2}) rotate(-90)" text-anchor="middle">'
           'rms difference of velocities, relative</text>',
           f'<rect x="{left}" y="40" width="{width - 170 - left}" height="{height - bottom - 40}" '
           'fill="none" stroke="#999"/>']
    for k, (first, last, low, high) in enumerate(scales):
        ticks = [x / 2 for x in range(int(first * 2), int(last * 2) + 1)]
        ticks = ticks if len(ticks) <= 8 else [t for t in ticks if t == int(t)]
        ticks = ticks if len(ticks) <= 10 else ticks[::2]
        for tick in ticks:
            at = low + (tick - first) / (last - first) * (high - low)
            word = f"{10**tick:.2g}"
            if k == 0:
                svg.append(f'<line x1="{at:.1f}" x2="{at:.1f}" y1="40" y2="{height - bottom}" stroke="#e5e5e5"/>')
                svg.append(f'<text x="{at:.1f}" y="{height - bottom + 16}" text-anchor="middle">{word}</text>')
            else:
                svg.append(f'<line x1="{left}" x2="{width - 170}" y1="{at:.1f}" y2="{at:.1f}" stroke="#e5e5e5"/>')
                svg.append(f'<text x="{left - 6}" y="{at + 4:.1f}" text-anchor="end">{word}</text>')
    for r in rows:
        x, y = place(scales[0], r["us_per_update"]), place(scales[1], r["apart_v"])
        svg.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="{COLOURS[r["precision"]]}"/>')
        svg.append(f'<text x="{x + 8:.1f}" y="{y + 4:.1f}">{r["case"]}</text>')
    for k, (name, colour) in enumerate(COLOURS.items()):
        svg.append(f'<circle cx="{width - 140}" cy="{60 + 20 * k}" r="5" fill="{colour}"/>')
        svg.append(f'<text x="{width - 128}" y="{64 + 20 * k}">{name}</text>')
    with open(path, "w") as file:
        file.write("\n".join([*svg, "</svg>", ""]))
    return True


def precision(program, rounds, short):
    reader, rows = snapshot_reader(), []
    for name, scene in cases(program, short).items():
        exact = program.run(scene, "--precision", "double", "--path", "extended", "--threads", "2")
        best = {}
        for _ in range(rounds):
            for word in PRECISIONS:
                summary = program.run(scene, "--precision", word, "--threads", "1")
                if word not in best or summary["cost"]["loop_s"] < best[word]["cost"]["loop_s"]:
                    best[word] = summary
        rows += [row(name, word, best[word], apart(reader, best[word], exact)) for word in PRECISIONS]
    print("\nprecision: errors against exact solutions (L1, relative), drift, rms difference of the velocities from "
          "the\n  same run in long double; one thread")
    width = {"case": 8, "precision": 11, "bytes_per_particle": 20, "us_per_update": 15}
    print("  " + "".join(f"{key.replace('_', ' '):>{width.get(key, 16)}s}" for key in rows[0]))
    for r in rows:
        cells = {key: v if isinstance(v, str) else "-" if v is None else f"{v:.4g}" for key, v in r.items()}
        print("  " + "".join(f"{text:>{width.get(key, 16)}s}" for key, text in cells.items()))
    folder = os.path.join(BUILD, "tests", "bench")
    folder = folder if os.path.isdir(folder) else "."
    path = os.path.join(folder, "precision.csv")
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    print(f"  {path}")
    if chart(rows, os.path.join(folder, "precision.svg")):
        print(f"  {os.path.join(folder, 'precision.svg')}")

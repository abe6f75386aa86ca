"""Time and peak memory of bakes against vertices, rays, bounces and threads: `cargo xtask bench growth [-- OPTIONS]`.

Each bake is the whole program, from the file to the finished asset. Seconds are those of the fastest of the runs, by processor time (of all
threads together, which other work on the machine changes little) and by the clock; memory is the largest resident size. Writes growth.csv
and growth.svg into the working folder and prints the table. Order 5, 1024 rays a vertex, direct light, all cores, where nothing else is said.
"""

import argparse
import csv
import json
import math
import os
import subprocess
import sys
import time
from pathlib import Path

MESHES = [
    "max_planck_5k.obj", "armadillo_10k.ply", "armadillo_14k.obj", "stanford_bunny_36k.ply", "armadillo_43k.obj",
    "happy_buddha_50k.obj", "igea_134k.ply",
]  # fmt: skip
ONE = "armadillo_14k.obj"
AXES = {
    "vertices": [{"mesh": mesh} for mesh in MESHES],
    "rays": [{"samples": 4**k} for k in range(4, 8)],
    "bounces": [{"bounces": k} for k in range(5)],
    "threads": [{"threads": k} for k in (1, 2)],
}
COLUMNS = ["axis", "at", "mesh", "vertices", "samples", "bounces", "threads", "processor_seconds", "seconds", "peak_mb"]
# Room for one panel, its margins, and where the plot's first row starts.
WIDTH, HEIGHT, LEFT, TOP, GAP_X, GAP_Y = 190, 150, 62, 46, 62, 62


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--relume", required=True, help="the program under test")
    parser.add_argument("--meshes", required=True, type=Path, help="the folder they lie in")
    parser.add_argument("--work", required=True, type=Path, help="folder for what is made")
    parser.add_argument("--runs", type=int, default=3, help="of each bake")
    parser.add_argument("--only-plot", action="store_true", help="draw growth.csv again")
    return parser.parse_args()


def bake(arguments, mesh, samples, bounces, threads):
    """Vertices, processor seconds, seconds, and megabytes at the peak, each the least of the runs."""
    command = [
        arguments.relume, "bake", arguments.meshes / mesh, "-o", arguments.work / "out.glb", "--json", "--samples", samples,
        "--bounces", bounces, "--threads", threads,
    ]  # fmt: skip
    figures = []
    for _ in range(arguments.runs):
        start = time.perf_counter()
        process = subprocess.Popen(list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        answer = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            sys.exit(f"error: {' '.join(map(str, command))} failed")
        kilo = 1 if sys.platform == "darwin" else 1024
        figures.append((usage.ru_utime + usage.ru_stime, seconds, usage.ru_maxrss * kilo * 1e-6))
    return json.loads(answer)["vertices"], *map(min, zip(*figures))


def measure(arguments):
    rows = []
    for axis, cases in AXES.items():
        for case in cases:
            options = {"mesh": ONE, "samples": 1024, "bounces": 0, "threads": os.cpu_count(), **case}
            if not (arguments.meshes / options["mesh"]).exists():
                print(f"skipped: {options['mesh']} is not there")
                continue
            if options["threads"] > os.cpu_count():
                continue
            vertices, worked, seconds, peak = bake(arguments, **options)
            at = vertices if axis == "vertices" else next(iter(case.values()))
            figures = {"processor_seconds": f"{worked:.3f}", "seconds": f"{seconds:.3f}", "peak_mb": f"{peak:.1f}"}
            rows.append({"axis": axis, "at": at, "vertices": vertices, **options, **figures})
            print(" ".join(f"{rows[-1][column]:>10}" for column in COLUMNS), flush=True)
    return rows


def ticks(low, high, log):
    """Round numbers from about `low` to about `high`."""
    if log:
        all_ticks = [m * 10.0**e for e in range(-3, 8) for m in (1, 2, 5)]
        inside = [t for t in all_ticks if low * 0.999 <= t <= high * 1.001]
        return [t for t in inside if math.log10(t) % 1 < 1e-9] if len(inside) > 6 else inside
    step = next(s * 10.0**e for e in range(-3, 8) for s in (1, 2, 5) if s * 10.0**e * 5 >= high - low)
    return [step * k for k in range(math.ceil(low / step), math.floor(high / step + 1e-9) + 1)]


def number(x):
    return f"{x / 1000:g}k" if x >= 1000 and x % 1000 == 0 else f"{x:g}"


def panel(at, title, unit, series, log):
    """One diagram with its corner at `at`; `series` is a list of (colour, points)."""
    points = [point for _, line in series for point in line]
    x_low, x_high = min(x for x, _ in points), max(x for x, _ in points)
    y_high = max(y for _, y in points) * (1.5 if log else 1.12)
    y_low = min(y for _, y in points) / 1.5 if log else 0.0
    if not log and x_low > 0:
        x_low -= 0.3
        x_high += 0.3

    def place(value, low, high, length):
        scale = math.log if log else float
        return length * (scale(value) - scale(low)) / (scale(high) - scale(low))

    def x_at(x):
        return at[0] + place(x, x_low, x_high, WIDTH)

    def y_at(y):
        return at[1] + HEIGHT - place(y, y_low, y_high, HEIGHT)

    out = [f'<text class="title" x="{at[0]}" y="{at[1] - 8}">{unit}</text>']
    for y in ticks(y_low, y_high, log):
        out.append(f'<path class="grid" d="M{at[0]} {y_at(y):.1f}h{WIDTH}"/>')
        out.append(f'<text class="y" x="{at[0] - 6}" y="{y_at(y) + 4:.1f}">{number(y)}</text>')
    measured = sorted({x for x, _ in points})
    for x in ticks(x_low, x_high, log) if len(measured) > 5 else measured:
        out.append(f'<path class="tick" d="M{x_at(x):.1f} {at[1] + HEIGHT}v4"/>')
        out.append(f'<text class="x" x="{x_at(x):.1f}" y="{at[1] + HEIGHT + 17}">{number(x)}</text>')
    out.append(f'<path class="axis" d="M{at[0]} {at[1]}v{HEIGHT}h{WIDTH}"/>')
    out.append(f'<text class="x" x="{at[0] + WIDTH / 2}" y="{at[1] + HEIGHT + 34}">{title}</text>')
    for colour, line in series:
        path = "L".join(f"{x_at(x):.1f} {y_at(y):.1f}" for x, y in line)
        out.append(f'<path class="line" stroke="{colour}" d="M{path}"/>')
        out += [f'<circle fill="{colour}" cx="{x_at(x):.1f}" cy="{y_at(y):.1f}" r="3"/>' for x, y in line]
    return out


STYLE = """
text { font: 11px sans-serif; fill: #333 }
.title { font-weight: bold }
.x { text-anchor: middle }
.y { text-anchor: end }
.grid { stroke: #ddd; fill: none }
.tick, .axis { stroke: #333; fill: none }
.line { stroke-width: 2; fill: none }
"""


def plot(rows):
    """The text of the SVG: seconds above, memory below, one column for each axis."""
    width, height = 4 * (WIDTH + GAP_X) + 24, 2 * (HEIGHT + GAP_Y) + TOP - 4
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">',
        f"<style>{STYLE}</style>",
        '<rect width="100%" height="100%" fill="white"/>',
        f'<text x="{LEFT}" y="18"><tspan fill="#1f5fa8">● processor time</tspan>  <tspan fill="#c2571a">● time by the clock</tspan></text>',
    ]
    column = 0
    for axis in AXES:
        found = [row for row in rows if row["axis"] == axis]
        if len(found) < 2:
            continue
        log = axis in ("vertices", "rays")
        title = axis if axis == "vertices" else f"{axis} ({found[0]['mesh'].split('.')[0]})"

        def line(name, found=found):
            return [(float(row["at"]), float(row[name])) for row in found]

        x = LEFT + column * (WIDTH + GAP_X)
        times = [("#1f5fa8", line("processor_seconds")), ("#c2571a", line("seconds"))]
        out += panel((x, TOP), title, "seconds", times, log)
        out += panel((x, TOP + HEIGHT + GAP_Y), title, "peak memory, MB", [("#2e7d4f", line("peak_mb"))], log)
        column += 1
    return "\n".join([*out, "</svg>", ""])


def main():
    arguments = parse()
    arguments.work.mkdir(parents=True, exist_ok=True)
    table = arguments.work / "growth.csv"
    if not arguments.only_plot:
        rows = measure(arguments)
        with table.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, COLUMNS)
            writer.writeheader()
            writer.writerows(rows)
    with table.open(newline="", encoding="utf-8") as file:
        picture = plot(list(csv.DictReader(file)))
    (arguments.work / "growth.svg").write_text(picture, encoding="utf-8")
    print(f"wrote {table} and growth.svg beside it")


if __name__ == "__main__":
    main()

"""The ways from transferred to outgoing radiance: error against bytes and against time: `cargo xtask bench outgoing [-- OPTIONS]`.

`examples/outgoing` measures; its table, which it prints too, goes to outgoing.tsv in the working folder, and the picture of the rows with light
of order 5 and transferred radiance of order 10 to outgoing.svg.
"""

import argparse
import csv
import os
import subprocess
import sys
from pathlib import Path

from growth import GAP_X, GAP_Y, HEIGHT, LEFT, STYLE, TOP, WIDTH, panel

MATERIALS = ["Phong 80", "GGX 0.7", "GGX 0.2"]
COLOURS = {
    "SH": "#999999",
    "least-squares SH": "#1f5fa8",
    "Gautron": "#2e7d4f",
    "grid, bilinear": "#c2571a",
    "separable": "#7b3fa0",
    "zonal, cosine in T": "#b8860b",
    "table, tangent frame": "#000000",
    "lobes in the plane of view": "#d6336c",
    "one zonal lobe, fitted": "#17a2b8",
}
# Below this, in percent, it is the steps of tables and f32 that are measured.
LEAST = 0.002


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--example", required=True, help="the program that measures")
    parser.add_argument("--mesh", required=True, type=Path)
    parser.add_argument("--work", required=True, type=Path, help="folder for what is made")
    parser.add_argument("--only-plot", action="store_true", help="draw outgoing.tsv again")
    parser.add_argument("numbers", nargs="*", help="of rays, pairs and paths, instead of the example's own")
    return parser.parse_args()


def measure(arguments, table):
    command = [arguments.example, arguments.mesh, *arguments.numbers]
    # One thread for the library's own stages, as for the rest; the bake takes all.
    environment = {**os.environ, "RAYON_NUM_THREADS": "1"}
    process = subprocess.Popen(list(map(str, command)), stdout=subprocess.PIPE, encoding="utf-8", env=environment)
    with table.open("w", encoding="utf-8") as file:
        for line in process.stdout:
            print(line, end="", flush=True)
            file.write(line)
    if process.wait() != 0:
        sys.exit("error: the example failed")


def lines(rows, material, x):
    """(colour, points) of every way: what it costs, and its error."""
    out = []
    for way, colour in COLOURS.items():
        found = [row for row in rows if row["material"] == material and row["way"] == way]
        if found:
            out.append((colour, [(float(row[x]), max(float(row["error %"]), LEAST)) for row in found]))
    return out


def legend():
    spans = []
    for k, (way, colour) in enumerate(COLOURS.items()):
        x, y = LEFT + (k % 4) * 185, 16 + k // 4 * 16
        spans.append(f'<text x="{x}" y="{y}" style="fill: {colour}">● {way}</text>')
    return spans


def plot(rows):
    """The text of the SVG: error against bytes above, against time below, one column for each material."""
    top = TOP + 30
    width, height = len(MATERIALS) * (WIDTH + GAP_X) + 24, 2 * (HEIGHT + GAP_Y) + top - 4
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">',
        f"<style>{STYLE}</style>",
        '<rect width="100%" height="100%" fill="white"/>',
        *legend(),
    ]
    for column, material in enumerate(MATERIALS):
        x = LEFT + column * (WIDTH + GAP_X)
        below = top + HEIGHT + GAP_Y
        unit = f"{material}: error, %"
        out += panel((x, top), "bytes a vertex, compound", unit, lines(rows, material, "compound bytes"), True)
        out += panel((x, below), "ns a vertex and view", unit, lines(rows, material, "view ns"), True)
    return "\n".join([*out, "</svg>", ""])


def main():
    arguments = parse()
    arguments.work.mkdir(parents=True, exist_ok=True)
    table = arguments.work / "outgoing.tsv"
    if not arguments.only_plot:
        measure(arguments, table)
    with table.open(newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file, delimiter="\t") if (row["n"], row["m"]) == ("5", "10")]
    (arguments.work / "outgoing.svg").write_text(plot(rows), encoding="utf-8")
    print(f"wrote {table} and outgoing.svg beside it")


if __name__ == "__main__":
    main()

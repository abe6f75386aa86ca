"""Calling the `relume` program named by the environment variable RELUME, and the scene the tests bake."""

import os
import shutil
import subprocess
from pathlib import Path

PROGRAM = os.environ.get("RELUME", "relume")

# A floor of 5 × 5 vertices, 2 m wide, facing up; above its middle a ceiling that faces down.
FLOOR = 5
CEILING_HALF_WIDTH, CEILING_HALF_DEPTH, CEILING_HEIGHT = 0.5, 0.4, 0.5
MIDDLE = FLOOR * FLOOR // 2


def relume(*arguments):
    """Runs `relume ARGUMENTS…` and returns what it writes to stdout; its words go into the error when it fails."""
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        words = " ".join(map(str, arguments))
        raise RuntimeError(f"relume {words} ended with {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def write_scene(path):
    """Writes the scene as OBJ, without normals or materials."""
    steps = [2 * i / (FLOOR - 1) - 1 for i in range(FLOOR)]
    lines = [f"v {x} 0 {z}" for z in steps for x in steps]
    for row in range(FLOOR - 1):
        for column in range(FLOOR - 1):
            a = row * FLOOR + column + 1
            # Counter-clockwise seen from above: +z runs toward the viewer who has +x to the right.
            lines.append(f"f {a} {a + FLOOR} {a + FLOOR + 1} {a + 1}")
    w, d, h = CEILING_HALF_WIDTH, CEILING_HALF_DEPTH, CEILING_HEIGHT
    lines += [f"v {x} {h} {z}" for x, z in ((-w, -d), (w, -d), (w, d), (-w, d))]
    first = FLOOR * FLOOR + 1
    lines.append(f"f {first} {first + 1} {first + 2} {first + 3}")
    Path(path).write_text("\n".join(lines) + "\n", encoding="ascii")


def keep_asset(path, name):
    """Leaves a baked file for the glTF validator, where one will look."""
    if folder := os.environ.get("RELUME_ASSETS"):
        Path(folder).mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, Path(folder) / name)

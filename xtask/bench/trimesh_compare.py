"""A whole bake beside a plain Python loop on trimesh and embreex, at equal error: `cargo xtask bench bake [-- OPTIONS]`.

The loop is the one human reconstruction code has (the sampling of sun2005): n² uniform random directions over the sphere, shared by all
vertices; for n of them at a time, the rays of all vertices, masked to each vertex's hemisphere, go through `mesh.ray.intersects_any`; cosine ×
basis is added up with numpy. Kinder to the loop than what is usual: only rays above the surface are cast, the offset is small enough to
cost no accuracy, and importing is free. It runs for some of the vertices and its time is scaled to all; loading counts once.

Errors are relative RMS over those vertices and all coefficients against a bake of 65,536 rays. Ours is the quickest bake of a ladder of
rays whose error is no larger than the least that the loop had in any round. Its time is that of the program, from the file to the finished asset, on all cores. Both take turns; the
medians count. On a machine that does other work as well, the seconds of processor time beside them tell more.

Prints one line per n: name, ours, theirs in vertices per second, separated by tabs.
"""

import argparse
import resource
import statistics
import subprocess
import time
from pathlib import Path

import numpy as np
import trimesh

LADDER = [16, 32, 48, 64, 128, 256, 512, 1024, 2048, 4096]


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mesh", type=Path, help="an OBJ or PLY")
    parser.add_argument("--relume", required=True, help="the program under test")
    parser.add_argument("--work", required=True, type=Path, help="folder for baked files")
    parser.add_argument("--n", default="40,80", help="the loop's n; it has n² directions")
    parser.add_argument("--order", type=int, default=5)
    parser.add_argument("--vertices", type=int, default=2000, help="how many of them the loop runs for")
    parser.add_argument("--rounds", type=int, default=5)
    return parser.parse_args()


def baked(arguments, samples, seed=0):
    """Seconds and processor seconds of the program, and its asset."""
    asset = arguments.work / f"{arguments.mesh.stem}-{samples}.glb"
    bake = [
        arguments.relume, "bake", arguments.mesh, "-o", asset, "--order", arguments.order, "--samples", samples, "--seed", seed,
    ]  # fmt: skip
    start, worked = time.perf_counter(), children()
    subprocess.run(list(map(str, bake)), check=True, stderr=subprocess.DEVNULL)
    return np.array([time.perf_counter() - start, children() - worked]), asset


def children():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def now():
    """Seconds and processor seconds."""
    return np.array([time.perf_counter(), time.process_time()])


def exported(arguments, asset):
    """Its arrays."""
    table = asset.with_suffix(".npz")
    subprocess.run([arguments.relume, "export", asset, "-o", table], check=True, stderr=subprocess.DEVNULL)
    with np.load(table) as arrays:
        return {key: arrays[key] for key in ("position", "normal", "transfer", "valid")}


def basis(order, directions):
    """Real spherical harmonics without the Condon–Shortley phase, [directions, order²]."""
    x, y, z = directions.T
    values = np.empty((len(directions), order * order))
    cosine, sine, diagonal = np.ones_like(x), np.zeros_like(x), np.sqrt(1 / (4 * np.pi))
    for m in range(order):
        before, now = np.zeros_like(x), np.full_like(x, diagonal)
        for l in range(m, order):  # noqa: E741
            factor = 1 if m == 0 else np.sqrt(2)
            values[:, l * (l + 1) + m] = factor * now * cosine
            if m > 0:
                values[:, l * (l + 1) - m] = factor * now * sine
            a = np.sqrt((4 * (l + 1) ** 2 - 1) / ((l + 1) ** 2 - m * m))
            b = np.sqrt((l * l - m * m) / (4 * l * l - 1)) if l > m else 0
            before, now = now, a * (z * now - b * before)
        cosine, sine = x * cosine - y * sine, x * sine + y * cosine
        diagonal *= np.sqrt((2 * m + 3) / (2 * m + 2))
    return values


def load(arguments):
    """The mesh as trimesh reads it, ready to cast rays."""
    mesh = trimesh.load(arguments.mesh, process=False, force="mesh")
    mesh.ray.intersects_any(mesh.vertices[:1], np.array([[0.0, 0, 1]]))
    return mesh


def loop(arguments, mesh, origins, normals, n, random):
    """Transfer vectors [vertices, order²]."""
    z, turn = 1 - 2 * random.random(n * n), 2 * np.pi * random.random(n * n)
    r = np.sqrt(1 - z * z)
    directions = np.stack([r * np.cos(turn), r * np.sin(turn), z], axis=1)
    values = basis(arguments.order, directions)
    vertices = len(origins)
    starts = np.repeat(origins, n, axis=0)
    ups = np.repeat(normals, n, axis=0)
    transfer = np.zeros((vertices, arguments.order**2))
    for i in range(0, n * n, n):
        rays = np.tile(directions[i : i + n], (vertices, 1))
        cosines = (rays * ups).sum(axis=1)
        front = cosines > 0
        opens = front.copy()
        opens[front] = ~mesh.ray.intersects_any(starts[front], rays[front])
        weights = (opens * cosines).reshape(vertices, n)
        transfer += weights @ values[i : i + n]
    return transfer * (4 / (n * n))


def error(transfer, truth):
    return float(np.linalg.norm(transfer - truth) / np.linalg.norm(truth))


def main():
    arguments = parse()
    arguments.work.mkdir(parents=True, exist_ok=True)
    truth = exported(arguments, baked(arguments, 65536, seed=1)[1])
    all_vertices = len(truth["valid"])
    random = np.random.default_rng(0)
    possible = np.flatnonzero(truth["valid"])
    chosen = np.sort(random.choice(possible, min(arguments.vertices, len(possible)), replace=False))
    reference = truth["transfer"][chosen, 0].astype(float)
    positions, normals = (truth[key][chosen].astype(float) for key in ("position", "normal"))
    start = now()
    mesh = load(arguments)
    loading = now() - start
    origins = positions + 1e-6 * mesh.scale * normals
    ladder = {}
    for samples in LADDER:
        seconds, asset = baked(arguments, samples)
        table = exported(arguments, asset)
        ladder[samples] = (error(table["transfer"][chosen, 0].astype(float), reference), seconds[1])

    for n in map(int, arguments.n.split(",")):
        # The same directions again when it is timed: what error they reach tells which of ours they are up against.
        errors = []
        for seed in range(arguments.rounds):
            few = slice(None, None, 10)
            transfer = loop(arguments, mesh, origins[few], normals[few], n, np.random.default_rng(seed))
            errors.append(error(transfer, reference[few]))
        good = [samples for samples in LADDER if ladder[samples][0] <= min(errors)]
        samples = min(good, key=lambda samples: ladder[samples][1])
        seconds, theirs, errors = [], [], []
        for seed in range(arguments.rounds):
            start = now()
            transfer = loop(arguments, mesh, origins, normals, n, np.random.default_rng(seed))
            theirs.append(loading + (now() - start) * all_vertices / len(chosen))
            errors.append(error(transfer, reference))
            seconds.append(baked(arguments, samples)[0])
        if ladder[samples][0] > statistics.median(errors):
            raise SystemExit(f"error: {samples} rays are worse than the loop after all")
        (a, a_worked), (b, b_worked) = np.median(seconds, axis=0), np.median(theirs, axis=0)
        print(
            f"{n * n} directions: error {statistics.median(errors):.2%}, {b:.1f} s ({b_worked:.1f} s of processors); "
            f"ours with {samples} rays: {ladder[samples][0]:.2%}, {a:.2f} s ({a_worked:.2f}); processor time {b_worked / a_worked:.0f} to 1"
        )
        print(f"bake {arguments.mesh.stem} / Python, {n * n} directions\t{all_vertices / a}\t{all_vertices / b}", flush=True)


if __name__ == "__main__":
    main()

"""Transfer vectors baked by Relume against Mitsuba 3: `cargo xtask bench mitsuba [-- OPTIONS]`.

For each mesh (OBJ or PLY, one object of one albedo), or the built-in scene `two-objects` (vertex colours over a textured floor), at
randomly chosen vertices:

    direct   relative RMS of the transfer vectors of 0 bounces
    bounce   relative RMS of what k bounces add to them (k minus 0), which the direct part would hide

Relative RMS is RMS(ours − reference) / RMS(reference) over vertices, channels and coefficients. The reference is run twice with different
seeds: it is their mean, and half the RMS of their difference is its own standard error, given beside each figure and, squared,
subtracted in the last column.

Mitsuba loads the mesh itself; its ray caster, sampling and spherical harmonics are its own and those of the reference tool. Positions and
normals of the receivers are ours, as exported. The shading normals where rays hit a mesh are set to ours as well, so that only the
transport is compared; how far its own normals lie from ours is printed. Transfer is per unit of the receiver's albedo, so the
reference's, which include it, are divided by it.

The reference's rays start `--eps` times the scene's diagonal above the surface. On two scanned figures (43k and 50k vertices), 1e-4 moved
the direct part by 0.3 to 0.4 % and the bounce part by 3 %, 1e-5 and 1e-7 agreed with 1e-6 to within noise (0.05 % and 0.5 %).
"""

import argparse
import importlib.util
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import two_objects


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--relume", required=True, help="the program under test")
    parser.add_argument("--tool", required=True, help="mitsuba_vertex_reference.py")
    parser.add_argument("--work", required=True, type=Path, help="folder for baked files")
    parser.add_argument("--mesh", action="append", default=[], help="a file, or two-objects (may be given several times)")
    parser.add_argument("--albedo", default="0.8,0.5,0.3", help="R,G,B of the surfaces of mesh files")
    parser.add_argument("--order", type=int, default=5)
    parser.add_argument("--samples", type=int, default=4096, help="rays per vertex of ours")
    parser.add_argument("--bounces", type=int, default=2, help="0 compares direct light alone")
    parser.add_argument("--vertices", type=int, default=400, help="how many are compared")
    parser.add_argument("--paths", type=int, default=262144, help="per vertex, in each of the reference's two runs")
    parser.add_argument("--eps", type=float, default=1e-6, help="the reference's ray offset over the mesh's diagonal")
    parser.add_argument("--seed", type=int, default=0, help="of the choice of vertices and of the reference")
    arguments = parser.parse_args()
    arguments.albedo = np.array([float(x) for x in arguments.albedo.split(",")])
    if arguments.albedo.shape != (3,) or arguments.albedo.min() <= 0:
        parser.error("--albedo wants three positive numbers R,G,B")
    return arguments


def load_tool(path):
    spec = importlib.util.spec_from_file_location("mitsuba_vertex_reference", path)
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    tool.setup()
    return tool


class Case:
    """One scene as both programs read it."""

    def __init__(self, tool, arguments, mesh):
        if mesh == "two-objects":
            self.file, self.meshes, self.materials = two_objects.build(tool, arguments.work)
            # The receivers take the material of the last mesh, which is white.
            self.flags, self.receiver, self.albedo = [], 2, np.ones(3)
        else:
            self.file, self.meshes = Path(mesh), [mesh]
            self.materials = [tool.bsdf_dict("diffuse", arguments.albedo)]
            self.flags = ["--albedo", ",".join(map(str, arguments.albedo))]
            self.receiver, self.albedo = 0, arguments.albedo


def ours(arguments, case, bounces):
    """Bakes and exports the scene; the exported arrays."""
    asset = arguments.work / f"{case.file.stem}-{bounces}.glb"
    table = asset.with_suffix(".npz")
    bake = [
        arguments.relume, "bake", case.file, "-o", asset, "--order", arguments.order, "--samples", arguments.samples,
        "--bounces", bounces, *case.flags,
    ]  # fmt: skip
    start = time.monotonic()
    subprocess.run(list(map(str, bake)), check=True)
    print(f"baked {case.file.name}, {bounces} bounces: {time.monotonic() - start:.1f} s", flush=True)
    subprocess.run([arguments.relume, "export", str(asset), "-o", str(table)], check=True)
    with np.load(table) as arrays:
        return {key: arrays[key] for key in ("position", "normal", "transfer", "valid")}


def keys(positions):
    """Positions as hashable bytes; adding 0 makes the two zeros one."""
    return [position.tobytes() for position in positions.astype(np.float32) + np.float32(0)]


def shade_like_ours(tool, mesh, baked):
    """Mitsuba's positions and faces of `mesh`, with our normal at each of its vertices."""
    positions, faces, normals = tool.mesh_arrays(tool.make_mesh(mesh, tool.bsdf_dict()))
    at = {}
    for i, key in enumerate(keys(baked["position"])):
        at.setdefault(key, []).append(i)
    matched = np.empty(len(positions), int)
    for i, key in enumerate(keys(positions)):
        if key not in at:
            sys.exit(f"error: {mesh}: our export has no vertex at {positions[i]}, which Mitsuba reads")
        matched[i] = max(at[key], key=lambda j: baked["normal"][j] @ normals[i])
    ours_there = baked["normal"][matched]
    used = np.unique(faces)  # A vertex that no face uses has no normal of its own.
    apart = np.linalg.norm(np.cross(ours_there[used], normals[used]), axis=1)
    angle = np.degrees(np.arctan2(apart, np.sum(ours_there[used] * normals[used], axis=1)))
    print(f"our normals differ from Mitsuba's by {np.median(angle):.4f}° (median), {angle.max():.4f}° (most)")
    return positions, faces, ours_there


def reference(tool, arguments, case, receivers, bounces, seed):
    """Transfer vectors [V, 3, n²] without the receiver's albedo."""
    found = tool.reference(
        case.meshes, case.materials, bounces=bounces, receivers=receivers, spp=arguments.paths, method="bsdf",
        transfer=arguments.order, seed=seed, eps=arguments.eps, quiet=True,
    )  # fmt: skip
    return found["transfer"].transpose(0, 2, 1) / case.albedo[:, None]


def rms(values):
    return float(np.sqrt(np.mean(np.square(values, dtype=np.float64))))


def heading():
    print(f"{'':<20} {'relative RMS':>14} {'reference’s error':>18} {'without it':>14}")


def row(name, part, runs):
    """Prints one line of the table; the figures are relative to the RMS of the reference."""
    mean = (runs[0] + runs[1]) / 2
    scale = rms(mean)
    error, noise = rms(part - mean) / scale, rms(runs[0] - runs[1]) / 2 / scale
    left = np.sqrt(max(0.0, error**2 - noise**2))
    print(f"{name:<20} {error:>14.3%} {noise:>18.3%} {left:>14.3%}", flush=True)


def choose(arguments, tool, case, baked):
    """Vertices to compare: not buried, and used by a triangle."""
    used = set()
    for mesh in case.meshes:
        positions, faces, _ = tool.mesh_arrays(tool.make_mesh(mesh, tool.bsdf_dict()))
        used.update(keys(positions[np.unique(faces)]))
    usable = [i for i, key in enumerate(keys(baked["position"])) if baked["valid"][i] and key in used]
    return np.random.default_rng(arguments.seed).permutation(usable)[: arguments.vertices]


def compare(tool, arguments, mesh):
    case = Case(tool, arguments, mesh)
    direct = ours(arguments, case, 0)
    chosen = choose(arguments, tool, case, direct)
    if len(case.meshes) == 1:
        case.meshes = [shade_like_ours(tool, case.meshes[0], direct)]
    receivers = {
        "p": direct["position"][chosen],
        "n": direct["normal"][chosen],
        "mesh": np.full(len(chosen), case.receiver),
    }
    seeds = (arguments.seed + 1, arguments.seed + 2)
    start = time.monotonic()
    run = {s: reference(tool, arguments, case, receivers, 0, s) for s in seeds}
    print(
        f"{case.file.name}: order {arguments.order}, {arguments.samples} samples, {len(chosen)} of {len(direct['valid'])} "
        f"vertices, 2 × {arguments.paths} reference paths"
    )
    heading()
    row("direct", direct["transfer"][chosen].astype(float), list(run.values()))
    if arguments.bounces > 0:
        bounced = ours(arguments, case, arguments.bounces)
        # The same seed follows the same paths further, so the direct part cancels in the difference.
        parts = [reference(tool, arguments, case, receivers, arguments.bounces, s) - run[s] for s in seeds]
        added = bounced["transfer"][chosen].astype(float) - direct["transfer"][chosen]
        row(f"bounce ({arguments.bounces} minus 0)", added, parts)
    print(f"reference and second bake: {time.monotonic() - start:.1f} s\n", flush=True)


def main():
    arguments = parse()
    arguments.work.mkdir(parents=True, exist_ok=True)
    tool = load_tool(arguments.tool)
    for mesh in arguments.mesh or ["two-objects"]:
        compare(tool, arguments, mesh)


if __name__ == "__main__":
    main()

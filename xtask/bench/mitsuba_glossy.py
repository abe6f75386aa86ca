"""Radiance of glossy surfaces toward an eye, by Relume and by Mitsuba 3: `cargo xtask bench mitsuba -- --glossy [OPTIONS]`.

For each mesh and each of `--brdf`, one material for all surfaces, at randomly chosen vertices that face the eye:

    direct     relative RMS of radiance with 0 bounces
    k bounces  the same with k
    added      relative RMS of what the bounces add (k minus 0)

All figures are as in mitsuba_compare.py: the mean of two runs of the reference is compared with, half the RMS of their difference is its
own standard error, and the last column is without it.

The light is `--light`, projected to the order of the asset and given to both as those coefficients, so that only the transfer is on trial.
Mitsuba sees them as two environment maps, one to be subtracted, with its path integrator and emitter sampling; paths from the eye are
`bounces + 2` long. The first of their vertices, which is one of ours, and the shading normals are as in mitsuba_compare.py.
"""

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import mitsuba_bsdfs
import mitsuba_compare as compare
import two_objects

DIFFUSE = (0.3, 0.2, 0.1)
SPECULAR = 0.5
METAL = (0.9, 0.7, 0.4)
# Toward the eye from the middle of the scene, in its diagonals.
EYE = (0.7, 0.6, 1.2)


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--relume", required=True, help="the program under test")
    parser.add_argument("--tool", required=True, help="mitsuba_vertex_reference.py")
    parser.add_argument("--work", required=True, type=Path, help="folder for baked files")
    parser.add_argument("--mesh", action="append", default=[], help="a file, or two-objects (may be given several times)")
    parser.add_argument("--brdf", action="append", default=[], help="phong:EXPONENT or metal:ROUGHNESS (may be given several times)")
    parser.add_argument("--light", default="sky:35,3", help="as for relume light")
    parser.add_argument("--order", type=int, default=5)
    parser.add_argument("--transfer-order", type=int, default=10)
    parser.add_argument("--samples", type=int, default=1024, help="rays per vertex of ours")
    parser.add_argument("--bounces", type=int, default=2, help="0 compares direct light alone")
    parser.add_argument("--vertices", type=int, default=100, help="how many are compared")
    parser.add_argument("--facing", type=float, default=0.0, help="the least cosine between their normals and the view")
    parser.add_argument("--paths", type=int, default=32768, help="per vertex, in each of the reference's two runs")
    parser.add_argument("--method", choices=["path", "bsdf"], default="path", help="bsdf: no emitter sampling, light by its coefficients")
    parser.add_argument("--eps", type=float, default=1e-6, help="the reference's ray offset over the mesh's diagonal")
    parser.add_argument("--seed", type=int, default=0, help="of the choice of vertices and of the reference")
    return parser.parse_args()


def material(tool, name):
    """Flags of ours, and Mitsuba's dictionary."""
    kind, _, width = name.partition(":")
    text = lambda colour: ",".join(map(str, colour))  # noqa: E731
    if kind == "phong":
        flags = ["--kd", text(DIFFUSE), "--ks", SPECULAR, "--exponent", width]
        return ["--brdf", "phong", *flags], tool.bsdf_dict("phong", kd=DIFFUSE, ks=(SPECULAR,) * 3, exponent=float(width))
    if kind == "metal":
        flags = ["--base-color", text(METAL), "--metallic", 1, "--roughness", width]
        return ["--brdf", "ggx", *flags], mitsuba_bsdfs.metal(METAL, float(width))
    sys.exit(f"error: --brdf {name}: unknown; use phong:EXPONENT or metal:ROUGHNESS")


class Case:
    """One scene as both programs read it, and the vertices that are compared."""

    def __init__(self, tool, arguments, mesh):
        if mesh == "two-objects":
            # The third lends its white to receivers that bring no colour of their own; here all have one.
            self.file, meshes, _ = two_objects.build(tool, arguments.work)
            self.meshes = meshes[:2]
        else:
            self.file, self.meshes = Path(mesh), [mesh]
        self.flags = []
        # Which vertices are buried is no matter of samples: few will do.
        plain = argparse.Namespace(**{**vars(arguments), "samples": 1})
        self.vertices = compare.ours(plain, self, 0)
        positions, normals = self.vertices["position"], self.vertices["normal"]
        low, high = positions.min(0).astype(float), positions.max(0).astype(float)
        self.eye = ((low + high) / 2 + np.array(EYE) * np.linalg.norm(high - low)).round(4)
        view = self.eye - positions
        cosine = np.sum(normals * view, axis=1) / np.linalg.norm(view, axis=1)
        self.vertices["valid"] = self.vertices["valid"] & (cosine > arguments.facing)
        self.chosen = compare.choose(arguments, tool, self, self.vertices)
        if len(self.meshes) == 1:
            self.meshes = [compare.shade_like_ours(tool, self.meshes[0], self.vertices)]


def light(arguments):
    """The light's file and its coefficients [n², 3]."""
    file = arguments.work / "light.json"
    run = [arguments.relume, "light", arguments.light, "--order", str(arguments.order), "-o", str(file)]
    subprocess.run(run, check=True)
    return file, np.array(json.loads(file.read_text(encoding="utf-8"))["coefficients"])


def ours(arguments, case, flags, lit, bounces):
    """Bakes and shades the scene; radiance toward the eye at the chosen vertices."""
    asset, table = arguments.work / "glossy.glb", arguments.work / "glossy.npz"
    bake = [
        arguments.relume, "bake", case.file, "-o", asset, "--transfer", "glossy", "--order", arguments.order, "--transfer-order",
        arguments.transfer_order, "--samples", arguments.samples, "--bounces", bounces, *flags,
    ]  # fmt: skip
    start = time.monotonic()
    subprocess.run(list(map(str, bake)), check=True)
    print(f"baked {case.file.name}, {bounces} bounces: {time.monotonic() - start:.1f} s", flush=True)
    eye = ",".join(map(str, case.eye))
    subprocess.run([arguments.relume, "shade", str(asset), "--light", str(lit), f"--eye={eye}", "-o", str(table)], check=True)
    asset.unlink()
    with np.load(table) as arrays:
        if not np.array_equal(arrays["position"], case.vertices["position"]):
            sys.exit(f"error: {table}: vertices are not those of {case.file}'s diffuse bake")
        return arrays["radiance"][case.chosen].astype(float)


def reference(tool, arguments, case, bsdf, coefficients, bounces, seed):
    """Radiance toward the eye, [V, 3]."""
    receivers = {"p": case.vertices["position"][case.chosen], "n": case.vertices["normal"][case.chosen]}
    found = tool.reference(
        case.meshes, [bsdf] * len(case.meshes), sh=coefficients, bounces=bounces, receivers=receivers, spp=arguments.paths,
        method=arguments.method, eye=case.eye, seed=seed, eps=arguments.eps, quiet=True,
    )  # fmt: skip
    return found["radiance"]


def compare_material(tool, arguments, case, name):
    flags, bsdf = material(tool, name)
    lit, coefficients = light(arguments)
    seeds = (arguments.seed + 1, arguments.seed + 2)
    depths = (0, arguments.bounces) if arguments.bounces > 0 else (0,)
    baked = {depth: ours(arguments, case, flags, lit, depth) for depth in depths}
    start = time.monotonic()
    # The same seed follows the same paths further, so the direct part cancels in the difference.
    runs = {depth: [reference(tool, arguments, case, bsdf, coefficients, depth, seed) for seed in seeds] for depth in depths}
    print(
        f"{case.file.name}, {name}: orders {arguments.order} and {arguments.transfer_order}, {arguments.samples} samples, "
        f"{len(case.chosen)} vertices, 2 × {arguments.paths} reference paths in {time.monotonic() - start:.1f} s"
    )
    compare.heading()
    compare.row("direct", baked[0], runs[0])
    if arguments.bounces > 0:
        most = depths[1]
        compare.row(f"{most} bounces", baked[most], runs[most])
        compare.row("added", baked[most] - baked[0], [b - a for a, b in zip(*runs.values())])
    print(flush=True)


def main():
    arguments = parse()
    arguments.work.mkdir(parents=True, exist_ok=True)
    tool = compare.load_tool(arguments.tool)
    mitsuba_bsdfs.define(tool)
    for mesh in arguments.mesh or ["two-objects"]:
        case = Case(tool, arguments, mesh)
        for name in arguments.brdf or ["phong:20", "metal:0.4"]:
            compare_material(tool, arguments, case, name)


if __name__ == "__main__":
    main()

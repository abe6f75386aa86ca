"""Relume: precomputed radiance transfer. Bake how light moves over a mesh once, relight it in real time.

    bake   triangles  → transfer vectors [V, C, n²]      once; on all cores, without the GIL
    light  a light    → coefficients     [n², 3]         for each light
    shade  both       → radiance         [V, 3]          for each frame

Lights that stand near: `relume.Emitters`, whose `light_at(vertices)` is light for each vertex, [V, n², 3].
Surfaces that look different from each side: `bake(…, transfer="glossy", brdf=relume.Ggx(…))`, then `shade(…, eye=…)`.

Axes are right-handed with y up. Spherical harmonics are real and orthonormal, without Condon–Shortley phase, at index l(l + 1) + m; *order* n
means the degrees 0…n − 1, n² coefficients. Colours are linear Rec. 709. Light is radiance.

>>> import numpy as np, relume
>>> vertices = np.array([[-9, 0, -9], [-9, 0, 9], [9, 0, 9], [9, 0, -9]], float)   # an open floor that faces up
>>> faces = np.array([[0, 1, 2], [0, 2, 3]])
>>> transfer = relume.bake(vertices, faces, samples=256)
>>> transfer.shape, transfer.dtype
((4, 1, 25), dtype('float32'))
>>> sky = relume.light("constant:1,0.5,0.25")
>>> sky.shape
(25, 3)
>>> radiance = relume.shade(transfer, sky, albedo=0.5)                             # a floor of albedo 0.5 sends out half of what arrives
>>> print(radiance[0].round(3))
[0.5   0.25  0.125]
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from typing import Literal, TypedDict, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments, _relume
from ._brdf import Brdf, Ggx, Lambert, Measured, Phong
from ._direct import DirectTransfer
from ._emitters import Emitters, Incident, SampledLight
from ._glossy import GlossyTransfer
from ._light_file import read_light, write_light
from ._relume import __version__
from ._shapes import Blocks, Cuboid, Disc, Emitter, Mesh, Quad, Sphere

__all__ = [
    "Blocks",
    "Cuboid",
    "DirectTransfer",
    "Disc",
    "Emitter",
    "Emitters",
    "Ggx",
    "GlossyTransfer",
    "Incident",
    "Lambert",
    "Measured",
    "Mesh",
    "Phong",
    "Quad",
    "SampledLight",
    "Sphere",
    "__version__",
    "bake",
    "light",
    "read_light",
    "shade",
    "write_light",
]


class _Options(TypedDict):
    """What both bakes take."""

    normals: NDArray[np.float32] | None
    albedo: NDArray[np.float32]
    order: int
    samples: int
    seed: int
    threads: int | None
    double_sided: bool


@overload
def bake(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    normals: ArrayLike | None = ...,
    albedo: ArrayLike = ...,
    order: int = ...,
    samples: int = ...,
    bounces: int = ...,
    seed: int = ...,
    threads: int | None = ...,
    double_sided: bool = ...,
    return_valid: Literal[False] = ...,
    transfer: Literal["diffuse"] = ...,
) -> NDArray[np.float32]: ...
@overload
def bake(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    normals: ArrayLike | None = ...,
    albedo: ArrayLike = ...,
    order: int = ...,
    samples: int = ...,
    bounces: int = ...,
    seed: int = ...,
    threads: int | None = ...,
    double_sided: bool = ...,
    return_valid: Literal[True],
    transfer: Literal["diffuse"] = ...,
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]: ...
@overload
def bake(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    normals: ArrayLike | None = ...,
    albedo: ArrayLike = ...,
    order: int = ...,
    samples: int = ...,
    bounces: int = ...,
    seed: int = ...,
    threads: int | None = ...,
    double_sided: bool = ...,
    transfer: Literal["glossy"],
    transfer_order: int | None = ...,
    brdf: Brdf | None = ...,
) -> GlossyTransfer: ...
@overload
def bake(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    normals: ArrayLike | None = ...,
    albedo: ArrayLike = ...,
    order: int = ...,
    samples: int = ...,
    seed: int = ...,
    threads: int | None = ...,
    double_sided: bool = ...,
    gather: Literal[True],
) -> DirectTransfer: ...
def bake(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    normals: ArrayLike | None = None,
    albedo: ArrayLike = 0.5,
    order: int = 5,
    samples: int = 1024,
    bounces: int = 0,
    seed: int = 0,
    threads: int | None = None,
    double_sided: bool = False,
    return_valid: bool = False,
    transfer: Literal["diffuse", "glossy"] = "diffuse",
    transfer_order: int | None = None,
    brdf: Brdf | None = None,
    gather: bool = False,
) -> NDArray[np.float32] | tuple[NDArray[np.float32], NDArray[np.bool_]] | GlossyTransfer | DirectTransfer:
    """Bakes the diffuse transfer vector of every vertex, or its transfer matrix: shadowed direct light and `bounces` interreflections.

    Returns float32 [V, C, order²], in the order of `vertices`; C is 1 without bounces and 3 (linear red, green, blue) with them. A row is the
    transferred irradiance divided by π, as coefficients of the light: visibility, the cosine and 1/π are folded in, every bounce's albedo too, but
    **not the receiver's own albedo**. So the radiance that leaves vertex v is

        radiance[v, c] = albedo[v, c] * sum(transfer[v, c] * light[:, c])

    which is what `relume.shade` computes. It is what `relume bake` and `relume export` write for the same mesh, to the bit, whatever the
    number of threads.

    vertices      [V, 3] floats, right-handed, y up. Those that no face uses stay in the result.
    faces         [F, 3] integers: triangles, counter-clockwise seen from the front. Triangles without an area cast no shadow.
    normals       [V, 3], of any length. Without them, and where one is zero: angle-weighted vertex normals; vertices at one place share one where
                  theirs differ by less than 60°.
    albedo        linear, in 0…1: a number, three, or [V, 3]. Only bounces depend on it.
    order         1…32: order² coefficients, for light up to degree order − 1.
    samples       rays for each vertex; bounces reuse them.
    seed          chooses their directions.
    threads       how many; None for all cores.
    double_sided  whether the backs of faces reflect as the fronts do; otherwise they are black and block light. The result is for the side of the
                  normals either way.
    return_valid  also return bool [V]: False where a vertex lies inside something (more than half of its rays first meet the back of a one-sided
                  face) and its row was filled from its neighbours.

    With transfer="glossy" the result is a `relume.GlossyTransfer`, with matrices for surfaces that look different from each side: `transfer_order²`
    times the size. Seen from behind their normals they are black.

    transfer_order  1…32, order + transfer_order at most 33: how sharp the light is that arrives; None for what the BRDF needs, 10 or `order` at most.
    brdf            how all surfaces reflect: relume.Lambert() (also for None), Phong(kd, ks, exponent), Ggx(base_color, metallic, roughness) or
                    Measured("file.binary").

    With gather=True the result is a `relume.DirectTransfer`: direct transfer, and the gather operator by which `relume.shade` makes bounces of any light,
    light that varies over the object too. Transfer with `bounces` folded in is for distant light alone.

    gather  whether; then `bounces` is 0.

    The GIL is released. Ctrl-C raises KeyboardInterrupt at once when called from the main thread, the one that Python tells of it.

    Raises ValueError, in one line that starts with the name of the argument, for everything that is not as above; MemoryError when the result
    would not fit. What was repaired is said by warnings.warn.
    """
    glossy = _arguments.is_glossy(transfer, transfer_order=transfer_order, brdf=brdf, return_valid=return_valid, gather=gather, bounces=bounces)
    points = _arguments.vertices(vertices)
    how = Lambert() if brdf is None else brdf
    if isinstance(how, Ggx) and how.base_color is not None:
        albedo = _arguments.color("brdf.base_color", how.base_color)
    arrays = (points, _arguments.faces(faces, len(points)))
    options = _Options(
        normals=_arguments.normals(normals, len(points)),
        albedo=_arguments.albedo(albedo, len(points)),
        order=_arguments.integer("order", order, 1, _arguments.MAX_ORDER),
        samples=_arguments.integer("samples", samples, 1, _arguments.MAX_SAMPLES),
        seed=_arguments.integer("seed", seed, 0, _arguments.MAX_SEED),
        threads=None if threads is None else _arguments.integer("threads", threads, 1, _arguments.MAX_THREADS),
        double_sided=bool(double_sided),
    )
    folded = _arguments.integer("bounces", bounces, 0, _arguments.MAX_BOUNCES)
    result: NDArray[np.float32] | tuple[NDArray[np.float32], NDArray[np.bool_]] | GlossyTransfer | DirectTransfer
    if glossy:
        height = None if transfer_order is None else _arguments.integer("transfer_order", transfer_order, 1, _arguments.MAX_ORDER)
        (matrices, valid, behind, backs), made, own, repairs = _relume.bake_glossy(
            *arrays, transfer_order=height, brdf=_arguments.brdf(how), bounces=folded, **options
        )
        surface = (points, made, own, how, arrays[1], options["double_sided"])
        result = GlossyTransfer(matrices, valid, *surface, behind, backs, options["samples"], options["seed"])
    elif gather:
        (vectors, valid, behind, backs), operator, repairs = _relume.bake_direct(*arrays, **options)
        shape = (points, arrays[1], options["normals"], options["double_sided"])
        result = DirectTransfer(vectors, valid, *shape, behind, backs, *operator)
    else:
        vectors, valid, repairs = _relume.bake(*arrays, bounces=folded, **options)
        result = (vectors, valid) if return_valid else vectors
    for repair in repairs:
        # Normals that were not given are no repair.
        if normals is not None or "normal" not in repair:
            warnings.warn(repair, stacklevel=2)
    return result


def light(
    env: str | os.PathLike[str] | ArrayLike,
    *,
    order: int = 5,
    layout: str = "auto",
    rotate: str | Sequence[str] = (),
    window: str = "none",
) -> NDArray[np.float32]:
    """Projects distant light onto spherical harmonics.

    Returns float32 [order², 3]: radiance, linear Rec. 709, from directions that point away from the scene. No π, cosine or albedo is folded in. It is
    what `relume light` writes.

    env     `"constant:R,G,B"`, `"sun:X,Y,Z,DEG,R,G,B"` (toward the sun, its diameter), `"sky:ELEVATION,TURBIDITY"`, the path of an image (.hdr, .exr,
            .pfm, …) or of a light.json; or an array [H, W, 3] of linear radiance in floats, rows from the top, latitude and longitude: +Y up, +Z in
            the centre, +X left of it.
    order   1…32.
    layout  how an image is wrapped around the scene: "latlong", "angular", "vcross", "hcross"; "auto" goes by the shape of a file, and is "latlong"
            for an array.
    rotate  turns, right-handed, the first one first: "X,Y,Z:DEG", such as "0,1,0:90", or several of them.
    window  against ringing: "none", "hann" (cutoff at the order), "auto" (the least blur that keeps the light positive).

    Raises ValueError, in one line that starts with the name of the argument; OSError for a file that cannot be read.
    """
    turns = [rotate] if isinstance(rotate, str) else list(rotate)
    for name, value in (("layout", layout), ("window", window), *(("rotate", turn) for turn in turns)):
        if not isinstance(value, str):
            raise ValueError(f"{name}: {value!r} is not text")
    source: str | os.PathLike[str] | NDArray[np.float32]
    if isinstance(env, (str, os.PathLike)):
        source = env
    else:
        source = _arguments.image(env)
        layout = "latlong" if layout == "auto" else layout
    result, notes = _relume.light(
        source,
        order=_arguments.integer("order", order, 1, _arguments.MAX_ORDER),
        layout=layout,
        rotate=turns,
        window=window,
    )
    for note in notes:
        warnings.warn(note, stacklevel=2)
    return result


@overload
def shade(transfer: ArrayLike, light: ArrayLike, *, albedo: ArrayLike | None = ...) -> NDArray[np.float32]: ...
@overload
def shade(
    transfer: GlossyTransfer, light: ArrayLike | Emitters, *, eye: ArrayLike, bounces: int = ...
) -> NDArray[np.float32]: ...
@overload
def shade(
    transfer: DirectTransfer, light: ArrayLike | Emitters, *, albedo: ArrayLike | None = ..., bounces: int = ...
) -> NDArray[np.float32]: ...
def shade(
    transfer: ArrayLike | GlossyTransfer | DirectTransfer,
    light: ArrayLike | Emitters,
    *,
    albedo: ArrayLike | None = None,
    eye: ArrayLike | None = None,
    bounces: int = 0,
) -> NDArray[np.float32]:
    """The radiance that leaves every vertex under a light: albedo × Σ transfer × light, or what glossy surfaces send toward an eye.

    Returns float32 [V, 3], linear Rec. 709, in the units of the light. A truncated light rings, so that small negative values are possible.

    transfer  [V, C, n²], from `relume.bake` or `transfer` of `relume export`; or a `relume.GlossyTransfer`, or a `relume.DirectTransfer`.
    light     [m², 3], from `relume.light`; or [V, m², 3], one for each vertex, from `Emitters.light_at`, for transfer without bounces. Of a higher order than
              the transfer it is cut off, of a lower one padded with zeros. With a DirectTransfer, or a GlossyTransfer without bounces, also
              `relume.Emitters`, which may stand anywhere, as lamps in a room do. What `light_at` gives is right for emitters outside the object's convex hull
              alone: transfer knows what is in the way, not how far away it is.
    albedo    the receivers' own, linear, in 0…1: a number, three, or [V, 3]. None leaves it out: radiance for a white surface. A glossy transfer has
              its own.
    eye       [3], only and always with a glossy transfer: where it is seen from. What turns its back to it is black; nothing hides anything.
    bounces   0…64 interreflections, with a DirectTransfer, or a GlossyTransfer that has none folded in. For each of the latter's the rays of the bake are
              cast again, 4096 for each vertex at most.

    The GIL is released. The first call with a glossy transfer, and each one with its bounces, tabulates the BRDF, which takes a moment. Ctrl-C ends the casting
    of rays at once.

    Raises ValueError, in one line that starts with the name of the argument.
    """
    if isinstance(transfer, GlossyTransfer):
        if albedo is not None:
            raise ValueError("albedo: a glossy transfer has its own; leave it out")
        return _toward(transfer, light, eye, bounces)
    if eye is not None:
        raise ValueError("eye: diffuse surfaces look the same from everywhere; leave it out")
    if isinstance(transfer, DirectTransfer):
        arrays = _arguments.direct(transfer)
        vectors = arrays["vectors"]
        count = _arguments.integer("bounces", bounces, 0, _arguments.MAX_BOUNCES)
        if isinstance(light, Emitters):
            radiance = _relume.shade_direct_near(light._native, _arguments.triangles(transfer, len(vectors)), arrays, bounces=count)
        else:
            radiance = _relume.shade_direct(_light(light, vectors), arrays, bounces=count)
    else:
        if bounces != 0:
            raise ValueError("bounces: are made with what relume.bake(…, gather=True) or transfer='glossy' gives; leave them out")
        vectors = _arguments.transfer(transfer)
        if isinstance(light, Emitters):
            raise ValueError("light: transfer vectors do not say where vertices stand; give emitters.light_at(vertices)")
        radiance = _relume.shade(vectors, _light(light, vectors))
    if albedo is None:
        return radiance
    return radiance * _arguments.albedo(albedo, len(vectors))


def _toward(transfer: GlossyTransfer, light: ArrayLike | Emitters, eye: ArrayLike | None, bounces: int) -> NDArray[np.float32]:
    """What glossy surfaces send toward an eye."""
    x, y, z = _arguments.eye(eye)
    place = (float(x), float(y), float(z))
    matrices = _arguments.matrices(transfer.matrices)
    count = _arguments.integer("bounces", bounces, 0, _arguments.MAX_BOUNCES)
    if count == 0 and not isinstance(light, Emitters):
        return _relume.shade_glossy(matrices, _light(light, matrices), eye=place, surfaces=transfer.surfaces())
    sides = _arguments.sides(transfer, matrices)
    surfaces = _arguments.surfaces(transfer, len(matrices))
    source = light._native if isinstance(light, Emitters) else _arguments.light_for(light, len(matrices))
    return _relume.shade_glossy_near(source, surfaces, sides, bounces=count, eye=place, surfaces=transfer.surfaces())


def _light(light: ArrayLike, transfer: NDArray[np.float32]) -> NDArray[np.float32]:
    """Coefficients for transfer [V, C, …, n²]."""
    made = _arguments.light_for(light, len(transfer))
    _arguments.unfolded("transfer", transfer, made)
    return made

"""Arguments as people give them, checked and brought into the form the native half takes.

Every refusal is one line that starts with the name of the argument.
"""

from __future__ import annotations

import math
import operator
import os
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._brdf import Ggx, Lambert, Measured, Phong
from ._direct import DirectTransfer

if TYPE_CHECKING:
    from ._glossy import GlossyTransfer


def array(name: str, value: ArrayLike, kinds: str, wanted: str) -> NDArray[Any]:
    """`value` as an array whose dtype is of one of `kinds` (the letters of `dtype.kind`)."""
    try:
        made = np.asarray(value)
    except ValueError:
        raise ValueError(f"{name}: not an array (are its rows of different lengths?); give {wanted}") from None
    # An empty list has the dtype of numbers it does not have.
    if made.dtype.kind not in kinds and made.size > 0:
        raise ValueError(f"{name}: holds {made.dtype}; give {wanted}")
    return made


def shape(made: NDArray[Any]) -> str:
    """As messages say it."""
    return "[" + ", ".join(map(str, made.shape)) + "]"


def floats(name: str, made: NDArray[Any]) -> NDArray[np.float32]:
    """Contiguous 32-bit floats, every one finite."""
    with np.errstate(over="ignore"):
        narrow = np.asarray(made, dtype=np.float32, order="C")
    finite = np.isfinite(narrow)
    if not finite.all():
        place = ", ".join(map(str, np.argwhere(~finite)[0]))
        value = made[tuple(np.argwhere(~finite)[0])]
        raise ValueError(f"{name}: [{place}] is {value}, which is not a finite 32-bit number; repair it")
    return narrow


def points(name: str, value: ArrayLike) -> NDArray[np.float32]:
    """Rows of three coordinates."""
    wanted = "an array [V, 3] of floats"
    made = array(name, value, "fiu", wanted)
    if made.ndim != 2 or made.shape[1] != 3:
        raise ValueError(f"{name}: has the shape {shape(made)}; give {wanted}")
    return floats(name, made)


def vertices(value: ArrayLike) -> NDArray[np.float32]:
    """Points, at least one."""
    made = points("vertices", value)
    if len(made) == 0:
        raise ValueError("vertices: there are none; give an array [V, 3] of floats")
    return made


def faces(value: ArrayLike, vertex_count: int) -> NDArray[np.uint32]:
    """Rows of three indices below `vertex_count`, at least one."""
    wanted = "an array [F, 3] of integers, the corners of triangles"
    made = array("faces", value, "iu", wanted)
    if made.ndim == 2 and made.shape[1] == 4:
        raise ValueError("faces: rows of 4 corners are quads; split each [a, b, c, d] into [a, b, c] and [a, c, d]")
    if made.ndim != 2 or made.shape[1] != 3:
        raise ValueError(f"faces: has the shape {shape(made)}; give {wanted}")
    if len(made) == 0:
        raise ValueError(f"faces: there are none; give {wanted}")
    outside = (made < 0) | (made >= vertex_count)
    if outside.any():
        row, column = np.argwhere(outside)[0]
        index = made[row, column]
        raise ValueError(f"faces: [{row}, {column}] is {index}, but the {vertex_count} vertices are numbered from 0 to {vertex_count - 1}")
    return np.ascontiguousarray(made, dtype=np.uint32)


def normals(value: ArrayLike | None, vertex_count: int) -> NDArray[np.float32] | None:
    """One vector for each vertex, or none at all."""
    if value is None:
        return None
    made = points("normals", value)
    if len(made) != vertex_count:
        raise ValueError(f"normals: {len(made)} for {vertex_count} vertices; give one for each")
    return made


def albedo(value: ArrayLike, vertex_count: int) -> NDArray[np.float32]:
    """Linear albedo [1, 3] or [V, 3]."""
    wanted = "a number, three (linear red, green, blue) or an array [V, 3] of them"
    made = floats("albedo", array("albedo", value, "fiu", wanted))
    if made.shape in ((), (3,)):
        made = np.ascontiguousarray(np.broadcast_to(made, (1, 3)))
    elif made.shape != (vertex_count, 3):
        raise ValueError(f"albedo: has the shape {shape(made)} for {vertex_count} vertices; give {wanted}")
    if made.min() < 0 or made.max() > 1:
        raise ValueError(f"albedo: {made.min():g} … {made.max():g} is not within 0…1, the share of light reflected")
    return made


def integer(name: str, value: object, low: int, high: int) -> int:
    """A whole number from `low` to `high`."""
    try:
        number = operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        raise ValueError(f"{name}: {value!r} is not a whole number") from None
    if not low <= number <= high:
        raise ValueError(f"{name}: {number} is not within {low}…{high}")
    return number


def transfer(value: ArrayLike) -> NDArray[np.float32]:
    """Transfer vectors [V, C, n²]."""
    return _vectors("transfer", value)


def _vectors(name: str, value: ArrayLike) -> NDArray[np.float32]:
    wanted = "what relume.bake returns, an array [V, 1 or 3, order²] of floats"
    made = array(name, value, "f", wanted)
    if made.ndim != 3 or made.shape[1] not in (1, 3) or not _is_order(made.shape[2]):
        raise ValueError(f"{name}: has the shape {shape(made)}; give {wanted}")
    return floats(name, made)


def coefficients(value: ArrayLike) -> NDArray[np.float32]:
    """Coefficients of a light: [n², 3], or [V, n², 3]."""
    wanted = "what relume.light returns, an array [order², 3] of floats, or [V, order², 3]"
    made = array("light", value, "fiu", wanted)
    if made.ndim not in (2, 3) or made.shape[-1] != 3 or not _is_order(made.shape[-2]):
        raise ValueError(f"light: has the shape {shape(made)}; give {wanted}")
    return floats("light", made)


def light_for(value: ArrayLike, vertex_count: int) -> NDArray[np.float32]:
    """Coefficients of a light: [n², 3], or [V, n², 3], one for each vertex."""
    made = coefficients(value)
    if made.ndim == 3 and len(made) != vertex_count:
        raise ValueError(f"light: {len(made)} for {vertex_count} vertices; give one for each, or one for all [order², 3]")
    return made


def light_of(value: ArrayLike) -> NDArray[np.float32]:
    """Coefficients of lights [V, n², 3]."""
    made = coefficients(value)
    if made.ndim != 3:
        raise ValueError(f"light: has the shape {shape(made)}; give one for each vertex, [V, order², 3]")
    return made


def unfolded(name: str, made: NDArray[np.float32], light: NDArray[np.float32]) -> None:
    """Refuses transfer [V, C, …] with bounces for light that varies."""
    if light.ndim == 3 and made.shape[1] == 3:
        what = "has bounces folded in (3 channels), which hold for distant light alone"
        raise ValueError(f"{name}: {what}; bake it with bounces=0, or with gather=True")


def direct(value: DirectTransfer) -> dict[str, NDArray[Any]]:
    """The arrays of a direct transfer."""
    vectors = _vectors("transfer.vectors", value.vectors)
    weights = array("transfer.weights", value.weights, "f", "an array [E, 1 or 3] of floats")
    if weights.ndim != 2 or weights.shape[1] not in (1, 3):
        raise ValueError(f"transfer.weights: has the shape {shape(weights)}; give an array [E, 1 or 3] of floats")
    return {
        "vectors": vectors,
        "valid": flags("transfer.valid", value.valid, len(vectors)),
        "back_vertices": _indices("transfer.back_vertices", value.back_vertices, np.uint32),
        "back_vectors": _vectors("transfer.back_vectors", value.back_vectors),
        "starts": _indices("transfer.starts", value.starts, np.uint64),
        "columns": _indices("transfer.columns", value.columns, np.uint32),
        "weights": floats("transfer.weights", weights),
    }


def triangles(value: DirectTransfer | GlossyTransfer, vertex_count: int) -> dict[str, Any]:
    """The object of a transfer."""
    return {
        "positions": per_vertex("transfer.positions", value.positions, vertex_count),
        "faces": faces(value.faces, vertex_count),
        "normals": normals(value.normals, vertex_count),
        "double_sided": bool(value.double_sided),
    }


def surfaces(value: GlossyTransfer, vertex_count: int) -> dict[str, Any]:
    """The object of a glossy transfer, and how it reflects."""
    return {
        **triangles(value, vertex_count),
        "normals": per_vertex("normals", value.normals, vertex_count),
        "albedo": albedo(value.albedo, vertex_count),
        "brdf": brdf(value.brdf),
    }


def sides(value: GlossyTransfer, made: NDArray[np.float32]) -> dict[str, Any]:
    """The transfer of a glossy one with the matrices `made`, which bounces and enclosed emitters can be added to."""
    if made.shape[1] == 3:
        what = "has bounces folded in (3 channels), which hold for distant light alone"
        raise ValueError(f"transfer: {what}; bake it with bounces=0, and give bounces to relume.shade")
    back = matrices(value.back_matrices, "transfer.back_matrices")
    behind = _indices("transfer.back_vertices", value.back_vertices, np.uint32)
    if len(back) != len(behind) or back.shape[1:] != made.shape[1:]:
        what = f"has the shape {shape(back)} for {len(behind)} back_vertices and matrices {shape(made)}"
        raise ValueError(f"transfer.back_matrices: {what}; bake it again")
    return {
        "matrices": made,
        "valid": flags("transfer.valid", value.valid, len(made)),
        "back_vertices": behind,
        "back_matrices": back,
        "samples": integer("transfer.samples", value.samples, 1, MAX_SAMPLES),
        "seed": integer("transfer.seed", value.seed, 0, MAX_SEED),
    }


def _indices(name: str, value: ArrayLike, dtype: type[np.unsignedinteger[Any]]) -> NDArray[Any]:
    """A list of indices."""
    wanted = "what relume.bake gave, a list of integers from 0"
    made = array(name, value, "iu", wanted)
    if made.ndim != 1 or (made.size > 0 and (made.min() < 0 or made.max() > np.iinfo(dtype).max)):
        raise ValueError(f"{name}: has the shape {shape(made)} or numbers below 0; give {wanted}")
    return np.ascontiguousarray(made, dtype=dtype)


def flags(name: str, value: ArrayLike, vertex_count: int) -> NDArray[np.bool_]:
    """True or False for each vertex."""
    made = array(name, value, "b", "an array [V] of bools")
    if made.shape != (vertex_count,):
        raise ValueError(f"{name}: has the shape {shape(made)} for {vertex_count} vertices; give one for each")
    return np.ascontiguousarray(made, dtype=np.bool_)


def path(value: object) -> str:
    """A path."""
    try:
        return os.fsdecode(value)  # type: ignore[arg-type]
    except TypeError:
        raise ValueError(f"path: {value!r} is not a path") from None


def image(value: ArrayLike) -> NDArray[np.float32]:
    """Radiance [H, W, 3]."""
    wanted = "a path, an analytic light such as 'sky:30,3', or an array [H, W, 3] of linear radiance in floats"
    made = array("env", value, "f", wanted)
    if made.ndim != 3 or made.shape[2] != 3 or made.size == 0:
        raise ValueError(f"env: has the shape {shape(made)}; give {wanted}")
    return floats("env", made)


def is_glossy(transfer: object, *, transfer_order: object, brdf: object, return_valid: object, gather: object, bounces: object) -> bool:
    """Whether matrices are to be baked; refuses arguments of the other kind."""
    if transfer not in ("diffuse", "glossy"):
        raise ValueError(f"transfer: {transfer!r} is neither 'diffuse' nor 'glossy'")
    for name, given in (("transfer_order", transfer_order), ("brdf", brdf)):
        if given is not None and transfer == "diffuse":
            raise ValueError(f"{name}: is of transfer='glossy'; give both or neither")
    if return_valid and transfer == "glossy":
        raise ValueError("return_valid: a glossy result has it as .valid; leave it out")
    if gather and transfer == "glossy":
        raise ValueError("gather: is of diffuse transfer; leave it out, or transfer='glossy'")
    if gather and return_valid:
        raise ValueError("return_valid: a result with gather has it as .valid; leave it out")
    if gather and bounces != 0:
        raise ValueError("bounces: with gather=True they are made where light is known; leave them out, and give them to relume.shade")
    return transfer == "glossy"


def matrices(value: ArrayLike, name: str = "matrices") -> NDArray[np.float32]:
    """Transfer matrices [V, C, m², n²]."""
    wanted = "an array [V, 1 or 3, transfer order², order²] of floats"
    made = array(name, value, "f", wanted)
    if made.ndim != 4 or made.shape[1] not in (1, 3) or not (_is_order(made.shape[2]) and _is_order(made.shape[3])):
        raise ValueError(f"{name}: has the shape {shape(made)}; give {wanted}")
    return floats(name, made)


def order_of(value: NDArray[np.float32]) -> int:
    """The transfer order of matrices."""
    return math.isqrt(matrices(value).shape[2])


def per_vertex(name: str, value: ArrayLike, vertex_count: int) -> NDArray[np.float32]:
    """Rows of three, one for each vertex."""
    made = points(name, value)
    if len(made) != vertex_count:
        raise ValueError(f"{name}: {len(made)} for {vertex_count} vertices; give one for each")
    return made


def eye(value: ArrayLike | None) -> NDArray[np.float64]:
    """A place [3]."""
    wanted = "a place [3] that glossy surfaces are seen from"
    if value is None:
        raise ValueError(f"eye: missing; give {wanted}")
    made = np.asarray(array("eye", value, "fiu", wanted), dtype=np.float64)
    if made.shape != (3,):
        raise ValueError(f"eye: has the shape {shape(made)}; give {wanted}")
    if not np.isfinite(made).all():
        raise ValueError(f"eye: {made} is not finite")
    return made


def number(name: str, value: object, low: float, high: float) -> float:
    """A number from `low` to `high`."""
    try:
        made = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise ValueError(f"{name}: {value!r} is not a number") from None
    if not low <= made <= high:
        raise ValueError(f"{name}: {made:g} is not within {low:g}…{high:g}")
    return made


def color(name: str, value: ArrayLike) -> list[float]:
    """Three linear shares."""
    wanted = "a number or three (linear red, green, blue)"
    made = floats(name, array(name, value, "fiu", wanted))
    if made.shape not in ((), (3,)):
        raise ValueError(f"{name}: has the shape {shape(made)}; give {wanted}")
    if made.min() < 0 or made.max() > 1:
        raise ValueError(f"{name}: {made.min():g} … {made.max():g} is not within 0…1")
    return [float(share) for share in np.broadcast_to(made, (3,))]


def brdf(value: object) -> tuple[str, list[float], str]:
    """How surfaces reflect, as the native half takes it: the model, its numbers, its file."""
    if isinstance(value, Lambert):
        return "lambert", [], ""
    if isinstance(value, Phong):
        diffuse, specular = color("brdf.kd", value.kd), color("brdf.ks", value.ks)
        brightest = max(d + s for d, s in zip(diffuse, specular))
        # The sums of shares that were rounded to 32 bits.
        if brightest > 1 + 1e-6:
            raise ValueError(f"brdf: kd and ks together reflect {brightest:g} of what arrives; their sum must not pass 1")
        return "phong", [*diffuse, *specular, number("brdf.exponent", value.exponent, 0, 1e6)], ""
    if isinstance(value, Ggx):
        return "ggx", [number("brdf.metallic", value.metallic, 0, 1), number("brdf.roughness", value.roughness, 0, 1)], ""
    if isinstance(value, Measured):
        try:
            return "merl", [], os.fsdecode(value.path)
        except TypeError:
            raise ValueError(f"brdf.path: {value.path!r} is not a path") from None
    raise ValueError(f"brdf: {value!r} is not a relume.Lambert, Phong, Ggx or Measured")


def _is_order(count: int) -> bool:
    return count in {order * order for order in range(1, MAX_ORDER + 1)}


MAX_ORDER = 32
MAX_SAMPLES = 1 << 22
MAX_BOUNCES = 64
MAX_BUDGET = 1 << 31
MAX_THREADS = 1024
MAX_SEED = (1 << 64) - 1

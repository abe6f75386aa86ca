"""Arguments as people give them, checked and brought into the form the native half takes.

Every refusal is one line that starts with the name of the argument.
"""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


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


def _shape(made: NDArray[Any]) -> str:
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
        raise ValueError(f"{name}: has the shape {_shape(made)}; give {wanted}")
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
        raise ValueError(f"faces: has the shape {_shape(made)}; give {wanted}")
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
        raise ValueError(f"albedo: has the shape {_shape(made)} for {vertex_count} vertices; give {wanted}")
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
    wanted = "what relume.bake returns, an array [V, 1 or 3, order²] of floats"
    made = array("transfer", value, "f", wanted)
    if made.ndim != 3 or made.shape[1] not in (1, 3) or not _is_order(made.shape[2]):
        raise ValueError(f"transfer: has the shape {_shape(made)}; give {wanted}")
    return floats("transfer", made)


def coefficients(value: ArrayLike) -> NDArray[np.float32]:
    """Coefficients of a light [n², 3]."""
    wanted = "what relume.light returns, an array [order², 3] of floats"
    made = array("light", value, "fiu", wanted)
    if made.ndim != 2 or made.shape[1] != 3 or not _is_order(made.shape[0]):
        raise ValueError(f"light: has the shape {_shape(made)}; give {wanted}")
    return floats("light", made)


def image(value: ArrayLike) -> NDArray[np.float32]:
    """Radiance [H, W, 3]."""
    wanted = "a path, an analytic light such as 'sky:30,3', or an array [H, W, 3] of linear radiance in floats"
    made = array("env", value, "f", wanted)
    if made.ndim != 3 or made.shape[2] != 3 or made.size == 0:
        raise ValueError(f"env: has the shape {_shape(made)}; give {wanted}")
    return floats("env", made)


def _is_order(count: int) -> bool:
    return count in {order * order for order in range(1, MAX_ORDER + 1)}


MAX_ORDER = 32
MAX_SAMPLES = 1 << 22
MAX_BOUNCES = 64
MAX_THREADS = 1024
MAX_SEED = (1 << 64) - 1

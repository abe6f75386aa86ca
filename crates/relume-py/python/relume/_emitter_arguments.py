"""Emitters as people describe them, checked and brought into the form the native half takes."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments
from ._shapes import IDENTITY, Blocks, Cuboid, Disc, Emitter, Mesh, Quad, Sphere

MAX_LENGTH = 1e9
MAX_CORNERS = 1 << 22
MAX_EXPONENT = 8

Arrays: TypeAlias = tuple[NDArray[np.float64], NDArray[np.uint32], NDArray[np.uint32]]
Made: TypeAlias = tuple[str, list[float], Arrays | None]
Entry: TypeAlias = tuple[str, Made, tuple[str, NDArray[np.float32]], bool, int, NDArray[np.float64]]


def entry(index: int, emitter: object) -> Entry:
    """One emitter of a list."""
    if not isinstance(emitter, Emitter):
        raise ValueError(f"emitters: [{index}] is {emitter!r}, which is not a relume.Emitter")
    at = f"emitters[{index}]."
    if emitter.name is not None and not isinstance(emitter.name, str):
        raise ValueError(f"{at}name: {emitter.name!r} is not text")
    return (
        f"emitter {index}" if emitter.name is None else emitter.name,
        shape(at, emitter.shape),
        radiance(at, emitter),
        bool(emitter.two_sided),
        _arguments.integer(f"{at}exponent", emitter.exponent, 0, MAX_EXPONENT),
        pose(f"{at}pose", IDENTITY if emitter.pose is None else emitter.pose),
    )


def shape(at: str, value: object) -> Made:
    """A shape by its name, its numbers and its mesh."""

    def lengths(*names: str) -> list[float]:
        return [length(f"{at}shape.{name}", getattr(value, name)) for name in names]

    if isinstance(value, Quad):
        return "quad", lengths("width", "height"), None
    if isinstance(value, Disc):
        return "disc", lengths("radius"), None
    if isinstance(value, Sphere):
        return "sphere", lengths("radius"), None
    if isinstance(value, Cuboid):
        return "cuboid", lengths("x", "y", "z"), None
    if isinstance(value, Blocks):
        most = MAX_CORNERS // 4
        columns = _arguments.integer(f"{at}shape.columns", value.columns, 1, most)
        rows = _arguments.integer(f"{at}shape.rows", value.rows, 1, most // columns)
        fill = _arguments.number(f"{at}shape.fill", value.fill, 0, 1)
        if fill == 0:
            raise ValueError(f"{at}shape.fill: must be above 0")
        return "blocks", [columns, rows, *lengths("width", "height"), fill], None
    if isinstance(value, Mesh):
        return "mesh", [], mesh(f"{at}shape.", value)
    raise ValueError(f"{at}shape: {value!r} is not a relume.Quad, Disc, Sphere, Cuboid, Blocks or Mesh")


def length(name: str, value: object) -> float:
    """Metres, above 0."""
    made = _arguments.number(name, value, 0, MAX_LENGTH)
    if made == 0:
        raise ValueError(f"{name}: 0 is no length; it must be above 0")
    return made


def mesh(at: str, value: Mesh) -> Arrays:
    """Corners, the indices of all faces, and how many each has."""
    wanted = "an array [P, 3] of floats"
    positions = _arguments.array(f"{at}vertices", value.vertices, "fiu", wanted)
    if positions.ndim != 2 or positions.shape[1] != 3:
        raise ValueError(f"{at}vertices: has the shape {_arguments.shape(positions)}; give {wanted}")
    try:
        faces = list(value.faces)  # type: ignore[arg-type]
    except TypeError:
        raise ValueError(f"{at}faces: {value.faces!r} is no list; give [F, 3] integers, or a list of faces") from None
    rows = [face(f"{at}faces", index, row, len(positions)) for index, row in enumerate(faces)]
    if not rows:
        raise ValueError(f"{at}faces: there are none; give [F, 3] integers, or a list of faces")
    counts = np.array([len(row) for row in rows], np.uint32)
    return finite(f"{at}vertices", positions), np.concatenate(rows), counts


def face(name: str, index: int, row: Any, vertex_count: int) -> NDArray[np.uint32]:
    """The corners of one face."""
    made = _arguments.array(f"{name}[{index}]", row, "iu", "the indices of its corners")
    if made.ndim != 1 or len(made) < 3:
        raise ValueError(f"{name}: [{index}] has the shape {_arguments.shape(made)}; give it three corners or more")
    if made.min() < 0 or made.max() >= vertex_count:
        wrong = made[(made < 0) | (made >= vertex_count)][0]
        raise ValueError(f"{name}: [{index}] has the corner {wrong}, but the {vertex_count} vertices are numbered from 0 to {vertex_count - 1}")
    return made.astype(np.uint32)


def radiance(at: str, emitter: Emitter) -> tuple[str, NDArray[np.float32]]:
    """How it varies, and rows of three."""
    if emitter.radiance is None and emitter.vertex_radiance is not None:
        return "vertex", _arguments.points(f"{at}vertex_radiance", emitter.vertex_radiance)
    if emitter.radiance is None or emitter.vertex_radiance is not None:
        raise ValueError(f"{at}radiance: give it or vertex_radiance, one of them; 0 where it only blocks")
    wanted = "a number, three (linear red, green, blue) or an array [F, 3], one for each face"
    made = _arguments.array(f"{at}radiance", emitter.radiance, "fiu", wanted)
    made = _arguments.floats(f"{at}radiance", made)
    if made.shape in ((), (3,)):
        return "uniform", np.ascontiguousarray(np.broadcast_to(made, (1, 3)))
    if made.ndim != 2 or made.shape[1] != 3:
        raise ValueError(f"{at}radiance: has the shape {_arguments.shape(made)}; give {wanted}")
    return "face", made


def pose(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """World from emitter [4, 4]."""
    wanted = "a matrix [4, 4] whose last row is 0, 0, 0, 1"
    made = _arguments.array(name, value, "fiu", wanted)
    if made.shape != (4, 4):
        raise ValueError(f"{name}: has the shape {_arguments.shape(made)}; give {wanted}")
    if tuple(made[3]) != (0, 0, 0, 1):
        raise ValueError(f"{name}: its last row is {made[3]}; give {wanted}")
    return finite(name, made)


def finite(name: str, made: NDArray[Any]) -> NDArray[np.float64]:
    """Contiguous 64-bit floats, every one finite."""
    wide = np.asarray(made, dtype=np.float64, order="C")
    if not np.isfinite(wide).all():
        place = ", ".join(map(str, np.argwhere(~np.isfinite(wide))[0]))
        raise ValueError(f"{name}: [{place}] is not finite; repair it")
    return wide


def place(name: str, value: ArrayLike) -> tuple[float, float, float]:
    """A point in the world."""
    wanted = "a place [3] in the world"
    made = _arguments.array(name, value, "fiu", wanted)
    if made.shape != (3,):
        raise ValueError(f"{name}: has the shape {_arguments.shape(made)}; give {wanted}")
    x, y, z = finite(name, made)
    return float(x), float(y), float(z)

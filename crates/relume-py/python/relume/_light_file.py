"""Light that varies by vertex, in files."""

from __future__ import annotations

import os

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments, _relume


def read_light(path: str | os.PathLike[str]) -> NDArray[np.float32]:
    """Light that varies by vertex, from a light.npz of `relume.write_light` or `relume light --emitters` (docs/format.md).

    Returns float32 [V, n², 3]: radiance, as of `relume.Emitters.light_at`, rows as in the file.

    path  the file.

    Raises OSError for a file that cannot be read, ValueError where it is no such file.
    """
    return _relume.read_light(_arguments.path(path))


def write_light(
    path: str | os.PathLike[str],
    light: ArrayLike,
    *,
    positions: ArrayLike,
    normals: ArrayLike | None = None,
    valid: ArrayLike | None = None,
) -> None:
    """Writes light that varies by vertex as a light.npz (docs/format.md), which `relume shade`, `render` and `relume.read_light` take.

    path       the file, written whole or not at all.
    light      [V, n², 3]: radiance, as of `relume.Emitters.light_at`.
    positions  [V, 3]: where the vertices stand.
    normals    [V, 3]; zero unless given. The program does not ask for them.
    valid      bool [V]: False where a vertex lies inside something; all True unless given.

    Raises OSError where it cannot be written, ValueError, in one line that starts with the name of the argument, for everything that is not as above.
    """
    rows = _arguments.light_of(light)
    count = len(rows)
    flags = np.ones(count, bool) if valid is None else _arguments.flags("valid", valid, count)
    facing = np.zeros((count, 3), np.float32) if normals is None else _arguments.per_vertex("normals", normals, count)
    places = _arguments.per_vertex("positions", positions, count)
    _relume.write_light(_arguments.path(path), rows, positions=places, normals=facing, valid=flags)

"""The native half: arguments are checked and laid out by `relume`, which is what to use."""

from os import PathLike

import numpy as np
from numpy.typing import NDArray

__version__: str

def bake(
    vertices: NDArray[np.float32],
    faces: NDArray[np.uint32],
    *,
    normals: NDArray[np.float32] | None,
    albedo: NDArray[np.float32],
    order: int,
    samples: int,
    bounces: int,
    seed: int,
    threads: int | None,
    double_sided: bool,
) -> tuple[NDArray[np.float32], NDArray[np.bool_], list[str]]: ...
def bake_glossy(
    vertices: NDArray[np.float32],
    faces: NDArray[np.uint32],
    *,
    normals: NDArray[np.float32] | None,
    albedo: NDArray[np.float32],
    order: int,
    transfer_order: int | None,
    brdf: tuple[str, list[float], str],
    samples: int,
    bounces: int,
    seed: int,
    threads: int | None,
    double_sided: bool,
) -> tuple[NDArray[np.float32], NDArray[np.bool_], NDArray[np.float32], NDArray[np.float32], list[str]]: ...
def light(
    env: str | PathLike[str] | NDArray[np.float32],
    *,
    order: int,
    layout: str,
    rotate: list[str],
    window: str,
) -> tuple[NDArray[np.float32], list[str]]: ...
def shade(transfer: NDArray[np.float32], light: NDArray[np.float32]) -> NDArray[np.float32]: ...
def shade_glossy(
    matrices: NDArray[np.float32], light: NDArray[np.float32], *, eye: tuple[float, float, float], surfaces: _Surfaces
) -> NDArray[np.float32]: ...
def surfaces(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    albedo: NDArray[np.float32],
    *,
    brdf: tuple[str, list[float], str],
    order: int,
) -> _Surfaces: ...

class _Surfaces: ...

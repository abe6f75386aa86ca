"""The native half: arguments are checked and laid out by `relume`, which is what to use."""

from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._emitter_arguments import Entry

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
) -> tuple[
    tuple[NDArray[np.float32], NDArray[np.bool_], NDArray[np.uint32], NDArray[np.float32]],
    NDArray[np.float32],
    NDArray[np.float32],
    list[str],
]: ...
def bake_direct(
    vertices: NDArray[np.float32],
    faces: NDArray[np.uint32],
    *,
    normals: NDArray[np.float32] | None,
    albedo: NDArray[np.float32],
    order: int,
    samples: int,
    seed: int,
    threads: int | None,
    double_sided: bool,
) -> tuple[
    tuple[NDArray[np.float32], NDArray[np.bool_], NDArray[np.uint32], NDArray[np.float32]],
    tuple[NDArray[np.int64], NDArray[np.uint32], NDArray[np.float32]],
    list[str],
]: ...
def emitters(entries: list[Entry]) -> _Emitters: ...
def load_emitters(path: str) -> tuple[_Emitters, list[str]]: ...
def emitter_poses(emitters: _Emitters) -> list[tuple[str, list[float]]]: ...
def set_pose(emitters: _Emitters, emitter: int, pose: NDArray[np.float64]) -> None: ...
def light_at(emitters: _Emitters, positions: NDArray[np.float32], *, order: int) -> NDArray[np.float32]: ...
def sampled_light_at(
    emitters: _Emitters,
    positions: NDArray[np.float32],
    *,
    transfer: NDArray[np.float32],
    albedo: NDArray[np.float32],
    order: int,
    budget: int | None,
    epsilon: float | None,
) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], float]: ...
def incident(emitters: _Emitters, point: tuple[float, float, float], *, order: int) -> tuple[NDArray[np.float64], float, float]: ...
def read_light(path: str) -> NDArray[np.float32]: ...
def write_light(
    path: str,
    light: NDArray[np.float32],
    *,
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    valid: NDArray[np.bool_],
) -> None: ...
def light(
    env: str | PathLike[str] | NDArray[np.float32],
    *,
    order: int,
    layout: str,
    rotate: list[str],
    window: str,
) -> tuple[NDArray[np.float32], list[str]]: ...
def shade(transfer: NDArray[np.float32], light: NDArray[np.float32]) -> NDArray[np.float32]: ...
def shade_direct(
    light: NDArray[np.float32], transfer: dict[str, NDArray[Any]], *, bounces: int
) -> NDArray[np.float32]: ...
def shade_direct_near(
    emitters: _Emitters, object: dict[str, Any], transfer: dict[str, NDArray[Any]], *, bounces: int
) -> NDArray[np.float32]: ...
def shade_glossy(
    matrices: NDArray[np.float32], light: NDArray[np.float32], *, eye: tuple[float, float, float], surfaces: _Surfaces
) -> NDArray[np.float32]: ...
def shade_glossy_near(
    light: _Emitters | NDArray[np.float32],
    object: dict[str, Any],
    transfer: dict[str, Any],
    *,
    bounces: int,
    eye: tuple[float, float, float],
    surfaces: _Surfaces,
) -> NDArray[np.float32]: ...
def surfaces(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    albedo: NDArray[np.float32],
    *,
    brdf: tuple[str, list[float], str],
    order: int,
) -> _Surfaces: ...

class _Emitters: ...
class _Surfaces: ...

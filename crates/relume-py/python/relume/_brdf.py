"""How surfaces reflect."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

Color: TypeAlias = float | Sequence[float]


@dataclass(frozen=True)
class Lambert:
    """Diffuse, of the `albedo` given beside it."""


@dataclass(frozen=True)
class Phong:
    """Diffuse, and a cosine power about the mirror direction: kd/π + ks (n + 2)/(2π) max(0, R·ω)ⁿ, n the exponent.

    Colours are a number or three, linear, in 0…1, and their sum too; `albedo` does not matter.
    """

    kd: Color = 0.5
    ks: Color = 0.25
    exponent: float = 20.0


@dataclass(frozen=True)
class Ggx:
    """The metallic-roughness material of glTF.

    base_color  a number or three, linear, in 0…1; None takes the `albedo` given beside it.
    metallic    0…1.
    roughness   0…1; the width of the lobe is its square.
    """

    base_color: Color | None = None
    metallic: float = 0.0
    roughness: float = 0.5


@dataclass(frozen=True)
class Measured:
    """As measured, isotropic: `path` is a .binary file of the MERL database. `albedo` does not matter."""

    path: str | os.PathLike[str]


Brdf: TypeAlias = Lambert | Phong | Ggx | Measured

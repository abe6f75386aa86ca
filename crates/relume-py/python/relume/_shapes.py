"""What emitters look like, and what they shine. Lengths are metres, in the emitter's own space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Quad:
    """A rectangle `width` × `height` about the origin in the plane z = 0, which shines toward +z.

    Its corners run counter-clockwise from the bottom left, as +z sees them.
    """

    width: float
    height: float


@dataclass(frozen=True)
class Disc:
    """A disc of `radius` about the origin in the plane z = 0, which shines toward +z: a regular polygon of 48 corners and of the disc's area."""

    radius: float


@dataclass(frozen=True)
class Sphere:
    """A sphere of `radius` about the origin, which shines outward, the same everywhere."""

    radius: float


@dataclass(frozen=True)
class Cuboid:
    """A box about the origin, `x` × `y` × `z`, which shines outward. Its faces are −x, +x, −y, +y, −z, +z."""

    x: float
    y: float
    z: float


@dataclass(frozen=True)
class Blocks:
    """`columns` × `rows` rectangles, together `width` × `height`, about the origin in the plane z = 0, which shine toward +z.

    Each is `fill` (above 0, at most 1) of its cell's sides. Faces run row after row from the top, as +z sees them from the left.
    """

    columns: int
    rows: int
    width: float
    height: float
    fill: float = 1.0


@dataclass(frozen=True, eq=False)
class Mesh:
    """Flat convex faces, counter-clockwise seen from the side that shines.

    vertices  [P, 3] floats.
    faces     [F, 3] integers or [F, 4], or a list of faces of three corners or more each. Those without an area are left out.
    """

    vertices: ArrayLike
    faces: ArrayLike | Sequence[ArrayLike]


Shape: TypeAlias = Quad | Disc | Sphere | Cuboid | Blocks | Mesh


@dataclass(frozen=True, eq=False)
class Emitter:
    """A shape that shines, or a black one that only blocks what shines behind it. A black body: it reflects nothing.

    shape            relume.Quad, Disc, Sphere, Cuboid, Blocks or Mesh.
    radiance         linear Rec. 709, finite, in 0…1e20, in the units of the distant light: a number, three, or [F, 3], one for each face. 0 is black.
    vertex_radiance  in place of `radiance`: [P, 3], one for each corner of the shape, linear between them over triangles.
    pose             [4, 4], world from emitter: pose @ (x, y, z, 1) is a point in the world. A rotation, a uniform scale above 0 and a translation; None
                     leaves it where it is. Radiance does not change with the scale.
    two_sided        whether the backs of faces shine as the fronts do; otherwise they are black. They block either way.
    exponent         0…8: radiance falls with this power of the cosine to the face's normal; 0 is diffuse. Not of spheres.
    name             for messages; "emitter 0", "emitter 1", … by its place unless given.
    """

    shape: Shape
    radiance: ArrayLike | None = None
    vertex_radiance: ArrayLike | None = None
    pose: ArrayLike | None = None
    two_sided: bool = False
    exponent: int = 0
    name: str | None = None


IDENTITY = np.eye(4)

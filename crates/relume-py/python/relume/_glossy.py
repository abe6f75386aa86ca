"""What a glossy bake gives."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _arguments, _relume
from ._brdf import Brdf


@dataclass(frozen=True, eq=False)
class GlossyTransfer:
    """What `relume.bake(…, transfer="glossy")` gives and `relume.shade` takes: all that radiance toward an eye depends on beside light and eye.

    matrices       float32 [V, C, m², n²]: a = matrices[v, c] @ light[:, c] are the m² coefficients of the radiance that arrives at vertex v, above its
                   own horizon (below it they mean nothing). Neither cosine nor π nor any property of the receiver is folded in. C is 1 without
                   bounces, else 3.
    valid          bool [V]: False where a vertex lies inside something and its matrices were filled from its neighbours.
    positions      float32 [V, 3].
    normals        float32 [V, 3], of length 1: those that were given, or that were made.
    albedo         float32 [V, 3], linear; black where no face uses a vertex.
    brdf           how it reflects. `dataclasses.replace(transfer, brdf=…)` looks at the same light with another surface. Bounces that `relume.shade` makes
                   are by that one; what was folded in when it was baked stays.
    faces          uint32 [F, 3].
    double_sided   whether the backs of faces reflect.
    back_vertices  uint32 [B], ascending: the vertices that have a back side.
    back_matrices  float32 [B, C, m², n²]: the matrices of these, for the flipped normals.
    samples        rays for each side, as the bake was asked for; bounces that `relume.shade` makes cast as many, 4096 at most.
    seed           chose their directions.

    What follows `brdf` is for bounces, and for emitters that stand within the object.

    Surfaces are tabulated once: make another with `dataclasses.replace` rather than write into the arrays.
    """

    matrices: NDArray[np.float32]
    valid: NDArray[np.bool_]
    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    albedo: NDArray[np.float32]
    brdf: Brdf
    faces: NDArray[np.uint32]
    double_sided: bool
    back_vertices: NDArray[np.uint32]
    back_matrices: NDArray[np.float32]
    samples: int
    seed: int
    # Tabulated when it is shaded first.
    _surfaces: list[_relume._Surfaces] = field(default_factory=list, init=False, repr=False)

    def surfaces(self) -> _relume._Surfaces:
        """What the surfaces make of arriving radiance, tabulated once."""
        if not self._surfaces:
            vertices = len(self.matrices)
            self._surfaces.append(
                _relume.surfaces(
                    _arguments.per_vertex("positions", self.positions, vertices),
                    _arguments.per_vertex("normals", self.normals, vertices),
                    _arguments.albedo(self.albedo, vertices),
                    brdf=_arguments.brdf(self.brdf),
                    order=_arguments.order_of(self.matrices),
                )
            )
        return self._surfaces[0]

    def __getstate__(self) -> dict[str, object]:
        # Tables are not pickled: they are made again.
        return {**self.__dict__, "_surfaces": []}

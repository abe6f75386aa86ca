"""What a bake with the gather operator gives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class DirectTransfer:
    """What `relume.bake(…, gather=True)` gives and `relume.shade(…, bounces=…)` takes: direct transfer, and how light bounces on, whatever lit it.

    A side is the front of a vertex, or the back of one on a double-sided surface: V + B of them, fronts first.

    vectors        float32 [V, 1, n²]: direct transfer of the fronts, as `relume.bake` gives it without bounces.
    valid          bool [V]: False where a vertex lies inside something and its row was filled from its neighbours.
    positions      float32 [V, 3].
    faces          uint32 [F, 3].
    normals        float32 [V, 3], as they were given; None without.
    double_sided   whether the backs of faces reflect.
    back_vertices  uint32 [B], ascending: the vertices that have a back side.
    back_vectors   float32 [B, 1, n²]: direct transfer of these.
    starts         int64 [V + B + 1]: entries starts[i] … starts[i + 1] − 1 of the gather operator are row i.
    columns        uint32 [E]: the side that light comes from, ascending in each row.
    weights        float32 [E, C]: how much of its transferred radiance, its albedo folded in; C is 1 where no albedo has a colour, else 3.

    With G the operator, transferred radiance of all sides after k bounces is E + G E + … + Gᵏ E, E that of direct light.
    """

    vectors: NDArray[np.float32]
    valid: NDArray[np.bool_]
    positions: NDArray[np.float32]
    faces: NDArray[np.uint32]
    normals: NDArray[np.float32] | None
    double_sided: bool
    back_vertices: NDArray[np.uint32]
    back_vectors: NDArray[np.float32]
    starts: NDArray[np.int64]
    columns: NDArray[np.uint32]
    weights: NDArray[np.float32]

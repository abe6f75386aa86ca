"""Lights that stand near."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments, _emitter_arguments, _relume
from ._shapes import Emitter


@dataclass(frozen=True, eq=False)
class Incident:
    """Light of emitters at a point, as if nothing but emitters were there.

    coefficients   float64 [n², 3]: radiance, as of `relume.Emitters.light_at`.
    solid_angle    steradians that emitters cover with the sides they show, black ones too; what shows a black back is left out.
    mean_distance  harmonic mean of the distances to what covers that, by solid angle, metres; infinite where nothing is seen.
    """

    coefficients: NDArray[np.float64]
    solid_angle: float
    mean_distance: float


@dataclass(frozen=True, eq=False)
class SampledLight:
    """Light at vertices from samples of light and its gradient at few points.

    light      float32 [V, n², 3]: as of `relume.Emitters.light_at`.
    positions  float64 [S, 3]: where it was sampled, metres.
    radii      float64 [S]: how far each sample counts, metres.
    weights    float64 [S]: how much, 0…1.
    epsilon    the error that was accepted: the one asked for, or more where the budget did not reach that far.
    """

    light: NDArray[np.float32]
    positions: NDArray[np.float64]
    radii: NDArray[np.float64]
    weights: NDArray[np.float64]
    epsilon: float


class Emitters:
    """Lights that stand near: meshes and spheres that shine, and black ones that only block, in the space of the object (right-handed, y up, metres).

    They hide one another, and reflect nothing. The object's own shadows are in its transfer, which knows what is in the way, not how far away it is:
    `light_at` and what is made of it are for emitters outside the object's convex hull. `relume.shade` takes emitters that stand anywhere, with a
    DirectTransfer or a GlossyTransfer. Radiance is linear Rec. 709.

    >>> import numpy as np, relume
    >>> panel = relume.Emitter(relume.Quad(2, 1), radiance=(12, 11, 9), name="panel")
    >>> lamps = relume.Emitters([panel, relume.Emitter(relume.Sphere(0.1), radiance=200)])
    >>> lamps.set_pose(1, [[1, 0, 0, 0], [0, 1, 0, 5], [0, 0, 1, 0], [0, 0, 0, 1]])
    >>> lamps.light_at([[0, 0, 3], [1, 0, 3]], order=4).shape
    (2, 16, 3)

    The GIL is released in all that takes long. Errors are ValueError, in one line that starts with the name of the argument.
    """

    def __init__(self, emitters: Sequence[Emitter]) -> None:
        """Emitters of these descriptions, which are copied."""
        self._native = _relume.emitters([_emitter_arguments.entry(index, emitter) for index, emitter in enumerate(emitters)])

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Emitters:
        """Emitters of an emitters.json (docs/format.md), or what is emissive in a .glb or .gltf.

        Meshes and images that an emitters.json names are looked for in its own folder and below it. What a person should know about them is said by
        warnings.warn. Raises OSError for a file that cannot be read, ValueError where it means nothing.

        path  the file.
        """
        made = cls.__new__(cls)
        made._native, notes = _relume.load_emitters(_arguments.path(path))
        for note in notes:
            warnings.warn(note, stacklevel=2)
        return made

    def __len__(self) -> int:
        return len(_relume.emitter_poses(self._native))

    def __repr__(self) -> str:
        return f"<relume.Emitters: {', '.join(map(repr, self.names))}>"

    @property
    def names(self) -> list[str]:
        """Their names, in order."""
        return [name for name, _ in _relume.emitter_poses(self._native)]

    def pose(self, emitter: int) -> NDArray[np.float64]:
        """Where one stands: float64 [4, 4], world from emitter.

        emitter  0…len − 1.
        """
        poses = _relume.emitter_poses(self._native)
        _, rows = poses[self._index(emitter, len(poses))]
        return np.array([*rows, 0, 0, 0, 1], np.float64).reshape(4, 4)

    def set_pose(self, emitter: int, pose: ArrayLike) -> None:
        """Moves one; nothing else of it is made anew.

        emitter  0…len − 1.
        pose     [4, 4], world from emitter: pose @ (x, y, z, 1) is a point in the world. A rotation, a uniform scale above 0 and a translation.
        """
        _relume.set_pose(self._native, self._index(emitter, len(self)), _emitter_arguments.pose("pose", pose))

    def light_at(self, positions: ArrayLike, order: int = 5) -> NDArray[np.float32]:
        """Light that arrives at points, exact but for rounding (of emitters whose radiance varies within a face, to 1/256).

        Returns float32 [V, order², 3]: radiance, linear Rec. 709, from directions that point away from the point, as if nothing but emitters were there. No
        π, cosine or albedo is folded in. `relume.shade` takes it. Distant light [order², 3] of the same order may be added to it. It is what
        `relume light --emitters` writes.

        positions  [V, 3], metres.
        order      1…32.
        """
        points = _arguments.points("positions", positions)
        return _relume.light_at(self._native, points, order=_arguments.integer("order", order, 1, _arguments.MAX_ORDER))

    def sampled_light_at(
        self,
        positions: ArrayLike,
        transfer: ArrayLike,
        order: int = 5,
        *,
        albedo: ArrayLike = 1.0,
        budget: int | None = None,
        epsilon: float | None = None,
    ) -> SampledLight:
        """`light_at` of many points from samples of light and its gradient at few, chosen by what they matter to vertices.

        Samples are added where the vertices' radiance under a stand-in for the light is most wrong, until `budget` or `epsilon` is reached: give one or both.
        Light changes smoothly as emitters move.

        positions  [V, 3], metres.
        transfer   [V, C, m²], of the same vertices, as from `relume.bake`.
        order      1…32.
        albedo     the vertices' own, linear, in 0…1: a number, three, or [V, 3].
        budget     the most samples, from 1.
        epsilon    what a cluster of vertices may add to the RMS error of their radiance, above 0.
        """
        points = _arguments.points("positions", positions)
        vectors = _arguments.transfer(transfer)
        if len(vectors) != len(points):
            raise ValueError(f"transfer: {len(vectors)} for {len(points)} positions; give one for each")
        if budget is None and epsilon is None:
            raise ValueError("budget: missing; give it or epsilon, or ask light_at")
        least = np.nextafter(0, 1)
        return SampledLight(
            *_relume.sampled_light_at(
                self._native,
                points,
                transfer=vectors,
                albedo=_arguments.albedo(albedo, len(points)),
                order=_arguments.integer("order", order, 1, _arguments.MAX_ORDER),
                budget=None if budget is None else _arguments.integer("budget", budget, 1, _arguments.MAX_BUDGET),
                epsilon=None if epsilon is None else _arguments.number("epsilon", epsilon, least, np.inf),
            )
        )

    def incident(self, point: ArrayLike, order: int = 5) -> Incident:
        """Light at one point, in float64, and how much of the sphere emitters cover.

        point  [3], metres.
        order  1…32.
        """
        place = _emitter_arguments.place("point", point)
        return Incident(*_relume.incident(self._native, place, order=_arguments.integer("order", order, 1, _arguments.MAX_ORDER)))

    @staticmethod
    def _index(emitter: object, count: int) -> int:
        if count == 0:
            raise ValueError("emitter: there are none")
        return _arguments.integer("emitter", emitter, 0, count - 1)

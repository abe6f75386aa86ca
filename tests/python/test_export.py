"""A scene baked and exported by the program, checked with numpy against closed forms."""

import tempfile
import unittest
from math import atan, pi, sqrt
from pathlib import Path

import numpy as np

import program
from program import MIDDLE, relume

SAMPLES = 1024
ORDER = 3
ALBEDO = (0.8, 0.5, 0.3)
# Coefficient 0 of the light whose radiance is 1 everywhere.
ONE = sqrt(4 * pi)
# A sum of SAMPLES equal f32 numbers, and the rounding of the result.
ROUNDING = 1e-6


def covered_by_ceiling():
    """How much of the cosine-weighted hemisphere of the floor's middle the ceiling covers: the form factor of a parallel rectangle."""
    a = program.CEILING_HALF_WIDTH / program.CEILING_HEIGHT
    b = program.CEILING_HALF_DEPTH / program.CEILING_HEIGHT
    ra, rb = sqrt(1 + a * a), sqrt(1 + b * b)
    return 2 / pi * (a / ra * atan(b / ra) + b / rb * atan(a / rb))


class Export(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.folder = Path(cls.scratch.name)
        cls.scene = cls.folder / "scene.obj"
        program.write_scene(cls.scene)
        cls.direct = cls.bake("direct", "--samples", SAMPLES, "--seed", 7)
        cls.bounced = cls.bake("bounced", "--samples", SAMPLES, "--seed", 7, "--bounces", 2)
        cls.open = cls.bake("unshadowed", "--no-shadows")

    @classmethod
    def bake(cls, name, *flags):
        asset, table = cls.folder / f"{name}.glb", cls.folder / f"{name}.npz"
        colour = ",".join(map(str, ALBEDO))
        relume("bake", cls.scene, "-o", asset, "--order", ORDER, "--albedo", colour, *flags)
        relume("export", asset, "-o", table)
        program.keep_asset(asset, f"python-{name}.glb")
        with np.load(table) as arrays:
            return {key: arrays[key] for key in arrays.files}

    def test_arrays_have_the_agreed_names_shapes_and_types(self):
        count = program.FLOOR**2 + 4
        for table, channels in ((self.direct, 1), (self.bounced, 3), (self.open, 1)):
            expected = {
                "position": (np.float32, (count, 3)),
                "normal": (np.float32, (count, 3)),
                "transfer": (np.float32, (count, channels, ORDER**2)),
                "albedo": (np.float32, (count, 3)),
                "source_vertex": (np.int32, (count,)),
                "valid": (np.bool_, (count,)),
            }
            for key, (kind, shape) in expected.items():
                self.assertEqual((table[key].dtype, table[key].shape), (np.dtype(kind), shape), key)

    def test_vertices_keep_the_order_of_the_file(self):
        rows = [line.split() for line in self.scene.read_text().splitlines()]
        file = np.array([row[1:] for row in rows if row[0] == "v"], np.float32)
        np.testing.assert_array_equal(self.direct["position"], file)
        np.testing.assert_array_equal(self.direct["source_vertex"], np.arange(len(file)))
        self.assertTrue(self.direct["valid"].all())

    def test_normals_face_up_on_the_floor_and_down_on_the_ceiling(self):
        up = np.where(np.arange(program.FLOOR**2 + 4) < program.FLOOR**2, 1.0, -1.0)
        expected = np.outer(up, (0, 1, 0))
        np.testing.assert_allclose(self.direct["normal"], expected, atol=ROUNDING)

    def test_albedo_is_the_one_asked_for(self):
        expected = np.tile(np.float32(ALBEDO), (len(self.direct["albedo"]), 1))
        np.testing.assert_array_equal(self.direct["albedo"], expected)

    def test_unshadowed_transfer_is_the_clamped_cosine(self):
        # A_l / π = 1, 2/3, 1/4, and Y up to degree 2 at the normal (0, ±1, 0) [ramamoorthi2001].
        y = self.open["normal"][:, 1]
        zero, one = 0 * y, np.ones_like(y)
        basis = np.stack([
            0.282095 * one, 0.488603 * y, zero, zero,
            zero, zero, -0.315392 * one, zero, -0.546274 * one,
        ], axis=1)  # fmt: skip
        expected = basis * np.repeat([1, 2 / 3, 1 / 4], [1, 3, 5])
        # The constants above have six digits.
        np.testing.assert_allclose(self.open["transfer"][:, 0], expected, atol=1e-6)

    def test_under_constant_light_direct_transfer_is_the_visible_fraction(self):
        fraction = ONE * self.direct["transfer"][:, 0, 0].astype(float)
        self.assertTrue(np.all((fraction >= -ROUNDING) & (fraction <= 1 + ROUNDING)))
        # Independent samples would scatter by this; stratified ones scatter less.
        covered = covered_by_ceiling()
        deviation = sqrt(covered * (1 - covered) / SAMPLES)
        self.assertLess(abs(fraction[MIDDLE] - (1 - covered)), 4 * deviation)

    def test_bounces_add_light_by_the_colour_of_what_they_hit_and_never_too_much(self):
        direct = ONE * self.direct["transfer"][:, :, 0].astype(float)
        bounced = ONE * self.bounced["transfer"][:, :, 0].astype(float)
        self.assertTrue(np.all(bounced >= direct - ROUNDING))
        self.assertTrue(np.all(bounced <= 1 + ROUNDING))
        # The same rays, so what a bounce adds at the middle is ordered as the albedo is.
        added = (bounced - direct)[MIDDLE]
        self.assertTrue(added[0] > added[1] > added[2] > 0, added)

    def test_shading_is_albedo_times_transfer_times_light(self):
        light, table = self.folder / "light.json", self.folder / "radiance.npz"
        relume("light", "constant:1,2,3", "-o", light, "--order", ORDER)
        relume("shade", self.folder / "bounced.glb", "--light", light, "-o", table)
        with np.load(table) as arrays:
            radiance, position = arrays["radiance"], arrays["position"]
        constant = ONE * self.bounced["transfer"][:, :, 0].astype(float) * (1, 2, 3)
        self.assertEqual(radiance.dtype, np.float32)
        # f32 sums of nine products.
        np.testing.assert_allclose(radiance, self.bounced["albedo"] * constant, rtol=2e-6, atol=2e-6)
        np.testing.assert_array_equal(position, self.bounced["position"])


if __name__ == "__main__":
    unittest.main()

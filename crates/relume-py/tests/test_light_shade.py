"""Lights and shading against definitions written in numpy, and against the program's own."""

import json

import numpy as np
import pytest
from shapes import ONE, box, harmonics

import program
import relume


def program_light(tmp_path, *arguments):
    program.relume("light", *arguments, "-o", tmp_path / "light.json")
    return np.array(json.loads((tmp_path / "light.json").read_text())["coefficients"], np.float32)


@pytest.mark.parametrize("spec", ["constant:1,2,3", "sun:1,2,3,5,9,8,7", "sky:30,3"])
def test_lights_are_those_of_the_program(tmp_path, spec):
    theirs = program_light(tmp_path, spec, "--order", 6, "--rotate", "0,1,0:30", "--rotate", "1,0,0:-20", "--window", "hann")
    ours = relume.light(spec, order=6, rotate=["0,1,0:30", "1,0,0:-20"], window="hann")
    assert ours.dtype == np.float32 and ours.flags.c_contiguous
    np.testing.assert_array_equal(ours, theirs)
    # The file it wrote is a light, too.
    np.testing.assert_array_equal(relume.light(tmp_path / "light.json", order=6), theirs)
    np.testing.assert_array_equal(relume.light(str(tmp_path / "light.json"), order=6), theirs)


def directions_of(height, width):
    """The directions of the texels' middles, written from the sentence in the docstring: +Y up, +Z in the centre, +X left of it."""
    latitude = np.pi / 2 - np.pi * (np.arange(height) + 0.5) / height
    longitude = np.pi - 2 * np.pi * (np.arange(width) + 0.5) / width
    latitude, longitude = np.meshgrid(latitude, longitude, indexing="ij")
    return np.stack([np.cos(latitude) * np.sin(longitude), np.sin(latitude), np.cos(latitude) * np.cos(longitude)], axis=-1)


def test_an_array_is_projected_by_its_texels_solid_angles():
    height, width, order = 48, 96, 4
    rng = np.random.default_rng(3)
    # Smooth light: the sum over texels' middles then is the integral, but for the square of a texel's size.
    true = rng.normal(size=(order * order, 3)) * 0.1
    true[0] += 5
    directions = directions_of(height, width)
    image = (harmonics(directions.reshape(-1, 3), order) @ true).reshape(height, width, 3)
    assert image.min() > 0
    # A texel is π/48 wide; the curvature of degree 3 makes an error of l(l+1) (π/48)² / 24 < 0.3 % of each coefficient.
    for dtype in (np.float64, np.float32, np.float16):
        ours = relume.light(image.astype(dtype), order=order)
        np.testing.assert_allclose(ours, true, atol=0.003 * np.abs(true).max())


def test_an_array_is_latlong_unless_told_otherwise():
    square = np.random.default_rng(5).uniform(size=(16, 16, 3))
    np.testing.assert_array_equal(relume.light(square), relume.light(square, layout="latlong"))
    assert not np.allclose(relume.light(square), relume.light(square, layout="angular"))


def test_an_array_is_turned_as_a_light_is():
    image = np.random.default_rng(6).uniform(size=(16, 32, 3))
    # A quarter turn about +Y brings +Z to +X, which is eight texels to the left.
    turned = relume.light(image, rotate="0,1,0:90")
    np.testing.assert_allclose(turned, relume.light(np.roll(image, -8, axis=1)), atol=1e-5)


def test_negative_pixels_are_none_and_said():
    image = np.ones((4, 8, 3))
    image[1, 2] = -1
    with pytest.warns(UserWarning, match="1 pixels were negative"):
        relume.light(image)


def test_shading_is_albedo_times_transfer_times_light():
    rng = np.random.default_rng(7)
    for channels, order, other in ((1, 5, 5), (3, 5, 5), (3, 4, 6), (1, 6, 3)):
        transfer = rng.normal(size=(100, channels, order**2)).astype(np.float32)
        light = rng.normal(size=(other**2, 3)).astype(np.float32)
        count = min(order, other) ** 2
        wide = np.broadcast_to(transfer[..., :count], (100, 3, count)).astype(float)
        expected = np.einsum("vci,ic->vc", wide, light[:count])
        # f32 products of at most 25 terms of size 1: the rounding of their sum.
        ours = relume.shade(transfer, light)
        assert ours.shape == (100, 3) and ours.dtype == np.float32
        np.testing.assert_allclose(ours, expected, atol=2e-5)
        albedo = rng.uniform(size=(100, 3)).astype(np.float32)
        np.testing.assert_array_equal(relume.shade(transfer, light, albedo=albedo), ours * albedo)
        np.testing.assert_array_equal(relume.shade(transfer, light, albedo=0.25), ours * np.float32(0.25))
        np.testing.assert_array_equal(relume.shade(transfer[::-2], light), ours[::-2])


def test_no_vertices_are_shaded_to_none():
    assert relume.shade(np.zeros((0, 3, 25), np.float32), np.zeros((25, 3))).shape == (0, 3)


def test_the_whole_flow_gives_the_radiance_of_the_program(tmp_path):
    vertices, faces = box(0.6, 0.8, 0.7, lid=False)
    lines = ["v %r %r %r" % tuple(map(float, v)) for v in vertices.astype(np.float32)] + ["f %d %d %d" % tuple(f + 1) for f in faces]
    (tmp_path / "box.obj").write_text("\n".join(lines) + "\n")
    program.relume("bake", tmp_path / "box.obj", "-o", tmp_path / "box.glb", "--samples", 64, "--bounces", 1, "--albedo", "0.8,0.5,0.3")
    program.relume("shade", tmp_path / "box.glb", "--light", "sky:30,3", "-o", tmp_path / "box.npz")
    albedo = (0.8, 0.5, 0.3)
    ours = relume.shade(relume.bake(vertices, faces, samples=64, bounces=1, albedo=albedo), relume.light("sky:30,3"), albedo=albedo)
    with np.load(tmp_path / "box.npz") as theirs:
        assert theirs["radiance"].tobytes() == ours.tobytes()


def test_under_light_from_everywhere_an_open_floor_sends_out_its_albedo():
    vertices = np.array([[-1, 0, -1], [-1, 0, 1], [1, 0, 1]])
    transfer = relume.bake(vertices, [[0, 1, 2]], samples=64)
    one = np.zeros((1, 3))
    one[0] = ONE
    np.testing.assert_allclose(relume.shade(transfer, one, albedo=0.5), 0.5, atol=1e-6)

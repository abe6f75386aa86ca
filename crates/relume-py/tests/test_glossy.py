"""Glossy transfer against the program, against diffuse transfer, and against definitions written in numpy."""

import dataclasses
import pickle
import struct

import numpy as np
import pytest
from shapes import ONE, box, grid, harmonics

import program
import relume

EYE = (1.0, 3.0, 2.0)


def measured_lambert(path, albedo):
    """A file of the MERL database that reflects so much of what it receives, everywhere alike."""
    entry = [albedo / np.pi * 1500 / scale for scale in (1, 1.15, 1.66)]
    path.write_bytes(struct.pack("<3i", 90, 90, 180) + np.repeat(entry, 90 * 90 * 180).astype("<f8").tobytes())
    return path


def write_obj(path, vertices, faces):
    lines = ["v %r %r %r" % tuple(map(float, v)) for v in vertices.astype(np.float32)] + ["f %d %d %d" % tuple(f + 1) for f in faces]
    path.write_text("\n".join(lines) + "\n")


@pytest.mark.parametrize(
    ("brdf", "flags"),
    [
        (relume.Phong(kd=(0.3, 0.2, 0.1), ks=0.4, exponent=6), "--brdf phong --kd 0.3,0.2,0.1 --ks 0.4 --exponent 6"),
        (relume.Ggx((0.8, 0.5, 0.3), metallic=1, roughness=0.6), "--brdf ggx --base-color 0.8,0.5,0.3 --metallic 1 --roughness 0.6"),
        (None, "--brdf lambert"),
    ],
    ids=["phong", "ggx", "lambert"],
)
def test_the_whole_flow_gives_the_radiance_of_the_program(tmp_path, brdf, flags):
    vertices, faces = box(0.6, 0.8, 0.7, lid=False)
    write_obj(tmp_path / "box.obj", vertices, faces)
    bake = ["--samples", 64, "--bounces", 1, "--order", 3, "--transfer", "glossy", "--transfer-order", 4]
    program.relume("bake", tmp_path / "box.obj", "-o", tmp_path / "box.glb", *bake, *flags.split())
    program.relume("shade", tmp_path / "box.glb", "--light", "sky:30,3", "--eye", "1,3,2", "-o", tmp_path / "box.npz")
    transfer = relume.bake(vertices, faces, samples=64, bounces=1, order=3, transfer="glossy", transfer_order=4, brdf=brdf)
    assert transfer.matrices.shape == (len(vertices), 3, 16, 9) and transfer.matrices.dtype == np.float32
    ours = relume.shade(transfer, relume.light("sky:30,3", order=3), eye=EYE)
    with np.load(tmp_path / "box.npz") as theirs:
        assert theirs["radiance"].tobytes() == ours.tobytes()
        assert theirs["normal"].tobytes() == transfer.normals.tobytes()
        assert theirs["valid"].tobytes() == transfer.valid.tobytes()


def test_an_order_is_chosen_for_the_brdf():
    mesh = dict(zip(("vertices", "faces"), grid(2)), samples=16, order=2, transfer="glossy")
    orders = [int(relume.bake(**mesh, brdf=relume.Ggx(metallic=1, roughness=r)).matrices.shape[2] ** 0.5) for r in (0.9, 0.3)]
    assert 2 <= orders[0] < orders[1] <= 10
    assert relume.bake(**mesh).matrices.shape == (4, 1, 4, 4)


def test_matrices_are_the_identity_above_the_horizon_of_an_open_floor():
    transfer = relume.bake(*grid(2), samples=64, order=3, transfer="glossy", transfer_order=3)
    rng = np.random.default_rng(8)
    directions = rng.normal(size=(100, 3))
    directions[:, 1] = np.abs(directions[:, 1])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    light = rng.normal(size=9)
    arriving = harmonics(directions, 3) @ (transfer.matrices[0, 0] @ light)
    # f32, and a least-squares fit whose condition multiplies its rounding by a hundred.
    np.testing.assert_allclose(arriving, harmonics(directions, 3) @ light, atol=1e-3)


def test_lambert_seen_from_anywhere_is_diffuse_transfer():
    vertices, faces = box(0.6, 0.8, 0.7, lid=False)
    light = relume.light("sky:30,3", order=4)
    albedo = np.random.default_rng(9).uniform(size=(len(vertices), 3))
    common = dict(samples=256, order=4, albedo=albedo)
    diffuse = relume.shade(relume.bake(vertices, faces, **common), light, albedo=albedo)
    glossy = relume.bake(vertices, faces, **common, transfer="glossy", transfer_order=4)
    np.testing.assert_array_equal(glossy.albedo, albedo.astype(np.float32))
    # From inside all walls show their fronts. Irradiance is kept by the fit; both are estimates from other rays.
    inside = relume.shade(glossy, light, eye=(0, 0.4, 0))
    assert np.abs(inside - diffuse).max() < 0.05 * diffuse.max()
    behind = relume.shade(glossy, light, eye=(0, -5, 0))
    assert not behind[:5].any()


def test_another_brdf_reflects_the_same_light_otherwise():
    one = np.zeros((1, 3))
    one[0] = ONE
    floor = relume.bake(*grid(2), samples=64, order=2, transfer="glossy", transfer_order=4, brdf=relume.Phong(0.2, 0.0, 1))
    # Under light from everywhere an open floor shows its albedo; f32 and the tables leave less than this.
    np.testing.assert_allclose(relume.shade(floor, one, eye=EYE), 0.2, atol=2e-4)
    brighter = dataclasses.replace(floor, brdf=relume.Phong(0.5, 0.0, 1))
    np.testing.assert_allclose(relume.shade(brighter, one, eye=EYE), 0.5, atol=5e-4)
    np.testing.assert_allclose(relume.shade(floor, one, eye=EYE), 0.2, atol=2e-4)


def test_a_measured_brdf_is_read(tmp_path):
    path = measured_lambert(tmp_path / "half.binary", 0.5)
    one = np.zeros((1, 3))
    one[0] = ONE
    for given in (path, str(path)):
        floor = relume.bake(*grid(2), samples=64, order=2, transfer="glossy", transfer_order=3, brdf=relume.Measured(given))
        # The outermost ring of entries is left out where its middle lies below the horizon.
        np.testing.assert_allclose(relume.shade(floor, one, eye=(0, 5, 0)), 0.5, rtol=0.01)


def test_a_glossy_transfer_is_pickled_and_shaded_again():
    transfer = relume.bake(*grid(3), samples=16, order=2, transfer="glossy", transfer_order=2, brdf=relume.Phong())
    light = relume.light("sky:30,3", order=2)
    before = relume.shade(transfer, light, eye=EYE)
    again = pickle.loads(pickle.dumps(transfer))
    np.testing.assert_array_equal(relume.shade(again, light, eye=EYE), before)


MESH = dict(zip(("vertices", "faces"), grid(2)), samples=16, order=2)
GLOSSY = dict(MESH, transfer="glossy", transfer_order=2)
REFUSED = [
    (dict(MESH, transfer="shiny"), "transfer: 'shiny' is neither 'diffuse' nor 'glossy'"),
    (dict(MESH, brdf=relume.Phong()), "brdf: is of transfer='glossy'; give both or neither"),
    (dict(MESH, transfer_order=3), "transfer_order: is of transfer='glossy'; give both or neither"),
    (dict(GLOSSY, return_valid=True), "return_valid: a glossy result has it as .valid; leave it out"),
    (dict(GLOSSY, transfer_order=0), "transfer_order: 0 is not within 1…32"),
    (dict(GLOSSY, transfer_order=2.5), "transfer_order: 2.5 is not a whole number"),
    (
        dict(GLOSSY, order=5, transfer_order=30),
        "transfer_order: light of order 5 and transferred radiance of order 30 need visibility of order 34, above 32; lower either",
    ),
    (dict(GLOSSY, brdf="phong"), "brdf: 'phong' is not a relume.Lambert, Phong, Ggx or Measured"),
    (dict(GLOSSY, brdf=relume.Phong(kd=2)), "brdf.kd: 2 … 2 is not within 0…1"),
    (dict(GLOSSY, brdf=relume.Phong(kd=(1, 2))), "brdf.kd: has the shape [2]; give a number or three (linear red, green, blue)"),
    (dict(GLOSSY, brdf=relume.Phong(0.8, 0.4)), "brdf: kd and ks together reflect 1.2 of what arrives; their sum must not pass 1"),
    (dict(GLOSSY, brdf=relume.Phong(exponent=-1)), "brdf.exponent: -1 is not within 0…1e+06"),
    (dict(GLOSSY, brdf=relume.Phong(exponent="x")), "brdf.exponent: 'x' is not a number"),
    (dict(GLOSSY, brdf=relume.Ggx(roughness=float("nan"))), "brdf.roughness: nan is not within 0…1"),
    (dict(GLOSSY, brdf=relume.Ggx(metallic=1.5)), "brdf.metallic: 1.5 is not within 0…1"),
    (dict(GLOSSY, brdf=relume.Ggx((0, 0, -1))), "brdf.base_color: -1 … 0 is not within 0…1"),
    (dict(GLOSSY, brdf=relume.Measured(7)), "brdf.path: 7 is not a path"),
]


def refused(call, *arguments, **keywords):
    with pytest.raises(ValueError) as caught:
        call(*arguments, **keywords)
    assert type(caught.value) is ValueError
    assert len(str(caught.value).splitlines()) == 1
    return str(caught.value)


@pytest.mark.parametrize(("arguments", "message"), REFUSED, ids=[message[:40] for _, message in REFUSED])
def test_bake_refuses(arguments, message):
    assert refused(relume.bake, **arguments) == message


def test_shade_refuses():
    glossy, diffuse, light = relume.bake(**GLOSSY), relume.bake(**MESH), relume.light("sky:30,3", order=2)
    assert refused(relume.shade, glossy, light) == "eye: missing; give a place [3] that glossy surfaces are seen from"
    assert refused(relume.shade, glossy, light, eye=(1, 2)).startswith("eye: has the shape [2]; ")
    assert refused(relume.shade, glossy, light, eye=(1, 2, np.nan)) == "eye: [ 1.  2. nan] is not finite"
    assert refused(relume.shade, glossy, light, eye="here").startswith("eye: holds <U4; ")
    assert refused(relume.shade, glossy, light, eye=EYE, albedo=1).startswith("albedo: a glossy transfer has its own")
    assert refused(relume.shade, diffuse, light, eye=EYE).startswith("eye: diffuse surfaces look the same")
    for change, message in (
        (dict(matrices=glossy.matrices[:, 0]), "matrices: has the shape [4, 4, 4]; give an array [V, 1 or 3, transfer order², order²] of floats"),
        (dict(matrices=glossy.matrices * np.nan), "matrices: [0, 0, 0, 0] is nan, which is not a finite 32-bit number; repair it"),
        (dict(positions=glossy.positions[:2]), "positions: 2 for 4 vertices; give one for each"),
        (dict(normals=glossy.normals[:, :2]), "normals: has the shape [4, 2]; give an array [V, 3] of floats"),
        (dict(brdf=None), "brdf: None is not a relume.Lambert, Phong, Ggx or Measured"),
    ):
        assert refused(relume.shade, dataclasses.replace(glossy, **change), light, eye=EYE) == message


def test_measured_brdfs_that_are_none_are_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match="missing.binary"):
        relume.bake(**GLOSSY, brdf=relume.Measured(tmp_path / "missing.binary"))
    (tmp_path / "words.binary").write_text("red 0.5")
    assert "it has 7 bytes" in refused(relume.bake, **GLOSSY, brdf=relume.Measured(tmp_path / "words.binary"))
    assert "not a regular file" in refused(relume.bake, **GLOSSY, brdf=relume.Measured(tmp_path))

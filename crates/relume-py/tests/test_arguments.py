"""What is refused, and in what words."""

import re

import numpy as np
import pytest
from shapes import grid

import relume

VERTICES, FACES = grid(3)
NAN, HUGE = VERTICES.copy(), VERTICES.copy()
NAN[4, 1] = np.nan
HUGE[2, 0] = 1e39

BAKE = [
    (dict(vertices=NAN), "vertices: [4, 1] is nan, which is not a finite 32-bit number; repair it"),
    (dict(vertices=HUGE), "vertices: [2, 0] is 1e+39, which is not a finite 32-bit number; repair it"),
    (dict(vertices=np.zeros((0, 3))), "vertices: there are none; give an array [V, 3] of floats"),
    (dict(vertices=VERTICES[:, :2]), "vertices: has the shape [9, 2]; give an array [V, 3] of floats"),
    (dict(vertices=VERTICES.ravel()), "vertices: has the shape [27]; give an array [V, 3] of floats"),
    (dict(vertices=VERTICES + 1j), "vertices: holds complex128; give an array [V, 3] of floats"),
    (dict(vertices=[["a", "b", "c"]]), "vertices: holds <U1; give an array [V, 3] of floats"),
    (dict(vertices=None), "vertices: holds object; give an array [V, 3] of floats"),
    (dict(vertices=[[0, 1, 2], [3]]), "vertices: not an array (are its rows of different lengths?); give an array [V, 3] of floats"),
    (
        dict(faces=[[0, 1, 4, 3]]),
        "faces: rows of 4 corners are quads; split each [a, b, c, d] into [a, b, c] and [a, c, d]",
    ),
    (dict(faces=[[0, 1, 9]]), "faces: [0, 2] is 9, but the 9 vertices are numbered from 0 to 8"),
    (dict(faces=[[0, 1, 2], [0, -1, 2]]), "faces: [1, 1] is -1, but the 9 vertices are numbered from 0 to 8"),
    (
        dict(faces=np.array([[0, 1, 2**64 - 1]], np.uint64)),
        "faces: [0, 2] is 18446744073709551615, but the 9 vertices are numbered from 0 to 8",
    ),
    (dict(faces=FACES.astype(float)), "faces: holds float64; give an array [F, 3] of integers, the corners of triangles"),
    (dict(faces=FACES == 0), "faces: holds bool; give an array [F, 3] of integers, the corners of triangles"),
    (dict(faces=[]), "faces: has the shape [0]; give an array [F, 3] of integers, the corners of triangles"),
    (dict(faces=np.zeros((0, 3), int)), "faces: there are none; give an array [F, 3] of integers, the corners of triangles"),
    (dict(faces=[3, 0, 1, 2]), "faces: has the shape [4]; give an array [F, 3] of integers, the corners of triangles"),
    (dict(faces=[[0, 0, 1]]), "faces: has no triangles, so there is nothing to bake; export a mesh with faces that have an area"),
    (dict(normals=VERTICES[:4]), "normals: 4 for 9 vertices; give one for each"),
    (dict(normals=NAN), "normals: [4, 1] is nan, which is not a finite 32-bit number; repair it"),
    (dict(normals=VERTICES.T), "normals: has the shape [3, 9]; give an array [V, 3] of floats"),
    (dict(albedo=1.5), "albedo: 1.5 … 1.5 is not within 0…1, the share of light reflected"),
    (dict(albedo=(0, -0.5, 1)), "albedo: -0.5 … 1 is not within 0…1, the share of light reflected"),
    (dict(albedo=float("nan")), "albedo: [] is nan, which is not a finite 32-bit number; repair it"),
    (
        dict(albedo=[0.5] * 9),
        "albedo: has the shape [9] for 9 vertices; give a number, three (linear red, green, blue) or an array [V, 3] of them",
    ),
    (dict(order=0), "order: 0 is not within 1…32"),
    (dict(order=33), "order: 33 is not within 1…32"),
    (dict(order=5.0), "order: 5.0 is not a whole number"),
    (dict(samples=0), "samples: 0 is not within 1…4194304"),
    (dict(samples="1"), "samples: '1' is not a whole number"),
    (dict(samples=1 << 40), "samples: 1099511627776 is not within 1…4194304"),
    (dict(bounces=-1), "bounces: -1 is not within 0…64"),
    (dict(bounces=65), "bounces: 65 is not within 0…64"),
    (dict(seed=-1), "seed: -1 is not within 0…18446744073709551615"),
    (dict(threads=0), "threads: 0 is not within 1…1024"),
]


def refused(call, *arguments, **keywords):
    """The one line that a call is refused with."""
    with pytest.raises(ValueError) as caught:
        call(*arguments, **keywords)
    # No more and no less: a subclass or a cause would say something else.
    assert type(caught.value) is ValueError
    message = str(caught.value)
    assert len(message.splitlines()) == 1
    return message


@pytest.mark.parametrize(("change", "message"), BAKE, ids=[message[:48] for _, message in BAKE])
def test_bake_refuses(change, message):
    assert refused(relume.bake, **{"vertices": VERTICES, "faces": FACES, "samples": 16, **change}) == message


def test_the_limits_are_those_of_the_library():
    """The extremes that are let through are accepted behind the checks, too."""
    tiny = dict(vertices=VERTICES[[0, 3, 1]], faces=[[0, 1, 2]])
    assert relume.bake(**tiny, order=32, samples=1, bounces=64, seed=2**64 - 1, threads=1024).shape == (3, 3, 1024)
    native = dict(normals=None, albedo=np.ones((1, 3), np.float32), order=1, samples=1, bounces=0, seed=0, threads=1, double_sided=False)
    vertices, faces = np.float32(tiny["vertices"]), np.uint32(tiny["faces"])
    for change in (dict(samples=(1 << 22) + 1), dict(bounces=65), dict(order=33), dict(albedo=np.full((1, 3), 2, np.float32))):
        assert refused(relume._relume.bake, vertices, faces, **{**native, **change})


LIGHT = [
    (dict(env="constant:1,1"), r'env: "constant:1,1" is not of the form constant:R,G,B.*'),
    (dict(env="constant:1,-1,1"), "env: constant radiance: 1,-1,1 must be finite, not negative and at most 1e20"),
    (dict(env="sky:99,3"), "env: .*0…90.*"),
    (dict(env=""), 'env: "" is not of the form a path.*'),
    (dict(env=np.zeros((4, 8))), r"env: has the shape \[4, 8\]; give a path.*"),
    (dict(env=np.zeros((0, 8, 3))), r"env: has the shape \[0, 8, 3\]; give a path.*"),
    (dict(env=np.zeros((4, 8, 4))), r"env: has the shape \[4, 8, 4\]; give a path.*"),
    (dict(env=np.zeros((4, 8, 3), np.uint8)), "env: holds uint8; give .*linear radiance in floats"),
    (dict(env=np.full((4, 8, 3), np.inf)), r"env: \[0, 0, 0\] is inf, .*"),
    (dict(env=None), "env: holds object; give a path.*"),
    (dict(layout="round"), 'layout: layout "round" is unknown; use auto, latlong, angular, vcross, hcross or faces'),
    (dict(layout=3), "layout: 3 is not text"),
    (dict(env=np.ones((4, 8, 3)), layout="vcross"), "layout: layout vcross needs 3 × 4 equal squares.* layout= .*"),
    (dict(rotate="90"), 'rotate: "90" is not of the form X,Y,Z:DEG.*'),
    (dict(rotate=["0,1,0:90", "0,0,0:1"]), "rotate: .*"),
    (dict(rotate=[90]), "rotate: 90 is not text"),
    (dict(window="box"), "window: .*"),
    (dict(order=0), "order: 0 is not within 1…32"),
]


@pytest.mark.parametrize(("change", "message"), LIGHT, ids=[message[:40] for _, message in LIGHT])
def test_light_refuses(change, message):
    said = refused(relume.light, **{"env": "sky:30,3", **change})
    assert re.fullmatch(message, said), said


def test_files_that_cannot_be_read_are_the_systems_errors(tmp_path):
    for name in (tmp_path / "missing.hdr", str(tmp_path / "missing.hdr")):
        with pytest.raises(FileNotFoundError, match="missing.hdr"):
            relume.light(name)
    (tmp_path / "noise.hdr").write_bytes(b"\x07" * 64)
    assert "noise.hdr" in refused(relume.light, tmp_path / "noise.hdr")
    assert "not a regular file" in refused(relume.light, tmp_path)
    # A path object is a path, whatever it looks like.
    with pytest.raises(FileNotFoundError):
        relume.light(tmp_path / "sky:30,3")


SHADE = [
    (dict(transfer=np.zeros((9, 25))), "transfer: has the shape [9, 25]; give what relume.bake returns, an array [V, 1 or 3, order²] of floats"),
    (dict(transfer=np.zeros((9, 2, 25))), "transfer: has the shape [9, 2, 25]; give what relume.bake returns, an array [V, 1 or 3, order²] of floats"),
    (dict(transfer=np.zeros((9, 1, 24))), "transfer: has the shape [9, 1, 24]; give what relume.bake returns, an array [V, 1 or 3, order²] of floats"),
    (dict(transfer=np.full((9, 1, 1), np.nan)), "transfer: [0, 0, 0] is nan, which is not a finite 32-bit number; repair it"),
    (dict(transfer="out.glb"), "transfer: holds <U7; give what relume.bake returns, an array [V, 1 or 3, order²] of floats"),
    (dict(light=np.zeros((24, 3))), "light: has the shape [24, 3]; give what relume.light returns, an array [order², 3] of floats, or [V, order², 3]"),
    (dict(light=np.zeros((3, 25))), "light: has the shape [3, 25]; give what relume.light returns, an array [order², 3] of floats, or [V, order², 3]"),
    (dict(light=np.full((25, 3), np.inf)), "light: [0, 0] is inf, which is not a finite 32-bit number; repair it"),
    (dict(albedo=2), "albedo: 2 … 2 is not within 0…1, the share of light reflected"),
    (
        dict(albedo=np.ones((8, 3))),
        "albedo: has the shape [8, 3] for 9 vertices; give a number, three (linear red, green, blue) or an array [V, 3] of them",
    ),
]


@pytest.mark.parametrize(("change", "message"), SHADE, ids=[message[:40] for _, message in SHADE])
def test_shade_refuses(change, message):
    good = {"transfer": np.zeros((9, 1, 25), np.float32), "light": np.zeros((25, 3), np.float32)}
    assert refused(relume.shade, **{**good, **change}) == message

"""What is refused of emitters, and in what words."""

import dataclasses
import json

import numpy as np
import pytest
from shapes import grid

import relume

QUAD = relume.Quad(1, 1)
CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
VERTICES, FACES = grid(2)


def refused(call, *arguments, **keywords):
    with pytest.raises(ValueError) as caught:
        call(*arguments, **keywords)
    assert type(caught.value) is ValueError
    assert len(str(caught.value).splitlines()) == 1
    return str(caught.value)


def mesh(**change):
    return relume.Mesh(**{"vertices": CORNERS, "faces": [[0, 1, 2]], **change})


EMITTERS = [
    ((relume.Quad(0, 1), 1), {}, "emitters[0].shape.width: 0 is no length; it must be above 0"),
    ((relume.Quad(1, np.nan), 1), {}, "emitters[0].shape.height: nan is not within 0…1e+09"),
    ((relume.Disc(-1), 1), {}, "emitters[0].shape.radius: -1 is not within 0…1e+09"),
    ((relume.Blocks(0, 1, 1, 1), 1), {}, "emitters[0].shape.columns: 0 is not within 1…1048576"),
    ((relume.Blocks(1 << 12, 1 << 12, 1, 1), 1), {}, "emitters[0].shape.rows: 4096 is not within 1…256"),
    ((relume.Blocks(1, 1, 1, 1, 0), 1), {}, "emitters[0].shape.fill: must be above 0"),
    (("quad", 1), {}, "emitters[0].shape: 'quad' is not a relume.Quad, Disc, Sphere, Cuboid, Blocks or Mesh"),
    ((mesh(faces=[[0, 1, 3]]), 1), {}, "emitters[0].shape.faces: [0] has the corner 3, but the 3 vertices are numbered from 0 to 2"),
    ((mesh(faces=[[0, 1, -1]]), 1), {}, "emitters[0].shape.faces: [0] has the corner -1, but the 3 vertices are numbered from 0 to 2"),
    ((mesh(faces=[[0, 1]]), 1), {}, "emitters[0].shape.faces: [0] has the shape [2]; give it three corners or more"),
    ((mesh(faces=[]), 1), {}, "emitters[0].shape.faces: there are none; give [F, 3] integers, or a list of faces"),
    ((mesh(faces=3), 1), {}, "emitters[0].shape.faces: 3 is no list; give [F, 3] integers, or a list of faces"),
    ((mesh(vertices=[(0, 0)]), 1), {}, "emitters[0].shape.vertices: has the shape [1, 2]; give an array [P, 3] of floats"),
    ((mesh(vertices=np.full((3, 3), np.inf)), 1), {}, "emitters[0].shape.vertices: [0, 0] is not finite; repair it"),
    ((QUAD,), {}, "emitters[0].radiance: give it or vertex_radiance, one of them; 0 where it only blocks"),
    ((QUAD, 1, np.ones((4, 3))), {}, "emitters[0].radiance: give it or vertex_radiance, one of them; 0 where it only blocks"),
    ((QUAD, -1), {}, 'emitters: emitter "emitter 0": radiance must be finite, not negative and at most 1e20'),
    ((QUAD, np.nan), {}, "emitters[0].radiance: [] is nan, which is not a finite 32-bit number; repair it"),
    (
        (QUAD, [1, 2]),
        {},
        "emitters[0].radiance: has the shape [2]; give a number, three (linear red, green, blue) or an array [F, 3], one for each face",
    ),
    ((QUAD, 1), dict(pose=np.eye(3)), "emitters[0].pose: has the shape [3, 3]; give a matrix [4, 4] whose last row is 0, 0, 0, 1"),
    ((QUAD, 1), dict(pose=np.diag([1, 2, 1, 1]), name="lamp"), 'emitters: emitter "lamp": its pose must be a rotation, a uniform scale above 0 and a translation'),
    ((QUAD, 1), dict(exponent=9), "emitters[0].exponent: 9 is not within 0…8"),
    ((QUAD, 1), dict(name=3), "emitters[0].name: 3 is not text"),
    ((relume.Sphere(1), 1), dict(exponent=1), 'emitters: emitter "emitter 0": a sphere shines the same everywhere; use a mesh for patterns and exponents'),
]


@pytest.mark.parametrize(("arguments", "keywords", "message"), EMITTERS, ids=[message[:40] for _, _, message in EMITTERS])
def test_emitters_refuse(arguments, keywords, message):
    assert refused(relume.Emitters, [relume.Emitter(*arguments, **keywords)]) == message


def test_counts_that_do_not_fit_are_said_with_what_to_do():
    for shape, change in ((QUAD, dict(radiance=np.ones((2, 3)))), (QUAD, dict(vertex_radiance=np.ones((3, 3))))):
        said = refused(relume.Emitters, [relume.Emitter(shape, name="lamp", **change)])
        assert 'emitter "lamp"' in said and "give" in said, said
    bent = relume.Mesh([(0, 0, 0), (1, 0, 0), (1, 1, 1), (0, 1, 0)], [[0, 1, 2, 3]])
    said = refused(relume.Emitters, [relume.Emitter(bent, 1)])
    assert said == 'emitters: emitter "emitter 0": face 0 is not flat and convex; cut it into triangles'
    assert refused(relume.Emitters, [QUAD]).startswith("emitters: [0] is Quad(")


CALLS = [
    ("light_at", (VERTICES[:, :2],), {}, "positions: has the shape [4, 2]; give an array [V, 3] of floats"),
    ("light_at", (VERTICES, 33), {}, "order: 33 is not within 1…32"),
    ("incident", ((1, 2),), {}, "point: has the shape [2]; give a place [3] in the world"),
    ("incident", ((1, 2, np.nan),), {}, "point: [2] is not finite; repair it"),
    ("incident", ((1, 2, 3), 0), {}, "order: 0 is not within 1…32"),
    ("pose", (1,), {}, "emitter: 1 is not within 0…0"),
    ("set_pose", (-1, np.eye(4)), {}, "emitter: -1 is not within 0…0"),
    ("set_pose", (0, np.zeros((4, 4))), {}, "pose: its last row is [0. 0. 0. 0.]; give a matrix [4, 4] whose last row is 0, 0, 0, 1"),
    (
        "set_pose",
        (0, np.diag([0, 0, 0, 1])),
        {},
        'pose: emitter "emitter 0": its pose must be a rotation, a uniform scale above 0 and a translation',
    ),
    ("sampled_light_at", (VERTICES, np.zeros((3, 1, 4), np.float32)), dict(budget=1), "transfer: 3 for 4 positions; give one for each"),
    ("sampled_light_at", (VERTICES, np.zeros((4, 1, 4), np.float32)), {}, "budget: missing; give it or epsilon, or ask light_at"),
    ("sampled_light_at", (VERTICES, np.zeros((4, 1, 4), np.float32)), dict(budget=0), "budget: 0 is not within 1…2147483648"),
    ("sampled_light_at", (VERTICES, np.zeros((4, 1, 4), np.float32)), dict(epsilon=-1), "epsilon: -1 is not within 4.94066e-324…inf"),
]


@pytest.mark.parametrize(("name", "arguments", "keywords", "message"), CALLS, ids=[message[:40] for *_, message in CALLS])
def test_their_methods_refuse(name, arguments, keywords, message):
    emitters = relume.Emitters([relume.Emitter(QUAD, 1)])
    assert refused(getattr(emitters, name), *arguments, **keywords) == message
    # What was refused has changed nothing.
    np.testing.assert_array_equal(emitters.pose(0), np.eye(4))


def test_files_that_cannot_be_read_are_the_systems_errors(tmp_path):
    for call in (relume.Emitters.load, relume.read_light):
        with pytest.raises(FileNotFoundError, match="missing"):
            call(tmp_path / "missing.npz")
        assert refused(call, 7) == "path: 7 is not a path"
    (tmp_path / "lamps.json").write_text(json.dumps({"emitters": [{"quad": [1, 1]}]}))
    said = refused(relume.Emitters.load, tmp_path / "lamps.json")
    assert said.startswith("path: ") and "lamps.json: emitters[0]: it says no radiance" in said
    (tmp_path / "noise.npz").write_bytes(b"\x07" * 64)
    assert "noise.npz" in refused(relume.read_light, tmp_path / "noise.npz")
    with pytest.raises(OSError, match="light.npz"):
        relume.write_light(tmp_path / "no such folder" / "light.npz", np.zeros((4, 4, 3)), positions=VERTICES)
    light = np.zeros((4, 4, 3))
    assert refused(relume.write_light, "x", light[0], positions=VERTICES) == "light: has the shape [4, 3]; give one for each vertex, [V, order², 3]"
    assert refused(relume.write_light, "x", light, positions=VERTICES[:2]) == "positions: 2 for 4 vertices; give one for each"
    assert refused(relume.write_light, "x", light, positions=VERTICES, valid=[True]).startswith("valid: has the shape [1] for 4 vertices")


def test_what_a_file_warns_of_is_said(tmp_path):
    (tmp_path / "m.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\nf 9 9 9\n")
    (tmp_path / "lamps.json").write_text(json.dumps({"emitters": [{"mesh": "m.obj", "radiance": 1}]}))
    said = refused(relume.Emitters.load, tmp_path / "lamps.json")
    assert 'names "m.obj"' in said


def test_shade_refuses_light_that_does_not_fit():
    plain, light = relume.bake(VERTICES, FACES, samples=16, order=2), np.zeros((4, 4, 3), np.float32)
    lamp = relume.Emitters([relume.Emitter(QUAD, 1)])
    assert refused(relume.shade, plain, light[:3]) == "light: 3 for 4 vertices; give one for each, or one for all [order², 3]"
    assert refused(relume.shade, plain, lamp) == "light: transfer vectors do not say where vertices stand; give emitters.light_at(vertices)"
    assert refused(relume.shade, plain, light, bounces=1) == (
        "bounces: are made with what relume.bake(…, gather=True) or transfer='glossy' gives; leave them out"
    )
    folded = relume.bake(VERTICES, FACES, samples=16, order=2, bounces=1)
    said = "transfer: has bounces folded in (3 channels), which hold for distant light alone; bake it with bounces=0, or with gather=True"
    assert refused(relume.shade, folded, light) == said
    glossy = relume.bake(VERTICES, FACES, samples=16, order=2, bounces=1, transfer="glossy", transfer_order=2)
    assert refused(relume.shade, glossy, light, eye=(0, 1, 0)) == said


def test_bake_refuses_what_does_not_go_with_gather():
    arguments = dict(vertices=VERTICES, faces=FACES, samples=16, gather=True)
    assert refused(relume.bake, **arguments, bounces=1).startswith("bounces: with gather=True they are made where light is known")
    assert refused(relume.bake, **arguments, transfer="glossy") == "gather: is of diffuse transfer; leave it out, or transfer='glossy'"
    assert refused(relume.bake, **arguments, return_valid=True) == "return_valid: a result with gather has it as .valid; leave it out"


def test_a_direct_transfer_that_was_tampered_with_is_refused():
    direct, light = relume.bake(VERTICES, FACES, samples=16, order=2, gather=True), np.zeros((4, 3))
    assert not relume.shade(direct, light, bounces=2).any()
    for change, message in (
        (dict(starts=direct.starts[:-1]), "transfer: a gather operator that is not one of 4 sides; bake it again"),
        (dict(starts=-1 - direct.starts), "transfer.starts: has the shape [5] or numbers below 0; give what relume.bake gave, a list of integers from 0"),
        (dict(back_vertices=[1]), "transfer.back_vectors: not as many as back_vertices, which ascend, or not of the order of the vectors"),
        (dict(weights=direct.weights.ravel()), "transfer.weights: has the shape [0]; give an array [E, 1 or 3] of floats"),
        (dict(vectors=direct.vectors[0]), "transfer.vectors: has the shape [1, 4]; give what relume.bake returns, an array [V, 1 or 3, order²] of floats"),
    ):
        assert refused(relume.shade, dataclasses.replace(direct, **change), light) == message
    columns = dict(starts=[0, 1, 1, 1, 1], columns=[4], weights=np.ones((1, 1), np.float32))
    said = refused(relume.shade, dataclasses.replace(direct, **columns), light, bounces=1)
    assert said == "transfer: a gather operator with a column that is no side; bake it again"
    assert refused(relume.shade, direct, light, bounces=65) == "bounces: 65 is not within 0…64"
    both = relume.bake(VERTICES, FACES, samples=16, order=2, gather=True, double_sided=True)
    within = relume.Emitters([relume.Emitter(relume.Sphere(0.1), 1)])
    said = "transfer.back_vertices: not the vertices of double-sided faces; bake it again"
    for transfer, double_sided in ((both, False), (direct, True)):
        assert refused(relume.shade, dataclasses.replace(transfer, double_sided=double_sided), within) == said

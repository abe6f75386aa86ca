"""Bounces on glossy surfaces, and emitters that stand among them: against bakes that fold bounces in, against diffuse transfer, and against the program."""

import dataclasses
import json
import pickle

import numpy as np
import pytest
from shapes import box, grid
from test_emitters import pose, turn, write_obj
from test_glossy import EYE, refused

import program
import relume

ORDERS = dict(order=3, transfer="glossy", transfer_order=5)


def shelf():
    """A floor, and over it a board; both face up, so that the board shows the floor its back."""
    floor, faces = grid(7)
    board, more = grid(4, 0.4)
    return np.concatenate([floor, board + (0.1, 0.5, -0.05)]), np.concatenate([faces, more + len(floor)])


def lantern(place, radiance=(900, 700, 500), radius=0.02):
    return relume.Emitters([relume.Emitter(relume.Sphere(radius), radiance, pose=pose(place), name="lantern")])


def normals_that_round(rng, count):
    """Normals about (1, 1, 0), of any length, whose bits change again after two divisions by their lengths."""

    def unit(vectors):
        wide = vectors.astype(float)
        return (wide / np.linalg.norm(wide, axis=1, keepdims=True)).astype(np.float32)

    many = rng.normal((1, 1, 0), 0.2, size=(1 << 16, 3)).astype(np.float32)
    twice = unit(unit(many))
    return many[(twice != unit(unit(twice))).any(axis=1)][:count]


@pytest.mark.parametrize("double_sided", [False, True])
@pytest.mark.parametrize("brdf", [relume.Ggx(metallic=0.6, roughness=0.6), relume.Phong((0.3, 0.2, 0.1), 0.5, 8)], ids=["ggx", "phong"])
def test_bounces_of_distant_light_are_those_that_a_bake_folds_in(double_sided, brdf):
    vertices, faces = shelf()
    # A bowl, so that the floor sees itself, tilted to where its normals are.
    vertices[:, 1] += (vertices[:, [0, 2]] ** 2).sum(axis=1)
    vertices = vertices @ turn((0, 0, 1), -45).T
    rng = np.random.default_rng(3)
    normals = normals_that_round(rng, len(vertices))
    albedo = rng.uniform(0.3, 0.9, size=vertices.shape)
    common = dict(ORDERS, samples=256, seed=5, normals=normals, albedo=albedo, brdf=brdf, double_sided=double_sided)
    direct, folded = relume.bake(vertices, faces, **common), relume.bake(vertices, faces, **common, bounces=2)
    assert direct.back_matrices.shape == (len(direct.back_vertices), 1, 25, 9) and direct.back_matrices.dtype == np.float32
    assert folded.back_matrices.shape == (len(direct.back_vertices), 3, 25, 9)
    np.testing.assert_array_equal(direct.back_vertices, np.arange(len(vertices)) if double_sided else [])
    sky = relume.light("sky:30,3", order=3)
    expected = relume.shade(folded, sky, eye=EYE)
    found = relume.shade(direct, sky, eye=EYE, bounces=2)
    assert found.shape == (len(vertices), 3) and found.dtype == np.float32
    # The same rays, which are scrambled by the bits of the normals; f32 is rounded in other places.
    np.testing.assert_allclose(found, expected, atol=3e-6 * expected.max())
    once = relume.shade(direct, sky, eye=EYE)
    assert np.abs(found - once).max() > 0.005 * expected.max()
    np.testing.assert_array_equal(relume.shade(direct, sky, eye=EYE, bounces=0), once)
    # The same light for each vertex is distant light, and bounces do not pass through pickling changed.
    same = np.broadcast_to(sky, (len(vertices), 9, 3))
    np.testing.assert_array_equal(relume.shade(direct, same, eye=EYE, bounces=2), found)
    np.testing.assert_array_equal(relume.shade(pickle.loads(pickle.dumps(direct)), sky, eye=EYE, bounces=2), found)


def test_light_bounces_by_the_brdf_that_is_given_at_last():
    mesh = dict(zip(("vertices", "faces"), shelf()), **ORDERS, samples=64)
    lambert, phong = relume.bake(**mesh), relume.bake(**mesh, brdf=relume.Phong(0.2, 0.6, 10))
    sky = relume.light("sky:30,3", order=3)
    found = relume.shade(dataclasses.replace(lambert, brdf=phong.brdf), sky, eye=EYE, bounces=1)
    np.testing.assert_array_equal(found, relume.shade(phong, sky, eye=EYE, bounces=1))


@pytest.mark.parametrize("bounces", [0, 1])
@pytest.mark.parametrize(
    ("brdf", "flags", "digits"),
    [
        (relume.Phong((0.3, 0.2, 0.1), 0.4, 6), "--brdf phong --kd 0.3,0.2,0.1 --ks 0.4 --exponent 6", 0),
        # Albedo of vertices rounds where it is interpolated, that of a material does not.
        (relume.Ggx((0.8, 0.5, 0.3), metallic=1, roughness=0.6), "--brdf ggx --base-color 0.8,0.5,0.3 --metallic 1 --roughness 0.6", 1e-6),
    ],
    ids=["phong", "ggx"],
)
def test_lamps_within_glossy_surfaces_are_those_of_the_program(tmp_path, bounces, brdf, flags, digits):
    vertices, faces = box(0.6, 0.8, 0.7, lid=False)
    middle = [float(x) for x in vertices.mean(axis=0)]
    lamps = [
        {"name": "lantern", "sphere": 0.02, "position": middle, "radiance": [900, 700, 500]},
        {"name": "panel", "quad": [2, 2], "position": [3, 2, 0], "target": [0, 0, 0], "radiance": [4, 3, 2]},
    ]
    (tmp_path / "lamps.json").write_text(json.dumps({"emitters": lamps}))
    write_obj(tmp_path / "box.obj", vertices, faces)
    bake = ["--order", 3, "--samples", 64, "--transfer", "glossy", "--transfer-order", 5, *flags.split()]
    program.relume("bake", tmp_path / "box.obj", "-o", tmp_path / "box.glb", *bake)
    shade = ["--emitters", tmp_path / "lamps.json", "--bounces", bounces, "--eye", "1,3,2", "-o", tmp_path / "box.npz"]
    program.relume("shade", tmp_path / "box.glb", *shade)
    transfer = relume.bake(vertices, faces, **ORDERS, samples=64, brdf=brdf)
    emitters = relume.Emitters.load(tmp_path / "lamps.json")
    ours = relume.shade(transfer, emitters, eye=EYE, bounces=bounces)
    with np.load(tmp_path / "box.npz") as theirs:
        np.testing.assert_allclose(ours, theirs["radiance"], rtol=0, atol=digits * ours.max())
    # Were the lantern outside, light at vertices would say all; it is not.
    outside = relume.shade(transfer, emitters.light_at(vertices, 3), eye=EYE, bounces=bounces)
    assert np.abs(ours - outside).max() > 0.05 * outside.max()


@pytest.mark.parametrize("double_sided", [False, True])
def test_lambert_lit_by_a_lamp_beside_it_is_diffuse_transfer(double_sided):
    vertices, faces = shelf()
    place = (0.1, 0.2, 0.0)
    lamp, albedo = lantern(place), (0.8, 0.5, 0.3)
    common = dict(samples=1024, albedo=albedo, double_sided=double_sided)
    direct = relume.bake(vertices, faces, **common, gather=True)
    glossy = relume.bake(vertices, faces, **common, **ORDERS)
    eye = (0, 8, 0)
    # Below the lamp: π sin²σ cos θ / π of a small ball's radiance, of which Lambert reflects its albedo. The fit keeps irradiance, in f32.
    apart = np.asarray(place) - vertices
    distance = np.linalg.norm(apart, axis=1)
    floor = (vertices[:, 1] == 0) & (distance < 0.6)
    assert floor.sum() > 4
    expected = np.multiply.outer(((0.02 / distance) ** 2 * apart[:, 1] / distance)[floor], np.multiply((900, 700, 500), albedo))
    np.testing.assert_allclose(relume.shade(glossy, lamp, eye=eye)[floor], expected, rtol=1e-5)
    # The same rays again, and Lambert's share of what arrives is linear in it: f32, once more.
    diffuse = relume.shade(direct, lamp, albedo=albedo, bounces=2)
    found = relume.shade(glossy, lamp, eye=eye, bounces=2)
    np.testing.assert_allclose(found, diffuse, atol=1e-5 * diffuse.max())
    # The board's back sends down what the floor sends up, where it reflects at all.
    once = relume.shade(glossy, lamp, eye=eye)
    below = floor & (np.abs(vertices[:, [0, 2]] - (0.1, -0.05)).max(axis=1) < 0.4)
    assert ((found - once)[below, 0].max() > 0.02 * once[below, 0].max()) == double_sided


FOLDED = "transfer: has bounces folded in (3 channels), which hold for distant light alone; bake it with bounces=0, and give bounces to relume.shade"


def test_what_cannot_bounce_is_refused():
    mesh = dict(zip(("vertices", "faces"), shelf()), samples=16, order=2, transfer="glossy", transfer_order=2)
    folded, lamp, sky = relume.bake(**mesh, bounces=1), lantern((0, 3, 0)), relume.light("sky:30,3", order=2)
    assert refused(relume.shade, folded, sky, eye=EYE, bounces=1) == FOLDED
    assert refused(relume.shade, folded, lamp, eye=EYE) == FOLDED
    direct = relume.bake(**mesh)
    assert refused(relume.shade, direct, sky, eye=EYE, bounces=65) == "bounces: 65 is not within 0…64"
    assert refused(relume.shade, direct, sky, eye=EYE, bounces=0.5) == "bounces: 0.5 is not a whole number"
    assert refused(relume.shade, direct, sky, bounces=1).startswith("eye: missing")
    short = np.zeros((3, 4, 3))
    assert refused(relume.shade, direct, short, eye=EYE, bounces=1) == "light: 3 for 65 vertices; give one for each, or one for all [order², 3]"


def test_a_glossy_transfer_that_was_tampered_with_is_refused():
    mesh = dict(zip(("vertices", "faces"), grid(2)), samples=16, order=2, transfer="glossy", transfer_order=3)
    one, two = relume.bake(**mesh), relume.bake(**mesh, double_sided=True)
    sky, lamp = relume.light("sky:30,3", order=2), lantern((0, 0.01, 0), radius=0.1)
    whole = "4 vertices; give one for each"
    sides = "transfer.back_vertices: not the vertices of double-sided faces; bake it again"
    for transfer, change, message in (
        (one, dict(faces=[[0, 1, 4]]), "faces: [0, 2] is 4, but the 4 vertices are numbered from 0 to 3"),
        (one, dict(faces=[[0, 1, 1]]), "faces: has no triangles, so there is nothing to bake; export a mesh with faces that have an area"),
        (one, dict(positions=one.positions[:2]), f"transfer.positions: 2 for {whole}"),
        (one, dict(normals=one.normals[:2]), f"normals: 2 for {whole}"),
        (one, dict(normals=None), "normals: holds object; give an array [V, 3] of floats"),
        (one, dict(valid=one.valid[:2]), f"transfer.valid: has the shape [2] for {whole}"),
        (one, dict(matrices=one.matrices[:2]), "transfer.valid: has the shape [4] for 2 vertices; give one for each"),
        (one, dict(samples=0), "transfer.samples: 0 is not within 1…4194304"),
        (one, dict(seed=-1), "transfer.seed: -1 is not within 0…18446744073709551615"),
        (one, dict(double_sided=True), sides),
        (two, dict(double_sided=False), sides),
        (two, dict(back_vertices=two.back_vertices[::-1]), sides),
        (two, dict(back_vertices=[0, 1, 2, 9]), sides),
        (two, dict(faces=two.faces[:1]), sides),
        (
            two,
            dict(back_vertices=[0, 1]),
            "transfer.back_matrices: has the shape [4, 1, 9, 4] for 2 back_vertices and matrices [4, 1, 9, 4]; bake it again",
        ),
        (
            two,
            dict(back_matrices=two.back_matrices[:, :, :4]),
            "transfer.back_matrices: has the shape [4, 1, 4, 4] for 4 back_vertices and matrices [4, 1, 9, 4]; bake it again",
        ),
        (
            one,
            dict(back_vertices=[-1]),
            "transfer.back_vertices: has the shape [1] or numbers below 0; give what relume.bake gave, a list of integers from 0",
        ),
    ):
        changed = dataclasses.replace(transfer, **change)
        assert refused(relume.shade, changed, sky, eye=EYE, bounces=1) == message
        assert refused(relume.shade, changed, lamp, eye=EYE) == message


def test_arrays_that_mean_something_else_do_no_harm():
    """What fits together is shaded, whatever was baked."""
    transfer = relume.bake(*grid(3), samples=16, order=2, transfer="glossy", transfer_order=3, double_sided=True)
    sky, lamp = relume.light("sky:30,3", order=2), lantern((0, 0.01, 0), radius=0.1)
    for change in (
        dict(normals=np.zeros((9, 3))),
        dict(normals=1e30 * transfer.normals),
        dict(positions=np.random.default_rng(1).uniform(-1e6, 1e6, size=(9, 3))),
        dict(valid=np.zeros(9, bool)),
        dict(samples=1, seed=7),
        dict(albedo=0.3),
        dict(brdf=relume.Ggx(metallic=1, roughness=0)),
    ):
        changed = dataclasses.replace(transfer, **change)
        for light, bounces in ((sky, 1), (lamp, 0), (lamp, 1)):
            assert relume.shade(changed, light, eye=EYE, bounces=bounces).shape == (9, 3)

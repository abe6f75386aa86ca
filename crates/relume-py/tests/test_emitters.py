"""Lights that stand near against closed forms that are derived beside them, and against the program."""

import json
from math import asin, cos, pi, radians, sin, sqrt

import numpy as np
import pytest
from shapes import ONE, box, grid, harmonics, icosphere

import program
import relume

ORDER = 5


def pose(position=(0, 0, 0), rotation=None, scale=1.0):
    made = np.eye(4)
    made[:3, :3] = scale * (np.eye(3) if rotation is None else rotation)
    made[:3, 3] = position
    return made


def turn(axis, degrees):
    """The right-handed rotation about a unit axis, by Rodrigues' formula."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + sin(radians(degrees)) * cross + (1 - cos(radians(degrees))) * cross @ cross


def one(shape, radiance=1.0, **keywords):
    return relume.Emitters([relume.Emitter(shape, radiance, **keywords)])


@pytest.mark.parametrize("exponent", [0, 3])
def test_a_far_quad_is_its_solid_angle_times_its_radiance(exponent):
    # Toward the origin from 10 m along (1, 2, 2)/3, its normal 40° off the line: Ω = A cos 40° / d², and radiance falls by cosᵏ 40°.
    toward = np.array([1, 2, 2]) / 3
    side = np.cross(toward, [0, 1, 0])
    normal = turn(side, 40) @ -toward
    up = np.cross(normal, side)
    rotation = np.stack([np.cross(up, normal), up, normal], axis=1) / [np.linalg.norm(side), np.linalg.norm(up), 1]
    rgb = np.array([12.0, 11.0, 9.0])
    lamp = one(relume.Quad(0.02, 0.01), rgb, pose=pose(10 * toward, rotation), exponent=exponent)
    solid_angle = 0.02 * 0.01 * cos(radians(40)) / 100
    expected = solid_angle * cos(radians(40)) ** exponent * harmonics([toward], ORDER)[0][:, None] * rgb
    light = lamp.light_at([[0, 0, 0]], ORDER)
    assert light.shape == (1, 25, 3) and light.dtype == np.float32 and light.flags.c_contiguous
    # It is 0.002 wide as seen; second derivatives of degree 4, up to 20 of it, leave 20 · 0.002² / 24 of the largest; so do those of the cosine. f32 rounds more.
    np.testing.assert_allclose(light[0], expected, atol=1e-5 * np.abs(expected).max())
    found = lamp.incident((0, 0, 0), ORDER)
    assert found.coefficients.dtype == np.float64
    np.testing.assert_allclose(found.coefficients, expected, atol=1e-5 * np.abs(expected).max())
    assert found.solid_angle == pytest.approx(solid_angle, rel=1e-5)
    assert found.mean_distance == pytest.approx(10, rel=1e-5)


def zonal(half_angle, order):
    """∫ P_l over a cap about the pole: 2π ∫ from cos α to 1 = 2π (P_{l−1}(cos α) − P_{l+1}(cos α)) / (2l + 1), P_{−1} = 1."""
    legendre = [np.polynomial.legendre.Legendre.basis(l)(cos(half_angle)) for l in range(order + 1)]
    before = [1.0, *legendre]
    return np.repeat([2 * pi * (before[l] - legendre[l + 1]) / (2 * l + 1) for l in range(order)], [2 * l + 1 for l in range(order)])


def test_a_sphere_is_a_cap_of_its_half_angle():
    toward = np.array([2, -1, 2]) / 3
    lamp = one(relume.Sphere(0.25), 3, pose=pose(2 * toward, scale=2))
    half_angle = asin(0.5 / 2)
    # The cap's zonal coefficients, turned to where it stands (Funk and Hecke).
    expected = 3 * zonal(half_angle, ORDER) * harmonics([toward], ORDER)[0]
    found = lamp.incident((0, 0, 0), ORDER)
    np.testing.assert_allclose(found.coefficients, np.repeat(expected[:, None], 3, axis=1), atol=1e-9)
    np.testing.assert_allclose(lamp.light_at([[0, 0, 0]], ORDER)[0, :, 1], expected, atol=1e-6)
    assert found.solid_angle == pytest.approx(2 * pi * (1 - cos(half_angle)), rel=1e-12)


def test_inside_a_bright_sphere_it_is_bright_everywhere():
    inside = one(relume.Sphere(2), 0.5, two_sided=True)
    found = inside.incident((0, 0, 0), 3)
    expected = np.zeros((9, 3))
    expected[0] = 0.5 * ONE
    np.testing.assert_allclose(found.coefficients, expected, atol=1e-12)
    assert (found.solid_angle, found.mean_distance) == (pytest.approx(4 * pi), pytest.approx(2))
    black = one(relume.Sphere(2), 0.5).incident((0, 0, 0), 3)
    assert not black.coefficients.any() and black.mean_distance == np.inf
    # An open floor in it sends out its albedo times that.
    vertices, faces = grid(3)
    transfer = relume.bake(vertices, faces, samples=64, order=3)
    radiance = relume.shade(transfer, inside.light_at(vertices, 3), albedo=0.4)
    np.testing.assert_allclose(radiance, 0.2, atol=1e-6)


def brightness(shape, at, **keywords):
    """Of coefficient 0 at a far point, over that of the same shape with radiance 1 everywhere."""
    emitter = relume.Emitters([relume.Emitter(shape, **keywords)]).incident(at, 1).coefficients[0]
    return emitter / one(shape).incident(at, 1).coefficients[0]


def test_every_face_shines_as_it_is_told():
    colours = np.arange(18, dtype=float).reshape(6, 3)
    directions = [(-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1)]
    for colour, direction in zip(colours, directions):
        # From 1000 m in front of a face, the others are seen edge on or from behind.
        np.testing.assert_allclose(brightness(relume.Cuboid(1, 2, 3), 1000 * np.array(direction), radiance=colours), colour, rtol=1e-6)
    # Blocks run from the top left, as +z sees them: alone, the first is seen up and to the left.
    first = one(relume.Blocks(2, 2, 2, 2, 0.5), [(1, 1, 1), (0, 0, 0), (0, 0, 0), (0, 0, 0)])
    ratio = first.incident((0, 0, 100), 2).coefficients[:, 0]
    expected = harmonics([np.array([-0.5, 0.5, -100]) / sqrt(10000.5)], 2)[0]
    # 0.005 wide as seen: squares of that.
    np.testing.assert_allclose(ratio / ratio[0], expected / expected[0], rtol=1e-4)


def test_radiance_of_corners_is_linear_between_them():
    corners = np.array([(4, 0, 0), (0, 4, 0), (0, 0, 4), (1, 1, 1)], float)
    # From far away the mean by area: of the fan's triangles (a, b, c) and (a, c, d), that of three corners each.
    mean = (corners[[0, 1, 2]].mean(axis=0) + corners[[0, 2, 3]].mean(axis=0)) / 2
    np.testing.assert_allclose(brightness(relume.Quad(1, 1), (0, 0, 1000), vertex_radiance=corners), mean, rtol=1e-5)


def test_backs_are_black_unless_they_shine_too():
    behind = (0, 0, -2)
    assert not one(relume.Disc(1)).incident(behind).coefficients.any()
    both = one(relume.Disc(1), two_sided=True)
    # A disc of radius 1 from 2 m: a cap of tan α = 1/2; its 48 corners keep the area, and the solid angle to a thousandth.
    assert both.incident(behind).solid_angle == pytest.approx(2 * pi * (1 - 2 / sqrt(5)), rel=1e-3)
    assert both.incident(behind).coefficients[0, 0] == pytest.approx(both.incident((0, 0, 2)).coefficients[0, 0])


def test_a_mesh_of_any_faces_is_the_shape_it_makes():
    corners = [(-0.5, -1, 0), (0.5, -1, 0), (0.5, 1, 0), (-0.5, 1, 0), (0, -1, 0)]
    expected = one(relume.Quad(1, 2)).light_at([[0.3, 0.2, 1]])
    for faces in (np.array([[0, 1, 2, 3]]), np.array([[0, 1, 2], [0, 2, 3]]), [[0, 4, 3], (4, 1, 2, 3)]):
        # Sums of f32 in another order.
        np.testing.assert_allclose(one(relume.Mesh(corners, faces)).light_at([[0.3, 0.2, 1]]), expected, atol=1e-5)


def test_a_black_emitter_hides_what_is_behind_it():
    panel = relume.Emitter(relume.Quad(1, 1), 5, pose=pose((0, 0, -2)))
    bar = relume.Emitter(relume.Quad(9, 9), 0, pose=pose((0, 0, -1)), two_sided=True)
    both = relume.Emitters([panel, bar])
    assert not both.light_at([[0, 0, 0]]).any()
    both.set_pose(1, pose((0, 0, -3)))
    np.testing.assert_array_equal(both.light_at([[0, 0, 0]]), relume.Emitters([panel]).light_at([[0, 0, 0]]))


def test_lights_and_points_that_are_moved_together_see_the_same():
    shapes = [relume.Emitter(relume.Cuboid(1, 0.5, 0.2), 3, name="box"), relume.Emitter(relume.Sphere(0.3), 20)]
    lamps = relume.Emitters(shapes)
    stand = [pose((2, 1, 0), turn((1, 2, 3), 50)), pose((-1, 2, 1))]
    points = np.random.default_rng(4).uniform(-0.5, 0.5, size=(20, 3))
    for i, where in enumerate(stand):
        lamps.set_pose(i, where)
        np.testing.assert_allclose(lamps.pose(i), where, atol=1e-15)
    before = lamps.light_at(points, 4)
    rotation = turn((3, -1, 2), 77)
    move = pose((5, -3, 2), rotation, 2.5)
    for i, where in enumerate(stand):
        lamps.set_pose(i, move @ where)
    after = lamps.light_at(points @ move[:3, :3].T + move[:3, 3], 4)
    # The same radiance from turned directions; positions are rounded to f32, 10⁻⁶ of the nearest distances.
    directions = np.random.default_rng(5).normal(size=(64, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    seen = np.einsum("di,vic->vdc", harmonics(directions, 4), before)
    turned = np.einsum("di,vic->vdc", harmonics(directions @ rotation.T, 4), after)
    np.testing.assert_allclose(turned, seen, atol=2e-5 * np.abs(seen).max())


def test_shading_by_vertex_is_transfer_times_each_vertexs_own_light():
    rng = np.random.default_rng(11)
    transfer = rng.normal(size=(30, 1, 16)).astype(np.float32)
    for order in (3, 4, 5):
        light = rng.normal(size=(30, order**2, 3)).astype(np.float32)
        count = min(order**2, 16)
        expected = np.einsum("vi,vic->vc", transfer[:, 0, :count].astype(float), light[:, :count])
        # f32 products of 16 terms of size 1.
        np.testing.assert_allclose(relume.shade(transfer, light), expected, atol=2e-5)
        same = np.broadcast_to(light[:1], light.shape)
        np.testing.assert_allclose(relume.shade(transfer, same), relume.shade(transfer, light[0]), atol=2e-5)


def test_glossy_surfaces_take_light_by_vertex():
    glossy = relume.bake(*grid(3), samples=64, order=3, transfer="glossy", transfer_order=4, brdf=relume.Phong(0.2, 0.3, 5))
    lamp = one(relume.Quad(1, 1), 9, pose=pose((0, 1.5, 0), turn((1, 0, 0), 90)))
    eye = (1.0, 3.0, 2.0)
    light = lamp.light_at(glossy.positions, 3)
    radiance = relume.shade(glossy, light, eye=eye)
    np.testing.assert_array_equal(relume.shade(glossy, lamp, eye=eye), radiance)
    for vertex in (0, 4, 8):
        np.testing.assert_allclose(radiance[vertex], relume.shade(glossy, light[vertex], eye=eye)[vertex], atol=1e-6)
    assert radiance.max() > 0


@pytest.mark.parametrize("double_sided", [False, True])
def test_bounces_of_distant_light_are_those_that_a_bake_folds_in(double_sided):
    mesh = dict(zip(("vertices", "faces"), box(0.6, 0.8, 0.7, lid=False)))
    common = dict(samples=256, order=3, albedo=(0.8, 0.5, 0.3), double_sided=double_sided)
    direct = relume.bake(**mesh, **common, gather=True)
    assert direct.vectors.shape == (len(mesh["vertices"]), 1, 9)
    assert (len(direct.back_vertices) > 0) == double_sided
    np.testing.assert_array_equal(direct.vectors, relume.bake(**mesh, **common))
    sky = relume.light("sky:30,3", order=3)
    for bounces in (0, 1, 3):
        folded = relume.shade(relume.bake(**mesh, **common, bounces=bounces), sky)
        # The same rays; sums in f32 of numbers of size 1.
        np.testing.assert_allclose(relume.shade(direct, sky, bounces=bounces), folded, atol=2e-4 * folded.max())
    # By hand: E + G E, from the arrays as the docstring has them.
    sides = np.concatenate([relume.shade(direct.vectors, sky), relume.shade(direct.back_vectors, sky)])
    rows = np.repeat(np.arange(len(sides)), np.diff(direct.starts))
    once = sides.copy()
    np.add.at(once, rows, direct.weights * sides[direct.columns])
    np.testing.assert_allclose(relume.shade(direct, sky, bounces=1), once[: len(direct.vectors)], atol=1e-4 * once.max())


LAMPS = {
    "emitters": [
        {"name": "panel", "quad": [2, 2], "position": [3, 2, 0], "target": [0, 0, 0], "radiance": [4, 3, 2]},
        {"sphere": 0.2, "position": [0, 3, 2], "radiance": 20},
    ]
}


@pytest.fixture
def lamps(tmp_path):
    (tmp_path / "lamps.json").write_text(json.dumps(LAMPS))
    return tmp_path / "lamps.json"


def write_obj(path, vertices, faces):
    lines = ["v %r %r %r" % tuple(map(float, v)) for v in vertices.astype(np.float32)] + ["f %d %d %d" % tuple(f + 1) for f in faces]
    path.write_text("\n".join(lines) + "\n")


def test_the_whole_flow_gives_the_radiance_of_the_program(tmp_path, lamps):
    vertices, faces = box(0.6, 0.8, 0.7, lid=False)
    write_obj(tmp_path / "box.obj", vertices, faces)
    albedo = (0.8, 0.5, 0.3)
    program.relume("bake", tmp_path / "box.obj", "-o", tmp_path / "box.glb", "--samples", 64, "--gather", "--albedo", "0.8,0.5,0.3")
    program.relume("shade", tmp_path / "box.glb", "--emitters", lamps, "--bounces", 2, "-o", tmp_path / "box.npz")
    emitters = relume.Emitters.load(lamps)
    assert len(emitters) == 2 and emitters.names == ["panel", "emitter 1"]
    assert repr(emitters) == "<relume.Emitters: 'panel', 'emitter 1'>"
    direct = relume.bake(vertices, faces, samples=64, gather=True, albedo=albedo)
    with np.load(tmp_path / "box.npz") as theirs:
        assert theirs["radiance"].tobytes() == relume.shade(direct, emitters, albedo=albedo, bounces=2).tobytes()
    # Their light.npz is ours, and ours theirs.
    program.relume("light", "--emitters", lamps, "--for", tmp_path / "box.glb", "-o", tmp_path / "light.npz")
    light = relume.read_light(tmp_path / "light.npz")
    np.testing.assert_array_equal(light, emitters.light_at(vertices))
    with np.load(tmp_path / "light.npz") as theirs:
        normals = theirs["normal"]
    relume.write_light(tmp_path / "ours.npz", light, positions=vertices, normals=normals, valid=direct.valid)
    assert (tmp_path / "ours.npz").read_bytes() == (tmp_path / "light.npz").read_bytes()
    relume.write_light(tmp_path / "bare.npz", light, positions=vertices)
    program.relume("shade", tmp_path / "box.glb", "--light", tmp_path / "bare.npz", "--bounces", 2, "-o", tmp_path / "again.npz")
    with np.load(tmp_path / "box.npz") as a, np.load(tmp_path / "again.npz") as b:
        np.testing.assert_array_equal(a["radiance"], b["radiance"])


@pytest.mark.parametrize("double_sided", [False, True])
def test_lamps_within_the_object_are_seen_from_where_they_stand(tmp_path, double_sided):
    vertices, faces = box(0.6, 0.8, 0.7, lid=False)
    middle = [float(x) for x in vertices.mean(axis=0)]
    lamp = {"emitters": [{"name": "lantern", "sphere": 0.02, "position": middle, "radiance": [900, 700, 500]}, *LAMPS["emitters"]]}
    (tmp_path / "lamp.json").write_text(json.dumps(lamp))
    emitters = relume.Emitters.load(tmp_path / "lamp.json")
    common = dict(samples=64, albedo=(0.8, 0.5, 0.3), double_sided=double_sided)
    direct = relume.bake(vertices, faces, **common, gather=True)
    lit = relume.shade(direct, emitters, albedo=common["albedo"], bounces=1)
    if not double_sided:
        write_obj(tmp_path / "box.obj", vertices, faces)
        program.relume("bake", tmp_path / "box.obj", "-o", tmp_path / "box.glb", "--samples", 64, "--gather", "--albedo", "0.8,0.5,0.3")
        program.relume("shade", tmp_path / "box.glb", "--emitters", tmp_path / "lamp.json", "--bounces", 1, "-o", tmp_path / "box.npz")
        with np.load(tmp_path / "box.npz") as theirs:
            assert theirs["radiance"].tobytes() == lit.tobytes()
    # On the floor below it: π sin²σ cos θ / π of a small ball's radiance.
    alone = relume.Emitters([relume.Emitter(relume.Sphere(0.02), (900, 700, 500), pose=pose(middle))])
    found = relume.shade(direct, alone)
    apart = np.asarray(middle) - vertices
    distance = np.linalg.norm(apart, axis=1)
    floor = np.isclose(vertices[:, 1], vertices[:, 1].min()) & (np.abs(vertices[:, [0, 2]] - np.take(middle, [0, 2])).max(axis=1) < 0.2)
    assert floor.any()
    expected = 900 * (0.02 / distance) ** 2 * apart[:, 1] / distance
    np.testing.assert_allclose(found[floor, 0], expected[floor], rtol=1e-5)


def test_a_few_samples_are_nearly_the_exact_light():
    vertices, faces = icosphere(3)
    transfer = relume.bake(vertices, faces, samples=64, order=4)
    lamp = one(relume.Quad(1, 1), 9, pose=pose((0, 0, -2.5)))
    exact = relume.shade(transfer, lamp.light_at(vertices, 4))
    errors = []
    for budget in (4, 64):
        sampled = lamp.sampled_light_at(vertices, transfer, 4, albedo=(1, 0.5, 0.5), budget=budget)
        count = len(sampled.positions)
        assert 0 < count <= budget and sampled.light.shape == (len(vertices), 16, 3)
        assert sampled.radii.shape == sampled.weights.shape == (count,)
        assert sampled.weights.min() > 0 and sampled.weights.max() <= 1
        errors.append(np.sqrt(np.mean((relume.shade(transfer, sampled.light) - exact) ** 2)) / exact.max())
    assert errors[1] < 0.3 * errors[0] and errors[1] < 0.01, errors
    loose = lamp.sampled_light_at(vertices, transfer, 4, epsilon=0.01)
    tight = lamp.sampled_light_at(vertices, transfer, 4, epsilon=0.0001)
    assert len(loose.positions) < len(tight.positions) and tight.epsilon <= 0.0001


def test_no_points_have_no_light():
    assert one(relume.Quad(1, 1)).light_at(np.zeros((0, 3))).shape == (0, 25, 3)
    assert relume.Emitters([]).light_at([[0, 0, 0]]).tolist() == [[[0, 0, 0]] * 25]

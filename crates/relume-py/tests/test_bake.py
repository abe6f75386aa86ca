"""Transfer vectors against closed forms, and against the program's own."""

import numpy as np
import pytest
from shapes import ONE, box, clamped_cosine, grid, harmonics, icosphere, opening_seen

import program
import relume

# A sum of equal f32 numbers, and the rounding of the result.
ROUNDING = 1e-6
# Replicates of a bake, for its own scatter; and the t value of 15 degrees of freedom that one of 10^5 draws exceeds.
SEEDS = 16
FAR = 5.5


def replicates(*mesh, **options):
    """The mean over `SEEDS` seeds and its standard error."""
    results = np.stack([relume.bake(*mesh, seed=seed, **options) for seed in range(SEEDS)]).astype(float)
    return results.mean(axis=0), results.std(axis=0, ddof=1) / np.sqrt(SEEDS)


def test_results_are_contiguous_f32_of_the_shape_promised():
    vertices, faces = grid(3)
    for bounces, channels, order in ((0, 1, 5), (1, 3, 2)):
        result = relume.bake(vertices, faces, bounces=bounces, order=order, samples=16)
        assert result.shape == (9, channels, order * order)
        assert result.dtype == np.float32
        assert result.flags.c_contiguous
    assert relume.bake(vertices, faces, samples=16).shape == (9, 1, 25)


def test_a_convex_sphere_has_the_clamped_cosine_about_each_of_its_normals():
    vertices, faces = icosphere()
    mean, error = replicates(vertices, faces, normals=vertices, samples=256)
    expected = harmonics(vertices, 5) * clamped_cosine(5)
    # A coefficient that hardly scatters is judged by rounding.
    assert np.all(np.abs(mean[:, 0] - expected) < FAR * error[:, 0] + ROUNDING)


def test_the_opening_of_a_box_is_seen_and_under_a_lid_nothing():
    w, d, h = 0.6, 0.8, 0.7
    mean, error = replicates(*box(w, d, h, lid=False), order=1, samples=256)
    middle, scatter = ONE * mean[4, 0, 0], ONE * error[4, 0, 0]
    assert abs(middle - opening_seen(w, d, h)) < FAR * scatter + ROUNDING
    assert 0 < scatter < 0.01
    closed = relume.bake(*box(w, d, h, lid=True), order=3, bounces=2, samples=64)
    assert np.all(closed[:5] == 0)


def test_light_that_bounces_in_a_box_takes_the_colour_of_its_walls_and_is_never_too_much():
    mesh = box(0.6, 0.8, 0.7, lid=False)
    direct = ONE * relume.bake(*mesh, order=1, samples=256).astype(float)[4, 0, 0]
    bounced = ONE * relume.bake(*mesh, order=1, samples=256, bounces=3, albedo=(0.9, 0.5, 0))[4, :, 0].astype(float)
    assert bounced[0] > bounced[1] > bounced[2]
    # The same rays: what nothing reflects adds nothing.
    assert bounced[2] == pytest.approx(direct, abs=ROUNDING)
    assert bounced[0] < 1


def test_albedos_of_vertices_are_interpolated():
    vertices, faces = box(0.6, 0.8, 0.7, lid=False)
    same = np.tile((0.9, 0.5, 0.1), (len(vertices), 1))
    options = dict(order=2, samples=64, bounces=2)
    np.testing.assert_allclose(
        relume.bake(vertices, faces, albedo=same, **options),
        relume.bake(vertices, faces, albedo=(0.9, 0.5, 0.1), **options),
        # Interpolated weights add up to 1 to within rounding, in each of two bounces.
        atol=ROUNDING,
    )


def test_double_sided_faces_reflect_from_behind_and_one_sided_ones_do_not():
    vertices, faces = grid(3)

    def under_a_ceiling(height, double_sided):
        # The ceiling faces up, too: its back looks down on the floor, which shines up at it.
        mesh = np.concatenate([vertices, vertices + (0, height, 0)]), np.concatenate([faces, faces + len(vertices)])
        return relume.bake(*mesh, double_sided=double_sided, order=1, samples=256, bounces=2, albedo=0.8, return_valid=True)

    # 36 % of the middle's rays meet the ceiling: too few for a buried vertex.
    (black, valid), (white, _) = (under_a_ceiling(1.5, both) for both in (False, True))
    assert white[4, 0, 0] > black[4, 0, 0] * 1.01
    assert valid.all()
    # 83 %, and it is buried where that is a one-sided back.
    assert not under_a_ceiling(0.5, False)[1][4]
    assert under_a_ceiling(0.5, True)[1].all()


def write_ply(path, vertices, faces):
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n" + "".join(f"property float {a}\n" for a in "xyz")
    header += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    rows = np.zeros(len(faces), [("n", "u1"), ("i", "<i4", 3)])
    rows["n"], rows["i"] = 3, faces
    path.write_bytes(header.encode() + vertices.astype("<f4").tobytes() + rows.tobytes())


def write_obj(path, vertices, faces):
    lines = ["v %s %s %s" % tuple(map(repr, map(float, v))) for v in vertices.astype(np.float32)]
    lines += ["f %d %d %d" % tuple(face + 1) for face in faces]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


@pytest.mark.parametrize(("kind", "write"), [("ply", write_ply), ("obj", write_obj)])
@pytest.mark.parametrize("bounces", [0, 2])
def test_the_bytes_are_those_of_the_program(tmp_path, kind, write, bounces):
    vertices, faces = box(0.6, 0.8, 0.7, lid=False)
    # A vertex nobody uses, and a triangle without an area.
    vertices, faces = np.vstack([vertices, (9, 9, 9)]), np.vstack([faces, (0, 0, 1)])
    write(tmp_path / f"scene.{kind}", vertices, faces)
    program.relume("bake", tmp_path / f"scene.{kind}", "-o", tmp_path / "out.glb", "--samples", 128, "--bounces", bounces, "--seed", 3)
    program.relume("export", tmp_path / "out.glb", "-o", tmp_path / "out.npz")
    with pytest.warns(UserWarning, match="1 triangles without area"):
        ours, valid = relume.bake(vertices, faces, samples=128, bounces=bounces, seed=3, return_valid=True)
    with np.load(tmp_path / "out.npz") as theirs:
        assert theirs["transfer"].shape == ours.shape
        assert theirs["transfer"].tobytes() == ours.tobytes()
        np.testing.assert_array_equal(theirs["valid"], valid)


def test_threads_do_not_change_the_bytes_and_seeds_do():
    mesh = box(0.6, 0.8, 0.7, lid=False)
    one, two, five, all_cores = (relume.bake(*mesh, samples=128, bounces=1, threads=n).tobytes() for n in (1, 2, 5, None))
    assert one == two == five == all_cores
    assert relume.bake(*mesh, samples=128, bounces=1, seed=1).tobytes() != one


@pytest.mark.parametrize("kind", [np.int8, np.uint8, np.int16, np.uint16, np.int32, np.uint32, np.int64, np.uint64, ">i4"])
def test_faces_are_integers_of_any_kind(kind):
    vertices, faces = grid(3)
    expected = relume.bake(vertices, faces, samples=16)
    np.testing.assert_array_equal(relume.bake(vertices, faces.astype(kind), samples=16), expected)


def test_arrays_may_be_of_any_order_and_stride_and_lists():
    vertices, faces = grid(3)
    vertices = vertices.astype(np.float32)
    expected = relume.bake(vertices, faces, samples=16, normals=np.tile((0, 1, 0), (9, 1)))
    wide = np.full((9, 7), np.nan)
    wide[:, 1:7:2] = vertices
    backwards = np.ascontiguousarray(vertices[::-1])[::-1]
    tall = np.zeros((3, len(faces) * 2), np.int64)
    tall[:, ::2] = faces.T
    for v, f in (
        (wide[:, 1:7:2], faces),
        (np.asfortranarray(vertices), np.asfortranarray(faces)),
        (backwards, tall[:, ::2].T),
        (vertices.tolist(), faces.tolist()),
        (vertices.astype(">f8"), faces),
    ):
        before = np.array(v), np.array(f)
        np.testing.assert_array_equal(relume.bake(v, f, samples=16, normals=[[0, 2, 0]] * 9), expected)
        assert np.array_equal(v, before[0]) and np.array_equal(f, before[1])


def test_normals_are_used_and_zero_ones_made_up():
    vertices, faces = grid(3)
    tilted = relume.bake(vertices, faces, samples=64, normals=np.tile((1, 1, 0), (9, 1)))
    assert not np.allclose(tilted, relume.bake(vertices, faces, samples=64))
    with pytest.warns(UserWarning, match="9 vertices have no usable normal"):
        made_up = relume.bake(vertices, faces, samples=64, normals=np.zeros((9, 3)))
    np.testing.assert_array_equal(made_up, relume.bake(vertices, faces, samples=64))


def test_buried_vertices_are_told():
    vertices, faces = icosphere(1)
    inside = np.concatenate([vertices, vertices * 0.1]), np.concatenate([faces, faces + len(vertices)])
    _, valid = relume.bake(*inside, samples=64, return_valid=True)
    np.testing.assert_array_equal(valid, np.arange(len(valid)) < len(vertices))


def test_a_mesh_of_trimesh_goes_straight_in():
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.creation.icosphere(subdivisions=2)
    result = relume.bake(mesh.vertices, mesh.faces, normals=mesh.vertex_normals, samples=64)
    assert result.shape == (len(mesh.vertices), 1, 25)
    # Convex: every vertex sees its whole hemisphere.
    np.testing.assert_allclose(ONE * result[:, 0, 0], 1, atol=ROUNDING)

"""A scene of two objects for mitsuba_compare.py: a ball with vertex colours over a textured floor, as glTF and as Mitsuba's PLY."""

import base64
import json
import struct
import zlib

import numpy as np

TEXELS = 64
FLOOR_QUADS = 96
FLOOR_HALF_WIDTH = 2.0
# Inside the ball, where no path goes: its white triangle lends its material to the receivers.
BALL_CENTRE = (0.1, 1.05, -0.05)


def build(tool, folder):
    """Writes the scene; returns the glTF file, Mitsuba's meshes and their materials. The last mesh is white and out of reach."""
    ball, floor = make_ball(tool), make_floor()
    image = make_texture()
    scene = folder / "two_objects.gltf"
    scene.write_text(json.dumps(gltf([ball, floor], png(image))), encoding="ascii")
    meshes = []
    for name, mesh in (("ball", ball), ("floor", floor)):
        meshes.append(str(folder / f"{name}.ply"))
        write_ply(meshes[-1], mesh)
    colours = {"type": "mesh_attribute", "name": "vertex_color"}
    texture = {"type": "bitmap", "bitmap": tool.mi.Bitmap(image), "filter_type": "bilinear", "wrap_mode": "clamp"}
    materials = [{"type": "diffuse", "reflectance": r} for r in (colours, texture)]
    hidden = np.array(BALL_CENTRE) + 1e-3 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    meshes.append((hidden, np.array([[0, 1, 2]]), np.tile([0.0, 0, 1], (3, 1))))
    materials.append(tool.bsdf_dict("diffuse", (1.0, 1.0, 1.0)))
    return scene, meshes, materials


def make_ball(tool):
    positions, faces, normals = tool.icosphere(5, 1.0, BALL_CENTRE)
    # Bands of colour that turn about the ball, 0.1 to 0.9.
    turn = np.arctan2(normals[:, 2], normals[:, 0])[:, None] + np.array([0, 2, 4]) * np.pi / 3
    colours = 0.5 + 0.4 * np.sin(turn + 3 * normals[:, 1:2])
    return arrays(positions, normals, faces, COLOR_0=colours)


def make_floor():
    t = np.linspace(0, 1, FLOOR_QUADS + 1)
    u, v = (grid.ravel() for grid in np.meshgrid(t, t))
    positions = np.stack([(2 * u - 1) * FLOOR_HALF_WIDTH, 0 * u, (2 * v - 1) * FLOOR_HALF_WIDTH], axis=1)
    row = FLOOR_QUADS + 1
    a = (np.arange(FLOOR_QUADS)[:, None] * row + np.arange(FLOOR_QUADS)).ravel()
    faces = np.concatenate([np.stack([a, a + row, a + 1], 1), np.stack([a + 1, a + row, a + row + 1], 1)])
    return arrays(positions, np.tile([0.0, 1, 0], (row * row, 1)), faces, TEXCOORD_0=np.stack([u, v], axis=1))


def arrays(positions, normals, faces, **more):
    """The vertex attributes by their glTF names as float32, and `indices`."""
    attributes = {"POSITION": positions, "NORMAL": normals, **more}
    return {"indices": faces.astype(np.uint32), **{key: np.float32(value) for key, value in attributes.items()}}


def make_texture():
    """8-bit sRGB, rows from the top: coloured waves that no axis flip leaves as they are."""
    y, x = np.mgrid[0:TEXELS, 0:TEXELS] / TEXELS
    waves = [np.sin(7 * x + 2 * y), np.sin(3 * x - 8 * y + 1), np.cos(5 * x * y + 4 * x)]
    return np.uint8(np.clip(140 + 100 * np.stack(waves, axis=2), 0, 255))


def png(image):
    """The image as a PNG file."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    height, width, _ = image.shape
    rows = b"".join(b"\0" + row.tobytes() for row in image)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def gltf(meshes, image):
    """A glTF document with everything embedded; the second mesh carries the texture."""
    blob, views, accessors, shapes = b"", [], [], []
    for i, mesh in enumerate(meshes):
        attributes = {}
        for key, values in mesh.items():
            flat = values.ravel() if key == "indices" else values
            data = flat.tobytes()
            accessor = {
                "bufferView": len(views),
                "componentType": 5125 if key == "indices" else 5126,
                "count": len(flat),
                "type": "SCALAR" if key == "indices" else f"VEC{values.shape[1]}",
            }
            if key == "POSITION":
                accessor |= {"min": values.min(0).tolist(), "max": values.max(0).tolist()}
            attributes[key] = len(accessors)
            accessors.append(accessor)
            views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data)})
            blob += data
        indices = attributes.pop("indices")
        shapes.append({"primitives": [{"attributes": attributes, "indices": indices, "material": i}]})
    uri = lambda kind, data: f"data:{kind};base64,{base64.b64encode(data).decode()}"  # noqa: E731
    plain = {"metallicFactor": 0}
    textured = {"metallicFactor": 0, "baseColorTexture": {"index": 0}}
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(meshes)))}],
        "nodes": [{"mesh": i} for i in range(len(meshes))],
        "meshes": shapes,
        "materials": [{"pbrMetallicRoughness": plain}, {"pbrMetallicRoughness": textured}],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{"magFilter": 9729, "minFilter": 9729, "wrapS": 33071, "wrapT": 33071}],
        "images": [{"uri": uri("image/png", image)}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(blob), "uri": uri("application/octet-stream", blob)}],
    }


def write_ply(path, mesh):
    """Binary PLY with the names Mitsuba reads: u v, and r g b for the attribute `vertex_color`."""
    names = {"POSITION": "x y z", "NORMAL": "nx ny nz", "TEXCOORD_0": "u v", "COLOR_0": "r g b"}
    keys = [key for key in names if key in mesh]
    rows = np.concatenate([mesh[key] for key in keys], axis=1).astype("<f4")
    faces = np.zeros(len(mesh["indices"]), [("n", "u1"), ("i", "<i4", 3)])
    faces["n"], faces["i"] = 3, mesh["indices"]
    columns = [f"property float {name}" for key in keys for name in names[key].split()]
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(rows)}", *columns,
              f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header", ""]  # fmt: skip
    with open(path, "wb") as file:
        file.write("\n".join(header).encode() + rows.tobytes() + faces.tobytes())

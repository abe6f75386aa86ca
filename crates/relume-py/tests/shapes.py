"""Meshes with known transfer, and spherical harmonics that share no code with Relume's."""

from math import factorial, pi, sqrt

import numpy as np

# Coefficient 0 of the light whose radiance is 1 everywhere.
ONE = sqrt(4 * pi)


def icosphere(splits=2):
    """A unit sphere of triangles, counter-clockwise from outside: an octahedron whose edges are halved and pushed out."""
    vertices = [np.array(v, float) for v in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    for _ in range(splits):
        middles = {}

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                point = vertices[a] + vertices[b]
                middles[key] = len(vertices)
                vertices.append(point / np.linalg.norm(point))
            return middles[key]

        split = []
        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            split += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = split
    return np.array(vertices), np.array(faces)


def grid(count=5, half=1.0):
    """A floor of count × count vertices at y = 0 that faces up."""
    steps = np.linspace(-half, half, count)
    vertices = np.array([(x, 0, z) for z in steps for x in steps])
    faces = []
    for row in range(count - 1):
        for column in range(count - 1):
            a = row * count + column
            faces += [(a, a + count, a + count + 1), (a, a + count + 1, a + 1)]
    return vertices, np.array(faces)


def box(half_width, half_depth, height, lid):
    """A box seen from inside, every wall with vertices of its own, and a vertex in the middle of its floor; the first five are the floor's.

    The floor faces up, the walls face in, and the lid, where there is one, faces down.
    """
    w, d, h = half_width, half_depth, height
    floor = [(-w, 0, -d), (-w, 0, d), (w, 0, d), (w, 0, -d), (0, 0, 0)]
    vertices, faces = list(floor), [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
    for a, b in ((0, 1), (1, 2), (2, 3), (3, 0)):
        # From inside, the floor's edge a → b runs counter-clockwise when seen from above, so the wall's front looks in when it climbs at a.
        first = len(vertices)
        up = np.array((0, h, 0))
        vertices += [floor[a], np.add(floor[a], up), np.add(floor[b], up), floor[b]]
        faces += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    if lid:
        first = len(vertices)
        vertices += [(-w, h, -d), (w, h, -d), (w, h, d), (-w, h, d)]
        faces += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    return np.array(vertices, float), np.array(faces)


def opening_seen(half_width, half_depth, height):
    """The form factor from a point to a parallel rectangle centred above it: the share of its cosine-weighted hemisphere."""
    a, b = half_width / height, half_depth / height
    ra, rb = sqrt(1 + a * a), sqrt(1 + b * b)
    return 2 / pi * (a / ra * np.arctan(b / ra) + b / rb * np.arctan(a / rb))


def harmonics(directions, order):
    """Real orthonormal spherical harmonics [N, order²] of unit directions, z polar, no Condon–Shortley phase.

    From the definition: Legendre polynomials are expanded by Rodrigues' formula and differentiated as polynomials.
    """
    x, y, z = np.asarray(directions, float).T
    rho, phi = np.hypot(x, y), np.arctan2(y, x)
    columns = []
    for l in range(order):
        legendre = np.polynomial.legendre.Legendre.basis(l)
        for m in range(-l, l + 1):
            k = abs(m)
            norm = sqrt((2 * l + 1) / (4 * pi) * factorial(l - k) / factorial(l + k)) * (sqrt(2) if m else 1)
            turn = np.cos(k * phi) if m >= 0 else np.sin(k * phi)
            columns.append(norm * rho**k * legendre.deriv(k)(z) * turn)
    return np.stack(columns, axis=1)


def clamped_cosine(order):
    """A_l / π of the clamped cosine for every coefficient, integrated by Gauss–Legendre over the upper half: exact for polynomials."""
    nodes, weights = np.polynomial.legendre.leggauss(64)
    t, w = (nodes + 1) / 2, weights / 2
    bands = [2 * np.sum(w * t * np.polynomial.legendre.Legendre.basis(l)(t)) for l in range(order)]
    return np.repeat(bands, [2 * l + 1 for l in range(order)])

#!/usr/bin/env python3
"""Writes the cloth meshes of the garment scenes as Wavefront OBJ: scripts/make_garments.py tablecloth 41 tablecloth.obj

Every shape comes from formulas; `rings` sets how fine it is. All lie flat in the plane z = 0 round the origin, at rest.
  tablecloth  a disc: 1 + 3 n (n + 1) vertices
  skirt       a ring, the pattern of a circle skirt, from its waist outwards: group "waist" is the first row of triangles
"""
import argparse
import math

SHAPES = {"tablecloth": (0.0, 0.9), "skirt": (0.165, 0.62)}  # inner and outer radius [m]


def ring(k, rings, inner, outer):
    """Points of ring k of `rings`. A disc has 6 k points on ring k; a ring as many as keep its triangles even."""
    radius = inner + (outer - inner) * k / rings
    count = max(1, round(2 * math.pi * radius / ((outer - inner) / rings) * 6 / (2 * math.pi)))
    turn = 0.5 * (k % 2) if inner > 0 else 0
    return [(radius * math.cos(2 * math.pi * (i + turn) / count), radius * math.sin(2 * math.pi * (i + turn) / count)) for i in range(count)]


def between(inside, outside):
    """Triangles between two rings of (first vertex, count, turn): the next point is that which comes first by angle."""
    (a, m, s), (b, n, t) = inside, outside
    out, i, j = [], 0, 0
    while i < (m if m > 1 else 0) or j < n:
        next_inside = (i + 1 + s) / m if m > 1 and i < m else math.inf
        next_outside = (j + 1 + t) / n if j < n else math.inf
        if next_outside <= next_inside:
            out.append((a + i % m, b + j % n, b + (j + 1) % n))
            j += 1
        else:
            out.append((a + i % m, b + j % n, a + (i + 1) % m))
            i += 1
    return out


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("shape", choices=sorted(SHAPES))
parser.add_argument("rings", type=int, help="rings of triangles from the middle or the waist to the rim")
parser.add_argument("out", help="the OBJ file")
options = parser.parse_args()

inner, outer = SHAPES[options.shape]
points, rings, triangles = [], [], []
for k in range(options.rings + 1):
    new = ring(k, options.rings, inner, outer)
    rings.append((len(points), len(new), 0.5 * (k % 2) if inner > 0 else 0))
    points += new
for inside, outside in zip(rings, rings[1:]):
    triangles.append(between(inside, outside))
with open(options.out, "w") as f:
    f.write(f"# scripts/make_garments.py {options.shape} {options.rings}\n")
    f.writelines(f"v {x:.5f} {y:.5f} 0\n" for x, y in points)
    for k, some in enumerate(triangles):
        if k < 2:
            f.write("g waist\n" if k == 0 and inner > 0 else "g cloth\n")
        f.writelines("f %d %d %d\n" % tuple(v + 1 for v in t) for t in some)

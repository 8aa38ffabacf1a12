#!/usr/bin/env python3
"""Writes an irregular triangle mesh of a square sheet as a Wavefront OBJ: scripts/make_cloth_mesh.py 32 sheet.obj

The mesh has as many vertices as a grid of N x N, in the plane z = 0 round the origin. Inner vertices are moved at random by a third of
a cell, then evened out (Lloyd's algorithm towards the centroids of their neighbours). Delaunay triangles join them; the border is even.
"""
import argparse

import numpy as np
from matplotlib.tri import Triangulation

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("n", type=int, help="vertices along a side")
parser.add_argument("out", help="the OBJ file")
parser.add_argument("--size", type=float, default=1.0, help="side [m]")
parser.add_argument("--seed", type=int, default=0)
options = parser.parse_args()

n, random = options.n, np.random.default_rng(options.seed)
line = np.linspace(-0.5, 0.5, n)
x, y = (a.ravel() for a in np.meshgrid(line, line))
inside = (abs(x) < 0.5 - 1e-9) & (abs(y) < 0.5 - 1e-9)
x = np.where(inside, x + random.uniform(-1, 1, x.size) / 3 / (n - 1), x)
y = np.where(inside, y + random.uniform(-1, 1, y.size) / 3 / (n - 1), y)
for _ in range(3):
    edges = Triangulation(x, y).edges
    count = np.bincount(edges.ravel(), minlength=x.size)
    for a in (x, y):
        mean = (np.bincount(edges[:, 0], a[edges[:, 1]], x.size) + np.bincount(edges[:, 1], a[edges[:, 0]], x.size)) / count
        a[inside] += 0.5 * (mean - a)[inside]
triangles = Triangulation(x, y).triangles
p = np.stack([x, y], 1)[triangles]
area = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]) / 2
triangles = triangles[area > 1e-6 / (n - 1) ** 2]  # slivers on the border
with open(options.out, "w") as f:
    f.write(f"# {n} x {n} vertices, seed {options.seed}: scripts/make_cloth_mesh.py\n")
    f.writelines(f"v {options.size * a:.6f} {options.size * b:.6f} 0\n" for a, b in zip(x, y))
    f.writelines("f %d %d %d\n" % tuple(t + 1) for t in triangles)

#!/usr/bin/env python3
"""Writes the cloth meshes of the garment scenes as Wavefront OBJ: scripts/make_garments.py tablecloth 41 tablecloth.obj

Every shape comes from formulas; `rings` sets how fine it is. Discs and rings lie flat in the plane z = 0 round the origin.
  tablecloth  a disc: 1 + 3 n (n + 1) vertices
  skirt       a ring, the pattern of a circle skirt, from its waist outwards: group "waist" is the first row of triangles
  sleeve      a tube round the y axis, from y = 0 downwards: group "armhole" is the first row of triangles
  t-shirt     two panels sewn along their outline but for neck, hem and cuffs, from y = 0 downwards, open to a circle at
              the hem: group "shoulders" is the first row of triangles; rings are rows from the shoulders to the hem
"""
import argparse
import math

DISCS = {"tablecloth": (0.0, 0.9), "skirt": (0.165, 0.62)}  # inner and outer radius [m]
SLEEVE = (0.11, 0.5)  # radius and length [m]
SHIRT_M, SHIRT_ROWS = 0.65, 13  # height, and the rows of the outline below, which is in cells of 5 cm


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


def disc(shape, count):
    """Points, and rows of triangles from the middle or the waist outwards."""
    inner, outer = DISCS[shape]
    points, rings, rows = [], [], []
    for k in range(count + 1):
        new = ring(k, count, inner, outer)
        rings.append((len(points), len(new), 0.5 * (k % 2) if inner > 0 else 0))
        points += [(x, y, 0) for x, y in new]
    for inside, outside in zip(rings, rings[1:]):
        rows.append(between(inside, outside))
    return points, rows


def sleeve(count):
    """A tube whose triangles are equilateral but for rounding: each ring is turned by half a side against the last."""
    radius, length = SLEEVE
    around = max(6, round(2 * math.pi * radius / (length / count) * math.sqrt(3) / 2))
    points, rows = [], []
    for k in range(count + 1):
        for i in range(around):
            angle = 2 * math.pi * (i + 0.5 * (k % 2)) / around
            points.append((radius * math.cos(angle), -length * k / count, radius * math.sin(angle)))
    for k in range(count):
        row, above, below, odd = [], k * around, (k + 1) * around, k % 2
        for i in range(around):
            j = (i + 1) % around
            if odd:
                row += [(above + i, above + j, below + j), (above + i, below + j, below + i)]
            else:
                row += [(above + i, above + j, below + i), (above + j, below + j, below + i)]
        rows.append(row)
    return points, rows


def in_shirt(x, y):
    """Whether the cell from (x, y) to (x + 1, y + 1) belongs to a panel, in cells of 5 cm from its middle and shoulders."""
    neck = -2 <= x < 2 and y < 1
    return not neck and ((-5 <= x < 5 and y < SHIRT_ROWS) or (-9 <= x < 9 and y < 4))


def opened(x, y):
    """Start of a point in row y of the front panel: rows are arcs as long as they are wide, to a half circle at the hem."""
    half, sleeve_row = 0.25, 4
    angle = 0.25 * max(y, 0.1) / sleeve_row if y < sleeve_row else 0.25 + (math.pi / 2 - 0.25) * (y - sleeve_row) / (SHIRT_ROWS - sleeve_row)
    radius, inside = half / angle, min(abs(x), half)
    depth = radius * (math.cos(angle * inside / half) - math.cos(angle))
    beyond = 0.015 * math.sin(math.pi * y / sleeve_row) if y < sleeve_row else 0
    return math.copysign(radius * math.sin(angle * inside / half) + abs(x) - inside, x), max(depth, beyond)


def t_shirt(count):
    """Panels of square cells, cut along diagonals that alternate."""
    fine = max(1, round(count / SHIRT_ROWS))
    size = SHIRT_M / (SHIRT_ROWS * fine)
    cells = [(i, j) for j in range(SHIRT_ROWS * fine) for i in range(-9 * fine, 9 * fine) if in_shirt(i // fine, j // fine)]
    inside = set(cells)
    open_sides = lambda i, j: (j == SHIRT_ROWS * fine, abs(i) == 9 * fine, abs(i) < 2 * fine and j <= fine, abs(i) == 2 * fine and 0 < j <= fine)
    number, points, rows = {}, [], [[] for _ in range(SHIRT_ROWS * fine)]

    def vertex(i, j, side):
        """Seams are shared by both panels: corners of a missing cell that are not at the neck, the hem or a cuff."""
        border = not all((i + a, j + b) in inside for a in (-1, 0) for b in (-1, 0))
        seam = border and (not any(open_sides(i, j)) or j == 0 or (abs(i) == 9 * fine and j == 4 * fine) or (abs(i) == 5 * fine and j == SHIRT_ROWS * fine))
        key = (i, j, 0 if seam else side)
        if key not in number:
            number[key] = len(points)
            x, z = opened(size * i, j / fine)
            points.append((x, -size * j, 0 if seam else side * max(z, 0.003)))
        return number[key]

    for side in (1, -1):
        for i, j in cells:
            a, b, c, d = (vertex(p, q, side) for p, q in ((i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)))
            two = [(a, b, c), (a, c, d)] if (i + j) % 2 else [(a, b, d), (b, c, d)]
            rows[j] += two if side > 0 else [t[::-1] for t in two]
    return points, rows


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("shape", choices=["skirt", "sleeve", "t-shirt", "tablecloth"])
parser.add_argument("rings", type=int, help="rings or rows of triangles from the middle, the waist or the shoulders to the rim")
parser.add_argument("out", help="the OBJ file")
options = parser.parse_args()

FIRST = {"skirt": "waist", "sleeve": "armhole", "t-shirt": "shoulders", "tablecloth": "cloth"}
points, triangles = {"sleeve": sleeve, "t-shirt": t_shirt}.get(options.shape, lambda n: disc(options.shape, n))(options.rings)
with open(options.out, "w") as f:
    f.write(f"# scripts/make_garments.py {options.shape} {options.rings}\n")
    f.writelines("v %.5f %.5f %s\n" % (x, y, "%.5f" % z if z else "0") for x, y, z in points)
    for k, some in enumerate(triangles):
        if k < 2:
            f.write(f"g {FIRST[options.shape] if k == 0 else 'cloth'}\n")
        f.writelines("f %d %d %d\n" % tuple(v + 1 for v in t) for t in some)

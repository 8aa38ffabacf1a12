"""Distances, crossings and lengths for recompute.py, by brute force and with numpy alone. Arrays of points end in an axis of 3."""
import itertools

import numpy as np


def dot(a, b):
    return (a * b).sum(-1)


def norm(a):
    return np.sqrt(dot(a, a))


def cross(a, b):
    """np.cross is several times slower on the small arrays here."""
    x, y, z = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1], a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2], a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return np.stack(np.broadcast_arrays(x, y, z), -1)


def area(t):
    return norm(cross(t[..., 1, :] - t[..., 0, :], t[..., 2, :] - t[..., 0, :])) / 2


def segment_in_triangle(p, q, t):
    """Whether segments p-q cross triangles t (Möller & Trumbore 1997), and where."""
    e1, e2, way = t[..., 1, :] - t[..., 0, :], t[..., 2, :] - t[..., 0, :], q - p
    h = cross(way, e2)
    with np.errstate(divide="ignore", invalid="ignore"):
        f = 1 / dot(e1, h)
        s = p - t[..., 0, :]
        u, k = f * dot(s, h), cross(s, e1)
        v, at = f * dot(way, k), f * dot(e2, k)
        hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (at >= 0) & (at <= 1)
        return hit, p + at[..., None] * way, -np.sign(dot(e1, h))


def pairs_of_triangles(a, b):
    """Which of the pairs of triangles meet, in general position, and the length that each pair shares: that between the two ends."""
    count, ends = 0, []
    for mine, other in ((a, b), (b, a)):
        for i in range(3):
            hit, at, _ = segment_in_triangle(mine[..., i, :], mine[..., (i + 1) % 3, :], other)
            count = count + hit
            ends.append((hit, at))
    length = np.zeros(np.shape(count))
    for (hit, at), (other_hit, other) in itertools.combinations(ends, 2):
        both = hit & other_hit & (count == 2)
        length[both] = norm(np.broadcast_to(at, both.shape + (3,))[both] - np.broadcast_to(other, both.shape + (3,))[both])
    return count == 2, length


def point_to_segment(p, a, b):
    ab = b - a
    long = dot(ab, ab)
    t = np.minimum(np.maximum(dot(p - a, ab) / np.where(long > 0, long, 1), 0), 1)  # a point has no direction: 0
    return norm(p - a - t[..., None] * ab)


def point_to_triangle(p, t):
    best = np.minimum.reduce([point_to_segment(p, t[..., i, :], t[..., (i + 1) % 3, :]) for i in range(3)])
    n = cross(t[..., 1, :] - t[..., 0, :], t[..., 2, :] - t[..., 0, :])
    with np.errstate(divide="ignore", invalid="ignore"):
        n = n / norm(n)[..., None]
        height = dot(p - t[..., 0, :], n)
        foot = p - height[..., None] * n
        above = np.all([dot(cross(t[..., (i + 1) % 3, :] - t[..., i, :], foot - t[..., i, :]), n) >= 0 for i in range(3)], 0)
    return np.where(above, np.abs(height), best)


def segment_to_segment(a, b, c, d):
    """The interior pair of points, where both lie on their segments, else an end and a segment."""
    u, v, w = b - a, d - c, a - c
    uu, vv, uv, uw, vw = dot(u, u), dot(v, v), dot(u, v), dot(u, w), dot(v, w)
    with np.errstate(divide="ignore", invalid="ignore"):
        s, t = (uv * vw - vv * uw) / (uu * vv - uv * uv), (uu * vw - uv * uw) / (uu * vv - uv * uv)
    inner = (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    ends = np.minimum.reduce([point_to_segment(a, c, d), point_to_segment(b, c, d), point_to_segment(c, a, b), point_to_segment(d, a, b)])
    s, t = np.where(inner, s, 0), np.where(inner, t, 0)
    return np.where(inner, np.minimum(norm(w + s[..., None] * u - t[..., None] * v), ends), ends)


def segment_to_triangle(a, b, t):
    hit, _, _ = segment_in_triangle(a, b, t)
    best = np.minimum(point_to_triangle(a, t), point_to_triangle(b, t))
    for i in range(3):
        best = np.minimum(best, segment_to_segment(a, b, t[..., i, :], t[..., (i + 1) % 3, :]))
    return np.where(hit, 0, best)


def triangle_to_triangle(a, b):
    best = np.inf
    for i in range(3):
        best = np.minimum(best, segment_to_triangle(a[..., i, :], a[..., (i + 1) % 3, :], b))
        best = np.minimum(best, segment_to_triangle(b[..., i, :], b[..., (i + 1) % 3, :], a))
    return best


def clipped(t, depth):
    """The part of a triangle where its linear depth is positive: the length of the line depth = 0, and triangles (area, mean depth)."""
    inside = depth > 0
    if inside.all():
        return 0.0, [(float(area(t)), float(depth.mean()))]
    if not inside.any():
        return 0.0, []
    corners = []  # of the polygon inside: (point, depth, whether the line cuts there)
    for i in range(3):
        j = (i + 1) % 3
        if inside[i]:
            corners.append((t[i], depth[i], False))
        if inside[i] != inside[j]:
            corners.append((t[i] + depth[i] / (depth[i] - depth[j]) * (t[j] - t[i]), 0.0, True))
    ends = [p for p, _, cut in corners if cut]
    # A fan from where the line enters the part inside.
    first = next(k for k in range(len(corners)) if corners[k][2] and not corners[(k + 1) % len(corners)][2])
    corners = corners[first:] + corners[:first]
    fan = [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
    return float(norm(ends[1] - ends[0])), [(float(area(np.array([c[0] for c in f]))), sum(c[1] for c in f) / 3) for f in fan]


def depth_figures(pieces):
    """Penetrating area, mean depth over it, and the depth that 99 % of it keeps below."""
    pieces = sorted(pieces, key=lambda p: p[1])
    whole = sum(a for a, _ in pieces)
    if not whole > 0:
        return 0.0, 0.0, 0.0
    below = np.cumsum([a for a, _ in pieces])
    return whole, sum(a * d for a, d in pieces) / whole, pieces[int(np.argmax(below >= 0.99 * whole))][1]


def box_triangles(attributes):
    """The 12 triangles of a box, and its signed distance."""
    centre, half = np.array(attributes["center_m"]), np.array(attributes["half_extent_m"])
    axes = np.array([attributes["axis_u"], attributes["axis_v"], attributes["axis_w"]])
    corners = {s: centre + (np.array(s) * half) @ axes for s in itertools.product((-1, 1), repeat=3)}
    out = []
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        for sign in (-1, 1):
            def corner(a, b):
                s = [0, 0, 0]
                s[k], s[i], s[j] = sign, a, b
                return corners[tuple(s)]
            # The diagonals are those of the program; a contour does not depend on them, its pairs do.
            square = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)]
            out += [[square[0], square[1], square[2]], [square[0], square[2], square[3]]]

    def distance(p):
        d = np.abs((p - centre) @ axes.T) - half
        return np.where((d <= 0).all(-1), d.max(-1), norm(np.maximum(d, 0)))
    return np.array(out), distance

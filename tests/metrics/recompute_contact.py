"""Contour, depth and tunnelling of stored runs, for recompute.py."""
import numpy as np

from recompute_geometry import (area, box_triangles, clipped, cross, depth_figures, dot, norm, pairs_of_triangles, point_to_segment, point_to_triangle,
                                segment_in_triangle, segment_to_triangle, sphere_contour)


def half_space(run, c, x):
    normal, at = np.array(c["normal"], float), np.array(c["point_m"], float)
    depth = (at - x) @ normal
    lengths, pieces = [], []
    for corners in run.triangles:
        length, inside = clipped(x[corners], depth[corners])
        lengths.append(length)
        pieces += inside
    most = max(0.0, depth.max())
    lengths = np.array(lengths)
    return {"length": lengths.sum(), "pairs": (lengths > 0).sum(), "cut": (lengths > 0).mean(), "vertex": most, "depth": most,
            "figures": depth_figures(pieces)}


HALVINGS = 5  # of a triangle's edges, for what is inside of capsules


def parts_of(t, halvings):
    """A triangle cut into 4^halvings parts: (part, corner, 3)."""
    t = t[None]
    for _ in range(halvings):
        m = [(t[:, i] + t[:, (i + 1) % 3]) / 2 for i in range(3)]
        t = np.concatenate([np.stack(c, 1) for c in ((t[:, 0], m[0], m[2]), (m[0], t[:, 1], m[1]), (m[2], m[1], t[:, 2]), (m[0], m[1], m[2]))])
    return t


def inside_capsules(t, shapes):
    """Parts of a triangle inside of capsules: (area, mean depth) each; a part counts by the share of its points that are inside."""
    parts = parts_of(t, HALVINGS)
    middle = parts.mean(1)
    reach = norm(parts[0] - middle[0]).max()
    parts = parts[np.max([r - point_to_segment(middle, a, b) for a, b, r in shapes], 0) > -reach]
    grid = np.array([(i, j, 14 - i - j) for i in range(15) for j in range(15 - i)])
    weights = (grid + 1 / 3) / 15  # the middles of 120 equal triangles that stand as the whole does
    depth = np.max([r - point_to_segment(np.einsum("gc,pck->pgk", weights, parts), a, b) for a, b, r in shapes], 0)
    within = depth > 0
    share = within.mean(1)
    keep = share > 0
    mean = np.divide(np.where(within, depth, 0).sum(1), within.sum(1), where=keep, out=np.zeros(len(parts)))
    each = float(area(t)) / 4**HALVINGS
    return [(each * s, m) for s, m in zip(share[keep], mean[keep])]


def round_depth(run, x, shapes):
    """Greatest depth of the cloth in capsules, edges and faces included, and figures of what is inside."""
    t = x[run.triangles]
    depth = np.array([r - segment_to_triangle(np.broadcast_to(a, (len(t), 3)), np.broadcast_to(b, (len(t), 3)), t) for a, b, r in shapes])
    pieces = [piece for k in np.flatnonzero(depth.max(0) > 0) for piece in inside_capsules(t[k], [s for s, d in zip(shapes, depth[:, k]) if d > 0])]
    return {"depth": max(0.0, float(depth.max())), "figures": depth_figures(pieces)}


def one_sphere(run, c, x):
    centre, radius = np.array(c["center_m"], float), float(c["radius_m"])
    lengths = np.array([sphere_contour(x[t], centre, radius) for t in run.triangles])
    return {"length": lengths.sum(), "pairs": (lengths > 0).sum(), "cut": (lengths > 0).mean(), "vertex": max(0.0, (radius - norm(x - centre)).max())} | round_depth(
        run, x, [(centre, centre, radius)])


def one_box(run, c, x):
    faces, distance = box_triangles(c)
    t = x[run.triangles]
    met, lengths = pairs_of_triangles(t[:, None], np.broadcast_to(faces, (len(t),) + faces.shape))
    middles = [(t[:, i] + t[:, (i + 1) % 3]) / 2 for i in range(3)]
    ring = np.stack([t[:, 0], middles[0], t[:, 1], middles[1], t[:, 2], middles[2]], 1)
    centre = t.mean(1)
    pieces, deepest = [], 0.0
    depth_ring, depth_centre = -distance(ring), -distance(centre)
    for k in range(len(t)):
        deepest = max(deepest, depth_ring[k].max(), depth_centre[k])
        for i in range(6):
            j = (i + 1) % 6
            pieces += clipped(np.array([ring[k, i], ring[k, j], centre[k]]), np.array([depth_ring[k, i], depth_ring[k, j], depth_centre[k]]))[1]
    return {"length": lengths.sum(), "cut": met.any(1).mean(), "vertex": max(0.0, -distance(x).min()), "depth": deepest, "figures": depth_figures(pieces)}


def capsule_contour(t, capsules):
    """Length of the contour in a triangle: the border of what is inside, walked by angle from an inner point of each capsule's section."""
    n = cross(t[1] - t[0], t[2] - t[0])
    n /= norm(n)
    e = (t[1] - t[0]) / norm(t[1] - t[0])
    f = cross(n, e)
    length = 0.0
    for k, (a, b, r) in enumerate(capsules):
        # The deepest point in the plane: the axis's point nearest to it, projected.
        ha, hb = dot(a - t[0], n), dot(b - t[0], n)
        s = np.clip(ha / (ha - hb), 0, 1) if ha != hb else 0.5
        foot = a + s * (b - a)
        inner = foot - dot(foot - t[0], n) * n
        if point_to_segment(inner, a, b) >= r:
            continue
        angle = np.linspace(0, 2 * np.pi, 2001)
        way = np.cos(angle)[:, None] * e + np.sin(angle)[:, None] * f
        low, high = np.zeros(len(angle)), np.full(len(angle), norm(b - a) + 2 * r)
        for _ in range(30):
            m = (low + high) / 2
            inside = point_to_segment(inner + m[:, None] * way, a, b) < r
            low, high = np.where(inside, m, low), np.where(inside, high, m)
        border = inner + low[:, None] * way
        middle = (border[1:] + border[:-1]) / 2
        kept = np.all([dot(cross(t[(i + 1) % 3] - t[i], middle - t[i]), n) >= 0 for i in range(3)], 0)
        for other, (a2, b2, r2) in enumerate(capsules):
            if other != k:
                kept &= point_to_segment(middle, a2, b2) >= r2
        length += norm(np.diff(border, axis=0))[kept].sum()
    return length


def capsules_of(c, frame):
    return [(v[:3], v[3:6], v[6]) for v in c["capsules"][min(frame, len(c["capsules"]) - 1)]]


def all_capsules(run, c, x, frame):
    shapes = capsules_of(c, frame)
    length = 0.0
    for corners in run.triangles:
        t = x[corners]
        middle = t.mean(0)
        reach = norm(t - middle).max()
        near = [s for s in shapes if point_to_segment(middle, s[0], s[1]) <= s[2] + reach]
        if near:
            length += capsule_contour(t, near)
    return {"length": length, "vertex": max(0.0, max((r - point_to_segment(x, a, b)).max() for a, b, r in shapes))} | round_depth(run, x, shapes)


class Mesh:
    """A static mesh: contour and crossing counts of the vertices."""

    def __init__(self, run, c):
        self.faces = np.array(c["position_m"], float)[c["triangles"]]
        self.links = np.unique(np.sort(np.concatenate([run.triangles[:, [i, (i + 1) % 3]] for i in range(3)]), 1), axis=0)
        edges = np.sort(np.concatenate([c["triangles"][:, [i, (i + 1) % 3]] for i in range(3)]), 1)
        edges, faces = np.unique(edges, axis=0, return_counts=True)
        self.border = np.array(c["position_m"], float)[edges[faces == 1]]
        self.counts, self.before, self.contour_before = np.zeros(run.x.shape[1], int), None, False
        self.dropped = np.zeros(run.x.shape[1], bool)

    def out_of_reach(self, p, q):
        """Whether a vertex's way cannot have led round the border: twice the way is less than the distances from it before and after."""
        far = [point_to_segment(v[:, None], self.border[:, 0], self.border[:, 1]).min(1) for v in (p, q)]
        return sum(far) > 2 * norm(q - p)

    def step(self, x, contour):
        """Crossings of a piece count with a contour now or before, if it is linked to no vertex that crossed otherwise, or if the border is
        out of reach for one of its vertices."""
        if self.before is not None:
            hit, _, sign = segment_in_triangle(self.before[:, None], x[:, None], self.faces[None])
            crossed = (hit * sign).sum(1).astype(int)
            if not (contour or self.contour_before):
                proven = (crossed != 0) & self.out_of_reach(self.before, x)
                seen = set()
                for start in np.flatnonzero(crossed):
                    piece, todo, linked = {start}, [start], False
                    while todo and start not in seen:
                        i = todo.pop()
                        for k in self.links[(self.links == i).any(1)].ravel():
                            if crossed[k] != crossed[start]:
                                linked = True
                            elif k not in piece:
                                piece.add(k)
                                todo.append(k)
                    if start not in seen:
                        seen |= piece
                        if linked and not proven[list(piece)].any():
                            self.dropped[list(piece)] = True
                crossed[self.dropped] = 0
                self.dropped[:] = False
            self.counts += crossed
        self.before, self.contour_before = x, contour

    def figures(self, run, x):
        t = x[run.triangles]
        met, lengths = pairs_of_triangles(t[:, None], np.broadcast_to(self.faces, (len(t),) + self.faces.shape))
        self.step(x, lengths.sum() > 0)
        through = self.counts != 0
        depth = point_to_triangle(x[through][:, None], self.faces[None]).min(1).max() if through.any() else 0.0
        return {"length": lengths.sum(), "pairs": met.sum(), "cut": met.any(1).mean(),
                "through": run.vertex_area[through].sum() / run.vertex_area.sum(), "through_depth": depth}


def sampled(run, k, c, frame, mesh):
    x = run.x[frame]
    if c["shape"] == "plane":
        return half_space(run, c, x)
    if c["shape"] == "sphere":
        return one_sphere(run, c, x)
    if c["shape"] == "box":
        return one_box(run, c, x)
    return all_capsules(run, c, x, frame) if c["shape"] == "capsules" else mesh[k].figures(run, x)


def contact_series(run):
    mesh = {k: Mesh(run, c) for k, c in enumerate(run.colliders) if c["shape"] == "mesh"}
    frames = [[sampled(run, k, c, f, mesh) for k, c in enumerate(run.colliders)] for f in range(len(run.time))]

    def over(key, combine):
        if not all(key in s for s in frames[0]):
            return None
        return np.array([combine([s[key] for s in at]) for at in frames], float)
    out = {"contact_length_m": over("length", sum), "contact_pairs": over("pairs", sum), "contact_cloth_fraction": over("cut", max),
           "depth_m": over("depth", max), "tunnelled_fraction": over("through", max), "tunnelled_depth_m": over("through_depth", max),
           "depth_vertex_m": over("vertex", max) if "depth_vertex_m" in run.series else None}
    if all("figures" in s for s in frames[0]):
        figures = [[s["figures"] for s in at] for at in frames]
        whole = np.array([sum(a for a, _, _ in at) for at in figures])
        moment = np.array([sum(a * m for a, m, _ in at) for at in figures])
        out |= {"penetrating_area_m2": whole, "depth_mean_m": np.divide(moment, whole, where=whole > 0, out=np.zeros_like(whole)),
                "depth_p99_m": np.array([max(p for _, _, p in at) for at in figures])}
    run.contours = np.array([[s["length"] for s in at] for at in frames])
    return {name: v for name, v in out.items() if v is not None and name in run.series}

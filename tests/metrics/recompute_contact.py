"""Contour, depth and tunnelling of stored runs, for recompute.py."""
import numpy as np

from recompute_geometry import (box_triangles, clipped, cross, depth_figures, dot, norm, pairs_of_triangles, point_to_segment, point_to_triangle,
                                segment_in_triangle)
from recompute_section import round_figures


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


def one_sphere(run, c, x):
    centre, radius = np.array(c["center_m"], float), float(c["radius_m"])
    return {"vertex": max(0.0, (radius - norm(x - centre)).max())} | round_figures(x[run.triangles], [(centre, centre, radius)])


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


def capsules_of(c, frame):
    return [(v[:3], v[3:6], v[6]) for v in c["capsules"][min(frame, len(c["capsules"]) - 1)]]


FINGERS = ((1, 4), (5, 9), (10, 14), (15, 19), (20, 24))  # first and last joints, in the order of the WebXR Hand Input module


def centre_lines(c):
    """Of each finger of a hand mesh: (joint, point at rest) along the middle of its flesh, the last one half-way on to the tip."""
    x, weight = np.array(c["position_m"], float), np.zeros((len(c["position_m"]), c["joint_matrix"].shape[1]))
    for k in range(4):
        np.add.at(weight, (np.arange(len(x)), c["joint_index"][:, k]), c["joint_weight"][:, k])
    out = []
    for first, last in FINGERS:
        line = [(j, weight[:, j] @ x / weight[:, j].sum()) for j in range(first, last + 1) if weight[:, j].sum() >= 1]
        if len(line) >= 2:
            end, middle = line[-1]
            along = (middle - line[-2][1]) / norm(middle - line[-2][1])
            ahead = max([0.0] + list((x[weight[:, end] >= 0.5] - middle) @ along))
            out.append(line + ([(end, middle + ahead / 2 * along)] if ahead > 0 else []))
    return out


def bones_of(c, frame):
    """Segments along the middle of a hand, one (a, b) each."""
    if c["shape"] == "capsules":
        return [(a, b) for a, b, _ in capsules_of(c, frame)]
    if "lines" not in c:
        c["lines"] = centre_lines(c)
    matrix = c["joint_matrix"][min(frame, len(c["joint_matrix"]) - 1)]
    posed = [[matrix[j, :, :3] @ p + matrix[j, :, 3] for j, p in line] for line in c["lines"]]
    return [pair for line in posed for pair in zip(line, line[1:])]


def vertices_of(c, frame):
    """Of a mesh: its positions, or for a skinned one the sums of what its joints do with them."""
    x = np.array(c["position_m"], float)
    if "joint_matrix" not in c:
        return x
    matrix = np.array(c["joint_matrix"][min(frame, len(c["joint_matrix"]) - 1)], float)[c["joint_index"]]
    each = np.einsum("vkij,vj->vki", matrix[..., :3], x) + matrix[..., 3]
    return np.einsum("vk,vki->vi", np.array(c["joint_weight"], float), each)


def near_pairs(t, faces, reach=0.0):
    """Pairs of triangles whose boxes are at most `reach` apart in each direction."""
    (low, high), (face_low, face_high) = ((v.min(-2) - reach / 2, v.max(-2) + reach / 2) for v in (t, faces))
    return np.nonzero(np.all((low[:, None] <= face_high[None]) & (face_low[None] <= high[:, None]), -1))


def mesh_contour(t, faces):
    a, b = near_pairs(t, faces)
    met, lengths = pairs_of_triangles(t[a], faces[b])
    return {"length": lengths.sum(), "pairs": met.sum(), "cut": len(set(a[met])) / len(t)}


def inside_mesh(p, faces):
    """Whether points are inside a closed mesh, by the sum of its solid angles (van Oosterom & Strackee 1983)."""
    r = faces[None] - p[:, None, None]
    size = norm(r)
    a, b, c = r[:, :, 0], r[:, :, 1], r[:, :, 2]
    below = size.prod(-1) + dot(a, b) * size[..., 2] + dot(b, c) * size[..., 0] + dot(c, a) * size[..., 1]
    return 2 * np.arctan2(dot(a, cross(b, c)), below).sum(1) > 2 * np.pi


def seven_points(t):
    """Corners and middles of edges in turn, and the middle."""
    return np.stack([t[:, 0], (t[:, 0] + t[:, 1]) / 2, t[:, 1], (t[:, 1] + t[:, 2]) / 2, t[:, 2], (t[:, 2] + t[:, 0]) / 2, t.mean(1)], 1)


def closed_mesh(run, c, x, frame):
    """A mesh with an inside. What is inside now has gone in: the crossings of its way add up to that."""
    faces, t = vertices_of(c, frame)[c["triangles"]], x[run.triangles]
    points = seven_points(t)
    depth = np.full(points.shape[:2], -np.inf)
    near = np.flatnonzero(np.all((points.min(1) <= faces.max((0, 1))) & (points.max(1) >= faces.min((0, 1))), -1))
    for k in near:
        distance = point_to_triangle(points[k][:, None], faces[None]).min(1)
        depth[k] = np.where(inside_mesh(points[k], faces), distance, -distance)
    pieces = [piece for k in near for i in range(6) for piece in clipped(points[k][[i, (i + 1) % 6, 6]], depth[k][[i, (i + 1) % 6, 6]])[1]]
    vertex = np.full(len(x), -np.inf)
    for i in range(3):
        np.maximum.at(vertex, run.triangles[:, i], depth[:, 2 * i])
    within = vertex > 0
    return mesh_contour(t, faces) | {
        "through": run.vertex_area[within].sum() / run.vertex_area.sum(), "through_depth": max(0.0, vertex.max()),
        "depth": max(0.0, depth.max()), "vertex": max(0.0, vertex.max()), "figures": depth_figures(pieces)}


def all_capsules(run, c, x, frame):
    shapes = capsules_of(c, frame)
    return {"vertex": max(0.0, max((r - point_to_segment(x, a, b)).max() for a, b, r in shapes))} | round_figures(x[run.triangles], shapes)


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
        contour = mesh_contour(x[run.triangles], self.faces)
        self.step(x, contour["length"] > 0)
        through = self.counts != 0
        depth = point_to_triangle(x[through][:, None], self.faces[None]).min(1).max() if through.any() else 0.0
        return contour | {"through": run.vertex_area[through].sum() / run.vertex_area.sum(), "through_depth": depth}


def sampled(run, k, c, frame, mesh):
    x = run.x[frame]
    if c["shape"] == "plane":
        return half_space(run, c, x)
    if c["shape"] == "sphere":
        return one_sphere(run, c, x)
    if c["shape"] == "box":
        return one_box(run, c, x)
    if c["shape"] == "capsules":
        return all_capsules(run, c, x, frame)
    return mesh[k].figures(run, x) if k in mesh else closed_mesh(run, c, x, frame)


def contact_series(run):
    mesh = {k: Mesh(run, c) for k, c in enumerate(run.colliders) if c["shape"] == "mesh" and not c["closed"]}
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

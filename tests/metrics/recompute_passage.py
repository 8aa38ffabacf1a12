"""Touch, slip, hooked axes and wrong side of stored runs, for recompute.py.

A bone's wake in 2D: seen along the side, the bone a-b is a segment, and a point is on the wake where it lies on that segment and beyond it
towards the side. Between frames everything moves in straight lines, so that is a quadratic in time.
"""
import numpy as np

from recompute_contact import bones_of, capsules_of, near_pairs, vertices_of
from recompute_geometry import (box_triangles, cross, dot, norm, point_to_segment, point_to_triangle, segment_in_triangle, segment_to_segment,
                                segment_to_triangle, triangle_to_triangle)


def nearest_distance(run, c, frame, x):
    """Of vertices to a collider, negative inside where the program's is; and of triangles, edges and faces included."""
    t = x[run.triangles]
    if c["shape"] == "plane":
        d = (x - np.array(c["point_m"], float)) @ np.array(c["normal"], float)
        return d, d[run.triangles].min(1)
    if c["shape"] in ("sphere", "capsules"):
        centre = np.array(c.get("center_m", (0, 0, 0)), float)
        shapes = [(centre, centre, c["radius_m"])] if c["shape"] == "sphere" else capsules_of(c, frame)
        return (np.min([point_to_segment(x, a, b) - r for a, b, r in shapes], 0),
                np.min([segment_to_triangle(np.broadcast_to(a, (len(t), 3)), np.broadcast_to(b, (len(t), 3)), t) - r for a, b, r in shapes], 0))
    if c["shape"] == "box":
        faces, distance = box_triangles(c)
        vertices = distance(x)
    else:
        # Farther than the reach it does not matter how far.
        faces = vertices_of(c, frame)[c["triangles"]]
        vertices = np.full(len(x), np.inf)
        near = np.flatnonzero(np.all((x >= faces.min((0, 1)) - c["reach_m"]) & (x <= faces.max((0, 1)) + c["reach_m"]), -1))
        for k in near:
            vertices[k] = point_to_triangle(x[k], faces).min()
    out = vertices[run.triangles].min(1)
    a, b = near_pairs(t, faces, 2 * c["reach_m"])
    np.minimum.at(out, a, triangle_to_triangle(t[a], faces[b]))
    return vertices, out


def surface_step(c, frame, p):
    """The unit normal at the nearest place of a collider with a closed form, and how far that place moved; one row a point."""
    if c["shape"] == "plane":
        return np.broadcast_to(np.array(c["normal"], float), p.shape), np.zeros_like(p)
    if c["shape"] == "sphere":
        out = p - np.array(c["center_m"], float)
        return out / norm(out)[:, None], np.zeros_like(p)
    now, was = capsules_of(c, frame), capsules_of(c, frame - 1)
    best = np.argmin([point_to_segment(p, a, b) - r for a, b, r in now], 0)
    (a, b), (a0, b0) = [[np.array([s[k] for s in of])[best] for k in (0, 1)] for of in (now, was)]
    share = np.clip(dot(p - a, b - a) / dot(b - a, b - a), 0, 1)[:, None]
    foot = a + share * (b - a)
    return (p - foot) / norm(p - foot)[:, None], foot - a0 - share * (b0 - a0)


def touch(run):
    touching, slip, before = [], [], [None] * len(run.colliders)
    for f, x in enumerate(run.x):
        any_triangle, ways = np.zeros(len(run.triangles), bool), []
        for k, c in enumerate(run.colliders):
            vertices, triangles = nearest_distance(run, c, f, x)
            any_triangle |= triangles <= c["reach_m"]
            now = vertices <= c["reach_m"]
            if before[k] is not None and c["shape"] in ("plane", "sphere", "capsules"):
                both = now & before[k]
                normal, carried = surface_step(c, f, x[both])
                way = x[both] - run.x[f - 1][both] - carried
                ways += list(norm(way - dot(way, normal)[:, None] * normal))
            before[k] = now
        touching.append(run.triangle_area[any_triangle].sum() / run.triangle_area.sum())
        slip.append(np.mean(ways) if ways else 0.0)
    return np.array(touching), np.array(slip)


def hooked(run, c):
    out = []
    for f, x in enumerate(run.x):
        t = x[run.triangles]
        out.append(sum(segment_in_triangle(np.broadcast_to(a, (len(t), 3)), np.broadcast_to(b, (len(t), 3)), t)[0].any() for a, b in bones_of(c, f)))
    return np.array(out, float)


def passes(p, q, was, now, side):
    """How often points on their ways p-q pass the wakes of bones on their ways from `was` to `now`: (point,)."""
    across = np.linalg.svd(side[None])[2][1:]  # two directions across the side
    count = np.zeros(len(p), int)
    for (a0, b0), (a1, b1) in zip(was, now):
        # x - a and b - a, seen along the side, each linear in time
        r0, r1, d0, d1 = (p - a0) @ across.T, (q - a1) @ across.T, (b0 - a0) @ across.T, (b1 - a1) @ across.T

        def flat_cross(u, v):
            return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
        zero, one, mixed = flat_cross(d0, r0), flat_cross(d1, r1), flat_cross(d0, r1) + flat_cross(d1, r0)
        square, linear = zero + one - mixed, mixed - 2 * zero
        with np.errstate(divide="ignore", invalid="ignore"):
            root = np.sqrt(linear**2 - 4 * square * zero)
            stable = -(linear + np.where(linear >= 0, root, -root)) / 2
            for t in (stable / square, zero / stable):
                ok = (t > 0) & (t < 1)
                t = np.where(ok, t, 0)[:, None]
                x, a, b = p + t * (q - p), a0 + t * (a1 - a0), b0 + t * (b1 - b0)
                flat_x, flat_b = (x - a) @ across.T, (b - a) @ across.T
                s = dot(flat_x, flat_b) / dot(flat_b, flat_b)
                above = dot(x - a - s[:, None] * (b - a), side)
                count += ok & (s > 0) & (s < 1) & (above > 0)
    return count


def rounds(p, q, was, now, side, reach):
    """Signed passages of the half-planes beyond ends: parallelograms at a tip, `across` to both sides and `out`."""
    total = np.zeros(len(p), int)
    for (tip0, out0), (tip1, out1) in zip(was, now):
        def plane(t):
            tip = tip0 + t[:, None] * (tip1 - tip0)
            ends = []
            for tip_k, out_k in ((tip0, out0), (tip1, out1)):
                across = cross(side, out_k / norm(out_k))
                ends.append((reach * across / norm(across), out_k))
            across = ends[0][0] + t[:, None] * (ends[1][0] - ends[0][0])
            out = ends[0][1] + t[:, None] * (ends[1][1] - ends[0][1])
            return p + t[:, None] * (q - p) - tip, across, out

        def height(t):
            r, across, out = plane(t)
            return dot(r, cross(across, out))
        grid = np.linspace(0, 1, 33)
        for low, high in zip(grid, grid[1:]):
            a, b = np.full(len(p), low), np.full(len(p), high)
            fa, fb = height(a), height(b)
            change = fa * fb < 0
            if not change.any():
                continue
            for _ in range(60):
                m = (a + b) / 2
                same = height(m) * fa > 0
                a, b = np.where(same, m, a), np.where(same, b, m)
            r, across, out = plane((a + b) / 2)
            u, v = dot(r, across) / dot(across, across), dot(r, out) / dot(out, out)
            total += np.where(change & (np.abs(u) < 1) & (v > 0) & (v < 1), np.sign(fb), 0).astype(int)
    return total


class Surface:
    """A wake and the samples that have passed it an odd number of times."""

    def __init__(self, bones_at, samples):
        self.bones_at, self.odd = bones_at, np.zeros(samples, bool)

    def step(self, side, f, p, q, links):
        was, now = self.bones_at(f - 1), self.bones_at(f)
        evenly = passes(p, q, was, now, side) % 2
        at_once = (passes(p, q, was, was, side) + passes(q, q, was, now, side)) % 2
        late = (passes(p, p, was, now, side) + passes(p, q, now, now, side)) % 2
        sure = (evenly == at_once) & (evenly == late)
        self.odd ^= sure & (evenly == 1)
        self.between = passes(q[links[:, 0]], q[links[:, 1]], now, now, side) % 2 == 1
        for i in np.flatnonzero(~sure):
            mine = np.flatnonzero((links == i).any(1))
            torn = self.between[mine] != (self.odd[links[mine, 0]] != self.odd[links[mine, 1]])
            if 2 * torn.sum() > len(mine):
                self.odd[i] = not self.odd[i]

    def torn(self, links):
        return self.between != (self.odd[links[:, 0]] != self.odd[links[:, 1]])


def chains_of(bones):
    """Bones that are joined end to end, and the free ends of each chain."""
    places = [[tuple(a), tuple(b)] for a, b in bones]
    used = [k for k, (a, b) in enumerate(places) if a != b]
    groups = []
    for k in used:
        touching = [g for g in groups if any(set(places[k]) & set(places[m]) for m in g)]
        groups = [g for g in groups if g not in touching] + [sorted(sum(touching, []) + [k])]
    ends = [p for k in used for p in places[k]]
    return [(g, [(k, e) for k in g for e in (0, 1) if ends.count(places[k][e]) == 1]) for g in groups]


def samples_and_links(run):
    """Vertices and cell centres, and what they are linked to."""
    rows, columns = run.rows, run.columns
    v = np.arange(rows * columns).reshape(rows, columns)
    cells = np.stack([v[:-1, :-1], v[:-1, 1:], v[1:, :-1], v[1:, 1:]], -1).reshape(-1, 4)
    sides = np.concatenate([np.stack([v[:, :-1], v[:, 1:]], -1).reshape(-1, 2), np.stack([v[:-1], v[1:]], -1).reshape(-1, 2)])
    sides = sides[np.lexsort(sides.T[::-1])]
    middles = np.stack([cells.ravel(), rows * columns + np.repeat(np.arange(len(cells)), 4)], -1)
    cell = run.width / (columns - 1) * run.height / (rows - 1)
    return cells, np.concatenate([sides, middles]), np.concatenate([run.vertex_area, np.full(len(cells), cell)])


def crosses(c, f, a, b):
    """Whether segments cross a hand."""
    if c["shape"] == "capsules":
        return np.any([segment_to_segment(a, b, np.broadcast_to(s, a.shape), np.broadcast_to(e, a.shape)) < r for s, e, r in capsules_of(c, f)], 0)
    faces = vertices_of(c, f)[c["triangles"]]
    return np.array([segment_in_triangle(p, q, faces)[0].any() for p, q in zip(a, b)])


def wrong_side(run, c, contours):
    cells, links, weights = samples_and_links(run)
    samples = np.concatenate([run.x, run.x[:, cells].mean(2)], 1)
    first = bones_of(c, 0)
    sheet = cross(run.u, run.v)
    middle = np.mean([(a + b) / 2 for a, b in first], 0)
    centre = run.start.mean(0)
    side = sheet / norm(sheet) * (-1 if dot(sheet, middle - centre) < 0 else 1)
    reach = 4 * (run.width + run.height + norm(middle - centre))

    def out(f, k, e):
        a, b = bones_of(c, f)[k]
        tip, other = (a, b) if e == 0 else (b, a)
        return tip, reach * (tip - other) / norm(tip - other)
    n = samples.shape[1]
    wrong, laid = np.zeros((len(run.x), n), bool), np.zeros((len(run.x), n), bool)
    for group, free in chains_of(first):
        wake = Surface(lambda f, g=group: [bones_of(c, f)[k] for k in g], n)
        endless = Surface(lambda f, g=group, e=free: [bones_of(c, f)[k] for k in g] + [(t, t + o) for t, o in (out(f, *at) for at in e)], n)
        rounded, shown = np.zeros(n, int), np.zeros(len(links), bool)
        for f in range(1, len(run.x)):
            p, q = samples[f - 1], samples[f]
            wake.step(side, f, p, q, links)
            endless.step(side, f, p, q, links)
            rounded += rounds(p, q, [out(f - 1, *at) for at in free], [out(f, *at) for at in free], side, reach)
            torn = wake.torn(links) & endless.torn(links)
            evidence = contours[f] > 0 or contours[f - 1] > 0
            now = np.full(len(links), evidence)
            odd_end = wake.odd[links].any(1)
            if not evidence and (torn & odd_end).any():
                a, b = q[links[:, 0]], q[links[:, 1]]
                now = odd_end & crosses(c, f, a, b)
            shown = torn & (shown | now)
            through = np.zeros(n, bool)
            np.logical_or.at(through, links[shown].ravel(), True)
            through &= wake.odd
            inner = links[wake.odd[links].all(1)]
            while len(inner) and (through[inner[:, 0]] != through[inner[:, 1]]).any():
                np.logical_or.at(through, inner[:, 0], through[inner[:, 1]])
                np.logical_or.at(through, inner[:, 1], through[inner[:, 0]])
            counted = wake.odd & through & (rounded == 0)
            wrong[f] |= counted
            laid[f] |= wake.odd
    return wrong, laid & ~wrong, weights


def passage_series(run, computed):
    out = dict(zip(("touching_fraction", "slip_m"), touch(run)))
    if any(c["shape"] not in ("plane", "sphere", "capsules") for c in run.colliders):
        del out["slip_m"]
    moving = [(k, c) for k, c in enumerate(run.colliders) if c["shape"] == "capsules" or "joint_matrix" in c]
    if moving:
        out["hooked_axes"] = sum(hooked(run, c) for _, c in moving)
        of = [wrong_side(run, c, run.contours[:, k]) for k, c in moving]
        wrong = np.any([w for w, _, _ in of], 0)
        laid = np.any([l for _, l, _ in of], 0) & ~wrong
        weights = of[0][2]
        out |= {"wrong_side_samples": wrong.sum(1).astype(float), "laid_over_samples": laid.sum(1).astype(float),
                "wrong_side_fraction": wrong @ weights / weights.sum()}
    return {n: v for n, v in out.items() if n in run.series}

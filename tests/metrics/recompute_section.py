"""What a triangle has of a union of capsules: border, area, depth. Curves are halved until their ends are known; lengths and areas are
integrated by Gauss's rule, where the program has closed forms."""
import numpy as np

from recompute_geometry import cross, dot, norm, point_to_segment, segment_to_triangle

FINE = 1e-8  # m: where a curve enters or leaves
NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)
DEPTH_NODES, DEPTH_WEIGHTS = np.polynomial.legendre.leggauss(8)


class Section:
    def __init__(self, t, capsules, depth):
        """`depth`: of the triangle in each capsule."""
        self.t, self.n = t, cross(t[1] - t[0], t[2] - t[0])
        self.n = self.n / norm(self.n)
        self.depth = depth.max()
        self.inward = [cross(self.n, t[(i + 1) % 3] - t[i]) for i in range(3)]
        self.inward = [w / norm(w) for w in self.inward]
        self.parts = []  # (kind, a, b, radius, capsule, greatest depth)
        for k, ((a, b, r), d) in enumerate(zip(capsules, depth)):
            if d > 0:
                for kind, p, q in [("ball", a, a)] + ([("ball", b, b), ("side", a, b)] if (a != b).any() else []):
                    same = [i for i, o in enumerate(self.parts) if o[0] == kind and (o[1] == p).all() and (o[2] == q).all() and o[3] == r]
                    if same:
                        old = self.parts[same[0]]
                        self.parts[same[0]] = old[:5] + (max(old[5], d),)
                    else:
                        self.parts.append((kind, p, q, r, k, d))

    def curves(self, part):
        """Of a part's surface in the plane: (point, derivative, from, to) each, anticlockwise."""
        kind, a, b, r = part[:4]
        n, height = self.n, dot(a - self.t[0], self.n)
        e = self.t[1] - self.t[0]
        e = e / norm(e)
        f = cross(n, e)

        def ellipse(c, u, v):
            def point(t):
                return c + np.cos(t)[:, None] * u + np.sin(t)[:, None] * v

            def slope(t):
                return -np.sin(t)[:, None] * u + np.cos(t)[:, None] * v
            return point, slope
        if kind == "ball":
            if abs(height) >= r:
                return []
            size = np.sqrt(r**2 - height**2)
            return [ellipse(a - height * n, size * e, size * f) + (0.0, 2 * np.pi)]
        long = norm(b - a)
        d = (b - a) / long
        rise = dot(d, n)
        w = d - rise * n
        level = norm(w)
        w = w / level if level > 1e-12 else e
        m = cross(n, w)
        if abs(rise) < 1e-8:
            above = height + rise * long / 2
            if abs(above) >= r:
                return []
            wide, middle = np.sqrt(r**2 - above**2) * m, (a + b) / 2 - above * n
            return [((lambda t, s=s: middle + s * (t[:, None] * w - wide)), (lambda t, s=s: s * np.broadcast_to(w, (len(t), 3))), -long / 2, long / 2)
                    for s in (1, -1)]
        met, far = -height / rise, r / abs(rise) * level
        curve = ellipse(a + met * d, -r * m, r / abs(rise) * w)
        if far <= 1e-12 * long:
            return [curve + (0.0, 2 * np.pi)] if 0 <= met <= long else []
        low, high = -met / far, (long - met) / far
        if low >= 1 or high <= -1:
            return []
        low, high = np.arcsin(max(low, -1.0)), np.arcsin(min(high, 1.0))
        return [curve + (low, high), curve + (np.pi - high, np.pi - low)]

    def clear(self, p, parts, own):
        out = np.min([dot(p - self.t[i], self.inward[i]) for i in range(3)], 0)
        mine = parts[own]
        for k, (kind, a, b, r, _, _) in enumerate(parts):
            joined = k != own and r == mine[3] and kind != mine[0]
            if k == own or (joined and kind == "ball" and ((a == mine[1]).all() or (a == mine[2]).all())):
                continue  # a side touches its own balls
            if kind == "ball":
                out = np.minimum(out, norm(p - a) - r)
                continue
            d = (b - a) / norm(b - a)
            s = dot(p - a, d)
            ends = [-s] if joined and (a == mine[1]).all() else [s - norm(b - a)] if joined and (b == mine[1]).all() else [
                norm(p - a - s[:, None] * d) - r, -s, s - norm(b - a)]
            out = np.minimum(out, np.max(ends, 0))
        return out

    def kept(self, curve, parts, own):
        """Intervals of a curve that bound what is inside the triangle and outside of the other parts."""
        point, slope, low, high = curve
        edges = np.linspace(low, high, 33)
        a, b = edges[:-1], edges[1:]
        whole, cut = [], []
        while len(a):
            m = (a + b) / 2
            speed = np.max([norm(slope(x)) for x in np.linspace(a, b, 5)], 0) * 1.2
            half, at = speed * (b - a) / 2, self.clear(point(m), parts, own)
            whole.append(np.stack([a, b], 1)[at > half])
            open_ = np.abs(at) <= half
            last = open_ & (half < FINE / 2)
            if last.any():
                first, end = (self.clear(point(x[last]), parts, own) for x in (a, b))
                for x, y, p, q, mid in zip(a[last], b[last], first, end, at[last]):
                    if (p > 0) == (q > 0):
                        cut += [(x, y)] if mid > 0 else []
                    else:
                        zero = x + (y - x) * p / (p - q)
                        cut.append((x, zero) if p > 0 else (zero, y))
            more = open_ & ~last
            a, b = np.concatenate([a[more], m[more]]), np.concatenate([m[more], b[more]])
        return np.concatenate(whole + [np.array(cut).reshape(-1, 2)])

    def integrals(self, less=0.0):
        """Border and area of what is deeper than `less`, and the capsules that have part of the border."""
        parts = [p[:3] + (p[3] - less,) + p[4:] for p in self.parts if p[5] > less]
        border = twice = 0.0
        on = set()
        for k, part in enumerate(parts):
            for curve in self.curves(part):
                ranges = self.kept(curve, parts, k)
                if not len(ranges):
                    continue
                on.add(part[4])
                point, slope = curve[:2]
                half = (ranges[:, 1] - ranges[:, 0]) / 2
                t = (ranges.mean(1)[:, None] + half[:, None] * NODES).ravel()
                weight = (half[:, None] * WEIGHTS).ravel()
                way = slope(t)
                border += (weight * norm(way)).sum()
                twice += (weight * dot(cross(point(t) - self.t[0], way), self.n)).sum()
        twice += self.edges(parts)
        return border, max(0.0, twice / 2), len(on)

    def edges(self, parts):
        """Twice the area between the first corner and what is inside of the edges: where |p + s q| < r, and between a side's ends."""
        a, b, r = (np.array([part[i] for part in parts])[None] for i in (1, 2, 3))
        p = self.t[:, None] - a
        q = np.broadcast_to((np.roll(self.t, -1, 0) - self.t)[:, None], p.shape)
        long = norm(b - a)
        d = (b - a) / np.where(long > 0, long, 1)[..., None]
        along, rate = dot(p, d), dot(q, d)
        p, q = p - along[..., None] * d, q - rate[..., None] * d
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = np.sort(np.stack([-along / rate, (long - along) / rate]), 0)
            ends = np.where(rate != 0, ends, np.where((along >= 0) & (along <= long), np.array([0.0, 1.0])[:, None, None], np.nan))
            ends = np.where(long > 0, ends, np.array([0.0, 1.0])[:, None, None])
            qq, pq, pp = dot(q, q), dot(p, q), dot(p, p) - r**2
            root = np.sqrt(pq**2 - qq * pp)
            low, high = np.maximum(ends[0], (-pq - root) / qq), np.minimum(ends[1], (-pq + root) / qq)
        low, high = np.maximum(low, 0), np.minimum(high, 1)
        total = 0.0
        for i in range(3):
            done, from_, way = 0.0, self.t[i] - self.t[0], self.t[(i + 1) % 3] - self.t[i]
            for first, last in sorted((x, y) for x, y in zip(low[i], high[i]) if x < y):
                first = max(first, done)
                if last > first:
                    total += dot(cross(from_ + first * way, from_ + last * way), self.n)
                    done = last
        return total


def round_figures(t, shapes):
    """Contour and depth of triangles in a union of capsules."""
    depth = np.array([r - segment_to_triangle(np.broadcast_to(a, (len(t), 3)), np.broadcast_to(b, (len(t), 3)), t) for a, b, r in shapes])
    sections = [Section(t[k], shapes, depth[:, k]) for k in np.flatnonzero(depth.max(0) > 0)]
    whole = [s.integrals() for s in sections]
    area = sum(a for _, a, _ in whole)
    out = {"length": sum(l for l, _, _ in whole), "pairs": sum(c for _, _, c in whole), "cut": sum(c > 0 for _, _, c in whole) / len(t),
           "depth": max([0.0] + [s.depth for s in sections]), "figures": (0.0, 0.0, 0.0)}
    if not area > 0:
        return out
    moment = sum(s.depth / 2 * sum(w * s.integrals(s.depth * (x + 1) / 2)[1] for x, w in zip(DEPTH_NODES, DEPTH_WEIGHTS))
                 for s, (_, a, _) in zip(sections, whole) if a > 0)
    low, high = 0.0, out["depth"]
    while high - low > 1e-10:
        middle = (low + high) / 2
        below = 0.0
        for s in sections:
            if s.depth > middle and below <= 0.01 * area:
                below += s.integrals(middle)[1]
        low, high = (middle, high) if below > 0.01 * area else (low, middle)
    return out | {"figures": (area, moment / area, (low + high) / 2)}

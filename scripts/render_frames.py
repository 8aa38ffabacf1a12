#!/usr/bin/env python3
"""Pictures of cloth and colliders at chosen times, one row a result file, all from the same camera.

usage: render_frames.py FILE.h5 … -o OUT.png [--times 0.25,0.5,1,3] [--labels A,B] [--view AZIMUTH,ELEVATION]
Reads /trajectory, /triangles and /colliders and nothing else. Parallel projection, so lengths compare everywhere; the two
faces of the cloth have two colours, and lines follow every fourth row and column of its grid.
"""
import argparse
import pathlib
import sys

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

FRONT, BACK = np.array([0.83, 0.48, 0.20]), np.array([0.25, 0.50, 0.76])
COLLIDER, BACKGROUND = np.array([0.74, 0.72, 0.68]), np.array([1.0, 1.0, 1.0])
LIGHT = np.array([-0.35, 0.75, 0.55])  # in the camera's frame: from the upper left, behind the viewer
WIDTH, HEIGHT, SAMPLES = 420, 360, 2   # of a picture; samples a pixel and axis
NEAR_M = 0.25  # colliders further from the cloth's place than this are left out: a room has more walls than its desk


class Mesh:
    """Triangles to draw. `grid`: columns and rows of a cloth; None for a collider."""

    def __init__(self, points, triangles, grid=None):
        self.points, self.triangles, self.grid = np.asarray(points, float), np.asarray(triangles, int), grid


def tube(a, b, radius, sides=20, rings=6):
    """A capsule as a mesh."""
    axis = b - a
    length = np.linalg.norm(axis)
    axis = axis / length if length > 0 else np.array([0.0, 1.0, 0.0])
    across = np.cross(axis, [1.0, 0, 0] if abs(axis[0]) < 0.9 else [0, 1.0, 0])
    across /= np.linalg.norm(across)
    other = np.cross(axis, across)
    angles = np.concatenate([np.linspace(-np.pi / 2, 0, rings), np.linspace(0, np.pi / 2, rings)])
    ends = np.array([a] * rings + [b] * rings)
    turn = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    circle = np.cos(turn)[:, None] * across + np.sin(turn)[:, None] * other
    points = ends[:, None] + radius * (np.cos(angles)[:, None, None] * circle + np.sin(angles)[:, None, None] * axis)
    return Mesh(points.reshape(-1, 3), lattice(len(angles), sides, closed=True))


def lattice(rows, columns, closed=False):
    """Triangles of a grid of points; `closed`: the last column meets the first."""
    r, c = np.meshgrid(np.arange(rows - 1), np.arange(columns if closed else columns - 1), indexing="ij")
    a, b = r * columns + c, r * columns + (c + 1) % columns
    return np.concatenate([np.stack([a, b, a + columns], -1).reshape(-1, 3), np.stack([b, b + columns, a + columns], -1).reshape(-1, 3)])


def box(center, half, axes):
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return Mesh(center + (signs * half) @ axes, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def plane(point, normal, reach):
    across = np.cross(normal, [1.0, 0, 0] if abs(normal[0]) < 0.9 else [0, 1.0, 0])
    across /= np.linalg.norm(across)
    other = np.cross(normal, across)
    steps = np.linspace(-reach, reach, 9)
    return Mesh([point + x * across + y * other for x in steps for y in steps], lattice(9, 9))


def skinned(group, frame):
    rest, joints, weights = group["position_m"][:], group["joint_index"][:], group["joint_weight"][:]
    matrices = group["joint_matrix"][frame]
    blended = np.einsum("vk,vkij->vij", weights, matrices[joints])
    return np.einsum("vij,vj->vi", blended[:, :, :3], rest) + blended[:, :, 3]


def colliders(file, frame, reach):
    """Meshes of everything the cloth may touch, as it is at a frame."""
    out = []
    for name in sorted(file.get("colliders", {})):
        group = file["colliders"][name]
        if "shape" not in group.attrs:
            continue
        shape, a = group.attrs["shape"], group.attrs
        shape = shape.decode() if isinstance(shape, bytes) else shape
        if shape == "capsules":
            now = group["capsules"][min(frame, group["capsules"].shape[0] - 1)]
            out += [tube(c[:3], c[3:6], c[6]) for c in now]
        elif shape == "mesh":
            moving = "joint_matrix" in group
            points = skinned(group, min(frame, group["joint_matrix"].shape[0] - 1)) if moving else group["position_m"][:]
            out.append(Mesh(points, group["triangles"][:]))
        elif shape == "sphere":
            out.append(tube(np.array(a["center_m"]), np.array(a["center_m"]), float(a["radius_m"]), 40, 12))
        elif shape == "box":
            out.append(box(np.array(a["center_m"]), np.array(a["half_extent_m"]), np.array([a[f"axis_{k}"] for k in "uvw"])))
        elif shape == "plane":
            out.append(plane(np.array(a["point_m"]), np.array(a["normal"]), reach))
    return out


class Run:
    """One result file."""

    def __init__(self, path):
        try:
            self.file = h5py.File(path, "r")
            self.time_s = self.file["trajectory/time_s"][:]
            self.positions, self.triangles = self.file["trajectory/position"], self.file["triangles"][:]
        except (OSError, KeyError) as e:
            sys.exit(f"{path}: not a result file with a trajectory: {e}")
        if len(self.time_s) == 0:
            sys.exit(f"{path}: its trajectory is empty")
        self.label = str(self.file.attrs["solver"]) + ("" if self.file.attrs["setting"] == "default" else f" {self.file.attrs['setting']}")
        # Columns of the grid, from its first run's triangles: the row below vertex 0 begins at `columns`.
        ids = np.unique(self.triangles[:2])
        columns = int(ids[2]) if len(ids) == 4 else 0
        self.grid = (columns, self.positions.shape[1] // columns) if columns > 1 and self.positions.shape[1] % columns == 0 else None
        start = self.positions[0]
        self.low, self.high = start.min(0), start.max(0)
        self.reach = 0.7 * float(np.max(self.high - self.low))

    def frame(self, time_s):
        return int(np.argmin(np.abs(self.time_s - time_s)))

    def meshes(self, frame):
        """The cloth at a frame, and what of the colliders is near the cloth's place."""
        out = [Mesh(self.positions[frame], self.triangles, self.grid)]
        for m in colliders(self.file, frame, self.reach):
            corners = m.points[m.triangles]
            lowest = self.low - [NEAR_M, 1.2 * self.reach + NEAR_M, NEAR_M]
            near = np.all((corners.max(1) >= lowest) & (corners.min(1) <= self.high + NEAR_M), axis=1)
            out.append(Mesh(m.points, m.triangles[near]))
        return out


def camera(azimuth_deg, elevation_deg):
    """Rows: right, up, towards the viewer."""
    az, el = np.radians([azimuth_deg, elevation_deg])
    towards = np.array([np.sin(az) * np.cos(el), np.sin(el), np.cos(az) * np.cos(el)])
    right = np.cross([0, 1.0, 0], towards)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(towards, right), towards])


def vertex_normals(points, triangles):
    corners = points[triangles]
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    out = np.zeros_like(points)
    for k in range(3):
        np.add.at(out, triangles[:, k], face)
    return out, face


def unit(v):
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-30)


def draw(image, depth, mesh, view, middle, scale):
    """Adds a mesh to image and depth buffer."""
    if len(mesh.triangles) == 0:
        return
    height, width = depth.shape
    seen = mesh.points @ view.T
    x = width / 2 + (seen[:, 0] - middle[0]) * scale
    y = height / 2 - (seen[:, 1] - middle[1]) * scale
    smooth, face = vertex_normals(seen, mesh.triangles)
    light = unit(LIGHT)
    for t, normal in zip(mesh.triangles, face):
        tx, ty, tz = x[t], y[t], seen[t, 2]
        if not np.isfinite([tx, ty, tz]).all():
            continue
        x0, x1 = max(int(np.ceil(tx.min())), 0), min(int(np.floor(tx.max())), width - 1)
        y0, y1 = max(int(np.ceil(ty.min())), 0), min(int(np.floor(ty.max())), height - 1)
        area = (tx[1] - tx[0]) * (ty[2] - ty[0]) - (tx[2] - tx[0]) * (ty[1] - ty[0])
        if x0 > x1 or y0 > y1 or area == 0:
            continue
        gx, gy = np.meshgrid(np.arange(x0, x1 + 1), np.arange(y0, y1 + 1))
        w0 = ((tx[1] - gx) * (ty[2] - gy) - (tx[2] - gx) * (ty[1] - gy)) / area
        w1 = ((tx[2] - gx) * (ty[0] - gy) - (tx[0] - gx) * (ty[2] - gy)) / area
        w = np.stack([w0, w1, 1 - w0 - w1], -1)
        z = w @ tz
        target = depth[y0:y1 + 1, x0:x1 + 1]
        hit = (w >= -1e-9).all(-1) & (z > target)
        if not hit.any():
            continue
        target[hit] = z[hit]
        n = unit(w[hit] @ smooth[t]) if mesh.grid else unit(normal)[None]
        facing = 1.0 if normal[2] > 0 else -1.0
        bright = 0.58 + 0.42 * np.clip(facing * (n @ light), 0, 1)
        colour = COLLIDER if mesh.grid is None else FRONT if facing > 0 else BACK
        rgb = colour * bright[:, None] * np.ones((len(z[hit]), 1))
        if mesh.grid:
            rgb *= np.where(on_line(w[hit], t, mesh.grid), 0.72, 1.0)[:, None]
        image[y0:y1 + 1, x0:x1 + 1][hit] = np.clip(rgb, 0, 1)


def on_line(weights, triangle, grid, every=4, half_width=0.12):
    """Which points lie on every fourth row or column."""
    columns, rows = grid
    u, v = weights @ (triangle % columns), weights @ (triangle // columns)

    def near(s, last):
        return (np.abs(s / every - np.round(s / every)) * every < half_width) | (last - s < half_width)

    return near(u, columns - 1) | near(v, rows - 1)


def fit(all_meshes, view, run):
    """Middle and pixels a metre that show the colliders, where the cloth began, and where it is if not far from both."""
    solid = [m.points[np.unique(m.triangles)] for meshes in all_meshes for m in meshes if m.grid is None]
    place = np.concatenate([[run.low, run.high], *solid])
    margin = 0.3 * run.reach
    cloth = np.concatenate([m.points for meshes in all_meshes for m in meshes if m.grid is not None] + [place])
    points = np.clip(cloth[np.isfinite(cloth).all(1)], place.min(0) - margin, place.max(0) + margin)
    seen = np.concatenate([points, place]) @ view.T
    least, most = seen.min(0)[:2], seen.max(0)[:2]
    return (least + most) / 2, 0.94 * SAMPLES * min(WIDTH / (most[0] - least[0]), HEIGHT / (most[1] - least[1]))


def in_picture(mesh, view, middle, scale):
    away = np.abs((mesh.points @ view.T)[:, :2] - middle) * scale
    return bool(((away[:, 0] < WIDTH * SAMPLES / 2) & (away[:, 1] < HEIGHT * SAMPLES / 2)).any())


def picture(meshes, view, middle, scale):
    image = np.tile(BACKGROUND, (HEIGHT * SAMPLES, WIDTH * SAMPLES, 1))
    depth = np.full(image.shape[:2], -np.inf)
    for m in meshes:
        draw(image, depth, m, view, middle, scale)
    return image.reshape(HEIGHT, SAMPLES, WIDTH, SAMPLES, 3).mean((1, 3))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", metavar="FILE.h5")
    parser.add_argument("-o", "--out", required=True)
    parser.add_argument("--times", default="0.25,0.5,1,3", help="seconds; the nearest frame is shown")
    parser.add_argument("--labels", help="names of the rows, instead of the solvers'")
    parser.add_argument("--view", default="30,24", help="degrees: azimuth (0 = from +z, 90 = from +x), elevation")
    a = parser.parse_args()
    times = [float(t) for t in a.times.split(",")]
    runs = [Run(f) for f in a.files]
    labels = a.labels.split(",") if a.labels else [r.label for r in runs]
    if len(labels) != len(runs):
        parser.error(f"--labels: expected {len(runs)} names, one for each file")
    view = camera(*(float(v) for v in a.view.split(",")))
    meshes = [[r.meshes(r.frame(t)) for t in times] for r in runs]
    middle, scale = fit([m for row in meshes for m in row], view, runs[0])
    fig, panels = plt.subplots(len(runs), len(times), squeeze=False, layout="constrained",
                               figsize=(2.1 * len(times) + 0.25, 2.1 * HEIGHT / WIDTH * len(runs) + 0.25))
    fig.set_constrained_layout_pads(w_pad=0.01, h_pad=0.03, wspace=0.01, hspace=0.01)
    for row, run in enumerate(runs):
        for column, t in enumerate(times):
            ax = panels[row][column]
            ax.imshow(picture(meshes[row][column], view, middle, scale))
            ax.set_xticks([])
            ax.set_yticks([])
            for side in ax.spines.values():
                side.set_visible(False)
            if row == 0:
                ax.set_title(f"{t:g} s", fontsize=8)
            notes = [f"ended at {run.time_s[-1]:.3g} s"] if t > run.time_s[-1] + 1e-9 else []
            if not in_picture(meshes[row][column][0], view, middle, scale):
                notes.append("cloth out of the picture")
            ax.text(0.5, 0.02, ", ".join(notes), transform=ax.transAxes, ha="center", fontsize=7, color="0.3")
        panels[row][0].set_ylabel(labels[row], fontsize=9)
    fig.savefig(pathlib.Path(a.out), dpi=200, metadata={"Software": None} if a.out.endswith(".png") else None)


if __name__ == "__main__":
    main()

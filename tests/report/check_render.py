"""Renders made-up result files and looks at the pixels.

usage: check_render.py RENDER_FRAMES.py
"""
import pathlib
import subprocess
import sys
import tempfile

import h5py
import matplotlib.image
import numpy as np


def lattice(n):
    r, c = np.meshgrid(np.arange(n - 1), np.arange(n - 1), indexing="ij")
    a = (r * n + c).ravel()
    return np.concatenate([np.stack([a, a + 1, a + n], -1), np.stack([a + 1, a + n + 1, a + n], -1)])


def result(path, height, collider, n=9):
    """A level sheet that sinks to `height` in two frames, u along x and v along z: its front looks down."""
    s = np.linspace(-0.25, 0.25, n)
    z, x = np.meshgrid(s, s, indexing="ij")
    sheet = np.stack([x.ravel(), np.zeros(n * n), z.ravel()], -1)
    with h5py.File(path, "w") as f:
        f.attrs["solver"], f.attrs["setting"] = "made-up", "default"
        f["trajectory/time_s"] = [0.0, 0.5]
        f["trajectory/position"] = np.array([sheet + [0, 0.3, 0], sheet + [0, height, 0]], dtype="f4")
        t = lattice(n).reshape(2, -1, 3).transpose(1, 0, 2).reshape(-1, 3)
        f["triangles"] = t
        group = f.create_group("colliders/0")
        for key, value in collider.get("attrs", {}).items():
            group.attrs[key] = value
        for key, value in collider.get("data", {}).items():
            group[key] = value


def count(image, colour):
    """Pixels of a hue, shaded or not."""
    rgb = image[..., :3] / np.maximum(image[..., :3].max(-1, keepdims=True), 1e-6)
    return int((np.abs(rgb - np.array(colour) / max(colour)).max(-1) < 0.06).sum())


def main():
    front, back, grey = (0.83, 0.48, 0.20), (0.25, 0.50, 0.76), (0.74, 0.72, 0.68)
    quad = np.array([[-0.3, 0, -0.3], [0.3, 0, -0.3], [0.3, 0, 0.3], [-0.3, 0, 0.3]])
    mesh = {"attrs": {"shape": "mesh"}, "data": {"position_m": quad, "triangles": [[0, 3, 2], [0, 2, 1]]}}
    hand = {"attrs": {"shape": "mesh"}, "data": mesh["data"] | {
        "joint_index": np.zeros((4, 4), int), "joint_weight": np.tile([1.0, 0, 0, 0], (4, 1)),
        "joint_matrix": np.tile(np.concatenate([np.eye(3), [[0], [0.1], [0]]], 1), (2, 1, 1, 1))}}
    capsule = {"attrs": {"shape": "capsules"}, "data": {"capsules": [[[-0.2, 0, 0, 0.2, 0, 0, 0.05]]]}}
    ball = {"attrs": {"shape": "sphere", "center_m": [0, 0, 0], "radius_m": 0.15}}
    cube = {"attrs": {"shape": "box", "center_m": [0, 0, 0], "half_extent_m": [0.1] * 3, "axis_u": [1, 0, 0], "axis_v": [0, 1, 0],
                      "axis_w": [0, 0, 1]}}
    floor = {"attrs": {"shape": "plane", "point_m": [0, 0, 0], "normal": [0, 1, 0]}}
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)

        def render(names, *more):
            out = folder / "out.png"
            subprocess.run([sys.executable, sys.argv[1], *[str(folder / f"{n}.h5") for n in names], "-o", str(out), *more], check=True)
            return matplotlib.image.imread(out)

        for name, height, collider in [("above", 0.01, mesh), ("below", -0.01, mesh), ("hand", 0.05, hand), ("capsule", -0.2, capsule),
                                       ("ball", -0.4, ball), ("cube", -0.4, cube), ("floor", 0.2, floor)]:
            result(folder / f"{name}.h5", height, collider)
        top = ("--view", "0,89", "--times", "0.5")
        above, below = render(["above"], *top), render(["below"], *top)
        assert count(above, back) > 10000 and count(above, front) == 0, "from above: the back face"
        assert count(below, back) == 0 and count(below, grey) > 10000, "what lies under the table is hidden by it"
        under = render(["below"], "--view", "0,-60", "--times", "0.5")
        assert count(under, front) > 10000 and count(under, back) == 0, "from below: the front face"
        assert count(render(["hand"], *top), back) == 0, "the skinned mesh has risen above the sheet"
        for name in ("capsule", "ball", "cube", "floor"):
            assert count(render([name], *top), grey) > 3000, name
        two = render(["above", "below"], "--times", "0,0.5,9", "--labels", "one,two")
        assert two.shape[1] > 1.4 * above.shape[1] and count(two, back) > 10000
        for bad in ("nothing", "empty"):
            (folder / "empty.h5").write_text("no HDF5")
            done = subprocess.run([sys.executable, sys.argv[1], str(folder / f"{bad}.h5"), "-o", "x.png"], capture_output=True, text=True)
            assert done.returncode != 0 and f"{bad}.h5" in done.stderr and "Traceback" not in done.stderr, done.stderr


if __name__ == "__main__":
    main()

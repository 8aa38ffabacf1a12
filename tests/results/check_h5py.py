"""h5py and xarray can read the contents that results/README.md describes. usage: check_h5py.py FOLDER"""
import json
import pathlib
import sys

import h5py
import numpy as np
import xarray as xr

path = next(pathlib.Path(sys.argv[1]).glob("*.h5"))
with h5py.File(path) as f:
    assert f.attrs["format"] == "clothbench-run" and f.attrs["format_version"] == 2
    header = json.loads(f["header_json"][0])
    assert f.attrs["scene"] == header["scene"] == "sample" and header["environment"]["driver"] == "µ"
    assert f["outcome"].attrs["status"] == "diverged" and f["outcome"].attrs["failed_frame"] == 3
    assert f["summary"].attrs["fps_median"] == 123.4567890123 and np.isnan(f["summary"].attrs["read_B_per_frame"])
    points = f["trajectory/position"][:]
    assert points.shape == (5, 6, 3) and points.dtype == np.float32
    assert f["frames/000003"].is_virtual and np.array_equal(f["frames/000003"][:], points[3]), "a frame is a view of the points"
    assert f["triangles"].shape == (4, 3)
    assert f["outcome"].attrs["expect"] == "fail: stretch_max 2 > 1"
    assert f["colliders"].attrs["count"] == 2 and f["colliders/0"].attrs["shape"] == "capsules"
    assert f["colliders/0"].attrs["normal"].tolist() == [0, 1, 0.1]
    capsules = f["colliders/0/capsules"]
    assert capsules.shape == (2, 3, 7) and capsules.dtype == np.float64 and capsules[1, 2, 6] == 0.1 * 41
    assert f["colliders/0/triangles"][:].tolist() == [[0, 1, 2], [0, 2, 3]] and f["colliders/0/triangles"].dtype == np.int64
    def labelled(name, item):
        if isinstance(item, h5py.Dataset):
            assert item.attrs["units"] and item.attrs["long_name"], name
    f.visititems(labelled)

shapes = {"timing": {"trial": 3, "frame": 4, "stage": 2}, "bandwidth": {"trial": 3, "frame": 4, "stage": 2}, "metrics": {"frame": 5},
          "trajectory": {"time_s": 5, "vertex": 6, "xyz": 3},
          "colliders/0": {"frame": 2, "capsule": 3, "value": 7, "triangle": 2, "corner": 3}}
for group, sizes in shapes.items():
    with xr.open_dataset(path, engine="h5netcdf", group=group) as d:
        assert dict(d.sizes) == sizes, (group, dict(d.sizes))
        if group == "timing":
            assert list(d["stage"].values) == ["First", "Second"]
            assert d["frame_wall_s"].attrs["units"] == "s"
            assert np.isnan(d["frame_device_s"].sel(trial=1)).all()
        if group == "trajectory":
            assert d["position"].dims == ("time_s", "vertex", "xyz")
            assert np.isclose(d["position"].values[2, 1, 0], 2.03)
print("ok", path)

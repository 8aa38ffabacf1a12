"""Which solver is fastest on each scene? The interval is the range of the trials."""
import h5py
import numpy as np
from _cells import files

rows = {}
for path in files():
    with h5py.File(path) as f:
        if "timing" in f and f["outcome"].attrs["status"] == "ok":
            t = np.nanmean(f["timing/frame_wall_s"][:], axis=1)  # one mean a trial
            rows.setdefault(f.attrs["scene"], []).append((np.median(t), t.min(), t.max(), f.attrs["solver"]))
for scene, times in rows.items():
    for t, low, high, solver in sorted(times):
        print(f"{scene:32} {solver:20} {1e3 * t:9.3f} ms  [{1e3 * low:.3f}, {1e3 * high:.3f}]")

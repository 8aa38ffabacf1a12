"""Which solver is fastest on each scene? The interval is the range of the trials."""
import numpy as np
from _runs import runs

rows = []
for _, f in runs():
    if "timing" in f and f["outcome"].attrs["status"] == "ok":
        t = 1e3 * np.nanmean(f["timing/frame_wall_s"][:], axis=1)  # one mean per trial
        note = "" if f["timing/jobs"][:].max() <= 1 else "  other jobs ran at the same time; reports withhold this time"
        rows.append((f.attrs["scene"], np.median(t), t.min(), t.max(), f.attrs["solver"], note))
for scene, t, low, high, solver, note in sorted(rows):
    print(f"{scene:32} {solver:20} {t:9.3f} ms  [{low:.3f}, {high:.3f}]{note}")

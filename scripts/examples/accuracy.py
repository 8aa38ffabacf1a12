"""How far from the truth, for what time a frame? Nothing to tell where scenes have no exact answer."""
import h5py
from _cells import files

for path in files():
    with h5py.File(path) as f:
        s = f["summary"].attrs
        name = f"{f.attrs['scene']:28} {f.attrs['solver']:18} {f.attrs['setting']:28}"
        for error in ("truth_error", "free_fall_error"):
            if error in s and s[error] == s[error]:
                print(f"{name} {error} {s[error]:.3e}  at {1e3 * s['frame_wall_median_s']:.3f} ms a frame")

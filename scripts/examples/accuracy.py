"""How far from the truth, for what time a frame? Nothing to tell where scenes have no exact answer."""
from _runs import runs

for name, f in runs():
    s = f["summary"].attrs
    for error in ("truth_error", "free_fall_error"):
        if error in s and s[error] == s[error]:  # not NaN
            print(f"{name:64} {error} {s[error]:.3e}  at {1e3 * s['frame_wall_median_s']:.3f} ms a frame")

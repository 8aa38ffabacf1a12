"""How large is the error, and at which time per frame? Only for scenes with an exact solution."""
from _runs import runs

for name, f in runs():
    s = f["summary"].attrs
    for error in ("truth_error", "free_fall_error"):
        if error in s and s[error] == s[error]:  # not NaN
            print(f"{name:64} {error} {s[error]:.3e}  at {1e3 * s['frame_wall_median_s']:.3f} ms per frame")

"""Where is the cloth at the end? Its box."""
import h5py
from _cells import files

for path in files():
    with h5py.File(path) as f:
        if "trajectory" not in f:
            continue
        x = f["trajectory/position"][-1]  # (vertex, xyz), y up
        print(f"{path.name}: t = {f['trajectory/time_s'][-1]:.2f} s, from {x.min(axis=0).round(3)} to {x.max(axis=0).round(3)} m")

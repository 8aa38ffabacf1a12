"""Where is the cloth at the end? Its box."""
from _runs import runs

for name, f in runs():
    if "trajectory" in f:
        x = f["trajectory/position"][-1]  # (vertex, xyz), y up
        t = f["trajectory/time_s"][-1]
        print(f"{name}: t = {t:.2f} s, from {x.min(axis=0).round(3)} to {x.max(axis=0).round(3)} m")

"""Where does the GPU's time go? Median over trials and frames of each stage."""
import numpy as np
import xarray as xr
from _runs import runs

for name, f in runs():
    if "timing" in f:  # a run with trials
        stages = xr.open_dataset(f.filename, engine="h5netcdf", group="timing").stage_device_s
        median = stages.median(["trial", "frame"])
        if np.isfinite(median).any():
            print(name, {str(s): f"{1e6 * float(t):.1f} us" for s, t in zip(median.stage.values, median.values)})

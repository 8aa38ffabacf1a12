"""Where does the GPU's time go? Median over trials and frames of each stage."""
import numpy as np
import xarray as xr
from _cells import files

for path in files():
    try:
        stages = xr.open_dataset(path, engine="h5netcdf", group="timing").stage_device_s
    except (OSError, AttributeError):  # a cell without trials
        continue
    median = stages.median(["trial", "frame"])
    if np.isfinite(median).any():
        print(path.name, {str(s): f"{1e6 * float(t):.1f} us" for s, t in zip(median.stage.values, median.values)})

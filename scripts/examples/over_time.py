"""How does a quantity change over time? QUANTITY=stretch_mean_positive selects another one (`clothbench list metrics`). Draws over_time.png."""
import os

import matplotlib.pyplot as plt
from _runs import runs

for name, f in runs():
    y = f.get("metrics/" + os.environ.get("QUANTITY", "stretch_max"))
    if y is not None:
        plt.plot(f["metrics/time_s"][:], y[:], label=name)
        plt.ylabel(f"{y.attrs['long_name']} [{y.attrs['units']}]")
plt.gca().set_xlabel("time [s]")
plt.savefig("over_time.png", bbox_extra_artists=[plt.legend(fontsize=6)])

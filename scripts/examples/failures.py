"""What did not end well, and why?"""
import h5py
from _cells import files

for path in files():
    with h5py.File(path) as f:
        o = f["outcome"].attrs
        if o["status"] != "ok" or str(o.get("expect", "")).startswith("broken"):
            print(f"{path.stem}: {o['status']} ({o['class']}) {o['message']} {o.get('expect', '')}")

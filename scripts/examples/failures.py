"""What did not end well, and why?"""
from _cells import cells

for name, f in cells():
    o = f["outcome"].attrs
    if o["status"] != "ok" or str(o.get("expect", "")).startswith("broken"):
        print(f"{name}: {o['status']} ({o['class']}) {o['message']} {o.get('expect', '')}")

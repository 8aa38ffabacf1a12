"""What did not end well, and why?"""
from _runs import runs

for name, f in runs():
    o = f["outcome"].attrs
    if o["status"] != "ok" or str(o.get("expect", "")).startswith("fail"):
        print(f"{name}: {o['status']} ({o['class']}) {o['message']} {o.get('expect', '')}")

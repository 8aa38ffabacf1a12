"""On what was it measured, when, and by which commit?"""
from _cells import cells

for name, f in cells():
    e = f["environment"].attrs
    told = [e[k] for k in ("gpu", "cpu", "driver", "git_commit", "build_type", "created") if k in e]
    notes = {"gpu_is_software": "no speed claims", "git_dirty": "with local changes"}
    print(f"{name}: " + ", ".join(told + [note for key, note in notes.items() if e.get(key) == "true"]))

"""On what was it measured, when, and by which commit?"""
import json

from _runs import runs

for name, f in runs():
    e = json.loads(f["header_json"][0])["environment"]
    reported = [e[k] for k in ("gpu", "cpu", "driver", "git_commit", "build_type", "created") if k in e]
    notes = {"gpu_is_software": "no speed claims", "git_dirty": "with local changes"}
    print(f"{name}: " + ", ".join(reported + [note for key, note in notes.items() if e.get(key)]))

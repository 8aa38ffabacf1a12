#!/usr/bin/env python3
"""Writes the seeds in corpus/ and the dictionary scene.dict: small inputs that every reader takes, so that fuzzing starts inside.

    tests/fuzz/make_corpus.py          from the scenarios of the repository and what is written out here
"""
import base64
import json
import pathlib
import struct

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
JOINTS = ["wrist"] + [f"{f}-{j}" for f, js in [("thumb", ["metacarpal", "phalanx-proximal", "phalanx-distal", "tip"])] for j in js] + [
    f"{f}-finger-{j}" for f in ("index", "middle", "ring", "pinky")
    for j in ("metacarpal", "phalanx-proximal", "phalanx-intermediate", "phalanx-distal", "tip")]
CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
TRIANGLES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]


def put(kind, name, data):
    folder = HERE / "corpus" / kind
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(data)


def scenes():
    for name in ["contact/sphere", "contact/open-sheet", "paper/two-hand-stretch-2mps", "paper/capsule-sweep", "paper/desk-corner-low",
                 "validation/two-hand-pull", "validation/capstan-slip", "stability/s04-heavy-edge", "stability/s17-collider-spin",
                 "stability/s22-jitter", "stability/s15-crumpled"]:
        scene = json.loads((ROOT / "scenarios" / (name + ".json")).read_text())
        scene["cloth"]["grid"] = [min(9, n) for n in scene["cloth"]["grid"]]
        scene["time"]["duration_s"] = min(0.1, scene["time"]["duration_s"])
        scene["why"] = "A seed."
        put("scene", name.replace("/", "-") + ".json", json.dumps(scene).encode())
    words = set()

    def walk(j):
        if isinstance(j, dict):
            for key, value in j.items():
                if key == "properties":
                    words.update(value)
                if key == "enum":
                    words.update(v for v in value if isinstance(v, str))
                walk(value)
        elif isinstance(j, list):
            for value in j:
                walk(value)

    walk(json.loads((ROOT / "scenarios/schema/scene.schema.json").read_text()))
    (HERE / "scene.dict").write_text("".join(f'"\\"{w}\\""\n' for w in sorted(words)))


def meshes():
    put("obj", "tetrahedron.obj", "".join(["v %d %d %d\n" % p for p in CORNERS] + ["f %d %d %d\n" % tuple(i + 1 for i in t) for t in TRIANGLES]).encode())
    put("obj", "quads.obj", b"# two\no sheet\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1 4/1/1\nf -5/1/1 -2//1 -1 -4\n")


def gltf_meshes():
    """A square of two triangles with texture coordinates, placed by its node: as text and as a binary file."""
    parts = [struct.pack("<12f", 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0), struct.pack("<8f", 0, 0, 1, 0, 1, 1, 0, 1), struct.pack("<6H", 0, 1, 2, 0, 2, 3)]
    data, views = b"".join(parts), []
    for k, part in enumerate(parts):
        views.append({"buffer": 0, "byteOffset": sum(len(p) for p in parts[:k]), "byteLength": len(part)})
    gltf = {"asset": {"version": "2.0"}, "buffers": [{"byteLength": len(data)}], "bufferViews": views,
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
                          {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
                          {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
            "materials": [{"name": "silk"}],
            "meshes": [{"name": "cloth", "primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
            "nodes": [{"name": "cape", "mesh": 0, "translation": [0, 0, 5], "scale": [2, 2, 2]}], "scenes": [{"nodes": [0]}], "scene": 0}
    put("gltf", "square.glb", container(json.dumps(gltf, separators=(",", ":")).encode(), data))
    gltf["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    put("gltf", "square.gltf", json.dumps(gltf).encode())


def container(text, data):
    """A binary glTF of a JSON and a binary chunk."""
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def rooms():
    def packed(kind, values):
        return base64.b64encode(struct.pack(f"<{len(values)}{kind}", *values)).decode()
    room = {"type": "scene", "version": 1, "spatialEntities": [
        {"uuid": "t-1", "semanticLabel_META": "TABLE", "locatable_META": {"orientation": {"x": -0.5, "y": 0.5, "z": 0.5, "w": 0.5}},
         "bounded3D_META": {"offset": {"z": -0.75}, "extent": {"width": 1, "height": 2, "depth": 0.75}}},
        {"uuid": "m-1", "semanticLabel_META": "UNRECOGNIZED", "locatable_META": {"position": {"y": 2}, "orientation": {"w": 1}},
         "triangleMesh_META": {"vertices": packed("f", [x for p in CORNERS for x in p]), "indices": packed("I", [v for t in TRIANGLES for v in t])}}]}
    put("room", "tetrahedron.json", json.dumps(room).encode())


def hands():
    unit = [1.0 if i % 5 == 0 else 0.0 for i in range(16)]
    parts = [struct.pack("<400f", *(unit * 25)), struct.pack("<12f", *[x for p in CORNERS for x in p]), bytes([0, 1, 2, 3] * 4),
             struct.pack("<16f", *([0.5, 0.25, 0.25, 0] * 4)), bytes([v for t in TRIANGLES for v in t])]
    views, at = [], 0
    for part in parts:
        views.append({"buffer": 0, "byteOffset": at, "byteLength": len(part)})
        at += len(part)
    def accessor(view, component, count, kind):
        return {"bufferView": view, "componentType": component, "count": count, "type": kind}
    gltf = {"asset": {"version": "2.0"}, "buffers": [{"byteLength": at}], "bufferViews": views,
            "accessors": [accessor(0, 5126, 25, "MAT4"), accessor(1, 5126, 4, "VEC3"), accessor(2, 5121, 4, "VEC4"), accessor(3, 5126, 4, "VEC4"),
                          accessor(4, 5121, 12, "SCALAR")],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 1, "JOINTS_0": 2, "WEIGHTS_0": 3}, "indices": 4, "mode": 4}]}],
            "nodes": [{"name": n} for n in JOINTS], "skins": [{"inverseBindMatrices": 0, "joints": list(range(25))}]}
    text, data = json.dumps(gltf, separators=(",", ":")).encode(), b"".join(parts)
    put("hand", "tetrahedron.parts", text + b"\0" + data)
    put("hand", "tetrahedron.glb", container(text, data))


def recording():
    """Two frames, capsules, a tetrahedron for a mesh."""
    block = lambda kind, *numbers: base64.b64encode(struct.pack(f"<{len(numbers)}{kind}", *numbers)).decode()
    joint = (0.1, 1, -0.5, 0, 0, 0, 1, 0.01)
    mesh = {"positions_m": block("f", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1), "triangles": block("I", 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3),
            "joints": block("B", *[1, 2, 0, 0] * 4), "weights": block("f", *[0.25, 0.75, 0, 0] * 4), "bind": block("f", *joint * 26)}
    return json.dumps({"hand": "left", "recording": {"frame_rate_hz": 72, "frames": 2, "joints": block("f", *joint * 52),
                                                     "capsules": block("f", *(0, 0, 0, 0, 0.1, 0, 0.01) * 38), "mesh": mesh}}).encode()


def tracks():
    for name in ["right-hand-sweep", "left-hand-stretch-2mps"]:
        put("track", name + ".json", (ROOT / "scenarios/assets" / (name + ".json")).read_bytes())
    put("track", "recording.json", recording())
    put("track", "blend.json", b'{"hand":"left","anchor":"palm","keys":[{"time_s":0,"pose":"relaxed","blend":{"to":"pinch","amount":0.5},'
        b'"position_m":[0,1,0.1],"orientation":[0,0,0,1],"grip":true,"sweep":true},{"time_s":1,"position_m":[1,1,0]}]}')


def cbor(value):
    """A value of JSON with byte strings as CBOR: what the seeds need."""
    def head(major, n):
        return bytes([major << 5 | n]) if n < 24 else bytes([major << 5 | 25]) + struct.pack(">H", n)
    if value is None or isinstance(value, bool):
        return {None: b"\xf6", False: b"\xf4", True: b"\xf5"}[value]
    if isinstance(value, float):
        return b"\xfb" + struct.pack(">d", value)
    if isinstance(value, int):
        return head(0, value)
    if isinstance(value, bytes):
        return head(2, len(value)) + value
    if isinstance(value, str):
        return head(3, len(value.encode())) + value.encode()
    if isinstance(value, list):
        return head(4, len(value)) + b"".join(map(cbor, value))
    return head(5, len(value)) + b"".join(cbor(k) + cbor(v) for k, v in value.items())


def part():
    numbers = lambda n: struct.pack("<d", 1.5) * n
    header = {"scene": "s", "solver": "x", "setting": "d", "settings": {}, "scenario_json": "{}", "scenario_sha256": "0", "plan": {},
              "stages": [{"name": "a", "serves": ["stretch"], "dispatches": 1, "bytes": ""}], "environment": {}, "vertices": 1,
              "triangles": [0, 0, 0], "load_s": None}
    replay = [{"path": "colliders", "attributes": {"count": 1}, "arrays": [
        {"name": "a", "units": "m", "long_name": "x", "dims": ["frame"], "shape": [2], "integer": False, "values": numbers(2)}]}]
    accuracy = {"time_s": numbers(2), "position": struct.pack("<f", 1) * 6, "metrics": [
        {"name": "speed_max", "units": "m s-1", "long_name": "x", "version": 1, "values": numbers(2)}]}
    trial = {"index": 0, "pipelined_wall_s": 0.5, "trial_start_unix_s": 1.0, "trial_end_unix_s": 2.0, "jobs": 1.0} | {
        name: numbers(2) for name in ["frame_wall_s", "frame_device_s", "stage_device_s", "read_B", "write_B"]} | {
        "frame_rendered_s": b"", "frame_cpu_s": b""}
    outcome = {"status": "ok", "class": "ok", "failed_frame": 3, "message": "", "expect": "pass", "trajectory_sha256": "", "summary": {"a": 1.5, "b": "inf"}}
    items = {"header": header, "replay": replay, "accuracy": accuracy, "trial": trial, "outcome": outcome}
    for n, name in enumerate(items):
        put("part", name, b"".join(cbor({k: v}) for k, v in list(items.items())[:n + 1]))


def hdf5():
    put("hdf5", "nothing", b"")
    for what in range(8):
        put("hdf5", f"change-{what}", bytes([what, 3, 0, 5, 0, 1, 2, 3, 4, 5, 6, 7]) * 3)
    put("hdf5", "header", bytes([7, 0, 0, 0, 0]) + b'{"scene":"s","solver":"x","setting":"d","settings":{},"stages":[]}')


for write in (scenes, meshes, gltf_meshes, rooms, hands, tracks, part, hdf5):
    write()

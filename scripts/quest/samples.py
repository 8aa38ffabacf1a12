"""Parsers of what a headset's tools print, and samples.json, which `clothbench import --samples` reads. Sources of the formats: README.md."""
import json
import math
import os
import re
import statistics

READ, WRITE = "Read Total (Bytes/sec)", "Write Total (Bytes/sec)"
# Counters of ovrgpuprofiler by name: their numbers are list positions, which differ between devices and systems.
WANTED = (READ, WRITE, "Clocks / Second", "GPU Frequency", "GPU % Bus Busy", "GPU % Utilization", "% Stalled on System Memory")
COUNTER_SOURCES = {"perfetto": "Perfetto's gpu.counters", "ovrgpuprofiler": "ovrgpuprofiler -r, the computer's time of arrival moved to the device's clock"}
CLOCK_TOLERANCE = 0.02  # relative to the median: steps between clock levels are 8 % and more
# VrApi's log line, one per second: series -> (pattern, units, role in the summary, factor to the role's SI unit).
VRAPI = {
    "fps": (r"FPS=(\d+)/", "s-1", "fps", 1),
    "refresh_rate": (r"FPS=\d+/(\d+)", "s-1", "", 1),
    "cpu_level": (r"CPU\d*/GPU=(\d+)/", "1", "", 1),
    "gpu_level": (r"CPU\d*/GPU=\d+/(\d+)", "1", "", 1),
    "cpu_clock_MHz": (r",(\d+)/\d+MHz", "MHz", "cpu_clock", 1e6),
    "gpu_clock_MHz": (r",\d+/(\d+)MHz", "MHz", "gpu_clock", 1e6),
    "memory_clock_MHz": (r"Mem=(\d+)MHz", "MHz", "", 1),
    "power_level_state": (r"PLS=(\d+)", "1", "", 1),
    "battery_saver": (r",LP=(\d+)", "1", "", 1),
    "voltage_scaling": (r"DVFS=(\d+)", "1", "", 1),
    "temperature_C": (r"Temp=(-?[\d.]+)C", "degC", "temperature", 1),
    "stale_frames": (r"Stale=(\d+)", "1", "", 1),
    "stale_runs_of_2": (r"Stale2/5/10/max=(\d+)", "1", "", 1),
    "stale_runs_of_5": (r"Stale2/5/10/max=\d+/(\d+)", "1", "", 1),
    "stale_runs_of_10": (r"Stale2/5/10/max=\d+/\d+/(\d+)", "1", "", 1),
    "stale_run_max": (r"Stale2/5/10/max=\d+/\d+/\d+/(\d+)", "1", "", 1),
    "app_gpu_time_ms": (r"App=(-?[\d.]+)ms", "ms", "", 1),
    "gpu_utilization": (r"GPU%=([\d.]+)", "1", "", 1),
    "compositor_latency_min_ms": (r"CFL=(-?[\d.]+)/", "ms", "", 1),
    "compositor_latency_max_ms": (r"CFL=-?[\d.]+/(-?[\d.]+)", "ms", "", 1),
    "compositor_latency_p95_ms": (r"ICFLp95=(-?[\d.]+)", "ms", "", 1),
    "framebuffer_scale": (r",SF=([\d.]+)", "1", "", 1),
}


def number(text):
    """A finite number, else None."""
    try:
        value = float(text)
    except (TypeError, ValueError):
        return None
    return value if math.isfinite(value) else None


def devices(text):
    """`adb devices -l` -> [(serial, state)]."""
    rows = [line.split() for line in text.splitlines()[1:] if not line.startswith("*")]
    return [tuple(row[:2]) for row in rows if len(row) >= 2]


def counter_ids(text):
    """`ovrgpuprofiler -m` -> {name: number}."""
    return {name: int(at) for at, name in re.findall(r"^[ \t]*(\d+)[ \t]+(\S.*?)[ \t]*$", text, re.M) if not name.endswith("supported:")}


class Counters:
    """`ovrgpuprofiler -r…`: one block of `name : value` lines per second, separated by empty lines."""

    def __init__(self):
        self.samples = []  # (time, {name: value})
        self._block = {}

    def feed(self, when, line):
        found = re.match(r"^\s*(\S.*?)\s+:\s*(\S+)\s*$", line)
        if self._block and (found[1] in self._block if found else not line.strip()):
            self.samples.append((when, self._block))
            self._block = {}
        if found:
            self._block[found[1]] = number(found[2])


def logcat(line):
    """A line of `logcat -v epoch` -> (seconds since 1970, tag, message); None for anything else."""
    found = re.match(r"^\s*(\d+\.\d+)\s+\d+\s+\d+\s+[VDIWEF]\s+(.*?)\s*:\s(.*)$", line)
    return (float(found[1]), found[2], found[3]) if found else None


def vrapi(message):
    """VrApi's line -> {series: value, None where not reported}; None for its other lines."""
    if not message.startswith("FPS="):
        return None
    return {name: number((re.findall(pattern, message) or [None])[0]) for name, (pattern, *_) in VRAPI.items()}


def level_change(message):
    """XrPerformanceManager's line of a change -> "4,3 -> 3,3" (CPU and GPU level); None for its other lines."""
    found = re.search(r"SetClockLevels: .*: (\d+,\d+ -> \d+,\d+)", message)
    return found[1] if found else None


def result(message):
    """The app's last line -> "PASS" or "FAIL"; None for its other lines."""
    found = re.match(r"^RESULT (PASS|FAIL)\s*$", message)
    return found[1] if found else None


def dataset_name(name):
    """"Read Total (Bytes/sec)" -> "Read_Total_Bytes_per_sec"."""
    return re.sub(r"\W+", "_", name.replace("/", " per ").replace("%", " percent "), flags=re.ASCII).strip("_")


def group(name, source, rows, described, reasons=None):
    """One group of samples.json. rows: [(time [s], {series: value})] in any order; described: {series: (units, role, factor)}; reasons: {time: text}."""
    kept = sorted({when: values for when, values in rows}.items())
    times = [when for when, _ in kept]
    steps = [b - a for a, b in zip(times, times[1:])]
    series = []
    for key, (units, role, factor) in described.items():
        values = [row.get(key) for _, row in kept]
        if any(v is not None for v in values):
            series.append({"name": dataset_name(key), "units": units, "long_name": key.replace("_", " "), "values": values, **({"role": role, "scale": factor} if role else {})})
    stated = {"reasons": [reasons[when] for when in times]} if reasons is not None else {}
    return {"name": name, "source": source, "period_s": statistics.median(steps) if steps else 1.0, "time_unix_s": times, "series": series, **stated}


def groups(vrapi_rows, counter_rows, counter_source, requested):
    names = sorted({name for _, values in counter_rows for name in values})
    counters = {n: ("B s-1" if "Bytes/sec" in n else "%" if "%" in n else "1", {READ: "read", WRITE: "write"}.get(n, ""), 1) for n in names}
    out = [group("vrapi", "VrApi lines of logcat", vrapi_rows, {name: rest for name, (_, *rest) in VRAPI.items()}, doubts(vrapi_rows, requested)),
           group(counter_source, COUNTER_SOURCES[counter_source], counter_rows, counters)]
    return [g for g in out if g["series"]]


def doubts(vrapi_rows, requested):
    """{time of VrApi's line: why frames of the second before it are not valid, empty if they are}. requested: {series: value}."""
    clocks = {name: [row[name] for _, row in vrapi_rows if row[name] is not None] for name in ("cpu_clock_MHz", "gpu_clock_MHz")}
    medians = {name: statistics.median(values or [0]) for name, values in clocks.items()}
    out = {}
    for when, row in vrapi_rows:
        found = [f"levels changed {change}" for change in row["changes"]]
        for name, wanted in {**requested, "power_level_state": 0}.items():
            if row[name] != wanted:
                found.append(f"{name.replace('_', ' ')} {'unknown' if row[name] is None else format(row[name], 'g')}, not {wanted:g}")
        found += ["battery saver on"] if row["battery_saver"] else []
        for name, median in medians.items():
            if row[name] is not None and not abs(row[name] - median) <= CLOCK_TOLERANCE * median:
                found.append(f"{name.replace('_', ' ')} {row[name]:g}, usually {median:g}")
        out[when] = ", ".join(found)
    return out


def write(path, device, found):
    record = {"format": "clothbench-device-samples", "format_version": 2, "device": device, "groups": found}
    with open(path + ".tmp", "w", encoding="utf-8") as out:
        json.dump(record, out, allow_nan=False, indent=0)
    os.replace(path + ".tmp", path)  # readers see the whole file or none

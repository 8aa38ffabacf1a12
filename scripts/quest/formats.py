"""Parsers of the output of the headset's tools: pure functions of text; sources in README.md."""
import csv
import io
import re
import statistics

READ_TOTAL, WRITE_TOTAL = "Read Total (Bytes/sec)", "Write Total (Bytes/sec)"
# Metrics asked of ovrgpuprofiler, by name: numbers are list positions that differ between devices and systems.
WANTED = (
    READ_TOTAL,
    WRITE_TOTAL,
    "Clocks / Second",
    "GPU Frequency",
    "GPU % Bus Busy",
    "GPU % Utilization",
    "% Stalled on System Memory",
)


def plain(text):
    """Without the \\r of terminals: `adb shell -tt` ends lines in \\r\\r\\n."""
    return text.replace("\r", "")


def number(text):
    """A finite number, else None."""
    try:
        v = float(text)
    except (TypeError, ValueError):
        return None
    return v if v - v == 0 else None


def slug(name):
    """A name fit for a dataset: "Read Total (Bytes/sec)" -> "Read_Total_Bytes_per_sec"."""
    return re.sub(r"\W+", "_", name.replace("/", " per ").replace("%", " percent "), flags=re.ASCII).strip("_")


def devices(text):
    """`adb devices -l` -> [(serial, state, model)]."""
    out = []
    for line in text.splitlines()[1:]:
        words = line.split()
        if len(words) >= 2 and not line.startswith("*"):
            model = re.search(r"model:(\S+)", line)
            out.append((words[0], words[1], model.group(1).replace("_", " ") if model else ""))
    return out


def battery(text):
    """`dumpsys battery` -> level [%], temperature_C, powered (any of AC, USB, wireless, dock), each None where not reported."""
    values = dict(re.findall(r"^\s*([\w ]+):\s*(\S+)\s*$", text, re.M))
    tenths = number(values.get("temperature"))
    powered = [v == "true" for k, v in values.items() if k.endswith(" powered")]
    return {
        "level": number(values.get("level")),
        "temperature_C": None if tenths is None else tenths / 10,
        "powered": any(powered) if powered else None,
    }


def thermal_status(text):
    """`dumpsys thermalservice` -> 0 (none) … 6 (shutdown), None where not reported."""
    found = re.search(r"Thermal Status:\s*(\d+)", text)
    return int(found.group(1)) if found else None


def free_B(text):
    """`df -k PATH` -> bytes free, None where not reported."""
    lines = [line.split() for line in text.splitlines() if line.strip()]
    if len(lines) >= 2 and "Available" in lines[0]:
        v = number(lines[1][lines[0].index("Available")])
        return None if v is None else int(v) * 1024
    return None


def metric_ids(text):
    """`ovrgpuprofiler -m` -> {name: number}."""
    listed = re.findall(r"^[ \t]*(\d+)[ \t]+(\S.*?)[ \t]*$", text, re.M)
    return {name: int(at) for at, name in listed if not name.endswith("supported:")}


class GpuBlocks:
    """`ovrgpuprofiler -r…`: a block of `name : value` lines a second, parted by empty lines."""

    def __init__(self):
        self.samples = []  # (time, {name: value})
        self._block = {}

    def feed(self, when, line):
        found = re.match(r"^\s*(\S.*?)\s+:\s*(\S+)\s*$", line)
        if found and found.group(1) in self._block:
            self.end(when)
        if found:
            self._block[found.group(1)] = number(found.group(2))
        elif not line.strip():
            self.end(when)

    def end(self, when):
        if self._block:
            self.samples.append((when, self._block))
            self._block = {}


def logcat(line):
    """A line of `logcat -v epoch` -> (seconds since 1970, tag, message); None for anything else."""
    found = re.match(r"^\s*(\d+\.\d+)\s+\d+\s+\d+\s+[VDIWEF]\s+(.*?)\s*:\s(.*)$", line)
    return (float(found.group(1)), found.group(2), found.group(3)) if found else None


def vrapi(message):
    """VrApi's line of every second -> {name: value}; None for its other lines."""
    if not message.startswith("FPS="):
        return None
    patterns = {
        "fps": r"FPS=(\d+)/",
        "refresh_rate": r"FPS=\d+/(\d+)",
        "cpu_level": r"CPU\d*/GPU=(\d+)/",
        "gpu_level": r"CPU\d*/GPU=\d+/(\d+)",
        "cpu_clock_MHz": r",(\d+)/\d+MHz",
        "gpu_clock_MHz": r",\d+/(\d+)MHz",
        "memory_clock_MHz": r"Mem=(\d+)MHz",
        "power_level_state": r"PLS=(\d+)",
        "temperature_C": r"Temp=(-?[\d.]+)C",
        "stale_frames": r"Stale=(\d+)",
        "app_gpu_time_ms": r"App=(-?[\d.]+)ms",
        "timewarp_gpu_time_ms": r"TW=(-?[\d.]+)ms",
        "gpu_utilization": r"GPU%=([\d.]+)",
        "cpu_utilization": r"CPU%=([\d.]+)",
    }
    found = {name: re.search(pattern, message) for name, pattern in patterns.items()}
    return {name: number(m.group(1)) if m else None for name, m in found.items()}


def ovr_csv(text):
    """A file of OVR Metrics Tool -> (times [s], {column: values}, rows left out).

    Columns vary with the tool's version: they are taken by the header's names. Rows may have more fields than the header
    (an app's own texts) and the last may be torn. "Time Stamp" counts milliseconds; its start is the caller's to anchor.
    """
    rows = [row for row in csv.reader(io.StringIO(plain(text))) if row]
    if not rows or "Time Stamp" not in rows[0]:
        return [], {}, len(rows)
    head = [name.strip() for name in rows[0]]
    at = head.index("Time Stamp")
    whole = [row for row in rows[1:] if len(row) >= len(head) and number(row[at]) is not None]
    whole = [row for k, row in enumerate(whole) if k == 0 or number(row[at]) > number(whole[k - 1][at])]
    columns = {name: [number(row[k]) for row in whole] for k, name in enumerate(head) if k != at and name}
    columns = {name: values for name, values in columns.items() if any(v is not None for v in values)}
    return [number(row[at]) * 1e-3 for row in whole], columns, len(rows) - 1 - len(whole)


def ovr_units(column):
    """Units by the tool's own suffixes."""
    for suffix, units in (
        ("_MHz", "MHz"),
        ("_MB", "MB"),
        ("_percentage", "%"),
        ("_celcius", "degC"),
        ("_microseconds", "us"),
        ("_milliseconds", "ms"),
        ("_frame_rate", "s-1"),
        ("_refresh_rate", "s-1"),
        ("_wattage", "W"),
    ):
        if suffix in column:
            return units
    return "1"


def period_s(times, otherwise=1.0):
    """Median step of ascending times."""
    steps = [b - a for a, b in zip(times, times[1:]) if b > a]
    return statistics.median(steps) if steps else otherwise


def result(message):
    """The app's last line -> (passed, path on the device); None for its other lines."""
    found = re.match(r"^RESULT (PASS|FAIL) (.+?)\s*$", message)
    return (found.group(1) == "PASS", found.group(2)) if found else None

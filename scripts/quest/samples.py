"""Everything sampled during a run, as the file that `clothbench import --samples` reads."""
import json
import os

from . import formats


def _group(name, source, rows, described):
    """rows: [(time, {series: value})] in any order; described: {series: (units, long name, role, scale)}; the first of a role counts."""
    times, kept = [], []
    for when, values in sorted(rows, key=lambda row: row[0]):
        if not times or when > times[-1]:
            times.append(when)
            kept.append(values)
    series = []
    for key, (units, long_name, role, scale) in described.items():
        column = [row.get(key) for row in kept]
        if any(v is not None for v in column):
            one = {"name": formats.slug(key), "units": units, "long_name": long_name, "values": column}
            if role:
                one.update(role=role, scale=scale)
            series.append(one)
    return {"name": name, "source": source, "period_s": formats.period_s(times), "time_unix_s": times, "series": series}


def vrapi_group(rows):
    units = {
        "fps": "s-1",
        "refresh_rate": "s-1",
        "temperature_C": "degC",
        "app_gpu_time_ms": "ms",
        "timewarp_gpu_time_ms": "ms",
    }
    roles = {
        "fps": ("fps", 1),
        "cpu_clock_MHz": ("cpu_clock", 1e6),
        "gpu_clock_MHz": ("gpu_clock", 1e6),
        "temperature_C": ("temperature", 1),
    }
    keys = sorted({key for _, values in rows for key in values})
    return _group(
        "vrapi",
        "VrApi lines of logcat",
        rows,
        {
            k: (units.get(k, "MHz" if k.endswith("_MHz") else "1"), k.replace("_", " "), *roles.get(k, ("", 1)))
            for k in keys
        },
    )


def profiler_group(rows):
    roles = {formats.READ_TOTAL: ("read", 1), formats.WRITE_TOTAL: ("write", 1)}
    names = sorted({name for _, values in rows for name in values})
    return _group(
        "ovrgpuprofiler",
        "ovrgpuprofiler -r, host's time of arrival moved to the device's clock",
        rows,
        {n: ("B s-1" if "Bytes/sec" in n else "%" if "%" in n else "1", n, *roles.get(n, ("", 1))) for n in names},
    )


def battery_group(rows):
    return _group(
        "battery",
        "dumpsys battery and thermalservice, polled",
        rows,
        {
            "level": ("%", "battery charge", "", 1),
            "temperature_C": ("degC", "battery temperature", "", 1),
            "powered": ("1", "1: on a charger", "", 1),
            "thermal_status": ("1", "Android thermal status; 0 is none", "", 1),
        },
    )


def ovr_group(text, enabled_unix_s, with_roles):
    """OVR Metrics counts from its start, which is taken to be when it was enabled: good to about a second."""
    times, columns, left_out = formats.ovr_csv(text)
    rows = [(enabled_unix_s + t, {name: values[k] for name, values in columns.items()}) for k, t in enumerate(times)]
    roles = (
        {
            "average_frame_rate": ("fps", 1),
            "cpu_frequency_MHz": ("cpu_clock", 1e6),
            "gpu_frequency_MHz": ("gpu_clock", 1e6),
            "battery_temperature_celcius": ("temperature", 1),
        }
        if with_roles
        else {}
    )
    described = {name: (formats.ovr_units(name), name.replace("_", " "), *roles.get(name, ("", 1))) for name in columns}
    source = "OVR Metrics Tool CSV; its time counted from when it was enabled, good to about a second"
    return _group("ovr_metrics", source + (f"; {left_out} torn rows left out" if left_out else ""), rows, described)


def write(path, device, asked, groups, reasons):
    """Groups without samples are left out. The file appears whole or not at all."""
    record = {
        "format": "clothbench-device-samples",
        "format_version": 1,
        "valid": not reasons,
        "reasons": reasons,
        "device": dict(device, asked=asked),
        "groups": [g for g in groups if g["time_unix_s"] and g["series"]],
    }
    with open(path + ".tmp", "w", encoding="utf-8") as out:
        json.dump(record, out, allow_nan=False, indent=0)
        out.write("\n")
        out.flush()
        os.fsync(out.fileno())
    os.replace(path + ".tmp", path)

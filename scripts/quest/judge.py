"""Decides whether a run is valid: clocks, temperatures, refresh rate and power must stay at the requested values.

Works on groups as samples.py makes them: {"name", "time_unix_s", "series": [{"name", "values"}]}.
"""

CLOCK_TOLERANCE = 0.02  # of the median: steps between levels are 8 % and more
WARMING_C = 8.0  # battery, from coolest to hottest


def _values(groups, group, series, since, until):
    for g in groups:
        if g["name"] == group:
            for s in g["series"]:
                if s["name"] == series:
                    return [v for t, v in zip(g["time_unix_s"], s["values"]) if v is not None and since <= t <= until]
    return []


def _reported(values):
    return f"{min(values):g}" if min(values) == max(values) else f"{min(values):g} to {max(values):g}"


def judge(groups, asked, since, until, events):
    """Reasons against the run, in words; empty if there is none. `asked`: cpu_level, gpu_level, refresh_hz."""

    def of(*places):
        return {place: v for place in places if (v := _values(groups, *place, since, until))}

    reasons = list(events)
    vrapi, ovr = "vrapi", "ovr_metrics"
    for what, wanted, seen in (
        ("CPU level", asked["cpu_level"], of((vrapi, "cpu_level"), (ovr, "cpu_level"))),
        ("GPU level", asked["gpu_level"], of((vrapi, "gpu_level"), (ovr, "gpu_level"))),
        ("refresh rate [Hz]", asked["refresh_hz"], of((vrapi, "refresh_rate"), (ovr, "display_refresh_rate"))),
    ):
        if not seen:
            reasons.append(f"{what}: not reported by the device, so it cannot be known to have stayed at {wanted:g}")
        for (group, _), values in seen.items():
            if any(v != wanted for v in values):
                reasons.append(f"{what} was {_reported(values)}, {wanted:g} was asked for ({group})")
    for what, seen in (
        ("GPU clock [MHz]", of((vrapi, "gpu_clock_MHz"), (ovr, "gpu_frequency_MHz"))),
        ("CPU clock [MHz]", of((vrapi, "cpu_clock_MHz"), (ovr, "cpu_frequency_MHz"))),
    ):
        for (group, _), values in seen.items():
            middle = sorted(values)[len(values) // 2]
            if not max(values) - min(values) <= CLOCK_TOLERANCE * middle:
                reasons.append(f"{what} moved: {_reported(values)} ({group})")
    for (group, _), values in of((vrapi, "power_level_state"), (ovr, "power_level_state")).items():
        if any(v != 0 for v in values):
            reasons.append(f"power level state was {_reported(values)}: the headset was saving power or too hot ({group})")
    for values in of(("battery", "thermal_status")).values():
        if any(v != 0 for v in values):
            reasons.append(f"thermal status was {_reported(values)}: too hot")
    for values in of(("battery", "temperature_C")).values():
        if not max(values) - min(values) <= WARMING_C:
            reasons.append(f"the battery's temperature moved: {_reported(values)} °C")
    for values in of(("battery", "powered")).values():
        if min(values) != max(values):
            reasons.append("the charger was plugged in or out")
    return reasons

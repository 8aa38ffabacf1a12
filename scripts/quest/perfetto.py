"""GPU counters by Perfetto: which ones a device offers, the configuration of a trace, and a trace's samples.

Field numbers are from protos/perfetto in google/perfetto. Android's producers describe their counters in the events
themselves (docs/data-sources/gpu.md there)."""
import math
import struct

PERIOD_NS = 10_000_000
REALTIME, BOOTTIME = 1, 6  # builtin_clock.proto


def varint(data, at):
    """Returns the value and the position after it."""
    for size in range(1, 11):
        if data[at + size - 1] < 128:
            return sum((byte & 127) << 7 * k for k, byte in enumerate(data[at:at + size])), at + size
    raise ValueError("a number of more than 10 bytes")


def fields(message):
    """(number, value) of each field of a protobuf message. Values are integers, or bytes if not of the wire's kind 0."""
    at = 0
    while at < len(message):
        key, at = varint(message, at)
        size, at = varint(message, at) if key & 7 in (0, 2) else ({1: 8, 5: 4}[key & 7], at)
        value, at = (size, at) if key & 7 == 0 else (message[at:at + size], at + size)
        if at > len(message):
            raise ValueError("a field that is longer than its message")
        yield key >> 3, value


def parts(message, number):
    """The messages of a repeated field, each as {number: last value}."""
    return [dict(fields(value)) for n, value in fields(message) if n == number]


def counter_names(descriptor):
    """GpuCounterDescriptor -> {id: name}."""
    return {spec[1]: spec[2].decode() for spec in parts(descriptor, 1)}


def offered(state):
    """TracingServiceState (`perfetto --query-raw`) -> (name of the data source, {counter: id}); the vendor's suffix differs. Raises ValueError if it is damaged."""
    try:
        for source in parts(state, 2):
            found = dict(fields(source[1]))
            if found[1].startswith(b"gpu.counters") and 5 in found:
                return found[1].decode(), {name: at for at, name in counter_names(found[5]).items()}
    except (LookupError, TypeError, AttributeError) as e:
        raise ValueError(f"not a state of Perfetto's service: {e!r}") from e
    return "", {}


def config(source, ids):
    chosen = " ".join(f"counter_ids: {at}" for at in ids)
    return (f'buffers {{ size_kb: 16384 }} duration_ms: 14400000 write_into_file: true file_write_period_ms: 2000 data_sources {{ config {{ name: "{source}" '
            f"gpu_counter_config {{ counter_period_ns: {PERIOD_NS} {chosen} }} }} }}")


def samples(trace):
    """Trace -> [(time [s since 1970], {counter: mean or rate since the sample before})]. Raises ValueError if it is damaged."""
    names, ahead_ns, out = {}, {}, []  # ahead: real time minus each clock
    try:
        for packet in parts(trace, 1):
            if 6 in packet:
                clocks = {clock[1]: clock[2] for clock in parts(packet[6], 1)}
                real_ns = clocks.get(REALTIME) or clocks[BOOTTIME] + ahead_ns[BOOTTIME]
                ahead_ns.update({clock: real_ns - t for clock, t in clocks.items()})
            event = packet.get(52, b"")
            names.update(counter_names(dict(fields(event)).get(1, b"")))
            values = {names[c[1]]: struct.unpack("<d", c[3])[0] if 3 in c else c[2] - (c[2] >> 63 << 64) for c in parts(event, 2)}
            if values := {name: v for name, v in values.items() if math.isfinite(v)}:
                out.append(((packet[8] + ahead_ns[packet.get(58, BOOTTIME)]) * 1e-9, values))
    except (LookupError, TypeError, AttributeError, ValueError, struct.error) as e:
        raise ValueError(f"not a Perfetto trace of GPU counters: {e!r}") from e
    return out

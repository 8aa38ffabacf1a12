"""Writes protobuf messages for the tests: the encoding of protobuf.dev/programming-guides/encoding."""
import struct


def varint(value):
    head = value & (1 << 64) - 1
    return bytes([head]) if head < 128 else bytes([head & 127 | 128]) + varint(head >> 7)


def message(*pairs):
    """Protobuf's encoding of (number, value): an int, a double, bytes, or another message's bytes."""
    def one(number, value):
        if isinstance(value, int):
            return varint(number << 3) + varint(value)
        if isinstance(value, float):
            return varint(number << 3 | 1) + struct.pack("<d", value)
        return varint(number << 3 | 2) + varint(len(value)) + value

    return b"".join(one(number, value) for number, value in pairs)

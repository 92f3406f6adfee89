"""Reads EXR files as sheen writes them: scan lines, without compression or with zip."""
import struct
import zlib

import numpy as np

TYPES = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}
ROWS = {0: 1, 2: 1, 3: 16}  # of a block, by compression: none, zips, zip


def _text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def _header(data):
    assert data[:4] == b"\x76\x2f\x31\x01"
    at, attributes = 8, {}
    while data[at]:
        name, at = _text(data, at)
        kind, at = _text(data, at)
        size, = struct.unpack_from("<I", data, at)
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def _channels(raw):
    at, found = 0, []
    while raw[at]:
        name, at = _text(raw, at)
        found.append((name, TYPES[struct.unpack_from("<I", raw, at)[0]]))
        at += 16
    return found


def _unzip(packed, size):
    if len(packed) == size:
        return packed
    raw = np.frombuffer(zlib.decompress(packed), "u1").astype("u8")
    raw[1:] -= 128
    raw = np.cumsum(raw).astype("u1")
    half = (size + 1) // 2
    out = np.empty(size, "u1")
    out[0::2], out[1::2] = raw[:half], raw[half:]
    return out.tobytes()


def read(data):
    """The channels by their names, as arrays (height, width)."""
    attributes, at = _header(data)
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    channels = _channels(attributes["channels"])
    rows = ROWS[attributes["compression"][0]]
    planes = {name: np.empty((height, width), dtype) for name, dtype in channels}
    n_blocks = -(-height // rows)
    for offset in struct.unpack_from(f"<{n_blocks}Q", data, at):
        y, size = struct.unpack_from("<ii", data, offset)
        n = min(rows, top + height - y)
        raw = _unzip(data[offset + 8:offset + 8 + size], n * width * sum(dtype.itemsize for _, dtype in channels))
        position = 0
        for row in range(y - top, y - top + n):
            for name, dtype in channels:
                planes[name][row] = np.frombuffer(raw, dtype, width, position)
                position += width * dtype.itemsize
    return planes

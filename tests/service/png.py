"""Reads PNG files that the client writes."""
import struct
import zlib


def read_png(path):
    """Width, height, and the RGB or RGBA rows of an 8-bit PNG without interlacing."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        assert zlib.crc32(kind + body) == struct.unpack(">I", data[at + 8 + length:][:4])[0]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
            assert depth == 8
            n = {2: 3, 6: 4}[colour]
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    raw, rows, before = zlib.decompress(packed), [], bytearray(n * width)
    for y in range(height):
        line = bytearray(raw[y * (n * width + 1):(y + 1) * (n * width + 1)])
        rows.append(unfilter(line[0], line[1:], before, n))
        before = rows[-1]
    return width, height, rows


def unfilter(kind, line, up, n):
    for i, value in enumerate(line):
        a, b, c = (line[i - n] if i >= n else 0), up[i], (up[i - n] if i >= n else 0)
        paeth = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
        line[i] = (value + (0, a, b, (a + b) // 2, paeth)[kind]) & 255
    return line

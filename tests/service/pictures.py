"""One picture of two by two pixels, in every format of light images."""
import struct

RED, GREEN, BLUE, YELLOW = PIXELS = ((255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 0))


def rgb(pixels):
    return b"".join(bytes(pixel) for pixel in pixels)


def bgr(pixels):
    return b"".join(bytes(pixel[::-1]) for pixel in pixels)


def ppm():
    return b"P6\n2 2\n255\n" + rgb(PIXELS)


def plain_ppm():
    return b"P3 2 2 255\n" + " ".join(str(byte) for byte in rgb(PIXELS)).encode() + b"\n"


def pfm():
    """Floats, bottom row first."""
    rows = (BLUE, YELLOW, RED, GREEN)
    return b"PF\n2 2\n-1.0\n" + struct.pack("<12f", *(c / 255 for pixel in rows for c in pixel))


def bmp():
    """Bottom row first; a row has eight bytes."""
    rows = bgr((BLUE, YELLOW)) + bytes(2) + bgr((RED, GREEN)) + bytes(2)
    return (b"BM" + struct.pack("<IHHI", 54 + len(rows), 0, 0, 54) +
            struct.pack("<IiiHHIIiiII", 40, 2, 2, 1, 24, 0, len(rows), 2835, 2835, 0, 0) + rows)


def tga(side=2, kind=2, pixels=None):
    """Top row first."""
    pixels = bgr(PIXELS) if pixels is None else pixels
    return struct.pack("<BBBHHBHHHHBB", 0, 0, kind, 0, 0, 0, 0, 0, side, side, 24, 0x20) + pixels


def packed_tga():
    """Each pixel is a run of length one."""
    return tga(kind=10, pixels=b"".join(b"\x80" + bgr((pixel,)) for pixel in PIXELS))


def hdr():
    rgbe = b"".join(bytes(128 if c else 0 for c in pixel) + b"\x81" for pixel in PIXELS)
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n" + rgbe


def gif():
    """Codes of three bits. The code 4 (restart) comes before codes would grow to four bits; 5 ends the picture."""
    bits = sum(code << 3 * i for i, code in enumerate((4, 0, 1, 4, 2, 3, 5)))
    data = bits.to_bytes(3, "little")
    return (b"GIF89a" + struct.pack("<HHBBB", 2, 2, 0x91, 0, 0) + rgb(PIXELS) + b"," +
            struct.pack("<HHHHB", 0, 0, 2, 2, 0) + b"\x02" + bytes([len(data)]) + data + b"\0;")


def webp():
    """Lossless WebP: codes of one bit for green, red and blue, and of no bits for alpha and distances."""
    fields = [(1, 14), (1, 14), (0, 4), (0, 3)]  # the sides minus one; no alpha, no transform, no cache
    fields += 3 * [(1, 1), (1, 1), (0, 1), (0, 1), (255, 8)]  # the values 0 and 255
    fields += [(1, 1), (0, 1), (1, 1), (255, 8), (1, 1), (0, 1), (0, 1), (0, 1)]
    fields += [(c // 255, 1) for r, g, b in PIXELS for c in (g, r, b)]
    bits = at = 0
    for value, size in fields:
        bits |= value << at
        at += size
    data = b"/" + bits.to_bytes((at + 7) // 8, "little")
    data += bytes(len(data) % 2)
    return (b"RIFF" + struct.pack("<I", 12 + len(data)) + b"WEBPVP8L" +
            struct.pack("<I", len(data)) + data)


EXACT = {"a.ppm": ppm(), "plain.ppm": plain_ppm(), "a.bmp": bmp(), "a.tga": tga(),
         "packed.tga": packed_tga(), "a.gif": gif(), "a.webp": webp()}
LINEAR = {"a.hdr": hdr(), "a.pfm": pfm()}

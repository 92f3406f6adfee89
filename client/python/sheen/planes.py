"""Planes of pixels as numpy arrays (protocol/README.md, chapter 5)."""
from __future__ import annotations

from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from sheen.protobuf import Malformed

Array = npt.NDArray[Any]
STRIP_BYTES = 524288
PTEX = np.dtype([("face", "<u4"), ("u", "<f4"), ("v", "<f4")])


class Plane(NamedTuple):
    bit: int
    dtype: np.dtype[Any]
    n: int  # numbers of a pixel


PLANES = {
    "colour": Plane(1, np.dtype("u1"), 4),
    "position": Plane(2, np.dtype("<f4"), 3),
    "normal": Plane(4, np.dtype("<f4"), 3),
    "ptex": Plane(8, PTEX, 1),
    "light": Plane(16, np.dtype("<f4"), 2),
    "curvature": Plane(32, np.dtype("<f4"), 2),
    "light_change": Plane(64, np.dtype("<f4"), 4),
    "coverage": Plane(128, np.dtype("<f4"), 1),
}


def zstd() -> ModuleType | None:
    """A module that unpacks zstd: Python 3.14's own, or zstandard; None: planes are sent as they are."""
    try:
        from compression import zstd as own  # type: ignore
        return own  # type: ignore[no-any-return]
    except ImportError:
        pass
    try:
        import zstandard
        return zstandard
    except ImportError:
        return None


def empty(width: int, height: int, bits: int) -> dict[str, Array]:
    """Arrays for the planes of these bits: (height, width, n), or (height, width) if a pixel has one number."""
    return {name: np.empty((height, width, plane.n) if plane.n > 1 else (height, width), plane.dtype)
            for name, plane in PLANES.items() if bits & plane.bit}


def views(planes: dict[str, Array]) -> list[memoryview]:
    """The memory of the planes, one after the other, as ENCODING_RAW sends them."""
    return [array.reshape(-1).view("u1").data for array in planes.values()]


def _unpacker(module: ModuleType) -> Any:
    if hasattr(module, "ZstdDecompressor") and hasattr(module, "frame_content_size"):
        made = module.ZstdDecompressor()

        def unpack(data: memoryview, size: int) -> bytes:
            if module.frame_content_size(data) != size:
                raise Malformed("a strip has another size than its pixels")
            return bytes(made.decompress(data))
        return unpack

    def unpack_own(data: memoryview, size: int) -> bytes:
        one = module.ZstdDecompressor()
        out = bytes(one.decompress(data, size + 1))
        if not one.eof or one.unused_data:
            raise Malformed("a strip is not one zstd frame")
        return out
    return unpack_own


def unpack_zstd(module: ModuleType, data: bytearray, width: int, height: int, planes: dict[str, Array]) -> None:
    """Fills the planes from the data of ENCODING_ZSTD. Malformed: it does not agree with them."""
    strips = []
    for name, array in planes.items():
        pixel = PLANES[name].dtype.itemsize * PLANES[name].n
        rows = max(1, STRIP_BYTES // (width * pixel))
        flat = array.reshape(-1).view("u1").reshape(height * width, pixel)
        strips += [(flat[y * width:min(height, y + rows) * width], name) for y in range(0, height, rows)]
    at = 4 * len(strips)
    if len(data) < at:
        raise Malformed("the table of strips is cut off")
    lengths = np.frombuffer(data, "<u4", len(strips)).tolist()
    if at + sum(lengths) != len(data):
        raise Malformed("the strips do not fill the data")
    unpack, view = _unpacker(module), memoryview(data)
    for (pixels, name), length in zip(strips, lengths):
        try:
            raw = np.frombuffer(unpack(view[at:at + length], pixels.size), "u1")
        except Malformed:
            raise
        except Exception as wrong:  # each module has exceptions of its own
            raise Malformed(f"a strip cannot be unpacked: {wrong}") from None
        if raw.size != pixels.size:
            raise Malformed("a strip has another size than its pixels")
        pixels[:] = raw.reshape(pixels.shape) if name == "colour" else raw.reshape(pixels.shape[::-1]).T
        at += length

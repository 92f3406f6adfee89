"""Frames: pictures and planes, with what the daemon tells about them."""
from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from sheen import messages
from sheen.errors import BadArgument, BadImage
from sheen.planes import Array
from sheen.protobuf import Malformed
from sheen.scene import Camera, Light, Lines, name_of
from sheen.values import Vec3, tuple_of

UP_SOURCES = ("given", "file", "guessed")
ENDINGS = {"png": (".png",), "exr": (".exr",), "jpeg": (".jpg", ".jpeg"), "tiff": (".tif", ".tiff")}


def _chunk(kind: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def png_of(colour: npt.NDArray[np.uint8]) -> bytes:
    """A PNG file of an array (height, width, 4) of sRGB with straight alpha."""
    height, width, _ = colour.shape
    rows = np.zeros((height, 1 + 4 * width), "u1")  # each row begins with the number of its filter, 0
    rows[:, 1:] = colour.reshape(height, 4 * width)
    return (b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)) +
            _chunk(b"sRGB", b"\0") + _chunk(b"IDAT", zlib.compress(rows.tobytes(), 4)) + _chunk(b"IEND", b""))


@dataclass(frozen=True)
class Extreme:
    """The least or greatest value of false colour, and its place, if it is not the same everywhere."""
    value: float
    pixel: tuple[int, int] | None
    position: Vec3 | None
    face: int | None
    u: float | None
    v: float | None

    @staticmethod
    def of(body: messages.Extreme) -> Extreme:
        has_place = body.x_px is not None and body.y_px is not None and body.position is not None
        return Extreme(body.value, (body.x_px or 0, body.y_px or 0) if has_place else None,
                       tuple_of(body.position) if body.position else None, body.face, body.u, body.v)


@dataclass
class Frame:
    """A frame. Planes are arrays of (height, width) or (height, width, n), C order, top row first, which the program
    owns. `file`: the bytes of a picture, if a format of files was asked for. `camera`, `lights`, `lines` are those that
    were used; `times` are microseconds."""
    width: int
    height: int
    planes: dict[str, Array] = field(repr=False)
    file: bytes | None = field(repr=False)
    format: str
    camera: Camera
    lights: list[Light] = field(repr=False)
    lines: Lines = field(repr=False)
    times: messages.Times = field(repr=False)
    device: str
    driver: str
    server: str
    software: bool
    threads: int
    blank: bool  # no pixel shows the model
    light_share: float | None  # of the visible surface: where a light is met
    up: Vec3 | None
    up_source: str | None
    show_range: float | None
    show_least: Extreme | None
    show_greatest: Extreme | None

    @staticmethod
    def of(body: messages.Frame, planes: dict[str, Array], file: bytes | None, format: str) -> Frame:
        """Malformed: the FRAME lacks a field that it must have."""
        if not body.lights:
            raise Malformed("a frame has no light")
        return Frame(
            body.width_px, body.height_px, planes, file, format, Camera.of(body.camera),
            [Light.of(light) for light in body.lights], Lines.of(body.lines), body.times, body.device, body.driver,
            body.server, body.software, body.threads or 0, bool(body.blank), body.light_share,
            tuple_of(body.up) if body.up else None,
            None if body.up_source is None else name_of(UP_SOURCES, body.up_source, "up_source"), body.show_range,
            Extreme.of(body.show_least) if body.show_least else None,
            Extreme.of(body.show_greatest) if body.show_greatest else None)

    def _plane(self, name: str) -> Array:
        try:
            return self.planes[name]
        except KeyError:
            raise AttributeError(f"the plane '{name}' was not asked for: render(planes=('{name}', ...))") from None

    @property
    def colour(self) -> npt.NDArray[np.uint8]:
        """(height, width, 4): R, G, B, A as displayed (sRGB), straight alpha."""
        return self._plane("colour")

    @property
    def position(self) -> npt.NDArray[np.float32]:
        """(height, width, 3): the point at the pixel's centre; NaN where nothing is hit."""
        return self._plane("position")

    @property
    def normal(self) -> npt.NDArray[np.float32]:
        """(height, width, 3), of length 1."""
        return self._plane("normal")

    @property
    def ptex(self) -> Array:
        """(height, width), structured: face (0xffffffff: nothing is hit), u, v."""
        return self._plane("ptex")

    @property
    def light(self) -> npt.NDArray[np.float32]:
        """(height, width, 2): s and t on the first light; NaN where it is not met."""
        return self._plane("light")

    @property
    def curvature(self) -> npt.NDArray[np.float32]:
        """(height, width, 2): the principal curvatures k.min and k.max."""
        return self._plane("curvature")

    @property
    def light_change(self) -> npt.NDArray[np.float32]:
        """(height, width, 4): ds/dx, ds/dy, dt/dx, dt/dy for a pixel to the right and down."""
        return self._plane("light_change")

    @property
    def coverage(self) -> npt.NDArray[np.float32]:
        """(height, width): the share of the pixel that shows surface."""
        return self._plane("coverage")

    @property
    def hit(self) -> npt.NDArray[np.bool_]:
        """(height, width): does the pixel's centre show surface?"""
        if "ptex" in self.planes:
            return np.asarray(self.ptex["face"] != 0xffffffff)
        return np.asarray(~np.isnan(self.position[..., 0]))

    def __array__(self, dtype: Any = None) -> Array:
        return self.colour if dtype is None else self.colour.astype(dtype)

    def _repr_png_(self) -> bytes | None:
        """The picture in a notebook."""
        if self.format == "png":
            return self.file
        return png_of(self.colour) if "colour" in self.planes else None

    def save(self, path: str | Path) -> None:
        """Writes the picture: the file that was asked for, or a PNG of the colour plane."""
        ending = Path(path).suffix.lower()
        if self.file is not None and ending in ENDINGS[self.format]:
            data: bytes | None = self.file
        else:
            data = self._repr_png_() if ending == ".png" else None
        if data is None:
            raise BadArgument(f"{path}: this frame has no such picture: render(format='png'), 'exr', 'jpeg' or 'tiff'")
        try:
            Path(path).write_bytes(data)
        except OSError as wrong:
            raise BadImage(f"{path}: cannot be written: {wrong.strerror}") from None

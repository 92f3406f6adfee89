"""Lines on the surface as curves: the answer of Session.lines() (protocol/README.md, "TRACE_LINES")."""
from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sheen import messages
from sheen.planes import Array
from sheen.protobuf import Malformed
from sheen.scene import Camera, Light, Lines

KINDS = ("line", "silhouette")
MARKS = ("singular", "flat")
CURVE = np.dtype([("kind", "u1"), ("closed", "u1"), ("light", "<u2"), ("line", "<u4"), ("place", "<f8"),
                  ("points", "<u8"), ("length", "<f8")])
POINT = np.dtype([("face", "<u4"), ("reserved", "<u4"), ("uv", "<f8", 2), ("position", "<f8", 3), ("normal", "<f8", 3),
                  ("along", "<f8", 3), ("residual", "<f8"), ("length", "<f8")])
MARK = np.dtype([("kind", "u1"), ("reserved", "u1"), ("light", "<u2"), ("line", "<u4"), ("face", "<u4"),
                 ("reserved_too", "<u4"), ("uv", "<f8", 2), ("position", "<f8", 3), ("normal", "<f8", 3)])


@dataclass(frozen=True)
class Curve:
    """A polyline on the surface. `points` is an array with the fields face, uv, position, normal, along (the tangent),
    residual and length (from the first point)."""
    points: Array = field(repr=False)
    kind: str  # line or silhouette
    closed: bool
    light: int
    line: int  # of all lines of all lights
    place: float  # on the light; NaN for a silhouette
    length: float


@dataclass(frozen=True)
class Curves:
    """`marks`: an array of the places where curves of one line meet, or a curve is a point (kind 0), or a line covers a part
    of the surface (kind 1)."""
    curves: list[Curve] = field(repr=False)
    marks: Array = field(repr=False)
    tolerance: float
    diagonal: float  # of the model's box
    total_us: int
    camera: Camera = field(repr=False)
    lights: list[Light] = field(repr=False)
    lines: Lines = field(repr=False)

    def __len__(self) -> int:
        return len(self.curves)

    @staticmethod
    def data_bytes(body: messages.Curves) -> int:
        """The size of the records; Malformed: the message says another."""
        size = body.curves * CURVE.itemsize + body.points * POINT.itemsize + body.marks * MARK.itemsize
        if size != body.data_bytes:
            raise Malformed(f"{body.data_bytes} bytes are not {body.curves} curves, {body.points} points and {body.marks} "
                            "marks")
        return size

    @staticmethod
    def of(body: messages.Curves, data: bytearray) -> Curves:
        """Malformed: a record has a value that it cannot have."""
        heads = np.frombuffer(data, CURVE, body.curves)
        points = np.frombuffer(data, POINT, body.points, heads.nbytes)
        marks = np.frombuffer(data, MARK, body.marks, heads.nbytes + points.nbytes)
        ends = np.cumsum(heads["points"].astype(object)) if body.curves else []
        if (heads["kind"] >= len(KINDS)).any() or (marks["kind"] >= len(MARKS)).any():
            raise Malformed("a record has a kind that does not exist")
        if (ends[-1] if body.curves else 0) != body.points:
            raise Malformed("the curves have another number of points")
        curves = [Curve(points[int(end - head["points"]):int(end)], KINDS[head["kind"]], bool(head["closed"]),
                        int(head["light"]), int(head["line"]), float(head["place"]), float(head["length"]))
                  for head, end in zip(heads, ends)]
        return Curves(curves, marks, body.tolerance, body.diagonal, body.total_us, Camera.of(body.camera),
                      [Light.of(light) for light in body.lights], Lines.of(body.lines))

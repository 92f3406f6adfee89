"""How far two surfaces differ: the answer of Session.compare() (protocol/README.md, "COMPARE")."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypedDict

import numpy as np

from sheen import messages
from sheen.planes import Array
from sheen.scene import Camera, Light, Lines
from sheen.values import Vec3, tuple_of

MEASURES = ("distance", "normal_deg", "lines", "line_length", "curvature")


class Limits(TypedDict, total=False):
    """Beyond which a measure counts as out; each has a default of the daemon, and some are off without a limit."""
    distance: float  # units
    normal_deg: float
    lines: float  # shift of the lines in spacings
    line_length: float  # the same as a length on the surface
    curvature: float  # share of the curvature


@dataclass(frozen=True)
class Place:
    face: int  # Ptex
    u: float
    v: float
    position: Vec3

    @staticmethod
    def of(body: messages.ComparedPlace) -> Place:
        return Place(body.face, body.u, body.v, tuple_of(body.position))


@dataclass(frozen=True)
class Measure:
    """A measure over the samples of one surface. `worst` is the value of the largest magnitude, at `old` and `new`."""
    worst: float
    old: Place
    new: Place
    rms: float  # over the area
    p95: float
    p99: float
    area_out: float  # beyond the limit

    @staticmethod
    def of(body: messages.ComparedMeasure) -> Measure:
        return Measure(body.worst, Place.of(body.old), Place.of(body.new), body.rms, body.p95, body.p99, body.area_out)


@dataclass(frozen=True)
class Side:
    """What the samples of one surface found on the other one. A measure without a value anywhere is None."""
    samples: int
    area: float
    area_uncovered: float  # where the other surface is missing
    area_rewound: float
    area_unlit: float
    uncovered: Place | None
    distance: Measure | None
    normal_deg: Measure | None
    lines: Measure | None
    line_length: Measure | None
    curvature: Measure | None

    @property
    def measures(self) -> dict[str, Measure]:
        """Those that have a value, by their names."""
        found = {name: getattr(self, name) for name in MEASURES}
        return {name: measure for name, measure in found.items() if measure is not None}

    @staticmethod
    def of(body: messages.ComparedSide) -> Side:
        def measure(one: messages.ComparedMeasure | None) -> Measure | None:
            return None if one is None else Measure.of(one)

        return Side(body.samples, body.area, body.area_uncovered, body.area_rewound, body.area_unlit,
                    None if body.uncovered is None else Place.of(body.uncovered), measure(body.distance),
                    measure(body.normal_deg), measure(body.lines), measure(body.line_length), measure(body.curvature))


@dataclass(frozen=True)
class Alignment:
    """The rigid motion that was applied to the new surface: first the rotation (3, 3), then the shift (3,)."""
    rotation: Array
    shift: Array
    rotation_deg: float
    rms_before: float  # of the distances
    rms_after: float

    @staticmethod
    def of(body: messages.Alignment) -> Alignment:
        rows = [tuple_of(row) for row in (body.x, body.y, body.z)]
        return Alignment(np.array(rows), np.array(tuple_of(body.shift)), body.rotation_deg, body.rms_before,
                         body.rms_after)


@dataclass(frozen=True)
class Comparison:
    """`old` and `new`: what the samples of each surface found on the other one. `limits`: as they were used."""
    old: Side
    new: Side
    limits: Limits
    rewound: bool  # the new surface as a whole is wound the other way around
    diagonal: float  # of the old model's box
    distance_floor: float  # rounding of the tables
    normal_floor_deg: float
    alignment: Alignment | None
    total_us: int
    camera: Camera = field(repr=False)
    lights: list[Light] = field(repr=False)
    lines: Lines = field(repr=False)

    @property
    def differs(self) -> bool:
        """True if a measure is out of its limit anywhere, or a part of a surface is missing on the other one."""
        return any(side.area_uncovered > 0 or any(measure.area_out > 0 for measure in side.measures.values())
                   for side in (self.old, self.new))

    def worst(self, name: str) -> Measure | None:
        """A measure of the side whose worst value has the larger magnitude."""
        found = [measure for side in (self.old, self.new) if (measure := side.measures.get(name)) is not None]
        return max(found, key=lambda measure: abs(measure.worst)) if found else None

    @staticmethod
    def of(body: messages.Compared) -> Comparison:
        limits: Limits = {"distance": body.distance, "normal_deg": body.normal_deg, "lines": body.lines}
        if body.line_length is not None:
            limits["line_length"] = body.line_length
        if body.curvature is not None:
            limits["curvature"] = body.curvature
        return Comparison(Side.of(body.old), Side.of(body.new), limits, body.rewound, body.diagonal, body.distance_floor,
                          body.normal_floor_deg, None if body.alignment is None else Alignment.of(body.alignment),
                          body.total_us, Camera.of(body.camera), [Light.of(light) for light in body.lights],
                          Lines.of(body.lines_used))

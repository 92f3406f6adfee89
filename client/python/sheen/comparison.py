"""How far two surfaces differ: the answer of Session.compare() (protocol/README.md, "COMPARE")."""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Tuple, TypedDict, Union

import numpy as np

from sheen import messages
from sheen.errors import BadArgument
from sheen.planes import Array
from sheen.scene import Camera, Light, Lines
from sheen.values import Vec3, tuple_of

MEASURES = ("distance", "normal_deg", "lines", "line_length", "curvature")


# A limit; "0.05@0.1%" or (0.05, 0.001) with the share of the area that may exceed it; "off": the measure is not judged.
Limit = Union[float, str, Tuple[float, float]]


class Limits(TypedDict, total=False):
    """Beyond which a measure counts as out; each has a default, and some are off without a limit."""
    distance: Limit  # units
    normal_deg: Limit
    lines: Limit  # shift of the lines in spacings
    line_length: Limit  # the same as a length on the surface
    curvature: Limit  # share of the curvature
    uncovered_area: Limit  # square units, of both sides together
    rotation_deg: Limit  # with align, of its rotation; it has no share


class Allowed(NamedTuple):
    """A limit that was read. `value` is None for the default."""
    value: float | None = None
    share: float = 0.0
    is_off: bool = False


def read_limit(name: str, given: Any) -> Allowed:
    """Reads a Limit, or None for the default. Raises BadArgument for what is no limit. The daemon checks the ranges of its measures."""
    if given is None:
        return Allowed()
    try:
        if given == "off":
            return Allowed(is_off=True)
        share = 0.0
        if isinstance(given, str):
            number, at, percent = given.partition("@")
            if at and not percent.endswith("%"):
                raise ValueError
            value, share = float(number), float(percent[:-1]) / 100 if at else 0.0
        elif isinstance(given, tuple):
            value, share = (float(each) for each in given)
        else:
            value = float(given)
        is_own = name in ("uncovered_area", "rotation_deg")
        if not 0 <= share <= 1 or (share and name == "rotation_deg") or (is_own and not 0 <= value < math.inf):
            raise ValueError
    except (TypeError, ValueError):
        raise BadArgument(f"limits[{name!r}]: {given!r} is no number, no pair (number, share) with a share from 0 to 1, "
                          "and no text as '0.05', '0.05@0.1%' or 'off'") from None
    return Allowed(value, share)


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
    free_directions: int  # of 6, in which the surface slides along itself: no motion in them was looked for

    @staticmethod
    def of(body: messages.Alignment) -> Alignment:
        rows = [tuple_of(row) for row in (body.x, body.y, body.z)]
        return Alignment(np.array(rows), np.array(tuple_of(body.shift)), body.rotation_deg, body.rms_before,
                         body.rms_after, body.free or 0)


@dataclass(frozen=True)
class Comparison:
    """`old` and `new`: what the samples of each surface found on the other one. `limits`: as they were used."""
    old: Side
    new: Side
    limits: dict[str, float]
    rewound: bool  # the new surface as a whole is wound the other way around
    diagonal: float  # of the old model's box
    distance_floor: float  # rounding of the tables
    normal_floor_deg: float
    alignment: Alignment | None
    total_us: int
    camera: Camera = field(repr=False)
    lights: list[Light] = field(repr=False)
    lines: Lines = field(repr=False)
    allowed: dict[str, Allowed] = field(repr=False, default_factory=dict)

    @property
    def out(self) -> list[str]:
        """The measures that exceed their limits, by the rules of `sheen compare`: without a share one place decides, with
        a share more of the area than that."""
        return [name for name in Limits.__annotations__ if self._is_out(name)]

    @property
    def differs(self) -> bool:
        """True if a measure is out; the verdict of `sheen compare`."""
        return bool(self.out)

    @property
    def identical(self) -> bool:
        """True if no measure that was compared differs from 0."""
        return not any(self.value(name) for name in Limits.__annotations__)

    def value(self, name: str) -> float | None:
        """The value of a measure that is judged, over both sides; None: it has none."""
        if name == "uncovered_area":
            return self.old.area_uncovered + self.new.area_uncovered
        if name == "rotation_deg":
            return None if self.alignment is None else self.alignment.rotation_deg
        worst = self.worst(name)
        return None if worst is None else worst.worst

    def share_out(self, name: str) -> float:
        """The share of the area that is beyond the limit of a measure, of both sides the larger one."""
        most = 0.0
        for side in (self.old, self.new):
            measure = side.measures.get(name)
            area = side.area_uncovered if name == "uncovered_area" else measure.area_out if measure else 0.0
            if side.area > 0:
                most = max(most, area / side.area)
        return most

    def _is_out(self, name: str) -> bool:
        allowed, value = self.allowed.get(name, Allowed()), self.value(name)
        if allowed.is_off or value is None or not abs(value) > self.limits.get(name, math.inf):
            return False
        return allowed.share == 0 or self.share_out(name) > allowed.share

    def worst(self, name: str) -> Measure | None:
        """A measure of the side whose worst value has the larger magnitude."""
        found = [measure for side in (self.old, self.new) if (measure := side.measures.get(name)) is not None]
        return max(found, key=lambda measure: abs(measure.worst)) if found else None

    @staticmethod
    def of(body: messages.Compared, allowed: dict[str, Allowed]) -> Comparison:
        limits = {"distance": body.distance, "normal_deg": body.normal_deg, "lines": body.lines}
        for name, default in (("uncovered_area", 0.0), ("rotation_deg", 1.0)):
            value = allowed[name].value
            limits[name] = default if value is None else value
        if body.line_length is not None:
            limits["line_length"] = body.line_length
        if body.curvature is not None:
            limits["curvature"] = body.curvature
        return Comparison(Side.of(body.old), Side.of(body.new), limits, body.rewound, body.diagonal, body.distance_floor,
                          body.normal_floor_deg, None if body.alignment is None else Alignment.of(body.alignment),
                          body.total_us, Camera.of(body.camera), [Light.of(light) for light in body.lights],
                          Lines.of(body.lines_used), allowed)

"""The numbers of the surface at a pixel of a picture, or along a line in it."""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Sequence

import numpy as np

from sheen.frame import Frame
from sheen.planes import Array
from sheen.values import Vec3

PLANES = ("position", "normal", "ptex", "light", "curvature")


@dataclass(frozen=True)
class Pick:
    """A place of a picture, in pixels. All else is None where no surface is visible; `normal` and curvatures also where
    the surface has no normal, and `light` where the first light is not met."""
    x: float
    y: float
    point: Vec3 | None = None
    normal: Vec3 | None = None
    curvature: tuple[float, float] | None = None  # k.min, k.max
    face: int | None = None  # Ptex
    u: float | None = None
    v: float | None = None
    light: tuple[float, float] | None = None  # s, t

    @property
    def hit(self) -> bool:
        return self.point is not None

    @property
    def mean_curvature(self) -> float | None:
        return None if self.curvature is None else 0.5 * (self.curvature[0] + self.curvature[1])

    @property
    def gaussian_curvature(self) -> float | None:
        return None if self.curvature is None else self.curvature[0] * self.curvature[1]

    @property
    def radius(self) -> float | None:
        """The smallest radius of curvature in any direction; infinite where the surface is flat."""
        if self.curvature is None:
            return None
        most = max(abs(self.curvature[0]), abs(self.curvature[1]))
        return 1 / most if most else math.inf

    @staticmethod
    def of(x: float, y: float, frame: Frame) -> Pick:
        """A frame of one pixel."""
        if not frame.hit[0, 0]:
            return Pick(x, y)
        px, py, pz = frame.position[0, 0].tolist()
        nx, ny, nz = frame.normal[0, 0].tolist()
        least, greatest = frame.curvature[0, 0].tolist()
        face, u, v = frame.ptex[0, 0].tolist()
        s, t = frame.light[0, 0].tolist()
        return Pick(x, y, (px, py, pz), None if math.isnan(nx) else (nx, ny, nz),
                    None if math.isnan(least) else (least, greatest), face, u, v, None if math.isnan(s) else (s, t))


@dataclass(frozen=True)
class Section:
    """Places along a line, as arrays whose first index is the place; NaN where there is no number."""
    x: Array = field(repr=False)
    y: Array = field(repr=False)
    position: Array = field(repr=False)  # (n, 3)
    normal: Array = field(repr=False)  # (n, 3)
    curvature: Array = field(repr=False)  # (n, 2)
    ptex: Array = field(repr=False)  # (n,), structured
    light: Array = field(repr=False)  # (n, 2)

    @property
    def hit(self) -> Array:
        return np.asarray(self.ptex["face"] != 0xffffffff)

    def __str__(self) -> str:
        """All places as a table, with dashes where there is no number."""
        def text(*values: float) -> str:
            return "".join(f"{'-' if math.isnan(value) else f'{value:.6g}':>13}" for value in values)

        names = ("x", "y", "point.x", "point.y", "point.z", "k.min", "k.max", "light.s", "light.t")
        rows = [text(self.x[i], self.y[i], *self.position[i], *self.curvature[i], *self.light[i]) for i in range(len(self.x))]
        return "\n".join(["".join(f"{name:>13}" for name in names), *rows])

    @staticmethod
    def of(places: Sequence[tuple[float, float]], frames: Sequence[Frame]) -> Section:
        def all_of(name: str) -> Array:
            return np.stack([frame.planes[name][0, 0] for frame in frames])

        x, y = np.array(places, "f8").T
        return Section(x, y, all_of("position"), all_of("normal"), all_of("curvature"), all_of("ptex"), all_of("light"))

"""Where lines on the surface break: the answer of Session.breaks() (protocol/README.md, "FIND_BREAKS")."""
from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sheen import messages
from sheen.planes import Array
from sheen.protobuf import Malformed
from sheen.scene import Camera, Light, Lines

MEASURES = ("gap", "angle", "curvature", "percent", "kink", "jump")
KINDS = ("crease", "semisharp", "joint")
# The worst value of a measure along an edge, where that is (0 to 1), and the position.
WORST = np.dtype([("value", "<f8"), ("at", "<f8"), ("position", "<f8", 3)])
EDGE = np.dtype([("faces", "<u4", 2), ("edges", "u1", 2), ("kind", "u1"), ("over", "u1"), ("kink_light", "u1"),
                 ("jump_light", "u1"), ("dart", "u1"), ("reserved", "u1"), ("length", "<f8"), ("out", "<f8"),
                 *((name, WORST) for name in MEASURES), ("shift", "<f8")])
VERTEX = np.dtype([("face", "<u4"), ("corner", "u1"), ("inside", "u1"), ("faces", "<u2"), ("radius", "<f8"),
                   ("curvature", "<f8", 2), ("position", "<f8", 3)])


@dataclass(frozen=True)
class Breaks:
    """`edges`: an array with a record for each edge, the worst first; those over a limit are the first `edges_out`.
    `vertices`: one for each extraordinary vertex. The fields are those of the protocol, for example
    edges["angle"]["value"] (degrees) and edges["angle"]["position"]; NaN where a measure has no value."""
    edges: Array = field(repr=False)
    vertices: Array = field(repr=False)
    edges_out: int
    out_length: float  # of the parts of edges over a limit
    gap: float  # limits, as used
    angle_deg: float
    curvature_percent: float
    creases: int
    semisharp: int
    joints: int
    borders: int
    creases_length: float
    borders_length: float
    diagonal: float  # of the model's box
    total_us: int
    camera: Camera = field(repr=False)
    lights: list[Light] = field(repr=False)
    lines: Lines = field(repr=False)

    def __bool__(self) -> bool:
        """True if an edge is out of tolerance."""
        return self.edges_out > 0

    @property
    def within(self) -> bool:
        """True if no edge is out of tolerance."""
        return self.edges_out == 0

    def __str__(self) -> str:
        return (f"{len(self.edges)} edges ({self.creases} creases, {self.semisharp} semi-sharp, {self.joints} joints), "
                f"{self.edges_out} out of tolerance on {self.out_length:.4g} units; {self.borders} borders, "
                f"{len(self.vertices)} extraordinary vertices")

    @staticmethod
    def data_bytes(body: messages.Breaks) -> int:
        """The size of the records; Malformed: the message says another."""
        size = body.edges * EDGE.itemsize + body.vertices * VERTEX.itemsize
        if size != body.data_bytes or body.edges_out > body.edges:
            raise Malformed(f"{body.data_bytes} bytes are not {body.edges} edges and {body.vertices} vertices")
        return size

    @staticmethod
    def of(body: messages.Breaks, data: bytearray) -> Breaks:
        """Malformed: a record has a value that it cannot have."""
        edges = np.frombuffer(data, EDGE, body.edges)
        vertices = np.frombuffer(data, VERTEX, body.vertices, body.edges * EDGE.itemsize)
        if (edges["kind"] >= len(KINDS)).any() or (edges["edges"] > 3).any() or (vertices["corner"] > 3).any():
            raise Malformed("a record has a kind, an edge or a corner that does not exist")
        return Breaks(edges, vertices, body.edges_out, body.out_length, body.gap, body.angle_deg,
                      body.curvature_percent, body.creases, body.semisharp, body.joints, body.borders,
                      body.creases_length, body.borders_length, body.diagonal, body.total_us, Camera.of(body.camera),
                      [Light.of(light) for light in body.lights], Lines.of(body.lines))

"""sheen: exact reflection lines on subdivision surfaces, as numpy arrays.

    import sheen
    with sheen.connect() as session:                       # $SHEEN_SERVER, else a private sheend
        hood = session.upload("hood.obj")
        frame = session.render(hood, size=(1280, 720), planes=("colour", "position", "normal"))
        frame.normal                                       # (720, 1280, 3) float32, NaN where nothing is hit
        session.render(hood, camera=frame.camera.orbit(10), lines="zebra").save("zebra.png")

The package speaks to the daemon by its protocol (protocol/README.md of the sources), without the C library."""
from __future__ import annotations

from typing import Unpack

from sheen.breaks import Breaks
from sheen.comparison import Comparison, Limits
from sheen.curves import Curve, Curves
from sheen.errors import (BadArgument, BadImage, BadModel, BadPeer, BadRequest, BadVersion, Cancelled, DeviceFailed,
                          Error, GpuLost, Late, Lost, NoServer, Overloaded, ShuttingDown, Superseded, Timeout, TooBig,
                          UnknownModel)
from sheen.frame import Extreme, Frame
from sheen.messages import HelloOk, ModelInfo, Stats, Times
from sheen.options import Options
from sheen.picks import Pick, Section
from sheen.planes import PLANES
from sheen.scene import Camera, Light, Lines, Pattern
from sheen.session import Model, PathOrBytes, Session
from sheen.version import __version__

connect = Session


def compare(old: PathOrBytes, new: PathOrBytes, *, limits: Limits | None = None, align: bool = False,
            samples: int | None = None, **options: Unpack[Options]) -> Comparison:
    """Session.compare() of two files, in a session of its own."""
    with Session() as session:
        return session.compare(old, new, limits=limits, align=align, samples=samples, **options)

__all__ = ["BadArgument", "BadImage", "BadModel", "BadPeer", "BadRequest", "BadVersion", "Breaks", "Camera",
           "Cancelled", "Comparison", "Curve", "Curves", "DeviceFailed", "Error", "Extreme", "Frame", "GpuLost",
           "HelloOk", "Late", "Light", "Limits", "Lines", "Lost", "Model", "ModelInfo", "NoServer", "Options",
           "Overloaded", "PLANES", "Pattern", "Pick", "Section", "Session", "ShuttingDown", "Stats", "Superseded",
           "Timeout", "Times", "TooBig", "UnknownModel", "__version__", "compare", "connect"]

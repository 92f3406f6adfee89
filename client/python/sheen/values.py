"""Values of options, as numbers and sequences or in the words of the `sheen` command."""
from __future__ import annotations

import math
from typing import Any, Sequence, Union

from sheen.errors import BadArgument
from sheen.messages import Colour as ColourMessage
from sheen.messages import Vec3 as Vec3Message

Vec3 = tuple[float, float, float]
Vector = Union[str, Sequence[float]]  # (1, 0, 0) or "1,0,0"; a direction may be "x" or "-z"
Colour = Union[str, Sequence[float]]  # "#rrggbb", "#rrggbbaa", or r, g, b and perhaps a from 0 to 1
Size = Union[str, tuple[int, int]]  # (1280, 720) or "1280x720"


def number(value: str | float, name: str) -> float:
    try:
        found = float(value)
    except (TypeError, ValueError):
        raise BadArgument(f"{name} is {value!r}; it must be a number") from None
    if not math.isfinite(found):
        raise BadArgument(f"{name} is {found}; it must be a finite number")
    return found


def whole(value: str | int, name: str) -> int:
    try:
        found = int(value)
        if found != float(value) or found < 0:
            raise ValueError
    except (TypeError, ValueError, OverflowError):
        raise BadArgument(f"{name} is {value!r}; it must be a whole number") from None
    return found


def number_or_none(value: str | float | None, name: str) -> float | None:
    return None if value is None else number(value, name)


def numbers(value: str | float | Sequence[float], name: str) -> list[float]:
    """The numbers of a sequence, of a text with commas between, or one number."""
    if isinstance(value, str):
        return [number(part, name) for part in value.split(",")]
    try:
        parts = list(value)  # type: ignore[arg-type]
    except TypeError:
        return [number(value, name)]  # type: ignore[arg-type]
    return [number(part, name) for part in parts]


def place(value: Sequence[float], name: str) -> tuple[float, float]:
    """A place of a picture."""
    parts = numbers(value, name)
    if len(parts) != 2:
        raise BadArgument(f"{name} is {value!r}; it must be two numbers")
    return parts[0], parts[1]


def vector(value: Vector, name: str) -> Vec3:
    parts = numbers(value, name)
    if len(parts) != 3:
        raise BadArgument(f"{name} is {value!r}; it must be three numbers")
    return parts[0], parts[1], parts[2]


def direction(value: Vector, name: str) -> Vec3:
    if isinstance(value, str) and value.lstrip("+-") in ("x", "y", "z") and len(value) <= 2:
        x, y, z = ((-1.0 if value[0] == "-" else 1.0) if axis == value[-1] else 0.0 for axis in "xyz")
        return x, y, z
    found = vector(value, name)
    if max(abs(part) for part in found) < 1e-30:
        raise BadArgument(f"{name} is {value!r}, no direction")
    return found


def colour(value: Colour, name: str) -> ColourMessage:
    if isinstance(value, str):
        digits = value[1:]
        if value[:1] != "#" or len(digits) not in (6, 8) or set(digits) - set("0123456789abcdefABCDEF"):
            raise BadArgument(f"{name} is {value!r}; it must be #rrggbb or #rrggbbaa")
        parts = [int(digits[i:i + 2], 16) / 255 for i in range(0, len(digits), 2)]
    else:
        parts = numbers(value, name)
    if len(parts) not in (3, 4):
        raise BadArgument(f"{name} has {len(parts)} parts; it must have 3 or 4")
    r, g, b, a = parts if len(parts) == 4 else [*parts, 1.0]
    return ColourMessage(r=r, g=g, b=b, a=a)


def size(value: Size) -> tuple[int, int]:
    try:
        given: Sequence[Any] = value.split("x") if isinstance(value, str) else value
        parts = [whole(part, "size") for part in given]
    except TypeError:
        parts = []
    if len(parts) != 2:
        raise BadArgument(f"size is {value!r}; it must be WIDTHxHEIGHT")
    return parts[0], parts[1]


def word(value: str, words: Sequence[str], name: str) -> int:
    """The word's number in a list."""
    try:
        return words.index(value)
    except ValueError:
        raise BadArgument(f"{name} is {value!r}; it must be {', '.join(words[:-1])} or {words[-1]}") from None


def message(v: Vec3) -> Vec3Message:
    return Vec3Message(x=v[0], y=v[1], z=v[2])


def tuple_of(v: Vec3Message) -> Vec3:
    return v.x, v.y, v.z

"""What a frame shows: camera, lights, patterns and lines, as frozen dataclasses that a program can change by replace().

Units are those of the model's file, angles are degrees. The daemon checks the ranges of numbers."""
from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any, Sequence, TypeVar, Union

from sheen import messages
from sheen.errors import BadArgument
from sheen.protobuf import Malformed, need
from sheen.values import Colour, Vec3, Vector, colour, direction, message, number, tuple_of, vector, word

FAMILIES = ("reflection", "highlight", "isophote", "zebra", "environment")
LIGHTS = ("rectangle", "plane", "tunnel", "sphere")
PATTERNS = ("stripes", "lattice", "circles", "image", "lines", "rainbow", "distance")
VIEWS = ("around", "front", "back", "left", "right", "top", "bottom", "iso")

T = TypeVar("T", bound="Replaceable")


def name_of(words: Sequence[str], value: int, what: str) -> str:
    """The word of an enum's number in an answer."""
    if value >= len(words):
        raise Malformed(f"{what} is {value}; it must be from 0 to {len(words) - 1}")
    return words[value]


class Replaceable:
    def replace(self: T, **changes: Any) -> T:
        """A copy with these members changed."""
        return dataclasses.replace(self, **changes)


def _unit(a: Vec3) -> Vec3:
    length = math.hypot(*a)
    return a[0] / length, a[1] / length, a[2] / length


def _turn(v: Vec3, axis: Vec3, angle: float) -> Vec3:
    """Rodrigues' rotation about an axis of length 1."""
    along = sum(a * b for a, b in zip(axis, v))
    across = [axis[(i + 1) % 3] * v[(i + 2) % 3] - axis[(i + 2) % 3] * v[(i + 1) % 3] for i in range(3)]
    x, y, z = (v[i] * math.cos(angle) + across[i] * math.sin(angle) + axis[i] * along * (1 - math.cos(angle))
               for i in range(3))
    return x, y, z


@dataclass(frozen=True)
class Camera(Replaceable):
    """A whole camera: perspective with `fov_deg`, or orthographic with `ortho_height`."""
    eye: Vec3
    target: Vec3
    up: Vec3 = (0.0, 0.0, 1.0)
    fov_deg: float | None = 35.0
    ortho_height: float | None = None

    def orbit(self, degrees: float, axis: Vector | None = None) -> Camera:
        """The camera turned about the axis (default: up) through the target."""
        upright = _unit(direction(axis if axis is not None else self.up, "axis"))
        x, y, z = (e - t for e, t in zip(self.eye, self.target))
        arm = _turn((x, y, z), upright, math.radians(degrees))
        eye = (self.target[0] + arm[0], self.target[1] + arm[1], self.target[2] + arm[2])
        is_axis = abs(sum(a * b for a, b in zip(_unit(self.up), upright))) >= 1
        return self.replace(eye=eye, up=self.up if is_axis else _turn(self.up, upright, math.radians(degrees)))

    def to_message(self) -> messages.Camera:
        is_ortho = self.ortho_height is not None
        return messages.Camera(eye=message(vector(self.eye, "eye")), target=message(vector(self.target, "target")),
                               up=message(vector(self.up, "up")), fov_deg=None if is_ortho else self.fov_deg,
                               ortho_height=self.ortho_height)

    @staticmethod
    def of(body: messages.Camera) -> Camera:
        """The camera of a FRAME, which is whole."""
        if (body.fov_deg is None) == (body.ortho_height is None):
            raise Malformed("camera has not one of fov_deg and ortho_height")
        return Camera(tuple_of(need(body.eye, "camera.eye")), tuple_of(need(body.target, "camera.target")),
                      tuple_of(need(body.up, "camera.up")), body.fov_deg, body.ortho_height)


@dataclass(frozen=True)
class Pattern(Replaceable):
    """What a light shows; `sheen patterns` explains the parts. `image`: the path of an image's file, or the id of an
    uploaded one."""
    kind: str = "stripes"
    count: float = 40.0
    period: float | None = None
    duty: float = 0.5
    rotation_deg: float = 0.0
    offset: float = 0.0
    soft: float = 0.0
    opacity: float = 1.0
    at: tuple[float, ...] = ()
    width: float = 0.01
    foreground: Colour | None = None
    background: Colour | None = None
    image: str | bytes | None = None

    @staticmethod
    def parse(text: str) -> Pattern:
        """The pattern of a text as --pattern takes it: stripes:count=40,duty=0.3 or image:FILE."""
        kind, _, rest = text.partition(":")
        if kind == "image":
            if not rest:
                raise BadArgument("pattern image: needs the name of a file")
            return Pattern("image", image=rest)
        word(kind, PATTERNS, "pattern")
        named: dict[str, Any] = {"at": (0.5,)} if kind == "lines" else {}
        names = {"rotation": "rotation_deg", "fg": "foreground", "bg": "background"}
        for part in rest.split(",") if rest else ():
            key, equals, value = part.partition("=")
            name = names.get(key, key)
            if not equals or name in ("kind", "image") or name not in Pattern.__dataclass_fields__:
                raise BadArgument(f"pattern {text!r}: there is no part {part!r}; sheen patterns lists them")
            if name == "at":
                named[name] = tuple(number(place, "at") for place in value.split("/"))
            else:
                named[name] = value if name in ("foreground", "background") else number(value, key)
        if "count" in named and "period" in named:
            raise BadArgument("pattern: count and period exclude each other")
        return Pattern(kind, **named)

    def to_message(self, image_id: bytes | None) -> messages.Pattern:
        has_colours = self.foreground is not None or self.background is not None
        is_lines = self.kind == "lines"
        return messages.Pattern(
            kind=word(self.kind, PATTERNS, "pattern"), count=self.count, duty=self.duty, period=self.period,
            rotation_deg=self.rotation_deg, offset=self.offset, soft=self.soft, opacity=self.opacity,
            at=[number(place, "at") for place in self.at], width=self.width if is_lines else None,
            foreground=colour(self.foreground or "#ffffff", "foreground") if has_colours else None,
            background=colour(self.background or "#000000", "background") if has_colours else None,
            image_sha256=image_id)

    @staticmethod
    def of(body: messages.Pattern) -> Pattern:
        def parts(c: messages.Colour | None) -> Colour | None:
            return None if c is None else (c.r, c.g, c.b, c.a)

        def given(value: float | None, default: float) -> float:
            return default if value is None else value

        return Pattern(name_of(PATTERNS, body.kind, "pattern.kind"), given(body.count, 40), body.period or None, given(body.duty, 0.5),
                       given(body.rotation_deg, 0), given(body.offset, 0), given(body.soft, 0),
                       given(body.opacity, 1), tuple(body.at), given(body.width, 0.01), parts(body.foreground),
                       parts(body.background), body.image_sha256)


@dataclass(frozen=True)
class Light(Replaceable):
    """A light. Without `kind` and place it is a tunnel about the model. `centre`, `u` and `v` come together."""
    kind: str | None = None
    centre: Vector | None = None
    u: Vector | None = None
    v: Vector | None = None
    one_sided: bool = False
    pattern: Union[Pattern, str] = Pattern()

    @property
    def whole_pattern(self) -> Pattern:
        return Pattern.parse(self.pattern) if isinstance(self.pattern, str) else self.pattern

    def to_message(self, image_id: bytes | None) -> messages.Light:
        def placed(value: Vector | None, name: str) -> messages.Vec3 | None:
            return None if value is None else message(vector(value, name))

        kind = self.kind or ("rectangle" if self.centre is not None else None)
        return messages.Light(centre=placed(self.centre, "centre"), u=placed(self.u, "u"), v=placed(self.v, "v"),
                              kind=None if kind is None else word(kind, LIGHTS, "light"), one_sided=self.one_sided,
                              pattern=self.whole_pattern.to_message(image_id))

    @staticmethod
    def of(body: messages.Light) -> Light:
        """A light of a FRAME, which is whole."""
        return Light(name_of(LIGHTS, body.kind or 0, "light.kind"), tuple_of(need(body.centre, "light.centre")),
                     tuple_of(need(body.u, "light.u")), tuple_of(need(body.v, "light.v")), bool(body.one_sided),
                     Pattern.of(need(body.pattern, "light.pattern")))


@dataclass(frozen=True)
class Lines(Replaceable):
    """The family of lines, and the eye for which they are computed: `eye` or `eye_direction`, else the camera's."""
    family: str = "reflection"
    direction: Vector | None = None
    eye: Vector | None = None
    eye_direction: Vector | None = None

    @staticmethod
    def parse(text: str, line_eye: Vector | None) -> Lines:
        """The lines of texts as --lines and --line-eye take them."""
        family, colon, rest = text.partition(":")
        lines = Lines(family, rest if colon else None)
        if line_eye is None or (isinstance(line_eye, str) and line_eye == "camera"):
            return lines
        if isinstance(line_eye, str) and line_eye.startswith("dir:"):
            return lines.replace(eye_direction=line_eye[4:])
        return lines.replace(eye=line_eye)

    def to_message(self) -> messages.Lines:
        def toward(value: Vector | None, name: str) -> messages.Vec3 | None:
            return None if value is None else message(direction(value, name))

        return messages.Lines(family=word(self.family, FAMILIES, "lines"),
                              direction=toward(self.direction, "the direction of lines"),
                              eye=None if self.eye is None else message(vector(self.eye, "line_eye")),
                              eye_direction=toward(self.eye_direction, "line_eye"))

    @staticmethod
    def of(body: messages.Lines) -> Lines:
        def tuple_or_none(v: messages.Vec3 | None) -> Vec3 | None:
            return None if v is None else tuple_of(v)

        return Lines(name_of(FAMILIES, body.family, "lines.family"), tuple_or_none(body.direction), tuple_or_none(body.eye),
                     tuple_or_none(body.eye_direction))


def lights_of(light: str | Light | Sequence[Light] | None, named: dict[str, Any]) -> list[Light]:
    """The lights of the options light, light_center, light_u, light_v and pattern; these describe one light, or `light`
    is one or several whole lights."""
    given = {name: value for name, value in named.items() if value is not None}
    if light is not None and not isinstance(light, str):
        if given:
            raise BadArgument(f"{' and '.join(given)}: the lights of `light` have their own")
        return [light] if isinstance(light, Light) else list(light)
    kind, colon, side = (light or "").partition(":")
    if colon and side != "one-sided":
        raise BadArgument(f"light is {light!r}; only one-sided may follow the ':'")
    return [Light(kind or None, one_sided=bool(colon), **given)]

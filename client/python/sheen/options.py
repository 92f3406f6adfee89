"""The options of a frame, by the names of the `sheen` command's options, and the RENDER that they make."""
from __future__ import annotations

from typing import Any, Sequence, TypedDict, Union

from sheen import messages
from sheen.errors import BadArgument
from sheen.scene import VIEWS, Camera, Light, Lines, lights_of
from sheen.values import Colour, Size, Vector, colour, direction, message, number, size, vector, whole, word

CLASSES = ("still", "interactive", "batch")
SHOWN = ("lines", "curvature", "gaussian", "mean", "normal", "ptex", "draft")
SUBSAMPLINGS = ("444", "422", "420")
SURFACES = ("exact", "polygon", "wireframe")


class Options(TypedDict, total=False):
    """What a frame shows. `sheen render --help` explains each option; a value is a number, a sequence, or a text as the
    command takes it. `class_` and `deadline` tell how a busy daemon treats the request."""
    size: Size
    camera: Camera
    eye: Vector
    target: Vector
    view: str
    zoom: Union[str, float, Sequence[float]]  # FACTOR@X,Y or (factor, x, y)
    up: Vector
    fov: float
    ortho: float
    lines: Union[str, Lines]
    line_eye: Vector
    light: Union[str, Light, Sequence[Light]]
    light_center: Vector
    light_u: Vector
    light_v: Vector
    pattern: str
    base: Colour
    antialias: str
    filter: str
    miss: Colour
    empty: Colour
    surface: str
    show: str
    show_range: float
    legend: str
    class_: str
    deadline: int
    jpeg_quality: int
    jpeg_subsampling: Union[str, int]
    window: tuple[float, float, int, int]  # the place of the frame in a picture of this width and height


def check_names(options: Options) -> None:
    unknown = sorted(set(options) - set(Options.__annotations__))
    if unknown:
        raise TypeError(f"there is no option {', '.join(unknown)}; sheen.Options has them all")


def _zoom(value: str | float | Sequence[float]) -> tuple[float, float, float]:
    if isinstance(value, str):
        factor, at, place = value.partition("@")
        parts: Sequence[Any] = [factor, *place.split(",")] if at else [factor]
    else:
        parts = [value] if isinstance(value, (int, float)) else value
    if len(parts) not in (1, 3):
        raise BadArgument(f"zoom is {value!r}; it must be FACTOR or FACTOR@X,Y")
    factor_, x, y = [number(part, "zoom") for part in parts] + [0.5, 0.5][:3 - len(parts)]
    return factor_, x, y


def _camera(options: Options) -> messages.Camera | None:
    names = {"eye", "target", "up", "fov", "ortho", "view", "zoom"} & set(options)
    whole_camera = options.get("camera")
    if whole_camera is not None:
        if names - {"zoom"}:
            raise BadArgument(f"{' and '.join(sorted(names))}: `camera` has its own")
        made = whole_camera.to_message()
    elif not names:
        return None
    else:
        made = messages.Camera()
        if "eye" in options:
            made.eye = message(vector(options["eye"], "eye"))
        if "target" in options:
            made.target = message(vector(options["target"], "target"))
        if "up" in options:
            made.up = message(direction(options["up"], "up"))
        if "view" in options:
            made.view = word(options["view"], VIEWS, "view")
        if "fov" in options:
            made.fov_deg = number(options["fov"], "fov")
        if "ortho" in options:
            made.ortho_height = number(options["ortho"], "ortho")
    if "zoom" in options:
        made.zoom, made.zoom_x, made.zoom_y = _zoom(options["zoom"])
    return made


def _show(options: Options) -> messages.Show | None:
    if not {"show", "show_range", "legend"} & set(options):
        return None
    kind, colon, pull = options.get("show", "lines").partition(":")
    show = messages.Show(kind=word(kind, SHOWN, "show"))
    if colon:
        show.direction = message(direction(pull, "the direction of draft"))
    if "show_range" in options:
        show.range = number(options["show_range"], "show_range")
    if "legend" in options:
        show.legend = word(options["legend"], ("off", "on"), "legend") == 1
    return show


def _surface(render: messages.Render, text: str) -> None:
    kind, colon, level = text.partition(":")
    render.surface = word(kind, SURFACES, "surface")
    if colon:
        render.surface_level = whole(level, "the level of surface")


def lights_and_lines(options: Options) -> tuple[list[Light], Lines]:
    """The lights of the options, whose images are to be uploaded, and the lines."""
    lights = lights_of(options.get("light"), {
        "centre": options.get("light_center"), "u": options.get("light_u"), "v": options.get("light_v"),
        "pattern": options.get("pattern")})
    lines = options.get("lines", "reflection")
    if isinstance(lines, str):
        lines = Lines.parse(lines, options.get("line_eye"))
    elif "line_eye" in options:
        raise BadArgument("line_eye: `lines` has its own")
    return lights, lines


def render_message(model_id: bytes, planes: int, encoding: int, options: Options, lights: Sequence[Light],
                   lines: Lines, image_ids: Sequence[bytes | None]) -> messages.Render:
    """The request of these options. `image_ids` has the uploaded image of each light."""
    width, height = size(options.get("size", (1280, 720)))
    render = messages.Render(
        model_sha256=model_id, width_px=width, height_px=height, planes=planes, encoding=encoding,
        camera=_camera(options), show=_show(options), lines=lines.to_message(),
        lights=[light.to_message(image) for light, image in zip(lights, image_ids)])
    for name in ("miss", "empty", "base"):
        if name in options:
            setattr(render, name, colour(options[name], name))  # type: ignore[literal-required]
    if "antialias" in options:
        render.aliased = word(options["antialias"], ("exact", "off"), "antialias") == 1
    if "filter" in options:
        render.unfiltered = word(options["filter"], ("exact", "off"), "filter") == 1
    if "surface" in options:
        _surface(render, options["surface"])
    if "class_" in options:
        render.request_class = word(options["class_"], CLASSES, "class_")
    if "window" in options:
        x, y, across, down = options["window"]
        render.window = messages.Window(x_px=number(x, "window"), y_px=number(y, "window"),
                                        width_px=whole(across, "window"), height_px=whole(down, "window"))
    if "deadline" in options:
        render.deadline_ms = whole(options["deadline"], "deadline")
    if "jpeg_quality" in options:
        render.jpeg_quality = whole(options["jpeg_quality"], "jpeg_quality")
    if "jpeg_subsampling" in options:
        render.jpeg_subsampling = word(str(options["jpeg_subsampling"]), SUBSAMPLINGS, "jpeg_subsampling")
    return render

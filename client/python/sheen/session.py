"""Sessions: connect, upload, render."""
from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from typing import Callable, Generator, Iterable, Mapping, Sequence, Union, Unpack, cast

import numpy as np

from sheen import files, header, messages, picks, planes
from sheen.breaks import Breaks
from sheen.comparison import Comparison, Limits, read_limit
from sheen.connection import Connection, connect
from sheen.curves import Curves
from sheen.daemon import PrivateDaemon
from sheen.errors import (BadArgument, BadImage, BadModel, BadPeer, BadRequest, BadVersion, Cancelled, DeviceFailed,
                          Error, GpuLost, Late, Lost, Overloaded, ShuttingDown, Superseded, TooBig, UnknownModel)
from sheen.frame import Frame
from sheen.messages import Type
from sheen.options import Options, check_names, lights_and_lines, render_message
from sheen.picks import Pick, Section
from sheen.protobuf import M, Malformed, Message, decode, encode
from sheen.scene import Camera, Pattern
from sheen.values import number, number_or_none, numbers, place, size, whole

Progress = Callable[[str, int, int], None]
PathOrBytes = Union[str, "os.PathLike[str]", bytes]
FORMATS = ("raw", "zstd", "png", "exr", "jpeg", "tiff")
RETRIES = 5  # of a request whose frame was lost with the daemon's GPU
LAST_WORDS_S = 1
CODES: Mapping[int, type[Error]] = {
    messages.ErrorCode.ERROR_PROTOCOL: BadPeer,
    messages.ErrorCode.ERROR_VERSION: BadVersion,
    messages.ErrorCode.ERROR_REQUEST: BadRequest,
    messages.ErrorCode.ERROR_MODEL: BadModel,
    messages.ErrorCode.ERROR_IMAGE: BadImage,
    messages.ErrorCode.ERROR_UNKNOWN_MODEL: UnknownModel,
    messages.ErrorCode.ERROR_TOO_BIG: TooBig,
    messages.ErrorCode.ERROR_OVERLOADED: Overloaded,
    messages.ErrorCode.ERROR_SHUTTING_DOWN: ShuttingDown,
    messages.ErrorCode.ERROR_DEVICE: DeviceFailed,
    messages.ErrorCode.ERROR_CANCELLED: Cancelled,
    messages.ErrorCode.ERROR_DEADLINE: Late,
    messages.ErrorCode.ERROR_GPU_LOST: GpuLost,
}


@dataclass(frozen=True)
class Model:
    """A model that the daemon has. `id` is the SHA-256 of its file."""
    id: bytes
    name: str
    session: Session

    @property
    def info(self) -> messages.ModelInfo:
        """What the model consists of and costs; asks the daemon."""
        return self.session.info(self)

    @property
    def warnings(self) -> list[str]:
        return self.info.warnings.splitlines()

    @property
    def box(self) -> planes.Array:
        """The least and the greatest corner, (2, 3)."""
        info = self.info
        return np.array([[corner.x, corner.y, corner.z] for corner in (info.box_min, info.box_max)])

    def __repr__(self) -> str:
        return f"Model({self.name!r}, id={self.id.hex()[:16]}...)"


@dataclass
class _Asked:
    render: messages.Render
    progress: Progress | None
    n_retries: int = 0


class Session:
    """A connection to a daemon. One thread at a time; sessions of several threads are independent.

    `server`: unix:PATH, tcp:HOST:PORT or tls:HOST:PORT; default: $SHEEN_SERVER, else a private daemon, for which
    `device`, `native_isa`, `native_threads`, `memory_budget` (bytes) and `sheend` (its program) are. `ca`, `cert`, `key`:
    PEM files, and `token`: a text, for a TLS server. `share`: other clients may use the uploaded files. `timeout`:
    the longest time in seconds without a byte, None: no limit."""

    def __init__(self, server: str | None = None, *, token: str | None = None, ca: str | None = None,
                 cert: str | None = None, key: str | None = None, timeout: float | None = 300,
                 connect_timeout: float | None = None, share: bool = False, device: str | None = None,
                 native_isa: str | None = None, native_threads: int | None = None,
                 memory_budget: int | None = None, sheend: str | None = None, model_id: bytes = bytes(32)) -> None:
        self._seq = 0
        self._share = share
        self._asked: dict[int, _Asked] = {}
        self._images: dict[str, bytes] = {}
        self._broken = False
        self._daemon: PrivateDaemon | None = None
        self._zstd = planes.zstd()
        first_timeout = timeout if connect_timeout is None else connect_timeout
        server = server or os.environ.get("SHEEN_SERVER") or None
        private = {"device": device, "native-isa": native_isa,
                   "native-threads": None if native_threads is None else str(native_threads)}
        if server is None:
            self._daemon = PrivateDaemon(sheend, private, memory_budget)
            self._connection = Connection(self._daemon.socket, first_timeout)
        elif memory_budget or sheend or any(private.values()):
            raise BadArgument(f"device, native_isa, native_threads, memory_budget and sheend are for a private daemon; "
                              f"the one at {server} has its own")
        else:
            self._connection = Connection(connect(server, first_timeout, ca, cert, key), first_timeout)
        # Without compression frames come sooner where bytes cost nothing.
        self._is_local = server is None or server.startswith("unix:")
        try:
            self.server = self._greet(model_id, token if server and server.startswith("tls:") else None)
        except BaseException:
            self.close()
            raise
        self._connection.set_timeout(timeout)

    def _greet(self, model_id: bytes, token: str | None) -> messages.HelloOk:
        from sheen import __version__
        hello = messages.Hello(minor=messages.MINOR, client=f"python sheen {__version__}", token=token)
        ok = self._ask(Type.HELLO, hello, Type.HELLO_OK, messages.HelloOk, before=model_id)
        if not 1 <= self._credits(ok) <= header.MAX_CREDITS:
            raise self._bad_peer(f"HELLO_OK: credits is {ok.credits}; it must be from 1 to {header.MAX_CREDITS}")
        return ok

    @staticmethod
    def _credits(ok: messages.HelloOk) -> int:
        return 4 if ok.credits is None else ok.credits

    @property
    def minor(self) -> int:
        """The minor version of the protocol that both sides speak."""
        return min(messages.MINOR, self.server.minor)

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closes the connection; ends a private daemon and waits for it."""
        self._broken = True
        self._connection.close()
        if self._daemon:
            self._daemon.end()
            self._daemon = None

    # ---- messages ----

    def _check(self) -> None:
        if self._broken:
            raise Lost("this session has failed or is closed: connect again")

    def _check_idle(self) -> None:
        self._check()
        if self._asked:
            raise BadArgument(f"{len(self._asked)} frames of a stream are in flight: read it to its end, or close it")

    def _fail(self, failure: Error) -> Error:
        """After a fatal failure the session can only be closed."""
        if failure.is_fatal:
            self._broken = True
            if self._daemon and isinstance(failure, Lost) and not isinstance(failure, ShuttingDown):
                return self._daemon.explain(failure)
        return failure

    def _bad_peer(self, text: str) -> Error:
        return self._fail(BadPeer(f"the server broke the protocol: {text}"))

    def _send(self, kind: Type, body: bytes, seq: int | None = None) -> int:
        self._check()
        if seq is None:
            self._seq = self._seq % 0xffffffff + 1
            seq = self._seq
        try:
            self._connection.write(header.pack(kind, seq, body))
        except Lost as lost:
            raise self._last_words(lost) from None
        except Error as failure:
            raise self._fail(failure) from None
        except BaseException:  # a part of the message may have gone
            self._broken = True
            raise
        return seq

    def _send_message(self, kind: Type, message: Message, before: bytes = b"", seq: int | None = None) -> int:
        try:
            body = before + encode(message)
        except Malformed as wrong:
            raise BadArgument(f"{kind.name}: {wrong}") from None
        if len(body) > messages.MAX_BODY_BYTES[kind]:
            raise BadArgument(f"{kind.name} has {len(body)} bytes; it may have {messages.MAX_BODY_BYTES[kind]}")
        return self._send(kind, body, seq)

    def _last_words(self, lost: Lost) -> Error:
        """A write has failed. If the daemon sent an error before it closed, that text is better."""
        try:
            self._connection.set_timeout(LAST_WORDS_S)
            while True:
                kind, _, length, _ = header.unpack(self._connection.read(header.HEADER.size))
                body = self._connection.read(length)
                if kind == Type.ERROR:
                    failure = self._error_of(body)
                    if failure.is_fatal or isinstance(failure, DeviceFailed):
                        self._broken = True
                        return failure
        except (Error, OSError):
            return self._fail(lost)

    def _error_of(self, body: bytes) -> Error:
        error = self._decode(Type.ERROR, messages.Error, body)
        kind = CODES.get(error.code)
        if kind is None:
            return self._bad_peer(f"ERROR: there is no code {error.code}")
        if any(ord(c) < 0x20 or ord(c) == 0x7f for c in error.text):
            return self._bad_peer("ERROR: its text has control characters")
        return kind(error.text)

    def _decode(self, kind: Type, cls: type[M], body: bytes) -> M:
        try:
            return decode(cls, body)
        except Malformed as wrong:
            raise self._bad_peer(f"{kind.name}: {wrong}") from None

    def _read_header(self) -> tuple[Type, int, int, int]:
        self._check()
        self._broken = True  # until the whole message is read
        try:
            return header.unpack(self._connection.read(header.HEADER.size))
        except Error as failure:
            raise self._fail(failure) from None

    def _read_body(self, length: int) -> bytes:
        try:
            body = self._connection.read(length)
        except Error as failure:
            raise self._fail(failure) from None
        self._broken = False
        return body

    def _next(self, progress: Progress | None) -> tuple[Type, int, bytes]:
        """The next message that is neither PROGRESS nor DATA: (type, number, body)."""
        while True:
            kind, _, length, seq = self._read_header()
            if kind == Type.DATA:
                raise self._bad_peer("DATA: no FRAME came before it")
            body = self._read_body(length)
            if kind != Type.PROGRESS:
                return kind, seq, body
            told = self._decode(kind, messages.Progress, body)
            if progress:
                progress(told.stage, told.done, told.total)

    def _expect(self, seq: int, want: Type, cls: type[M], progress: Progress | None = None) -> M:
        kind, got, body = self._next(progress)
        if kind == Type.ERROR and got in (seq, 0):
            raise self._fail(self._error_of(body))
        if got != seq or kind != want:
            raise self._bad_peer(f"{kind.name}: another answer was due")
        return self._decode(kind, cls, body)

    def _ask(self, kind: Type, message: Message, want: Type, cls: type[M], progress: Progress | None = None,
             before: bytes = b"") -> M:
        self._check_idle()
        return self._expect(self._send_message(kind, message, before), want, cls, progress)

    # ---- files ----

    def _upload(self, kind: int, data: bytes, name: str, progress: Progress | None) -> bytes:
        if not data or len(data) > header.MAX_UPLOAD_BYTES:
            raise BadArgument(f"{name}: {len(data)} bytes; a file has 1 to {header.MAX_UPLOAD_BYTES}")
        file_id = hashlib.sha256(data).digest()
        begin = messages.UploadBegin(kind=kind, sha256=file_id, size_bytes=len(data), name=os.path.basename(name),
                                     share=True if self._share else None)
        state = self._ask(Type.UPLOAD_BEGIN, begin, Type.UPLOAD_STATE, messages.UploadState, progress)
        if state.complete:
            return file_id
        if state.received_bytes >= len(data):
            raise self._bad_peer("UPLOAD_STATE: it has more bytes than the file")
        seq = self._seq
        for at in range(state.received_bytes, len(data), header.CHUNK_BYTES):
            self._send(Type.UPLOAD_CHUNK, data[at:at + header.CHUNK_BYTES], seq)
            if progress:
                progress("upload", min(len(data), at + header.CHUNK_BYTES), len(data))
        if not self._expect(seq, Type.UPLOAD_STATE, messages.UploadState, progress).complete:
            raise self._bad_peer("UPLOAD_STATE: the file is sent, but not complete")
        return file_id

    def upload(self, model: PathOrBytes, name: str | None = None, *, weld: bool = False,
               progress: Progress | None = None) -> Model:
        """Uploads a model, unless the daemon has it; continues where a broken upload stopped. `model`: a path, or the
        file's bytes, which need a `name` whose ending tells the format. `weld` joins vertices of an OBJ file."""
        if isinstance(model, bytes):
            if name is None:
                raise BadArgument("the bytes of a model need a name, whose ending tells their format")
            data = model
        else:
            data, name = files.read_model(model), name or os.fspath(model)
        if weld:
            data = files.weld(name, data)
        return Model(self._upload(messages.UploadKind.UPLOAD_MODEL, data, name, progress), os.path.basename(name), self)

    def upload_image(self, image: PathOrBytes, name: str | None = None, *, progress: Progress | None = None) -> bytes:
        """Uploads an image for Pattern(image=...), and returns its id."""
        if isinstance(image, bytes):
            return self._upload(messages.UploadKind.UPLOAD_IMAGE, image, name or "image", progress)
        path = os.fspath(image)
        return self._upload(messages.UploadKind.UPLOAD_IMAGE, files.read(path, False), name or path, progress)

    def find(self, name: str, *, progress: Progress | None = None) -> Model:
        """A model in the folder of the daemon (sheend --models)."""
        info = self._ask(Type.MODEL_QUERY, messages.ModelQuery(sha256=bytes(32), file=name), Type.MODEL_INFO,
                         messages.ModelInfo, progress)
        return Model(info.sha256, name, self)

    def info(self, model: Model | PathOrBytes, *, progress: Progress | None = None) -> messages.ModelInfo:
        """What a model consists of and costs."""
        return self._ask(Type.MODEL_QUERY, messages.ModelQuery(sha256=self._id_of(model, progress)), Type.MODEL_INFO,
                         messages.ModelInfo, progress)

    def stats(self) -> messages.Stats:
        """The daemon's statistics."""
        self._check_idle()
        seq = self._send(Type.STATS_QUERY, b"")
        return self._expect(seq, Type.STATS, messages.Stats)

    def _id_of(self, model: Model | PathOrBytes, progress: Progress | None = None) -> bytes:
        """The id of a model, of 32 bytes that are an id, or of a file, which is uploaded."""
        if isinstance(model, Model):
            return model.id
        if isinstance(model, bytes) and len(model) == 32:
            return model
        return self.upload(model, progress=progress).id

    # ---- frames ----

    def _image_id(self, pattern: Pattern) -> bytes | None:
        if pattern.image is None or isinstance(pattern.image, bytes):
            return pattern.image
        if pattern.image not in self._images:
            self._images[pattern.image] = self.upload_image(pattern.image)
        return self._images[pattern.image]

    def _encoding(self, format: str) -> int:
        if format == "planes":
            return FORMATS.index("zstd" if self._zstd and not self._is_local else "raw")
        if format not in FORMATS:
            raise BadArgument(f"format is {format!r}; it must be planes, {', '.join(FORMATS)}")
        if format == "zstd" and not self._zstd:
            raise BadArgument("format zstd needs the module zstandard, or Python 3.14")
        return FORMATS.index(format)

    @staticmethod
    def _bits(names: Iterable[str]) -> int:
        bits = 0
        for name in (names,) if isinstance(names, str) else names:
            if name not in planes.PLANES:
                raise BadArgument(f"there is no plane {name!r}; there are {', '.join(planes.PLANES)}")
            bits |= planes.PLANES[name].bit
        return bits

    def _render_of(self, model: Model | PathOrBytes, names: Iterable[str], format: str,
                   options: Options) -> messages.Render:
        check_names(options)
        lights, lines = lights_and_lines(options)
        images = [self._image_id(light.whole_pattern) for light in lights]
        render = render_message(self._id_of(model), self._bits(names), self._encoding(format), options, lights, lines,
                                images)
        if render.aliased and self.minor < 4:
            raise BadArgument("the daemon is too old to draw frames without antialiasing")
        if render.window and self.minor < 5:
            raise BadArgument("the daemon is too old to draw a part of a picture")
        return render

    def _ask_frame(self, render: messages.Render, progress: Progress | None) -> int:
        seq = self._send_message(Type.RENDER, render)
        self._asked[seq] = _Asked(render, progress)
        return seq

    def render(self, model: Model | PathOrBytes, *, planes: Iterable[str] = ("colour",), format: str = "planes",
               progress: Progress | None = None, **options: Unpack[Options]) -> Frame:
        """Renders one frame. `planes`: names of sheen.PLANES. `format`: planes (arrays), or png, exr, jpeg, tiff: a file
        in Frame.file. All other options have the names of the command's options (sheen.Options)."""
        self._check_idle()
        seq = self._ask_frame(self._render_of(model, planes, format, options), progress)
        _, answer = self._receive()
        if isinstance(answer, Error):
            raise answer
        assert not self._asked, seq
        return answer

    def stream(self, model: Model | PathOrBytes, cameras: Iterable[Camera | Options], *, in_flight: int = 2,
               planes: Iterable[str] = ("colour",), format: str = "planes",
               **options: Unpack[Options]) -> Generator[Frame, None, None]:
        """Renders a frame for each camera, or for each dict of options, and yields the frames in this order. So many
        requests are in flight at once. A frame that fails raises its error at its turn, and ends the stream."""
        model_id = self._id_of(model)
        names = tuple((planes,) if isinstance(planes, str) else planes)
        most = max(1, min(in_flight, self._credits(self.server)))
        waiting: list[int] = []
        answers: dict[int, Frame | Error] = {}
        rest = iter(cameras)
        is_over = False
        try:
            while True:
                while not is_over and len(self._asked) < most and len(waiting) < 2 * most:
                    try:
                        one = next(rest)
                    except StopIteration:
                        is_over = True
                        break
                    both = cast(Options, dict(options))
                    both.update({"camera": one} if isinstance(one, Camera) else one)
                    waiting.append(self._ask_frame(self._render_of(model_id, names, format, both), None))
                if not waiting:
                    return
                while waiting[0] not in answers:
                    seq, answer = self._receive()
                    answers[seq] = answer
                first = answers.pop(waiting.pop(0))
                if isinstance(first, Error):
                    raise first
                yield first
        finally:
            self._drop(waiting)

    def _windows(self, model: Model | PathOrBytes, places: Sequence[tuple[float, float]], camera: Camera | None,
                 options: Options) -> list[Frame]:
        """Frames of one pixel each, which is a part of the picture that the options describe."""
        width, height = size(options.get("size", (1280, 720)))
        for x, y in places:
            if not (0 <= x < width and 0 <= y < height):
                raise BadArgument(f"{x},{y} is not in the picture, whose pixels are 0,0 to {width - 1},{height - 1} (size)")
        both = cast(Options, {**options, "size": (1, 1)})
        if camera is not None:
            if "camera" in options:
                raise BadArgument("there are two cameras")
            both["camera"] = camera
        parts: list[Camera | Options] = [{"window": (x, y, width, height)} for x, y in places]
        return list(self.stream(model, parts, in_flight=header.MAX_CREDITS, planes=picks.PLANES, format="raw", **both))

    def pick(self, model: Model | PathOrBytes, camera: Camera | None, x: float, y: float, /,
             **options: Unpack[Options]) -> Pick:
        """The numbers at the pixel x, y of the picture of this camera and these options: the same as in its planes.
        Fractions lie between the centres of pixels."""
        check_names(options)
        x, y = number(x, "x"), number(y, "y")
        return Pick.of(x, y, self._windows(model, [(x, y)], camera, options)[0])

    def section(self, model: Model | PathOrBytes, camera: Camera | None, start: tuple[float, float],
                end: tuple[float, float], samples: int = 100, /, **options: Unpack[Options]) -> Section:
        """The numbers at places along a line of the picture, both ends included."""
        check_names(options)
        samples, start, end = whole(samples, "samples"), place(start, "start"), place(end, "end")
        if samples < 2:
            raise BadArgument(f"samples is {samples}; it must be at least 2")
        places = [(start[0] + (end[0] - start[0]) * i / (samples - 1), start[1] + (end[1] - start[1]) * i / (samples - 1))
                  for i in range(samples - 1)] + [(end[0], end[1])]
        return Section.of(places, self._windows(model, places, camera, options))

    # ---- computations ----

    def _scene(self, model: Model | PathOrBytes, options: Options) -> messages.Render:
        """The scene of a computation, of which no picture is drawn."""
        self._check_idle()
        if self.minor < 5:
            raise BadArgument("the daemon is too old to compute this")
        return self._render_of(model, ("position",), "raw", options)

    def _compute(self, kind: Type, asked: Message, want: Type, cls: type[M], size_of: Callable[[M], int],
                 progress: Progress | None) -> tuple[M, bytearray]:
        """A computation's answer and its records, whose size `size_of` tells by the answer."""
        seq = self._send_message(kind, asked)
        body = self._expect(seq, want, cls, progress)
        try:
            size = size_of(body)
            if size > header.MAX_FRAME_BYTES:
                raise Malformed(f"{size} bytes of records; there may be {header.MAX_FRAME_BYTES}")
        except Malformed as wrong:
            raise self._bad_peer(f"{want.name}: {wrong}") from None
        return body, self._read_data(seq, size)

    def breaks(self, model: Model | PathOrBytes, *, gap: float | None = None, angle_deg: float | None = None,
               curvature_percent: float | None = None, progress: Progress | None = None,
               **options: Unpack[Options]) -> Breaks:
        """Finds where lines on the surface break: along creases and joints, and at extraordinary vertices. The limits
        `gap`, `angle_deg` and `curvature_percent` decide which edges are out of tolerance. The other options tell camera,
        lights and lines, and `deadline`."""
        asked = messages.FindBreaks(scene=self._scene(model, options), gap=number_or_none(gap, "gap"),
                                    angle_deg=number_or_none(angle_deg, "angle_deg"),
                                    curvature_percent=number_or_none(curvature_percent, "curvature_percent"))
        body, data = self._compute(Type.FIND_BREAKS, asked, Type.BREAKS, messages.Breaks, Breaks.data_bytes, progress)
        try:
            return Breaks.of(body, data)
        except Malformed as wrong:
            raise self._bad_peer(f"BREAKS: {wrong}") from None

    def compare(self, old: Model | PathOrBytes, new: Model | PathOrBytes, *, limits: Limits | None = None,
                align: bool = False, samples: int | None = None, progress: Progress | None = None,
                **options: Unpack[Options]) -> Comparison:
        """Compares two surfaces by samples in both directions. `align` first moves the new surface onto the old one. The
        other options tell the camera, lights and lines of which shifts are measured, and `deadline`."""
        given = limits or {}
        unknown = sorted(set(given) - set(Limits.__annotations__))
        if unknown:
            raise BadArgument(f"there is no measure {', '.join(unknown)}; there are {', '.join(Limits.__annotations__)}")
        allowed = {name: read_limit(name, given.get(name)) for name in Limits.__annotations__}
        scene = self._scene(old, options)
        asked = messages.Compare(scene=scene, new_sha256=self._id_of(new), align=True if align else None,
                                 samples=None if samples is None else whole(samples, "samples"),
                                 distance=allowed["distance"].value, normal_deg=allowed["normal_deg"].value,
                                 lines=allowed["lines"].value, line_length=allowed["line_length"].value,
                                 curvature=allowed["curvature"].value)
        body, _ = self._compute(Type.COMPARE, asked, Type.COMPARED, messages.Compared, lambda _: 0, progress)
        try:
            return Comparison.of(body, allowed)
        except Malformed as wrong:
            raise self._bad_peer(f"COMPARED: {wrong}") from None

    def lines(self, model: Model | PathOrBytes, *, tolerance: float | None = None,
              at: float | Sequence[float] = (),
              silhouettes: bool = False, progress: Progress | None = None, **options: Unpack[Options]) -> Curves:
        """Traces lines on the surface as curves. `at`: places on each light, or one; default: those of its pattern. `tolerance`:
        the greatest distance of a curve from its chords. `silhouettes`: those of the eye, instead of lines."""
        asked = messages.TraceLines(scene=self._scene(model, options), tolerance=number_or_none(tolerance, "tolerance"),
                                    at=numbers(at, "at"), silhouettes=True if silhouettes else None)
        body, data = self._compute(Type.TRACE_LINES, asked, Type.CURVES, messages.Curves, Curves.data_bytes, progress)
        try:
            return Curves.of(body, data)
        except Malformed as wrong:
            raise self._bad_peer(f"CURVES: {wrong}") from None

    def _drop(self, waiting: Sequence[int]) -> None:
        """Takes back the requests that are still in flight."""
        if self._broken:
            self._asked.clear()
            return
        for seq in waiting:
            if seq in self._asked and self.minor >= 1:
                self._send(Type.CANCEL, b"", seq)
        while self._asked:
            self._receive()

    def _receive(self) -> tuple[int, Frame | Error]:
        """The next answer to a request in flight, which then is in flight no more."""
        while True:
            progress = next(iter(self._asked.values())).progress
            kind, seq, body = self._next(progress)
            if kind == Type.ERROR and seq == 0:
                raise self._fail(self._error_of(body))
            asked = self._asked.pop(seq, None)
            if asked is None:
                raise self._bad_peer(f"{kind.name}: it answers no request in flight")
            if kind == Type.FRAME:
                return seq, self._read_frame(seq, asked.render, self._decode(kind, messages.Frame, body))
            if kind == Type.SUPERSEDED:
                by = self._decode(kind, messages.Superseded, body).by
                return seq, Superseded(f"request {by} has taken the place of {seq}")
            if kind != Type.ERROR:
                raise self._bad_peer(f"{kind.name}: another answer was due")
            failure = self._fail(self._error_of(body))
            if failure.is_fatal:
                raise failure
            if isinstance(failure, GpuLost) and asked.n_retries < RETRIES:
                asked.n_retries += 1
                self._asked[seq] = asked
                self._send_message(Type.RENDER, asked.render, seq=seq)
                continue
            # The request is too big, not a file.
            return seq, BadRequest(str(failure)) if isinstance(failure, TooBig) else failure

    def _read_frame(self, seq: int, asked: messages.Render, body: messages.Frame) -> Frame:
        if (body.width_px, body.height_px, body.planes, body.encoding) != (
                asked.width_px, asked.height_px, asked.planes, asked.encoding):
            raise self._bad_peer("FRAME is not of the size, planes and encoding that were asked for")
        if not 1 <= body.data_bytes <= header.MAX_FRAME_BYTES:
            raise self._bad_peer(f"FRAME: data_bytes is {body.data_bytes}")
        format = FORMATS[asked.encoding]
        try:
            if format not in ("raw", "zstd"):
                return Frame.of(body, {}, bytes(self._read_data(seq, body.data_bytes)), format)
            made = planes.empty(asked.width_px, asked.height_px, asked.planes)
            if format == "raw":
                self._fill(seq, body.data_bytes, planes.views(made))
            else:
                assert self._zstd
                data = self._read_data(seq, body.data_bytes)
                planes.unpack_zstd(self._zstd, data, asked.width_px, asked.height_px, made)
            return Frame.of(body, made, None, "planes")
        except Malformed as wrong:
            raise self._bad_peer(f"FRAME: {wrong}") from None

    def _next_data(self, seq: int, left: int) -> int:
        """The length of the next DATA."""
        kind, flags, length, got = self._read_header()
        if kind != Type.DATA or got != seq:
            raise self._bad_peer(f"{kind.name}: DATA of {seq} was due")
        if not 0 < length <= left or (length == left) != bool(flags & header.END):
            raise self._bad_peer("DATA is longer or shorter than its FRAME says")
        return length

    def _read_data(self, seq: int, size: int) -> bytearray:
        data = bytearray()
        while len(data) < size:
            data += self._read_body(self._next_data(seq, size - len(data)))
        return data

    def _fill(self, seq: int, size: int, views: list[memoryview]) -> None:
        """Reads the data into these pieces of memory, one after the other."""
        if size != sum(len(view) for view in views):
            raise Malformed("it has another number of bytes than its planes")
        while size:
            length = self._next_data(seq, size)
            size -= length
            while length:
                n = min(length, len(views[0]))
                try:
                    self._connection.read_into(views[0][:n])
                except Error as failure:
                    raise self._fail(failure) from None
                views[0] = views[0][n:]
                length -= n
                if not views[0]:
                    views.pop(0)
            self._broken = False



"""Files as they are sent: a glTF model is packed with its buffer files into one GLB, as the `sheen` command does."""
from __future__ import annotations

import json
import os
import struct
import urllib.parse
from pathlib import Path
from typing import Any

from sheen.errors import BadArgument, BadImage, BadModel, Error, TooBig
from sheen.header import MAX_UPLOAD_BYTES

WELD_TAG = b"\n\nt weld 0/0/0\n"


def read(path: str | os.PathLike[str], is_model: bool) -> bytes:
    bad: type[Error] = BadModel if is_model else BadImage
    try:
        with open(path, "rb") as file:
            data = file.read(MAX_UPLOAD_BYTES + 1)
    except OSError as wrong:
        raise bad(f"{os.fspath(path)}: {wrong.strerror}") from None
    if not data:
        raise bad(f"{os.fspath(path)}: the file is empty")
    if len(data) > MAX_UPLOAD_BYTES:
        raise TooBig(f"{os.fspath(path)}: over {MAX_UPLOAD_BYTES} bytes, which is the most that can be uploaded")
    return data


def weld(name: str, data: bytes) -> bytes:
    """The model with the line that joins vertices at equal positions."""
    if data[:4] == b"glTF" or name.lower().endswith((".gltf", ".glb")):
        raise BadArgument(f"{name}: weld is for OBJ; equal positions inside a mesh of a glTF file are joined without it")
    if data[:5] == b"#usda" or data[:8] == b"PXR-USDC" or name.lower().endswith((".usda", ".usd", ".usdc", ".usdz")):
        raise BadArgument(f"{name}: weld is for OBJ; a mesh of a USD file names by index which vertices its faces share")
    return data + WELD_TAG


def _is_data(uri: Any) -> bool:
    return not isinstance(uri, str) or uri[:5].lower() == "data:"


def _buffer_file(path: Path, index: int, uri: str) -> bytes:
    """A buffer's file, which must be in the model's folder or below, also where a name is a link."""
    name = urllib.parse.unquote(uri)
    folder = path.parent.resolve()
    if "://" in uri or not name or os.path.isabs(name) or "\0" in name:
        raise BadModel(f"{path}: buffer {index}: '{uri[:100]}' is no file beside the model")
    file = (folder / name).resolve()
    if not file.is_relative_to(folder):
        raise BadModel(f"{path}: buffer {index}: '{uri[:100]}' is not in the model's folder or below")
    try:
        return read(file, True)
    except BadModel as wrong:
        raise BadModel(f"{path}: buffer {index}: {wrong}") from None


def _real(value: float) -> str:
    text = f"{value:.17g}"
    mantissa, e, exponent = text.partition("e")
    return f"{mantissa}e{int(exponent)}" if e else text if "." in text else text + ".0"


def _json(value: Any) -> str:
    """The text that the `sheen` command writes, so that equal models have equal ids: numbers have 17 digits."""
    if isinstance(value, dict):
        return "{" + ",".join(f"{_json(key)}:{_json(member)}" for key, member in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ",".join(map(_json, value)) + "]"
    return _real(value) if isinstance(value, float) else json.dumps(value, ensure_ascii=False)


def _packed(path: Path, root: dict[str, Any], buffers: list[Any]) -> bytes:
    binary, places, kept = bytearray(), {}, [{"byteLength": 0}]
    for i, buffer in enumerate(buffers):
        uri = buffer.get("uri") if isinstance(buffer, dict) else None
        if _is_data(uri):
            places[i] = (len(kept), 0, 0)
            kept.append(buffer)
            continue
        assert isinstance(uri, str)
        data, wanted = _buffer_file(path, i, uri), buffer.get("byteLength")
        if type(wanted) is not int or not 1 <= wanted <= len(data):
            raise BadModel(f"{path}: buffer {i} has byteLength {wanted!r}, but '{uri[:100]}' has {len(data)} bytes")
        places[i] = (0, len(binary), wanted)
        binary += data[:wanted] + bytes(-wanted % 4)
        if len(binary) > MAX_UPLOAD_BYTES:
            raise TooBig(f"{path}: with the files beside it over {MAX_UPLOAD_BYTES} bytes")
    kept[0]["byteLength"] = len(binary)
    root["buffers"] = kept
    for i, view in enumerate(root.get("bufferViews", ())):
        at = view.get("buffer") if isinstance(view, dict) else None
        if type(at) is not int or at not in places:
            continue  # the reader at the daemon reports it
        buffer, offset, size = places[at]
        if size:
            start, length = view.get("byteOffset", 0), view.get("byteLength", 0)
            if type(start) is not int or type(length) is not int or not 0 <= start <= start + length <= size:
                raise BadModel(f"{path}: buffer view {i} does not lie within its buffer of {size} bytes")
            view["byteOffset"] = offset + start
        view["buffer"] = buffer
    try:
        text = _json(root).encode()
    except (UnicodeEncodeError, RecursionError):
        raise BadModel(f"{path}: its JSON is nested too deeply, or has half a character") from None
    text += b" " * (-len(text) % 4)
    return (struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(binary), len(text), 0x4E4F534A) + text +
            struct.pack("<II", len(binary), 0x004E4942) + bytes(binary))


def read_model(path: str | os.PathLike[str]) -> bytes:
    """The model's bytes as they are sent."""
    data = read(path, True)
    text = data.removeprefix(b"\xef\xbb\xbf").lstrip(b" \t\r\n")
    if text[:1] != b"{":
        return data
    try:
        root = json.loads(text)
    except (ValueError, RecursionError):
        return data  # the reader at the daemon says what is wrong with it
    buffers = root.get("buffers")
    if not isinstance(buffers, list) or all(
            _is_data(buffer.get("uri") if isinstance(buffer, dict) else None) for buffer in buffers):
        return data
    return _packed(Path(path), root, buffers)

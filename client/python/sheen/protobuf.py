"""Protocol Buffers, as far as the protocol uses them: messages are encoded and decoded by tables of their fields.

A message that does not agree with its table raises Malformed. Numbers of enums are plain integers, because a peer may
have enumerators that this package does not know."""
from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Any, ClassVar, Iterator, TypeVar

VARINT, FIXED64, BYTES, FIXED32 = 0, 1, 2, 5
WIRE_TYPES = {"uint32": VARINT, "uint64": VARINT, "bool": VARINT, "enum": VARINT, "double": FIXED64, "float": FIXED32,
              "string": BYTES, "bytes": BYTES}
MOST = {"uint32": 1 << 32, "uint64": 1 << 64, "enum": 1 << 31}


class Malformed(Exception):
    """These bytes are not the message, or this value does not fit its field."""


@dataclass(frozen=True)
class Field:
    """A field of a message: `kind` is a scalar type of the schema, "enum", or the class of a message."""
    number: int
    name: str
    kind: str | type[Message]
    label: str  # required, optional or repeated
    most: int | None  # the greatest number of bytes of a text, or of entries of a list; of `fixed` bytes, their number
    fixed: bool


class Message:
    """The base of all messages of sheen.messages."""
    FIELDS: ClassVar[dict[int, Field]] = {}


M = TypeVar("M", bound=Message)
V = TypeVar("V")


def need(value: V | None, name: str) -> V:
    """An optional field that this message must have."""
    if value is None:
        raise Malformed(f"{name} is missing")
    return value


def fields(*rows: Field) -> dict[int, Field]:
    """A message's table: in ascending order, in which the fields are encoded."""
    return {row.number: row for row in sorted(rows, key=lambda row: row.number)}


def varint(value: int) -> bytes:
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    out.append(value)
    return bytes(out)


def field(number: int, value: int | float | str | bytes) -> bytes:
    """One field of any number: an int, a float (as double), a text, or bytes, which may be an encoded message."""
    if isinstance(value, float):
        return varint(number << 3 | FIXED64) + struct.pack("<d", value)
    if isinstance(value, int):
        return varint(number << 3 | VARINT) + varint(value)
    if isinstance(value, str):
        value = value.encode()
    return varint(number << 3 | BYTES) + varint(len(value)) + value


def _take_varint(body: bytes, at: int) -> tuple[int, int]:
    value = shift = 0
    while True:
        if at == len(body) or shift > 63:
            raise Malformed("a number is cut off or too long")
        byte = body[at]
        at += 1
        value |= (byte & 127) << shift
        if byte < 128:
            if value >> 64:
                raise Malformed("a number has more than 64 bits")
            return value, at
        shift += 7


def scan(body: bytes) -> Iterator[tuple[int, int, int | bytes]]:
    """All fields as (number, wire type, value): an int for varints, else the bytes."""
    at = 0
    while at < len(body):
        key, at = _take_varint(body, at)
        number, wire = key >> 3, key & 7
        if number == 0:
            raise Malformed("a field has number 0")
        if wire == VARINT:
            value, at = _take_varint(body, at)
            yield number, wire, value
            continue
        if wire == BYTES:
            size, at = _take_varint(body, at)
        elif wire in (FIXED64, FIXED32):
            size = 8 if wire == FIXED64 else 4
        else:
            raise Malformed(f"field {number} has wire type {wire}, which does not exist")
        if size > len(body) - at:
            raise Malformed(f"field {number} is cut off")
        yield number, wire, body[at:at + size]
        at += size


def decode_fields(body: bytes) -> dict[int, list[Any]]:
    """All fields by number, without a table: lists of int (varints) or bytes (all others)."""
    found: dict[int, list[Any]] = {}
    for number, _, value in scan(body):
        found.setdefault(number, []).append(value)
    return found


def _number(row: Field, value: Any) -> int:
    if row.kind == "bool":
        return int(bool(value))
    most = MOST[str(row.kind)]
    if isinstance(value, float) and not value.is_integer():
        raise Malformed(f"{row.name} is {value}; it must be a whole number")
    whole = int(value)
    if not 0 <= whole < most:
        raise Malformed(f"{row.name} is {whole}; it must be from 0 to {most - 1}")
    return whole


def _check_bytes(row: Field, value: bytes) -> None:
    if row.kind == "string" and 0 in value:
        raise Malformed(f"{row.name} has a zero byte")
    if row.label == "repeated" or row.most is None:
        return
    if len(value) > row.most or (row.fixed and len(value) != row.most):
        raise Malformed(f"{row.name} has {len(value)} bytes; it must have "
                        f"{'' if row.fixed else 'at most '}{row.most}")


def _encode_value(row: Field, value: Any) -> bytes:
    if isinstance(row.kind, type):
        return field(row.number, encode(value))
    wire = WIRE_TYPES[row.kind]
    if wire == VARINT:
        return field(row.number, _number(row, value))
    if wire == BYTES:
        raw = value.encode() if isinstance(value, str) else bytes(value)
        _check_bytes(row, raw)
        return field(row.number, raw)
    try:
        return varint(row.number << 3 | wire) + struct.pack("<d" if wire == FIXED64 else "<f", value)
    except (OverflowError, struct.error):
        raise Malformed(f"{row.name} is {value!r}, which does not fit its type") from None


def encode(message: Message) -> bytes:
    """The message's bytes. Malformed: a value does not fit its field."""
    out = bytearray()
    for row in message.FIELDS.values():
        value = getattr(message, row.name)
        if row.label != "repeated":
            if value is not None:
                out += _encode_value(row, value)
            continue
        if row.most is not None and len(value) > row.most:
            raise Malformed(f"{row.name} has {len(value)} entries; it may have at most {row.most}")
        if not isinstance(row.kind, type) and WIRE_TYPES[row.kind] != BYTES:
            # Numbers are packed into one field, as in the examples of the specification.
            head = len(varint(row.number << 3))
            packed = b"".join(_encode_value(row, entry)[head:] for entry in value)
            out += field(row.number, packed) if value else b""
            continue
        for entry in value:
            out += _encode_value(row, entry)
    return bytes(out)


def _decode_value(row: Field, raw: int | bytes) -> Any:
    if isinstance(raw, int):
        return bool(raw) if row.kind == "bool" else _number(row, raw)
    if isinstance(row.kind, type):
        return decode(row.kind, raw)
    if row.kind == "double":
        return struct.unpack("<d", raw)[0]
    if row.kind == "float":
        return struct.unpack("<f", raw)[0]
    _check_bytes(row, raw)
    if row.kind == "bytes":
        return raw
    try:
        return raw.decode()
    except UnicodeDecodeError:
        raise Malformed(f"{row.name} is not UTF-8") from None


def _entries(row: Field, wire: int, raw: int | bytes) -> list[Any]:
    """The values of a field as it was sent. Numbers of a list may be packed into one field."""
    own = BYTES if isinstance(row.kind, type) else WIRE_TYPES[row.kind]
    if wire == own:
        return [raw]
    if row.label != "repeated" or wire != BYTES or not isinstance(raw, bytes):
        raise Malformed(f"{row.name} has wire type {wire}")
    found: list[Any] = []
    at = 0
    while at < len(raw):
        if own == VARINT:
            value, at = _take_varint(raw, at)
            found.append(value)
            continue
        size = 8 if own == FIXED64 else 4
        if size > len(raw) - at:
            raise Malformed(f"{row.name} is cut off")
        found.append(raw[at:at + size])
        at += size
    return found


def decode(kind: type[M], body: bytes) -> M:
    """The message of these bytes; unknown fields are skipped."""
    found: dict[str, Any] = {}
    for number, wire, raw in scan(body):
        row = kind.FIELDS.get(number)
        if row is None:
            continue
        values = [_decode_value(row, one) for one in _entries(row, wire, raw)]
        if row.label != "repeated":
            found[row.name] = values[0]
            continue
        entries = found.setdefault(row.name, [])
        entries += values
        if row.most is not None and len(entries) > row.most:
            raise Malformed(f"{row.name} has more than {row.most} entries")
    for row in kind.FIELDS.values():
        if row.label == "required" and row.name not in found:
            raise Malformed(f"{row.name} is missing")
    return kind(**found)

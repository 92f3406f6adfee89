"""The header of 16 bytes before each message."""
from __future__ import annotations

import struct

from sheen.errors import BadPeer, BadVersion
from sheen.messages import MAX_BODY_BYTES, Type

MAGIC = b"SHEN"
MAJOR = 1
HEADER = struct.Struct("<4sBBHII")
END = 1  # flag of the last DATA of an answer
CHUNK_BYTES = MAX_BODY_BYTES[Type.UPLOAD_CHUNK]
MAX_FRAME_BYTES = 4096 << 20
MAX_UPLOAD_BYTES = 1024 << 20
MAX_CREDITS = 64

def pack(kind: int, seq: int, body: bytes = b"", flags: int = 0) -> bytes:
    """A message's header and body."""
    return HEADER.pack(MAGIC, MAJOR, kind, flags, len(body), seq) + body


def unpack(head: bytes) -> tuple[Type, int, int, int]:
    """(type, flags, length, seq) of a header from the daemon, checked."""
    magic, major, kind, flags, length, seq = HEADER.unpack(head)
    if magic != MAGIC:
        raise BadPeer("the server broke the protocol: its message does not begin with SHEN")
    if major != MAJOR:
        raise BadVersion(f"the server speaks version {major} of the protocol, this client version {MAJOR}; install "
                         "the same version of sheen on both sides")
    try:
        known = Type(kind)
    except ValueError:
        raise BadPeer(f"the server broke the protocol: there is no message of type {kind}") from None
    if length > MAX_BODY_BYTES[known]:
        raise BadPeer(f"the server broke the protocol: {known.name} has {length} bytes; it may have at most "
                      f"{MAX_BODY_BYTES[known]}")
    return known, flags, length, seq



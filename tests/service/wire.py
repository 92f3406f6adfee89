"""A client of sheen's protocol that can also break the protocol on purpose. It encodes and decodes by the package of
client/python, which is written from protocol/README.md and not from the C code, so that each judges the other."""
import hashlib
import socket
import ssl

from sheen.header import HEADER, MAGIC
from sheen.messages import ErrorCode, Type
from sheen.protobuf import decode_fields as decode
from sheen.protobuf import field, varint

# HELLO, FRAME, ERROR_REQUEST and so on, as in the specification.
globals().update({**Type.__members__, **ErrorCode.__members__})
STILL, INTERACTIVE, BATCH = range(3)
RAW, ZSTD, PNG, EXR, JPEG, TIFF = range(6)
MODEL, IMAGE = 0, 1
ONE_STRIPES = 0
PATTERN_IMAGE = 3
PATIENCE = 1  # times the timeout of every client; daemon.py raises it for slow builds


def message(kind, seq, body=b"", flags=0, magic=MAGIC, major=1, length=None):
    length = len(body) if length is None else length
    return HEADER.pack(magic, major, kind, flags, length, seq) + body


def hello(seq=1, model=bytes(32), minor=0, token=None):
    return message(HELLO, seq, model + field(1, minor) + field(2, "test 1") +
                   (field(3, token) if token else b""))


def render(seq, model, width=64, height=48, encoding=RAW, planes=1, extra=b"", kind=None,
           view=None, deadline=None):
    later = b"".join(field(number, value) for number, value in
                     ((14, kind), (15, view), (16, deadline)) if value is not None)
    return message(RENDER, seq, field(1, model) + field(2, width) + field(3, height) + extra +
                   field(9, planes) + field(10, encoding) + later)


def upload_begin(seq, sha256, size, name, kind=MODEL, share=False):
    return message(UPLOAD_BEGIN, seq,
                   field(1, kind) + field(2, sha256) + field(3, size) + field(4, name) +
                   (field(5, 1) if share else b""))


class Refused(Exception):
    """The daemon's ERROR message."""

    def __init__(self, seq, code, text):
        super().__init__(f"ERROR {code} to {seq}: {text}")
        self.seq, self.code, self.text = seq, code, text


class Frame:
    def __init__(self, fields, data):
        self.width, self.height = fields[1][0], fields[2][0]
        self.encoding = fields[4][0]
        self.size = fields[5][0]
        times = decode(fields[6][0])
        self.tables_us, self.total_us = times[1][0], times[7][0]
        self.visibility_us, self.evaluate_us = times[2][0], times[3][0]
        self.data = data
        self.fields = fields


class Client:
    def __init__(self, address, greet=True, timeout=30, minor=0, buffer=None, tls=None, token=None):
        """`tls` is an ssl.SSLContext for a tls: address."""
        if address.startswith("unix:"):
            self.socket = socket.socket(socket.AF_UNIX)
            target = address[5:]
        else:
            self.socket = socket.socket()
            host, port = address[4:].rsplit(":", 1)
            target = (host, int(port))
        self.socket.settimeout(timeout * PATIENCE)
        if buffer:  # the receive buffer of a client that does not read
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer)
        self.socket.connect(target)
        if tls:
            self.socket = tls.wrap_socket(self.socket, server_hostname=target[0])
        self.seq = 1
        if greet:
            self.send(hello(minor=minor, token=token))
            self.credits = self.expect(HELLO_OK, 1)[9][0]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def send(self, data):
        self.socket.sendall(data)

    def next_seq(self):
        self.seq += 1
        return self.seq

    def read(self, size):
        out = bytearray()
        while len(out) < size:
            part = self.socket.recv(min(size - len(out), 1 << 20))
            if not part:
                raise EOFError(f"the daemon closed {size - len(out)} bytes early")
            out += part
        return bytes(out)

    def receive(self):
        """(type, flags, seq, body) of the next message that is not PROGRESS."""
        while True:
            magic, major, kind, flags, length, seq = HEADER.unpack(self.read(HEADER.size))
            assert (magic, major) == (MAGIC, 1), (magic, major)
            body = self.read(length)
            if kind == ERROR:
                fields = decode(body)
                raise Refused(seq, fields[1][0], fields[2][0].decode())
            if kind != PROGRESS:
                return kind, flags, seq, body

    def expect(self, kind, seq):
        got, _, got_seq, body = self.receive()
        assert (got, got_seq) == (kind, seq), (got, got_seq, kind, seq)
        return decode(body)

    def at_end(self):
        """True if the daemon has closed and no byte is left to read."""
        try:
            return self.socket.recv(1) == b""
        except (ConnectionResetError, ssl.SSLError):
            return True

    def upload(self, data, name, kind=MODEL, share=False):
        sha256 = hashlib.sha256(data).digest()
        seq = self.next_seq()
        self.send(upload_begin(seq, sha256, len(data), name, kind, share))
        state = self.expect(UPLOAD_STATE, seq)
        if not state[1][0]:
            for at in range(0, len(data), 262144):
                self.send(message(UPLOAD_CHUNK, seq, data[at:at + 262144]))
            state = self.expect(UPLOAD_STATE, seq)
            assert state[1][0] == 1, state
        return sha256

    def query(self, model):
        seq = self.next_seq()
        self.send(message(MODEL_QUERY, seq, field(1, model)))
        return self.expect(MODEL_INFO, seq)

    def find(self, name, sha256=bytes(32)):
        """The id of a model file in the daemon's folder."""
        seq = self.next_seq()
        self.send(message(MODEL_QUERY, seq, field(1, sha256) + field(2, name)))
        return self.expect(MODEL_INFO, seq)[1][0]

    def stats(self):
        seq = self.next_seq()
        self.send(message(STATS_QUERY, seq))
        return self.expect(STATS, seq)

    def read_frame(self, seq):
        return self.read_rest(seq, self.expect(FRAME, seq))

    def read_rest(self, seq, fields):
        data, end = bytearray(), False
        while not end:
            kind, flags, got_seq, body = self.receive()
            assert (kind, got_seq) == (DATA, seq) and 0 < len(body) <= 1 << 20
            data += body
            end = flags & 1
        frame = Frame(fields, bytes(data))
        assert frame.size == len(data)
        return frame

    def answer(self):
        """The next answer to a RENDER as (number, what): a Frame, the number of the request that superseded it, or
        the Refused."""
        try:
            kind, _, seq, body = self.receive()
        except Refused as refused:
            return refused.seq, refused
        if kind == SUPERSEDED:
            return seq, decode(body)[1][0]
        assert kind == FRAME, kind
        return seq, self.read_rest(seq, decode(body))

    def ask(self, model, *args, **named):
        """Sends a RENDER and returns its number."""
        seq = self.next_seq()
        self.send(render(seq, model, *args, **named))
        return seq

    def render(self, model, *args, **named):
        seq = self.next_seq()
        self.send(render(seq, model, *args, **named))
        return self.read_frame(seq)

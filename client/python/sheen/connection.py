"""A connection to a daemon: bytes, with a limit of the time without any."""
from __future__ import annotations

import re
import socket
import ssl
from typing import NoReturn, Union

from sheen.errors import BadArgument, Lost, NoServer, Timeout

Socket = Union[socket.socket, ssl.SSLSocket]
ADDRESS = re.compile(r"(tcp|tls):(?:\[([0-9a-zA-Z:.%]+)\]|([0-9a-zA-Z._-]+)):([0-9]{1,5})")
PATH_BYTES = 107  # the most that a Unix socket takes


def _tls(ca: str | None, cert: str | None, key: str | None) -> ssl.SSLContext:
    if (cert is None) != (key is None):
        raise BadArgument("cert and key come together")
    try:
        context = ssl.create_default_context(cafile=ca)
        context.minimum_version = ssl.TLSVersion.TLSv1_3
        if cert is not None:
            context.load_cert_chain(cert, key)
    except (OSError, ValueError) as wrong:  # ssl.SSLError is an OSError
        raise BadArgument(f"a file of ca, cert or key cannot be used: {wrong}") from None
    return context


def connect(address: str, timeout: float | None, ca: str | None, cert: str | None, key: str | None) -> Socket:
    """Connects to unix:PATH, tcp:HOST:PORT or tls:HOST:PORT; checks the certificate of a TLS server."""
    try:
        if address.startswith("unix:"):
            path = address[5:]
            if not path or len(path.encode()) > PATH_BYTES:
                raise BadArgument(f"address '{address}' has no path of 1 to {PATH_BYTES} bytes")
            made = socket.socket(socket.AF_UNIX)
            made.settimeout(timeout)
            made.connect(path)
            return made
        found = ADDRESS.fullmatch(address)
        if not found or not 1 <= int(found[4]) <= 65535:
            raise BadArgument(f"address '{address}' is none; write unix:PATH, tcp:HOST:PORT or tls:HOST:PORT")
        host = found[2] or found[3]
        context = _tls(ca, cert, key) if found[1] == "tls" else None
        plain = socket.create_connection((host, int(found[4])), timeout)
        plain.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return context.wrap_socket(plain, server_hostname=host) if context else plain
    except ssl.SSLCertVerificationError as wrong:
        raise Lost(f"{address}: this client does not trust the server: {wrong.verify_message}") from None
    except ssl.SSLError as wrong:
        raise Lost(f"{address}: no TLS connection: {wrong.reason or wrong}") from None
    except TimeoutError:
        raise Timeout(f"{address}: no connection within {timeout} s") from None
    except OSError as wrong:
        raise NoServer(f"cannot connect to {address}: {wrong.strerror or wrong}") from None


class Connection:
    """Reads and writes whole pieces. Every failure is a sheen.Error."""

    def __init__(self, made: Socket, timeout: float | None) -> None:
        self.socket = made
        self.set_timeout(timeout)

    def set_timeout(self, timeout: float | None) -> None:
        self.timeout = timeout
        self.socket.settimeout(timeout)

    def _fail(self, wrong: OSError) -> NoReturn:
        if isinstance(wrong, TimeoutError):
            raise Timeout(f"no byte came or went for {self.timeout} s") from None
        raise Lost(f"the connection broke: {wrong.strerror or wrong}") from None

    def read_into(self, view: memoryview) -> None:
        while view:
            try:
                got = self.socket.recv_into(view)
            except OSError as wrong:
                self._fail(wrong)
            if got == 0:
                raise Lost("the server closed the connection")
            view = view[got:]

    def read(self, size: int) -> bytes:
        data = bytearray(size)
        self.read_into(memoryview(data))
        return bytes(data)

    def write(self, data: bytes) -> None:
        view = memoryview(data)
        while view:
            try:
                view = view[self.socket.send(view):]
            except OSError as wrong:
                self._fail(wrong)

    def close(self) -> None:
        self.socket.close()



"""A server that passes messages on to a daemon, and can lose a connection at a chosen one."""
import os
import socket
import struct
import tempfile
import threading

import wire

FORWARD, HOLD, CUT = range(3)


def read(source, size):
    """Reads exactly so many bytes. Returns no bytes at the end of the connection."""
    out = b""
    while len(out) < size:
        part = source.recv(size - len(out))
        if not part:
            return b""
        out += part
    return out


def close(*sockets):
    for each in sockets:
        try:
            each.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass  # it has closed already


class Between:
    """A relay. `judge(connection, kind, seq, body, client)` decides about each message of a client: FORWARD, HOLD
    (the message is dropped) or CUT (both sides are closed). `connection` counts from 0, `client` is the client's
    socket. `cut_after`: the first connection is closed after so many bytes of the daemon's answers."""

    def __init__(self, daemon, judge=lambda *_: FORWARD, cut_after=None, n_accepted=None):
        self.daemon, self.judge, self.cut_after = daemon, judge, cut_after
        self.n_accepted = n_accepted  # connections beyond this number wait and are never served
        self.n_connections = 0
        self.sockets = []
        self.folder = tempfile.TemporaryDirectory(prefix="sheen-test-")
        self.path = os.path.join(self.folder.name, "between.sock")
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(self.path)
        self.listener.listen()
        self.threads = [threading.Thread(target=self.accept)]
        self.threads[0].start()

    @property
    def unix(self):
        return "unix:" + self.path

    def accept(self):
        while self.n_accepted is None or self.n_connections < self.n_accepted:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return  # the relay is finished
            server = socket.socket(socket.AF_UNIX)
            self.sockets += client, server
            server.connect(self.daemon.path)
            connection, self.n_connections = self.n_connections, self.n_connections + 1
            for work in (self.requests, self.answers):
                thread = threading.Thread(target=work, args=(connection, client, server))
                self.threads.append(thread)
                thread.start()

    def requests(self, connection, client, server):
        try:
            while header := read(client, 16):
                kind, _, length, seq = struct.unpack("<BHII", header[5:])
                body = read(client, length)
                what = self.judge(connection, kind, seq, body, client)
                if what == CUT:
                    break
                if what == FORWARD:
                    server.sendall(header + body)
        except OSError:
            pass  # one of the two connections has closed
        close(client, server)

    def answers(self, connection, client, server):
        left = self.cut_after if connection == 0 else None
        try:
            while data := server.recv(1 << 16 if left is None else min(left, 1 << 16)):
                client.sendall(data)
                if left is not None:
                    left -= len(data)
                    if left == 0:
                        break
        except OSError:
            pass  # one of the two connections has closed
        close(client, server)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        close(self.listener)
        self.listener.close()
        for thread in self.threads:
            thread.join(30)
        for each in self.sockets:
            each.close()
        self.folder.cleanup()


def cut_at(kind, number=1, connections=(0,)):
    """A judge that closes these connections at the number-th message of this kind."""
    seen = {}

    def judge(connection, got, *_):
        if got == kind and connection in connections:
            seen[connection] = seen.get(connection, 0) + 1
            if seen[connection] == number:
                return CUT
        return FORWARD

    return judge


def frame_number(body):
    """The number of a stream's frame, from its RENDER: the view, which the first frame leaves out."""
    return wire.decode(body).get(15, [0])[0]

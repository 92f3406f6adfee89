"""Random sequences of messages, valid and invalid ones, against a daemon. Each valid request has one answer; an
invalid message closes its own connection and no other. Sessions are made from a fixed seed: SHEEN_FUZZ_SEED (7).
`make fuzz` runs this for SHEEN_FUZZ_S seconds against a daemon with AddressSanitizer."""
import hashlib
import os
import random
import socket
import struct
import sys
import time
import unittest

import wire
from daemon import CUBE, Daemon
from wire import Client, field, message

SEED = int(os.environ.get("SHEEN_FUZZ_SEED", "7"))
SECONDS = float(os.environ.get("SHEEN_FUZZ_S", "0"))
SESSIONS = 150  # without SHEEN_FUZZ_S
PATIENCE_S = 10
FINAL = {wire.HELLO_OK, wire.UPLOAD_STATE, wire.MODEL_INFO, wire.STATS, wire.ERROR, wire.SUPERSEDED,
         wire.BREAKS, wire.CURVES, wire.COMPARED}
EDGES = (0.0, -0.0, 1.0, -1.0, 0.5, 1e-30, 1e30, -1e300, 5e-324, float("inf"), float("nan"))


class Script:
    """The bytes of a session, and the answers that it must get."""

    def __init__(self, noise, models):
        self.noise, self.models = noise, models
        self.minor = noise.choice((0, 1, 2, 3, 4, 5, 5, 9))
        self.seq, self.parts, self.answers = 1, [], {1: 1}  # number of a request: number of its answers
        self.is_right = True  # False after an invalid message, whose answers are not predicted
        self.parts.append(wire.hello(1, minor=self.minor))
        in_flight = 4 if self.minor == 0 else 16
        for _ in range(noise.randrange(1, in_flight)):
            noise.choice((self.render, self.render, self.render, self.stats, self.query, self.upload,
                          self.computation, self.cancel, self.oddity))()
            if not self.is_right:
                break

    def ask(self, kind, body, answers=1):
        self.seq += self.noise.choice((1, 1, 1, 2, 1000))
        self.parts.append(message(kind, self.seq, body))
        self.answers[self.seq] = answers

    def model(self):
        return self.noise.choice(self.models[:1] * 5 + self.models * 3 + [bytes(32)])

    def number(self):
        noise = self.noise
        return noise.choice(EDGES) if noise.random() < 0.02 else noise.uniform(-10, 10)

    def one_of(self, n):
        """A random number below n, sometimes n itself."""
        return n if self.noise.random() < 0.02 else self.noise.randrange(n)

    def vector(self):
        return b"".join(field(i, self.number()) for i in (1, 2, 3))

    def light(self):
        noise = self.noise
        light = b"".join(field(i, self.vector()) for i in (1, 2, 3)) if noise.random() < 0.5 else b""
        pattern = field(1, noise.choice((0, 1, 2, 5, self.one_of(7)))) + field(2, abs(self.number()))
        for number, scale in ((3, 0.1), (8, 10.0), (9, 1.0), (10, 0.05), (11, 0.1), (13, 0.05)):
            if noise.random() < 0.2:
                pattern += field(number, scale * abs(self.number()))
        return field(5, light + field(4, self.one_of(4)) + field(6, pattern))

    def render(self):
        noise = self.noise
        body = field(1, self.model()) + field(2, noise.choice((1, 7, 16, 48, 96))) + \
            field(3, noise.choice((1, 5, 16, 40)))
        if noise.random() < 0.4:
            body += field(4, field(1, self.vector()) + field(2, self.vector()) +
                          (field(4, self.number()) if noise.random() < 0.3 else b""))
        for _ in range(noise.choice((0, 0, 1, 2, 8))):
            body += self.light()
        if noise.random() < 0.3:
            body += field(6, field(1, noise.choice((0, 0, 1, self.one_of(5)))))
        encoding = self.one_of(6)
        planes = noise.choice((1, 1, 2, 255, 1 << self.one_of(8))) if encoding in (0, 1, 3) else 1
        body += field(9, planes) + field(10, encoding)
        if noise.random() < 0.2:
            body += field(13, field(1, self.one_of(7)))
        if noise.random() < 0.1:
            body += field(18, b"".join(field(i, abs(self.number())) for i in (1, 2)) +
                          b"".join(field(i, noise.choice((1, 16, 100, 1280, 65536))) for i in (3, 4)))
        if noise.random() < 0.7:
            body += field(14, self.one_of(3))
        if noise.random() < 0.3:
            body += field(15, noise.randrange(3))
        if noise.random() < 0.1:
            body += field(16, noise.choice((0, 1, 60000)))
        if noise.random() < 0.2:
            body += field(40, self.one_of(3)) + field(41, noise.randrange(5))
        self.ask(wire.RENDER, body)

    def computation(self):
        """A computation; before 1.5 it breaks the protocol."""
        noise = self.noise
        if self.minor < 5 and noise.random() < 0.9:
            return
        self.is_right = self.minor >= 5
        scene = field(1, self.model()) + field(2, 64) + field(3, 48) + field(9, 1) + field(10, 0)
        for _ in range(noise.choice((0, 0, 1, 2))):
            scene += self.light()
        if noise.random() < 0.3:
            scene += field(6, field(1, self.one_of(5)))
        if noise.random() < 0.2:
            scene += field(16, noise.choice((0, 1, 60000)))
        noise.choice((self.find_breaks, self.trace_lines, self.compare))(scene)

    def limits(self, numbers):
        return b"".join(field(number, abs(self.number())) for number in numbers if self.noise.random() < 0.3)

    def find_breaks(self, scene):
        self.ask(wire.FIND_BREAKS, field(1, scene) + self.limits((2, 3, 4)))

    def trace_lines(self, scene):
        noise = self.noise
        places = b"".join(field(3, self.number()) for _ in range(noise.choice((0, 0, 1, 3))))
        self.ask(wire.TRACE_LINES, field(1, scene) + self.limits((2,)) + places +
                 field(4, noise.choice((0, 0, 0, 1))))

    def compare(self, scene):
        noise = self.noise
        self.ask(wire.COMPARE, field(1, scene) + field(2, self.model()) + self.limits((3, 4, 5, 6, 7)) +
                 field(8, noise.choice((0, 0, 1))) + field(9, noise.choice((1000, 1000, 3000, self.one_of(1000)))))

    def stats(self):
        self.ask(wire.STATS_QUERY, b"")

    def query(self):
        self.ask(wire.MODEL_QUERY, field(1, self.model()))

    def cancel(self):
        if self.minor > 0:
            self.parts.append(message(wire.CANCEL, self.noise.choice(list(self.answers))))

    def cage(self):
        """A small file, often damaged."""
        noise, lines = self.noise, []
        n = noise.randrange(3, 12)
        for _ in range(n):
            lines.append("v " + " ".join(f"{self.number():g}" for _ in range(3)))
        for _ in range(noise.randrange(1, 10)):
            corners = noise.sample(range(1, n + 1), min(n, noise.choice((3, 4, 4, 5))))
            corners = [13] if noise.random() < 0.05 else corners
            lines.append("f " + " ".join(map(str, corners)))
        if noise.random() < 0.5:
            lines.append(f"t crease 2/1/0 {noise.randrange(9)} {noise.randrange(9)} {self.number():g}")
        data = bytearray("\n".join(lines).encode() + b"\n")
        for _ in range(noise.choice((0, 0, 0, 3))):
            data[noise.randrange(len(data))] = noise.randrange(256)
        return bytes(data)

    def upload(self):
        """An answer to the beginning and one to the last byte; a single answer if the daemon has the file."""
        noise, data = self.noise, self.cage()
        sha = hashlib.sha256(data).digest()
        if noise.random() < 0.1:
            sha = bytes(32)
        self.seq += 1
        self.parts.append(wire.upload_begin(self.seq, sha, len(data), "a.obj"))
        at = 0
        while at < len(data):
            size = noise.randrange(1, len(data) - at + 1)
            self.parts.append(message(wire.UPLOAD_CHUNK, self.seq, data[at:at + size]))
            at += size
        self.answers[self.seq] = 2
        self.models.append(sha)
        del self.models[1:-20]

    def oddity(self):
        """Adds a message that breaks the protocol."""
        noise = self.noise
        self.is_right = False
        self.parts.append(noise.choice((
            message(noise.randrange(256), noise.choice((0, 1, self.seq + 1)), noise.randbytes(40)),
            message(wire.RENDER, self.seq + 1, noise.randbytes(noise.randrange(200))),
            message(wire.UPLOAD_CHUNK, self.seq + 1, b"x"),
            message(wire.RENDER, self.seq + 1, b"", length=noise.choice((1, 0xffffffff, 8193))),
            message(wire.STATS_QUERY, 0), wire.hello(self.seq + 1),
            message(wire.STATS_QUERY, self.seq + 1, magic=b"SHEM"),
            message(wire.STATS_QUERY, self.seq + 1, major=2),
            wire.upload_begin(self.seq + 1, bytes(32), noise.choice((0, 10, 1 << 40)), "a.obj"))))

    def bytes(self):
        data = bytearray(b"".join(self.parts))
        if self.noise.random() < 0.3:  # damages a random byte
            self.is_right = False
            for _ in range(self.noise.choice((1, 1, 4))):
                at = self.noise.randrange(len(data))
                how = self.noise.randrange(3)
                if how == 0:
                    data[at] ^= 1 << self.noise.randrange(8)
                elif how == 1:
                    del data[at:at + self.noise.randrange(1, 40)]
                else:
                    data[at:at] = data[at:at + self.noise.randrange(1, 40)]
                if not data:
                    break
        return bytes(data)


class Sequences(unittest.TestCase):
    def run_session(self, daemon, script, noise):
        """Returns how often each number was answered, or None if the session was left unread."""
        data = script.bytes()
        leaves = noise.random() < 0.1
        address = daemon.unix if noise.random() < 0.5 else daemon.tcp
        with Client(address, greet=False, timeout=PATIENCE_S) as client:
            at = 0
            try:
                while at < len(data):
                    size = noise.choice((1, 3, 16, 100, 1000, 100000))
                    client.send(data[at:at + size])
                    at += size
                if leaves:
                    return None
                client.socket.shutdown(socket.SHUT_WR)
            except OSError:  # the daemon has closed the connection because of what was sent
                self.assertFalse(script.is_right)
                return None
            return self.read_answers(client, script.is_right)

    def read_answers(self, client, is_right):
        counts, left = {}, {}
        while True:
            try:
                header = client.socket.recv(16, socket.MSG_WAITALL)
            except ConnectionResetError:
                self.assertFalse(is_right)
                return counts
            if not header:
                return counts
            magic, major, kind, flags, length, seq = struct.unpack("<4sBBHII", header)
            self.assertEqual((magic, major), (wire.MAGIC, 1))
            body = client.read(length)
            size = wire.decode(body)[{wire.FRAME: 5, wire.BREAKS: 1, wire.CURVES: 1}[kind]][0] \
                if kind in (wire.FRAME, wire.BREAKS, wire.CURVES) else 0
            if size > 0:
                self.assertNotIn(seq, left)
                left[seq] = size
            elif kind == wire.DATA:
                left[seq] -= length
                if flags & 1:
                    self.assertEqual(left.pop(seq), 0)
                    counts[seq] = counts.get(seq, 0) + 1
            elif kind != wire.PROGRESS:
                self.assertIn(kind, FINAL)
                counts[seq] = counts.get(seq, 0) + 1

    def check(self, script, counts):
        if counts is None or not script.is_right:
            return
        self.assertLessEqual(set(counts), set(script.answers))
        for seq, answers in script.answers.items():
            self.assertIn(counts.get(seq, 0), (1, answers), (seq, script.parts))

    def test_sequences(self):
        daemon = Daemon("--max-upload", "64K", "--memory-budget", "128M")
        end, number, right = time.monotonic() + SECONDS, 0, 0
        with Client(daemon.unix, timeout=PATIENCE_S) as innocent:
            cube = innocent.upload(CUBE, "cube.obj", share=True)
            models = [cube]
            while number < SESSIONS if SECONDS == 0 else time.monotonic() < end:
                noise = random.Random(f"{SEED} {number}")
                script = Script(noise, models)
                try:
                    self.check(script, self.run_session(daemon, script, noise))
                    if number % 10 == 0:
                        innocent.render(cube)
                except Exception:
                    print(f"session {number} of seed {SEED}; log: {daemon.errors()[-3000:]}",
                          file=sys.stderr)
                    raise
                right += script.is_right
                number += 1
            innocent.render(cube)
        self.assertGreater(right, number / 4)
        self.assertEqual(daemon.stop(), 0, daemon)

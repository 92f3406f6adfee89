"""Random cages, whole and damaged ones, through a daemon: each is drawn or refused with one clear answer, its numbers
are finite, and a second frame has the same bytes. Cages are made from a fixed seed: SHEEN_FUZZ_SEED (7). `make fuzz`
runs this for SHEEN_FUZZ_S seconds against a daemon with AddressSanitizer."""
import math
import os
import random
import struct
import sys
import time
import unittest

import wire
from daemon import CUBE, Daemon
from wire import Client, Refused, field

SEED = int(os.environ.get("SHEEN_FUZZ_SEED", "7"))
SECONDS = float(os.environ.get("SHEEN_FUZZ_S", "0"))
CAGES = 60  # without SHEEN_FUZZ_S
PATIENCE_S = 10
POSITION, PTEX, COVERAGE = 2, 8, 128
WIDTH, HEIGHT = 48, 40
NONE = 0xffffffff
REFUSALS = {wire.ERROR_MODEL, wire.ERROR_TOO_BIG, wire.ERROR_REQUEST}
TAGS = ("interpolateboundary 1/0/0 {0}", "interpolateboundary 1/0/0 0", "creasemethod 0/0/1 chaikin",
        "smoothtriangles 1/0/0 1", "facevaryinginterpolateboundary 1/0/0 1", "weld 0/0/0", "hole 1/0/0 {0}")


class Cage:
    """A mesh that begins as a regular shape, and steps that take away from its regularity."""

    def __init__(self, noise):
        self.noise, self.points, self.faces, self.tags = noise, [], [], []
        noise.choice((self.sheet, self.fan, self.tube, self.soup))()
        for _ in range(noise.choice((0, 1, 2, 4))):
            noise.choice((self.poke, self.remove, self.merge, self.join, self.fin, self.turn, self.double,
                          self.flatten, self.move_far, self.coincide, self.line_up))()
        for _ in range(noise.choice((0, 0, 1, 3))):
            noise.choice((self.crease, self.crease, self.corner, self.other_tag))()

    def add(self, *point):
        self.points.append(point)
        return len(self.points) - 1

    def sheet(self):
        columns, rows = self.noise.randrange(1, 6), self.noise.randrange(1, 6)
        for y in range(rows + 1):
            for x in range(columns + 1):
                self.add(x, y, self.noise.uniform(-1, 1))
        for y in range(rows):
            for x in range(columns):
                a = y * (columns + 1) + x
                self.faces.append([a, a + 1, a + columns + 2, a + columns + 1])

    def fan(self):
        """Faces around one vertex, open or closed."""
        n, size = self.noise.choice((3, 4, 5, 7, 20, 60)), self.noise.choice((3, 4))
        middle = self.add(0, 0, self.noise.uniform(-1, 1))
        for k in range(n * (size - 2)):
            angle = 2 * math.pi * k / (n * (size - 2))
            self.add(math.cos(angle), math.sin(angle), self.noise.uniform(-0.5, 0.5))
        ring = len(self.points) - 1
        for k in range(n - self.noise.randrange(2)):
            edge = [1 + (k * (size - 2) + j) % ring for j in range(size - 1)]
            self.faces.append([middle, *edge])

    def tube(self):
        around, along = self.noise.choice((3, 4, 6)), self.noise.randrange(1, 4)
        for y in range(along + 1):
            for k in range(around):
                angle = 2 * math.pi * k / around
                self.add(math.cos(angle), math.sin(angle), y)
        for y in range(along):
            for k in range(around):
                a, b = y * around + k, y * around + (k + 1) % around
                self.faces.append([a, b, b + around, a + around])
        if self.noise.random() < 0.5:
            self.faces.append(list(range(around))[::-1])  # a lid

    def soup(self):
        n = self.noise.randrange(3, 14)
        for _ in range(n):
            self.add(*(self.noise.uniform(-1, 1) for _ in range(3)))
        for _ in range(self.noise.randrange(1, 12)):
            self.faces.append(self.noise.sample(range(n), min(n, self.noise.choice((3, 3, 4, 4, 5, 9)))))

    def face(self):
        return self.noise.choice(self.faces)

    def poke(self):
        """Triangles around a new vertex in the middle of a face."""
        face = self.face()
        if len(self.faces) > 300:
            return
        middle = self.add(*(sum(self.points[i][k] for i in face) / len(face) for k in range(3)))
        self.faces.remove(face)
        self.faces += [[face[k - 1], face[k], middle] for k in range(len(face))]

    def remove(self):
        if len(self.faces) > 1:
            self.faces.remove(self.face())

    def merge(self):
        """Two vertices become one: faces lose corners, and sheets touch."""
        a, b = (self.noise.randrange(len(self.points)) for _ in range(2))
        self.faces = [[a if i == b else i for i in face] for face in self.faces]

    def join(self):
        """Two faces of a common edge become one of more corners."""
        a, b = self.face(), self.face()
        common = [i for i in a if i in b]
        if len(common) == 2 and len(a) + len(b) < 40:
            self.faces = [face for face in self.faces if face not in (a, b)]
            self.faces.append(list(dict.fromkeys(a + b)))

    def fin(self):
        """A third face at an edge."""
        face = self.face()
        tops = [self.add(*(x + self.noise.uniform(-1, 1) for x in self.points[i])) for i in face[:2]]
        self.faces.append([face[1], face[0], *tops])

    def turn(self):
        self.face().reverse()

    def double(self):
        self.faces.append(list(self.face()))

    def flatten(self):
        """Vertices at one place."""
        at = self.noise.choice(self.points)
        for i in self.face():
            self.points[i] = at

    def coincide(self):
        """Two vertices at one place."""
        a, b = (self.noise.randrange(len(self.points)) for _ in range(2))
        self.points[a] = self.points[b]

    def line_up(self):
        """A face without area: its vertices on the line through two of them."""
        face = self.face()
        a, b = self.points[face[0]], self.points[face[1]]
        for i in face[2:]:
            t = self.noise.choice((0, 0.5, 1, self.noise.random()))
            self.points[i] = tuple(x + t * (y - x) for x, y in zip(a, b))

    def move_far(self):
        far = self.noise.choice((1e-30, 1e6, 1e15, 1e29, -1e30))
        i = self.noise.randrange(len(self.points))
        self.points[i] = (far, *self.points[i][1:])

    def sharpness(self):
        return self.noise.choice((0, 0.3, 1, 1.5, 2, 3.7, 9.99, 10, 11, -1, self.noise.uniform(0, 10)))

    def crease(self):
        face = self.face()
        k = self.noise.randrange(len(face))
        self.tags.append(f"crease 2/1/0 {face[k - 1]} {face[k]} {self.sharpness():g}")

    def corner(self):
        self.tags.append(f"corner 1/1/0 {self.noise.choice(self.face())} {self.sharpness():g}")

    def other_tag(self):
        self.tags.append(self.noise.choice(TAGS).format(self.noise.randrange(4)))

    def text(self):
        lines = ["v " + " ".join(f"{x:.9g}" for x in point) for point in self.points]
        lines += ["f " + " ".join(str(i + 1) for i in face) for face in self.faces]
        lines += ["t " + tag for tag in self.tags]
        data = bytearray("\n".join(lines).encode() + b"\n")
        if self.noise.random() < 0.15:  # damages the text
            for _ in range(self.noise.choice((1, 1, 5))):
                data[self.noise.randrange(len(data))] = self.noise.choice(b"0123456789.-e/ \nvft\xff\0")
        return bytes(data)


class Cages(unittest.TestCase):
    def camera(self, noise):
        if noise.random() < 0.5:
            return b""
        eye = b"".join(field(k, noise.uniform(-4, 4)) for k in (1, 2, 3))
        target = b"".join(field(k, noise.uniform(0, 1)) for k in (1, 2, 3))
        return field(4, field(1, eye) + field(2, target))

    def check_planes(self, data, n_faces):
        """Position and face of each pixel, and the share of it that shows the surface."""
        n = WIDTH * HEIGHT
        positions = struct.unpack(f"<{3 * n}f", data[:12 * n])
        faces = [row[0] for row in struct.iter_unpack("<Iff", data[12 * n:24 * n])]
        shares = struct.unpack(f"<{n}f", data[24 * n:])
        for k in range(n):
            self.assertTrue(0 <= shares[k] <= 1, shares[k])
            if faces[k] == NONE:
                continue
            self.assertLess(faces[k], n_faces)
            self.assertGreater(shares[k], 0)
            self.assertTrue(all(map(math.isfinite, positions[3 * k:3 * k + 3])), (k, positions[3 * k:3 * k + 3]))

    def draw(self, client, noise, data):
        """True if the daemon takes the cage and draws it."""
        try:
            model = client.upload(data, "a.obj")
            client.query(model)
            camera = self.camera(noise)
            planes = client.render(model, WIDTH, HEIGHT, planes=POSITION | PTEX | COVERAGE, extra=camera)
            # n-gons have a Ptex face for each corner
            self.check_planes(planes.data, data.count(b" ") + 1)
            pattern = field(5, field(6, field(1, noise.randrange(3)) + field(2, 9.0)))
            kind = noise.choice((0, 0, 1, 2))
            surface = field(40, kind) + (field(41, noise.randrange(3)) if kind else b"")
            first, second = (client.render(model, WIDTH, HEIGHT, extra=camera + pattern + surface).data
                             for _ in range(2))
            self.assertEqual(first, second)
        except Refused as refused:
            self.assertIn(refused.code, REFUSALS, refused)
            self.assertGreater(len(refused.text), 10)
            return False
        return True

    def test_cages(self):
        daemon = Daemon("--max-upload", "64K", "--memory-budget", "128M")
        end, number, drawn = time.monotonic() + SECONDS, 0, 0
        with Client(daemon.unix, timeout=PATIENCE_S) as innocent:
            cube = innocent.upload(CUBE, "cube.obj", share=True)
            before = innocent.render(cube).data
            while number < CAGES if SECONDS == 0 else time.monotonic() < end:
                noise = random.Random(f"{SEED} {number}")
                data = Cage(noise).text()
                try:
                    with Client(daemon.unix, timeout=PATIENCE_S) as client:
                        drawn += self.draw(client, noise, data)
                    if number % 10 == 0:
                        self.assertEqual(innocent.render(cube).data, before)
                except Exception:
                    print(f"cage {number} of seed {SEED}:\n{data.decode(errors='replace')}\nlog: {daemon.errors()[-3000:]}",
                          file=sys.stderr)
                    raise
                number += 1
        print(f"{number} cages, {drawn} of them drawn", file=sys.stderr)
        self.assertGreater(drawn, number / 2)
        self.assertEqual(daemon.stop(), 0, daemon)

"""--surface: polygons and wireframe compared with the exact surface, and `sheen levels`."""
import json
import math
import os
import struct
import subprocess
import tempfile

import wire
from daemon import CUBE, MODELS, SHEEN, DaemonCase, grid
from png import read_png

EXACT, POLYGON, WIREFRAME = range(3)
COLOUR, NORMAL, PTEX = 1, 4, 8
NONE = 0xffffffff
WIDTH, HEIGHT = 200, 150
BODY = os.path.join(MODELS, "body.obj")


def surface(kind, level=None):
    return wire.field(40, kind) + (b"" if level is None else wire.field(41, level))


class Planes:
    def __init__(self, client, model, extra):
        data = client.render(model, WIDTH, HEIGHT, wire.RAW, COLOUR | NORMAL | PTEX, extra).data
        n = WIDTH * HEIGHT
        self.colour = data[:4 * n]
        normals = struct.unpack(f"<{3 * n}f", data[4 * n:16 * n])
        self.normal = [normals[3 * k:3 * k + 3] for k in range(n)]
        self.face = [row[0] for row in struct.iter_unpack("<Iff", data[16 * n:])]


def off_deg(a, b):
    """(largest, mean) angle between the normals of pixels that show the same Ptex face in both."""
    angles = [2 * math.degrees(math.asin(min(1, math.dist(a.normal[k], b.normal[k]) / 2)))
              for k in range(WIDTH * HEIGHT) if a.face[k] == b.face[k] != NONE]
    return max(angles), sum(angles) / len(angles)


class Surface(DaemonCase):
    def model(self, client, path=BODY):
        with open(path, "rb") as file:
            return client.upload(file.read(), os.path.basename(path))

    def test_polygons_come_to_the_exact_surface(self):
        with wire.Client(self.daemon.unix) as client:
            model = self.model(client)
            exact = Planes(client, model, b"")
            self.assertEqual(Planes(client, model, surface(EXACT)).colour, exact.colour)
            last = None
            for level in range(7):
                polygons = Planes(client, model, surface(POLYGON, level))
                largest, mean = off_deg(polygons, exact)
                print(f"level {level}: {largest:.4f} deg at most, {mean:.5f} on average")
                if last:
                    self.assertLess(mean, last / 3.4)
                last = mean
            self.assertLess(last, 2e-3)
            self.assertLess(largest, 0.3)
            # Only the exact surface is antialiased at edges and where its curvature is high.
            near = sum(max(abs(a - b) for a, b in zip(polygons.colour[4 * k:4 * k + 3],
                                                      exact.colour[4 * k:4 * k + 3])) <= 8
                       for k in range(WIDTH * HEIGHT))
            self.assertGreater(near, 0.97 * WIDTH * HEIGHT)

    def test_wireframe_differs(self):
        with wire.Client(self.daemon.unix) as client:
            model = self.model(client)
            exact = Planes(client, model, b"")
            wires = Planes(client, model, surface(WIREFRAME, 1))
            polygons = Planes(client, model, surface(POLYGON, 1))
            self.assertNotEqual(wires.colour, polygons.colour)
            self.assertEqual(wires.face, polygons.face)
            greys = {wires.colour[4 * k] for k in range(WIDTH * HEIGHT) if wires.face[k] != NONE}
            self.assertTrue(min(greys) < 80 and max(greys) == 219, greys)
            for k in range(WIDTH * HEIGHT):
                r, g, b, _ = wires.colour[4 * k:4 * k + 4]
                self.assertTrue(r == g == b)
            # The command leaves no daemon behind.
            self.assertEqual(Planes(client, model, b"").colour, exact.colour)

    def test_refused(self):
        with wire.Client(self.daemon.unix) as client:
            model = self.model(client)
            for seq, (extra, words) in enumerate((
                    (surface(POLYGON, 7), "surface_level"), (surface(3, 1), "surface"),
                    (surface(EXACT, 1), "surface_level")), 50):
                client.send(wire.render(seq, model, extra=extra))
                self.assert_refused(client, wire.ERROR_REQUEST, words, seq)
            many = client.upload(grid(60), "many.obj")
            client.send(wire.render(60, many, extra=surface(POLYGON, 6)))
            self.assert_refused(client, wire.ERROR_REQUEST, "level 5 or less", 60)
            self.assertEqual(len(client.render(many, extra=surface(POLYGON, 2)).data), 64 * 48 * 4)

    def sheen(self, *arguments):
        return subprocess.run([SHEEN, *arguments, "--server", self.daemon.unix],
                              capture_output=True, text=True, timeout=120)

    def test_the_file_says_it(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.png")
            for name in ("exact", "polygon:2", "wireframe:0"):
                done = self.sheen("render", BODY, "-o", path, "--size", "64x48", "--surface", name)
                self.assertEqual(done.returncode, 0, done.stderr)
                with open(path, "rb") as file:
                    self.assertIn(b"sheen:surface\0" + name.encode(), file.read())

    def test_levels(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "levels.png")
            done = self.sheen("levels", BODY, "-o", path, "--size", "240x180", "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            answer = json.loads(done.stdout)
            width, height, rows = read_png(path)
            self.assertEqual((width, height), (answer["width"], answer["height"]))
            self.assertTrue(720 < width < 800 and 540 < height < 720, (width, height))
            self.assertEqual([level["level"] for level in answer["levels"]], [1, 2, 3])
            for worse, better in zip(answer["levels"], answer["levels"][1:]):
                self.assertLess(better["max_deg"], worse["max_deg"] / 1.5)
                self.assertLess(better["mean_deg"], worse["mean_deg"] / 3.4)
            self.check_panels(rows, height)
            text = self.sheen("figure7", BODY, "-o", path, "--size", "240x180")  # its old name
            self.assertEqual(len(text.stdout.splitlines()), 3)
            self.assertIn(f"up to {answer['levels'][0]['max_deg']:.3g} deg", text.stdout)

    def check_panels(self, rows, height):
        """The exact panel is the same picture in each row, the other panels differ; text stands below."""
        gap, step = 6, (height - 6) // 3

        def panel(column, row):
            x, y = gap + column * (240 + gap), gap + row * step
            return [bytes(line[3 * x:3 * (x + 240)]) for line in rows[y:y + 180]]

        for column, different in ((0, 3), (1, 3), (2, 1)):
            pictures = {b"".join(panel(column, row)) for row in range(3)}
            self.assertEqual(len(pictures), different)
        with wire.Client(self.daemon.unix) as client:
            exact = client.render(self.model(client), 240, 180).data
        rgb = b"".join(exact[k:k + 3] for k in range(0, len(exact), 4))
        self.assertEqual(b"".join(panel(2, 0)), rgb)
        for row in range(3):
            caption = rows[gap + row * step + 180:(row + 1) * step]
            ink = [sum(line[3 * x] == 0 for line in caption for x in range(at, at + 240))
                   for at in (gap, 246 + gap, 492 + gap)]
            self.assertTrue(ink[1] > ink[0] > ink[2] > 20, ink)

    def test_levels_refuses(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "x.png")
            cube = os.path.join(folder, "cube.obj")
            with open(cube, "wb") as file:
                file.write(CUBE + b"f 1 2 99\n")
            for code, words, *arguments in (
                    (2, "-o FILE", BODY), (2, ".png", BODY, "-o", path + ".exr"),
                    (2, "--surface is no option", BODY, "-o", path, "--surface", "polygon:1"),
                    (2, "--show is no option", BODY, "-o", path, "--show", "mean"),
                    (2, "--show-range is no", BODY, "-o", path, "--show-range", "2"),
                    (3, "cube.obj", cube, "-o", path),
                    (3, "nowhere", BODY, "-o", os.path.join(folder, "nowhere", "x.png"))):
                with self.subTest(words=words):
                    done = self.sheen("levels", *arguments)
                    self.assertEqual(done.returncode, code, done.stderr)
                    self.assertIn(words, done.stderr)
                    self.assertEqual(len(done.stderr.splitlines()), 1)
                    self.assertFalse(os.path.exists(path))

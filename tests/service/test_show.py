"""False colour by --show, through the whole program."""
import json
import math
import os
import struct
import unittest

import wire
from daemon import MODELS, SHEEN, DaemonCase
from test_client import sheen

CURVATURE, GAUSSIAN, MEAN, NORMAL, PTEX, DRAFT = range(1, 7)
COLOUR, P, PTEX_PLANE, K, COVERAGE = 1, 2, 8, 32, 128
WIDTH, HEIGHT = 160, 110  # too low for a legend
EMPTY = bytes((128, 128, 128, 255))
BODY, PLANE = os.path.join(MODELS, "body.obj"), os.path.join(MODELS, "plane.obj")


def read(path):
    with open(path, "rb") as file:
        return file.read()


def vec3(x, y, z):
    return wire.field(1, float(x)) + wire.field(2, float(y)) + wire.field(3, float(z))


def show(kind, direction=None, scale=None, surface=b""):
    body = wire.field(1, kind)
    if direction:
        body += wire.field(2, vec3(*direction))
    if scale:
        body += wire.field(3, float(scale))
    return wire.field(13, body) + surface


def pixels(data):
    return [data[i:i + 4] for i in range(0, 4 * WIDTH * HEIGHT, 4)]


def whole(data):
    """The pixels that are covered by surface or emptiness alone, and how many others there are."""
    cover = struct.unpack(f"<{WIDTH * HEIGHT}f", data[-4 * WIDTH * HEIGHT:])
    found = [pixel for pixel, share in zip(pixels(data), cover) if share in (0, 1)]
    return found, WIDTH * HEIGHT - len(found)


class Show(DaemonCase):
    def render(self, path, extra, planes=COLOUR):
        with wire.Client(self.daemon.unix) as client:
            model = client.upload(read(path), os.path.basename(path))
            return client.render(model, WIDTH, HEIGHT, planes=planes, extra=extra).data

    def test_a_convex_body_is_blue_by_its_mean(self):
        """The picture is blue where the body is convex. The answer has the requested planes only, and they are the
        same as without --show."""
        data = self.render(BODY, show(MEAN), COLOUR | K)
        self.assertEqual(len(data), WIDTH * HEIGHT * 12)
        curvature = data[4 * WIDTH * HEIGHT:]
        self.assertEqual(curvature, self.render(BODY, b"", K))
        n_blue = 0
        cover = struct.iter_unpack("<f", self.render(BODY, b"", COVERAGE))
        for pixel, (low, high), (share,) in zip(pixels(data), struct.iter_unpack("<2f", curvature),
                                                cover):
            if share == 0:
                self.assertEqual(pixel, EMPTY)
            elif low + high < -0.1:
                self.assertGreater(pixel[2], pixel[0], (low, high))
                n_blue += 1
        self.assertGreater(n_blue, 500)
        gaussian = {p for p in pixels(self.render(BODY, show(GAUSSIAN))) if p != EMPTY}
        red = sum(p[0] > p[2] for p in gaussian)
        self.assertGreater(red, len(gaussian) / 2, "a body's Gaussian curvature is positive")

    def test_extremes(self):
        """The extremes equal those of the planes of the same frame; with the Ptex plane they have a place on the
        surface."""
        def place(extreme):
            found = wire.decode(extreme)
            numbers = [struct.unpack("<d", found[k][0])[0] if k in found else None
                       for k in (1, 6, 7)]
            at = [struct.unpack("<d", value)[0] for value, in wire.decode(found[4][0]).values()]
            return numbers, found[2][0] + WIDTH * found[3][0], at, found.get(5)

        with wire.Client(self.daemon.unix) as client:
            model = client.upload(read(BODY), "body.obj")
            for planes in (COLOUR | P | K, COLOUR | P | PTEX_PLANE | K):
                seq = client.ask(model, WIDTH, HEIGHT, planes=planes, extra=show(MEAN))
                fields = client.expect(wire.FRAME, seq)
                data = client.read_rest(seq, fields).data[4 * WIDTH * HEIGHT:]
                n = WIDTH * HEIGHT
                position = list(struct.iter_unpack("<3f", data[:12 * n]))
                ptex = list(struct.iter_unpack("<I2f", data[12 * n:-8 * n]))
                mean = [(a + b) / 2 for a, b in struct.iter_unpack("<2f", data[-8 * n:])]
                seen = [(value, i) for i, value in enumerate(mean) if math.isfinite(value)]
                greatest = max(seen, key=lambda found: (found[0], -found[1]))
                for number, (value, i) in ((40, min(seen)), (41, greatest)):
                    numbers, at, where, face = place(fields[number][0])
                    self.assertEqual((numbers[0], at, tuple(where)), (value, i, position[i]))
                    if ptex:
                        self.assertEqual((face[0], *numbers[1:]), ptex[i])
                    else:
                        self.assertIsNone(face)
            for extra in (b"", show(NORMAL)):
                seq = client.ask(model, WIDTH, HEIGHT, extra=extra)
                fields = client.expect(wire.FRAME, seq)
                client.read_rest(seq, fields)
                self.assertFalse({40, 41} & set(fields))

    def test_a_plane_has_one_draft(self):
        for direction, colour in (((0, 0, 2), (0, 84, 38)), ((0, 0, -1), (128, 0, 13)),
                                  ((1, 0, 0.03), (255, 224, 64)), ((1, 0, -0.03), (237, 173, 26))):
            for surface in (b"", wire.field(40, 1) + wire.field(41, 1)):
                with self.subTest(direction=direction, polygon=bool(surface)):
                    extra = show(DRAFT, direction, surface=surface)
                    if surface:
                        found = pixels(self.render(PLANE, extra))
                    else:
                        found, n_mixed = whole(self.render(PLANE, extra, COLOUR | COVERAGE))
                        self.assertTrue(100 < n_mixed < 1000, n_mixed)
                    self.assertEqual(set(found), {EMPTY, bytes((*colour, 255))})

    def test_faces_and_normals(self):
        found, _ = whole(self.render(PLANE, show(NORMAL), COLOUR | COVERAGE))
        self.assertEqual(set(found), {EMPTY, bytes((128, 128, 255, 255))})
        self.assertGreater(len(set(pixels(self.render(PLANE, show(PTEX))))), 36)

    def test_outlines_are_antialiased(self):
        """Outlines are close to those of a picture eight times as large, and closer than with one sample for each
        pixel."""
        scale, one_sample = 8, wire.field(12, 1)
        with wire.Client(self.daemon.unix) as client:
            model = client.upload(read(BODY), "body.obj")
            big = client.render(model, WIDTH * scale, HEIGHT * scale,
                                extra=one_sample + show(NORMAL)).data
            cover = struct.unpack(f"<{WIDTH * HEIGHT}f",
                                  client.render(model, WIDTH, HEIGHT, planes=COVERAGE).data)
        smooth, rough = (pixels(self.render(BODY, extra + show(NORMAL)))
                         for extra in (b"", one_sample))
        errors, n = [0, 0], 0
        for i, share in enumerate(cover):
            x, y = i % WIDTH * scale, i // WIDTH * scale
            if share in (0, 1) or y > HEIGHT * scale * 2 // 3:  # the large picture has a legend
                continue
            n += 1
            for k in range(3):
                mean = sum(sum(big[4 * (row * WIDTH * scale + x) + k:][:4 * scale:4])
                           for row in range(y, y + scale)) / scale**2
                errors[0] += abs(smooth[i][k] - mean)
                errors[1] += abs(rough[i][k] - mean)
        self.assertGreater(n, 50)
        self.assertLess(errors[0], errors[1] / 2, n)

    def test_bad_values(self):
        with wire.Client(self.daemon.unix) as client:
            model = client.upload(read(PLANE), "plane.obj")
            for planes, extra, words in ((COLOUR, show(7), "show.kind"),
                                         (COLOUR, show(DRAFT), "show.direction"),
                                         (COLOUR, show(DRAFT, (0, 0, 0)), "0,0,0"),
                                         (COLOUR, show(DRAFT, (0, 0, 1), 91), "show.range"),
                                         (COLOUR, show(MEAN, None, float("nan")), "show.range"),
                                         (K, show(MEAN), "colour"),
                                         (COLOUR, show(MEAN) + wire.field(40, 2), "wireframe")):
                seq = client.next_seq()
                client.send(wire.render(seq, model, planes=planes, extra=extra))
                with self.subTest(words=words):
                    with self.assertRaises(wire.Refused) as caught:
                        client.receive()
                    self.assertEqual(caught.exception.code, wire.ERROR_REQUEST)
                    self.assertIn(words, caught.exception.text)
            client.render(model, extra=show(MEAN))


@unittest.skipUnless(os.path.exists(SHEEN), "no client in this build")
class Command(DaemonCase):
    def command(self, *arguments):
        path = os.path.join(self.daemon.folder, "out.png")
        done = sheen("render", BODY, "-o", path, "--server", self.daemon.unix, "--size", "320x240",
                     *arguments)
        return done, path

    def test_the_range_is_told(self):
        done, path = self.command("--show", "draft:0,0,1", "--json", "-q")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn('"show_range": 3', done.stdout)
        self.assertIn(b"draft direction=0,0,1 range=3", read(path))
        done, path = self.command("--json", "-q")
        self.assertNotIn("show_range", done.stdout)

    def test_extremes_are_told(self):
        done, _ = self.command("--show", "mean", "--json", "-q")
        told = json.loads(done.stdout)
        least, greatest = told["show_least"], told["show_greatest"]
        self.assertTrue(least["value"] < greatest["value"] < 0, "a convex body")
        for extreme in (least, greatest):
            self.assertTrue(0 <= extreme["pixel"][0] < 320 and 0 <= extreme["pixel"][1] < 240)
            self.assertEqual(len(extreme["position"]), 3)
            self.assertNotIn("ptex", extreme)
        # On a flat model all values are equal; a model that is not visible has none.
        for arguments, value in (((), 90), (("--eye", "0,0,9", "--target", "0,0,20", "--up",
                                             "0,1,0"), None)):
            path = os.path.join(self.daemon.folder, "out.png")
            done = sheen("render", PLANE, "-o", path, "--server", self.daemon.unix, "--size",
                         "64x48", "--show", "draft:0,0,1", "--json", "-q", *arguments)
            self.assertEqual(done.returncode, 0, done.stderr)
            for key in ("show_least", "show_greatest"):
                extreme = json.loads(done.stdout)[key]
                self.assertEqual(extreme, value and
                                 {"value": value, "pixel": None, "position": None})
        for kind in ("normal", "ptex", "lines"):
            done, _ = self.command("--show", kind, "--json", "-q")
            self.assertNotIn("show_least", done.stdout)

    def test_no_legend(self):
        """Without the legend the picture is the same except in the corner, and the file's text says so."""
        for legend in ("on", "off"):
            _, path = self.command("--show", "mean", "--legend", legend, "-q")
            self.assertEqual(b"legend=off" in read(path), legend == "off")
        width, height = 320, 240
        with wire.Client(self.daemon.unix) as client:
            model = client.upload(read(BODY), "body.obj")
            on, off = (client.render(model, width, height, extra=wire.field(13, body)).data
                       for body in (wire.field(1, MEAN), wire.field(1, MEAN) + wire.field(4, 0)))
        different = [i for i in range(width * height) if on[4 * i:4 * i + 4] != off[4 * i:4 * i + 4]]
        self.assertGreater(len(different), 2000)
        self.assertGreater(min(i % width for i in different), width // 3)
        self.assertGreater(min(different) // width, height // 2)
        done, _ = self.command("--legend", "no")
        self.assertEqual(done.returncode, 2)
        self.assertIn("on or off", done.stderr)

    def test_bad_values(self):
        for arguments in (("--show", "torsion"), ("--show", "draft"), ("--show", "draft:0,0,0"),
                          ("--show", "mean", "--show-range", "-1"),
                          ("--show", "ptex", "--show-range", "2"),
                          ("--show", "draft:0,0,1", "--show-range", "91"),
                          ("--show-range", "2"),
                          ("--show", "mean", "--surface", "wireframe:1")):
            with self.subTest(arguments=arguments):
                done, _ = self.command(*arguments)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

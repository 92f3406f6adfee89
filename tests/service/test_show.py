"""False colour end to end: --show."""
import os
import struct
import unittest

import wire
from daemon import MODELS, SHEEN, DaemonCase
from test_client import sheen

CURVATURE, GAUSSIAN, MEAN, NORMAL, PTEX, DRAFT = range(1, 7)
COLOUR, K = 1, 32
WIDTH, HEIGHT = 160, 110  # low enough for no legend
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


class Show(DaemonCase):
    def render(self, path, extra, planes=COLOUR):
        with wire.Client(self.daemon.unix) as client:
            model = client.upload(read(path), os.path.basename(path))
            return client.render(model, WIDTH, HEIGHT, planes=planes, extra=extra).data

    def test_a_convex_body_is_blue_by_its_mean(self):
        """And only the planes that were asked for come back, the same as without --show."""
        data = self.render(BODY, show(MEAN), COLOUR | K)
        self.assertEqual(len(data), WIDTH * HEIGHT * 12)
        curvature = data[4 * WIDTH * HEIGHT:]
        self.assertEqual(curvature, self.render(BODY, b"", K))
        n_blue = 0
        for pixel, (low, high) in zip(pixels(data), struct.iter_unpack("<2f", curvature)):
            if low != low:
                self.assertEqual(pixel, EMPTY)
            elif low + high < -0.1:
                self.assertGreater(pixel[2], pixel[0], (low, high))
                n_blue += 1
        self.assertGreater(n_blue, 500)
        gaussian = {p for p in pixels(self.render(BODY, show(GAUSSIAN))) if p != EMPTY}
        red = sum(p[0] > p[2] for p in gaussian)
        self.assertGreater(red, len(gaussian) / 2, "a body's Gaussian curvature is positive")

    def test_a_plane_has_one_draft(self):
        for direction, colour in (((0, 0, 2), (0, 84, 38)), ((0, 0, -1), (128, 0, 13)),
                                  ((1, 0, 0.03), (255, 224, 64)), ((1, 0, -0.03), (237, 173, 26))):
            for surface in (b"", wire.field(40, 1) + wire.field(41, 1)):
                with self.subTest(direction=direction, polygon=bool(surface)):
                    found = set(pixels(self.render(PLANE, show(DRAFT, direction,
                                                               surface=surface))))
                    self.assertEqual(found, {EMPTY, bytes((*colour, 255))})

    def test_faces_and_normals(self):
        found = set(pixels(self.render(PLANE, show(NORMAL))))
        self.assertEqual(found, {EMPTY, bytes((128, 128, 255, 255))})
        self.assertGreater(len(set(pixels(self.render(PLANE, show(PTEX))))), 36)

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

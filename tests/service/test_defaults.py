"""What is drawn without options: the default light and camera for all models, through the whole program."""
import glob
import json
import math
import os
import random
import struct
import subprocess
import tempfile
import unittest

import wire
from daemon import MODELS, SHEEN, DaemonCase

POSITION, PTEX, LIGHT = 2, 8, 16
SHAPES = os.path.join(MODELS, "..", "..", "..", "shared", "shapes")
FRONT, TOP = 1, 5
# A panel that stands upright and is slightly bent: thin in y, so that z is guessed to be up.
DOOR = b"".join(b"v %g %g %g\n" % (x, 0.04 * x * x, z) for z in (0, 1, 2) for x in (-1, 0, 1)) + \
    b"f 1 2 5 4\nf 2 3 6 5\nf 4 5 8 7\nf 5 6 9 8\n"


def vec3(v):
    return b"".join(wire.field(k + 1, float(x)) for k, x in enumerate(v))


def doubles(body):
    return [struct.unpack("<d", wire.decode(body)[k][0])[0] for k in (1, 2, 3)]


def camera(eye=None, target=None, fov=None, view=None, zoom=None):
    """The field `camera` of a RENDER; zoom is (factor, x, y)."""
    parts = [(1, eye and vec3(eye)), (2, target and vec3(target)), (4, fov), (6, view)]
    parts += zip((7, 8, 9), zoom or ())
    return wire.field(4, b"".join(wire.field(number, value) for number, value in parts
                                  if value is not None))


def cube_of(size):
    return b"".join(b"v %g %g %g\n" % (x * size, y * size, z * size)
                    for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))) + \
        b"f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"


class Picture:
    """The planes of a frame as lists of pixels; None for a pixel that shows nothing."""

    def __init__(self, client, model, width, height, extra=b""):
        self.width, self.height = width, height
        frame = client.render(model, width, height, planes=POSITION | PTEX | LIGHT, extra=extra)
        n = width * height
        data = frame.data
        self.position = list(struct.iter_unpack("<3f", data[:12 * n]))
        faces = struct.iter_unpack("<I8x", data[12 * n:24 * n])
        self.hit = [face != 0xffffffff for face, in faces]
        self.light = list(struct.iter_unpack("<2f", data[24 * n:]))
        self.fields = frame.fields
        self.camera = wire.decode(frame.fields[7][0])

    def eye(self):
        return doubles(self.camera[1][0])

    def target(self):
        return doubles(self.camera[2][0])

    def fill(self):
        """Returns the larger share of the picture's sides that the model takes, and whether it touches the border."""
        places = [(i % self.width, i // self.width) for i, hit in enumerate(self.hit) if hit]
        shares, touches = [], False
        for side, size in enumerate((self.width, self.height)):
            low, high = min(p[side] for p in places), max(p[side] for p in places)
            shares.append((high - low + 1) / size)
            touches = touches or low == 0 or high == size - 1
        return max(shares), touches


class Defaults(DaemonCase):
    def setUp(self):
        super().setUp()
        self.client = wire.Client(self.daemon.unix)
        self.client.__enter__()
        self.addCleanup(self.client.__exit__)

    def upload(self, path):
        with open(path, "rb") as file:
            return self.client.upload(file.read(), os.path.basename(path))

    def test_all_models(self):
        """Every pixel of the surface meets the light. The model fills the picture and does not touch its border."""
        n = 0
        for path in sorted(glob.glob(os.path.join(MODELS, "*.obj")) +
                           glob.glob(os.path.join(MODELS, "*.gltf")) +
                           glob.glob(os.path.join(SHAPES, "*.obj"))):
            model = self.upload(path)
            for width, height in ((120, 80), (70, 100)):
                with self.subTest(path=os.path.basename(path), size=(width, height)):
                    try:
                        picture = Picture(self.client, model, width, height)
                    except wire.Refused as refused:
                        self.assertEqual(refused.code, 4, refused.text)
                        continue
                    missed = sum(hit and math.isnan(st[0])
                                 for hit, st in zip(picture.hit, picture.light))
                    self.assertEqual(missed, 0, "pixels without light")
                    share = struct.unpack("<d", picture.fields[32][0])[0]
                    self.assertEqual(share, 1)
                    fill, touches = picture.fill()
                    self.assertGreaterEqual(fill, 0.85)
                    self.assertFalse(touches)
                    n += 1
        self.assertGreaterEqual(n, 20)

    def test_one_eye(self):
        """A point of the surface shows the same place of the light, whatever the camera looks at."""
        rng = random.Random(5)
        for name in ("fender.obj", "body.obj"):
            model = self.upload(os.path.join(MODELS, name))
            overview = Picture(self.client, model, 161, 121)
            hits = [i for i, hit in enumerate(overview.hit) if hit]
            for i in rng.sample(hits, 20):
                size = 2 * rng.randrange(1, 20) + 1
                extra = camera(overview.eye(), overview.position[i], 1 + 60 * rng.random())
                closer = Picture(self.client, model, size, size, extra)
                self.assertEqual(closer.fields[8], overview.fields[8], "the light moved")
                middle = size * size // 2
                for a, b in zip(closer.light[middle], overview.light[i]):
                    self.assertLess(abs(a - b), 1e-5)

    def test_zoom(self):
        """The given place of the picture comes to the middle; eye and light do not change."""
        model = self.upload(os.path.join(MODELS, "fender.obj"))
        for view in (None, TOP):
            overview = Picture(self.client, model, 161, 121, camera(view=view))
            for i in [i for i, hit in enumerate(overview.hit) if hit][::997]:
                x, y = (i % 161 + 0.5) / 161, (i // 161 + 0.5) / 121
                closer = Picture(self.client, model, 161, 121,
                                 camera(view=view, zoom=(20.0, x, y)))
                self.assertEqual(closer.eye(), overview.eye())
                self.assertEqual(closer.fields[8], overview.fields[8])
                middle = 161 * 60 + 80
                self.assertLess(math.dist(closer.position[middle], overview.position[i]),
                                1e-6 * math.dist(overview.eye(), overview.position[i]))
                fovs = [struct.unpack("<d", p.camera[4][0])[0] for p in (overview, closer)]
                tangents = [math.tan(math.radians(fov / 2)) for fov in fovs]
                self.assertAlmostEqual(tangents[0] / tangents[1], 20, 9)

    def test_views(self):
        """Each named view looks from its direction, and the model fills the picture."""
        model = self.upload(os.path.join(MODELS, "body.obj"))  # z up
        third = math.sqrt(1 / 3)
        for view, (toward, up) in enumerate((((0, 1, 0), (0, 0, 1)), ((0, -1, 0), (0, 0, 1)),
                                             ((1, 0, 0), (0, 0, 1)), ((-1, 0, 0), (0, 0, 1)),
                                             ((0, 0, -1), (0, 1, 0)), ((0, 0, 1), (0, -1, 0)),
                                             ((-third, third, -third), (0, 0, 1))), FRONT):
            with self.subTest(view=view):
                self.check_view(model, view, toward, up)

    def check_view(self, model, view, toward, up):
        picture = Picture(self.client, model, 120, 80, camera(view=view))
        away = [b - a for a, b in zip(picture.eye(), picture.target())]
        length = math.hypot(*away)
        for k in range(3):
            self.assertAlmostEqual(away[k] / length, toward[k], 12)
        self.assertEqual(doubles(picture.camera[3][0]), list(up))
        fill, touches = picture.fill()
        self.assertGreaterEqual(fill, 0.85)
        self.assertFalse(touches)

    def test_a_model_of_no_usual_size(self):
        """Where camera or light that are chosen by the model would be out of range, the model's size is told."""
        for size, what in ((9e29, "camera"), (1e29, "light"), (3e18, "light"), (1e-20, "light")):
            model = self.client.upload(cube_of(size), "cube.obj")
            with self.subTest(size=size), self.assertRaises(wire.Refused) as caught:
                self.client.render(model)
            self.assertEqual(caught.exception.code, wire.ERROR_REQUEST)
            self.assertRegex(caught.exception.text, rf"^the model's box has a diagonal of [\d.e+-]+ units, for which no "
                                                    rf"{what} can be chosen \({what}: .*\): scale the model, or give")
            told = float(caught.exception.text.split()[7])
            self.assertTrue(size < told < 3.5 * size, told)
        given = wire.field(5, b"".join(wire.field(k, vec3(v)) for k, v in
                                       ((1, (0, 0, 2e19)), (2, (1e17, 0, 0)), (3, (0, 1e17, 0)))))
        self.client.render(self.client.upload(cube_of(3e18), "cube.obj"), extra=given)

    def test_target_alone(self):
        model = self.upload(os.path.join(MODELS, "body.obj"))
        whole = Picture(self.client, model, 60, 40)
        turned = Picture(self.client, model, 60, 40, camera(target=(0.5, 0.25, 0.125)))
        self.assertEqual((turned.eye(), turned.target()), (whole.eye(), [0.5, 0.25, 0.125]))
        self.assertEqual(turned.fields[8], whole.fields[8])


class Said(DaemonCase):
    def test_one_of_a_kind(self):
        path = os.path.join(self.folder, "one.obj")
        with open(path, "w", encoding="ascii") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        _, text = self.sheen(path)
        self.assertIn(": 90x60, 1 face, ", text)
        done = subprocess.run([SHEEN, "info", path, "--server", self.daemon.unix],
                              capture_output=True, text=True, timeout=60, check=True)
        self.assertIn(" 3 vertices, 1 face: 1 triangle, 0 quads, 0 larger\n", done.stdout)
        self.assertIn(" 3 edges, 3 extraordinary vertices\n", done.stdout)
        _, text = self.sheen(self.door)
        self.assertIn(": 90x60, 4 faces, ", text)

    def test_the_devices_own_limit(self):
        """A side that the protocol allows and the device does not."""
        _, text = self.sheen(self.door, "--size", "60x60000", code=2)
        self.assertRegex(text, r"height is 60000; it must be from 1 to \d+ pixels, the device's own "
                               r"limit")

    def setUp(self):
        super().setUp()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.door = os.path.join(self.folder, "door.obj")
        with open(self.door, "wb") as file:
            file.write(DOOR)

    def sheen(self, model, *options, code=0):
        """The options' effects, by --json and by the texts for people."""
        done = subprocess.run([SHEEN, "render", model, "-o", os.path.join(self.folder, "a.png"),
                               "--size", "90x60", "--server", self.daemon.unix, "--json", *options],
                              capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(done.returncode, code, done.stderr)
        return json.loads(done.stdout) if code == 0 else None, done.stderr

    def test_up(self):
        """The up that a file gives is used; a guessed up is reported; a given up wins."""
        said, text = self.sheen(os.path.join(MODELS, "fender.gltf"))
        self.assertEqual((said["up"], said["up_source"]), ([0, 1, 0], "file"))
        self.assertEqual(said["camera"]["up"], [0, 1, 0])
        self.assertNotIn("guessed", text)
        said, text = self.sheen(self.door)
        self.assertEqual((said["up"], said["up_source"]), ([0, 1, 0], "guessed"))
        self.assertIn("up is taken as y (a guess", text)
        self.assertIn("--up z", text)
        for word, up in (("z", [0, 0, 1]), ("-z", [0, 0, -1]), ("+x", [1, 0, 0]),
                         ("-y", [0, -1, 0]), ("0,0,3", [0, 0, 3])):
            said, text = self.sheen(self.door, "--up", word)
            self.assertEqual((said["up"], said["up_source"]), (up, "given"))
            self.assertEqual(said["camera"]["up"], up)
            self.assertNotIn("guessed", text)

    def test_light_share(self):
        """If most of the visible surface misses the light, one notice says so and what to do."""
        said, text = self.sheen(self.door, "--up", "z")
        self.assertEqual((said["light_share"], said["light"]["kind"]), (1, "tunnel"))
        self.assertNotIn("is met on", text)
        said, text = self.sheen(self.door, "--up", "z", "--light", "rectangle")
        self.assertLess(said["light_share"], 0.5)
        self.assertEqual(text.count("the light is met on"), 1)
        self.assertIn("--light tunnel, or no --light, is met everywhere", text)
        self.assertIn("--light-center", text)
        said, text = self.sheen(self.door, "--up", "z", "--light-center", "0,0,9", "--light-u",
                                "1,0,0", "--light-v", "0,1,0")
        self.assertLess(said["light_share"], 0.5)
        self.assertIn("or leave these and --light out", text)
        for options in (("--show", "mean"), ("--surface", "wireframe:2"),
                        ("--eye", "0,-9,1", "--target", "0,-18,1")):
            said, text = self.sheen(self.door, "--up", "z", *options)
            self.assertIsNone(said["light_share"], options)
            self.assertNotIn("is met on", text)

    def test_every_command_that_draws_says_it(self):
        """The warnings of the file, the guessed up, a light that is hardly met, and a picture without surface: each
        is reported once."""
        bad = os.path.join(self.folder, "bad.obj")
        with open(bad, "wb") as file:
            file.write(DOOR + b"f 1 2\n")
        warning = "bad.obj:%d: a face with fewer than 3 different corners" % (DOOR.count(b"\n") + 1)
        commands = (("render", bad, "-o", os.path.join(self.folder, "a.png")),
                    ("stream", bad, "--frames", "3"), ("stream", bad, "--frames", "3", "--light-only"),
                    ("levels", bad, "-o", os.path.join(self.folder, "l.png")))
        away = ("--eye", "0,-9,1", "--target", "0,-18,1")
        low = ("--light-center", "0,9,0", "--light-u", "1,0,0", "--light-v", "0,0,1")
        for command in commands:
            for options, words in (((), ("up is taken as y (a guess",)), (("--up", "y"), ()),
                                   (low, ("up is taken as y (a guess", "the light is met on")),
                                   (away, ("up is taken as y (a guess", "no pixel shows the surface"))):
                with self.subTest(command=command[0], options=options):
                    asked = (SHEEN, *command, *options, "--size", "90x60", "--server",
                             self.daemon.unix, "--json")
                    done = subprocess.run(asked, capture_output=True, text=True, timeout=60, check=True)
                    for sentence in ("guessed", "is met on", "no pixel shows"):
                        self.assertEqual(done.stderr.count(sentence),
                                         any(sentence in each for each in words), done.stderr)
                    self.assertEqual(done.stderr.count(f"sheen: warning: {warning}"), 1, done.stderr)
                    told = json.loads(done.stdout)["warnings"]
                    self.assertEqual([line.startswith(warning) for line in told], [True])
                    done = subprocess.run((*asked, "-q"), capture_output=True, text=True, timeout=60,
                                          check=True)
                    self.assertEqual(done.stderr, "")

    def test_straight_down(self):
        """--up is not needed for such a camera; the lines are the same as for every other camera."""
        whole, _ = self.sheen(os.path.join(MODELS, "fender.obj"))
        for height, back in ((4000, 1), (-4000, -1)):
            said, _ = self.sheen(os.path.join(MODELS, "fender.obj"), "--eye", f"500,0,{height}",
                                 "--target", "500,0,0")
            self.assertEqual(said["camera"]["up"], [0, back, 0])
            self.assertEqual(said["light"], whole["light"])

    def test_refused(self):
        for options, words in (
                (("--eye", "1,2,3"), "--eye needs a --target"),
                (("--eye", "1,2,3", "--target", "0,0,0", "--view", "top"), "exclude each other"),
                (("--view", "upside"), "--view 'upside'"), (("--up", "w"), "--up 'w': must be x, y, z, -x, -y, -z, or X,Y,Z"),
                (("--up", "Z"), "x, y, z, -x"), (("--up", "0,0,0"), "not 0,0,0"),
                (("--show", "draft:Z"), "x, y, z, -x, -y, -z, or X,Y,Z"),
                (("--zoom", "0.5"), "FACTOR must be a number from 1 to"),
                (("--zoom", "2@640,360"), "not pixels"), (("--zoom", "2@1"), "FACTOR@X,Y")):
            _, text = self.sheen(self.door, *options, code=2)
            self.assertIn(words, text)


if __name__ == "__main__":
    unittest.main()

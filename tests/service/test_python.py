"""The Python package: the same frames as by the command, files, streams, and what it says about failures."""
import base64
import collections
import json
import math
import os
import random
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import textwrap
import threading
import unittest
import zlib

import numpy as np

import authority
import between
import exr
import sheen
import wire
from daemon import BUILD, CUBE, DEVICE, MESA, MODELS, SHEEN, SHEEND, Daemon, DaemonCase, grid
from sheen import header, messages, protobuf
from wire import Client

ROOT = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
FENDER = os.path.join(MODELS, "fender.gltf")
ALL = tuple(sheen.PLANES)
AOV = "P,N,ptex,light,k,dlight,coverage"
CHANNELS = {"position": ("P.X", "P.Y", "P.Z"), "normal": ("N.X", "N.Y", "N.Z"), "light": ("light.s", "light.t"),
            "curvature": ("k.min", "k.max"), "coverage": ("coverage",),
            "light_change": ("light.dsdx", "light.dsdy", "light.dtdx", "light.dtdy")}

# (the model, the command's options, the same for the package)
REQUESTS = [
    (FENDER, "", {}),
    (FENDER, "--view left --lines zebra", {"view": "left", "lines": "zebra"}),
    ("body.obj", "--view top --up y", {"view": "top", "up": "y"}),
    ("body.obj", "--eye 9,-8,7 --target 0,0,0 --fov 25", {"eye": (9, -8, 7), "target": (0, 0, 0), "fov": 25}),
    (FENDER, "--ortho 700", {"ortho": 700}),
    (FENDER, "--zoom 4@0.4,0.6", {"zoom": (4, 0.4, 0.6)}),
    (FENDER, "--zoom 3 --view iso", {"zoom": 3, "view": "iso"}),
    ("creases.obj", "--lines isophote:0,0,1", {"lines": "isophote:0,0,1"}),
    ("creases.obj", "--lines environment:-x", {"lines": sheen.Lines("environment", "-x")}),
    ("creases.obj", "--lines highlight --light rectangle:one-sided",
     {"lines": "highlight", "light": "rectangle:one-sided"}),
    (FENDER, "--light plane --light-center 0,3000,0 --light-u 100,0,0 --light-v 0,0,100 --pattern lattice:period=100",
     {"light": "plane", "light_center": (0, 3000, 0), "light_u": (100, 0, 0), "light_v": "0,0,100",
      "pattern": "lattice:period=100"}),
    (FENDER, "--light tunnel --pattern stripes:count=12 --light sphere --pattern circles:opacity=0.5",
     {"light": [sheen.Light("tunnel", pattern=sheen.Pattern(count=12)),
                sheen.Light("sphere", pattern="circles:opacity=0.5")]}),
    (FENDER, "--pattern lines:at=0.25/0.5/0.75,width=0.02,soft=0.3", {"pattern": "lines:at=0.25/0.5/0.75,width=0.02,soft=0.3"}),
    (FENDER, "--pattern rainbow:count=5,rotation=30 --miss #10203040", {"pattern": "rainbow:count=5,rotation=30",
                                                                      "miss": "#10203040"}),
    (FENDER, "--pattern distance:period=50 --base #ff8800 --empty #000000",
     {"pattern": "distance:period=50", "base": "#ff8800", "empty": (0, 0, 0)}),
    (FENDER, "--pattern stripes:fg=#ff0000,duty=0.3,soft=0.1,offset=0.25",
     {"light": sheen.Light(pattern=sheen.Pattern(foreground="#ff0000", duty=0.3, soft=0.1, offset=0.25))}),
    (FENDER, "--line-eye 0,500,4000", {"line_eye": (0, 500, 4000)}),
    (FENDER, "--line-eye dir:0,-1,-1", {"line_eye": "dir:0,-1,-1"}),
    (FENDER, "--show mean --show-range 0.01 --legend off", {"show": "mean", "show_range": 0.01, "legend": "off"}),
    ("body.obj", "--show draft:z --class batch --deadline 60000", {"show": "draft:z", "class_": "batch",
                                                                 "deadline": 60000}),
]


def bits(array):
    """NaNs have different bits, of which some mean the same; a NaN here is one that the daemon sent."""
    return np.ascontiguousarray(array).view("u1").tobytes()


def pixels_of(png):
    """The pixels of an 8-bit PNG file as an array (height, width, 3 or 4)."""
    at, packed = 8, b""
    while at < len(png):
        length, kind = struct.unpack_from(">I4s", png, at)
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack_from(">IIBB", png, at + 8)
            n = {2: 3, 6: 4}[colour]
            assert depth == 8
        packed += png[at + 8:at + 8 + length] if kind == b"IDAT" else b""
        at += 12 + length
    raw = np.frombuffer(zlib.decompress(packed), "u1").reshape(height, 1 + n * width)
    out, above = np.zeros((height, n * width), "u1"), np.zeros(n * width, "i4")
    for y, (kind, line) in enumerate(zip(raw[:, 0], raw[:, 1:].astype("i4"))):
        row = np.zeros(n * width + n, "i4")  # n zeros on the left
        for i in range(n * width) if kind in (1, 3, 4) else ():
            left, up, corner = row[i], above[i], above[i - n] if i >= n else 0
            near = min((abs(up - corner), 0, left), (abs(left - corner), 1, up),
                       (abs(left + up - 2 * corner), 2, corner))[2]
            row[i + n] = line[i] + {1: left, 3: (left + up) // 2, 4: near}[kind] & 255
        if kind in (0, 2):
            row[n:] = (line + (above if kind == 2 else 0)) & 255
        out[y] = above = row[n:]
    return out.reshape(height, width, n)


class Zstd(unittest.TestCase):
    """Planes that are sent compressed, by each of the modules that Python may have."""

    def test_modules(self):
        import zstandard

        class Own:
            """The interface of Python 3.14's compression.zstd."""
            class ZstdDecompressor:
                def __init__(self):
                    self.made = zstandard.ZstdDecompressor().decompressobj()

                def decompress(self, data, max_length):
                    return self.made.decompress(bytes(data))[:max_length]

                eof = property(lambda self: self.made.eof)
                unused_data = property(lambda self: self.made.unused_data)

        # Colour has a strip of up to 131072 rows, position strips of 43690.
        raw = {"colour": bytes(range(256)) * 1024, "position": random.Random(1).randbytes(12 * 65536)}
        pack = zstandard.ZstdCompressor().compress
        first = np.frombuffer(raw["position"], "u1").reshape(-1, 12)
        strips = [pack(raw["colour"]), *(pack(np.ascontiguousarray(part.T)) for part in (first[:43690], first[43690:]))]
        data = bytearray(b"".join(struct.pack("<I", len(strip)) for strip in strips) + b"".join(strips))
        for module in (zstandard, Own):
            planes = sheen.planes.empty(1, 65536, 3)
            sheen.planes.unpack_zstd(module, data, 1, 65536, planes)
            self.assertEqual({name: bits(array) for name, array in planes.items()}, raw)
            for wrong in (data[:-1], data + b"x", data[:5], data[:12] + b"x" * (len(data) - 12),
                          data[:12] + data[13:] + b"x"):
                with self.assertRaises(protobuf.Malformed):
                    sheen.planes.unpack_zstd(module, bytearray(wrong), 1, 65536, planes)

    def test_without_a_module(self):
        daemon = Daemon()
        with sheen.connect(daemon.tcp) as session:
            packed = session.render(session.upload(CUBE, "cube.obj"), planes=ALL, size=(40, 30))
            session._zstd = None
            plain = session.render(session.upload(CUBE, "cube.obj"), planes=ALL, size=(40, 30))
            for name, array in packed.planes.items():
                self.assertEqual(bits(array), bits(plain.planes[name]))
            with self.assertRaisesRegex(sheen.BadArgument, "zstandard"):
                session.render(session.upload(CUBE, "cube.obj"), format="zstd")
        self.assertEqual(daemon.stop(), 0)


class Same(DaemonCase):
    """The command, which uses libsheen, is the other client."""
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        folder = tempfile.TemporaryDirectory(prefix="sheen-test-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name

    def by_command(self, model, name, *options):
        path = os.path.join(self.folder, name)
        done = subprocess.run([SHEEN, "render", model, "-o", path, "--size", "80x60", "-q", "--server", self.daemon.unix,
                               *options], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(path, "rb") as file:
            return file.read()

    def test_all_planes_bit_for_bit(self):
        self.assertEqual(len(REQUESTS), 20)
        with sheen.connect(self.daemon.unix) as session, sheen.connect(self.daemon.tcp) as remote:
            for model, words, options in REQUESTS:
                with self.subTest(options=words):
                    model = os.path.join(MODELS, model)
                    options = {"size": (80, 60), **options}
                    file = self.by_command(model, "a.exr", "--aov", AOV, *words.split())
                    expected = exr.read(file)
                    # Files tell how they were made, so equal files mean equal requests.
                    self.assertEqual(session.render(model, planes=ALL, format="exr", **options).file, file)
                    for client in (session, remote):  # raw, and compressed by zstd
                        frame = client.render(model, planes=ALL, **options)
                        self.assertTrue(frame.hit.any() and not frame.hit.all())
                        for name, channels in CHANNELS.items():
                            found = np.stack([expected[channel] for channel in channels], -1).reshape(
                                frame.planes[name].shape)
                            self.assertEqual(bits(frame.planes[name]), bits(found), name)
                        for name in ("face", "u", "v"):
                            self.assertEqual(bits(frame.ptex[name]), bits(expected["ptex." + name]), name)
                    png = self.by_command(model, "a.png", *words.split())
                    self.assertEqual(session.render(model, format="png", **options).file, png)
                    pixels = pixels_of(png)
                    self.assertEqual(bits(frame.colour[..., :pixels.shape[2]]), bits(pixels))

    def test_surfaces_and_samples(self):
        """What has no coverage plane."""
        with sheen.connect(self.daemon.unix) as session:
            for words, options in (("--surface polygon:2", {"surface": "polygon:2"}),
                                   ("--surface wireframe:1", {"surface": "wireframe:1"}),
                                   ("--filter off", {"filter": "off"}), ("--antialias off", {"antialias": "off"}),
                                   ("--jpeg-quality 60 --jpeg-subsampling 420", {"jpeg_quality": 60,
                                                                                 "jpeg_subsampling": 420})):
                format, name = ("jpeg", "a.jpg") if "jpeg" in words else ("png", "a.png")
                with self.subTest(options=words):
                    self.assertEqual(session.render(FENDER, size="80x60", format=format, **options).file,
                                     self.by_command(FENDER, name, *words.split()))

    def test_image_of_a_light(self):
        path = os.path.join(self.folder, "light.ppm")
        with open(path, "wb") as file:
            file.write(b"P6\n2 1\n255\n" + bytes((255, 0, 0, 0, 0, 255)))
        with sheen.connect(self.daemon.unix) as session:
            frame = session.render(FENDER, size="80x60", format="png", pattern="image:" + path)
            self.assertEqual(frame.file, self.by_command(FENDER, "a.png", "--pattern", "image:" + path))
            again = session.render(FENDER, size="80x60", format="png", light=frame.lights)
            self.assertEqual(again.lights, frame.lights)

    def split_gltf(self):
        with open(FENDER, encoding="utf-8") as file:
            gltf = json.load(file)
        os.makedirs(os.path.join(self.folder, "a b"), exist_ok=True)
        with open(os.path.join(self.folder, "a b", "fender.bin"), "wb") as file:
            file.write(base64.b64decode(gltf["buffers"][0]["uri"].partition(",")[2]))
        gltf["buffers"][0]["uri"] = "a%20b/fender.bin"
        gltf["asset"]["extras"] = {"numbers": [0.1, -2.0, 1e300, 3.25e-7, 1e16, 7, True, None], "text": "\u00e9/\n\""}
        model = os.path.join(self.folder, "split.gltf")
        with open(model, "w", encoding="utf-8") as file:
            json.dump(gltf, file)
        return model

    def test_models_have_the_ids_that_the_command_gives_them(self):
        body = os.path.join(MODELS, "body.obj")
        with sheen.connect(self.daemon.unix) as session:
            for model, options in ((FENDER, ()), (body, ()), (body, ("--weld",)), (self.split_gltf(), ())):
                with self.subTest(model=model, options=options):
                    text = subprocess.run([SHEEN, "info", model, "--json", "-q", "--server", self.daemon.unix, *options],
                                          check=True, capture_output=True, timeout=60).stdout
                    expected = json.loads(text)
                    found = session.upload(model, weld=bool(options))
                    self.assertEqual(found.id.hex(), expected["sha256"])
                    self.assertEqual(found.info.faces, expected["faces"])
                    self.assertEqual(found.box.tolist(), [expected["box_min"], expected["box_max"]])
                    self.assertEqual(found.warnings, expected["warnings"])

    def test_json_that_cannot_be_written_again(self):
        path = os.path.join(self.folder, "odd.gltf")
        with open(os.path.join(self.folder, "one.bin"), "wb") as file:
            file.write(b"1")
        buffers = '"buffers":[{"uri":"one.bin","byteLength":1}]'
        for extras in ("[" * 900 + "]" * 900, '"\\ud800"'):
            with open(path, "w", encoding="ascii") as file:
                file.write(f'{{"extras":{extras},{buffers}}}')
            with self.assertRaisesRegex(sheen.BadModel, "JSON"):
                sheen.files.read_model(path)
        deep = f'{{"extras":{"[" * 100000},{buffers}}}'.encode()
        for data in (deep, b"{", b'{"buffers":7}', b'{"buffers":[7,{"uri":7}]}', b"\xef\xbb\xbf {}"):
            with open(path, "wb") as file:
                file.write(data)
            self.assertEqual(sheen.files.read_model(path), data)  # the daemon says what is wrong with it

    def test_files_outside_of_the_models_folder_are_not_sent(self):
        for uri in ("../x.bin", "/etc/passwd", "http://a/b", "link"):
            model = os.path.join(self.folder, "bad.gltf")
            with open(model, "w", encoding="utf-8") as file:
                json.dump({"buffers": [{"uri": uri, "byteLength": 1}]}, file)
            if uri == "link":
                os.symlink("/etc/passwd", os.path.join(self.folder, uri))
            with self.assertRaisesRegex(sheen.BadModel, "buffer 0"):
                sheen.files.read_model(model)


class Windows(DaemonCase):
    """Frames that show a part of a picture."""
    SIZE = (320, 240)

    def part(self, session, model, place, size, **options):
        return session.render(model, planes=ALL, size=size, window=(*place, *self.SIZE), **options)

    def test_the_picture_bit_for_bit(self):
        chance = random.Random(5)
        n_hits = 0
        with sheen.connect(self.daemon.unix) as session:
            for name, options in (("fender.gltf", {"zoom": (3, 0.4, 0.5)}), ("creases.obj", {"lines": "zebra"}),
                                  ("body.obj", {"ortho": 4, "view": "left"}), ("body.obj", {"surface": "polygon:3"})):
                model = session.upload(os.path.join(MODELS, name))
                names = [name for name in ALL if name != "coverage" or "surface" not in options]
                whole = session.render(model, planes=names, size=self.SIZE, **options)
                parts = [((0, 0), self.SIZE), ((100, 57), (200, 183)), ((319, 239), (1, 1))]
                parts += [((chance.randrange(320), chance.randrange(240)), (1, 1)) for _ in range(60)]
                for (x, y), (width, height) in parts:
                    frame = session.render(model, planes=names, size=(width, height), window=(x, y, *self.SIZE), **options)
                    n_hits += frame.hit.sum()
                    self.assertEqual(frame.camera, whole.camera)
                    for plane, array in frame.planes.items():
                        if plane != "colour":
                            self.assertEqual(bits(array), bits(whole.planes[plane][y:y + height, x:x + width]),
                                             (name, plane, x, y))
        self.assertGreater(n_hits, 100000)

    def test_kept_planes(self):
        """A second frame of a part is only shaded, and has the picture's places on another light."""
        other = {"lines": "zebra", "pattern": "stripes:count=11"}
        for device, most in (("software", 0), (MESA, 1e-4)):
            daemon = Daemon("--device", device)
            with sheen.connect(daemon.unix) as session:
                whole = session.render(FENDER, planes=("colour", "light"), size=self.SIZE, **other)
                for (x, y), size in (((120, 70), (100, 90)), ((100, 60), (60, 40)), ((160, 120), (1, 1))):
                    with self.subTest(device=device, place=(x, y)):
                        self.part(session, FENDER, (x, y), size)
                        part = self.part(session, FENDER, (x, y), size, **other)
                        self.assertEqual((part.times.visibility_us, part.times.evaluate_us), (0, 0))
                        expected = whole.light[y:y + size[1], x:x + size[0]]
                        self.assertTrue(np.isfinite(expected).any())
                        self.assertTrue(np.allclose(part.light, expected, rtol=0, atol=most, equal_nan=True))
            self.assertEqual(daemon.stop(), 0)

    def test_a_gl_device(self):
        """There the same, except for rounding."""
        daemon = Daemon("--device", MESA)
        with sheen.connect(daemon.unix) as session:
            self.assertNotIn("native", session.server.device)
            whole = session.render(FENDER, planes=("colour", "position", "normal", "ptex"), size=self.SIZE)
            for (x, y), (width, height) in (((120, 70), (100, 90)), ((160, 120), (1, 1))):
                part = session.render(FENDER, planes=whole.planes, size=(width, height), window=(x, y, *self.SIZE))
                rows, columns = slice(y, y + height), slice(x, x + width)
                self.assertTrue(part.hit.any())
                self.assertTrue(np.array_equal(part.ptex["face"], whole.ptex["face"][rows, columns]))
                for name, most in (("position", 1e-3), ("normal", 1e-5), ("colour", 1)):  # the model has 1000 units
                    self.assertTrue(np.allclose(part.planes[name], whole.planes[name][rows, columns], rtol=0, atol=most,
                                                equal_nan=True), name)
        self.assertEqual(daemon.stop(), 0)

    def test_places_between_pixels(self):
        """The ray at a quarter of a pixel is that of a pixel of the picture of twice the size."""
        with sheen.connect(self.daemon.unix) as session:
            double = session.render(FENDER, planes=ALL, size=(640, 480))
            for x, y in ((160, 120), (100, 110), (170, 150), (200, 130)):
                frame = self.part(session, FENDER, (x + 0.25, y + 0.25), (1, 1))
                found, expected = frame.position[0, 0], double.position[2 * y + 1, 2 * x + 1]
                self.assertTrue(np.allclose(found, expected, atol=1e-3), (found, expected))  # the model has 1000 units
                self.assertTrue(np.allclose(frame.normal[0, 0], double.normal[2 * y + 1, 2 * x + 1], atol=1e-5))

    def test_parts_must_be_inside(self):
        with sheen.connect(self.daemon.unix) as session:
            model = session.upload(CUBE, "cube.obj")
            for place, size in (((320, 0), (1, 1)), ((0, 239.5), (1, 2)), ((-0.5, 0), (1, 1)), ((1, 0), (320, 240)),
                                ((0, 1e300), (1, 1))):
                with self.subTest(place=place), self.assertRaisesRegex(sheen.BadRequest, "window"):
                    self.part(session, model, place, size)
            self.part(session, model, (319.75, 239.75), (1, 1))
            frame = session.render(model, size=(1, 1), window=(60000, 60000, 65536, 65536))  # more than the device draws
            self.assertEqual(frame.colour.shape, (1, 1, 4))
        with Client(self.daemon.unix, minor=5) as client:
            model = client.upload(CUBE, "cube.obj")
            window = b"".join(wire.field(n, value) for n, value in enumerate((float("nan"), 0.0, 320, 240), 1))
            client.send(wire.render(9, model, extra=wire.field(18, window)))
            self.assert_refused(client, wire.ERROR_REQUEST, "window.x_px", 9)


class Sessions(DaemonCase):
    def setUp(self):
        self.session = sheen.connect(self.daemon.unix)
        self.addCleanup(self.session.close)
        self.model = self.session.upload(CUBE, "cube.obj")

    def test_stream_comes_in_order(self):
        cameras = [sheen.Camera((4 + i, 3, 2), (0, 0, 0)) for i in range(8)]
        for in_flight in (1, 2, 5, 100):
            frames = list(self.session.stream(self.model, cameras, size=(32, 24), in_flight=in_flight))
            self.assertEqual([frame.camera.eye for frame in frames], [camera.eye for camera in cameras])
        expected = [self.session.render(self.model, camera=camera, size=(32, 24)).colour for camera in cameras]
        for frame, colour in zip(frames, expected):
            self.assertEqual(bits(frame.colour), bits(colour))

    def test_stream_that_is_left_or_fails(self):
        cameras = [sheen.Camera((4 + i, 3, 2), (0, 0, 0)) for i in range(20)]
        for frame in self.session.stream(self.model, cameras, size=(32, 24), in_flight=4):
            with self.assertRaisesRegex(sheen.BadArgument, "in flight"):
                self.session.render(self.model)
            break
        self.session.render(self.model, size=(32, 24))
        views = [{"view": "left"}, {"size": (70000, 1)}, {"view": "right"}]
        got = []
        with self.assertRaisesRegex(sheen.BadRequest, "width"):
            for frame in self.session.stream(self.model, views, size=(32, 24), in_flight=3):
                got.append(frame)
        self.assertEqual(len(got), 1)
        self.session.render(self.model, size=(32, 24))

    def test_arrays(self):
        frame = self.session.render(self.model, planes=ALL, size=(33, 21))
        shapes = {name: (array.shape, array.dtype.str) for name, array in frame.planes.items() if name != "ptex"}
        self.assertEqual(shapes, {
            "colour": ((21, 33, 4), "|u1"), "position": ((21, 33, 3), "<f4"), "normal": ((21, 33, 3), "<f4"),
            "light": ((21, 33, 2), "<f4"), "curvature": ((21, 33, 2), "<f4"), "light_change": ((21, 33, 4), "<f4"),
            "coverage": ((21, 33), "<f4")})
        self.assertEqual((frame.ptex.shape, frame.ptex.dtype.names), ((21, 33), ("face", "u", "v")))
        for array in frame.planes.values():
            self.assertTrue(array.flags.owndata and array.flags.writeable and array.flags.c_contiguous)
        self.assertTrue(np.array_equal(frame.hit, ~np.isnan(frame.normal[..., 0])))
        self.assertTrue(np.allclose(np.linalg.norm(frame.normal[frame.hit], axis=1), 1))
        self.assertIs(np.asarray(frame), frame.colour)
        only = self.session.render(self.model, planes="normal", size=(8, 8))
        with self.assertRaisesRegex(AttributeError, "curvature"):
            only.curvature.sum()

    def test_picture_of_a_notebook(self):
        frame = self.session.render(self.model, size=(40, 30), empty="#00000000")
        self.assertEqual(bits(pixels_of(frame._repr_png_())), bits(frame.colour))
        self.assertIsNone(self.session.render(self.model, size=(4, 3), planes="normal")._repr_png_())
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.png")
            frame.save(path)
            with open(path, "rb") as file:
                self.assertEqual(file.read(), frame._repr_png_())
            with self.assertRaises(sheen.BadArgument):
                frame.save(os.path.join(folder, "a.exr"))
            with self.assertRaises(sheen.BadImage):
                frame.save(os.path.join(folder, "no", "a.png"))

    def test_refusals(self):
        for kind, code, options in (
                (sheen.BadRequest, 2, {"fov": 200}), (sheen.BadRequest, 2, {"size": (0, 5)}),
                (sheen.BadRequest, 2, {"planes": "normal", "format": "png"}), (sheen.BadArgument, 2, {"size": (-1, 5)}),
                (sheen.BadArgument, 2, {"fov": float("nan")}), (sheen.BadArgument, 2, {"planes": "depth"}),
                (sheen.BadArgument, 2, {"lines": "zebras"}), (sheen.BadArgument, 2, {"pattern": "stripes:count=x"}),
                (sheen.BadArgument, 2, {"pattern": "stripes:kind=lattice"}), (sheen.BadArgument, 2, {"format": "bmp"}),
                (sheen.BadArgument, 2, {"size": (1 << 40, 5)}), (sheen.BadArgument, 2, {"up": (0, 0, 0)}),
                (sheen.BadArgument, 2, {"light": [sheen.Light()] * 9})):
            with self.subTest(options=options), self.assertRaises(kind) as caught:
                self.session.render(self.model, **options)
            self.assertIsInstance(caught.exception, ValueError)
            self.assertEqual(caught.exception.exit_code, code)
            self.assertNotIn("\n", str(caught.exception))
        with self.assertRaises(TypeError):
            self.session.render(self.model, colour="red")
        with self.assertRaises(sheen.BadModel) as caught:
            self.session.upload(b"f 1 2 3\n", "bad.obj")
            self.session.render(self.session.upload(b"f 1 2 3\n", "bad.obj"))
        self.assertEqual(caught.exception.exit_code, 3)
        with self.assertRaises(sheen.UnknownModel) as caught:
            self.session.render(b"x" * 32)
        self.assertEqual(caught.exception.exit_code, 4)
        with self.assertRaises(sheen.BadModel):
            self.session.upload("/no/such/file.obj")
        self.session.render(self.model, size=(8, 8))  # the session goes on

    def test_every_bound(self):
        """Each bounded field is encoded at its bound, and refused beyond it; the daemon accepts what is encoded."""
        n_bounds = 0
        for cls in vars(messages).values():
            if not (isinstance(cls, type) and issubclass(cls, protobuf.Message)):
                continue
            for row in cls.FIELDS.values():
                if row.most is None:
                    continue
                n_bounds += 1
                one = {"string": "x", "bytes": b"x"}.get(row.kind, [1.5])
                if isinstance(row.kind, type):
                    one = [row.kind(**{r.name: 1 for r in row.kind.FIELDS.values() if r.label == "required"})]
                number = next(n for n, r in cls.FIELDS.items() if r is row)
                lone = type("Lone", (), {"FIELDS": {number: row}})  # a message of this field alone
                for n, is_good in ((row.most - 1, not row.fixed), (row.most, True), (row.most + 1, False)):
                    message = lone()
                    setattr(message, row.name, one * n)
                    with self.subTest(message=cls.__name__, field=row.name, n=n):
                        if is_good:
                            encoded = protobuf.encode(message)
                        else:
                            with self.assertRaisesRegex(protobuf.Malformed, row.name):
                                protobuf.encode(message)
                            # The bytes that a careless peer would send.
                            encoded = b"".join(protobuf._encode_value(row, entry) for entry in one * n) if isinstance(
                                one, list) else protobuf.field(number, one * n)
                        rows = {n: r for n, r in cls.FIELDS.items() if r is row}
                        decoder = type("Lone", (), {"FIELDS": rows, "__init__": lambda self, **named: None})
                        if is_good:
                            protobuf.decode(decoder, encoded)
                        else:
                            with self.assertRaisesRegex(protobuf.Malformed, row.name):
                                protobuf.decode(decoder, encoded)
        self.assertGreater(n_bounds, 25)
        name = "n" * 251 + ".obj"
        self.assertEqual(self.session.info(self.session.upload(CUBE + b"#\n", name)).name, name)
        with self.assertRaisesRegex(sheen.BadArgument, "name has 256 bytes"):
            self.session.upload(CUBE + b"##\n", "n" + name)
        frame = self.session.render(self.model, size=(8, 8), light=[
            sheen.Light(pattern=sheen.Pattern("lines", at=tuple(i / 16 for i in range(16))))] * 8)
        self.assertEqual((len(frame.lights), len(frame.lights[7].pattern.at)), (8, 16))

    def test_specification(self):
        """Each hex example of a body is decoded and encoded to the same bytes."""
        with open(os.path.join(ROOT, "protocol", "README.md"), encoding="utf-8") as file:
            examples = re.findall(r"^```hex (\S+)\n(.*?)^```", file.read(), re.M | re.S)
        names = {"".join(part.title() for part in name.split("_")): name for name in messages.Type.__members__}
        n = 0
        for name, text in examples:
            data = bytes.fromhex(re.sub(r"#.*", "", text))
            if data[:4] != wire.MAGIC:
                continue
            _, _, kind, flags, length, seq = wire.HEADER.unpack(data[:16])
            body = data[16:]
            self.assertEqual(len(body), length, name)
            cls = next((getattr(messages, cls, None) for cls, type_name in names.items()
                        if messages.Type[type_name] == kind), None)
            if cls is None:
                continue
            before, body = (body[:32], body[32:]) if kind == wire.HELLO else (b"", body)
            message = protobuf.decode(cls, body)
            self.assertEqual(wire.message(kind, seq, before + protobuf.encode(message), flags), data, name)
            n += 1
        self.assertGreater(n, 15)


def folded(degrees, n=3):
    """Two flat sheets of n by n faces that meet in a crease along y at x = 0 and z = 0, at this angle."""
    turn = math.radians(degrees)
    rows = [(x if x < 0 else x * math.cos(turn), y, 0 if x < 0 else x * math.sin(turn))
            for y in range(n + 1) for x in range(-n, n + 1)]
    side = 2 * n + 1
    lines = ["v %.17g %.17g %.17g" % row for row in rows]
    lines += ["f %d %d %d %d" % (a, a + 1, a + 1 + side, a + side)
              for y in range(n) for x in range(2 * n) for a in [1 + y * side + x]]
    lines += [f"t crease 2/1/0 {y * side + n} {(y + 1) * side + n} 10" for y in range(n)]
    return "\n".join(lines).encode() + b"\n"


class Computations(DaemonCase):
    def test_breaks_of_a_fold(self):
        with sheen.connect(self.daemon.unix) as session:
            found = session.breaks(session.upload(folded(30), "fold.obj"))
            self.assertEqual((found.edges_out, found.creases, found.joints, len(found.edges)), (3, 3, 0, 3))
            self.assertTrue(found)
            self.assertFalse(found.within)
            self.assertIn("3 edges (3 creases, 0 semi-sharp, 0 joints), 3 out of tolerance on 3 units", str(found))
            self.assertEqual(found.angle_deg, 0.1)
            self.assertAlmostEqual(found.creases_length, 3, delta=1e-9)
            self.assertEqual(found.edges["kind"].tolist(), [0, 0, 0])
            self.assertTrue(np.allclose(found.edges["angle"]["value"], 30, rtol=0, atol=1e-6))
            self.assertTrue(np.allclose(found.edges["length"], 1, rtol=0, atol=1e-9))
            self.assertTrue(np.allclose(found.edges["angle"]["position"][:, (0, 2)], 0, atol=1e-9))
            self.assertTrue(np.allclose(found.edges["gap"]["value"], 0, atol=1e-6))
            loose = session.breaks(session.upload(folded(30), "fold.obj"), gap=1, angle_deg=40, curvature_percent=200)
            self.assertEqual((bool(loose), loose.within, loose.edges_out, loose.angle_deg), (False, True, 0, 40))
            for options in ({"angle_deg": 0}, {"gap": -1}, {"curvature_percent": float("nan")}, {"fov": 200}):
                with self.assertRaises((sheen.BadRequest, sheen.BadArgument)):
                    session.breaks(session.upload(folded(30), "fold.obj"), **options)
            closed = session.breaks(session.upload(CUBE, "cube.obj"))
            self.assertEqual((len(closed.edges), len(closed.vertices), closed.borders), (0, 8, 0))
            self.assertEqual(closed.vertices["faces"].tolist(), [3] * 8)


LOOSE = {"distance": 1, "normal_deg": 90, "lines": "off"}
LIMITS_OF_COMPARISON = (
    {}, LOOSE, {**LOOSE, "distance": 1e-5}, {**LOOSE, "distance": "1e-5@90%"}, {**LOOSE, "distance": "1e-5@1%"},
    {**LOOSE, "distance": (1e-5, 0.9)}, {**LOOSE, "normal_deg": "0.01@99%"}, {**LOOSE, "normal_deg": 0.01},
    {**LOOSE, "rotation_deg": 1e-9}, {**LOOSE, "uncovered_area": 0})


class Comparisons(DaemonCase):
    def verdict(self, old, new, limits):
        """What the command says of the same files and limits."""
        with tempfile.TemporaryDirectory(prefix="sheen-test-") as folder:
            for name, data in (("old.obj", old), ("new.obj", new)):
                with open(os.path.join(folder, name), "wb") as file:
                    file.write(data)
            texts = [f"--limit={name}=" + (f"{limit[0]}@{limit[1] * 100}%" if isinstance(limit, tuple) else str(limit))
                     for name, limit in limits.items()]
            done = subprocess.run([SHEEN, "compare", "old.obj", "new.obj", "--align", "--json", "--samples=20000",
                                   "--server", self.daemon.unix, *texts], cwd=folder, capture_output=True, text=True,
                                  timeout=120)
        self.assertLess(done.returncode, 2, done.stderr)
        return json.loads(done.stdout)["verdict"]

    def test_a_moved_vertex(self):
        """A regular vertex takes the surface with it by 4/9 of its way."""
        flat = re.sub(rb"(v \S+ \S+) \S+", rb"\1 0", grid(6))
        rows = flat.split(b"\n")
        rows[24] = rows[24].rsplit(b" ", 1)[0] + b" 0.001"  # inside
        told = []
        with sheen.connect(self.daemon.unix) as session:
            old, new = session.upload(flat, "old.obj"), session.upload(b"\n".join(rows), "new.obj")
            found = session.compare(old, new, samples=20000, limits={"distance": 1e-5, "curvature": 0.1},
                                    progress=lambda *each: told.append(each))
            self.assertTrue(found.differs)
            self.assertEqual((found.limits["distance"], found.limits["curvature"]), (1e-5, 0.1))
            self.assertAlmostEqual(found.worst("distance").worst, 0.001 * 4 / 9, delta=1e-6)
            self.assertAlmostEqual(found.worst("distance").new.position[2], 0.001 * 4 / 9, delta=1e-6)
            self.assertGreater(found.old.distance.area_out, 0)
            self.assertLessEqual({"distance", "normal_deg", "lines", "curvature"}, set(found.new.measures))
            same = session.compare(old, old, samples=20000, align=True)
            self.assertTrue(same.identical and not found.identical)
            self.assertEqual(same.alignment.free_directions, 3)  # those of a plane
            self.assertFalse(same.differs)
            self.assertEqual((same.worst("distance").worst, same.worst("normal_deg").worst), (0, 0))
            self.assertIsNone(same.worst("curvature"))  # nobody asked
            self.assertTrue(np.allclose(same.alignment.rotation, np.eye(3), atol=1e-9))
            self.assertIsNone(found.alignment)
            self.assertAlmostEqual(same.old.area, same.new.area)
            for limits in LIMITS_OF_COMPARISON:
                mine = session.compare(old, new, samples=20000, align=True, limits=limits)
                self.assertEqual(mine.differs, self.verdict(flat, b"\n".join(rows), limits) == "differs", limits)
            for limits in ({"normal_deg": "1@"}, {"lines": "1@2"}, {"distance": "1@101%"}, {"distance": (1, 2)},
                           {"rotation_deg": "1@1%"}, {"uncovered_area": -1}, {"lines": "x"}):
                with self.assertRaisesRegex(sheen.BadArgument, "limits"):
                    session.compare(old, new, limits=limits)
            with self.assertRaisesRegex(sheen.BadArgument, "no measure normal"):
                session.compare(old, new, limits={"normal": 1})
            for limits in ({"distance": -1}, {"normal_deg": 181}, {"lines": float("nan")}):
                with self.assertRaises((sheen.BadRequest, sheen.BadArgument)):
                    session.compare(old, new, limits=limits)
            session.render(old, size=(8, 8))  # the session goes on

    def test_a_missing_face(self):
        with tempfile.TemporaryDirectory(prefix="sheen-test-") as folder:
            paths = []
            flat = re.sub(rb"(v \S+ \S+) \S+", rb"\1 0", grid(6))
            for name, data in (("whole.obj", flat), ("open.obj", flat[:flat.rindex(b"f ")])):
                paths.append(os.path.join(folder, name))
                with open(paths[-1], "wb") as file:
                    file.write(data)
            before = os.environ.get("SHEEN_SERVER")
            os.environ["SHEEN_SERVER"] = self.daemon.unix
            try:
                found = sheen.compare(*paths, samples=20000)
            finally:
                os.environ.pop("SHEEN_SERVER")
                if before is not None:
                    os.environ["SHEEN_SERVER"] = before
        self.assertTrue(found.differs)
        self.assertTrue(0.3 < found.old.area_uncovered < 1.2, found.old)
        self.assertIsNotNone(found.old.uncovered)
        self.assertEqual(found.new.area_uncovered, 0)
        self.assertAlmostEqual(found.old.area - found.new.area, found.old.area_uncovered, delta=0.05)


class Curves(DaemonCase):
    def test_lines(self):
        with sheen.connect(self.daemon.unix) as session:
            model = session.upload(FENDER)
            found = session.lines(model, pattern="stripes:count=20")
            self.assertGreater(len(found), 3)
            self.assertEqual({(curve.kind, curve.light) for curve in found.curves}, {("line", 0)})
            for curve in found.curves:
                points = curve.points
                self.assertGreaterEqual(len(points), 2)
                self.assertLess(np.nanmax(abs(points["residual"])), 1e-9)
                steps = np.linalg.norm(np.diff(points["position"], axis=0), axis=1)
                if not curve.closed:
                    self.assertAlmostEqual(steps.sum(), curve.length, delta=1e-6)
                self.assertTrue(np.allclose(points["length"][1:], np.cumsum(steps), atol=1e-6))
                self.assertTrue(np.allclose(np.linalg.norm(points["normal"], axis=1), 1))
                self.assertAlmostEqual((curve.place * 20 - 0.25) % 1, 0, delta=1e-9)  # the middle of a bright stripe
            other = session.lines(model, at=[curve.place for curve in found.curves[:1]], tolerance=1)
            self.assertEqual({curve.place for curve in other.curves}, {found.curves[0].place})
            self.assertEqual(other.tolerance, 1)
            self.assertLess(sum(len(curve.points) for curve in other.curves), sum(len(curve.points) for curve in found.curves))
            one = session.lines(model, at=found.curves[0].place, tolerance=1)  # one number
            self.assertEqual([curve.length for curve in one.curves], [curve.length for curve in other.curves])
            outline = session.lines(session.upload(CUBE, "cube.obj"), silhouettes=True)
            self.assertEqual([(curve.kind, math.isnan(curve.place)) for curve in outline.curves], [("silhouette", True)])
            for options in ({"tolerance": -1.0}, {"at": [0.5] * 257}, {"pattern": "rainbow"}):
                with self.assertRaises((sheen.BadRequest, sheen.BadArgument)):
                    session.lines(model, **options)
            session.render(model, size=(8, 8))  # the session goes on

    def test_wrong_types(self):
        """A value of the wrong type is refused by the name of its option, before anything is asked."""
        with sheen.connect(self.daemon.unix) as session:
            model = session.upload(CUBE, "cube.obj")
            camera = session.render(model, size=(8, 8)).camera
            for name, call in (("at", lambda: session.lines(model, at=["a"])),
                               ("at", lambda: session.lines(model, at=object())),
                               ("tolerance", lambda: session.lines(model, tolerance="fine")),
                               ("gap", lambda: session.breaks(model, gap=[1])),
                               ("samples", lambda: session.compare(model, model, samples="many")),
                               (r"limits\['distance'\]:", lambda: session.compare(model, model, limits={"distance": "far"})),
                               ("x", lambda: session.pick(model, camera, "left", 0)),
                               ("start", lambda: session.section(model, camera, 3, (1, 1))),
                               ("samples", lambda: session.section(model, camera, (0, 0), (1, 1), "many")),
                               ("size", lambda: session.render(model, size=7)),
                               ("up", lambda: session.render(model, up=1))):
                with self.assertRaisesRegex(sheen.BadArgument, f"^{name} "):
                    call()
            table = str(session.section(model, camera, (0, 0), (7, 7), 3, size=(8, 8))).splitlines()
            self.assertEqual((len(table), table[0].split()[0], len(table[2].split())), (4, "x", 9))


class Loss(unittest.TestCase):
    def private(self, **options):
        return sheen.connect(sheend=SHEEND, device=DEVICE, **options)

    def test_private_daemon_ends_with_its_session(self):
        with self.private(native_threads=1) as session:
            pid = session._daemon.pid
            self.assertGreater(session.stats().uptime_us, 0)
            os.kill(pid, 0)
        with self.assertRaises(ProcessLookupError):
            os.kill(pid, 0)
        with self.assertRaises(sheen.Lost):
            session.stats()

    def test_killed_daemon(self):
        """Killed while it draws a frame that takes long, and between frames."""
        for wait_s in (0, 0.3):
            with self.private() as session:
                model = session.upload(CUBE, "cube.obj")
                pid = session._daemon.pid
                killer = threading.Timer(wait_s, os.kill, (pid, signal.SIGKILL))
                killer.start()
                if not wait_s:
                    killer.join()
                with self.assertRaisesRegex(sheen.Lost, "private daemon died of signal 9") as caught:
                    for _ in range(100):
                        session.render(model, size=(4000, 4000))
                killer.join()
                self.assertEqual(caught.exception.exit_code, 4)
                self.assertIsInstance(caught.exception, ConnectionError)
                with self.assertRaises(sheen.Lost):
                    session.render(model)

    def test_daemon_that_stops_answering(self):
        with self.private(timeout=0.5) as session:
            os.kill(session._daemon.pid, signal.SIGSTOP)
            try:
                with self.assertRaises(sheen.Timeout) as caught:
                    session.stats()
            finally:
                os.kill(session._daemon.pid, signal.SIGCONT)
            self.assertIsInstance(caught.exception, TimeoutError)

    def test_no_daemon(self):
        with self.assertRaisesRegex(sheen.NoServer, "SHEEN_DAEMON"):
            sheen.connect(sheend="/no/such/sheend")
        with self.assertRaises(sheen.NoServer):
            sheen.connect("unix:/no/such/socket")
        with self.assertRaises(sheen.DeviceFailed) as caught:
            sheen.connect(sheend=SHEEND, device="99")
        self.assertEqual(caught.exception.exit_code, 5)
        for address in ("unix:", "tcp:here", "tcp:a:0", "http://a", "tcp:::1:5", "unix:" + "x" * 108):
            with self.subTest(address=address), self.assertRaises(sheen.BadArgument):
                sheen.connect(address)


class FakeServer:
    """Sends prepared bytes to each client, whatever that says, and closes its side. Keeps what the clients said."""

    def __init__(self, *answers):
        self.folder = tempfile.TemporaryDirectory(prefix="sheen-test-")
        self.unix = "unix:" + os.path.join(self.folder.name, "fake.sock")
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(self.unix[5:])
        self.listener.listen()
        self.said = []
        self.thread = threading.Thread(target=self.serve, args=(answers,))
        self.thread.start()

    def serve(self, answers):
        for answer in answers:
            client, _ = self.listener.accept()
            with client:
                said = bytearray()
                reader = threading.Thread(target=lambda: said.extend(iter_of(client)))
                reader.start()
                try:
                    client.sendall(answer)
                    client.shutdown(socket.SHUT_WR)
                except OSError:
                    pass  # the client has closed
                reader.join()
            self.said.append(bytes(said))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.thread.join(60)
        self.listener.close()
        self.folder.cleanup()


def iter_of(client):
    out = bytearray()
    try:
        while data := client.recv(1 << 16):
            out += data
    except OSError:
        pass  # the client has closed with unread bytes
    return out


def messages_of(data):
    """(type, seq, body) of each message."""
    found = []
    while data:
        _, _, kind, _, length, seq = wire.HEADER.unpack(data[:16])
        found.append((kind, seq, data[16:16 + length]))
        data = data[16 + length:]
    return found


class Hostile(unittest.TestCase):
    """Servers that are not a sheend."""
    @classmethod
    def setUpClass(cls):
        """What a daemon answers to `work`, message by message."""
        daemon = Daemon()
        parts = []
        with between.Between(daemon) as relay:
            with sheen.connect(relay.unix) as session:
                received = session._connection.read_into

                def keep(view):
                    received(view)
                    parts.append(bytes(view))
                session._connection.read_into = keep
                hello = messages.HelloOk(**vars(session.server))
                cls.work(session)
        assert daemon.stop() == 0
        cls.hello = wire.message(wire.HELLO_OK, 1, protobuf.encode(hello))
        cls.answers = cls.hello + b"".join(parts)
        cls.messages = messages_of(cls.answers)

    @staticmethod
    def work(session):
        model = session.upload(CUBE, "cube.obj")
        info = session.info(model)
        some = ("colour", "position", "ptex", "coverage")
        frames = [session.render(model, planes=names, format=format, size=(16, 12))
                  for format, names in (("raw", some), ("zstd", some), ("png", "colour"))]
        frames += session.stream(model, [{"view": "left"}, {"view": "top", "show": "mean"}], size=(8, 8))
        session.stats()
        session.breaks(session.upload(folded(30), "fold.obj"))
        session.compare(model, session.upload(folded(30), "fold.obj"), samples=2000)
        session.lines(model, at=[0.3], tolerance=0.05)
        return info, frames

    def work_with(self, relay):
        with sheen.connect(relay.unix, timeout=20) as session:
            return self.work(session)

    def test_recorded_answers(self):
        """Without a fault the work succeeds, so that faults are what makes it fail."""
        kinds = {kind for kind, _, _ in self.messages}
        self.assertLessEqual({wire.HELLO_OK, wire.UPLOAD_STATE, wire.MODEL_INFO, wire.FRAME, wire.DATA, wire.STATS,
                              wire.BREAKS, wire.COMPARED, wire.CURVES}, kinds)
        with FakeServer(self.answers) as server:
            info, frames = self.work_with(server)
        self.assertEqual((info.faces, len(frames)), (6, 5))
        self.assertEqual(bits(frames[0].ptex), bits(frames[1].ptex))

    def mutated(self, chance):
        """The answers with one fault."""
        data = bytearray(self.answers)
        kind = chance.randrange(7)
        at = chance.randrange(len(data))
        if kind == 0:
            data[at] ^= 1 << chance.randrange(8)
        elif kind == 1:
            data[at:at + chance.randrange(1, 9)] = chance.randbytes(chance.randrange(9))
        elif kind == 2:
            del data[at:]
        elif kind == 3:  # in a header or at the beginning of a body, where most rules are
            starts, here = [], 0
            for _, _, body in self.messages:
                starts.append(here)
                here += 16 + len(body)
            at = min(len(data) - 1, chance.choice(starts) + chance.randrange(40))
            data[at] = chance.choice((0, 1, 0x7f, 0x80, 0xff, chance.randrange(256)))
        else:
            rows = [wire.HEADER.pack(wire.MAGIC, 1, kind, header.END if kind == wire.DATA else 0, len(body), seq) + body
                    for kind, seq, body in self.messages]
            i, j = chance.randrange(len(rows)), chance.randrange(len(rows))
            if kind == 4:
                del rows[i]
            elif kind == 5:
                rows[i], rows[j] = rows[j], rows[i]
            else:
                rows.insert(i, rows[j])
            data = b"".join(rows)
        return bytes(data)

    def test_random_faults(self):
        """Each ends in success or one exception of the package with one line, and at once."""
        chance = random.Random(19)
        faulty = [self.mutated(chance) for _ in range(600)]
        outcomes = collections.Counter()
        with FakeServer(*faulty) as server:
            for i in range(len(faulty)):
                with self.subTest(i=i):
                    try:
                        self.work_with(server)
                        outcomes["success"] += 1
                    except sheen.Error as failure:
                        self.assertNotIsInstance(failure, (sheen.Timeout, sheen.BadArgument))
                        self.assertNotIn("\n", str(failure))
                        outcomes[type(failure).__name__] += 1
        self.assertGreater(outcomes["BadPeer"], 100, outcomes)
        self.assertGreater(outcomes["Lost"], 20, outcomes)

    def test_single_faults(self):
        """Each rule about answers."""
        upload_state = protobuf.encode(messages.UploadState(complete=True, received_bytes=0))
        state = wire.message(wire.UPLOAD_STATE, 2, upload_state)
        error = wire.message(wire.ERROR, 2, wire.field(1, 4) + wire.field(2, "bad\nmodel"))
        for words, answer in (
                ("SHEN", b"HTTP/1.1 400 Bad Request\r\n"), ("version 2", wire.message(2, 1, major=2)),
                ("type 99", self.hello + wire.message(99, 2)), ("UPLOAD_STATE has 2049", self.hello + wire.message(
                    wire.UPLOAD_STATE, 2, length=2049)),
                ("another answer", self.hello + wire.message(wire.UPLOAD_STATE, 3, upload_state)),
                ("another answer", self.hello + wire.message(wire.MODEL_INFO, 2, upload_state)),
                ("complete is missing", self.hello + wire.message(wire.UPLOAD_STATE, 2)),
                ("control characters", self.hello + error), ("no code 0", self.hello + wire.message(
                    wire.ERROR, 2, wire.field(1, 0) + wire.field(2, "x"))),
                ("no FRAME", self.hello + state + wire.message(wire.DATA, 3, b"x")),
                ("credits", wire.message(wire.HELLO_OK, 1, protobuf.encode(messages.HelloOk(
                    minor=1, server="", device="", driver="", software=True, max_width_px=1, max_height_px=1,
                    max_upload_bytes=1, credits=65)))),
                ("more bytes than the file", self.hello + wire.message(
                    wire.UPLOAD_STATE, 2, wire.field(1, 0) + wire.field(2, 1 << 40)))):
            with self.subTest(words=words), FakeServer(answer) as server:
                with self.assertRaisesRegex(sheen.BadPeer, words):
                    self.work_with(server)

    def test_upload_goes_on_where_it_broke(self):
        model = grid(200)
        kept = 300000
        self.assertGreater(len(model), 4 * 262144)
        answers = self.hello + wire.message(wire.UPLOAD_STATE, 2, wire.field(1, 0) + wire.field(2, kept)) + wire.message(
            wire.UPLOAD_STATE, 2, wire.field(1, 1) + wire.field(2, len(model)))
        with FakeServer(answers) as server:
            with sheen.connect(server.unix) as session:
                session.upload(model, "grid.obj")
        chunks = [body for kind, _, body in messages_of(server.said[0]) if kind == wire.UPLOAD_CHUNK]
        self.assertEqual(b"".join(chunks), model[kept:])
        self.assertEqual(max(map(len, chunks)), 262144)


class Tls(unittest.TestCase):
    def test_certificates_and_tokens(self):
        with tempfile.TemporaryDirectory(prefix="sheen-test-") as folder:
            ours = authority.Authority(os.path.join(folder, "ours"))
            other = authority.Authority(os.path.join(folder, "other"))
            cert, key = ours.issue("server")
            client = ours.issue("client")
            tokens = os.path.join(folder, "tokens")
            token = "correct-horse-battery-staple-0123"
            with open(tokens, "w", encoding="ascii") as file:
                file.write(subprocess.run([SHEEND, "--hash-token", "bot:2999-01-01"], input=token + "\n", check=True,
                                          capture_output=True, text=True, timeout=60).stdout)
            os.chmod(tokens, 0o600)
            daemon = Daemon("--listen", "tls:127.0.0.1:0", "--tls-cert", cert, "--tls-key", key, "--client-ca", ours.cert,
                            "--tokens", tokens, tcp=False)
            address = re.search(r"tls:127\.0\.0\.1:\d+", daemon.errors()).group()
            for options in ({"cert": client[0], "key": client[1]}, {"token": token}):
                with sheen.connect(address, ca=ours.cert, **options) as session:
                    frame = session.render(session.upload(CUBE, "cube.obj"), size=(32, 24), planes=ALL)
                    self.assertTrue(frame.hit.any())
            for options in ({}, {"token": "wrong-horse-battery-staple-012345"}, {"token": "x", "ca": other.cert}):
                with self.subTest(options=options), self.assertRaises(sheen.Lost):
                    sheen.connect(address, **{"ca": ours.cert, **options})
            with self.assertRaises(sheen.BadArgument):
                sheen.connect(address, ca=ours.cert, cert=client[0])
            with self.assertRaises(sheen.BadArgument):
                sheen.connect(address, ca="/no/such/file")
            self.assertEqual(daemon.stop(), 0)


class Manual(unittest.TestCase):
    """client/python/README.md."""

    def rows(self, title):
        with open(os.path.join(ROOT, "client", "python", "README.md"), encoding="utf-8") as file:
            part = file.read().partition(f"## {title}\n")[2].partition("\n## ")[0]
        return [row.split(" | ", 1) for row in re.findall(r"^\| (.*?) ?\|$", part, re.M)[1:]]

    def test_errors(self):
        codes = {}
        for code, text in self.rows("Errors"):
            for name in re.findall(r"`(\w+)`", text):
                codes[name] = int(code)
        found = {name: value.exit_code for name, value in vars(sheen).items()
                 if isinstance(value, type) and issubclass(value, sheen.Error) and value is not sheen.Error}
        self.assertEqual(codes, found)
        fatal = {name for name, value in vars(sheen).items() if getattr(value, "is_fatal", False) is True}
        self.assertEqual(fatal, {"NoServer", "Lost", "ShuttingDown", "BadPeer", "BadVersion", "Timeout"})

    def test_planes_and_methods(self):
        planes = [name for names, _ in self.rows("Frames") for name in re.findall(r"`(\w+)`", names)]
        self.assertEqual(sorted(planes), sorted(sheen.PLANES))
        methods = {name for names, *_ in self.rows("Sessions") for name in re.findall(r"`(\w+)\(", names)}
        self.assertEqual(methods, {name for name, value in vars(sheen.Session).items()
                                   if callable(value) and not name.startswith("_")} - {"close", "upload_image"})


class Command(DaemonCase):
    def run_it(self, *words):
        return subprocess.run([sys.executable, *words], capture_output=True, text=True, timeout=60,
                              env={**os.environ, "PYTHONPATH": os.path.join(BUILD, "python"), "PYTHONDONTWRITEBYTECODE": "1",
                                   "SHEEN_SERVER": self.daemon.unix})

    def test_command(self):
        with tempfile.TemporaryDirectory(prefix="sheen-test-") as folder:
            for name in ("a.png", "a.npz"):
                path = os.path.join(folder, name)
                done = self.run_it("-m", "sheen", "render", FENDER, "-o", path, "--size", "64x48", "--planes",
                                   "normal,ptex", "--lines", "zebra", "--class", "batch", "--view", "left")
                self.assertEqual((done.returncode, done.stderr), (0, ""))
            with np.load(path) as arrays:
                self.assertEqual((sorted(arrays), arrays["normal"].shape), (["normal", "ptex"], (48, 64, 3)))
            expected = os.path.join(folder, "b.png")
            subprocess.run([SHEEN, "render", FENDER, "-o", expected, "--size", "64x48", "--lines", "zebra", "--view",
                            "left", "-q", "--class", "batch", "--server", self.daemon.unix], check=True, timeout=60)
            with open(expected, "rb") as file, open(os.path.join(folder, "a.png"), "rb") as found:
                self.assertEqual(found.read(), file.read())
            for code, words in ((2, ("--fov", "200")), (2, ("--fov", "x")), (3, ("-o", "/no/such/a.png")),
                                (4, ("--server", "unix:/no/such"))):
                done = self.run_it("-m", "sheen", "render", FENDER, "-o", path, *words)
                self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (code, "", 1), done.stderr)
                self.assertTrue(done.stderr.startswith("sheen: "))
        done = self.run_it("-m", "sheen", "info", FENDER)
        self.assertEqual(json.loads(done.stdout)["name"], "fender.gltf")
        versions = [subprocess.run([SHEEN, "--version"], capture_output=True, text=True).stdout,
                    self.run_it("-m", "sheen", "version").stdout]
        self.assertEqual(*versions)

    def test_example_of_the_readme(self):
        with open(os.path.join(ROOT, "README.md"), encoding="utf-8") as file:
            lines = re.search(r"^    import numpy as np, sheen\n(?:    .*\n)+", file.read(), re.M).group()
        with tempfile.TemporaryDirectory(prefix="sheen-test-") as folder:
            program, picture = os.path.join(folder, "readme.py"), os.path.join(folder, "draft.png")
            with open(program, "w", encoding="utf-8") as file:
                file.write(textwrap.dedent(lines).replace("hood.obj", FENDER).replace("draft.png", picture))
            done = self.run_it(program)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, r"^least draft angle 3\.\d\d degrees, Ptex face \d+\n$")
            with open(picture, "rb") as file:
                self.assertEqual(pixels_of(file.read()).shape, (720, 1280, 3))

    def test_example(self):
        with tempfile.TemporaryDirectory(prefix="sheen-test-") as folder:
            done = self.run_it(os.path.join(ROOT, "client", "python", "examples", "notebook.py"), FENDER, folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, r"[1-9]\d?\.\d% of the pixels show the surface")
            self.assertEqual(len(os.listdir(folder)), 7)


if __name__ == "__main__":
    unittest.main()

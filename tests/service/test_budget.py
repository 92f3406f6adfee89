"""--memory-budget bounds what the daemon takes: a mixed load at small budgets, and its resident memory meanwhile."""
import random
import re
import struct
import threading
import time
import unittest
import zlib

import wire
from daemon import CUBE, DAEMON_MIB, SANITIZED, Daemon, budget, grid, resident_kb
from test_untrusted import image_pattern
from wire import BATCH, INTERACTIVE, Client

LOAD_S, WARM_UP_S = 9, 2
SIZES = ((64, 48), (160, 120), (320, 240), (640, 480), (1280, 720), (1600, 1000))
ENCODINGS = (wire.RAW, wire.ZSTD, wire.PNG, wire.JPEG)


def ppm(side):
    return f"P6\n{side} {side}\n255\n".encode() + bytes(range(256)) * (side * side * 3 // 256) + bytes(side * side * 3 % 256)


def png(side):
    """A black square, RGB of 8 bits."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(side * (1 + 3 * side)))) +
            chunk(b"IEND", b""))


def mixed_load(daemon, seed, ends, done):
    """One client: models, pictures of all sizes and kinds; who is refused goes on. Returns when `ends` has come, with
    the sizes of its pictures added to `done`; None is added at the end, if nothing failed."""
    noise = random.Random(seed)
    with Client(daemon.unix, minor=1, timeout=3600) as client:
        while time.monotonic() < ends:
            try:
                model = client.upload(noise.choice((CUBE, grid(noise.randrange(2, 90)))), "a.obj")
                for _ in range(noise.randrange(1, 6)):
                    size, extra = noise.choice(SIZES), b""
                    if noise.random() < 0.2:
                        extra = image_pattern(client.upload(ppm(noise.randrange(1, 400)), "i.ppm", wire.IMAGE))
                    client.render(model, *size, encoding=noise.choice(ENCODINGS), extra=extra,
                                  planes=1, kind=noise.choice((INTERACTIVE, wire.STILL, BATCH)))
                    done.append(size)
            except wire.Refused as refusal:
                if refusal.code not in (wire.ERROR_TOO_BIG, wire.ERROR_OVERLOADED, wire.ERROR_MODEL, wire.ERROR_IMAGE,
                                        wire.ERROR_REQUEST, wire.ERROR_UNKNOWN_MODEL):
                    raise
    done.append(None)


def folded_sheet(side):
    """side x side patches in OBJ's free form, between four points."""
    rows = [" ".join(str(1 + i % 2 + 2 * (j % 2)) for i in range(side + 3)) for j in range(side + 3)]
    knots = " ".join(str(k) for k in range(-3, side + 4))
    return (f"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0.3\ncstype bspline\ndeg 3 3\nsurf 0 {side} 0 {side} " +
            " \\\n".join(rows) + f"\nparm u {knots}\nparm v {knots}\nend\n").encode()


class Resident(unittest.TestCase):
    def test_views_that_are_dropped_change_no_byte(self):
        """Three clients' frames have no room beside each other, so that what each is drawn on goes between its tiles."""
        frames = ((700, 500, wire.STILL), (300, 300, INTERACTIVE), (680, 520, BATCH))
        pictures = {}
        for room in ("--memory-budget", "1G"), ("--memory-budget", budget(66)):
            daemon, got = Daemon(*room, tcp=False), []

            def draw(width, height, kind):
                with Client(daemon.unix, minor=1) as client:
                    model = client.upload(grid(30), "sheet.obj")
                    for _ in range(4):
                        got.append((kind, client.render(model, width, height, kind=kind).data))

            clients = [threading.Thread(target=draw, args=frame) for frame in frames]
            for client in clients:
                client.start()
            for client in clients:
                client.join()
            self.assertEqual(len(got), 12)
            for kind, data in got:
                self.assertEqual(pictures.setdefault(kind, data), data)
            self.assertEqual(daemon.stop(), 0)

    def test_an_image_is_refused_before_it_is_decoded(self):
        """A small file of many pixels: they have no room twice, as the worker's answer and as what the daemon keeps."""
        daemon = Daemon("--memory-budget", budget(64), tcp=False)
        most_kb = (DAEMON_MIB + 64) * 1024 * 1.15
        with Client(daemon.unix) as client:
            model = client.upload(CUBE, "cube.obj")
            client.render(model)
            for side, taken in (500, True), (3500, False):  # 3500 x 3500 RGB: 49 MB
                image = client.upload(png(side), "wide.png", wire.IMAGE)
                if taken:
                    client.render(model, extra=image_pattern(image))
                    continue
                with self.assertRaises(wire.Refused) as caught:
                    client.render(model, extra=image_pattern(image))
                self.assertEqual(caught.exception.code, wire.ERROR_IMAGE)
                self.assertRegex(caught.exception.text,
                                 rf"^wide.png needs \d+ bytes .* memory budget has {64 << 20} for it")
                need = int(re.search(r"needs (\d+)", caught.exception.text).group(1))
                self.assertGreaterEqual(need, 2 * 4 * side * side)
            with open(f"/proc/{daemon.process.pid}/status", encoding="ascii") as status:
                peak_kb = int(re.search(r"VmHWM:\s*(\d+)", status.read()).group(1))
            self.assertLess(0 if SANITIZED else peak_kb, most_kb)
            self.assertLess(client.stats()[62][0], 1 << 20)  # nothing stays reserved for the work
        self.assertEqual(daemon.stop(), 0)

    def test_patches_are_refused_before_they_are_joined(self):
        """A file of 2 bytes a patch, each of which takes more than a kilobyte until its tables are made."""
        daemon = Daemon("--memory-budget", budget(64), tcp=False)
        with Client(daemon.unix) as client:
            for side, taken in (100, True), (300, False):
                model = client.upload(folded_sheet(side), "sheet.obj")
                if taken:
                    client.render(model)
                    continue
                with self.assertRaises(wire.Refused) as caught:
                    client.render(model)
                need = int(re.search(r"needs at least (\d+) bytes", caught.exception.text).group(1))
                self.assertGreater(need, 1000 * side * side)
            client.render(client.upload(CUBE, "cube.obj"))
        self.assertEqual(daemon.stop(), 0)

    @unittest.skipIf(SANITIZED, "sanitizers hoard memory")
    def test_stays_within_the_budget(self):
        for mib in (4, 96):  # the least, and one in which frames, views and models push each other out
            with self.subTest(budget=budget(mib)):
                daemon, done = Daemon("--memory-budget", budget(mib), tcp=False), []
                ends = time.monotonic() + LOAD_S
                clients = [threading.Thread(target=mixed_load, args=(daemon, seed, ends, done)) for seed in range(3)]
                for client in clients:
                    client.start()
                most_kb = 0
                time.sleep(WARM_UP_S)
                while any(client.is_alive() for client in clients):
                    most_kb = max(most_kb, resident_kb(daemon.process.pid))
                    time.sleep(0.01)
                self.assertEqual(done.count(None), len(clients))
                self.assertGreater(len(done), 8)  # and not all of it refused
                self.assertLess(most_kb, (DAEMON_MIB + mib) * 1024 * 1.15)
                self.assertEqual(daemon.stop(), 0)

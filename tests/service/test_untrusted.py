"""Files that attack their parser, and processes that die: the sender gets an error, and nothing else happens."""
import contextlib
import os
import signal
import struct
import subprocess
import time
import unittest

import pictures
import wire
from daemon import BUILD, CUBE, SANITIZED, Daemon, DaemonCase, resident_kb
from wire import Client, field

WORKERS = ("sheend-cage", "sheend-image")


def image_pattern(sha256):
    return field(5, field(6, field(1, wire.PATTERN_IMAGE) + field(6, sha256)))


def children(pid):
    """The child processes of all threads of a process."""
    found = []
    for thread in os.listdir(f"/proc/{pid}/task"):
        with open(f"/proc/{pid}/task/{thread}/children", encoding="ascii") as file:
            found += [int(child) for child in file.read().split()]
    return found


def workers(pid):
    """The running worker programs of a daemon, by name. Each is the child of its starter."""
    found = {}
    for starter in children(pid):
        with contextlib.suppress(OSError):  # the process has ended in the meantime
            for child in children(starter):
                found[os.path.basename(os.readlink(f"/proc/{child}/exe"))] = child
    return found


def is_alive(pid):
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii") as file:
            return file.read().rsplit(")", 1)[1].split()[0] not in "ZX"
    except OSError:
        return False


def wait_for_end(pids):
    for _ in range(500):
        if not any(is_alive(pid) for pid in pids):
            return True
        time.sleep(0.01)
    return False


def tiff(tile):
    """A picture of 64 x 64 pixels with one tile that is much larger, and whose bytes are missing."""
    entries = ((256, 4, 64), (257, 4, 64), (258, 3, 8), (259, 3, 1), (262, 3, 1), (277, 3, 4),
               (322, 4, tile), (323, 4, tile), (324, 4, 8), (325, 4, 16))
    return (b"II*\0" + struct.pack("<IH", 8, len(entries)) +
            b"".join(struct.pack("<HHII", tag, kind, 1, value) for tag, kind, value in entries) +
            bytes(4))


def exr(tile):
    """The same as an EXR file."""
    attribute = lambda name, kind, value: (name + b"\0" + kind + b"\0" +
                                           struct.pack("<I", len(value)) + value)
    box = struct.pack("<4i", 0, 0, 63, 63)
    return (b"\x76\x2f\x31\x01" + struct.pack("<I", 0x202) +
            attribute(b"channels", b"chlist", b"R\0" + struct.pack("<iB3xii", 2, 0, 1, 1) + b"\0") +
            attribute(b"compression", b"compression", b"\0") +
            attribute(b"dataWindow", b"box2i", box) + attribute(b"displayWindow", b"box2i", box) +
            attribute(b"lineOrder", b"lineOrder", b"\0") +
            attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)) +
            attribute(b"screenWindowCenter", b"v2f", bytes(8)) +
            attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) +
            attribute(b"tiles", b"tiledesc", struct.pack("<IIB", tile, tile, 0)) + b"\0" +
            struct.pack("<Q", 10000) * 64 + bytes(200))


class Untrusted(DaemonCase):
    arguments = ("--memory-budget", "300M")

    def refused_image(self, client, data, name, words):
        model = client.upload(CUBE, "cube.obj")
        image = client.upload(data, name, wire.IMAGE)
        client.send(wire.render(9, model, extra=image_pattern(image)))
        self.assert_refused(client, wire.ERROR_IMAGE, words, 9)

    def test_no_parser_in_the_daemon(self):
        with Client(self.daemon.unix) as client:
            client.render(client.upload(CUBE, "cube.obj"), encoding=wire.EXR)
        with open(f"/proc/{self.daemon.process.pid}/maps", encoding="ascii") as maps:
            loaded = maps.read()
        self.assertIn("libepoxy", loaded)
        for library in ("OpenImageIO", "tinygltf", "libIlmImf", "libOpenEXR", "libtiff"):
            self.assertNotIn(library, loaded)

    def test_images_that_take_gigabytes(self):
        pid = self.daemon.process.pid
        before = resident_kb(pid)
        refused = "of the 300 MB that it may take"
        for data, name, words in ((tiff(30000), "tile.tif", refused), (exr(20000), "tile.exr", refused),
                                  (pictures.tga(12000), "square.tga", "memory budget has")):
            if SANITIZED:
                break  # without a limit of memory
            with self.subTest(name=name), Client(self.daemon.unix) as client:
                self.refused_image(client, data, name, words)
        self.assertLess(resident_kb(pid) - before, 32 * 1024)

    def test_dead_workers_are_started_again(self):
        pid = self.daemon.process.pid
        for encoding in (wire.RAW, wire.EXR):
            before = workers(pid)
            self.assertEqual(sorted(before), sorted(WORKERS))
            for worker in before.values():
                os.kill(worker, signal.SIGKILL)
            self.assertTrue(wait_for_end(before.values()))
            with Client(self.daemon.unix) as client:
                cube = CUBE + b"# %d\n" % encoding
                image = client.upload(b"P6\n1 1\n255\n\xff\0" + bytes([encoding]), "dot.ppm",
                                      wire.IMAGE)
                client.render(client.upload(cube, "cube.obj"), encoding=encoding,
                              extra=image_pattern(image))
            after = workers(pid)
            self.assertEqual(sorted(after), sorted(WORKERS))
            self.assertFalse(set(before.values()) & set(after.values()))

    def test_the_daemon_writes_png_and_jpeg_itself(self):
        with Client(self.daemon.unix) as client:
            model = client.upload(CUBE, "cube.obj")
            client.render(model, encoding=wire.TIFF)
            writer = workers(self.daemon.process.pid)["sheend-image"]
            os.kill(writer, signal.SIGSTOP)
            try:
                for encoding in (wire.PNG, wire.JPEG):
                    client.render(model, encoding=encoding)
                seq = client.ask(model, encoding=wire.TIFF)
                with self.assertRaises(TimeoutError):
                    client.socket.settimeout(0.5)
                    client.read_frame(seq)
            finally:
                os.kill(writer, signal.SIGCONT)
            client.socket.settimeout(30)
            client.read_frame(seq)

    def test_nothing_stays_of_a_job(self):
        pid = self.daemon.process.pid
        with Client(self.daemon.unix) as client:
            for i in range(5):
                client.render(client.upload(CUBE + b"# %d\n" % i, "cube.obj"), encoding=wire.EXR)
                self.refused_image(client, b"P6\n9 9\n255\n" + bytes([i]), "cut.ppm", "cut.ppm")
            for worker in workers(pid).values():
                self.assertEqual(children(worker), [])
        for process in [pid, *workers(pid).values()]:
            targets = []
            for fd in os.listdir(f"/proc/{process}/fd"):
                with contextlib.suppress(FileNotFoundError):  # the client's connection is being closed
                    targets.append(os.readlink(f"/proc/{process}/fd/{fd}"))
            kept = [target for target in targets if "memfd:sheend-" in target]
            # Pictures were written one at a time, so one file of input is kept for the next.
            self.assertEqual(len(kept), 1 if process == pid else 0, kept)
            self.assertFalse([target for target in kept if "input" not in target])


class CutPieces(DaemonCase):
    """A surface that reaches 1e15 units beyond its other vertices: all its pieces reach far beyond the picture, and
    are cut to it."""
    CAGE = b"""v 0 0 -0.207673081
v 1 0 -0.0936913328
v 0.623489802 0.781831482 -0.100010153
v -0.222520934 0.974927912 0.0148677797
v -0.900968868 0.433883739 -0.408690837
v -0.900968868 -0.433883739 0.262366648
v 1e+15 -0.974927912 -0.032048851
v 0.623489802 -0.781831482 0.390586157
f 1 2 3
f 1 4 5
f 1 5 6
f 1 6 7
f 1 7 8
f 1 8 2
t crease 2/1/0 0 5 9.99
"""
    CAMERA = bytes.fromhex("223a0a1b09cca7d7908d030c4011d03fce500c1ff8bf196a67f1e5387c0cc0121b0906dbad1d0fcadb3f1138ed59c62941e53f19ef2e"
                           "c895c77ee03f")

    def test_a_view_that_cuts_too_many_is_refused(self):
        """It took 21 s of the thread that draws."""
        with Client(self.daemon.unix, timeout=60) as client:
            model = client.upload(self.CAGE, "far.obj")
            with self.assertRaises(wire.Refused) as caught:
                client.render(model, 48, 40, extra=self.CAMERA)
            self.assertEqual(caught.exception.code, wire.ERROR_REQUEST)
            self.assertIn("grid vertices", caught.exception.text)


class Slow(DaemonCase):
    """A file that takes long delays nobody but its sender."""
    arguments = ("--threads", "1")

    def test_frames_of_others_go_on(self):
        with Client(self.daemon.unix) as slow, Client(self.daemon.unix) as other:
            model = other.upload(CUBE, "cube.obj")
            other.render(model, encoding=wire.ZSTD)
            files = [slow.upload(CUBE + b"# %d\n" % i, "slow.obj") for i in range(2)]
            reader = workers(self.daemon.process.pid)["sheend-cage"]
            os.kill(reader, signal.SIGSTOP)
            try:
                for i, file in enumerate(files):  # as many as are read at once
                    slow.send(wire.render(50 + i, file))
                time.sleep(0.2)
                for encoding in (wire.RAW, wire.ZSTD, wire.PNG, wire.TIFF):
                    other.render(model, encoding=encoding)
            finally:
                os.kill(reader, signal.SIGCONT)
            for i in range(2):
                slow.read_frame(50 + i)


class Ends(unittest.TestCase):
    """Workers end with their daemon, however the daemon ends."""

    def test_workers_end_with_the_daemon(self):
        for kill in (signal.SIGTERM, signal.SIGKILL):
            daemon = Daemon(tcp=False)
            found = list(workers(daemon.process.pid).values())
            self.assertEqual(len(found), 2)
            daemon.process.send_signal(kill)
            daemon.process.wait(60)
            self.assertTrue(wait_for_end(found))
            daemon.stop()

    def test_workers_by_themselves(self):
        for name in WORKERS:
            done = subprocess.run([os.path.join(BUILD, name)], capture_output=True, text=True,
                                  timeout=60, check=False)
            self.assertEqual(done.returncode, 2)
            self.assertIn("a part of sheend", done.stderr)

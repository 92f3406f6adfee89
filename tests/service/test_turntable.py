"""sheen stream -o: every frame is in a file of its own, complete, and once."""
import json
import os
import resource
import signal
import struct
import subprocess
import tempfile
import time
import unittest

import wire
from test_surface import read_png
from between import FORWARD, HOLD, Between, cut_at
from daemon import MODELS, SHEEN, DaemonCase
from test_client import sheen

BODY = os.path.join(MODELS, "body.obj")
FENDER = os.path.join(MODELS, "fender.obj")
SMALL = ("--size", "96x64")


def read(path):
    with open(path, "rb") as file:
        return file.read()


@unittest.skipUnless(os.path.exists(SHEEN), "no client in this build")
class Turntable(DaemonCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="sheen-test-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def stream(self, pattern, *arguments, server=None, **options):
        return sheen("stream", FENDER, "-o", os.path.join(self.folder, pattern), "--server",
                     server or self.daemon.unix, *SMALL, *arguments, **options)

    def files(self):
        return {name: read(os.path.join(self.folder, name)) for name in os.listdir(self.folder)}

    def test_frames_are_pictures(self):
        """In every format. Where only the light moves, the first frame equals that of `sheen render`."""
        for ending in ("png", "exr", "jpg", "tif"):
            done = self.stream("a_%03d." + ending, "--frames", "4", "--orbit", "90", "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            told, files = json.loads(done.stdout), self.files()
            self.assertEqual(sorted(files), [f"a_{k:03}.{ending}" for k in range(4)])
            self.assertEqual([frame["file"] for frame in told["frames"]],
                             [os.path.join(self.folder, name) for name in sorted(files)])
            self.assertEqual(len(set(files.values())), 4, "it turns")
            self.assertEqual((told["written"], told["written_bytes"]),
                             (4, sum(map(len, files.values()))))
            one = os.path.join(self.folder, "one." + ending)
            done = self.stream("a_%03d." + ending, "--frames", "1", "--light-only")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(sheen("render", FENDER, "-o", one, *SMALL, "--server",
                                   self.daemon.unix).returncode, 0)
            self.assertEqual(read(one), self.files()["a_000." + ending])
            for name in os.listdir(self.folder):
                os.unlink(os.path.join(self.folder, name))
        done = self.stream("%d.png", "--frames", "2")
        self.assertIn("%d.png: 2 files, ", done.stdout)
        done = sheen("stream", FENDER, "--frames", "2", *SMALL, "--json", "--server",
                     self.daemon.unix)
        self.assertNotIn("written", done.stdout)

    def test_an_interrupt_ends_it_with_the_table(self):
        """Ctrl-C goes to the whole process group: to a private daemon, too."""
        for server in (("--server", self.daemon.unix), ("--device", "software")):
            for form in ((), ("--json",)):
                with self.subTest(server=server, form=form):
                    pattern = os.path.join(self.folder, "a_%d.png")
                    process = subprocess.Popen([SHEEN, "stream", FENDER, "--frames", "100000", "-o", pattern, *SMALL, *server,
                                                *form], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                               start_new_session=True)
                    while len(os.listdir(self.folder)) < 5:
                        self.assertIsNone(process.poll())
                        time.sleep(0.02)
                    os.killpg(process.pid, signal.SIGINT)
                    said, complaint = process.communicate(timeout=60)
                    self.assertEqual(process.returncode, -signal.SIGINT, complaint)
                    n = json.loads(said)["written"] if form else int(said.split(" ")[0])
                    self.assertIn("total_us" if form else "frames per second", said)
                    self.assertEqual(sorted(os.listdir(self.folder)), sorted(f"a_{i}.png" for i in range(n)))
                    self.assertTrue(5 <= n < 100000, n)
                    for name in os.listdir(self.folder):
                        os.remove(os.path.join(self.folder, name))

    def test_none_is_lost_or_written_twice(self):
        """The connection is interrupted again and again."""
        self.assertEqual(self.stream("%d.png", "--frames", "12").returncode, 0)
        whole = self.files()
        for name in whole:
            os.unlink(os.path.join(self.folder, name))
        with Between(self.daemon, cut_at(wire.RENDER, 3, range(6))) as between:
            done = self.stream("%d.png", "--frames", "12", "--json", server=between.unix)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertGreater(between.n_connections, 5)
        self.assertEqual(self.files(), whole)
        told = json.loads(done.stdout)
        self.assertEqual(told["written_bytes"], sum(map(len, whole.values())))
        self.assertEqual([frame["number"] for frame in told["frames"]], list(range(12)))

    def silhouettes(self, model, *arguments, n=8):
        """For each frame: left, top, right and bottom of its pixels that are not empty, and its size."""
        done = sheen("stream", model, "-o", os.path.join(self.folder, "s%d.png"), "--frames", str(n),
                     "--empty", "#ff00ff", "--size", "120x80", "--server", self.daemon.unix,
                     *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        for k in range(n):
            width, height, rows = read_png(os.path.join(self.folder, f"s{k}.png"))
            hits = [(i, y) for y, row in enumerate(rows) for i in range(width)
                    if bytes(row[3 * i:3 * i + 3]) != b"\xff\0\xff"]
            xs, ys = [x for x, _ in hits], [y for _, y in hits]
            yield min(xs), min(ys), max(xs), max(ys)

    def test_all_of_it_stays_in_the_picture(self):
        for name in ("body.obj", "fender.obj", "door.obj"):
            path = os.path.join(MODELS, name)
            if name == "door.obj":  # thin, far from the origin, and y is guessed to be up
                path = os.path.join(self.folder, name)
                with open(path, "w", encoding="ascii") as file:
                    file.write("v 50 7 0\nv 52 7 0\nv 52 7.1 2\nv 50 7 2\nf 1 2 3 4\n")
            for options in ((), ("--view", "top"), ("--view", "left"), ("--up", "-x"),
                            ("--target", "51,7,1" if name == "door.obj" else "1,0,0")):
                widths = set()
                for left, top, right, bottom in self.silhouettes(path, "--orbit", "45", *options):
                    with self.subTest(name=name, options=options):
                        self.assertGreater(min(left, top), 0)
                        self.assertLess(right, 119)
                        self.assertLess(bottom, 79)
                    widths.add(right - left)
                self.assertGreater(len(widths), 1, "it turns")

    def test_a_plan_turns_in_its_plane(self):
        """Turns about z, though up in the picture is y: after 90 degrees the model is as high as it was wide."""
        first, _, _, turned, *_ = self.silhouettes(BODY, "--view", "top", "--orbit", "30", n=4)
        wide, tall = first[2] - first[0], first[3] - first[1]
        self.assertGreater(wide, 2 * tall)
        self.assertLessEqual(abs(turned[3] - turned[1] - wide), 1)
        self.assertLessEqual(abs(turned[2] - turned[0] - tall), 1)

    def test_colours_of_one_range(self):
        """All frames have the range of the first one unless a range is given, so that a colour means one value."""
        ranges = []

        def judge(connection, kind, seq, body, client):
            if kind == wire.RENDER:
                show = wire.decode(body).get(13)
                if show:
                    ranges.append(wire.decode(show[0]).get(3))
            return FORWARD

        with Between(self.daemon, judge) as between:
            done = self.stream("%d.png", "--frames", "4", "--orbit", "40", "--show", "mean",
                               "--json", server=between.unix)
            self.assertEqual(done.returncode, 0, done.stderr)
            told = json.loads(done.stdout)
            self.assertEqual(told["show"], "mean")
            asked = [value and struct.unpack("<d", value[0])[0] for value in ranges]
            self.assertEqual(asked, [None] + 3 * [told["show_range"]])
            ranges.clear()
            done = self.stream("%d.png", "--frames", "2", "--show", "mean", "--show-range", "0.25",
                               "--json", server=between.unix)
            self.assertEqual(json.loads(done.stdout)["show_range"], 0.25)
            asked = [struct.unpack("<d", value[0])[0] for value in ranges]
            self.assertEqual(asked, [0.25, 0.25])
            done = self.stream("%d.png", "--frames", "2", "--show", "mean", "--show-range", "0.25")
            self.assertIn("colours of mean end at 0.25 either way, in all frames", done.stdout)
            self.assertNotIn("show", self.stream("%d.png", "--frames", "1", "--json").stdout)

    def assert_fails(self, done, words):
        self.assertEqual((done.returncode, done.stdout), (3, ""), done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn(words, done.stderr)

    def test_no_folder(self):
        """These errors are found before the client connects."""
        done = self.stream("nowhere/%d.png", "--frames", "2", "--json", server="unix:/no/such")
        self.assert_fails(done, "nowhere/0.png: cannot be written")

    def test_a_name_that_is_taken(self):
        os.mkdir(os.path.join(self.folder, "3.png"))
        done = self.stream("%d.png", "--frames", "9", "--json", "-q")
        self.assert_fails(done, "3.png: cannot be written")
        self.assertEqual(sorted(os.listdir(self.folder)), ["0.png", "1.png", "2.png", "3.png"])

    def test_a_full_disk(self):
        """No partial file, and no file with a temporary name."""
        done = self.stream("%d.tif", "--frames", "3", "--json", "-q", restore_signals=False,
                           preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (999, 999)))
        self.assert_fails(done, "0.tif: cannot be written: File too large")
        self.assertEqual(os.listdir(self.folder), [])

    def test_late_frames_have_no_file(self):
        def judge(connection, kind, seq, body, client):
            if kind == wire.RENDER and len(seen) == 3:  # the first frame tells the camera
                client.sendall(wire.message(wire.ERROR, seq, wire.field(1, wire.ERROR_DEADLINE) +
                                            wire.field(2, "too late")))
                seen.append(seq)
                return HOLD
            seen.extend([seq] * (kind == wire.RENDER))
            return FORWARD

        seen = []
        with Between(self.daemon, judge) as between:
            done = self.stream("%d.png", "--frames", "5", "--json", "--deadline", "3600000",
                               server=between.unix)
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads(done.stdout)
        self.assertEqual((told["written"], told["late"]), (4, 1))
        self.assertEqual(sorted(os.listdir(self.folder)), ["0.png", "1.png", "3.png", "4.png"])

"""sheen stream -o: every frame in a file of its own, whole, once."""
import json
import os
import resource
import tempfile
import unittest

import wire
from between import FORWARD, HOLD, Between, cut_at
from daemon import MODELS, SHEEN, DaemonCase
from test_client import sheen

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
        """In every format, and the first is what render draws."""
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
            self.assertEqual(sheen("render", FENDER, "-o", one, *SMALL, "--server",
                                   self.daemon.unix).returncode, 0)
            self.assertEqual(read(one), files["a_000." + ending])
            for name in os.listdir(self.folder):
                os.unlink(os.path.join(self.folder, name))
        done = self.stream("%d.png", "--frames", "2")
        self.assertIn("%d.png: 2 files, ", done.stdout)
        done = sheen("stream", FENDER, "--frames", "2", *SMALL, "--json", "--server",
                     self.daemon.unix)
        self.assertNotIn("written", done.stdout)

    def test_none_is_lost_or_written_twice(self):
        """The connection breaks again and again."""
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

    def assert_fails(self, done, words):
        self.assertEqual((done.returncode, done.stdout), (3, ""), done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn(words, done.stderr)

    def test_no_folder(self):
        """Known before anybody is connected to."""
        done = self.stream("nowhere/%d.png", "--frames", "2", "--json", server="unix:/no/such")
        self.assert_fails(done, "nowhere/0.png: cannot be written")

    def test_a_name_that_is_taken(self):
        os.mkdir(os.path.join(self.folder, "3.png"))
        done = self.stream("%d.png", "--frames", "9", "--json", "-q")
        self.assert_fails(done, "3.png: cannot be written")
        self.assertEqual(sorted(os.listdir(self.folder)), ["0.png", "1.png", "2.png", "3.png"])

    def test_a_full_disk(self):
        """No half a file, and none under a temporary name."""
        done = self.stream("%d.tif", "--frames", "3", "--json", "-q", restore_signals=False,
                           preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (999, 999)))
        self.assert_fails(done, "0.tif: cannot be written: File too large")
        self.assertEqual(os.listdir(self.folder), [])

    def test_late_frames_have_no_file(self):
        def judge(connection, kind, seq, body, client):
            if kind == wire.RENDER and len(seen) == 2:
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

"""Large models: one is drawn, one that does not fit is refused with the numbers, and the memory that is counted for
models is the memory that they take."""
import os
import re
import tempfile
import unittest

import mesa
import wire
from daemon import CUBE, DAEMON_MIB, SANITIZED, SHEEN, Daemon, DaemonCase, budget, grid, resident_kb, run
from test_client import sheen
from test_untrusted import image_pattern

LARGE = 200  # faces along an edge; 40,000 in all
MEMORY_BYTES, TABLE_BYTES = 23, 16  # field numbers of Stats and ModelInfo


class Large(DaemonCase):
    def test_renders(self):
        with wire.Client(self.daemon.unix) as client:
            frame = client.render(client.upload(grid(LARGE), "large.obj"), 320, 240)
        colours = {frame.data[i:i + 4] for i in range(0, len(frame.data), 4)}
        self.assertEqual(len(frame.data), 320 * 240 * 4)
        self.assertGreater(len(colours), 16, "a picture of nothing")


class Counted(unittest.TestCase):
    """The share of the memory budget that a model takes."""

    def counted(self, device):
        """Returns the bytes of the budget that a model takes, and the bytes of its tables."""
        daemon = Daemon("--device", device, tcp=False)
        with wire.Client(daemon.unix) as client:
            before = client.stats()[MEMORY_BYTES][0]
            model = client.upload(grid(LARGE), "large.obj")
            client.render(model)
            taken = client.stats()[MEMORY_BYTES][0] - before
            tables = client.query(model)[TABLE_BYTES][0]
        self.assertEqual(daemon.stop(), 0)
        return taken, tables

    def test_tables_on_demand(self):
        """Nodes with their bounds and curvatures (152 bytes each), and room for cached patches (256)."""
        taken, tables = self.counted("native")
        self.assertGreater(taken, LARGE * LARGE * (152 + 256))
        self.assertLess(taken, LARGE * LARGE * 600)
        self.assertAlmostEqual(tables, LARGE * LARGE * 152, delta=1000)

    @unittest.skipUnless(mesa.device(), "no Mesa here")
    def test_both_copies_of_stored_tables(self):
        """The tables on the GL device, and those in main memory from which they are uploaded."""
        taken, tables = self.counted(mesa.device())
        self.assertGreater(tables, 10 << 20)
        self.assertGreater(taken, 2 * tables)
        # In addition to the copies 88 bytes for each node: its bounds and curvatures.
        self.assertLess(taken, 2.4 * tables)


@unittest.skipUnless(os.path.exists(SHEEN), "no client in this build")
class Private(unittest.TestCase):
    """A private daemon has the budget that the command gives it, and its error tells a sufficient one."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="sheen-test-")
        self.addCleanup(folder.cleanup)
        self.model = os.path.join(folder.name, "large.obj")
        self.picture = os.path.join(folder.name, "a.png")
        with open(self.model, "wb") as file:
            file.write(grid(LARGE))

    def render(self, *arguments, size="320x240"):
        return sheen("render", self.model, "-o", self.picture, "--size", size, "--device",
                     "native", *arguments)

    def test_a_frame_over_its_limit(self):
        """A command cannot give its private daemon another --max-frame: the error says what can be done."""
        done = self.render("--quiet", size="20000x20000")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertRegex(done.stderr, "over a private daemon's --max-frame of 1073741824: ask for a smaller frame .*"
                                      "start sheend with a larger one and name it by --server")
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

    def test_what_it_asks_for_is_enough(self):
        done = self.render("--memory-budget", budget(6), size="64x48")
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertNotIn("sheend", done.stderr)
        asked = re.search(r"large.obj needs (\d+) bytes .* budget of 39845888: give more, as "
                          r"(--memory-budget) (\d+M)", done.stderr)
        self.assertIsNotNone(asked, done.stderr)
        self.assertGreater(int(asked.group(1)), 20 << 20)
        self.assertEqual(self.render(*asked.groups()[1:], size="64x48").returncode, 0)
        self.assertTrue(os.path.exists(self.picture))

    def test_a_file_and_a_frame_over_it(self):
        with open(self.model, "ab") as file:
            file.write(b"# " + b"x" * (4 << 20))
        done = self.render("--memory-budget", budget(4))
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("give it a larger --memory-budget", done.stderr)
        with open(self.model, "wb") as file:
            file.write(grid(10))
        done = self.render("--memory-budget", budget(4), size="2000x2000")
        self.assert_more_is_enough(done, "2000x2000")
        # The whole budget may be one client's, above the limit of a client of a shared daemon (--peer-memory).
        self.assertEqual(self.render("--memory-budget", "5G").returncode, 0)


    def assert_more_is_enough(self, done, size):
        """Expects one message, about the budget, with a value that is enough, because there are no other clients to
        wait for."""
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertRegex(done.stderr, r"^sheen: a frame needs \d+ bytes beside \d+ in use, and this "
                                      r"command's daemon has a memory budget of \d+: give more, as "
                                      r"--memory-budget \d+M, if the machine has it\n$")
        more = re.search(r"--memory-budget (\d+M)", done.stderr).group(1)
        self.assertEqual(self.render("--memory-budget", more, size=size).returncode, 0)

    def test_a_frame_that_just_does_not_fit(self):
        """Too little for the planes alone, for the planes and the file, and for these and the model's tables."""
        with open(self.model, "wb") as file:
            file.write(grid(10))
        done = self.render("--memory-budget", budget(4), size="1000x1000")
        frame = int(re.search(r"a frame needs (\d+) bytes", done.stderr).group(1))
        for more in (-1, 0, 100000):
            with self.subTest(more=more):
                self.assert_more_is_enough(self.render("--memory-budget", str((DAEMON_MIB << 20) + frame + more),
                                                       size="1000x1000"), "1000x1000")


class TooLarge(DaemonCase):
    """The budget has room for the file, but not for its tables: 40,000 faces take 23 MB."""
    arguments = ("--memory-budget", budget(6))

    def test_is_refused_by_need_and_budget(self):
        with wire.Client(self.daemon.unix) as client:
            with self.assertRaises(wire.Refused) as caught:
                client.render(client.upload(grid(LARGE), "large.obj"))
        text = caught.exception.text
        self.assertNotIn("\n", text)
        self.assertIn("--memory-budget", text)
        self.assertNotIn("--device", text)
        found = re.search(r"needs (?:at least )?(\d+) bytes.* budget has (\d+)", text)
        self.assertIsNotNone(found, text)
        self.assertGreater(int(found.group(1)), int(found.group(2)))
        self.assertEqual(int(found.group(2)), 6 << 20)

    @unittest.skipUnless(mesa.device(), "no Mesa here")
    def test_stored_tables_name_the_device_that_needs_less(self):
        """There drivers take a part of the budget, so that sheend starts with no less than it says."""
        device = ("--device", mesa.device(), "--listen", self.daemon.unix + "2", "--memory-budget")
        done = run(*device, "36M")
        self.assertEqual(done.returncode, 2, done.stderr)
        least = int(re.search(r"memory-budget is 37748736; on this device it must be at least (\d+), of which "
                              r"the daemon and its drivers take \d+\n$", done.stderr).group(1))
        daemon = Daemon("--device", mesa.device(), "--memory-budget", str(least + (31 << 19)), tcp=False)
        with wire.Client(daemon.unix) as client:
            with self.assertRaisesRegex(wire.Refused, "--memory-budget.*; with --device native"):
                client.render(client.upload(grid(LARGE), "large.obj"))
        self.assertEqual(daemon.stop(), 0)

    def test_its_operator_is_to_be_asked(self):
        """A client of a shared daemon cannot restart it with more memory."""
        path = os.path.join(self.daemon.folder, "large.obj")
        with open(path, "wb") as file:
            file.write(grid(LARGE))
        done = sheen("info", path, "--server", self.daemon.unix)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("ask its operator for more (sheend --memory-budget)", done.stderr)
        done = sheen("info", path, "--server", self.daemon.unix, "--memory-budget", "1G")
        self.assertEqual(done.returncode, 2, done.stderr)

    def test_a_model_that_fits_renders_afterwards(self):
        with wire.Client(self.daemon.unix) as client:
            with self.assertRaises(wire.Refused):
                client.render(client.upload(grid(LARGE), "large.obj"))
            frame = client.render(client.upload(grid(10), "small.obj"))
            self.assertEqual(len(frame.data), 64 * 48 * 4)


class Resident(unittest.TestCase):
    """The memory that STATS counts, compared with the growth of the process. A model counts with all memory that it
    may take later: a single view fills only a part of the room for patches."""

    def grown(self, make, n):
        """How many bytes n models made by make(client, number) add to the daemon: to the process, and to the
        count."""
        daemon = Daemon(tcp=False)
        with wire.Client(daemon.unix, minor=1, timeout=60) as client:
            client.render(client.upload(grid(3), "first.obj"))
            make(client, n)  # memory that only the first models of a kind take
            taken, counted = resident_kb(daemon.process.pid), client.stats()[MEMORY_BYTES][0]
            for i in range(n):
                make(client, i)
            taken = 1024 * (resident_kb(daemon.process.pid) - taken)
            counted = client.stats()[MEMORY_BYTES][0] - counted
        self.assertEqual(daemon.stop(), 0)
        return taken, counted

    def assert_counted(self, make, n, least=0.85):
        """Expects that the process grows by no more than is counted, and at least by this share of it."""
        taken, counted = self.grown(make, n)
        self.assertLess(taken, 1.15 * counted + (2 << 20), (taken, counted))
        if not SANITIZED:
            self.assertGreater(taken, least * counted - (2 << 20), (taken, counted))

    def test_small_models(self):
        self.assert_counted(
            lambda client, i: client.render(client.upload(CUBE + b"# %d\n" % i, "cube.obj")), 200, 0.4)

    def test_tiny_models(self):
        """Models without surface take memory for objects and none for tables."""
        hole = grid(1) + b"t interpolateboundary 1/0/0 0\n"
        self.assert_counted(
            lambda client, i: client.query(client.upload(hole + b"# %d\n" % i, "none.obj")), 1000, 0.4)

    def test_large_models(self):
        self.assert_counted(
            lambda client, i: client.render(client.upload(grid(LARGE) + b"# %d\n" % i, "large.obj"), 640, 480),
            3, 0.4)

    def test_images(self):
        def use(client, i):
            size = b"P6\n1000 1000\n255\n" + bytes([i]) * (3 * 1000 * 1000)
            client.render(client.upload(CUBE, "cube.obj"),
                          extra=image_pattern(client.upload(size, "light.ppm", wire.IMAGE)))

        self.assert_counted(use, 8)

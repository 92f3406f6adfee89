"""Models of a size: a large one renders, one that does not fit is refused with the numbers, and what is
counted for them is what they take."""
import re
import unittest

import wire
from daemon import CUBE, SANITIZED, Daemon, DaemonCase, grid, resident_kb
from test_untrusted import image_pattern

LARGE = 200  # faces along an edge: 40,000
MEMORY_BYTES, TABLE_BYTES = 23, 16  # fields of Stats and ModelInfo


class Large(DaemonCase):
    def test_renders(self):
        with wire.Client(self.daemon.unix) as client:
            frame = client.render(client.upload(grid(LARGE), "large.obj"), 320, 240)
        colours = {frame.data[i:i + 4] for i in range(0, len(frame.data), 4)}
        self.assertEqual(len(frame.data), 320 * 240 * 4)
        self.assertGreater(len(colours), 16, "a picture of nothing")


class Counted(DaemonCase):
    """What a model takes of the budget: its tables on the device and those that it is drawn by."""

    def test_both_copies_count(self):
        with wire.Client(self.daemon.unix) as client:
            before = client.stats()[MEMORY_BYTES][0]
            model = client.upload(grid(LARGE), "large.obj")
            client.render(model)
            taken = client.stats()[MEMORY_BYTES][0] - before
            tables = client.query(model)[TABLE_BYTES][0]
        self.assertGreater(tables, 10 << 20)
        self.assertGreater(taken, 2 * tables)
        self.assertLess(taken, 2.3 * tables)


class TooLarge(DaemonCase):
    """The file fits into the budget, its tables do not: 40,000 faces take more than 20 MB."""
    arguments = ("--memory-budget", "6M")

    def test_is_refused_by_need_and_budget(self):
        with wire.Client(self.daemon.unix) as client:
            with self.assertRaises(wire.Refused) as caught:
                client.render(client.upload(grid(LARGE), "large.obj"), 320, 240)
        text = caught.exception.text
        self.assertNotIn("\n", text)
        self.assertIn("--memory-budget", text)
        found = re.search(r"needs (\d+) bytes.* budget (?:is|of) (\d+)", text)
        self.assertIsNotNone(found, text)
        self.assertGreater(int(found.group(1)), int(found.group(2)))
        self.assertEqual(int(found.group(2)), 6 << 20)

    def test_a_model_that_fits_renders_afterwards(self):
        with wire.Client(self.daemon.unix) as client:
            with self.assertRaises(wire.Refused):
                client.render(client.upload(grid(LARGE), "large.obj"), 320, 240)
            frame = client.render(client.upload(grid(10), "small.obj"))
            self.assertEqual(len(frame.data), 64 * 48 * 4)


class Resident(unittest.TestCase):
    """Memory of the budget in use (STATS) beside what the process has more: on a software device tables
    lie in main memory twice."""

    def grown(self, make, n):
        """By how many bytes n models made by make(client, number) grow the daemon: taken, counted."""
        daemon = Daemon(tcp=False)
        with wire.Client(daemon.unix, minor=1, timeout=60) as client:
            client.render(client.upload(grid(3), "first.obj"))
            make(client, n)  # what comes with the first of its kind
            taken, counted = resident_kb(daemon.process.pid), client.stats()[MEMORY_BYTES][0]
            for i in range(n):
                make(client, i)
            taken = 1024 * (resident_kb(daemon.process.pid) - taken)
            counted = client.stats()[MEMORY_BYTES][0] - counted
        self.assertEqual(daemon.stop(), 0)
        return taken, counted

    def assert_counted(self, make, n):
        taken, counted = self.grown(make, n)
        self.assertLess(taken, 1.15 * counted + (2 << 20), (taken, counted))
        if not SANITIZED:
            self.assertGreater(taken, 0.85 * counted - (2 << 20), (taken, counted))

    def test_small_models(self):
        self.assert_counted(
            lambda client, i: client.query(client.upload(CUBE + b"# %d\n" % i, "cube.obj")), 200)

    def test_tiny_models(self):
        """Without surface: what they take is objects, not tables."""
        hole = grid(1) + b"t interpolateboundary 1/0/0 0\n"
        self.assert_counted(
            lambda client, i: client.query(client.upload(hole + b"# %d\n" % i, "none.obj")), 1000)

    def test_large_models(self):
        self.assert_counted(
            lambda client, i: client.query(client.upload(grid(LARGE) + b"# %d\n" % i, "large.obj")), 3)

    def test_images(self):
        def use(client, i):
            size = b"P6\n1000 1000\n255\n" + bytes([i]) * (3 * 1000 * 1000)
            client.render(client.upload(CUBE, "cube.obj"),
                          extra=image_pattern(client.upload(size, "light.ppm", wire.IMAGE)))

        self.assert_counted(use, 8)

"""Models of a size: a large one renders, and one that does not fit is refused with the numbers."""
import re

import wire
from daemon import DaemonCase, grid

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
    """The file fits into the budget, its tables do not: 40,000 faces take more than 10 MB."""
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

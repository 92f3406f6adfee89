"""Planes that were evaluated for a view are used by every class."""
import os

import wire
from daemon import MODELS, Daemon, DaemonCase
from wire import BATCH, INTERACTIVE, STILL, Client, field

SIZE = (400, 300)  # two tiles of a still on a software device
RELIT = field(6, field(1, 1))  # highlight lines


class Planes(DaemonCase):
    def setUp(self):
        with open(os.path.join(MODELS, "fender.obj"), "rb") as file:
            self.fender = file.read()

    def test_every_class(self):
        """Whichever class drew a view first, the next frame of it runs neither stage one nor stage two, and equals
        that of a new daemon."""
        fresh = {}
        for kind in (STILL, INTERACTIVE, BATCH):
            daemon = Daemon()
            with Client(daemon.unix, minor=1) as client:
                model = client.upload(self.fender, "fender.obj")
                frame = client.render(model, *SIZE, kind=kind, extra=RELIT)
                self.assertGreater(min(frame.visibility_us, frame.evaluate_us), 0)
                fresh[kind] = frame.data
            self.assertEqual(daemon.stop(), 0)
        with Client(self.daemon.unix, minor=1) as client:
            for n, first in enumerate((INTERACTIVE, STILL, BATCH)):
                # Another model each time, so that no planes are kept.
                model = client.upload(self.fender + b"# %d\n" % n, "fender.obj")
                frame = client.render(model, *SIZE, kind=first)
                self.assertGreater(min(frame.visibility_us, frame.evaluate_us), 0)
                for kind in (STILL, BATCH, INTERACTIVE, STILL):
                    with self.subTest(first=first, kind=kind):
                        frame = client.render(model, *SIZE, kind=kind, extra=RELIT)
                        self.assertEqual((frame.visibility_us, frame.evaluate_us), (0, 0))
                        self.assertEqual(frame.data, fresh[kind])
                        client.render(model, 64, 48, kind=kind)  # a thumbnail
        self.assertEqual(len(set(fresh.values())), 1)

    def test_larger_frames(self):
        """Planes of frames with more than 32 tiles are not kept, and do not remove those of other frames."""
        with Client(self.daemon.unix, minor=1) as client:
            model = client.upload(self.fender, "fender.obj")
            client.render(model, *SIZE, kind=STILL)
            for _ in range(2):
                frame = client.render(model, 2100, 1000, kind=STILL)
                self.assertGreater(min(frame.visibility_us, frame.evaluate_us), 0)
            frame = client.render(model, *SIZE, kind=STILL)
            self.assertEqual((frame.visibility_us, frame.evaluate_us), (0, 0))

    def test_without_antialiasing(self):
        """Planes of a frame with one sample of the surface are not used by frames with antialiasing, but the reverse.
        The coverage plane is refused."""
        aliased, one_sample = field(17, 1), field(12, 1)
        with Client(self.daemon.unix, minor=4) as client:
            # A model of which no planes are kept.
            model = client.upload(self.fender + b"# aliased\n", "fender.obj")
            frames = {}
            for name, extra, is_kept in (("aliased", aliased, False), ("exact", b"", False),
                                         ("aliased", aliased, True), ("exact", b"", True),
                                         ("one sample", one_sample, True),
                                         ("one sample", one_sample + aliased, True)):
                with self.subTest(name=name, is_kept=is_kept):
                    frame = client.render(model, *SIZE, extra=extra + RELIT)
                    self.assertEqual(frame.evaluate_us == 0, is_kept)
                    self.assertEqual(frame.data, frames.setdefault(name, frame.data))
            self.assertEqual(len(set(frames.values())), 3)
            for extra in (aliased, one_sample):
                with self.assertRaises(wire.Refused) as caught:
                    client.render(model, *SIZE, planes=128, extra=extra)
                self.assertEqual(caught.exception.code, wire.ERROR_REQUEST)
                self.assertIn("coverage", caught.exception.text)

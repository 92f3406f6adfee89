"""Memory of frames: after a few frames of a kind, a further one takes no block from the heap, and kept memory is
freed in the end. build/sheend-faults counts the blocks that sheend's own code takes (allocations.c)."""
import math
import mmap
import os
import re
import struct
import tempfile
import time
import unittest

import wire
from daemon import BUILD, MODELS, Daemon, resident_kb

P, N, PTEX, LIGHT = 2, 4, 8, 16
COLOUR = 1
MIB = 1 << 20


class CountingDaemon(Daemon):
    program = os.path.join(BUILD, "sheend-faults")

    def __init__(self, *arguments):
        with tempfile.NamedTemporaryFile() as file:
            file.write(bytes(8))
            file.flush()
            self.count = mmap.mmap(file.fileno(), 8)
            super().__init__(*arguments, env={"SHEEN_ALLOCATIONS": file.name})

    def allocations(self):
        return struct.unpack("<Q", self.count[:8])[0]


def vector(*values):
    return b"".join(wire.field(i + 1, float(value)) for i, value in enumerate(values))


def camera_at(angle):
    """Another camera for each frame: no planes are kept, and the surface's pieces are chosen and drawn again."""
    return wire.field(4, wire.field(1, vector(25 * math.cos(angle), 25 * math.sin(angle), 12)) +
                      wire.field(2, vector(0, 0, 0)) + wire.field(3, vector(0, 0, 1)))


def light_at(x):
    """Another light for each frame: the camera stays, so that planes are kept."""
    light = (wire.field(1, vector(x, 0, 20)) + wire.field(2, vector(40, 0, 0)) +
             wire.field(3, vector(0, 40, 0)))
    return wire.field(5, light)


def clear():
    """Transparent where no surface is: some strips of a PNG file are opaque and are encoded again."""
    return wire.field(8, b"".join(wire.varint(i << 3 | 5) + struct.pack("<f", 0)
                                  for i in range(1, 5)))


def most_resident_kb(pid):
    """The largest resident memory so far; 0 where the system does not tell it, or a sanitizer keeps freed memory."""
    with open(f"/proc/{pid}/status", encoding="ascii") as file:
        found = re.search(r"VmHWM:\s+(\d+) kB", file.read())
    return int(found.group(1)) if found and resident_kb(pid) else 0


class WarmFrames(unittest.TestCase):
    def serve(self, *arguments):
        """A daemon with the model, and a client that did not upload it. The buffer that an upload's messages used is
        made smaller when its client has waited for a second, which may fall into the measured frames."""
        server = CountingDaemon(*arguments)
        self.addCleanup(server.stop)
        client = wire.Client(server.unix, minor=1)
        self.addCleanup(client.socket.close)
        with wire.Client(server.unix) as uploader, \
                open(os.path.join(MODELS, "fender.obj"), "rb") as file:
            model = uploader.upload(file.read(), "fender.obj")
            client.query(model)
        return server, client, model

    def least_allocations(self, count):
        """The least count of a few runs. On a busy machine frames may be so far apart that kept memory is freed
        between two of them; blocks that each frame takes are counted in every run."""
        counts = []
        while 0 not in counts and len(counts) < 8:
            counts.append(count())
        return min(counts)

    def warm_allocations(self, server, client, frames):
        """The blocks that the second half of these frames takes. An entry has the arguments of one frame."""
        def count():
            for i, (model, named) in enumerate(frames):
                if i == len(frames) // 2:
                    before = server.allocations()
                client.render(model, **named)
            return server.allocations() - before
        return self.least_allocations(count)

    def test_a_warm_frame_takes_nothing_from_the_heap(self):
        server, client, model = self.serve()
        self.assertGreater(server.allocations(), 0)
        planes = COLOUR | P | N | PTEX | LIGHT
        kinds = {
            "raw": {"encoding": wire.RAW},
            "zstd": {"encoding": wire.ZSTD},
            "float planes": {"encoding": wire.ZSTD, "planes": planes},
            "raw float planes": {"encoding": wire.RAW, "planes": planes},
            "in tiles": {"encoding": wire.ZSTD, "width": 640, "height": 480, "kind": wire.STILL},
            "batch": {"encoding": wire.RAW, "kind": wire.BATCH},
            "PNG": {"encoding": wire.PNG, "width": 640, "height": 480},
            "PNG with alpha": {"encoding": wire.PNG, "width": 640, "height": 480, "extra": clear()},
            "JPEG": {"encoding": wire.JPEG},
            "false colour": {"encoding": wire.RAW, "width": 320, "height": 240,  # with a legend
                             "extra": wire.field(13, wire.field(1, 1))},
        }
        for name, named in kinds.items():
            frames = [(model, {"kind": wire.INTERACTIVE, **named})] * 20
            self.assertEqual(self.warm_allocations(server, client, frames), 0, name)
        polygons = wire.field(40, 1) + wire.field(41, 2)
        sliced = wire.field(40, 2) + wire.field(41, 4)  # 98,304 triangles: several steps a frame
        changes = {
            "light": light_at,
            "view": camera_at,
            "view, polygons": lambda x: camera_at(x) + polygons,
            "view, edges in slices": lambda x: camera_at(x) + sliced,
        }
        for name, extra in changes.items():
            for encoding, planes in ((wire.ZSTD, COLOUR), (wire.JPEG, COLOUR), (wire.PNG, COLOUR),
                                     (wire.ZSTD, COLOUR | P | N | PTEX | LIGHT)):
                frames = [(model, {"kind": wire.INTERACTIVE, "encoding": encoding,
                                   "planes": planes, "extra": extra(0.1 * i)}) for i in range(20)]
                self.assertEqual(self.warm_allocations(server, client, frames), 0,
                                 (name, encoding))

    def two_in_flight(self, server, client, model, encoding):
        """The blocks that are taken in the middle of 40 frames of a turning camera, while one frame is drawn and the
        previous one is encoded and sent."""
        ends, asked = [], []
        for i in range(40):
            asked.append(client.ask(model, 320, 240, encoding, extra=camera_at(0.1 * i),
                                    kind=wire.INTERACTIVE, view=i % 2))
            if i > 0:
                client.read_frame(asked[i - 1])
            ends.append(server.allocations())
        client.read_frame(asked[-1])
        return ends[-1] - ends[19]

    def test_nor_do_two_in_flight(self):
        server, client, model = self.serve()
        for encoding in wire.RAW, wire.ZSTD, wire.JPEG, wire.PNG:
            # The number of frames in progress at a time also depends on the clock.
            count = lambda: self.two_in_flight(server, client, model, encoding)
            self.assertEqual(self.least_allocations(count), 0, encoding)

    def test_without_spare_memory_each_takes_its_own(self):
        server, client, model = self.serve("--spare-memory", "0")
        frames = [(model, {"encoding": wire.ZSTD})] * 8
        self.assertGreater(self.warm_allocations(server, client, frames), 4)

    def test_what_is_not_used_goes_back(self):
        server, client, model = self.serve()
        client.render(model, width=3840, height=2160, planes=COLOUR | P | N)
        client.socket.close()
        most = most_resident_kb(server.process.pid)  # some memory may have been freed by now
        end = time.monotonic() + 40
        while resident_kb(server.process.pid) * 1024 > most * 1024 - 64 * MIB:
            if most == 0:
                break  # a sanitizer keeps freed memory
            self.assertLess(time.monotonic(), end, "spares were kept for 40 s")
            time.sleep(0.5)

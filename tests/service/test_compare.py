"""COMPARE through real sockets. What is computed is judged by tests/oracle/test_comparison.cpp; here that the request
reaches it whole, and the order of service."""
import math
import re
import struct
import time
import unittest

import wire
from daemon import CUBE, DaemonCase, grid
from wire import Client, field, message

# Fields of Compared, ComparedSide and ComparedMeasure.
OLD, NEW, REWOUND, DIAGONAL, DISTANCE_LIMIT, ALIGNMENT = 1, 2, 3, 4, 7, 12
SAMPLES, AREA, UNCOVERED, UNCOVERED_AT, DISTANCE, NORMAL, LINES, CURVATURE = 1, 2, 3, 6, 7, 8, 9, 11
WORST, AREA_OUT = 1, 7


def compare(seq, old, new, extra=b"", deadline=None):
    scene = wire.render(1, old, 1280, 720, encoding=wire.PNG, deadline=deadline)[16:]
    return message(wire.COMPARE, seq, field(1, scene) + field(2, new) + extra)


def moved(obj, index, by):
    """The vertex of an OBJ moved in z."""
    lines = obj.decode().split("\n")
    at = [i for i, line in enumerate(lines) if line.startswith("v ")][index]
    x, y, z = map(float, lines[at].split()[1:])
    lines[at] = f"v {x} {y} {z + by}"
    return "\n".join(lines).encode()


def pole(n, height):
    """n quads around one vertex, which has this height."""
    lines = [f"v 0 0 {height}"]
    lines += [f"v {r * math.cos(k * math.pi / n)} {r * math.sin(k * math.pi / n)} 0"
              for k in range(2 * n) for r in (1.3 if k % 2 else 1,)]
    lines += [f"f 1 {2 + 2 * k} {3 + 2 * k} {2 + (2 * k + 2) % (2 * n)}" for k in range(n)]
    return ("\n".join(lines) + "\n").encode()


class Comparisons(DaemonCase):
    def client(self):
        client = Client(self.daemon.unix, minor=5)
        self.addCleanup(client.socket.close)
        return client

    def compared(self, client, old, new, extra=field(9, 20000)):
        seq = client.next_seq()
        client.send(compare(seq, old, new, extra))
        return client.expect(wire.COMPARED, seq)

    def side(self, answer, number):
        return wire.decode(answer[number][0])

    def measure(self, answer, number, measure):
        return wire.decode(self.side(answer, number)[measure][0])

    def number(self, fields, number):
        return struct.unpack("<d", fields[number][0])[0]

    def test_the_same_model(self):
        client = self.client()
        cube = client.upload(CUBE, "cube.obj")
        answer = self.compared(client, cube, cube)
        for number in (OLD, NEW):
            side = self.side(answer, number)
            self.assertGreater(side[SAMPLES][0], 5000)
            self.assertEqual(self.number(side, UNCOVERED), 0)
            self.assertNotIn(UNCOVERED_AT, side)
            self.assertNotIn(CURVATURE, side)  # nobody asked
            for measure in (DISTANCE, NORMAL, LINES):
                self.assertEqual(self.number(self.measure(answer, number, measure), WORST), 0)
        self.assertEqual(answer[REWOUND][0], 0)
        self.assertNotIn(ALIGNMENT, answer)

    def test_a_moved_vertex(self):
        """A regular vertex takes the surface with it by 4/9 of its way."""
        client = self.client()
        flat = re.sub(rb"(v \S+ \S+) \S+", rb"\1 0", grid(6))
        old = client.upload(flat, "old.obj")
        new = client.upload(moved(flat, 24, 0.001), "new.obj")
        answer = self.compared(client, old, new, field(3, 1e-5) + field(7, 0.1) + field(9, 20000))
        for number in (OLD, NEW):
            measure = self.measure(answer, number, DISTANCE)
            self.assertAlmostEqual(self.number(measure, WORST), 0.001 * 4 / 9, delta=1e-6)
            self.assertGreater(self.number(measure, AREA_OUT), 0)
            self.assertIn(CURVATURE, self.side(answer, number))
        self.assertEqual(self.number(answer, DISTANCE_LIMIT), 1e-5)

    def test_alignment(self):
        client = self.client()
        old = client.upload(CUBE, "old.obj")
        new = client.upload(CUBE.replace(b"v 1", b"v 1.0"), "new.obj")  # the same numbers
        answer = self.compared(client, old, new, field(8, 1) + field(9, 20000))
        rotation = self.number(wire.decode(answer[ALIGNMENT][0]), 5)
        self.assertLess(rotation, 1e-6)

    def test_numbers_out_of_range(self):
        client = self.client()
        cube = client.upload(CUBE, "cube.obj")
        for extra in (field(3, 0.0), field(4, 181.0), field(5, -1.0), field(6, float("nan")), field(7, 3.0),
                      field(9, 10)):
            with self.assertRaises(wire.Refused) as caught:
                self.compared(client, cube, cube, extra)
            self.assertEqual(caught.exception.code, wire.ERROR_REQUEST)

    def test_a_model_of_no_usual_size(self):
        """A camera or a light chosen by the model cannot have its size: that is refused, and the session goes on."""
        client = self.client()
        cube = client.upload(CUBE, "cube.obj")
        for size, what in ((b"9e29", "camera"), (b"1e29", "light"), (b"1e-20", "light")):
            other = client.upload(re.sub(rb"(?m)^v.*$", lambda line: line[0].replace(b"1", size), CUBE), "other.obj")
            with self.assertRaises(wire.Refused) as caught:
                self.compared(client, other, cube)
            self.assertEqual(caught.exception.code, wire.ERROR_REQUEST)
            self.assertIn(f"units, for which no {what} can be chosen", caught.exception.text)
        answer = self.compared(client, cube, cube)
        self.assertEqual(self.number(self.measure(answer, OLD, DISTANCE), WORST), 0)

    def test_an_unknown_second_model(self):
        client = self.client()
        cube = client.upload(CUBE, "cube.obj")
        with self.assertRaises(wire.Refused) as caught:
            self.compared(client, cube, bytes(32))
        self.assertEqual(caught.exception.code, wire.ERROR_UNKNOWN_MODEL)

    def test_cancelled(self):
        client = self.client()
        sheet = client.upload(grid(40), "sheet.obj")
        seq = client.next_seq()
        client.send(compare(seq, sheet, sheet, field(9, 100000000)))
        client.send(message(wire.CANCEL, seq))
        with self.assertRaises(wire.Refused) as caught:
            client.receive()
        self.assertIn(caught.exception.code, (wire.ERROR_CANCELLED, wire.ERROR_REQUEST))
        answer = self.compared(client, sheet, sheet)  # the daemon goes on
        self.assertEqual(self.number(self.measure(answer, OLD, DISTANCE), WORST), 0)

    def test_a_pole_keeps_nobody_waiting(self):
        """Every sample looks for its counterpart among 300 faces that meet in one vertex, and the line along its normal
        misses. Meanwhile another client gets its picture, and the comparison can be cancelled."""
        client, other = self.client(), self.client()
        old, new = (client.upload(pole(300, height), f"{height}.obj") for height in (0, 0.1))
        cube = other.upload(CUBE, "cube.obj")
        seq = client.next_seq()
        client.send(compare(seq, old, new, field(9, 2000000)))
        self.wait_for_stage(client, seq, "samples")
        frame = other.render(cube, 64, 48, encoding=wire.PNG)
        self.assertEqual(frame.data[:8], b"\x89PNG\r\n\x1a\n")
        self.wait_for_stage(client, seq, "samples")  # it has not ended
        start = time.monotonic()
        client.send(message(wire.CANCEL, seq))
        with self.assertRaises(wire.Refused) as caught:
            client.receive()
        self.assertEqual((caught.exception.seq, caught.exception.code), (seq, wire.ERROR_CANCELLED))
        answer = self.compared(client, cube, cube, field(9, 1000))  # no thread of the pool is still at it
        self.assertEqual(self.number(self.measure(answer, OLD, DISTANCE), WORST), 0)
        self.assertLess(time.monotonic() - start, 20 * wire.PATIENCE)

    def wait_for_stage(self, client, seq, stage):
        name = ""
        while name != stage:
            _, kind, _, length, got = struct.unpack("<BBHII", client.read(16)[4:])
            fields = wire.decode(client.read(length))
            self.assertEqual((kind, got), (wire.PROGRESS, seq))
            name = fields[1][0].decode()


if __name__ == "__main__":
    unittest.main()

"""Computations: FIND_BREAKS through real sockets. What is computed is judged by tests/unit/test_curves_breaks.c; here
the order of service: cancelling, deadlines, progress, limits, and frames in between."""
import math
import struct
import unittest

import wire
from daemon import CUBE, Daemon, DaemonCase, budget, grid
from wire import Client, field, message

EDGE_BYTES, VERTEX_BYTES = 280, 56
CANCELLED, LATE, IN_REQUEST = wire.ERROR_CANCELLED, wire.ERROR_DEADLINE, wire.ERROR_REQUEST


def creased(n):
    """A sheet of n by n faces, whose inner edges are all infinitely sharp."""
    side = n + 1
    lines = [f"t crease 2/1/0 {y * side + x} {y * side + x + 1} 10"
             for y in range(1, n) for x in range(n)]
    lines += [f"t crease 2/1/0 {y * side + x} {(y + 1) * side + x} 10"
              for x in range(1, n) for y in range(n)]
    return grid(n) + ("\n".join(lines) + "\n").encode()


# All edges of one face of the cube are creases.
CREASED_CUBE = CUBE + b"t crease 2/1/0 0 1 10\nt crease 2/1/0 1 2 10\nt crease 2/1/0 2 3 10\nt crease 2/1/0 3 0 10\n"


def ring(n):
    """A torus of n by n faces."""
    turns = [2 * math.pi * i / n for i in range(n)]
    lines = [f"v {(3 + math.cos(b)) * math.cos(a)} {(3 + math.cos(b)) * math.sin(a)} {math.sin(b)}"
             for a in turns for b in turns]
    for i in range(n):
        for k in range(n):
            corners = (i, k), (i + 1, k), (i + 1, k + 1), (i, k + 1)
            lines.append("f " + " ".join(str(x % n * n + y % n + 1) for x, y in corners))
    return ("\n".join(lines) + "\n").encode()


RING = ring(6)


def scene(model, deadline=None):
    return wire.render(1, model, 1280, 720, encoding=wire.PNG, deadline=deadline)[16:]


def find_breaks(seq, model, deadline=None, limits=b""):
    return message(wire.FIND_BREAKS, seq, field(1, scene(model, deadline)) + limits)


class Breaks:
    """An answer."""

    def __init__(self, fields, data):
        self.fields = fields
        self.n_edges, self.n_vertices, self.n_out = (fields[i][0] for i in (2, 3, 4))
        assert fields[1][0] == len(data) == self.n_edges * EDGE_BYTES + self.n_vertices * VERTEX_BYTES
        self.edges = [struct.unpack("<II7Bx33d", data[i * EDGE_BYTES:(i + 1) * EDGE_BYTES])
                      for i in range(self.n_edges)]


class Computations(DaemonCase):
    def client(self, **named):
        client = Client(self.daemon.unix, minor=5, **named)
        self.addCleanup(client.socket.close)
        return client

    def ask(self, client, model, **named):
        seq = client.next_seq()
        client.send(find_breaks(seq, model, **named))
        return seq

    def read(self, client, seq):
        fields, data, end = client.expect(wire.BREAKS, seq), bytearray(), False
        while fields[1][0] and not end:
            kind, flags, got, body = client.receive()
            self.assertEqual((kind, got), (wire.DATA, seq))
            data += body
            end = flags & 1
        return Breaks(fields, bytes(data))

    def refused(self, client):
        with self.assertRaises(wire.Refused) as caught:
            client.receive()
        return caught.exception

    def wait_for_progress(self, client, seq, stage):
        """Waits until a PROGRESS of this stage comes, and returns its fields."""
        for _ in range(1000):
            _, kind, _, length, got = struct.unpack("<BBHII", client.read(16)[4:])
            fields = wire.decode(client.read(length))
            self.assertEqual((kind, got), (wire.PROGRESS, seq))
            if fields[1][0].decode() == stage:
                return fields
        raise AssertionError(f"no progress of {stage}")

    def test_a_cube(self):
        client = self.client()
        model = client.upload(CREASED_CUBE, "cube.obj")
        breaks = self.read(client, self.ask(client, model))
        self.assertEqual(breaks.n_edges, 4)
        self.assertEqual(breaks.n_out, 4)
        self.assertEqual(breaks.fields[8][0], 4)  # creases
        self.assertEqual(breaks.fields[11][0], 0)  # borders

    def test_limits_of_the_request_decide(self):
        client = self.client()
        model = client.upload(CREASED_CUBE, "cube.obj")
        loose = field(2, 1e3) + field(3, 179.0) + field(4, 200.0)
        breaks = self.read(client, self.ask(client, model, limits=loose))
        self.assertEqual((breaks.n_edges, breaks.n_out), (4, 0))
        for number, value in ((2, 0.0), (2, -1.0), (3, 0.0), (3, 181.0), (4, 201.0), (4, float("nan"))):
            self.ask(client, model, limits=field(number, value))
            self.assertEqual(self.refused(client).code, IN_REQUEST, (number, value))

    def test_a_model_without_records(self):
        """A ring of quads that is closed both ways has no crease and no extraordinary vertex: no DATA follows."""
        client = self.client()
        model = client.upload(RING, "ring.obj")
        breaks = self.read(client, self.ask(client, model))
        self.assertEqual((breaks.n_edges, breaks.n_vertices, breaks.n_out), (0, 0, 0))

    def test_borders_are_counted(self):
        client = self.client()
        model = client.upload(grid(3), "sheet.obj")
        breaks = self.read(client, self.ask(client, model))
        self.assertEqual((breaks.n_edges, breaks.fields[11][0]), (0, 12))
        self.assertEqual(breaks.n_vertices, 4)  # the corners, which are round

    def test_unknown_model(self):
        client = self.client()
        self.ask(client, bytes(32))
        self.assertEqual(self.refused(client).code, wire.ERROR_UNKNOWN_MODEL)

    def test_older_peers_may_not_ask(self):
        with Client(self.daemon.unix, minor=4) as client:
            model = client.upload(CUBE, "cube.obj")
            self.ask(client, model)
            refused = self.refused(client)
            self.assertEqual(refused.code, wire.ERROR_PROTOCOL)
            self.assertIn("FIND_BREAKS: a message of minor version 5", refused.text)
            self.assertTrue(client.at_end())

    def test_same_bytes_again(self):
        """The order in which threads end slices has no influence."""
        client = self.client()
        model = client.upload(creased(12), "creased.obj")
        first, second = (self.read(client, self.ask(client, model)) for _ in range(2))
        self.assertEqual(first.n_edges, 2 * 12 * 11)
        self.assertEqual(first.edges, second.edges)
        self.assertEqual({edge[:3] for edge in first.edges}, {edge[:3] for edge in second.edges})

    def large(self, client):
        """A model whose breaks take many seconds. Its tables are ready."""
        model = client.upload(creased(150), "large.obj")
        client.query(model)
        return model

    def test_cancelled_while_it_computes(self):
        client = self.client()
        model = self.large(client)
        seq = self.ask(client, model)
        progress = self.wait_for_progress(client, seq, "edges")
        self.assertLess(progress[2][0], progress[3][0])
        client.send(message(wire.CANCEL, seq))
        refused = self.refused(client)
        self.assertEqual((refused.seq, refused.code), (seq, CANCELLED))
        # Nothing is left of it: another computation of this client begins.
        small = client.upload(CREASED_CUBE, "cube.obj")
        self.assertEqual(self.read(client, self.ask(client, small)).n_edges, 4)

    def test_deadline(self):
        client = self.client()
        model = self.large(client)
        seq = self.ask(client, model, deadline=50)
        refused = self.refused(client)
        self.assertEqual((refused.seq, refused.code, refused.text),
                         (seq, LATE, "not done within its deadline_ms of 50"))

    def test_lost_client(self):
        """The computation of a client that goes away ends; its memory is free again."""
        with Client(self.daemon.unix, minor=5) as watcher:
            before = watcher.stats()[23][0]
            with Client(self.daemon.unix, minor=5) as client:
                model = self.large(client)
                self.wait_for_progress(client, self.ask(client, model), "edges")
                during = watcher.stats()[23][0]
            self.assertGreater(during, before)
            small = watcher.upload(CREASED_CUBE, "cube.obj")
            self.assertEqual(self.read(watcher, self.ask(watcher, small)).n_edges, 4)
            held = watcher.query(model)[16][0]  # the model's tables are still there
            self.assertLess(watcher.stats()[23][0], during + held)

    def test_one_of_a_client_at_a_time(self):
        """The second one waits in line, and an answer that needs less work does not overtake."""
        client = self.client()
        model = self.large(client)
        small = client.upload(CREASED_CUBE, "cube.obj")
        client.query(small)
        first = self.ask(client, model)
        self.wait_for_progress(client, first, "edges")
        second = self.ask(client, small)
        kinds = set()
        while (second, "waiting") not in kinds:
            _, kind, _, length, seq = struct.unpack("<BBHII", client.read(16)[4:])
            fields = wire.decode(client.read(length))
            self.assertEqual(kind, wire.PROGRESS)
            kinds.add((seq, fields[1][0].decode()))
        client.send(message(wire.CANCEL, first))
        self.assertEqual(self.refused(client).seq, first)
        self.assertEqual(self.read(client, second).n_edges, 4)

    def test_frames_go_through(self):
        """While a computation runs, frames of its client and of others are drawn, and queries are answered."""
        client, other = self.client(), self.client()
        model = self.large(client)
        cube = other.upload(CUBE, "cube.obj")
        self.assertEqual(client.upload(CUBE, "cube.obj"), cube)
        seq = self.ask(client, model)
        self.wait_for_progress(client, seq, "edges")
        for _ in range(5):
            for each in (client, other):
                frame = each.render(cube, 64, 48)
                self.assertEqual(len(frame.data), 64 * 48 * 4)
            other.query(cube)
        self.wait_for_progress(client, seq, "edges")  # it has not ended
        client.send(message(wire.CANCEL, seq))
        self.assertEqual(self.refused(client).code, CANCELLED)


class Ending(unittest.TestCase):
    def test_ends_with_the_daemon(self):
        """A daemon that must end refuses what is not done in time, and ends."""
        daemon = Daemon("--drain-timeout", "1")
        with Client(daemon.unix, minor=5) as client:
            model = client.upload(creased(150), "large.obj")
            client.query(model)
            client.send(find_breaks(9, model))
            client.stats()
            daemon.terminate()
            with self.assertRaises(wire.Refused) as caught:
                client.receive()
            self.assertEqual((caught.exception.seq, caught.exception.code),
                             (9, wire.ERROR_SHUTTING_DOWN))
        self.assertEqual(daemon.stop(), 0)


class LittleMemory(DaemonCase):
    arguments = ("--memory-budget", budget(40), "--peer-memory", "4M")

    def test_too_big_for_the_budget(self):
        with Client(self.daemon.unix, minor=5) as client:
            model = client.upload(creased(150), "creased.obj")
            seq = client.next_seq()
            client.send(find_breaks(seq, model))
            with self.assertRaises(wire.Refused) as caught:
                client.receive()
            self.assertEqual(caught.exception.code, IN_REQUEST)
            self.assertIn("finding breaks takes up to", caught.exception.text)
            self.assertIn("--peer-memory", caught.exception.text)

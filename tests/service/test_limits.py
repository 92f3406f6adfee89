"""Every limit of `sheend --help` is reached once: what exceeds it is refused with a text that names the limit, or the
connection is closed with the reason in the log. Other clients notice nothing."""
import contextlib
import math
import os
import re
import resource
import signal
import socket
import struct
import tempfile
import time
import unittest
import zlib

import wire
from daemon import CUBE, SANITIZED, Daemon, DaemonCase, budget, grid, resident_kb, run
from test_untrusted import children, image_pattern, workers
from wire import BATCH, INTERACTIVE, Client, field, message

MIB = 1 << 20
LONG_MESSAGE_BYTES = 16 + 262144 - 4096  # more than the buffer that every client has for its messages


def interlaced_png(width, height):
    """A black RGBA picture in the seven passes of Adam7; Paeth predicts each row."""
    def chunk(kind, data):
        return (struct.pack(">I", len(data)) + kind + data +
                struct.pack(">I", zlib.crc32(kind + data)))

    packer, packed = zlib.compressobj(1), b""
    for x, y, dx, dy in ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4),
                         (1, 0, 2, 2), (0, 1, 1, 2)):
        row = b"\4" + bytes(4 * -(-(width - x) // dx))
        for _ in range(-(-(height - y) // dy)):
            packed += packer.compress(row)
    return (b"\x89PNG\r\n\x1a\n" +
            chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 1)) +
            chunk(b"IDAT", packed + packer.flush()) + chunk(b"IEND", b""))


class Table(unittest.TestCase):
    """tests/unit/test_ops_limits.c tests the meaning of the table's values."""

    def test_help_and_file_have_the_same_limits(self):
        text = run("--help").stdout
        said = re.findall(r"^[ *] --([a-z-]+) (?:BYTES|PX|N|SECONDS)\b.*?"
                          r"\(default: (\w+); (\w+) (?:to (\w+)|or more)\)",
                          text[text.index("limits;"):], re.S | re.M)
        self.assertEqual(len(said), 29, said)
        for name, _, low, high in said:
            for value, code in ((low, 0), (high or low, 0), (high and high + "0", 2)):
                if value:
                    done = run(f"--{name}", value, "--check-config")
                    self.assertEqual(done.returncode, code, (name, value, done.stderr))
        rows = [row[:2] for row in said]
        with tempfile.NamedTemporaryFile("w", suffix=".conf") as file:
            file.write("".join(f"{name} = {fallback}\n" for name, fallback in rows))
            file.flush()
            done = run("--config", file.name, "--check-config")
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            for last, words in (("credits = 65", "credits is '65'"),
                                ("output-hard = 1G", "output-hard has a line before this one")):
                file.seek(0)
                file.truncate()
                file.write("".join(f"{name} = {fallback}\n" for name, fallback in rows
                                   if name != "credits") + last + "\n")
                file.flush()
                done = run("--config", file.name, "--check-config")
                self.assertEqual(done.returncode, 2)
                self.assertIn(f"{file.name}:{len(rows)}: {words}", done.stderr)



class Descriptors(unittest.TestCase):
    def test_who_is_connected_is_served(self):
        """With 48 descriptors fewer clients are accepted, and no work for those fails."""
        daemon = Daemon("--metrics", "tcp:127.0.0.1:0", under=("prlimit", "--nofile=48:48"))
        daemon.wait_for("few descriptors")
        with Client(daemon.unix, minor=1) as first, contextlib.ExitStack() as others:
            model = first.upload(CUBE, "cube.obj")
            taken = []
            for _ in range(40):
                try:
                    taken.append(others.enter_context(Client(daemon.unix, minor=1)))
                except (wire.Refused, EOFError, OSError):
                    pass
            self.assertGreater(len(taken), 3)
            self.assertLess(len(taken), 30)
            for encoding in (wire.PNG, wire.EXR, wire.TIFF):
                asked = [client.ask(model, encoding=encoding) for client in (first, first)]
                for seq in asked:
                    self.assertEqual(first.answer()[0], seq)
            models = []
            for number, client in enumerate(taken):
                cube = CUBE + b"# %d\n" % number
                models.append((client, client.upload(cube, "cube.obj")))
            asked = [(client, client.ask(own, encoding=wire.TIFF)) for client, own in models]
            for client, seq in asked:
                got, what = client.answer()
                self.assertEqual(got, seq)
                self.assertIsInstance(what, wire.Frame, what)
        self.assertEqual(daemon.stop(), 0)


class Workers(unittest.TestCase):
    """The limits of the process that reads a file: the file's sender is told which limit was exceeded."""

    def refused(self, arguments, words, act=lambda daemon: None):
        daemon = Daemon(*arguments, tcp=False)
        with Client(daemon.unix, timeout=60) as client:
            client.send(wire.render(70, client.upload(grid(300), "sheet.obj")))
            act(daemon)
            with self.assertRaises(wire.Refused) as caught:
                client.read_frame(70)
            self.assertEqual(caught.exception.seq, 70)
            self.assertRegex(caught.exception.text, "^sheet.obj: .*" + words)
            client.render(client.upload(CUBE, "cube.obj"))
        self.assertEqual(daemon.stop(), 0)

    @unittest.skipIf(SANITIZED, "without a limit of memory")
    def test_worker_memory(self):
        self.refused(("--worker-memory", "4M"), "of the 4 MB that it may take")

    def test_worker_output(self):
        self.refused(("--worker-output", "1M"), "more than 1 MB come out of it")

    def test_stopped_jobs(self):
        def stop_its_processes(daemon):
            """Both of them: a job whose process was stopped is given to another one, once."""
            reader = workers(daemon.process.pid)["sheend-cage"]
            stopped = set()
            while len(stopped) < 2:
                for job in set(children(reader)) - stopped:
                    os.kill(job, signal.SIGSTOP)
                    stopped.add(job)

        self.refused((), "its process was stopped: try again later", stop_its_processes)

    def refused_slow_image(self, option, why):
        """A megabyte that takes seconds to decode: an interlaced picture."""
        daemon = Daemon(option, "1", tcp=False)
        with Client(daemon.unix, timeout=60) as client:
            model = client.upload(CUBE, "cube.obj")
            image = client.upload(interlaced_png(12000, 8000), "slow.png", wire.IMAGE)
            client.send(wire.render(70, model, extra=image_pattern(image)))
            with self.assertRaises(wire.Refused) as caught:
                client.read_frame(70)
            self.assertIn("slow.png: " + why, caught.exception.text)
            client.render(model)
        self.assertEqual(daemon.stop(), 0)

    def test_worker_time(self):
        self.refused_slow_image("--worker-time", "not done in 1 s")

    def test_worker_cpu(self):
        self.refused_slow_image("--worker-cpu", "more than 1 s of processor time")

    @staticmethod
    def slow(comment=""):
        """Vertices of up to 64 faces at which a crease ends, or which are sharp. The limit of their rings is found by
        iteration, once for each number of faces and each kind."""
        lines, tags, first = [], [], 0
        for n in [*range(24, 65)] * 2:
            lines += ["v 0 0 1"] + [f"v {math.cos(math.pi * k / n)} {math.sin(math.pi * k / n)} "
                                    f"{k % 3 / 50}" for k in range(2 * n)]
            lines += [f"f {first + 1} {first + 2 + 2 * k} {first + 3 + 2 * k} "
                      f"{first + 2 + (2 * k + 2) % (2 * n)}" for k in range(n)]
            is_dart = len(tags) > 40
            tags.append(f"t crease 2/1/0 {first} {first + 1} 10" if is_dart
                        else f"t corner 1/1/0 {first} 10")
            first += 2 * n + 1
        return "\n".join([*lines, *tags, "# " + comment, ""]).encode()

    def test_tables_cpu(self):
        daemon = Daemon("--tables-cpu", "1", "--threads", "2", tcp=False)
        with Client(daemon.unix, timeout=60) as client:
            model = client.upload(self.slow(), "slow.obj")
            for seq in (70, 71):
                client.send(wire.render(seq, model))
                with self.assertRaises(wire.Refused) as caught:
                    client.read_frame(seq)
                self.assertEqual(caught.exception.code, wire.ERROR_MODEL)
                self.assertIn("slow.obj: its tables take more than 1 s of processor time "
                              "(--tables-cpu)", caught.exception.text)
            client.render(client.upload(CUBE, "cube.obj"))
        self.assertEqual(daemon.stop(), 0)

    def test_who_takes_back_waits_no_more(self):
        """Frames that are requested and cancelled while a model is being built leave no memory behind."""
        n = 1000  # requests of some 100 KB each
        daemon = Daemon("--tables-cpu", "8", "--threads", "2", tcp=False)
        with Client(daemon.unix, minor=1, timeout=60) as client:
            model = client.upload(self.slow(), "slow.obj")
            query = client.next_seq()
            client.send(message(wire.MODEL_QUERY, query, field(1, model)))
            client.stats()
            before = resident_kb(daemon.process.pid)
            for first in range(0, n, 100):
                client.send(b"".join(wire.render(1000 + i, model, kind=kind) +
                                     (message(wire.CANCEL, 1000 + i) if kind == BATCH else b"")
                                     for i in range(first, first + 100)
                                     for kind in (INTERACTIVE if i % 2 else BATCH,)))
                for _ in range(99 if first == 0 else 100):  # one is superseded only later
                    seq, _ = client.answer()
                    self.assertNotEqual(seq, query)
            self.assertLess(resident_kb(daemon.process.pid) - before, 20 * 1024)
            client.send(message(wire.CANCEL, query))
            self.assertEqual(client.answer()[0], query)
        self.assertEqual(daemon.stop(), 0)

    def test_builds_have_turns(self):
        """A client that asks for many slow models delays another client by those that have begun, and by no more."""
        n_slow = 8
        daemon = Daemon("--tables-cpu", "1", "--threads", "2")
        with Client(daemon.tcp, minor=1, timeout=60) as many, Client(daemon.unix) as one:
            slow = [many.upload(self.slow(str(i)), "slow.obj") for i in range(n_slow)]
            quick = one.upload(CUBE, "cube.obj")
            many.send(b"".join(wire.message(wire.MODEL_QUERY, 100 + i, wire.field(1, model))
                               for i, model in enumerate(slow)))
            many.stats()  # all these queries have been read
            one.query(quick)
            refused = 0
            many.send(wire.message(wire.STATS_QUERY, 200))
            while True:
                try:
                    many.expect(wire.STATS, 200)
                    break
                except wire.Refused as answer:
                    self.assertEqual(answer.code, wire.ERROR_MODEL)
                    refused += 1
            self.assertLess(refused, n_slow // 2)
        self.assertEqual(daemon.stop(), 0)


    def test_slow_builds_of_one_hold_nobody_up(self):
        """A client without a running build is served before any of the slow builds ends."""
        daemon = Daemon("--tables-cpu", "600", "--threads", "2")
        with Client(daemon.tcp, minor=1, timeout=60) as many, Client(daemon.unix) as one:
            sheets = [grid(90 + i) for i in range(3)]
            slow = [many.upload(self.slow(str(i)), "slow.obj") for i in range(6)]
            many.send(b"".join(wire.message(wire.MODEL_QUERY, 100 + i, wire.field(1, model))
                               for i, model in enumerate(slow)))
            many.stats()  # all these queries have been read
            for sheet in sheets:
                one.query(one.upload(sheet, "sheet.obj"))
            seq = many.next_seq()
            many.send(wire.message(wire.STATS_QUERY, seq))
            many.expect(wire.STATS, seq)  # no model was answered before
        daemon.process.kill()


class Memory(DaemonCase):
    arguments = ("--memory-budget", "400M", "--peer-memory", "12M", "--max-upload", "4M",
                 "--max-frame", "8M", "--max-image-side", "100")

    def client(self, address=None):
        client = Client(address or self.daemon.unix, minor=1)
        self.addCleanup(client.socket.close)
        return client

    def begin(self, client, size, name="x.obj"):
        seq = client.next_seq()
        client.send(wire.upload_begin(seq, os.urandom(32), size, name))
        return seq

    def test_max_upload(self):
        client = self.client()
        seq = self.begin(client, 4 * MIB + 1)
        self.assert_refused(client, wire.ERROR_TOO_BIG, str(4 * MIB), seq)

    def test_max_frame(self):
        client = self.client()
        model = client.upload(CUBE, "cube.obj")
        seq = client.ask(model, 1500, 1500)
        self.assert_refused(client, wire.ERROR_TOO_BIG, f"--max-frame of {8 * MIB}", seq)
        seq = client.ask(model, 500, 500, planes=63)  # 56 bytes a pixel
        self.assert_refused(client, wire.ERROR_TOO_BIG, "14000000 bytes", seq)
        client.render(model, 1400, 1400)

    def test_frames_count_what_they_are_encoded_to(self):
        client = self.client()
        model = client.upload(CUBE, "cube.obj")
        seq = client.ask(model, 1400, 1400, encoding=wire.ZSTD)
        self.assert_refused(client, wire.ERROR_TOO_BIG, f"--peer-memory of {12 * MIB}", seq)

    def test_frames_count_what_polygons_are_drawn_on(self):
        """In one piece, or tile by tile if the class allows that."""
        client = self.client()
        model = client.upload(CUBE, "cube.obj")
        polygons = field(40, 1) + field(41, 1)
        client.render(model, 1400, 1400, kind=INTERACTIVE)
        seq = client.ask(model, 1400, 1400, kind=INTERACTIVE, extra=polygons)
        self.assert_refused(client, wire.ERROR_TOO_BIG, "what polygons are drawn on", seq)
        client.render(model, 1400, 1400, kind=wire.STILL, extra=polygons)

    def test_max_image_side(self):
        client = self.client()
        model = client.upload(CUBE, "cube.obj")
        light = lambda image: field(5, field(6, field(1, wire.PATTERN_IMAGE) + field(6, image)))
        wide = client.upload(b"P6\n101 1\n255\n" + bytes(303), "wide.ppm", wire.IMAGE)
        seq = client.ask(model, extra=light(wide))
        self.assert_refused(client, wire.ERROR_IMAGE, "100", seq)
        good = client.upload(b"P6\n100 1\n255\n" + bytes(300), "good.ppm", wire.IMAGE)
        client.render(model, extra=light(good))

    def test_announcing_takes_nothing(self):
        """Eight clients announce the whole budget: memory that has not been received is free for the next client."""
        for _ in range(8):
            client = self.client()
            client.expect(wire.UPLOAD_STATE, self.begin(client, 4 * MIB))
        other = self.client()
        before = other.stats()[23][0]
        other.render(other.upload(os.urandom(0) + b"#" * 3 * MIB + b"\n" + CUBE, "long.obj"))
        self.assertLess(before, MIB)

    def test_peer_memory(self):
        """The unfinished uploads of one user: 12 MB, and no more until some are given up. Another address has its own
        share."""
        holders = []
        for _ in range(3):
            client = self.client()
            seq = self.begin(client, 4 * MIB - LONG_MESSAGE_BYTES)
            client.expect(wire.UPLOAD_STATE, seq)
            client.send(b"".join(message(wire.UPLOAD_CHUNK, seq, bytes(262144))
                                 for _ in range(15)))
            holders.append(client)
        other = self.client()
        deadline = time.monotonic() + 10
        while other.stats()[23][0] < 12 * MIB and time.monotonic() < deadline:
            time.sleep(0.01)
        seq = self.begin(other, MIB, "late.obj")
        other.expect(wire.UPLOAD_STATE, seq)
        other.send(message(wire.UPLOAD_CHUNK, seq, bytes(262144)))
        self.assert_refused(other, wire.ERROR_OVERLOADED, "--peer-memory", seq)
        far = self.client(self.daemon.tcp)
        far.render(far.upload(CUBE + b"# far\n", "far.obj"))
        for client in holders:
            client.socket.close()
        time.sleep(0.1)
        other.render(other.upload(CUBE + b"# late\n", "late.obj"))

    def test_messages_on_their_way_count(self):
        """Each upload lacks one byte; the user has room for 48 of them."""
        clients, before = [], self.client().stats()[23][0]
        for _ in range(48):
            client = self.client()
            seq = self.begin(client, 4 * MIB)
            client.expect(wire.UPLOAD_STATE, seq)
            client.send(message(wire.UPLOAD_CHUNK, seq, bytes(262144))[:-1])
            clients.append(client)
        other = self.client()
        deadline = time.monotonic() + 10
        while other.stats()[23][0] < before + 48 * LONG_MESSAGE_BYTES:
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)
        seq = self.begin(other, 4 * MIB)
        other.expect(wire.UPLOAD_STATE, seq)
        chunk = message(wire.UPLOAD_CHUNK, seq, bytes(262144))
        other.send(chunk[:5000])
        self.assert_refused(other, wire.ERROR_OVERLOADED, "--peer-memory", seq)
        other.send(chunk[5000:] + chunk)  # the client may have sent these chunks already
        other.stats()
        far = self.client(self.daemon.tcp)
        far.upload(CUBE + b"#" * 300000, "far.obj")
        for client in clients:
            client.socket.close()
        while other.stats()[23][0] > before + MIB:
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)
        other.upload(CUBE + b"#" * 200000, "long.obj")

    def test_no_room_out_of_turn(self):
        """A long message that breaks the protocol is refused when its header has been read."""
        for greet, words in ((False, "the first message must be HELLO"),
                             (True, "no upload of its number is under way")):
            client = Client(self.daemon.unix, greet=greet)
            self.addCleanup(client.socket.close)
            client.send(message(wire.UPLOAD_CHUNK, 9, length=262144))
            self.assert_refused(client, wire.ERROR_PROTOCOL, words, 9)
            self.assertTrue(client.at_end())

    def test_frames_wait_for_memory(self):
        """More frames at once than the budget holds: all are drawn in the end."""
        clients = [self.client(address) for address in self.addresses() for _ in range(4)]
        model = clients[0].upload(CUBE, "cube.obj")
        asked = [(client, client.ask(model, 1000, 1000, encoding=wire.ZSTD, kind=kind))
                 for client in clients for kind in (BATCH, INTERACTIVE)]
        for client in clients:
            answers = dict(client.answer() for _ in range(2))
            for seq in answers:
                self.assertIsInstance(answers[seq], wire.Frame, answers[seq])
                self.assertIn((client, seq), asked)
        self.assertLess(clients[0].stats()[23][0], 2 * MIB)  # everything except the model has been freed

    def test_no_frame_waits_for_one_behind_it(self):
        """The second frame has no room beside its model. It must not wait for the memory of the third frame, whose
        answer comes after the second's."""
        daemon = Daemon("--memory-budget", budget(45), tcp=False)
        client = Client(daemon.unix)
        model = client.upload(grid(170), "large.obj")
        client.query(model)
        self.assertGreater(client.stats()[23][0], 15 * MIB)
        seqs = [client.ask(model, 300, 200, encoding=wire.PNG),
                client.ask(model, 500, 500, encoding=wire.ZSTD), client.ask(model)]
        answers = dict(client.answer() for _ in seqs)
        self.assertIsInstance(answers[seqs[0]], wire.Frame)
        self.assertEqual(answers[seqs[1]].code, wire.ERROR_OVERLOADED)
        self.assertIsInstance(answers[seqs[2]], wire.Frame)
        client.socket.close()
        self.assertEqual(daemon.stop(), 0)

    def test_unread_stills_of_one_leave_room(self):
        """One user's connections do not read their frames; a client of another address does not wait for them."""
        clients = [self.client() for _ in range(6)]
        other = self.client(self.daemon.tcp)
        model, theirs = clients[0].upload(CUBE, "cube.obj"), other.upload(CUBE, "cube.obj")
        for client in clients:
            for _ in range(8):
                client.ask(model, 500, 500)
        held, before = 0, -1
        while held != before:
            time.sleep(0.5)
            before, held = held, other.stats()[23][0]
        self.assertGreater(held, 4 * MIB)
        other.socket.settimeout(10)
        other.render(theirs, 500, 500)

    def test_polygons_count(self):
        client = self.client()
        model, large = client.upload(grid(20), "sheet.obj"), client.upload(grid(44), "large.obj")
        polygons = lambda model, level: client.send(
            message(wire.RENDER, client.next_seq(), field(1, model) + field(2, 64) + field(3, 48) +
                    field(9, 1) + field(10, 0) + field(40, 1) + field(41, level)))
        before = client.stats()[23][0]
        polygons(model, 4)  # 400 faces x 17 x 17 vertices of 32 bytes, and their indices
        client.read_frame(client.seq)
        self.assertGreater(client.stats()[23][0] - before, 400 * 17 * 17 * 32)
        polygons(large, 6)
        self.assert_refused(client, wire.ERROR_REQUEST, "--memory-budget", client.seq)


class Polygons(unittest.TestCase):
    def polygons(self, clients, model, level):
        """Requests one frame for each client at the same time, and returns the answers."""
        extra = field(40, 1) + field(41, level)
        asked = [client.ask(model, 64, 48, extra=extra) for client in clients]
        return [client.read_frame(seq).data for client, seq in zip(clients, asked)]

    def test_polygons_are_made_once(self):
        """There is one copy of the polygons of a model and level in main memory and one on the device, whichever
        client draws them; the budget has no room for another. They are evicted before their model, and made again."""
        daemon = Daemon("--memory-budget", budget(24))
        clients = [Client(daemon.unix, minor=1) for _ in range(4)]
        sheets = [clients[0].upload(grid(20) + b"# %d\n" % i, "sheet.obj", share=True)
                  for i in range(3)]
        of_each = 400 * (17 * 17 * 32 + 16 * 16 * 6 * 4)
        for client in clients:
            client.render(sheets[0])
        before = clients[0].stats()[23][0]
        frames = self.polygons(clients, sheets[0], 4)
        self.assertEqual(len(set(frames)), 1)
        used = clients[0].stats()[23][0] - before
        # `before` may count a reply of some kilobytes that was sent, but not freed yet
        self.assertGreater(used, 1.95 * of_each)
        self.assertLess(used, 2.1 * of_each)
        self.polygons(clients[:1], sheets[1], 4)
        self.assertLess(clients[0].stats()[23][0], before + 4 * of_each)
        clients[0].render(sheets[0])  # the model is still there
        self.assertEqual(self.polygons(clients, sheets[0], 4), frames)
        for client in clients:
            client.socket.close()
        self.assertEqual(daemon.stop(), 0)


class Connections(unittest.TestCase):
    def turned_away(self, address):
        client = Client(address, greet=False)
        self.addCleanup(client.socket.close)
        with self.assertRaises(wire.Refused) as caught:
            client.receive()
        self.assertEqual(caught.exception.code, wire.ERROR_OVERLOADED)
        self.assertTrue(client.at_end())
        return caught.exception.text

    def test_max_connections(self):
        daemon = Daemon("--max-connections", "3", "--max-peer-connections", "2")
        first = Client(daemon.unix)
        with first, Client(daemon.unix):
            self.assertIn(f"uid:{os.getuid()} has as many connections as it may (2)",
                          self.turned_away(daemon.unix))
            with Client(daemon.tcp) as other:
                self.assertIn("as many clients", self.turned_away(daemon.tcp))
                other.stats()
                first.socket.close()
                time.sleep(0.1)
                with Client(daemon.unix) as again:
                    again.stats()
        self.assertEqual(daemon.stop(), 0)

    def test_credits(self):
        daemon = Daemon("--credits", "2")
        with Client(daemon.unix, minor=1) as client:
            self.assertEqual(client.credits, 2)
            model = client.upload(CUBE, "cube.obj")
            client.send(b"".join(wire.render(50 + i, model, 400, 400) for i in range(3)))
            self.assertEqual({client.answer()[0] for _ in range(3)}, {50, 51, 52})
            self.assertTrue(client.at_end())
        self.assertIn("credits", daemon.errors())
        self.assertEqual(daemon.stop(), 0)


class Output(unittest.TestCase):
    """Clients that do not read."""

    def assert_disconnected(self, daemon, words, within):
        end = time.monotonic() + within * wire.PATIENCE
        while words not in daemon.errors():
            self.assertLess(time.monotonic(), end, daemon.errors())
            time.sleep(0.02)
        self.assertRegex(daemon.errors(), r'msg="client disconnected" session=\d+ '
                                          r'peer=("unix uid=\d+ gid=\d+ pid=\d+"|127\.0\.0\.1:\d+) ')
        with Client(daemon.unix) as client:
            self.assertEqual(client.stats()[19], [1])
            self.assertEqual(client.stats()[2], [1])  # the field of connected clients
            client.render(client.upload(CUBE, "cube.obj"))
        self.assertEqual(daemon.stop(), 0)

    def frames(self, daemon):
        with Client(daemon.unix) as client:
            return client.stats()[3][0]

    def deaf(self, daemon, address, *requests):
        """A client that sends requests and reads nothing."""
        client = Client(address, minor=1)
        self.addCleanup(client.socket.close)
        model = client.upload(CUBE, "cube.obj")
        client.render(model)
        for i, (width, named) in enumerate(requests):
            while i and self.frames(daemon) < 1 + i:
                time.sleep(0.02)  # so that an interactive request does not overtake this one
            client.ask(model, width, width, **named)
        return client

    def test_output_hard(self):
        daemon = Daemon("--output-hard", "1M")
        self.deaf(daemon, daemon.unix, *[(900, {"kind": BATCH})] * 2)
        self.assert_disconnected(daemon, "over the output-hard limit of 1048576", 10)

    def test_output_soft(self):
        daemon = Daemon("--output-soft", "1M", "--output-seconds", "1")
        self.deaf(daemon, daemon.tcp, (2000, {}))
        self.assert_disconnected(daemon, "over output-soft for output-seconds", 15)

    def test_interactive_hard(self):
        daemon = Daemon("--interactive-hard", "1M")
        self.deaf(daemon, daemon.unix, (1000, {}), (100, {"kind": INTERACTIVE}))
        self.assert_disconnected(daemon, "over the interactive-hard limit of 1048576", 10)

    def test_interactive_soft(self):
        daemon = Daemon("--interactive-soft", "1M", "--interactive-seconds", "1")
        self.deaf(daemon, daemon.unix, (900, {"kind": INTERACTIVE}))
        self.assert_disconnected(daemon, "over interactive-soft for interactive-seconds", 15)

    def test_stall_of_output(self):
        daemon = Daemon("--stall-timeout", "1")
        self.deaf(daemon, daemon.unix, (400, {}))
        self.assert_disconnected(daemon, "no byte read for stall-timeout", 10)

    def test_one_unsent_interactive_frame(self):
        """However many frames it asks for, one waits for the socket, and one behind it for its turn."""
        daemon = Daemon()
        pid = daemon.process.pid
        client = self.deaf(daemon, daemon.unix)
        model = client.upload(CUBE, "cube.obj")
        client.render(model, 1000, 1000, kind=INTERACTIVE)  # the device has planes of this size from here on
        asked = []
        before = resident_kb(pid)
        for view in range(12):
            asked.append(client.ask(model, 1000, 1000, kind=INTERACTIVE, view=view))
        with Client(daemon.unix) as other:
            time.sleep(1.5)
            stats = other.stats()
            self.assertLess(stats[3][0], 6)  # a few frames of this size, not twelve
            self.assertLess(stats[23][0], 3 * 4 * 1000 * 1000)
        self.assertLess(resident_kb(pid) - before, 64 * 1024)
        self.assertEqual([client.answer()[0] for _ in asked], asked)
        client.socket.close()
        self.assertEqual(daemon.stop(), 0)

    def test_kernels_take_no_frames_ahead(self):
        """A TCP socket's buffer would hold several of these frames, which would be out of date when they are read."""
        daemon = Daemon()
        with Client(daemon.tcp, minor=1, buffer=4096) as client, Client(daemon.unix) as other:
            model = client.upload(CUBE, "cube.obj")
            before = other.stats()[3][0]
            asked = [client.ask(model, 350, 350, kind=INTERACTIVE, view=i) for i in range(10)]
            while other.stats()[3][0] == before:
                time.sleep(0.02)
            time.sleep(0.5)
            self.assertEqual(other.stats()[3][0] - before, 1)
            # Through a window of 4 kB the rest takes 15 s, and on a busy machine longer than the client waits.
            client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
            self.assertEqual([client.answer()[0] for _ in asked], asked)
        self.assertEqual(daemon.stop(), 0)

    def test_a_frame_that_waits_for_the_socket_is_replaced(self):
        daemon = Daemon()
        client = self.deaf(daemon, daemon.unix)
        model = client.upload(CUBE, "cube.obj")
        asked = []
        for _ in range(8):
            asked.append(client.ask(model, 1000, 1000, kind=INTERACTIVE, view=1))
            time.sleep(0.25)
        answers = [client.answer() for _ in asked]
        self.assertEqual({seq for seq, _ in answers}, set(asked))
        frames = [seq for seq, what in answers if isinstance(what, wire.Frame)]
        self.assertEqual((frames[0], frames[-1]), (asked[0], asked[-1]))
        self.assertLess(len(frames), 5)
        for seq, by in answers:
            if seq not in frames:
                self.assertGreater(by, seq)
        client.socket.close()
        self.assertEqual(daemon.stop(), 0)


class Input(unittest.TestCase):
    def refused(self, client, words):
        with self.assertRaises(wire.Refused) as caught:
            client.receive()
        self.assertEqual(caught.exception.code, wire.ERROR_PROTOCOL)
        self.assertIn(words, caught.exception.text)
        self.assertTrue(client.at_end())

    def test_handshake(self):
        daemon = Daemon("--handshake-timeout", "1")
        with Client(daemon.unix, greet=False) as silent:
            self.refused(silent, "no HELLO within 1 s")
        self.assertIn("no HELLO within 1 s", daemon.errors())
        self.assertEqual(daemon.stop(), 0)

    def test_a_byte_a_second_is_no_message(self):
        """Each byte arrives within stall-timeout, but the message takes longer than message-timeout."""
        daemon = Daemon("--message-timeout", "1")
        with Client(daemon.unix) as slow, Client(daemon.tcp) as other:
            whole = message(wire.STATS_QUERY, 2)
            with contextlib.suppress(BrokenPipeError):
                for byte in whole:
                    slow.send(bytes([byte]))
                    time.sleep(0.15)
            self.refused(slow, "not come to its end within 1 s")
            other.stats()
        self.assertEqual(daemon.stop(), 0)

    def test_thrown_away_in_time(self):
        """Every long message that finds no memory has its own time limit."""
        daemon = Daemon("--message-timeout", "1", "--memory-budget", budget(4))
        with Client(daemon.unix) as holder, Client(daemon.unix) as client:
            for who, size in ((holder, 4 * MIB), (client, 2 * MIB)):
                who.send(wire.upload_begin(2, bytes(32), size, "a.obj"))
                who.expect(wire.UPLOAD_STATE, 2)
            holder.send(b"".join(message(wire.UPLOAD_CHUNK, 2, bytes(4000)) for _ in range(530)))
            deadline = time.monotonic() + 10
            with Client(daemon.unix) as third:
                while third.stats()[23][0] < 4 * MIB - MIB // 8 and time.monotonic() < deadline:
                    time.sleep(0.01)
            chunks = message(wire.UPLOAD_CHUNK, 2, bytes(262144)) * 8
            for at in range(0, len(chunks), 100000):  # each read contains the end of a message
                client.send(chunks[at:at + 100000])
                time.sleep(0.1)
            with self.assertRaises(wire.Refused) as caught:
                client.receive()
            self.assertEqual(caught.exception.code, wire.ERROR_OVERLOADED)
            client.stats()
        self.assertEqual(daemon.stop(), 0)

    def test_an_upload_that_stops(self):
        daemon = Daemon("--stall-timeout", "1")
        with Client(daemon.unix) as client:
            client.send(wire.upload_begin(2, bytes(32), 100, "a.obj"))
            client.expect(wire.UPLOAD_STATE, 2)
            client.send(message(wire.UPLOAD_CHUNK, 2, b"abc"))
            self.refused(client, "an upload stopped in the middle for 1 s")
        self.assertEqual(daemon.stop(), 0)


class Idle(unittest.TestCase):
    def test_a_thousand(self):
        """Connections that send nothing cost little memory, and cost a client beside them nothing."""
        daemon = Daemon("--max-peer-connections", "1000")
        pid = daemon.process.pid
        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, 4096), hard))
        self.addCleanup(resource.setrlimit, resource.RLIMIT_NOFILE, (soft, hard))
        with Client(daemon.unix) as client:
            model = client.upload(grid(200), "sheet.obj")  # the buffers for chunks of 256 KiB have been used
            client.render(model)
            before = resident_kb(pid)
            clients = []
            for i in range(1000):
                clients.append(Client(daemon.tcp if i % 2 else daemon.unix, minor=1))
            for idle in clients[:100]:
                idle.upload(grid(200), "sheet.obj")
            self.assertEqual(client.stats()[2], [1001])
            self.assertLess(resident_kb(pid) - before, 1000 * 64)
            client.render(model)
            for idle in clients:
                idle.socket.close()
        self.assertEqual(daemon.stop(), 0)

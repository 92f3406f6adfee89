"""The client continues with the next daemon: no frame is lost, and none is counted twice."""
import hashlib
import json
import os
import shutil
import socket
import subprocess
import tempfile
import time
import unittest

import wire
from between import CUT, FORWARD, HOLD, Between, cut_at, frame_number
from daemon import MODELS, SHEEN, Daemon
from wire import Client

FENDER = os.path.join(MODELS, "fender.obj")
SMALL = ("--size", "64x48")


def start(*arguments):
    return subprocess.Popen([SHEEN, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                            text=True)


def sheen(*arguments):
    return subprocess.run([SHEEN, *arguments], capture_output=True, text=True, timeout=60)


def numbers(out):
    return [frame["number"] for frame in json.loads(out)["frames"]]


class Reconnect(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="sheen-test-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def file(self, name):
        return os.path.join(self.folder, name)

    def daemon(self, *arguments):
        return Daemon(*arguments, folder=self.folder, tcp=False)

    def stream(self, daemon, *arguments, frames):
        """Starts a stream, and waits until it has received some of its frames."""
        client = start("stream", FENDER, "--server", daemon.unix, "--frames", str(frames), "--json",
                       "--up", "z", *arguments)
        with Client(daemon.unix) as other:
            while other.stats()[3][0] < 5:
                time.sleep(0.02)
        return client

    def assert_one_notice(self, said, seconds=30):
        self.assertEqual(len(said.splitlines()), 1, said)
        self.assertTrue(said.endswith(f"; connecting again for up to {seconds} s\n"), said)


class NextDaemon(Reconnect):
    def test_after_three_seconds(self):
        """The gap is longer than one attempt. Every frame arrives, from one daemon or the other."""
        daemon = self.daemon()
        client = self.stream(daemon, "--size", "400x300", frames=60)
        self.assertEqual(daemon.stop(), 0)
        time.sleep(3)
        after = self.daemon()
        out, said = client.communicate(timeout=60)
        self.assertEqual(client.returncode, 0, said)
        self.assertIn("shutting down", said)
        self.assert_one_notice(said)
        self.assertEqual(numbers(out), list(range(60)))
        self.assertEqual(after.stop(), 0)

    def test_after_a_kill(self):
        """The socket's file still exists. With -q nothing is printed about the interruption."""
        for quiet in (False, True):
            daemon = self.daemon()
            client = self.stream(daemon, "--size", "400x300", *["-q"] * quiet, frames=60)
            daemon.process.kill()
            daemon.wait()
            after = self.daemon()
            out, said = client.communicate(timeout=60)
            with self.subTest(quiet=quiet):
                self.assertEqual(client.returncode, 0, said)
                if quiet:
                    self.assertEqual(said, "")
                else:
                    self.assert_one_notice(said)
                    self.assertIn("lost server", said)
                self.assertEqual(numbers(out), list(range(60)))
            self.assertEqual(after.stop(), 0)
            daemon.stop()

    def test_a_client_that_is_told_at_once(self):
        """The refusal answers the client's HELLO, before the client has asked for a model in the daemon's folder."""
        path, picture = self.file("sheen.sock"), self.file("a.png")
        for command in (("render", "-o", picture), ("stream", "--frames", "3")):
            with socket.socket(socket.AF_UNIX) as listener:
                listener.bind(path)
                listener.listen()
                client = start(*command, "server:fender.obj", "--server", "unix:" + path, *SMALL)
                peer, _ = listener.accept()
            os.unlink(path)
            with peer:
                peer.recv(1000)
                peer.sendall(wire.message(wire.ERROR, 1, wire.field(1, wire.ERROR_SHUTTING_DOWN) +
                                          wire.field(2, "shutting down")))
                peer.shutdown(socket.SHUT_WR)
                while peer.recv(1000):
                    pass
            daemon = self.daemon("--models", MODELS)
            said = client.communicate(timeout=60)[1]
            with self.subTest(command=command[0]):
                self.assertEqual(client.returncode, 0, said)
                self.assertIn("shutting down; connecting again", said)
            self.assertEqual(daemon.stop(), 0)

    def test_none_comes(self):
        daemon = self.daemon()
        client = self.stream(daemon, *SMALL, "--reconnect", "1", frames=10000)
        self.assertEqual(daemon.stop(), 0)
        out, said = client.communicate(timeout=60)
        self.assertEqual((client.returncode, out), (4, ""))
        notice, end = said.splitlines()
        self.assert_one_notice(notice + "\n", 1)
        self.assertIn("no server at unix:", end)

    def test_none_is_waited_for(self):
        daemon = self.daemon()
        client = self.stream(daemon, *SMALL, "--reconnect", "0", frames=10000)
        self.assertEqual(daemon.stop(), 0)
        out, said = client.communicate(timeout=20)
        self.assertEqual((client.returncode, out), (4, ""))
        self.assertEqual(len(said.splitlines()), 1, said)
        self.assertIn("shutting down", said)
        self.assertNotIn("connecting again", said)

    def test_none_was_ever_there(self):
        """A wrong address fails at once, whatever --reconnect is."""
        for address in ("unix:" + self.file("none"), "tcp:127.0.0.1:1"):
            for command in (("render", FENDER, "-o", self.file("a.png")), ("info", FENDER),
                            ("stream", FENDER, "--frames", "2"),
                            ("levels", FENDER, "-o", self.file("a.png"))):
                with self.subTest(address=address, command=command[0]):
                    done = sheen(*command, "--server", address, "--reconnect", "86400")
                    self.assertEqual(done.returncode, 4)
                    self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                    self.assertIn("no server at", done.stderr)

    def test_a_model_that_has_changed(self):
        """Frames of two versions of a model must not be in one stream."""
        models = self.file("models")
        os.mkdir(models)
        shutil.copy(FENDER, os.path.join(models, "part.obj"))
        daemon = self.daemon("--models", models)
        client = start("stream", "server:part.obj", "--server", daemon.unix, "--frames", "10000",
                       *SMALL)
        with Client(daemon.unix) as other:
            while other.stats()[3][0] < 5:
                time.sleep(0.02)
        self.assertEqual(daemon.stop(), 0)
        shutil.copy(os.path.join(MODELS, "body.obj"), os.path.join(models, "part.obj"))
        after = self.daemon("--models", models)
        out, said = client.communicate(timeout=60)
        self.assertEqual((client.returncode, out), (3, ""), said)
        self.assertIn("part.obj: it has changed", said)
        self.assertEqual(after.stop(), 0)


    def test_what_a_balancer_sees(self):
        """The id at the beginning of a connection: that of the file, or that of the name of a file at the server. A
        new connection begins with the same id, although the client knows more by then."""
        daemon = self.daemon("--models", MODELS)
        with open(FENDER, "rb") as file:
            own = hashlib.sha256(file.read()).digest()
        for model, greeted in ((FENDER, own),
                               ("server:fender.obj", hashlib.sha256(b"server:fender.obj").digest())):
            for command in (("info",), ("render", "-o", self.file("a.png"), *SMALL)):
                seen = []
                cut = cut_at(wire.MODEL_QUERY if command[0] == "info" else wire.RENDER)

                def judge(connection, kind, seq, body, client):
                    if kind == wire.HELLO:
                        seen.append(body[:32])
                    return cut(connection, kind, seq, body, client)

                with self.subTest(model=model, command=command[0]), Between(daemon, judge) as between:
                    done = sheen(*command, model, "--server", between.unix)
                    self.assertEqual(done.returncode, 0, done.stderr)
                    self.assertEqual(seen, [greeted, greeted])
        self.assertEqual(daemon.stop(), 0)


class Broken(Reconnect):
    """One daemon, and a relay to it that closes connections at a chosen message."""

    @classmethod
    def setUpClass(cls):
        cls.served = Daemon(tcp=False)

    @classmethod
    def tearDownClass(cls):
        if cls.served.stop() != 0:
            raise AssertionError("the daemon did not end well")

    def run_through(self, between, *arguments):
        done = sheen(*arguments, "--server", between.unix)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(between.n_connections, 2)
        return done

    def test_pictures_are_the_same(self):
        whole, parts = self.file("whole.png"), self.file("parts.png")
        image = self.file("light.png")
        self.assertEqual(sheen("render", FENDER, "-o", image, *SMALL, "--server",
                               self.served.unix).returncode, 0)
        for place, command in ((cut_at(wire.UPLOAD_BEGIN), ("render", *SMALL)),
                               (cut_at(wire.UPLOAD_BEGIN, 2), ("render", *SMALL, "--pattern",
                                                               "image:" + image)),
                               (cut_at(wire.RENDER), ("render", *SMALL)),
                               (cut_at(wire.RENDER, 4), ("levels", *SMALL))):
            arguments = (command[0], FENDER, *command[1:])
            done = sheen(*arguments, "-o", whole, "--server", self.served.unix)
            self.assertEqual(done.returncode, 0, done.stderr)
            with self.subTest(command=command), Between(self.served, place) as between:
                broken = self.run_through(between, *arguments, "-o", parts)
                self.assertIn("connecting again", broken.stderr)
                self.assertEqual(broken.stdout, done.stdout)
                with open(whole, "rb") as one, open(parts, "rb") as other:
                    self.assertEqual(one.read(), other.read())

    def test_images_go_to_the_next_too(self):
        image = self.file("light.png")
        self.assertEqual(sheen("render", FENDER, "-o", image, *SMALL, "--server",
                               self.served.unix).returncode, 0)
        uploads = [0, 0]
        cut = cut_at(wire.RENDER, 2)

        def judge(connection, kind, *rest):
            uploads[connection] += kind == wire.UPLOAD_BEGIN
            return cut(connection, kind, *rest)

        for command in (("stream", "--frames", "4"), ("levels", "-o", self.file("levels.png"))):
            with self.subTest(command=command[0]), Between(self.served, judge) as between:
                self.run_through(between, command[0], FENDER, *command[1:], *SMALL, "--pattern",
                                 "image:" + image)
                self.assertEqual(uploads, [2, 2])  # the model and the image, each uploaded once on each connection
            uploads[:] = [0, 0]
            cut = cut_at(wire.RENDER, 2)

    def test_info(self):
        with Between(self.served, cut_at(wire.MODEL_QUERY)) as between:
            done = self.run_through(between, "info", FENDER, "--json")
            self.assertEqual(json.loads(done.stdout)["ptex_faces"],
                             json.loads(sheen("info", FENDER, "--json", "--server",
                                              self.served.unix).stdout)["ptex_faces"])

    def test_inside_a_frame(self):
        """Half of the frame has arrived."""
        with Between(self.served, cut_after=200000) as between:
            done = self.run_through(between, "stream", FENDER, "--frames", "30", "--json", "--size",
                                    "400x300")
            self.assertEqual(numbers(done.stdout), list(range(30)))

    def test_answers_in_another_order(self):
        """Frame 3 is answered as late while frame 2 is unanswered: frame 2 is requested again, frame 3 is not."""
        asked = []

        def judge(connection, kind, seq, body, client):
            if kind != wire.RENDER:
                return FORWARD
            number = frame_number(body)
            if connection == 1:
                asked.append(number)
                return FORWARD
            if number == 3:
                client.sendall(wire.message(wire.ERROR, seq, wire.field(1, wire.ERROR_DEADLINE) +
                                            wire.field(2, "too late")))
            return {2: HOLD, 3: HOLD, 4: CUT}.get(number, FORWARD)

        with Between(self.served, judge) as between:
            done = self.run_through(between, "stream", FENDER, "--frames", "8", "--json", *SMALL,
                                    "--deadline", "3600000")
        self.assertEqual(asked, [2, 4, 5, 6, 7])
        self.assertEqual(json.loads(done.stdout)["late"], 1)
        self.assertEqual(numbers(done.stdout), [0, 1, 2, 4, 5, 6, 7])

    def test_every_loss_after_an_answer_is_the_first(self):
        """More losses in all than are allowed in a row."""
        with Between(self.served, cut_at(wire.RENDER, 3, range(6))) as between:
            done = sheen("stream", FENDER, "--frames", "12", "--json", "--up", "z", *SMALL, "--server",
                         between.unix)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertGreater(between.n_connections, 5)
            self.assertEqual(len(done.stderr.splitlines()), between.n_connections - 1)
            self.assertEqual(numbers(done.stdout), list(range(12)))

    def test_a_request_that_ends_every_server(self):
        """The client tries four servers and no more."""
        with Between(self.served, cut_at(wire.RENDER, 1, range(100))) as between:
            done = sheen("render", FENDER, "-o", self.file("a.png"), *SMALL, "--server",
                         between.unix)
            self.assertEqual((done.returncode, between.n_connections), (4, 4))
            self.assertIn("4 servers in a row went before they answered",
                          done.stderr.splitlines()[-1])

    def test_a_server_that_is_silent_costs_its_time(self):
        """An attempt that nobody serves ends with the time limit of --reconnect."""
        with Between(self.served, cut_at(wire.RENDER), n_accepted=1) as between:
            done = sheen("render", FENDER, "-o", self.file("a.png"), *SMALL, "--reconnect", "1",
                         "--server", between.unix)
            self.assertEqual(done.returncode, 4)
            self.assertIn("the server said nothing for 1 s", done.stderr.splitlines()[-1])

    def test_statistics_are_of_one_daemon(self):
        with Between(self.served, cut_at(wire.STATS_QUERY)) as between:
            done = sheen("stats", "--server", between.unix)
            self.assertEqual((done.returncode, between.n_connections), (4, 1))
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

    def test_closed_at_the_first_hello(self):
        """A client that is not admitted does not keep trying."""
        with Between(self.served, cut_at(wire.HELLO, 1, range(100))) as between:
            done = sheen("info", FENDER, "--server", between.unix)
            self.assertEqual((done.returncode, between.n_connections), (4, 1))
            self.assertIn("lost server", done.stderr)

"""Many clients at once, some of which misbehave, for a few seconds. soak_load.py does the same for longer."""
import contextlib
import os
import random
import signal
import socket
import subprocess
import sys
import threading
import time
import unittest

import wire
from daemon import CUBE, Daemon
from load import LoadClient, make_clients, run_load
from wire import INTERACTIVE, Client, message

ALONE = True  # tests/run.sh runs nothing else at the same time as these tests


class Many(unittest.TestCase):
    def test_every_request_is_answered_once(self):
        """64 interactive and 8 batch clients. LoadClient expects exactly one answer to each request."""
        daemon = Daemon()
        with Client(daemon.unix) as other:
            model = other.upload(CUBE, "cube.obj", share=True)
            other.render(model)
            before = other.stats()
            interactive, batch = make_clients((daemon.unix, daemon.tcp), model, 64, 8)
            run_load(interactive + batch, 4)
            after = other.stats()
        counts = [sum(client.frames for client in group) for group in (interactive, batch)]
        superseded = sum(client.superseded for client in interactive)
        self.assertEqual([client.errors for client in interactive + batch], [[]] * 72)
        self.assertEqual(after[3][0] - before[3][0], sum(counts))
        self.assertEqual(after[16][0] - before[16][0], superseded)
        self.assertGreater(superseded, 0)
        self.assertTrue(all(client.frames for client in interactive + batch))
        used = [after[field][0] - before[field][0] for field in (20, 21, 22)]
        self.assertGreater(used[2] / sum(used), 0.17, used)  # the batches' fifth
        for client in interactive + batch:
            client.socket.close()
        self.assertEqual(daemon.stop(), 0)


class Misbehaviour(unittest.TestCase):
    """Misbehaviour costs only the client that misbehaves: the log has the reason, and others get every answer."""
    arguments = ("--message-timeout", "1", "--stall-timeout", "2", "--interactive-soft", "100K",
                 "--interactive-seconds", "1", "--handshake-timeout", "1")

    def stops_reading(self):
        with Client(self.daemon.tcp, minor=1) as client:
            model = client.upload(CUBE, "cube.obj")
            client.ask(model, 1200, 1200, kind=INTERACTIVE)
            self.gone.wait()

    def sends_a_byte_a_second(self):
        with Client(self.daemon.unix, minor=1) as client, contextlib.suppress(OSError):
            for byte in message(wire.STATS_QUERY, 2):
                client.send(bytes([byte]))
                time.sleep(0.2)

    def lies_about_lengths(self):
        while not self.gone.wait(0.01):  # other clients run in this process
            with Client(self.daemon.unix, minor=1) as client, contextlib.suppress(OSError):
                client.send(message(wire.RENDER, 2, bytes(100), length=1 << 30))
                client.socket.recv(1000)

    def floods(self):
        flood = b"".join(wire.render(9 + i, self.model, kind=INTERACTIVE, view=i)
                         for i in range(200))
        while not self.gone.wait(0.01):  # other clients run in this process
            with Client(self.daemon.unix, minor=1) as client, contextlib.suppress(OSError):
                client.upload(CUBE, "cube.obj")
                client.send(flood)
                while client.socket.recv(1 << 20):
                    pass

    def closes_half(self):
        while not self.gone.wait(0.01):  # other clients run in this process
            with Client(self.daemon.tcp, minor=1) as client, contextlib.suppress(OSError):
                client.send(message(wire.STATS_QUERY, 2)[:9])
                client.socket.shutdown(socket.SHUT_WR)
                client.socket.recv(1000)

    def is_stopped(self):
        """Stops the client by SIGSTOP while a frame larger than any socket's buffer is due, which is always so from
        the first frame on."""
        ask = ("import wire; client = wire.Client({!r}, minor=1)\n"
               "ask = lambda: client.ask({!r}, 1000, 1000, kind=wire.STILL)\n"
               "due = ask()\n"
               "while True:\n"
               "    seq, due = due, ask()\n"
               "    client.read_frame(seq)\n"
               "    print(flush=True)")
        process = subprocess.Popen(
            [sys.executable, "-c", ask.format(self.daemon.unix, self.model)],
            cwd=os.path.dirname(os.path.abspath(__file__)), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
            env=dict(os.environ, PYTHONPATH=os.path.join(os.environ["SHEEN_BUILD"], "python")))
        process.stdout.readline()
        process.send_signal(signal.SIGSTOP)
        self.gone.wait()
        process.kill()
        process.wait()
        process.stdout.close()

    def wait_for_log(self, reason, n):
        """Expects that n lines of the log soon contain these words."""
        end = time.monotonic() + 20
        while self.daemon.errors().count(reason) < n:
            self.assertLess(time.monotonic(), end, self.daemon.errors()[-4000:])
            time.sleep(0.05)

    def run_beside(self, misbehave, seconds, reason=None):
        """The latencies of a client while another misbehaves, until the log reports it."""
        n_before = self.daemon.errors().count(reason) if reason else 0
        self.gone = threading.Event()
        thread = threading.Thread(target=misbehave) if misbehave else None
        if thread:
            thread.start()
        good = [LoadClient(self.daemon.unix, self.model, random.Random(i), INTERACTIVE, 64, 48)
                for i in range(4)]
        try:
            run_load(good, seconds)
            if reason:
                self.wait_for_log(reason, n_before + 1)
        finally:
            self.gone.set()
            if thread:
                thread.join()
            for client in good:
                client.socket.close()
        self.assertEqual([client.errors for client in good], [[]] * 4)
        self.assertTrue(all(client.frames for client in good))
        return [latency for client in good for latency in client.latencies]

    CASES = ((stops_reading, "unsent: over interactive-soft for interactive-seconds", 2),
             (sends_a_byte_a_second, "has not come to its end within 1 s", 2),
             (lies_about_lengths, "longer than its type allows", 1),
             (floods, "more requests unanswered than HELLO_OK's credits allow", 1),
             (closes_half, None, 1),
             (is_stopped, "bytes unsent: ", 2))

    def setUp(self):
        self.daemon = Daemon(*self.arguments)
        with Client(self.daemon.unix) as client:
            self.model = client.upload(CUBE, "cube.obj")
            client.render(self.model)

    def tearDown(self):
        self.assertEqual(self.daemon.stop(), 0)

    def test_each_costs_only_itself(self):
        for misbehave, reason, seconds in self.CASES:
            with self.subTest(misbehave.__name__):
                self.run_beside(lambda: misbehave(self), seconds, reason)
                with Client(self.daemon.unix) as client:
                    end = time.monotonic() + 5
                    while client.stats()[2] != [1] and time.monotonic() < end:
                        time.sleep(0.05)
                    self.assertEqual(client.stats()[2], [1])  # no other client is connected any more

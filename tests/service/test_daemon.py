"""Start, end and options of the daemon."""
import os
import re
import signal
import socket
import stat
import subprocess
import tempfile
import threading
import time
import unittest

import wire
from daemon import CUBE, SHEEND, Daemon, budget, grid, judges_time, run
from test_untrusted import workers
from wire import Client


class Options(unittest.TestCase):
    def assert_fails(self, code, words, *arguments, env=None):
        done = run(*arguments, env=env)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertIn(words, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

    def test_help_and_version(self):
        text = run("--help").stdout
        for name in ("--listen", "--device", "--memory-budget", "--config", "--check-config",
                     "--session-fd", "--threads", "--drain-timeout", "--version"):
            self.assertIn(name, text)
        self.assertIn("examples", text)
        self.assertRegex(run("--version").stdout, r"^sheend \d+\.\d+\.\d+, protocol 1\.\d+\n$")

    def test_wrong_usage(self):
        for words, *arguments in (("'--nothing' is no option; ", "--nothing"), ("stray", "stray"),
                                  ("--help takes no value", "--help=1"), ("'--max' may be ", "--max", "3"),
                                  ("'--listn' is no option; ", "--listn", "x"),
                                  ("--device needs a value; ", "--device"), ("device", "--device", "fast"),
                                  ("memory-budget", "--memory-budget", "much"),
                                  ("memory-budget", "--memory-budget", "0"),
                                  ("memory-budget is '1'; it must be 36M or more: bytes, ",
                                   "--memory-budget", "1"),
                                  ("memory-budget", "--memory-budget", "-1"),
                                  ("memory-budget", "--memory-budget", "99999999999999T"),
                                  ("memory-budget", "--memory-budget", "4GB"),
                                  ("drain-timeout", "--drain-timeout", "-1"),
                                  ("threads", "--threads", "0"), ("threads", "--threads", "257"),
                                  ("unix:PATH", "--listen", "sheen.sock"),
                                  ("unix:PATH", "--listen", "tcp:localhost"),
                                  ("models", "--models", ""), ("models", "--models", 512 * "x"),
                                  ("session-fd", "--session-fd", "77"),
                                  ("session-fd", "--session-fd", "1")):
            with self.subTest(arguments=arguments):
                self.assert_fails(2, words, *arguments)

    def test_not_loopback(self):
        for address in ("tcp:0.0.0.0:0", "tcp:[::]:0", "tcp:192.0.2.1:7410", "tcp:[2001:db8::1]:1",
                        "tcp:[::ffff:192.0.2.1]:1"):
            with self.subTest(address=address):
                self.assert_fails(2, "loopback", "--listen", address)
                self.assert_fails(2, "loopback", "--listen", address, "--check-config")

    def test_config(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "sheend.conf")

            def write(text):
                with open(path, "w", encoding="ascii") as file:
                    file.write(text)

            write(f"# ours\n[sheend]\nlisten = unix:{folder}/a.sock\nlisten = tcp:127.0.0.1:0\n"
                  "device = software\nmemory-budget = 1G\nthreads = 2\nidle-timeout = 60\n")
            done = run("--config", path, "--check-config")
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            for line, words in (("nothing = 1", "nothing"), ("threads = many", "threads"),
                                ("just words", "name = value"), ("[other]\nthreads = 1", "other"),
                                ("config = x", "config"), ("session-fd = 0", "session-fd")):
                write("[sheend]\nthreads = 1\n" + line + "\n")
                self.assert_fails(2, words, "--config", path)
                self.assert_fails(2, f"{path}:{4 if line[0] == '[' else 3}:", "--config", path)
            for line, words in (("threads = 2", "threads has a line before this one"),
                                ("  2", "the line is indented"),
                                ("\tdevice = software", "the line is indented"),
                                ("device = software\0, or not", "zero byte in the line"),
                                ("\0", "zero byte in the line"),
                                ("#\0", "zero byte in the line"),
                                ("[sheend] device = auto", "behind a section's name"),
                                ("# " + 300 * "a", "more than 199 bytes")):
                for end in ("\n", "\nnothing = 1\nwords\n", ""):
                    write("[sheend]\nthreads = 1\n" + line + end)
                    self.assert_fails(2, f"{path}:3: ", "--config", path)
                    self.assert_fails(2, words, "--config", path)
            write("words\n[sheend]\nthreads = many\n")
            self.assert_fails(2, f"{path}:1: a line must be", "--config", path)
            write("  # ours\n[sheend]  \n\n \t\nthreads = 1 ; one\nlisten = tcp:127.0.0.1:0\n"
                  "allow-uid = 1\nallow-gid = 2\nallow-uid = 2\nlisten = tcp:127.0.0.1:0\n;" +
                  198 * "a")
            done = run("--config", path, "--check-config")
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            write("listen = tcp:0.0.0.0:1\n")
            self.assert_fails(2, "loopback", "--config", path, "--check-config")
            # Options on the command line override those in the file.
            done = run("--config", path, "--listen", f"unix:{folder}/b.sock", "--check-config")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assert_fails(2, "cannot read", "--config", folder + "/none")
            os.mkfifo(folder + "/pipe")
            for other in (folder, folder + "/pipe"):
                self.assert_fails(2, other + ": it is no plain file", "--config", other)

    def test_no_device(self):
        hidden = {"__EGL_VENDOR_LIBRARY_FILENAMES": "/dev/null"}
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "s")
            self.assert_fails(5, "EGL", "--listen", "unix:" + path, "--device", "0", env=hidden)
            self.assertFalse(os.path.exists(path))
            self.assert_fails(5, "99", "--listen", "unix:" + path, "--device", "99")


class Sockets(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = os.path.join(self.folder.name, "sheen.sock")

    def tearDown(self):
        self.folder.cleanup()

    def start(self, *arguments):
        return Daemon(*arguments, folder=self.folder.name, tcp=False)

    def test_owner_only_and_removed(self):
        old = os.umask(0)
        try:
            daemon = self.start()
        finally:
            os.umask(old)
        mode = os.stat(self.path).st_mode
        self.assertTrue(stat.S_ISSOCK(mode))
        self.assertEqual(stat.S_IMODE(mode), 0o600)
        self.assertEqual(daemon.stop(), 0)
        self.assertFalse(os.path.exists(self.path))

    def test_stale_socket_is_replaced(self):
        with socket.socket(socket.AF_UNIX) as dead:
            dead.bind(self.path)
        self.assertTrue(os.path.exists(self.path))
        daemon = self.start()
        with Client(daemon.unix) as client:
            client.stats()
        self.assertEqual(daemon.stop(), 0)

    def test_living_socket_is_not(self):
        daemon = self.start()
        done = run("--listen", daemon.unix, "--device", "software")
        self.assertEqual(done.returncode, 4)
        self.assertIn("another daemon", done.stderr)
        with Client(daemon.unix) as client:
            client.stats()
        self.assertEqual(daemon.stop(), 0)

    def test_waits_for_a_predecessor_that_dies(self):
        """The sockets of a daemon that is dying still answer for a moment."""
        unix, tcp = socket.socket(socket.AF_UNIX), socket.create_server(("127.0.0.1", 0))
        unix.bind(self.path)
        unix.listen()
        port = tcp.getsockname()[1]

        def die():
            time.sleep(0.3)
            unix.close()
            time.sleep(0.3)
            tcp.close()

        dying = threading.Thread(target=die)
        dying.start()
        daemon = Daemon("--listen", f"tcp:127.0.0.1:{port}", path=self.path, tcp=False)
        dying.join()
        for address in daemon.unix, f"tcp:127.0.0.1:{port}":
            with Client(address) as client:
                client.stats()
        self.assertEqual(daemon.stop(), 0)

    def test_other_files_are_not(self):
        with open(self.path, "w", encoding="ascii") as file:
            file.write("precious")
        done = run("--listen", "unix:" + self.path, "--device", "software")
        self.assertEqual(done.returncode, 4)
        with open(self.path, encoding="ascii") as file:
            self.assertEqual(file.read(), "precious")

    def test_somebody_elses_socket_is_not_removed(self):
        daemon = self.start()
        os.unlink(self.path)
        with socket.socket(socket.AF_UNIX) as other:
            other.bind(self.path)
            self.assertEqual(daemon.stop(), 0)
            self.assertTrue(os.path.exists(self.path))

    def test_no_such_folder(self):
        done = run("--listen", "unix:/no/such/folder/s", "--device", "software")
        self.assertEqual(done.returncode, 4)
        self.assertIn("/no/such/folder/s", done.stderr)

    def test_port_in_use(self):
        with socket.socket() as other:
            other.bind(("127.0.0.1", 0))
            other.listen()
            port = other.getsockname()[1]
            done = run("--listen", f"tcp:127.0.0.1:{port}", "--device", "software")
        self.assertEqual(done.returncode, 4)
        self.assertIn(str(port), done.stderr)

    def test_default_address(self):
        env = {**os.environ, "XDG_RUNTIME_DIR": self.folder.name}
        process = subprocess.Popen([SHEEND, "--device", "software"], env=env,
                                   stderr=subprocess.PIPE, text=True)
        try:
            self.assertIn(self.path, process.stderr.readline())
            with Client("unix:" + self.path) as client:
                client.stats()
        finally:
            process.terminate()
            process.wait(30)
            process.stderr.close()

    def test_banner(self):
        daemon = Daemon()
        self.assertRegex(daemon.errors(),
                         r'^ts=\S+Z level=info msg=listening version=\d+\.\d+\.\d+ device=.+ '
                         r'addresses="unix:.+, tcp:127\.0\.0\.1:\d+" metrics=""\n$')
        self.assertEqual(daemon.stop(), 0)


class Shutdown(unittest.TestCase):
    def assert_told(self, client):
        """A client without a request in flight is told why its connection closes."""
        with self.assertRaises(wire.Refused) as caught:
            client.receive()
        self.assertEqual((caught.exception.code, caught.exception.seq),
                         (wire.ERROR_SHUTTING_DOWN, 0))
        self.assertTrue(client.at_end())

    def test_finishes_what_is_in_flight(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            daemon = Daemon()
            with Client(daemon.unix, timeout=60) as client, Client(daemon.tcp) as idle:
                model = client.upload(CUBE, "cube.obj")
                client.send(b"".join(wire.render(5 + i, model, width=1200, height=1200)
                                     for i in range(3)))
                time.sleep(0.2)
                daemon.process.send_signal(number)
                for i in range(3):
                    client.read_frame(5 + i)
                self.assert_told(client)
                self.assert_told(idle)
                self.assertEqual(daemon.wait(), 0)
            self.assertEqual(daemon.stop(), 0)

    def test_new_requests_are_refused(self):
        daemon = Daemon()
        with Client(daemon.unix, timeout=60) as client:
            model = client.upload(CUBE, "cube.obj")
            client.send(wire.render(5, model, width=3000, height=3000))
            time.sleep(0.2)
            daemon.terminate()
            time.sleep(0.2)
            client.send(wire.render(6, model))
            with self.assertRaises(OSError):
                Client(daemon.unix)
            client.read_frame(5)
            with self.assertRaises(wire.Refused) as caught:
                client.receive()
            self.assertEqual((caught.exception.code, caught.exception.seq),
                             (wire.ERROR_SHUTTING_DOWN, 6))
            self.assertTrue(client.at_end())
        self.assertEqual(daemon.stop(), 0)

    def test_slow_readers_get_whole_frames(self):
        """The data exceeds any socket's buffer and is read slowly, while the daemon is told to end."""
        daemon = Daemon()
        size = 2000 * 2000 * 4
        with Client(daemon.unix, timeout=60) as one, Client(daemon.tcp, timeout=60) as two:
            model = one.upload(CUBE, "cube.obj", share=True)
            for client in (one, two):
                client.send(wire.render(5, model, width=2000, height=2000))
            time.sleep(0.3)
            daemon.terminate()
            time.sleep(2)
            left = {one: size, two: size}
            for client in left:
                client.expect(wire.FRAME, 5)
            while any(left.values()):
                time.sleep(0.1)
                for client in left:
                    if left[client]:
                        left[client] -= len(client.receive()[3])
            self.assert_told(one)
            self.assert_told(two)
        self.assertEqual(daemon.stop(), 0)

    @judges_time
    def test_readers_that_are_too_slow_are_left(self):
        daemon = Daemon("--drain-timeout", "2")
        with Client(daemon.unix, timeout=60) as client:
            model = client.upload(CUBE, "cube.obj")
            client.send(wire.render(5, model, width=2000, height=2000))
            client.expect(wire.FRAME, 5)
            daemon.terminate()
            start = time.monotonic()
            while daemon.process.poll() is None and time.monotonic() - start < 10:
                client.read(1)  # reads so often that the daemon sees no stall
                time.sleep(0.05)
            self.assertGreater(time.monotonic() - start, 1.5)
            self.assertLess(time.monotonic() - start, 5)
        self.assertEqual(daemon.stop(), 0)

    def assert_slow_requests_are_refused(self, stopped_s):
        """When the daemon's second for draining is over, there are many seconds of work left. Files are small, so that
        reading them takes no time. `stopped_s`: how long nothing of the daemon runs after it has begun to drain."""
        daemon = Daemon("--drain-timeout", "1")
        with Client(daemon.unix, timeout=60, minor=1) as client, \
             Client(daemon.tcp, timeout=60, minor=1) as quick:
            model = client.upload(CUBE, "cube.obj", share=True)
            asked = [client.ask(model, 8192, 4096, kind=wire.BATCH, encoding=wire.JPEG)
                     for _ in range(16)]
            small = quick.ask(model)
            daemon.terminate()
            if stopped_s:
                daemon.wait_for("shutting down")
                daemon.process.send_signal(signal.SIGSTOP)
                time.sleep(stopped_s)
                daemon.process.send_signal(signal.SIGCONT)
            self.assertEqual(quick.answer()[0], small)
            self.assert_told(quick)
            answers = dict(client.answer() for _ in asked)
            self.assertEqual(sorted(answers), asked)
            refused = [a for a in answers.values() if isinstance(a, wire.Refused)]
            self.assertGreater(len(refused), 8)
            for one in refused:
                self.assertEqual(one.code, wire.ERROR_SHUTTING_DOWN)
                self.assertIn("not done within the 1 s (drain-timeout)", one.text)
            self.assert_told(client)
        self.assertEqual(daemon.wait(10), 0)
        log = daemon.errors()
        self.assertIn("drain-timeout is over", log)
        daemon.stop()
        return log

    def test_what_was_sent_before_the_signal_is_answered(self):
        """The requests fill what the daemon reads at once, 4096 bytes, exactly twice."""
        daemon = Daemon("--credits", "32")
        with Client(daemon.unix, minor=1) as client:
            daemon.process.send_signal(signal.SIGSTOP)
            asked = [client.next_seq() for _ in range(client.credits)]
            for seq in asked:
                query = wire.message(wire.MODEL_QUERY, seq, wire.field(1, bytes(32)) +
                                     wire.field(2, 203 * "x"))
                self.assertEqual(len(query), 256)
                client.send(query)
            daemon.terminate()
            daemon.process.send_signal(signal.SIGCONT)
            for seq in asked:
                with self.assertRaises(wire.Refused) as caught:
                    client.receive()
                self.assertEqual(caught.exception.seq, seq)
                self.assertNotEqual(caught.exception.code, wire.ERROR_SHUTTING_DOWN)
            self.assert_told(client)
        self.assertEqual(daemon.stop(), 0)

    @judges_time
    def test_what_takes_too_long_is_refused(self):
        self.assertNotIn("at work", self.assert_slow_requests_are_refused(stopped_s=0))

    def test_a_daemon_that_stood_still_answers_before_it_leaves(self):
        self.assert_slow_requests_are_refused(stopped_s=2.5)

    def test_a_tile_after_the_time_is_the_last(self):
        """One frame of many tiles; the daemon looks at the clock between tiles."""
        daemon = Daemon("--drain-timeout", "0")
        with Client(daemon.unix, timeout=60, minor=1) as client:
            model = client.upload(CUBE, "cube.obj")
            client.render(model)  # all programs are compiled now
            seq = client.ask(model, 12000, 12000, kind=wire.BATCH)
            time.sleep(0.3)
            daemon.terminate()
            number, refused = client.answer()
            self.assertEqual((number, refused.code), (seq, wire.ERROR_SHUTTING_DOWN))
            self.assert_told(client)
        self.assertEqual(daemon.wait(10), 0)
        daemon.stop()

    def test_whoever_goes_on_sending_is_left(self):
        daemon = Daemon("--drain-timeout", "1")
        with Client(daemon.unix, timeout=60) as client:
            daemon.terminate()
            self.assert_told(client)
            end = time.monotonic() + 20
            while daemon.process.poll() is None and time.monotonic() < end:
                try:
                    client.send(b"x")
                except OSError:
                    break
                time.sleep(0.05)
            self.assertEqual(daemon.wait(5), 0)
        daemon.stop()

    def test_whoever_does_not_read_is_left(self):
        daemon = Daemon("--drain-timeout", "1")
        with Client(daemon.unix, timeout=60) as client:
            model = client.upload(CUBE, "cube.obj")
            seq = client.ask(model, 2000, 2000)  # the answer is larger than the socket's buffer
            client.expect(wire.FRAME, seq)
            daemon.terminate()
            self.assertEqual(daemon.wait(20), 0)
            self.assertIn("bytes unsent: not read within drain-timeout", daemon.errors())
        daemon.stop()

    def test_during_a_build_that_nobody_waits_for(self):
        daemon = Daemon()
        with Client(daemon.unix) as client:
            client.send(wire.render(5, client.upload(grid(300), "big.obj")))
        daemon.terminate()
        self.assertEqual(daemon.stop(), 0)

    def test_second_signal_ends_at_once(self):
        daemon = Daemon()
        with Client(daemon.unix) as client:
            model = client.upload(CUBE, "cube.obj")
            client.send(b"".join(wire.render(5 + i, model, width=4000, height=4000)
                                 for i in range(4)))
            time.sleep(0.3)
            daemon.terminate()
            time.sleep(0.2)
            start = time.monotonic()
            daemon.terminate()
            self.assertEqual(daemon.wait(), 0)
            self.assertLess(time.monotonic() - start, 2)
            self.assertFalse(os.path.exists(daemon.path))
        daemon.stop()


class Timeouts(unittest.TestCase):
    def test_idle(self):
        daemon = Daemon("--idle-timeout", "1")
        with Client(daemon.unix) as idle, Client(daemon.tcp) as busy:
            model = busy.upload(CUBE, "cube.obj")
            for _ in range(8):
                busy.render(model)
                time.sleep(0.3)
            with self.assertRaises(wire.Refused) as caught:
                idle.receive()
            self.assertIn("no request for 1 s", caught.exception.text)
            self.assertEqual((caught.exception.code, caught.exception.seq),
                             (wire.ERROR_SHUTTING_DOWN, 0))
            self.assertTrue(idle.at_end())
            busy.render(model)
        self.assertEqual(daemon.stop(), 0)


class Budget(unittest.TestCase):
    def test_need_and_budget_are_named(self):
        daemon = Daemon("--memory-budget", budget(4))
        with Client(daemon.unix) as client:
            model = client.upload(grid(150), "sheet.obj")
            client.send(wire.render(5, model))
            with self.assertRaises(wire.Refused) as caught:
                client.receive()
            self.assertEqual(caught.exception.code, wire.ERROR_MODEL)
            self.assertIn("sheet.obj: it needs at least ", caught.exception.text)
            self.assertIn("4194304", caught.exception.text)
            client.stats()
            seq = client.next_seq()
            client.send(wire.upload_begin(seq, bytes(32), 4194305, "long.obj"))
            with self.assertRaises(wire.Refused) as caught:
                client.receive()
            self.assertEqual(caught.exception.code, wire.ERROR_TOO_BIG)
        self.assertEqual(daemon.stop(), 0)

    def test_least_recently_used_goes_first(self):
        """The budget has room for two sheets of about 3.4 MB each with their tables, and not for three."""
        sheets = [grid(70) + f"# {i}\n".encode() for i in range(3)]
        daemon = Daemon("--memory-budget", budget(9))
        with Client(daemon.unix) as client:
            ids = [client.upload(data, f"{i}.obj") for i, data in enumerate(sheets[:2])]
            for model in ids:
                client.render(model)
            self.assertEqual(client.stats()[5], [2])
            client.render(ids[0])  # now the second model is the least recently used
            client.render(client.upload(sheets[2], "2.obj"))
            self.assertEqual(client.stats()[5], [2])
            self.assertEqual(client.render(ids[0]).tables_us, 0)
            client.send(wire.render(77, ids[1]))
            with self.assertRaises(wire.Refused) as caught:
                client.receive()
            self.assertEqual(caught.exception.code, wire.ERROR_UNKNOWN_MODEL)
            client.render(client.upload(sheets[1], "1.obj"))
        self.assertEqual(daemon.stop(), 0)


class SessionFd(unittest.TestCase):
    def start(self):
        ours, theirs = socket.socketpair()
        process = subprocess.Popen(
            [SHEEND, "--device", "software", "--session-fd", str(theirs.fileno())],
            pass_fds=[theirs.fileno()], stderr=subprocess.PIPE, text=True)
        theirs.close()
        ours.settimeout(30)
        return ours, process

    def client(self, ours):
        client = Client.__new__(Client)
        client.socket, client.seq = ours, 1
        client.send(wire.hello())
        client.expect(wire.HELLO_OK, 1)
        return client

    def test_serves_one_and_ends(self):
        ours, process = self.start()
        with self.client(ours) as client:
            client.render(client.upload(CUBE, "cube.obj"))
        self.assertEqual(process.wait(10), 0)
        self.assertEqual(process.stderr.read(), "")
        process.stderr.close()

    def test_starts_no_library_for_a_picture_of_its_own(self):
        for encoding, is_started in ((wire.PNG, False), (wire.JPEG, False), (wire.TIFF, True)):
            ours, process = self.start()
            with self.client(ours) as client:
                client.render(client.upload(CUBE, "cube.obj"), encoding=encoding)
                self.assertEqual("sheend-image" in workers(process.pid), is_started)
            self.assertEqual(process.wait(10), 0)
            process.stderr.close()

    def test_ends_when_its_client_dies_in_the_middle(self):
        ours, process = self.start()
        with self.client(ours) as client:
            client.send(wire.render(5, client.upload(grid(200), "big.obj"), 1000, 1000))
        self.assertEqual(process.wait(20), 0)
        process.stderr.close()


    def test_ends_soon_when_its_client_dies_in_a_large_frame(self):
        ours, process = self.start()
        with self.client(ours) as client:
            model = client.upload(CUBE, "cube.obj")
            client.render(model)
            client.send(b"".join(wire.render(5 + i, model, 6000, 6000, encoding=encoding)
                                 for i, encoding in enumerate((wire.PNG, wire.TIFF, wire.PNG))))
            time.sleep(0.5)
        start = time.monotonic()
        self.assertEqual(process.wait(60), 0)
        self.assertLess(time.monotonic() - start, 1.5)
        process.stderr.close()


class Load(unittest.TestCase):
    def test_clients_in_parallel(self):
        """Eight clients connect, ask and leave: every frame is right, and nothing of them remains."""
        daemon = Daemon()
        with Client(daemon.unix) as client:
            want = client.render(client.upload(CUBE, "cube.obj")).data
        wrong = []

        def work(number):
            for i in range(6):
                with Client(daemon.unix if (number + i) % 2 else daemon.tcp) as client:
                    model = client.upload(CUBE, "cube.obj")
                    for _ in range(4):
                        if client.render(model).data != want:
                            wrong.append((number, i))

        threads = [threading.Thread(target=work, args=(n,)) for n in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])
        with Client(daemon.unix) as client:
            stats = client.stats()
            self.assertEqual(stats[3], [8 * 6 * 4 + 1])
            # two models: clients of the Unix socket and of TCP are different owners
            self.assertEqual((stats[5], stats[15]), ([2], [0]))
            time.sleep(0.3)
            self.assertEqual(client.stats()[2], [1])
            descriptors = len(os.listdir(f"/proc/{daemon.process.pid}/fd"))
            self.assertLess(descriptors, 40)
        self.assertEqual(daemon.stop(), 0)

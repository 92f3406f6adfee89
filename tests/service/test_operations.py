"""What operators of the daemon rely on: service manager, reload, log, metrics, health."""
import ctypes
import fcntl
import hashlib
import json
import os
import re
import signal
import socket
import subprocess
import tempfile
import time
import unittest

import wire
from daemon import CUBE, SANITIZED, SHEEN, SHEEND, Daemon, run
from test_untrusted import children, is_alive, workers
from wire import Client


def fetch(address, request="GET /metrics HTTP/1.1\r\n\r\n", timeout=10):
    """(status, body) of a request to a tcp: or unix: address; None if the connection is closed without an answer."""
    if isinstance(request, str):
        request = request.encode()
    if address.startswith("unix:"):
        connection = socket.socket(socket.AF_UNIX)
        target = address[5:]
    else:
        connection = socket.socket()
        host, port = address[4:].rsplit(":", 1)
        target = (host, int(port))
    with connection:
        connection.settimeout(timeout)
        connection.connect(target)
        connection.sendall(request)
        answer = b""
        try:
            while part := connection.recv(65536):
                answer += part
        except ConnectionResetError:
            pass
    if not answer:
        return None
    head, body = answer.split(b"\r\n\r\n", 1)
    length = int(re.search(rb"Content-Length: (\d+)", head).group(1))
    assert length == len(body), (length, len(body))
    return int(head.split()[1]), body.decode()


def get(address, path):
    return fetch(address, f"GET {path} HTTP/1.1\r\nHost: sheen\r\n\r\n")


def metrics_address(daemon):
    return re.search(r'metrics"?[=:]"?([^"\s}]+)', daemon.errors()).group(1)


def read_metrics(text):
    """{name{labels}: value} of a text, which must follow the format's rules."""
    values, types, helped = {}, {}, set()
    label = r'[a-z_]+="(?:[^"\\\n]|\\["\\n])*"'
    sample = re.compile(rf'^([a-z_]+)(\{{{label}(?:,{label})*\}})? (\d+(?:\.\d+)?)$')
    assert text.endswith("\n")
    for line in text.splitlines():
        if line.startswith("# HELP "):
            helped.add(line.split(" ")[2])
        elif line.startswith("# TYPE "):
            _, _, name, kind = line.split(" ")
            assert name not in types and kind in ("counter", "gauge", "histogram"), line
            assert (kind == "counter") == name.endswith("_total"), line
            types[name] = kind
        else:
            found = sample.match(line)
            assert found, line
            name, labels, value = found.groups()
            assert re.sub("_(bucket|sum|count)$", "", name) in types or name in types, line
            assert name + (labels or "") not in values, line
            values[name + (labels or "")] = float(value)
    assert helped == set(types), helped ^ set(types)
    return values


class Notify:
    """A service manager's socket, and the environment that names it."""

    def __init__(self, folder, watchdog_us=0, abstract=False):
        path = os.path.join(folder, "notify")
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind("\0" + path if abstract else path)
        self.socket.settimeout(10)
        self.env = {"NOTIFY_SOCKET": ("@" if abstract else "") + path}
        if watchdog_us:
            self.env["WATCHDOG_USEC"] = str(watchdog_us)

    def next(self):
        return self.socket.recv(4096).decode()

    def count(self, seconds):
        """The number of pings within so many seconds from now."""
        self.socket.setblocking(False)
        try:
            while True:
                self.socket.recv(4096)
        except BlockingIOError:
            pass
        n, end = 0, time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            self.socket.settimeout(left)
            try:
                n += self.socket.recv(4096) == b"WATCHDOG=1"
            except TimeoutError:
                break
        return n


PTRACE_SEIZE, PTRACE_INTERRUPT, PTRACE_DETACH, WALL = 0x4206, 0x4207, 17, 0x40000000
libc = ctypes.CDLL(None, use_errno=True)


def trace(request, thread):
    if libc.ptrace(request, thread, None, None) != 0:
        raise OSError(ctypes.get_errno(), "ptrace")


def stop_thread(thread):
    trace(PTRACE_INTERRUPT, thread)
    os.waitpid(thread, WALL)


def threads(pid, name):
    """The threads of a process with this name, oldest first. A driver's threads inherit the name."""
    found = []
    for task in sorted(map(int, os.listdir(f"/proc/{pid}/task"))):
        with open(f"/proc/{pid}/task/{task}/comm", encoding="ascii") as file:
            if file.read() == name + "\n":
                found.append(task)
    return found


class ServiceManager(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def test_ready_reload_and_stop(self):
        for abstract in (False, True):
            manager = Notify(self.folder, abstract=abstract)
            daemon = Daemon(env=manager.env)
            self.assertEqual(manager.next().splitlines()[0], "READY=1")
            daemon.process.send_signal(signal.SIGHUP)
            self.assertEqual([manager.next(), manager.next()], ["RELOADING=1", "READY=1"])
            daemon.terminate()
            self.assertEqual(manager.next().splitlines()[0], "STOPPING=1")
            self.assertEqual(daemon.stop(), 0)
            manager.socket.close()

    def test_watchdog_is_fed(self):
        manager = Notify(self.folder, watchdog_us=200000)
        daemon = Daemon(env=manager.env)
        self.assertGreaterEqual(manager.count(1), 5)
        self.assertEqual(daemon.stop(), 0)
        daemon = Daemon(env={**manager.env, "WATCHDOG_PID": "1"})
        self.assertEqual(manager.count(0.5), 0)
        self.assertEqual(daemon.stop(), 0)
        manager.socket.close()

    def test_watchdog_starves_when_the_gl_thread_hangs(self):
        """ptrace stops this single thread in the middle of a frame."""
        manager = Notify(self.folder, watchdog_us=200000)
        daemon = Daemon("--stuck-after", "1", "--metrics", f"unix:{self.folder}/metrics",
                        env=manager.env)
        address = metrics_address(daemon)
        thread = threads(daemon.process.pid, "sheend-gl")[0]
        with Client(daemon.unix, timeout=60) as client:
            model = client.upload(CUBE, "cube.obj")
            client.render(model)
            trace(PTRACE_SEIZE, thread)
            client.send(wire.render(50, model, 3000, 3000))
            busy = 'sheen_thread_busy_seconds{thread="gl"}'
            while read_metrics(get(address, "/metrics")[1])[busy] == 0:
                pass
            stop_thread(thread)
            self.assertEqual(get(address, "/healthz"), (200, "ok\n"))
            daemon.wait_for("the watchdog is not fed any more")
            self.assertEqual(manager.count(1), 0)
            for path in ("/healthz", "/readyz"):
                status, text = get(address, path)
                self.assertEqual(status, 503)
                self.assertIn("the GL thread", text)
            self.assertGreater(read_metrics(get(address, "/metrics")[1])[busy], 1)
            trace(PTRACE_DETACH, thread)
            client.read_frame(50)
            daemon.wait_for("not stuck any more")
            self.assertGreaterEqual(manager.count(1), 5)
            self.assertEqual(get(address, "/healthz"), (200, "ok\n"))
        self.assertEqual(daemon.stop(), 0)
        manager.socket.close()

    def test_watchdog_starves_when_a_reader_hangs(self):
        """A daemon that waits for the process that reads a file is not stuck, because that process has its own time
        limit."""
        manager = Notify(self.folder, watchdog_us=200000)
        daemon = Daemon("--stuck-after", "1", "--metrics", f"unix:{self.folder}/metrics",
                        env=manager.env)
        address = metrics_address(daemon)
        with Client(daemon.unix, timeout=60) as client:
            model = client.upload(CUBE, "cube.obj")
            worker = workers(daemon.process.pid)["sheend-cage"]
            os.kill(worker, signal.SIGSTOP)
            self.addCleanup(lambda: is_alive(worker) and os.kill(worker, signal.SIGCONT))
            client.send(wire.render(50, model))
            time.sleep(1.5)
            self.assertEqual(get(address, "/healthz"), (200, "ok\n"))
            self.assertNotIn("not fed", daemon.errors())
            readers = threads(daemon.process.pid, "sheend-read")
            for thread in readers:
                trace(PTRACE_SEIZE, thread)
                stop_thread(thread)
            daemon.wait_for("the watchdog is not fed any more")
            self.assertEqual(manager.count(1), 0)
            status, text = get(address, "/healthz")
            self.assertEqual(status, 503)
            self.assertIn("a reader thread", text)
            busy = 'sheen_thread_busy_seconds{thread="read"}'
            self.assertGreater(read_metrics(get(address, "/metrics")[1])[busy], 1)
            os.kill(worker, signal.SIGCONT)
            for thread in readers:
                trace(PTRACE_DETACH, thread)
            client.read_frame(50)
            daemon.wait_for("not stuck any more")
        self.assertEqual(daemon.stop(), 0)
        manager.socket.close()

    def await_health(self, address, status, words):
        while True:
            answer = get(address, "/healthz")
            if answer[0] == status:
                self.assertIn(words, answer[1])
                return
            time.sleep(0.05)

    def test_health_tells_of_worker_programs(self):
        """A stopped program is replaced, and its job is done. Without its starter it cannot be: the daemon finishes what
        it does and ends, for the service manager to start another."""
        daemon = Daemon("--metrics", f"unix:{self.folder}/metrics")
        address, pid = metrics_address(daemon), daemon.process.pid
        with Client(daemon.unix, timeout=60) as client:
            model = client.upload(CUBE, "cube.obj")
            os.kill(workers(pid)["sheend-cage"], signal.SIGSTOP)
            client.send(wire.render(50, model))
            self.await_health(address, 503, "sheend-cage does not answer")
            client.read_frame(50)
            self.await_health(address, 200, "ok")
            client.seq = 50
            side = 1000 if SANITIZED else 3000
            client.send(b"".join(wire.render(60 + i, model, side, side, encoding=wire.JPEG) for i in range(2)))
            for starter in children(pid):
                os.kill(starter, signal.SIGKILL)
            log = daemon.wait_for("has died: ending with exit code 75")
            self.assertIn("sheend-cage cannot be started any more", log)
            for i in range(2):
                client.read_frame(60 + i)
            with self.assertRaises(wire.Refused) as caught:
                client.receive()
            self.assertEqual((caught.exception.seq, caught.exception.code), (0, wire.ERROR_SHUTTING_DOWN))
        self.assertEqual(daemon.wait(), 75)
        daemon.stop()

    def start_activated(self, sockets, names="", pid="os.getpid()", n=None, options=()):
        """Starts the daemon like a service manager: sockets from descriptor 3 on, and three variables."""
        high = [fcntl.fcntl(one.fileno(), fcntl.F_DUPFD, 50) for one in sockets]
        script = ("import os, sys\n"
                  f"for i, fd in enumerate({high}): os.dup2(fd, 3 + i); os.close(fd)\n"
                  f"os.environ['LISTEN_PID'] = str({pid})\n"
                  "os.execv(sys.argv[1], sys.argv[1:])\n")
        process = subprocess.Popen(
            ["/usr/bin/python3", "-c", script, SHEEND, "--device", "software", *options], pass_fds=high,
            stderr=subprocess.PIPE, text=True,
            env={**os.environ, "XDG_RUNTIME_DIR": self.folder, "LISTEN_FDNAMES": names,
                 "LISTEN_FDS": str(len(high) if n is None else n)})
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        for fd in high:
            os.close(fd)
        return process

    def test_socket_activation(self):
        path = os.path.join(self.folder, "given.sock")
        with socket.socket(socket.AF_UNIX) as unix, socket.socket() as tcp, \
                socket.socket() as web:
            unix.bind(path)
            for one in (tcp, web):
                one.bind(("127.0.0.1", 0))
            for one in (unix, tcp, web):
                one.listen()
            # A client may connect before the daemon runs; nothing that it sends is lost.
            early = Client("unix:" + path, greet=False)
            early.send(wire.hello())
            process = self.start_activated([unix, tcp, web], "sheen:sheen:metrics")
            early.expect(wire.HELLO_OK, 1)
            early.socket.close()
            self.assertIn(path, process.stderr.readline())
            for address in ("unix:" + path, f"tcp:127.0.0.1:{tcp.getsockname()[1]}"):
                with Client(address) as client:
                    client.render(client.upload(CUBE, "cube.obj"))
            status, _ = get(f"tcp:127.0.0.1:{web.getsockname()[1]}", "/metrics")
            self.assertEqual(status, 200)
            process.terminate()
            self.assertEqual(process.wait(20), 0)
            self.assertTrue(os.path.exists(path), "the socket is the service manager's")
            self.assertFalse(os.path.exists(os.path.join(self.folder, "sheen.sock")))

    def test_metrics_socket_beyond_the_loopback(self):
        """Sockets of a service manager are not more open than the daemon's own."""
        for options, answers in (((), False), (("--metrics-open",), True)):
            with self.subTest(options=options), socket.socket(socket.AF_UNIX) as unix, socket.socket() as web:
                path = os.path.join(self.folder, f"given-{answers}.sock")
                unix.bind(path)
                web.bind(("0.0.0.0", 0))
                for one in (unix, web):
                    one.listen()
                process = self.start_activated([unix, web], "sheen:metrics", options=options)
                if answers:
                    port = web.getsockname()[1]
                    self.assertIn(f"metrics=tcp:0.0.0.0:{port}\n", process.stderr.readline())
                    self.assertEqual(get(f"tcp:127.0.0.1:{port}", "/healthz")[0], 200)
                    process.terminate()
                    self.assertEqual(process.wait(20), 0)
                else:
                    self.assertEqual(process.wait(20), 2)
                    self.assertIn("--metrics-open", process.stderr.read())

    def test_sockets_for_somebody_else(self):
        """LISTEN_PID is that of another process: the environment was inherited."""
        path = os.path.join(self.folder, "given.sock")
        with socket.socket(socket.AF_UNIX) as unix:
            unix.bind(path)
            unix.listen()
            process = self.start_activated([unix], pid="1")
            line = process.stderr.readline()
            self.assertIn("sheen.sock", line)
            self.assertNotIn(path, line)
            process.terminate()
            self.assertEqual(process.wait(20), 0)

    def test_sockets_that_are_none(self):
        with socket.socket(socket.AF_UNIX) as plain, open("/dev/null", "rb") as file, \
                socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as datagrams:
            for words, sockets, n in (("no listening", [plain], None), ("no listening", [file], None),
                                      ("no listening", [datagrams], None),
                                      ("LISTEN_FDS", [], "many"), ("LISTEN_FDS", [], 33),
                                      ("LISTEN_FDS", [], -1)):
                process = self.start_activated(sockets, n=n)
                self.assertEqual(process.wait(20), 4)
                self.assertIn(words, process.stderr.read())


class Reload(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "sheend.conf")

    def write(self, *lines):
        with open(self.path, "w", encoding="ascii") as file:
            file.write("\n".join(("[sheend]", *lines, "")))

    def test_good_and_bad(self):
        self.write("idle-timeout = 1")
        daemon = Daemon("--config", self.path)

        def hang_up(words):
            before = daemon.errors().count(words)
            daemon.process.send_signal(signal.SIGHUP)
            end = time.monotonic() + 10
            while daemon.errors().count(words) == before:
                self.assertLess(time.monotonic(), end, daemon.errors())
                time.sleep(0.02)
            return daemon.errors().splitlines()[-1]

        for lines, words in ((("idle-timeout = soon",), f"{self.path}:2: idle-timeout is 'soon'"),
                             (("idle-timeout = 0", "nothing = 1"), f"{self.path}:3: unknown name"),
                             (("idle-timeout = 0", "[other]"), f"{self.path}:4: unknown section")):
            self.write(*lines, "threads = 1")
            self.assertIn(words, hang_up("the old one stays"))
        os.unlink(self.path)
        self.assertIn("cannot read", hang_up("the old one stays"))
        os.mkfifo(self.path)  # nobody writes to it
        self.assertIn("no plain file", hang_up("the old one stays"))
        os.unlink(self.path)
        with Client(daemon.unix) as idle:
            with self.assertRaises(wire.Refused) as caught:
                idle.receive()
            self.assertIn("1 s", caught.exception.text)

        self.write("idle-timeout = 0", "threads = 3", "memory-budget = 1G", "log-format = json",
                   "log-level = debug")
        daemon.wait_for("session closed")
        last = json.loads(hang_up("configuration reloaded"))
        self.assertEqual((last["level"], last["msg"]), ("info", "configuration reloaded"))
        self.assertIn('level=warn msg="options that wait for the next start" '
                      'options="threads, memory-budget"', daemon.errors())
        with Client(daemon.unix) as client:
            time.sleep(1.5)
            client.render(client.upload(CUBE, "cube.obj"))
        lines = daemon.wait_for('"session closed"').splitlines()
        self.assertIn("request answered", [json.loads(line)["msg"] for line in lines[-4:]])
        self.assertEqual(daemon.stop(), 0)

    def test_the_command_line_goes_first(self):
        self.write("idle-timeout = 7")
        daemon = Daemon("--config", self.path, "--idle-timeout", "1")
        self.write("idle-timeout = 0")
        daemon.process.send_signal(signal.SIGHUP)
        daemon.wait_for("configuration reloaded")
        with Client(daemon.unix) as idle, self.assertRaises(wire.Refused):
            idle.receive()
        self.assertEqual(daemon.stop(), 0)


class Log(unittest.TestCase):
    def test_sessions_and_requests(self):
        daemon = Daemon("--log-format", "json", "--log-level", "debug")
        with Client(daemon.unix) as client:
            model = client.upload(CUBE, "cube.obj")
            client.send(wire.render(77, model, width=0))
            with self.assertRaises(wire.Refused):
                client.receive()
            client.render(model)
        with Client(daemon.tcp) as client:
            client.send(b"\n" * 16)
            with self.assertRaises(wire.Refused):
                client.receive()
            self.assertTrue(client.at_end())
        daemon.wait_for('"reason":"protocol"')
        lines = [json.loads(line) for line in daemon.errors().splitlines()]
        opened = [line for line in lines if line["msg"] == "session opened"]
        closed = [line for line in lines if line["msg"] == "session closed"]
        refused = [line for line in lines if line["msg"] == "request refused"]
        answered = [line for line in lines if line["msg"] == "request answered"]
        self.assertEqual([line["session"] for line in opened], [1, 2])
        self.assertEqual(opened[0]["peer"],
                         f"unix uid={os.getuid()} gid={os.getgid()} pid={os.getpid()}")
        self.assertRegex(opened[1]["peer"], r"^127\.0\.0\.1:\d+$")
        self.assertEqual([(line["session"], line["reason"]) for line in closed],
                         [(1, "client"), (2, "protocol")])
        self.assertEqual((refused[0]["session"], refused[0]["request"], refused[0]["code"]),
                         (1, 77, "request"))
        self.assertIn("width", refused[0]["text"])
        self.assertEqual((refused[1]["session"], refused[1]["code"]), (2, "protocol"))
        self.assertEqual([(line["session"], line["answer"]) for line in answered],
                         [(1, "HELLO_OK"), (1, "UPLOAD_STATE"), (1, "UPLOAD_STATE"), (1, "FRAME"),
                          (2, "HELLO_OK")])
        self.assertEqual(daemon.stop(), 0)

    def test_levels(self):
        for level, there in (("error", False), ("warn", False), ("info", True)):
            path = tempfile.mkdtemp()
            process = subprocess.Popen([SHEEND, "--device", "software", "--log-level", level,
                                        "--listen", f"unix:{path}/s"], stderr=subprocess.PIPE,
                                       text=True)
            for _ in range(400):
                if os.path.exists(f"{path}/s"):
                    break
                time.sleep(0.05)
            with Client(f"unix:{path}/s") as client:
                client.stats()
            process.terminate()
            said = process.communicate(timeout=20)[1]
            os.rmdir(path)
            self.assertEqual("session opened" in said, there, said)
            self.assertEqual(said == "", not there, said)


    def test_a_reader_that_leaves(self):
        with tempfile.TemporaryDirectory() as folder:
            process = subprocess.Popen([SHEEND, "--device", "software", "--listen",
                                        f"unix:{folder}/s"], stderr=subprocess.PIPE, text=True)
            self.addCleanup(process.wait)
            self.addCleanup(process.kill)
            self.assertIn("listening", process.stderr.readline())
            process.stderr.close()
            for _ in range(3):
                with Client(f"unix:{folder}/s") as client:
                    client.stats()
            process.terminate()
            self.assertEqual(process.wait(20), 0)


class Metrics(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = Daemon("--metrics", "tcp:127.0.0.1:0")
        cls.address = metrics_address(cls.daemon)

    @classmethod
    def tearDownClass(cls):
        if cls.daemon.stop() != 0:
            raise AssertionError("the daemon did not end well")

    def test_what_they_count(self):
        before = read_metrics(get(self.address, "/metrics")[1])
        with Client(self.daemon.unix) as client:
            model = client.upload(CUBE + b"# counted\n", "cube.obj")
            for _ in range(3):
                client.render(model)
            client.send(wire.render(77, bytes(32)))
            with self.assertRaises(wire.Refused):
                client.receive()
            now = read_metrics(get(self.address, "/metrics")[1])
            self.assertEqual(now["sheen_sessions"], before["sheen_sessions"] + 1)
        change = {name: value - before[name] for name, value in now.items()}
        for name, want in (('sheen_answers_total{answer="frame"}', 3),
                           ('sheen_answers_total{answer="error"}', 1),
                           ('sheen_errors_total{code="unknown_model"}', 1),
                           ("sheen_sessions_opened_total", 1),
                           ('sheen_frame_stage_seconds_count{stage="total"}', 3),
                           ('sheen_frame_stage_seconds_bucket{stage="total",le="+Inf"}', 3),
                           ('sheen_frame_stage_seconds_count{stage="tables"}', 1),
                           ("sheen_model_cache_misses_total", 1),
                           ("sheen_model_cache_hits_total", 2),
                           ("sheen_upload_bytes_total", len(CUBE) + 10), ("sheen_models", 1)):
            self.assertEqual(change[name], want, name)
        self.assertGreater(change["sheen_sent_bytes_total"], 3 * 64 * 48 * 4)
        self.assertEqual(now["sheen_gpu_generation"], 1)
        self.assertLess(abs(now["process_start_time_seconds"] - time.time()), 600)
        self.assertGreater(now["process_resident_memory_bytes"], 1 << 20)

    def test_buckets_rise(self):
        with Client(self.daemon.unix) as client:
            client.render(client.upload(CUBE, "cube.obj"))
        _, text = get(self.address, "/metrics")
        for stage in ("tables", "visibility", "evaluate", "shade", "readback", "encode", "total"):
            found = re.findall(rf'_bucket{{stage="{stage}",le="([^"]+)"}} (\d+)', text)
            bounds = [float(le) for le, _ in found]
            counts = [int(n) for _, n in found]
            self.assertEqual(bounds, sorted(set(bounds)))
            self.assertEqual(counts, sorted(counts))
            self.assertEqual(bounds[-1], float("inf"))

    def test_health(self):
        self.assertEqual(get(self.address, "/healthz"), (200, "ok\n"))
        self.assertEqual(get(self.address, "/readyz?x=1"), (200, "ok\n"))
        self.assertEqual(get(self.address, "/other")[0], 404)

    def test_what_is_refused(self):
        for status, request in ((405, "POST /metrics HTTP/1.1\r\n\r\n"), (400, "hello\r\n\r\n"),
                                (400, "GET metrics HTTP/1.1\r\n\r\n"), (400, "GET /metrics\r\n\r\n"),
                                (400, "GET /metrics FTP/1.1\r\n\r\n"), (400, "\r\n\r\n"),
                                (400, " / HTTP/1.1\0\r\n\r\n"),
                                (431, "GET /" + 4091 * "a")):
            with self.subTest(request=request[:40]):
                self.assertEqual(fetch(self.address, request)[0], status)
        self.assertEqual(fetch(self.address, "GET /healthz HTTP/1.1\r\nA: b\r\n\r\n")[0], 200)

    def connect(self):
        host, port = self.address[4:].rsplit(":", 1)
        connection = socket.create_connection((host, int(port)), 10)
        self.addCleanup(connection.close)
        return connection

    def read_to_end(self, connection):
        """Reads to the end of the connection. A reset raises an exception."""
        answer = b""
        while part := connection.recv(65536):
            answer += part
        return answer

    def test_a_refusal_is_read_to_its_end(self):
        """The client reads the whole refusal, although the daemon has not read the whole request."""
        for status, request in ((431, b"GET / HTTP/1.1\r\nA: " + 100000 * b"a"),
                                (405, b"POST / HTTP/1.1\r\n\r\n" + 100000 * b"a")):
            connection = self.connect()
            connection.sendall(request)
            time.sleep(0.1)
            self.assertTrue(self.read_to_end(connection).startswith(b"HTTP/1.1 %d " % status))
            connection.sendall(1000 * b"a")  # the daemon still reads for a while

    def test_who_does_not_close_takes_no_place(self):
        staying = [self.connect() for _ in range(32)]
        for connection in staying:
            connection.sendall(b"GET /healthz HTTP/1.1\r\n\r\n")
            self.assertTrue(self.read_to_end(connection).endswith(b"ok\n"))
        for _ in range(2):
            self.assertEqual(get(self.address, "/healthz")[0], 200)
        start = time.monotonic()
        with self.assertRaises(OSError):  # nor does the daemon read from the last of them for long
            while True:
                staying[-1].send(b"a")
                self.assertLess(time.monotonic(), start + 5)
                time.sleep(0.05)

    def test_a_byte_at_a_time(self):
        host, port = self.address[4:].rsplit(":", 1)
        with socket.create_connection((host, int(port))) as slow:
            for byte in b"GET /healthz HTTP/1.1\r\n\r\n":
                slow.send(bytes([byte]))
                time.sleep(0.01)
            self.assertTrue(slow.recv(100).startswith(b"HTTP/1.1 200 OK\r\n"))

    def test_idle_peers_keep_no_probe_out(self):
        """The oldest connection is closed for a new one; the others have their time limit and no more."""
        silent = [self.connect() for _ in range(32)]
        start = time.monotonic()
        time.sleep(0.2)
        self.assertEqual(get(self.address, "/healthz"), (200, "ok\n"))
        silent[0].settimeout(3)
        self.assertEqual(silent[0].recv(1), b"")
        silent[1].sendall(b"GET /healthz HTTP/1.1\r\n\r\n")
        self.assertTrue(self.read_to_end(silent[1]).endswith(b"ok\n"))
        for one in silent[2:]:
            one.settimeout(15)
            self.assertEqual(one.recv(1), b"")
        self.assertGreater(time.monotonic() - start, 4)
        self.assertEqual(get(self.address, "/healthz")[0], 200)

    def test_probes_among_many_that_come_at_once(self):
        """The connections wait in the queue, the probe first, and the daemon accepts many before it looks for
        events."""
        for _ in range(3):
            self.daemon.process.send_signal(signal.SIGSTOP)
            try:
                probe = self.connect()
                probe.sendall(b"GET /healthz HTTP/1.1\r\n\r\n")
                silent = [self.connect() for _ in range(100)]
            finally:
                self.daemon.process.send_signal(signal.SIGCONT)
            self.assertTrue(self.read_to_end(probe).endswith(b"ok\n"))
            for one in silent:
                one.close()

    def test_not_ready_while_it_drains(self):
        daemon = Daemon("--metrics", "tcp:127.0.0.1:0")
        address = metrics_address(daemon)
        with Client(daemon.unix, timeout=60) as client:
            model = client.upload(CUBE, "cube.obj")
            client.send(wire.render(5, model, width=2000, height=2000))
            client.expect(wire.FRAME, 5)
            daemon.terminate()
            daemon.wait_for("shutting down")
            self.assertEqual(get(address, "/readyz"), (503, "shutting down\n"))
            self.assertEqual(get(address, "/healthz"), (200, "ok\n"))
        self.assertEqual(daemon.stop(), 0)

    def test_loopback_only(self):
        """The address that the error text advises is accepted."""
        for address in ("tcp:0.0.0.0:9477", "tcp:192.0.2.1:9477", "tcp:[::]:9477"):
            with self.subTest(address=address):
                done = run("--metrics", address, "--check-config")
                self.assertEqual(done.returncode, 2)
                host = address.replace("[", "").replace("]", "")
                self.assertIn(f"metrics go to this machine alone, and not to {host}: ", done.stderr)
                for words in ("--tls", "use tls:"):
                    self.assertNotIn(words, done.stderr)
                advised, = re.findall(r"as (tcp:\S+);", done.stderr)
                self.assertEqual(run("--metrics", advised, "--check-config").returncode, 0)
                self.assertEqual(run("--metrics", address, "--metrics-open", "--check-config").returncode, 0)
        for options in ((), ("--metrics-open",)):
            done = run("--metrics", "tls:0.0.0.0:9477", *options, "--check-config")
            self.assertEqual(done.returncode, 2)
            self.assertIn("metrics are served without TLS, and not at tls:0.0.0.0:9477", done.stderr)
        done = run("--metrics", "tcp:a..b:9477", "--check-config")
        self.assertIn("cannot find the address of 'a..b'", done.stderr)

    def test_beyond_the_loopback_when_told_to(self):
        """Allowed by an option or in the configuration. The metrics name no client."""
        with tempfile.NamedTemporaryFile("w", suffix=".conf") as config:
            config.write("metrics = tcp:0.0.0.0:0\nmetrics-open = yes\n")
            config.flush()
            for options in (("--metrics", "tcp:0.0.0.0:0", "--metrics-open"), ("--config", config.name)):
                daemon = Daemon(*options)
                address = metrics_address(daemon)
                self.assertRegex(address, r"^tcp:0\.0\.0\.0:\d+$")
                with Client(daemon.unix) as client:
                    client.render(client.upload(CUBE, "secret-car.obj"))
                    text = get(address, "/metrics")[1]
                self.assertEqual(read_metrics(text)["sheen_models"], 1)
                for name in ("secret-car", hashlib.sha256(CUBE).hexdigest(), daemon.folder, "uid"):
                    self.assertNotIn(name, text)
                for path in ("/healthz", "/readyz"):
                    self.assertEqual(get(address, path), (200, "ok\n"))
                self.assertEqual(daemon.stop(), 0)


class Stats(unittest.TestCase):
    def test_no_rate_is_of_less_than_a_second(self):
        daemon = Daemon()
        found = json.loads(subprocess.run([SHEEN, "stats", "--server", daemon.unix, "--json"],
                                          capture_output=True, text=True, timeout=60).stdout)
        # HELLO and STATS_QUERY
        self.assertGreater(found["requests_per_s"], 0)
        self.assertLessEqual(found["requests_per_s"], 2)
        self.assertEqual(daemon.stop(), 0)

    def test_rates_and_percentiles(self):
        daemon = Daemon()
        with Client(daemon.unix) as client:
            model = client.upload(CUBE, "cube.obj")
            times = sorted(client.render(model).total_us for _ in range(20))
        done = subprocess.run([SHEEN, "stats", "--server", daemon.unix, "--json"],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        stats = json.loads(done.stdout)
        self.assertAlmostEqual(stats["p50"]["total_us"], times[9], delta=times[9] * 0.035 + 1)
        self.assertAlmostEqual(stats["p99"]["total_us"], times[19], delta=times[19] * 0.035 + 1)
        self.assertLessEqual(stats["p50"]["total_us"], stats["p95"]["total_us"])
        self.assertLessEqual(stats["p95"]["total_us"], stats["p99"]["total_us"])
        # An age below a second counts as one second.
        window_s = max(stats["window_us"] / 1e6, 1)
        self.assertAlmostEqual(stats["frames_per_s"] * window_s, 20, places=6)
        self.assertGreater(stats["requests_per_s"], stats["frames_per_s"])
        latency = stats["latency"]
        self.assertEqual([latency[name]["frames"] for name in ("interactive", "still", "batch")],
                         [0, 20, 0])
        for p in "p50", "p95", "p99":
            self.assertEqual(latency["still"][p + "_us"], stats[p]["total_us"])
            self.assertEqual(latency["batch"][p + "_us"], 0)
        sent = stats["sent_bytes_per_s"] * window_s
        self.assertGreater(sent, 20 * 64 * 48 * 4)
        self.assertLessEqual(sent, stats["sent_bytes"] + 0.001)  # the rounding of a quotient
        budget = stats["budget"]
        self.assertEqual((budget["daemon"], budget["input"]), (32 << 20, 0))
        self.assertGreater(budget["assets"], len(CUBE))
        self.assertGreater(budget["device"], 64 * 48 * 100)
        parts = ("assets", "input", "interactive", "patient")
        self.assertEqual(sum(budget[part] for part in parts), stats["memory_bytes"])
        self.assertLess(sum(budget.values()) - budget["bytes"], budget["bytes"])
        table = subprocess.run([SHEEN, "stats", "--server", daemon.unix], capture_output=True,
                               text=True, timeout=60).stdout
        for words in ("frames/s", "bytes/s", "p50", "p95", "p99", "ms a frame", "interactive", "bytes of tables in main memory;",
                      "bytes uploaded, ", "bytes in use, of --memory-budget", "models and images 0.", "device time spent, s: interactive",
                      "frames that needed the stage"):
            self.assertIn(words, table)
        self.assertNotIn("GPU", table.split("models", 1)[1])
        self.assertEqual(daemon.stop(), 0)

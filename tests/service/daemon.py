"""Starting and ending the daemon under test."""
import atexit
import os
import re
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

import mesa
import wire

BUILD = os.environ["SHEEN_BUILD"]
SHEEND = os.path.join(BUILD, "sheend")
SHEEN = os.path.join(BUILD, "sheen")
DEVICE = os.environ.get("SHEEN_TEST_DEVICE", "software")
MESA = mesa.device()  # for tests of what only a GL device does
MODELS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "models")

with open(SHEEND, "rb") as _file:
    _code = _file.read()
SANITIZED = b"__asan_init" in _code or b"__tsan_init" in _code  # sanitizers keep freed memory
# Sanitizers make frames slower, so that clients wait longer. With ThreadSanitizer the daemon waits longer, too, and
# tests of time are left out.
SLOWED = b"__tsan_init" in _code
if SANITIZED:
    wire.PATIENCE = 10
LONGER = {"--drain-timeout": "300", "--stall-timeout": "300"} if SLOWED else {}
judges_time = unittest.skipIf(SLOWED, "ThreadSanitizer makes frames many times slower")

# A closed cube: small, but with extraordinary vertices.
CUBE = (b"v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
        b"f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n")


def grid(n):
    """An open sheet of n by n faces."""
    lines = [f"v {x} {y} {(x * y) % 7}" for y in range(n + 1) for x in range(n + 1)]
    for y in range(n):
        for x in range(n):
            a = y * (n + 1) + x + 1
            lines.append(f"f {a} {a + 1} {a + n + 2} {a + n + 1}")
    return ("\n".join(lines) + "\n").encode()


DAEMON_MIB = 32  # of a budget, for the daemon itself


def budget(mib):
    """--memory-budget for a daemon on processors that has so much beside itself."""
    return f"{DAEMON_MIB + mib}M"


def run(*arguments, env=None, timeout=60):
    return subprocess.run([SHEEND, *arguments], capture_output=True, text=True, timeout=timeout,
                          env={**os.environ, **(env or {})})


def resident_kb(pid):
    """The process's resident memory; 0 in a build with a sanitizer, which keeps freed memory."""
    with open(f"/proc/{pid}/status", encoding="ascii") as status:
        kb = int(next(line for line in status if line.startswith("VmRSS")).split()[1])
    return 0 if SANITIZED else kb


class Daemon:
    """A real sheend on a Unix socket and a TCP port of its own."""
    program = SHEEND

    def __init__(self, *arguments, folder=None, path=None, tcp=True, env=None, under=()):
        self.folder = folder or tempfile.mkdtemp(prefix="sheen-test-")
        self.owns_folder = folder is None
        self.path = path or os.path.join(self.folder, "sheen.sock")
        self.unix = "unix:" + self.path
        listen = ["--listen", self.unix] + (["--listen", "tcp:127.0.0.1:0"] if tcp else [])
        longer = [word for name in LONGER if name not in arguments for word in (name, LONGER[name])]
        self.stderr = tempfile.TemporaryFile("w+")
        self.process = subprocess.Popen([*under, self.program, *listen, "--device", DEVICE, *longer,
                                         *arguments],
                                        stdout=subprocess.DEVNULL, stderr=self.stderr,
                                        env={**os.environ, **(env or {})})
        atexit.register(self.process.kill)  # ends the daemon if a test fails before it stops the daemon
        banner = self.wait_for_banner()
        found = re.search(r"tcp:127\.0\.0\.1:\d+", banner)
        self.tcp = found.group() if found else None

    def errors(self):
        # Not by read(): the daemon writes where this descriptor stands.
        return os.pread(self.stderr.fileno(), 1 << 24, 0).decode()

    def wait_for(self, words, timeout=10):
        """Waits until the log has these words, and returns it."""
        end = time.monotonic() + timeout
        while words not in self.errors():
            if time.monotonic() > end:
                raise AssertionError(f"the log lacks '{words}': {self.errors()}")
            time.sleep(0.02)
        return self.errors()

    def wait_for_banner(self):
        for _ in range(600):
            text = self.errors()
            if "msg=listening" in text or '"msg":"listening"' in text:
                return text
            if self.process.poll() is not None:
                break
            time.sleep(0.05)
        raise AssertionError(f"the daemon did not start: {self.errors()}")

    def terminate(self):
        self.process.send_signal(signal.SIGTERM)

    def wait(self, timeout=60):
        return self.process.wait(timeout)

    def stop(self):
        """Ends the daemon and returns its exit code."""
        if self.process.poll() is None:
            self.terminate()
        try:
            return self.wait()
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            raise
        finally:
            atexit.unregister(self.process.kill)
            self.stderr.close()
            if self.owns_folder:
                shutil.rmtree(self.folder, ignore_errors=True)


class DaemonCase(unittest.TestCase):
    """Tests that share one daemon. After each test the daemon must still serve, and at the end exit with code 0."""
    arguments = ()

    @classmethod
    def setUpClass(cls):
        cls.daemon = Daemon(*cls.arguments)

    @classmethod
    def tearDownClass(cls):
        code = cls.daemon.stop()
        if code != 0:
            raise AssertionError(f"the daemon ended with exit code {code}")

    def addresses(self):
        return (self.daemon.unix, self.daemon.tcp)

    def assert_serves(self):
        self.assertIsNone(self.daemon.process.poll(), self.daemon.errors()
                          if self.daemon.process.poll() is not None else "")
        for address in self.addresses():
            with wire.Client(address) as client:
                frame = client.render(client.upload(CUBE, "cube.obj"))
                self.assertEqual(len(frame.data), 64 * 48 * 4)

    def tearDown(self):
        self.assert_serves()

    def assert_refused(self, client, code, words="", seq=None):
        """Expects that the next answer is this ERROR with a text of one line."""
        with self.assertRaises(wire.Refused) as caught:
            client.receive()
        self.assertEqual(caught.exception.code, code, caught.exception)
        self.assertIn(words, caught.exception.text)
        self.assertNotIn("\n", caught.exception.text)
        if seq is not None:
            self.assertEqual(caught.exception.seq, seq)

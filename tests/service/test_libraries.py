"""Machines without a library of the GPU: the daemon draws on processors, and a device that is requested by its number
is refused with one clear error, where libepoxy would abort."""
import json
import os
import subprocess
import tempfile
import unittest

from daemon import BUILD, MESA, MODELS, SANITIZED, SHEEN, SHEEND, Daemon

MISSING = (("libEGL.so.1", "libegl1"), ("libOpenGL.so.0 libGL.so.1", "libopengl0"))


@unittest.skipIf(SANITIZED, "a sanitizer's runtime is to be loaded before any other library")
class Libraries(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="sheen-test-")
        self.addCleanup(folder.cleanup)
        self.picture = os.path.join(folder.name, "a.png")
        self.socket = os.path.join(folder.name, "sheen.sock")

    def without(self, libraries):
        return {**os.environ, "LD_PRELOAD": os.path.join(BUILD, "tests", "no_library.so"),
                "SHEEN_NO_LIBRARIES": f" {libraries} "}

    def run_without(self, libraries, *command):
        return subprocess.run(command, capture_output=True, text=True, timeout=60, env=self.without(libraries))

    def assert_says(self, done, libraries, package):
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn(" or ".join(libraries.split()) + " cannot be loaded on this machine: install "
                      f"{package} (Debian)", done.stderr)

    def test_the_daemon(self):
        for libraries, package in MISSING:
            with self.subTest(libraries=libraries):
                done = self.run_without(libraries, SHEEND, "--listen", "unix:" + self.socket,
                                        "--device", MESA)
                self.assert_says(done, libraries, package)

    def test_a_private_daemon(self):
        model = os.path.join(MODELS, "plane.obj")
        for libraries, package in MISSING:
            for command in (("render", model, "-o", self.picture), ("info", model)):
                with self.subTest(libraries=libraries, command=command[0]):
                    done = self.run_without(libraries, SHEEN, *command, "--device", MESA)
                    self.assert_says(done, libraries, package)
                    self.assertEqual(done.stdout, "")
                    self.assertFalse(os.path.exists(self.picture))

    def test_one_of_two_will_do(self):
        for library in ("libOpenGL.so.0", "libGL.so.1"):
            with self.subTest(library=library):
                done = self.run_without(library, SHEEN, "render", os.path.join(MODELS, "plane.obj"),
                                        "-o", self.picture, "--size", "64x48", "--device", MESA)
                self.assertEqual(done.returncode, 0, done.stderr)
                os.unlink(self.picture)

    def test_processors_take_none(self):
        every = " ".join(libraries for libraries, _ in MISSING)
        for device in ("auto", "software", "native"):
            with self.subTest(device=device):
                done = self.run_without(every, SHEEN, "render", os.path.join(MODELS, "plane.obj"), "-o", self.picture,
                                        "--size", "64x48", "--device", device, "--json")
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertRegex(json.loads(done.stdout)["device"], "^native ")
                daemon = Daemon("--device", device, env=self.without(every))
                self.assertRegex(daemon.errors(), 'device="native ')
                self.assertEqual(daemon.stop(), 0)

"""Machines that lack a library of the GPU's: one clear error, where libepoxy would abort."""
import os
import subprocess
import tempfile
import unittest

from daemon import BUILD, MODELS, SANITIZED, SHEEN, SHEEND

MISSING = (("libEGL.so.1", "libegl1"), ("libOpenGL.so.0 libGL.so.1", "libopengl0"))


@unittest.skipIf(SANITIZED, "a sanitizer's runtime is to be loaded before any other library")
class Libraries(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="sheen-test-")
        self.addCleanup(folder.cleanup)
        self.picture = os.path.join(folder.name, "a.png")
        self.socket = os.path.join(folder.name, "sheen.sock")

    def run_without(self, libraries, *command):
        env = {**os.environ, "LD_PRELOAD": os.path.join(BUILD, "tests", "no_library.so"),
               "SHEEN_NO_LIBRARIES": f" {libraries} "}
        return subprocess.run(command, capture_output=True, text=True, timeout=60, env=env)

    def assert_says(self, done, libraries, package):
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn(" or ".join(libraries.split()) + " cannot be loaded on this machine: install "
                      f"{package} (Debian)", done.stderr)

    def test_the_daemon(self):
        for libraries, package in MISSING:
            with self.subTest(libraries=libraries):
                done = self.run_without(libraries, SHEEND, "--listen", "unix:" + self.socket)
                self.assert_says(done, libraries, package)

    def test_a_private_daemon(self):
        model = os.path.join(MODELS, "plane.obj")
        for libraries, package in MISSING:
            for command in (("render", model, "-o", self.picture), ("info", model)):
                with self.subTest(libraries=libraries, command=command[0]):
                    done = self.run_without(libraries, SHEEN, *command)
                    self.assert_says(done, libraries, package)
                    self.assertEqual(done.stdout, "")
                    self.assertFalse(os.path.exists(self.picture))

    def test_one_of_two_will_do(self):
        for library in ("libOpenGL.so.0", "libGL.so.1"):
            with self.subTest(library=library):
                done = self.run_without(library, SHEEN, "render", os.path.join(MODELS, "plane.obj"),
                                        "-o", self.picture, "--size", "64x48")
                self.assertEqual(done.returncode, 0, done.stderr)
                os.unlink(self.picture)

"""The native device as its users choose it: number of threads and instruction set."""
import hashlib
import json
import os
import platform
import subprocess
import tempfile
import unittest

from daemon import BUILD, MODELS, Daemon
from test_client import sheen

BODY = os.path.join(MODELS, "body.obj")
ISAS = {"v2": "native SSE4.2", "v3": "native AVX2", "v4": "native AVX-512"}
X86 = platform.machine() == "x86_64"


def flags():
    with open("/proc/cpuinfo", encoding="ascii") as cpu:
        return next(line for line in cpu if line.startswith("flags")).split()


def has(isa):
    return {"v2": "sse4_2", "v3": "avx2", "v4": "avx512bw"}[isa] in flags()


class Chosen(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.picture = os.path.join(folder.name, "a.exr")

    def render(self, *arguments):
        """The object of --json, and the SHA-256 of the file."""
        done = sheen("render", BODY, "-o", self.picture, "--size", "300x200", "--device", "native", "--aov",
                     "P,N,ptex,light,k,coverage", "--json", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.picture, "rb") as file:
            return json.loads(done.stdout), hashlib.sha256(file.read()).hexdigest()

    def test_frames_are_the_same_for_any_number_of_threads(self):
        files = set()
        for n in (1, 2, 5, 64):
            said, file = self.render("--native-threads", str(n))
            self.assertEqual((said["threads"], said["software"]), (n, True))
            files.add(file)
        self.assertEqual(len(files), 1)

    def test_as_many_threads_as_processors(self):
        every = os.sched_getaffinity(0)
        self.addCleanup(os.sched_setaffinity, 0, every)
        self.assertIn(self.render()[0]["threads"], range(1, len(every) + 1))
        os.sched_setaffinity(0, {min(every)})
        self.assertEqual(self.render()[0]["threads"], 1)

    @unittest.skipUnless(X86, "instruction sets are x86-64's")
    def test_instruction_sets(self):
        found = {isa: self.render("--native-isa", isa) for isa in ISAS if has(isa)}
        for isa, (said, _) in found.items():
            self.assertEqual(said["device"], ISAS[isa])
        widest = list(found)[-1]
        for arguments in ((), ("--native-isa", "auto"), ("--native-isa", widest)):
            said, file = self.render(*arguments)
            self.assertEqual((said["device"], file), (ISAS[widest], found[widest][1]))

    @unittest.skipUnless(X86, "instruction sets are x86-64's")
    def test_a_processor_that_lacks_the_set(self):
        faults = {**os.environ, "SHEEN_DAEMON": os.path.join(BUILD, "sheend-faults"),
                  "SHEEN_FAULTS": "native.v4:1:9"}
        wanted = ("this processor lacks the instructions v4 of --native-isa; the widest that it has and "
                  "sheen draws by: v3\n")
        done = sheen("render", BODY, "-o", self.picture, "--device", "native", "--native-isa", "v4", env=faults)
        self.assertEqual((done.returncode, done.stderr), (5, "sheen: " + wanted))
        done = subprocess.run([faults["SHEEN_DAEMON"], "--listen", "unix:" + self.picture, "--device", "native",
                               "--native-isa", "v4"], env=faults, capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 5)
        self.assertTrue(done.stderr.endswith("sheend: " + wanted), done.stderr)
        if has("v3"):  # the set of this processor is accepted without a notice
            done = sheen("render", BODY, "-o", self.picture, "--device", "native", "--size", "64x48", "--json",
                         env=faults)
            self.assertEqual(json.loads(done.stdout)["device"], ISAS["v3"], done.stderr)

    def test_info_names_the_device(self):
        done = sheen("info", BODY, "--device", "native", "--json")
        self.assertEqual({key: json.loads(done.stdout)[key] for key in ("device", "software")},
                         {"device": self.render()[0]["device"], "software": True})
        self.assertRegex(sheen("info", BODY, "--device", "native").stdout, r"(?m)^device +native .+ \(sheen .+\)$")

    def test_wrong_values(self):
        for words, *arguments in (("native-threads", "--native-threads", "0"),
                                  ("native-threads", "--native-threads", "65"),
                                  ("native-threads", "--native-threads", "-1"),
                                  ("native-isa", "--native-isa", "avx2")):
            done = sheen("render", BODY, "-o", self.picture, *arguments)
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)
            done = subprocess.run([os.path.join(BUILD, "sheend"), *arguments], capture_output=True, text=True,
                                  timeout=60)
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)

    def test_of_a_daemon_of_ones_own_alone(self):
        for arguments in (("--native-threads", "2"), ("--native-isa", "v2")):
            done = sheen("render", BODY, "-o", self.picture, "--server", "unix:/nowhere", *arguments)
            self.assertEqual(done.returncode, 2)
            self.assertIn("are for a private daemon", done.stderr)

    def test_stats(self):
        daemon = Daemon("--device", "native", "--native-threads", "3")
        self.addCleanup(daemon.stop)
        done = sheen("stats", "--server", daemon.unix, "--json")
        self.assertEqual(json.loads(done.stdout)["threads"], 3)
        self.assertRegex(sheen("stats", "--server", daemon.unix).stdout,
                         r"(?m)^device +native .*, software, 3 threads$")

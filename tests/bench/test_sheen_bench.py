"""test_sheen_bench.py BUILD: build/sheen-bench runs, writes figures, and needs only EGL, libepoxy and the C
library; and every program of `make bench` runs with the options that it has by itself."""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv.pop())
PROGRAM = str(BUILD / "sheen-bench")
MAY_NEED = {"linux-vdso.so.1", "libc.so.6", "libm.so.6", "libdl.so.2", "libepoxy.so.0", "libEGL.so.1",
            "libGLdispatch.so.0"}
# libraries that a build with sanitizers adds
SANITIZERS = {"libasan.so.8", "libubsan.so.1", "libstdc++.so.6", "libgcc_s.so.1"}


def run(*arguments):
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, timeout=300)


class Bench(unittest.TestCase):
    def test_needs_no_other_library(self):
        listed = subprocess.run(["ldd", PROGRAM], capture_output=True, text=True, check=True).stdout
        needed = {re.split(r"[ (]", line.strip())[0] for line in listed.splitlines()}
        needed = {name for name in needed if not name.startswith("/lib")}
        self.assertIn("libepoxy.so.0", needed)
        may = MAY_NEED | SANITIZERS if "sanitize" in BUILD.parts else MAY_NEED
        self.assertEqual(needed - may, set())

    def test_measures_a_cage(self):
        with tempfile.TemporaryDirectory() as folder:
            ran = run("frame", "tests/models/plane.obj", "--device", "software", "--runs", "1",
                      "--folder", folder)
            self.assertEqual((ran.returncode, ran.stderr), (0, ""))
            kept = json.loads(pathlib.Path(folder, "sheen-bench_frame.json").read_text())
        figures = kept["figures"]
        self.assertIn("native", kept["device"])
        for size in "640x480", "1280x720", "1920x1080":
            self.assertGreater(figures[f"plane {size} covered pixels"], 1000)
            for stage in "visibility", "evaluate", "shade", "frame", "aliased", "all":
                self.assertGreater(figures[f"plane {size} {stage}_ms"], 0)
            self.assertGreater(figures[f"plane {size} wall_ms"], figures[f"plane {size} frame_ms"])
            self.assertIn(size, ran.stdout)
        self.assertNotIn("3840x2160", ran.stdout)
        self.assertFalse([name for name in figures if "Embree" in name or "ratio" in name])

    def test_names_what_it_measures(self):
        told = run("--help")
        self.assertEqual(told.returncode, 0)
        self.assertEqual(re.findall(r"^  ([a-z]+) ", told.stdout, re.M),
                         ["closeup", "frame", "light", "paper", "size", "tables"])

    def test_refuses(self):
        for arguments, code, says in (
            ([], 2, "--help"),
            (["speed"], 2, "'speed' is nothing to measure"),
            (["frame", "--speed", "9"], 2, "no option --speed"),
            (["frame", "--runs"], 2, "--runs needs a value"),
            (["frame", "--runs", "x"], 2, "--runs x is no number"),
            (["frame", "nowhere.obj"], 1, "no model is there"),
            (["frame", "tests/models/fender.gltf"], 1, "reads OBJ alone"),
            (["frame", "tests/models/plane.obj", "--device", "none"], 1, "'none'"),
        ):
            with self.subTest(arguments):
                ran = run(*arguments)
                self.assertEqual(ran.returncode, code)
                self.assertIn(says, ran.stderr)


@unittest.skipIf({"sanitize", "thread"} & set(BUILD.parts), "the peers lose memory of their own")
class Defaults(unittest.TestCase):
    """On the device that a user gets who names none, with few runs and small models."""
    MODELS = ["tests/models/plane.obj"]
    OPTIONS = {"wire": [*MODELS, "--frames", "1"], "size": ["--faces", "1024"], "comparison": [*MODELS, "--samples", "10000"], "worker": [], "paper": [], "closeup": []}

    def test_every_program_measures(self):
        programs = sorted(path for path in (BUILD / "tests").glob("bench_*") if "." not in path.name)
        self.assertEqual(len(programs), len(list(pathlib.Path("tests/bench").glob("bench_*.cpp"))))
        for program in programs:
            question = program.name.removeprefix("bench_")
            with self.subTest(question), tempfile.TemporaryDirectory() as folder:
                ran = subprocess.run([program, "--runs", "1", "--folder", folder, *self.OPTIONS.get(question, self.MODELS)],
                                     capture_output=True, text=True, timeout=300)
                self.assertEqual((ran.returncode, ran.stderr), (0, ""))
                figures = json.loads(pathlib.Path(folder, f"{program.name}.json").read_text())["figures"]
                self.assertGreater(len(figures), 1)


result = unittest.main(exit=False).result
bad = len(result.failures) + len(result.errors)
print(f"{result.testsRun - bad} passed, {bad} failed")
sys.exit(bad != 0)

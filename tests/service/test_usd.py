"""USD through the command and the daemon: a cage in USD and the same cage in OBJ give the same picture, and files that
are refused cost one line and exit code 3. What the reader takes is tested by tests/unit/test_cage_usd*.c."""
import json
import os
import tempfile
import unittest

from daemon import MODELS, SHEEN, Daemon
from png import read_png
from sheen.errors import BadArgument
from sheen.files import weld
from test_client import sheen

REFUSED = {
    "empty.usda": b"",
    "cut.usda": b"#usda 1.0\ndef Mesh \"m\" {\n point3f[] points = [(0, 0, 0), (1,",
    "other.usda": b"v 0 0 0\n",
    "binary.usdc": b"PXR-USDC" + bytes(80),
    "binary.usd": b"PXR-USDC" + bytes(80),
    "package.usdz": b"PK\3\4" + bytes(80),
    "zeros.usda": b"#usda 1.0\n" + bytes(80),
    "control.usda": b"#usda 1.0\ndef \"\x1b[31m\n\" {}\n",
    "reference.usda": b"#usda 1.0\ndef \"a\" (references = @../../etc/passwd@) {}\n",
    "polygons.usda": b"#usda 1.0\ndef Mesh \"m\" { point3f[] points = [(0,0,0),(1,0,0),(0,1,0)]\n"
                     b"int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0,1,2]\n"
                     b"uniform token subdivisionScheme = \"none\" }\n",
    "deep.usda": b"#usda 1.0\n" + b"def \"a\" { " * 100000,
    "deep_value.usda": b"#usda 1.0\ndef \"a\" { int b = " + b"[" * 100000,
}


@unittest.skipUnless(os.path.exists(SHEEN), "no client in this build")
class Usd(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.daemon = Daemon()

    @classmethod
    def tearDownClass(cls):
        status = cls.daemon.stop()
        cls.folder.cleanup()
        if status != 0:
            raise AssertionError("the daemon did not end well")

    def write(self, name, data):
        path = os.path.join(self.folder.name, name)
        with open(path, "wb") as file:
            file.write(data)
        return path

    def run_sheen(self, *arguments, code=0):
        done = sheen(*arguments, "--server", self.daemon.unix)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def test_same_picture(self):
        obj, usd = (os.path.join(MODELS, name) for name in ("creases.obj", "creases.usda"))
        pictures, models = [], []
        for model in (obj, usd):
            out = os.path.join(self.folder.name, "out.png")
            self.run_sheen("render", model, "--up", "z", "--size", "320x240", "-o", out)
            pictures.append(read_png(out))
            models.append(json.loads(self.run_sheen("info", model, "--json").stdout))
        self.assertEqual(pictures[0], pictures[1])
        for key in models[0].keys() - {"sha256", "name", "file_bytes", "tables_us"}:
            self.assertEqual(models[0][key], models[1][key], key)

    def test_up_of_the_file(self):
        quad = (b'#usda 1.0\n( upAxis = "%c" )\ndef Mesh "m" { point3f[] points = [(0,0,0),(4,0,0),(4,1,2),(0,1,2)]\n'
                b"int[] faceVertexCounts = [4]\nint[] faceVertexIndices = [0,1,2,3] }\n")
        for axis, up in ((b"Y", [0, 1, 0]), (b"Z", [0, 0, 1])):
            model = self.write("up.usda", quad % axis)
            out = os.path.join(self.folder.name, "up.png")
            answer = json.loads(self.run_sheen("render", model, "-o", out, "--size", "32x24", "--json").stdout)
            self.assertEqual((answer["up"], answer["up_source"]), (up, "file"))

    def test_refused(self):
        for name, data in REFUSED.items():
            with self.subTest(name):
                done = self.run_sheen("info", self.write(name, data), code=3)
                self.assertEqual(done.stdout, "")
                self.assertRegex(done.stderr, r"\Asheen: [^\n]*" + name.replace(".", r"\.") + r"[:\d]*: [^\n\x1b]+\n\Z")

    def test_weld_is_for_obj(self):
        model = os.path.join(MODELS, "creases.usda")
        self.assertIn("--weld is for OBJ", self.run_sheen("info", model, "--weld", code=2).stderr)
        for name, data in (("a.usda", b""), ("a", b"#usda 1.0\n"), ("a", b"PXR-USDC")):
            self.assertRaisesRegex(BadArgument, "weld is for OBJ", weld, name, data)


if __name__ == "__main__":
    unittest.main()

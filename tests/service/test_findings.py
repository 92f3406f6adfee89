"""Probable mistakes in a model's file are reported once, and the model is drawn all the same."""
import json
import os
import tempfile
import unittest

import wire
from daemon import CUBE, SHEEN, Daemon
from test_client import sheen

HEAD = CUBE[:CUBE.index(b"f ")]  # 8 vertices; the faces are lines 9 to 14
FLIPPED = CUBE.replace(b"f 5 6 7 8", b"f 8 7 6 5")
INSIDE_OUT = HEAD + b"\n".join(b"f " + b" ".join(reversed(line.split()[1:]))
                               for line in CUBE[len(HEAD):].splitlines()) + b"\n"
TRIANGLES = HEAD + b"f 1 4 3\nf 1 3 2\nf 5 6 7\nf 5 7 8\n"

# For each case: the file, its number of faces, and the findings as (kind, count, line).
CASES = {
    "repeated": (CUBE.replace(b"f 4 1 5 8", b"f 4 1 5 5\nf 4 5 8"), 7, [("repeated-corner", 1, 14)]),
    "two": (CUBE + b"f 2 5\nf 1 1 2\n", 6, [("few-corners", 2, 15)]),
    "keyhole": (CUBE + b"f 1 2 6 2 5\n", 6, [("keyhole", 1, 15)]),
    "crease": (CUBE + b"t crease 2/1/0 4 5 3\nt crease 2/1/0 0 6 3\n", 6,
               [("crease-without-edge", 1, 16)]),
    "corner": (CUBE + b"t corner 1/1/0 8 3\n", 6, [("corner-without-vertex", 1, 15)]),
    "hole": (CUBE + b"t hole 1/0/0 6\n", 6, [("hole-without-face", 1, 15)]),
    "triangles": (TRIANGLES, 4, [("triangles", 4, None)]),
    "flipped": (FLIPPED, 6, [("wound-against", 4, 10)]),
    "twice": (CUBE + b"f 6 7 8 5\n", 7, [("face-twice", 1, 15)]),
    "inside": (INSIDE_OUT, 6, [("inside-out", 1, 9)]),
    "good": (CUBE, 6, []),
    "two-kinds": (FLIPPED + b"f 2 5\n", 6, [("few-corners", 1, 15), ("wound-against", 4, 10)]),
}


def apart(obj):
    """The same faces, each with vertices of its own."""
    vertices = [line for line in obj.splitlines() if line.startswith(b"v ")]
    lines, faces = [], []
    for line in obj.splitlines():
        if line.startswith(b"f "):
            corners = line.split()[1:]
            faces.append(b"f " + b" ".join(b"%d" % (len(lines) + i + 1) for i in range(len(corners))))
            lines += [vertices[int(corner) - 1] for corner in corners]
    return b"\n".join(lines + faces) + b"\n"


@unittest.skipUnless(os.path.exists(SHEEN), "no client in this build")
class Findings(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.models = tempfile.TemporaryDirectory()
        with open(os.path.join(cls.models.name, "apart.obj"), "wb") as file:
            file.write(apart(CUBE))
        with open(os.path.join(cls.models.name, "tagged.obj"), "wb") as file:
            file.write(apart(CUBE) + b"t weld 0/0/0\n")
        cls.daemon = Daemon("--models", cls.models.name)

    @classmethod
    def tearDownClass(cls):
        status = cls.daemon.stop()
        cls.models.cleanup()
        if status != 0:
            raise AssertionError("the daemon did not end well")

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def write(self, name, data):
        path = os.path.join(self.folder, name)
        with open(path, "wb") as file:
            file.write(data)
        return path

    def run_sheen(self, *arguments, code=0):
        done = sheen(*arguments, "--server", self.daemon.unix)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def info(self, *arguments):
        done = self.run_sheen("info", *arguments, "--json")
        return json.loads(done.stdout), done.stderr.splitlines()

    def test_every_kind(self):
        for name, (data, faces, findings) in CASES.items():
            with self.subTest(name=name):
                model = self.write(name + ".obj", data)
                info, lines = self.info(model)
                self.assertEqual(info["faces"], faces)
                self.assertEqual([(found["kind"], found["count"], found.get("line"))
                                  for found in info["findings"]], findings)
                self.assertEqual(len(info["warnings"]), len(findings))
                self.assertEqual(lines, ["sheen: warning: " + line for line in info["warnings"]])
                for line, (_, _, place) in zip(info["warnings"], findings):
                    self.assertTrue(line.startswith(f"{name}.obj:{place or ''}"), line)
                done = self.run_sheen("render", model, "-o", os.path.join(self.folder, "a.png"),
                                      "--size", "64x48")
                self.assertEqual([line for line in done.stderr.splitlines() if "warning" in line],
                                 lines)

    def test_no_face_is_left(self):
        for data, what in ((HEAD + b"f 2 5\n", "fewer than 3"), (HEAD + b"f 1 2 3 1 5 6\n", "keyhole")):
            done = self.run_sheen("info", self.write("none.obj", data), code=3)
            self.assertIn("none.obj:9: no face of 1 can be drawn", done.stderr)
            self.assertIn(what, done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1)

    def test_weld(self):
        """With and without --weld one file is two models, each with its own answer, whichever came first."""
        model = self.write("apart.obj", apart(CUBE))
        pictures = {}
        for options in (("--weld",), (), ("--weld",), ()):
            info, lines = self.info(model, *options)
            self.assertEqual(info["vertices"], 8 if options else 24)
            self.assertEqual([found["kind"] for found in info["findings"]],
                             [] if options else ["unwelded"])
            self.assertEqual(len(lines), 0 if options else 1)
            output = os.path.join(self.folder, "a.png")
            self.run_sheen("render", model, "-o", output, "--size", "64x48", *options)
            with open(output, "rb") as file:
                self.assertEqual(pictures.setdefault((info["sha256"], options), file.read()),
                                 pictures[info["sha256"], options])
        self.assertEqual(len(pictures), 2)
        self.assertEqual(info["findings"], [{"kind": "unwelded", "count": 16}])

    def test_weld_where_it_does_not_belong(self):
        for model in (self.write("a.gltf", b"{}"), self.write("a.glb", b"glTF"),
                      self.write("unnamed", b" \n{}"), "server:apart.obj"):
            done = self.run_sheen("info", model, "--weld", code=2)
            self.assertIn("--weld is for", done.stderr)
        self.assertEqual(self.info("server:apart.obj")[0]["vertices"], 24)
        self.assertEqual(self.info("server:tagged.obj")[0]["vertices"], 8)

    def test_weld_after_a_continued_line(self):
        for end in (b"\\", b"# \\", b"\\\n", b""):
            model = self.write("end.obj", apart(CUBE).rstrip(b"\n") + b" " + end)
            self.assertEqual(self.info(model, "--weld")[0]["vertices"], 8)

    def test_on_the_wire(self):
        with wire.Client(self.daemon.unix) as client:
            info = client.query(client.upload(FLIPPED, "flipped.obj"))
            self.assertEqual([wire.decode(body) for body in info[31]], [{1: [8], 2: [4], 3: [10]}])


if __name__ == "__main__":
    unittest.main()

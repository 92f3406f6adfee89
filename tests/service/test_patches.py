"""Models of patches through the programs: what info counts, what breaks, comparison and lines say of them, and how damaged
files end."""
import json
import math
import os
import random
import subprocess
import tempfile
import unittest

from daemon import MODELS, SHEEN, DaemonCase
from png import read_png

BOTTLE = os.path.join(MODELS, "bottle.bpt")


def strip(bend):
    """Two Bezier patches with a common curve, along which normals agree; the curvature jumps there if `bend` is not 0."""
    lines = ["2"]
    for patch in range(2):
        lines.append("2 1")
        lines += [f"{patch + i / 2} {y} {bend * (patch == 1 and i == 2)}" for y in range(2) for i in range(3)]
    return "\n".join(lines) + "\n"


def spindle(height):
    """A closed surface of eight patches around z, with a pole at each end."""
    rows = ((1, 0), (1, height / 3), (0.5, 0.6 * height), (0, height))
    bend = 4 / 3 * math.tan(math.pi / 8)
    lines = ["8"]
    for k in range(8):
        sine, cosine = round(math.sin(k * math.pi / 2)), round(math.cos(k * math.pi / 2))
        arc = [(cosine * x - sine * y, sine * x + cosine * y) for x, y in ((1, 0), (1, bend), (bend, 1), (0, 1))]
        lines.append("3 3")
        for x, y, radius, z in ((x, y, radius, z) for radius, z in rows for x, y in (arc if k < 4 else arc[::-1])):
            lines.append(f"{radius * x} {radius * y} {z if k < 4 else -z}")
    return "\n".join(lines) + "\n"


@unittest.skipUnless(os.path.exists(SHEEN), "no client in this build")
class Patches(DaemonCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name

    def write(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def sheen(self, *arguments, code=0):
        done = subprocess.run([SHEEN, *arguments, "--server", self.daemon.unix], capture_output=True, text=True,
                              timeout=120)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def test_info(self):
        info = json.loads(self.sheen("info", BOTTLE, "--json").stdout)
        expected = {"patches": 28, "faces": 0, "vertices": 0, "ptex_faces": 28, "regular_patches": 28,
                    "boundary_edges": 4, "nonmanifold_edges": 0, "findings": []}
        self.assertEqual({key: info[key] for key in expected}, expected)
        self.assertIn("patches          28 bicubic", self.sheen("info", BOTTLE).stdout)

    def test_breaks(self):
        for bend, kinds in ((0, []), (0.1, ["joint"])):
            path = self.write("strip.bpt", strip(bend))
            found = json.loads(self.sheen("breaks", path, "--json", code=1 if bend else 0).stdout)
            self.assertEqual([edge["kind"] for edge in found["edges"]], kinds)
            self.assertEqual(found["counts"]["borders"], 6)
            for edge in found["edges"]:
                self.assertLess(edge["angle_deg"]["value"], 1e-4)
                # z = bend t^2 with t along x, so that the curvature is 2 bend beside nothing.
                self.assertAlmostEqual(edge["curvature"]["value"], 2 * bend, delta=1e-4)

    def test_comparison(self):
        same = json.loads(self.sheen("compare", BOTTLE, BOTTLE, "--json").stdout)
        self.assertEqual(same["verdict"], "same")
        with open(BOTTLE, encoding="utf-8") as file:
            lines = file.read().splitlines()
        moved = self.write("moved.bpt", "\n".join(
            line if line.count(" ") != 2 or line[0] == "#" else line.split(" ", 1)[0] + " " +
            str(float(line.split()[1]) + 0.5) + " " + line.split()[2] for line in lines))
        self.sheen("compare", BOTTLE, moved, code=1)

    def test_a_pole_is_no_border(self):
        """The tip of the longer spindle lies beyond that of the shorter one, where no line along its normals leads to:
        its counterpart is the tip, because the surface does not end there."""
        longer, shorter = self.write("longer.bpt", spindle(1)), self.write("shorter.bpt", spindle(0.95))
        info = json.loads(self.sheen("info", longer, "--json").stdout)
        self.assertEqual((info["patches"], info["boundary_edges"], info["nonmanifold_edges"]), (8, 0, 0))
        for old, new in ((longer, shorter), (shorter, longer)):
            pair, = json.loads(self.sheen("compare", old, new, "--samples", "20000", "--json", code=1).stdout)["pairs"]
            for side in ("old", "new"):
                self.assertEqual(pair[side + "_samples"]["uncovered_area"], 0)
            self.assertAlmostEqual(abs(pair["measures"]["distance"]["worst"]), 0.05, delta=1e-3)

    def test_a_model_of_no_usual_size(self):
        """A camera or a light that is chosen by the model cannot have its size. Given ones are used."""
        huge = self.write("huge.patches", "patches 1\nbezier 1 1\n-9e29 -9e29 0  9e29 -9e29 0  -9e29 9e29 0  9e29 9e29 1e29\n")
        for command in (["lines", huge, "-o", os.path.join(self.folder, "huge.svg")], ["breaks", huge],
                        ["compare", huge, huge], ["compare", BOTTLE, huge, "--eye", "0,0,1e31"]):
            done = self.sheen(*command, code=2)
            if command[1] == huge:
                self.assertRegex(done.stderr, "the model's box has a diagonal of .* for which no camera can be chosen .*: "
                                              "scale the model, or give the camera")
            self.assertEqual(len(done.stderr.splitlines()), 1)
        given = ["--eye=0,0,1e30", "--target=0,0,0", "--up=0,1,0", "--light=rectangle", "--light-center=0,0,1e30",
                 "--light-u=1e18,0,0", "--light-v=0,1e18,0", "--json"]
        same, = json.loads(self.sheen("compare", huge, huge, "--samples", "2000", *given).stdout)["pairs"]
        self.assertEqual(same["verdict"], "same")
        self.assertAlmostEqual(same["old_samples"]["area"] / 3.24e60, 1, delta=0.01)
        self.assertGreater(same["floor"]["distance"], 1e20)
        self.sheen("breaks", huge, *given)

    def test_lines(self):
        """Of the bottle without its bottom: lines go on across smooth joints, so that they end at open borders, or
        where no ray meets the light."""
        with open(BOTTLE, encoding="utf-8") as file:
            lines = file.read().splitlines()[2:]
        patches = [lines[1 + 17 * k:18 + 17 * k] for k in range(28) if k % 7]
        model = self.write("open.bpt", "\n".join(["24"] + [line for patch in patches for line in patch]))
        path = os.path.join(self.folder, "lines.json")
        self.sheen("lines", model, "-o", path, "--up", "y", "--lines", "isophote", "--at", "0.4,0.5,0.6")
        with open(path, encoding="utf-8") as file:
            found = json.load(file)
        self.assertEqual(found["counts"]["marks"], 0)
        self.assertGreater(found["counts"]["curves"], 0)
        faces = set()
        for curve in found["curves"]:
            faces |= {point["face"] for point in curve["points"]}
            for point in () if curve["closed"] else (curve["points"][0], curve["points"][-1]):
                self.assertTrue(abs(point["position"][1] - 184) < 1e-3 or abs(point["position"][1] - 2) < 1e-3, point)
        self.assertGreater(len(faces), 8)

    def test_lines_without_a_normal(self):
        """The normal of a patch whose points lie on one line is little more than rounding, so that its lines wind without
        end. What is undecided is marked, and the work has a limit. A request that is late keeps nobody waiting."""
        points = []
        for row in range(4):
            for column in range(4):
                t = 0.037 * column + 0.091 * row
                points.append(f"{0.3 + t} {-0.2 + 7 * t} {0.17 + 3 * t}")
        model = self.write("line.patches", "\n".join(["patches 1", "bezier 3 3"] + points) + "\n")
        path = os.path.join(self.folder, "line.json")
        done = self.sheen("lines", model, "-o", path, "--deadline", "1", code=4)
        self.assertIn("within --deadline 1 ", done.stderr)
        self.sheen("lines", model, "-o", path)
        with open(path, encoding="utf-8") as file:
            counts = json.load(file)["counts"]
        self.assertGreater(counts["marks"], 0)
        self.assertLess(counts["points"], 1 << 18)

    def test_each_form_draws_the_same(self):
        """One bicubic patch as Bezier patch in three files, as B-spline, Hermite and bicubically blended Coons patch."""
        noise = random.Random(5)
        net = [[i / 3, j / 3, noise.uniform(-0.3, 0.3)] for j in range(4) for i in range(4)]

        def difference(at, beside, factor):
            return [factor * (a - b) for a, b in zip(net[at], net[beside])]

        def text(rows):
            return "\n".join(" ".join(repr(float(x)) for x in row) for row in rows) + "\n"

        def to_spline(b):  # server/surface/README.md, equation 17
            return [[6 * p - 7 * q + 2 * r for p, q, r in zip(b[0], b[1], b[2])],
                    [2 * p - q for p, q in zip(b[1], b[2])], [2 * q - p for p, q in zip(b[1], b[2])],
                    [2 * p - 7 * q + 6 * r for p, q, r in zip(b[1], b[2], b[3])]]

        rows = [to_spline(net[4 * j:4 * j + 4]) for j in range(4)]
        columns = [to_spline([row[i] for row in rows]) for i in range(4)]
        spline = [columns[i][j] for j in range(4) for i in range(4)]
        corners = []
        for at, x, y in ((0, 1, 4), (3, -1, 4), (12, 1, -4), (15, -1, -4)):
            sx, sy = x, y // 4
            twist = [9 * sx * sy * (a - b - c + d) for a, b, c, d in
                     zip(net[at + x + y], net[at + x], net[at + y], net[at])]
            corners += [net[at], difference(at + x, at, 3 * sx), difference(at + y, at, 3 * sy), twist]
        sides = [(range(0, 4), 4), (range(12, 16), -4), (range(0, 16, 4), 1), (range(3, 16, 4), -1)]
        curves = "".join("3\n" + text([net[k] for k in side]) for side, _ in sides)
        across = "".join("3\n" + text([difference(k + inwards, k, 3 if inwards > 0 else -3) for k in side])
                         for side, inwards in sides)
        files = {"a.bpt": "1\n3 3\n" + text(net), "b.patches": "patches 1\nbezier 3 3\n" + text(net),
                 "c.patches": "patches 1\nbspline\n" + text(spline), "d.patches": "patches 1\nhermite\n" + text(corners),
                 "e.patches": "patches 1\ncoons-bicubic\n" + curves + across,
                 "f.obj": "v " + text(net).strip().replace("\n", "\nv ") + "\ncstype bezier\ndeg 3 3\nsurf 0 1 0 1 " +
                          " ".join(str(k) for k in range(1, 17)) + "\nparm u 0 1\nparm v 0 1\nend\n"}
        bernstein = " 1 -3 3 -1 0 3 -6 3 0 0 3 -3 0 0 0 1"
        files["g.obj"] = files["f.obj"].replace("bezier", "bmatrix").replace(
            "deg", f"bmat u{bernstein}\nbmat v{bernstein}\nstep 3 3\ndeg")
        files["h.obj"] = files["f.obj"].replace("bezier", "rat bezier")
        pictures = []
        for name, contents in files.items():
            picture = os.path.join(self.folder, name + ".png")
            self.sheen("render", self.write(name, contents), "-o", picture, "--size", "160x120", "--up", "z",
                       "--eye=1.5,-1.5,1.2", "--target=0.5,0.5,0", "--lines", "zebra")
            pictures.append(b"".join(read_png(picture)[2]))
        self.assertGreater(len(set(pictures[0])), 20)
        for picture in pictures[1:]:
            self.assertLessEqual(max(abs(a - b) for a, b in zip(pictures[0], picture)), 1)

    def test_damaged_files(self):
        for text, words in (("1\n4 3\n", ":2: a patch of degree 4 along u"), ("2\n1 1\n", "ends before coordinate x")):
            done = self.sheen("info", self.write("bad.bpt", text), code=3)
            self.assertIn(words, done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1)
        rational = ("v 0 0 0\nv 1 0 0 0.5\nv 0 1 0\nv 1 1 0\ncstype rat bezier\ndeg 1 1\nsurf 0 1 0 1 1 2 3 4\n"
                    "parm u 0 1\nparm v 0 1\nend\n")
        done = self.sheen("info", self.write("rational.obj", rational), code=3)
        self.assertIn(":7: control point 2 has the weight 0.5, and the first one 1: ", done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1)

    def test_weld_is_for_faces(self):
        self.assertIn("--weld is for OBJ; patches are joined", self.sheen("info", BOTTLE, "--weld", code=2).stderr)


if __name__ == "__main__":
    unittest.main()

"""sheen breaks: exit codes, the table, JSON by its schema, JUnit, with files of strange names. The numbers themselves are
judged by tests/unit/test_curves_breaks.c and tests/oracle/test_breaks.cpp."""
import json
import math
import os
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as xml

import junit_schema
import schema
from daemon import CUBE, MODELS, SHEEN
from test_surface import read_png

SCHEMAS = os.path.join(MODELS, "..", "..", "client", "schema")
# A sheet that is folded along x = 0 by 30 degrees, with an infinitely sharp crease of three edges.
ANGLE = 30


def fold(sharpness):
    c, s = math.cos(math.radians(ANGLE)), math.sin(math.radians(ANGLE))
    lines = [f"v {x * (c if x > 0 else 1):.17g} {y} {max(x, 0) * s:.17g}" for y in range(4) for x in range(-2, 3)]
    lines += [f"f {5 * y + x + 1} {5 * y + x + 2} {5 * y + x + 7} {5 * y + x + 6}" for y in range(3) for x in range(4)]
    lines += [f"t crease 2/1/0 {5 * y + 2} {5 * y + 7} {sharpness}" for y in range(3)]
    return "\n".join(lines) + "\n"


@unittest.skipUnless(os.path.exists(SHEEN), "no client in this build")
class BreaksCommand(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        cls.folded = cls.write("fold.obj", fold(10))
        cls.smooth = cls.write("cube.obj", CUBE.decode())
        with open(os.path.join(SCHEMAS, "breaks-1.json"), encoding="utf-8") as file:
            cls.schema = json.load(file)

    @classmethod
    def write(cls, name, text):
        path = os.path.join(cls.folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def breaks(self, *arguments, code):
        done = subprocess.run([SHEEN, "breaks", *arguments], capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def json(self, *arguments, code):
        answer = json.loads(self.breaks(*arguments, "--json", code=code).stdout)
        schema.check(answer, self.schema)
        self.assertEqual(answer["within"], code == 0)
        return answer

    def test_exit_codes(self):
        self.breaks(self.folded, code=1)
        self.breaks(self.folded, "--angle", "31", code=0)
        self.breaks(self.folded, "--angle", "29", code=1)
        self.breaks(self.smooth, code=0)
        self.assertIn("--angle '0'", self.breaks(self.folded, "--angle", "0", code=2).stderr)
        self.assertIn("--curvature '201'", self.breaks(self.folded, "--curvature", "201", code=2).stderr)
        self.breaks(os.path.join(self.folder, "missing.obj"), code=3)
        self.breaks(self.folded, "--server", "unix:/nowhere", code=4)

    def test_json(self):
        answer = self.json(self.folded, code=1)
        self.assertEqual(answer["counts"], {"edges": 3, "out": 3, "creases": 3, "semisharp": 0, "joints": 0,
                                            "borders": 14, "vertices": answer["counts"]["vertices"]})
        self.assertAlmostEqual(answer["limits"]["gap"]["value"], 1e-5 * answer["diagonal"], places=12)
        self.assertEqual([answer["limits"][name]["default"] for name in ("gap", "angle_deg")], [True, True])
        self.assertAlmostEqual(answer["lengths"]["creases"], 3, places=5)
        for edge in answer["edges"]:
            self.assertEqual((edge["kind"], edge["over"]), ("crease", ["angle_deg"]))
            self.assertAlmostEqual(edge["angle_deg"]["value"], ANGLE, places=4)
            x, y, z = edge["angle_deg"]["position"]
            self.assertAlmostEqual(x, 0, places=6)
            self.assertLess(edge["kink_deg"]["value"], 180)
        worst = answer["worst"]["angle_deg"]
        self.assertEqual(answer["edges"][worst["edge"]]["angle_deg"]["value"], worst["value"])
        loose = self.json(self.folded, "--angle", "31", "--gap", "0.5", code=0)
        self.assertEqual(loose["limits"]["gap"], {"value": 0.5, "default": False})
        self.assertEqual((loose["counts"]["out"], loose["lengths"]["out"]), (0, 0))

    def test_lights_and_lines_decide_kinks_and_jumps_alone(self):
        tunnel = self.json(self.folded, code=1)
        zebra = self.json(self.folded, "--lines", "zebra", "--pattern", "stripes:count=10", code=1)
        self.assertEqual(zebra["lines"], "zebra")
        for one, other in zip(tunnel["edges"], zebra["edges"]):
            self.assertEqual(one["angle_deg"], other["angle_deg"])
            self.assertNotEqual(one["jump_spacings"], other["jump_spacings"])
        # Zebra's bands are 18 degrees wide here: the ray turns by twice the angle, at most.
        self.assertTrue(all(edge["jump_spacings"]["value"] <= 2 * ANGLE / 18 + 1e-6 for edge in zebra["edges"]))

    def test_an_angle_equal_to_its_limit_is_within(self):
        self.breaks(self.folded, "--angle", str(ANGLE), code=0)
        self.breaks(self.folded, "--angle", str(ANGLE - 3e-5), code=1)

    def test_flat_corners_are_not_listed(self):
        flat = self.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0.5\nf 1 2 3 4\n")
        self.assertNotIn("extraordinary", self.breaks(flat, code=0).stdout)
        self.assertIn("8 extraordinary vertices", self.breaks(self.smooth, code=0).stdout)

    def test_semisharp_creases_are_no_breaks(self):
        path = self.write("soft.obj", fold(2))
        answer = self.json(path, code=0)
        self.assertEqual(answer["counts"]["semisharp"], 3)
        self.assertEqual([edge["kind"] for edge in answer["edges"]], ["semi-sharp"] * 3)
        self.assertIsNone(answer["edges"][0]["gap"])
        self.assertIsNone(answer["worst"]["angle_deg"])
        self.assertIn("semi-sharp creases are smooth", self.breaks(path, code=0).stdout)

    def test_table(self):
        lines = self.breaks(self.folded, code=1).stdout.splitlines()
        self.assertTrue(lines[0].startswith("3 edges: 3 creases, 0 semi-sharp, 0 joints, on 3 units; 14 borders"), lines)
        self.assertIn("default: 1e-5 of the diagonal", lines[1])
        self.assertIn("3 out of tolerance", lines[2])
        rows = [line.split() for line in lines if line.startswith("crease")]
        self.assertEqual(len(rows), 3)
        self.assertEqual({row[6] for row in rows}, {"30!"})

    def test_table_has_the_length_of_all_kinds(self):
        """Two sheets of 1 x 1 side by side: one joint, no crease."""
        lines = [f"v {x + i} {y} 0" for i in (0, 1) for y in (0, 1) for x in (0, 1)]
        path = self.write("joint.obj", "\n".join(lines) + "\nf 1 2 4 3\nf 5 6 8 7\nt interpolateboundary 1/0/0 1\n")
        lines = self.breaks(path, code=0).stdout.splitlines()
        self.assertTrue(lines[0].startswith("1 edge: 0 creases, 0 semi-sharp, 1 joint, on 1 units; 8 borders"), lines)

    def test_junit(self):
        """Valid XML with the right counts, also where the file's name has what XML must escape or cannot hold."""
        for name in ("fold.obj", 'a<b>&"c"\'\x01\x1b[31m\x7f.obj'):
            path = self.write(name, fold(10))
            report = os.path.join(self.folder, "report.xml")
            self.breaks(path, "--junit", report, code=1)
            junit_schema.check(report)
            with open(report, "rb") as file:
                suites = xml.fromstring(file.read())
            suite, = suites
            self.assertEqual((suites.tag, suite.tag), ("testsuites", "testsuite"))
            self.assertEqual({key: suite.get(key) for key in ("tests", "failures", "errors")},
                             {"tests": "3", "failures": "1", "errors": "0"})
            self.assertIn(name.replace("\x01", "\ufffd").replace("\x1b", "\ufffd").replace("\x7f", "\ufffd"),
                          suite.get("name"))
            failed = [case for case in suite if case.tag == "testcase" and len(case)]
            self.assertEqual([case.get("name") for case in failed], ["angle"])
            self.assertIn("3 edges are over the limit of 0.1 degrees", failed[0][0].get("message"))
            self.assertEqual(len(failed[0][0].text.strip().splitlines()), 3)
        self.breaks(self.smooth, "--junit", report, code=0)
        junit_schema.check(report)
        suite, = xml.parse(report).getroot()
        self.assertEqual(suite.get("failures"), "0")
        self.breaks(self.folded, "--junit", os.path.join(self.folder, "no", "folder.xml"), code=3)

    def test_picture(self):
        """The crease is painted red where it is seen, and nothing else is; within the limits nothing is painted."""
        path = os.path.join(self.folder, "a.png")
        # From above, 4 units high on 200 pixels: the fold runs down the middle, from y = 0 to y = 3.
        view = ("--size", "200x200", "--ortho", "4", "--eye", "0,1.5,9", "--target", "0,1.5,0", "--up", "0,1,0")
        self.assertNotIn("cannot be seen", self.breaks(self.folded, "-o", path, *view, code=1).stderr)
        width, _, rows = read_png(path)
        red = {(x, y) for y, row in enumerate(rows) for x in range(width) if row[3 * x:3 * x + 3] == bytes((255, 0, 0))}
        self.assertLessEqual({x for x, _ in red}, set(range(97, 103)))
        for y in range(30, 170):
            self.assertIn((99, y), red)
            self.assertIn((100, y), red)
        self.assertFalse(any(y < 24 or y > 175 for _, y in red))
        # Half a unit high at y = 0.5: two of the three edges lie outside.
        near = (*view[:2], "--ortho", "0.5", "--eye", "0,0.5,9", "--target", "0,0.5,0", "--up", "0,1,0")
        said = self.breaks(self.folded, "-o", path, *near, code=1).stderr
        self.assertIn(f"{path}: 2 of 3 edges out of tolerance cannot be seen in this view", said)
        self.assertNotIn("cannot be seen", self.breaks(self.folded, "-o", path, "-q", *near, code=1).stderr)
        self.breaks(self.folded, "-o", path, "--angle", "31", *view, code=0)
        width, _, rows = read_png(path)
        self.assertTrue(all(row[3 * x] == row[3 * x + 1] for row in rows for x in range(width)))
        self.assertIn("must end in .png", self.breaks(self.folded, "-o", "a.jpg", code=2).stderr)

    def test_render_says_who_paints_breaks(self):
        done = subprocess.run([SHEEN, "render", self.folded, "-o", "a.png", "--show", "breaks"], capture_output=True,
                              text=True, timeout=60)
        self.assertEqual(done.returncode, 2)
        self.assertIn("sheen breaks MODEL -o FILE.png", done.stderr)

    def test_deadline(self):
        done = self.breaks(self.folded, "--deadline", "0", code=2)
        self.assertIn("--deadline '0'", done.stderr)

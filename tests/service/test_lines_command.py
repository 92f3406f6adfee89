"""sheen lines: the files that it writes, and its curves against the numbers of the picture. That no line is lost, and that
every point lies on its line, is judged by tests/unit/test_curves_lines.c."""
import csv
import json
import math
import os
import re
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as xml

import schema
from daemon import MODELS, SHEEN, Daemon

SCHEMAS = os.path.join(MODELS, "..", "..", "client", "schema")
BODY = os.path.join(MODELS, "body.obj")
SVG = "{http://www.w3.org/2000/svg}"


@unittest.skipUnless(os.path.exists(SHEEN), "no client in this build")
class LinesCommand(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        cls.daemon = Daemon()
        cls.addClassCleanup(cls.daemon.stop)
        with open(os.path.join(SCHEMAS, "lines-1.json"), encoding="utf-8") as file:
            cls.schema = json.load(file)

    def sheen(self, *arguments, code=0):
        done = subprocess.run([SHEEN, *arguments, "--server", self.daemon.unix], capture_output=True, text=True,
                              timeout=120)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def lines(self, name, *arguments, model=BODY, code=0):
        path = os.path.join(self.folder, name)
        done = self.sheen("lines", model, "-o", path, *arguments, code=code)
        return path if code == 0 else done

    def json(self, *arguments, model=BODY):
        with open(self.lines("lines.json", *arguments, model=model), encoding="utf-8") as file:
            answer = json.load(file)
        schema.check(answer, self.schema)
        self.assertEqual(len(answer["curves"]), answer["counts"]["curves"])
        self.assertEqual(sum(len(curve["points"]) for curve in answer["curves"]), answer["counts"]["points"])
        return answer

    def test_json(self):
        answer = self.json("--at", "0.25,0.5,0.75")
        self.assertEqual(sorted({curve["place"] for curve in answer["curves"]}), [0.25, 0.5, 0.75])
        self.assertAlmostEqual(answer["tolerance"], 1e-5 * answer["diagonal"], places=12)
        self.assertEqual((answer["lines"], answer["silhouettes"], answer["marks"]), ("reflection", False, []))
        for curve in answer["curves"]:
            last = 0
            for before, point in zip(curve["points"], curve["points"][1:]):
                last += math.dist(before["position"], point["position"])
                self.assertAlmostEqual(point["length"], last, places=9)
                self.assertAlmostEqual(math.hypot(*point["normal"]), 1, places=12)
                self.assertLess(abs(sum(n * t for n, t in zip(point["normal"], point["along"]))), 1e-6)
            for start, end in curve["visible"]:
                self.assertTrue(0 <= start < end <= len(curve["points"]))
        summary = json.loads(self.sheen("lines", BODY, "-o", os.path.join(self.folder, "a.svg"), "--json").stdout)
        schema.check(summary, self.schema)
        self.assertNotIn("curves", summary)

    def test_summary(self):
        path = os.path.join(self.folder, "summary.svg")
        answer = self.json("--at", "0.25,0.35625")
        n_lines = len({curve["line"] for curve in answer["curves"]})
        asked = ("lines", BODY, "-o", path, "--at", "0.25,0.35625")
        self.assertRegex(self.sheen(*asked).stderr, rf"{path}: {len(answer['curves'])} curves? of {n_lines} lines?, "
                         r"0 undecided places, \d+ ms\n$")
        self.assertEqual(self.sheen(*asked, "-q").stderr, "")
        with open(path, encoding="utf-8") as file:
            self.assertIn('data-place="0.35625"', file.read())
        with open(self.lines("summary.csv", "--at", "0.35625"), encoding="utf-8") as file:
            self.assertEqual({row["place"] for row in csv.DictReader(file)}, {"0.35625"})
        sheet = os.path.join(self.folder, "sheet.obj")
        with open(sheet, "w", encoding="utf-8") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
        said = self.sheen("lines", sheet, "-o", path, "--silhouettes").stderr
        self.assertRegex(said, rf"sheet.obj: no silhouettes\n{path}: 0 silhouettes, 0 undecided places, \d+ ms\n$")

    def test_the_middles_of_bright_stripes(self):
        answer = self.json("--pattern", "stripes:count=4,duty=0.5", "--tolerance", "0.01")
        self.assertEqual(sorted({curve["place"] for curve in answer["curves"]}), [0.0625, 0.3125, 0.5625, 0.8125])
        self.assertEqual(answer["tolerance"], 0.01)
        done = self.lines("x.svg", "--pattern", "circles", code=2)
        self.assertIn("--at", done.stderr)
        done = self.lines("x.svg", "--pattern", "stripes:rotation=30", code=2)
        self.assertIn("multiple of 90 degrees", done.stderr)

    def test_csv_has_the_numbers_of_json(self):
        answer = self.json("--at", "0.3")
        with open(self.lines("lines.csv", "--at", "0.3"), encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        points = [point for curve in answer["curves"] for point in curve["points"]]
        self.assertEqual(len(rows), len(points))
        for row, point in zip(rows, points):
            self.assertEqual([float(row[key]) for key in "xyz"], point["position"])
            self.assertEqual([float(row[key]) for key in ("tx", "ty", "tz")], point["along"])
            self.assertEqual((int(row["face"]), [float(row["u"]), float(row["v"])]), (point["face"], point["uv"]))
        seen = {row["visible"] for row in rows}
        self.assertEqual(seen, {"0", "1"})
        with open(self.lines("lines.csv", "--at", "0.3", "--visible-only"), encoding="utf-8", newline="") as file:
            self.assertEqual(len(list(csv.DictReader(file))), sum(row["visible"] == "1" for row in rows))

    def test_dxf(self):
        """Pairs of a code and a value: a polyline for each curve, with all its points, on a layer for each light."""
        lights = ("--light", "plane", "--pattern", "lines:at=0.5", "--light", "tunnel", "--pattern", "lines:at=0.3")
        answer = self.json(*lights)
        with open(self.lines("lines.dxf", *lights), encoding="ascii") as file:
            text = file.read().splitlines()
        pairs = list(zip(text[::2], text[1::2]))
        self.assertEqual(pairs[-1], ("0", "EOF"))
        self.assertIn(("1", "AC1009"), pairs)
        kinds = [value for code, value in pairs if code == "0"]
        self.assertEqual(kinds.count("POLYLINE"), len(answer["curves"]))
        self.assertEqual(kinds.count("SEQEND"), len(answer["curves"]))
        self.assertEqual(kinds.count("VERTEX"), answer["counts"]["points"])
        self.assertEqual({value for code, value in pairs if code == "8"}, {"LIGHT_1", "LIGHT_2"})
        first = answer["curves"][0]["points"][0]["position"]
        start = pairs.index(("0", "VERTEX"))
        self.assertEqual([float(value) for code, value in pairs[start + 2:start + 5]], first)

    def test_svg(self):
        root = xml.parse(self.lines("lines.svg", "--at", "0.3,0.6")).getroot()
        self.assertEqual((root.tag, root.get("width"), root.get("height")), (SVG + "svg", "1280", "720"))
        light, = root[0]
        self.assertEqual(light.get("id"), "light-1")
        self.assertEqual([line.get("data-place") for line in light], ["0.3", "0.6"])
        self.assertTrue(any(group.get("class") == "hidden" for line in light for group in line))
        for path in root.iter(SVG + "path"):
            self.assertTrue(re.fullmatch(r"M[-0-9. ]+(C[-0-9. ]+)+", path.get("d")))
        visible = xml.parse(self.lines("lines.svg", "--at", "0.3,0.6", "--visible-only")).getroot()
        self.assertFalse(any(group.get("class") for group in visible.iter(SVG + "g")))

    def test_a_silhouette_is_one_closed_curve(self):
        answer = self.json("--silhouettes")
        self.assertEqual((answer["counts"]["curves"], answer["counts"]["closed"]), (1, 1))
        curve, = answer["curves"]
        self.assertIsNone(curve["place"])
        self.assertEqual(curve["visible"], [[0, len(curve["points"])]])

    def test_curves_are_where_the_picture_has_their_lines(self):
        """The light's coordinate at the places of points, by the picture's own numbers: within 0.1 px."""
        answer = self.json("--at", "0.31,0.52,0.7")
        camera, width, height = answer["camera"], answer["width"], answer["height"]
        forward = [b - a for a, b in zip(camera["eye"], camera["target"])]
        cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        unit = lambda a: [x / math.hypot(*a) for x in a]
        dot = lambda a, b: sum(x * y for x, y in zip(a, b))
        forward = unit(forward)
        right = unit(cross(forward, camera["up"]))
        above = cross(right, forward)
        scale = height / 2 / math.tan(math.radians(camera["fov_deg"]) / 2)
        n = 0
        for curve in answer["curves"]:
            for start, end in curve["visible"]:
                point = curve["points"][min(math.ceil((start + end) / 2), len(curve["points"]) - 1)]
                to = [p - e for p, e in zip(point["position"], camera["eye"])]
                if end - start < 8 or abs(dot(unit(to), point["normal"])) < 0.2:
                    continue
                x = width / 2 + scale * dot(to, right) / dot(to, forward) - 0.5
                y = height / 2 - scale * dot(to, above) / dot(to, forward) - 0.5
                s = [json.loads(self.sheen("pick", BODY, f"{x + dx:.9f},{y + dy:.9f}", "--json").stdout)["light_st"][0]
                     for dx, dy in ((0, 0), (0.5, 0), (0, 0.5))]
                slope = math.hypot(s[1] - s[0], s[2] - s[0]) / 0.5
                self.assertLess(abs(s[0] - curve["place"]) / slope, 0.1)
                n += 1
        self.assertGreater(n, 2)

    def test_wrong_usage(self):
        for arguments, text in ((("--at", "1,x"), "--at"), (("--at", ""), "--at"), (("--tolerance", "0"), "--tolerance"),
                                (("--at", "0.5", "--silhouettes"), "no places"),
                                (("--at", ",".join(["0.5"] * 257)), "256")):
            self.assertIn(text, self.lines("x.svg", *arguments, code=2).stderr)
        self.assertIn(".svg", self.lines("x.png", code=2).stderr)
        self.assertIn("-o FILE", self.sheen("lines", BODY, code=2).stderr)
        self.lines(os.path.join("no", "folder.svg"), code=3)

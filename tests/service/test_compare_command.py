"""sheen compare: exit codes, limits, folders, JSON by its schema, JUnit and markdown, with files of strange names. The
numbers themselves are judged by tests/oracle/test_comparison.cpp."""
import base64
import hashlib
import json
import math
import os
import shutil
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as xml
from html.parser import HTMLParser

import junit_schema
import schema
from daemon import CUBE, MODELS, SHEEN
from png import read_png

SCHEMAS = os.path.join(MODELS, "..", "..", "client", "schema")
LIFT = 0.01
MOST = LIFT * 4 / 9  # by which a regular vertex takes the surface with it
FEW = ("--samples", "20000")


def sheet(lift=0.0, without=None):
    """A flat sheet of 6 by 6 faces, whose middle vertex is lifted, without one face."""
    lines = [f"v {x} {y} {lift if (x, y) == (3, 3) else 0}" for y in range(7) for x in range(7)]
    lines += [f"f {7 * y + x + 1} {7 * y + x + 2} {7 * y + x + 9} {7 * y + x + 8}"
              for y in range(6) for x in range(6) if (x, y) != without]
    return "\n".join(lines) + "\n"


@unittest.skipUnless(os.path.exists(SHEEN), "no client in this build")
class Comparing(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        cls.flat = cls.write("flat.obj", sheet())
        cls.lifted = cls.write("lifted.obj", sheet(LIFT))

    @classmethod
    def write(cls, name, text):
        path = os.path.join(cls.folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def compare(self, *arguments, code):
        done = subprocess.run([SHEEN, "compare", *arguments, *FEW], capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, code, done.stderr)
        return done


class CompareCommand(Comparing):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        with open(os.path.join(SCHEMAS, "compare-1.json"), encoding="utf-8") as file:
            cls.schema = json.load(file)

    def json(self, *arguments, code):
        answer = json.loads(self.compare(*arguments, "--json", code=code).stdout)
        schema.check(answer, self.schema)
        self.assertIn(answer["verdict"], {0: ("same", "within_limits"), 1: ("differs",)}.get(code, ("failed",)))
        return answer

    def test_exit_codes(self):
        self.compare(self.flat, self.flat, code=0)
        self.compare(self.flat, self.lifted, code=1)
        missing = os.path.join(self.folder, "missing.obj")
        self.assertEqual(self.compare(self.flat, missing, code=3).stdout, "")
        self.compare(missing, self.flat, code=3)
        bad = self.write("bad.obj", "v 0 0 zero\n")
        self.assertEqual(self.compare(self.flat, bad, "--json", code=3).stdout, "")
        self.compare(self.flat, self.flat, "--server", "unix:/nowhere", code=4)
        self.assertIn("NEW, is missing", self.compare(self.flat, code=2).stderr)
        self.assertIn("two models or two folders", self.compare(self.flat, self.folder, code=2).stderr)
        for pair in ((self.folder, missing), (missing, self.folder)):
            self.assertEqual(self.compare(*pair, code=3).stderr, f"sheen: {missing}: No such file or directory\n")

    def test_same_is_more_than_within_limits(self):
        same = self.compare(self.flat, self.flat, code=0).stdout
        self.assertIn("flat.obj: same\n", same)
        self.assertNotRegex(same, r"face \d")  # a difference of 0 has no place
        wide = ("--limit", "distance=1", "--limit", "normal_deg=90", "--limit", "lines=off")
        near = self.compare(self.flat, self.lifted, *wide, code=0).stdout
        self.assertIn("lifted.obj: within limits\n", near)
        self.assertRegex(near, r"distance +0\.0044.* face \d+\n")
        for new, found in ((self.flat, ("same", True, True)), (self.lifted, ("within_limits", True, False))):
            answer = self.json(self.flat, new, *wide, code=0)
            pair, = answer["pairs"]
            self.assertEqual(answer["verdict"], found[0])
            self.assertEqual((pair["verdict"], pair["within_limits"], pair["identical"]), found)
        pair, = self.json(self.flat, self.lifted, code=1)["pairs"]
        self.assertEqual((pair["verdict"], pair["within_limits"], pair["identical"]), ("differs", False, False))
        self.assertRegex(self.compare(self.lifted, self.flat, *wide, code=0).stdout, r"distance +-0\.0044")

    def test_limits(self):
        loose = ("--limit", "normal_deg=off", "--limit", "lines=off")
        for factor, code in ((0.999, 1), (1.001, 0)):
            self.compare(self.flat, self.lifted, *loose, "--limit", f"distance={MOST * factor}", code=code)
        # The lifted part is 4 x 4 faces of 36, most of it by more than a tenth of the limit.
        for share, code in (("60%", 0), ("1%", 1)):
            self.compare(self.flat, self.lifted, *loose, "--limit", f"distance={MOST / 100}@{share}", code=code)
        for wrong in ("distance", "distance=", "distance=x", "distance=0", "speed=1", "distance=1@2", "distance=1@101%",
                      "lines=off@1%", "normal_deg=181", "distance=nan"):
            self.assertIn("--limit", self.compare(self.flat, self.flat, "--limit", wrong, code=2).stderr, wrong)
        for wrong in ("normal_deg=0.05@", "normal_deg=0.05@1", "normal_deg=0.05@101%"):
            text = self.compare(self.flat, self.flat, "--limit", wrong, code=2).stderr
            self.assertEqual(text.count(wrong), 1, text)
            self.assertIn("as a percentage from 0% to 100%", text)
        # A face is missing, which is less than 1 square unit and about 2 % of the area.
        opened = self.write("opened.obj", sheet(without=(2, 2)))
        for area, code in (("0", 1), ("0@1%", 1), ("0@10%", 0), ("2", 0), ("off", 0)):
            self.compare(self.flat, opened, *loose, "--limit", f"uncovered_area={area}", code=code)

    def test_json(self):
        answer = self.json(self.flat, self.lifted, "--limit", "curvature=0.1", code=1)
        pair, = answer["pairs"]
        for side in ("old", "new"):
            with open(pair[side]["file"], "rb") as file:
                self.assertEqual(pair[side]["sha256"], hashlib.sha256(file.read()).hexdigest())
            distance = pair[side + "_samples"]["distance"]
            self.assertAlmostEqual(distance["worst"], MOST, delta=1e-5)
            self.assertAlmostEqual(distance["old"]["position"][0], 3, delta=0.01)
            self.assertAlmostEqual(distance["new"]["position"][2], MOST, delta=1e-5)
            self.assertIsNotNone(pair[side + "_samples"]["curvature"])
        self.assertTrue(pair["measures"]["distance"]["default"] and pair["measures"]["distance"]["out"])
        self.assertAlmostEqual(pair["measures"]["distance"]["limit"], 1e-5 * pair["diagonal"], places=12)
        self.assertFalse(pair["measures"]["curvature"]["default"])
        self.assertFalse(pair["measures"]["uncovered_area"]["out"])
        same, = self.json(self.flat, self.flat, code=0)["pairs"]
        self.assertEqual([same["measures"][name]["worst"] for name in ("distance", "normal_deg", "lines")], [0, 0, 0])
        self.assertIsNone(same["measures"]["curvature"]["worst"])

    def test_a_missing_face(self):
        opened = self.write("open.obj", sheet(without=(2, 2)))
        pair, = self.json(self.flat, opened, code=1)["pairs"]
        self.assertTrue(pair["measures"]["uncovered_area"]["out"])
        self.assertGreater(pair["old_samples"]["uncovered_area"], 0.5)
        self.assertEqual(pair["new_samples"]["uncovered_area"], 0)
        x, y, _ = pair["old_samples"]["uncovered_at"]["position"]
        self.assertTrue(2 < x < 3 and 2 < y < 3)

    def test_winding_is_no_difference(self):
        lines = [" ".join([line.split()[0], *reversed(line.split()[1:])]) if line.startswith("f") else line
                 for line in CUBE.decode().splitlines()]
        old, new = self.write("cube.obj", CUBE.decode()), self.write("turned.obj", "\n".join(lines) + "\n")
        done = self.compare(old, new, code=0)
        self.assertEqual(done.stdout.count("notice: 100 % of the area is wound the other way around"), 1)

    def test_align(self):
        with open(os.path.join(MODELS, "body.obj"), encoding="utf-8") as file:
            body = file.read().splitlines()
        moved = ["v %s %s %r" % (*line.split()[1:3], float(line.split()[3]) + 0.02) if line.startswith("v ") else line
                 for line in body]
        old, new = self.write("body.obj", "\n".join(body)), self.write("moved.obj", "\n".join(moved))
        self.compare(old, new, code=1)
        pair, = self.json(old, new, "--align", code=0)["pairs"]
        self.assertAlmostEqual(pair["alignment"]["shift"][2], -0.02, places=6)
        self.assertLess(pair["alignment"]["rotation_deg"], 1e-4)
        self.assertEqual(pair["alignment"]["free_directions"], 0)
        # A flat sheet slides in its plane and turns about its normal.
        done = self.compare(self.flat, self.flat, "--align", code=0)
        self.assertEqual(done.stdout.count("notice: the new surface slides along itself in 3 of 6 directions"), 1)

    def test_folders(self):
        strange = 'a<b>&"c"|\'\x01\x1b[31m.obj'
        for name, old, new in (("same.obj", sheet(), sheet()), ("bent.obj", sheet(), sheet(LIFT)),
                               (strange, sheet(), sheet(LIFT)), ("gone.obj", sheet(), None),
                               ("fresh.obj", None, sheet()), ("notes.txt", "no model", None)):
            for folder, text in (("old", old), ("new", new)):
                if text:
                    self.write(os.path.join("pairs", folder, name), text)
        old, new = (os.path.join(self.folder, "pairs", folder) for folder in ("old", "new"))
        report, summary = os.path.join(self.folder, "junit.xml"), os.path.join(self.folder, "summary.md")
        answer = self.json(old, new, "--junit", report, "--markdown", summary, code=1)
        self.assertEqual({pair["name"]: pair["verdict"] for pair in answer["pairs"]},
                         {"same.obj": "same", "bent.obj": "differs", strange: "differs", "gone.obj": "deleted",
                          "fresh.obj": "added"})
        self.junit(report, strange)
        with open(summary, encoding="utf-8") as file:
            text = file.read()
        self.assertIn("1 within limits, 4 not", text)
        self.assertIn("a&#60;b&#62;&#38;&#34;c&#34;&#124;'??&#91;31m.obj | differs |", text)
        rows = [line for line in text.splitlines() if line.startswith("| ")]
        self.assertEqual(len({row.count("|") for row in rows}), 1)
        self.assertTrue(rows[-1].startswith("| same.obj"), "the worst come first")
        done = self.compare(os.path.join(self.folder, "pairs"), os.path.join(self.folder, "pairs"), code=3)
        self.assertIn("neither folder has a model (.obj, .gltf, .glb, .usda, .bpt, .patches)", done.stderr)

    def test_a_bad_file_in_a_folder(self):
        """The first, the second and the last pair are bad; the others are compared nevertheless."""
        bad = "v 0 0 zero\n"
        for name, old, new in (("a.obj", bad, sheet()), ("b<.obj", sheet(), bad), ("bent.obj", sheet(), sheet(LIFT)),
                               ("same.obj", sheet(), sheet())):
            self.write(os.path.join("bad", "old", name), old)
            self.write(os.path.join("bad", "new", name), new)
        old, new = (os.path.join(self.folder, "bad", folder) for folder in ("old", "new"))
        for folder in (old, new):
            os.makedirs(os.path.join(folder, "z.obj"), exist_ok=True)  # cannot be read
        report, summary = os.path.join(self.folder, "bad.xml"), os.path.join(self.folder, "bad.md")
        pages = os.path.join(self.folder, "bad-pages")
        outputs = ("--junit", report, "--markdown", summary, "--report", pages)
        pairs = {pair["name"]: pair for pair in self.json(old, new, *outputs, code=3)["pairs"]}
        self.assertEqual({name: pair["verdict"] for name, pair in pairs.items()},
                         {"a.obj": "failed", "b<.obj": "failed", "bent.obj": "differs", "same.obj": "same",
                          "z.obj": "failed"})
        for name, side in (("a.obj", "old"), ("b<.obj", "new"), ("z.obj", "old")):
            error = pairs[name]["error"]
            self.assertEqual((error["side"], error["code"]), (side, 3))
            self.assertIn(f"the {side} file: ", error["text"])
        junit_schema.check(report)
        with open(report, "rb") as file:
            suites = {suite.get("name"): suite for suite in xml.fromstring(file.read())}
        self.assertEqual({name: (suite.get("errors"), len(suite.findall("testcase/error")), suite.get("failures") != "0")
                          for name, suite in suites.items()},
                         {"a.obj": ("1", 1, False), "b<.obj": ("1", 1, False), "bent.obj": ("0", 0, True),
                          "same.obj": ("0", 0, False), "z.obj": ("1", 1, False)})
        self.assertIn("the old file: ", suites["a.obj"].find("testcase/error").get("message"))
        for path in (summary, os.path.join(pages, "index.html")):
            with open(path, encoding="utf-8") as file:
                text = file.read()
            self.assertIn("1 within limits, 1 not, 3 failed", text)
            self.assertEqual(text.count("the new file: "), 1)
        done = self.compare(old, new, code=3)
        self.assertIn("a.obj: failed\n  the old file: ", done.stdout)
        self.assertIn("bent.obj: differs\n", done.stdout)
        self.assertIn("5 pairs: 1 within limits, 1 not, 3 failed", done.stdout)
        self.assertRegex(done.stderr, "3 of 5 pairs failed, such as a.obj: the old file: ")
        self.compare(old, new, "--server", "unix:/nowhere", code=4)

    def test_a_huge_model_in_a_folder(self):
        """The daemon refuses the first pair for its size; the others are compared, and the highest code comes last."""
        huge = "\n".join(line if line[0] == "f" else "v " + " ".join(f"{float(x) * 1e29}" for x in line.split()[1:])
                         for line in sheet().splitlines()) + "\n"
        old, new = (os.path.join(self.folder, "huge", folder) for folder in ("old", "new"))
        for name, text in (("a.obj", huge), ("b.obj", sheet()), ("c.obj", sheet(LIFT))):
            self.write(os.path.join(old, name), sheet() if name == "c.obj" else text)
            self.write(os.path.join(new, name), text)
        pages = os.path.join(self.folder, "huge-pages")
        answer = self.json(old, new, "--report", pages, code=2)
        pairs = {pair["name"]: pair for pair in answer["pairs"]}
        self.assertEqual({name: pair["verdict"] for name, pair in pairs.items()},
                         {"a.obj": "failed", "b.obj": "same", "c.obj": "differs"})
        self.assertEqual(pairs["a.obj"]["error"]["code"], 2)
        self.assertIn("no light can be chosen", pairs["a.obj"]["error"]["text"])
        self.write(os.path.join(old, "d.obj"), "v 0 0 zero\n")
        self.write(os.path.join(new, "d.obj"), sheet())
        done = self.compare(old, new, code=3)
        self.assertIn("4 pairs: 1 within limits, 1 not, 2 failed", done.stdout)
        self.assertRegex(done.stderr, "2 of 4 pairs failed, such as d.obj: the old file: ")

    def junit(self, report, strange):
        """Valid by both schemas, and names that XML cannot hold."""
        junit_schema.check(report)
        with open(report, "rb") as file:
            suites = xml.fromstring(file.read())
        found = {suite.get("name"): suite for suite in suites}
        self.assertEqual(set(found), {"same.obj", "bent.obj", "gone.obj", "fresh.obj",
                                      strange.replace("\x01", "\ufffd").replace("\x1b", "\ufffd")})
        self.assertEqual({name: suite.get("failures") for name, suite in found.items() if name[0] in "sgf"},
                         {"same.obj": "0", "gone.obj": "1", "fresh.obj": "1"})
        cases = [case for case in found["bent.obj"] if case.tag == "testcase"]
        self.assertEqual([case.get("name") for case in cases], ["distance", "normal_deg", "lines", "uncovered_area"])
        self.assertEqual([len(case) for case in cases][0], 1)
        self.assertRegex(cases[0][0].get("message"), r"^distance 0\.0044.* units, limit .* at .*, face \d+, u ")
        deleted = [case for case in found["gone.obj"] if case.tag == "testcase"]
        self.assertIn("deleted", deleted[0][0].get("message"))


class Page(HTMLParser):
    """What a page refers to, and what a server that forbids scripts and inline styles would not show. Scripts of their own
    files do no harm there."""

    def __init__(self, text):
        super().__init__()
        self.files, self.forbidden, self.text, self.images = set(), [], "", []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.files |= {value for name, value in attrs if name == "src" or (tag, name) == ("link", "href")}
        self.images += [value for name, value in attrs if (tag, name) == ("img", "src")]
        is_inline = tag == "script" and not any(name == "src" for name, _ in attrs)
        if is_inline or tag in ("style", "iframe") or any(name == "style" or name.startswith("on") for name, _ in attrs):
            self.forbidden.append((tag, attrs))

    def handle_data(self, data):
        self.text += data


def colours_of(path):
    _, _, rows = read_png(path)
    return {bytes(row[i:i + 3]) for row in rows for i in range(0, len(row), 3)}


class Report(Comparing):
    def report(self, *arguments, code):
        folder = os.path.join(self.folder, "report")
        shutil.rmtree(folder, ignore_errors=True)
        self.compare(*arguments, "--report", folder, code=code)
        with open(os.path.join(folder, "index.html"), encoding="utf-8") as file:
            page = Page(file.read())
        self.assertEqual(page.forbidden, [])
        self.assertEqual(page.files | {"index.html"}, set(os.listdir(folder)))  # no other addresses either
        return page, lambda name: colours_of(os.path.join(folder, name))

    def test_pictures_of_a_change(self):
        page, colours = self.report(self.flat, self.lifted, code=1)
        self.assertEqual(len(page.files), 3 + 4 * 4)
        self.assertIn("lifted.obj: differs", page.text)
        for kind in ("angle", "distance"):
            found = colours(f"p0-v0-{kind}.png")
            self.assertTrue({b"\0\0\0", b"\xff\xff\xff", b"\x9a\x9a\x9a"} <= found, kind)

    def test_maps_of_the_same_model_are_black(self):
        page, colours = self.report(self.flat, self.flat, code=0)
        self.assertIn("flat.obj: same", page.text)
        self.assertEqual(colours("p0-v1-angle.png"), {b"\0\0\0", b"\x9a\x9a\x9a"})

    def test_a_missing_face_is_magenta(self):
        _, colours = self.report(self.flat, self.write("open.obj", sheet(without=(2, 2))), code=1)
        self.assertIn(b"\xff\0\xff", colours("p0-v0-angle.png"))

    def test_the_aligned_surface_is_shown_where_it_was_moved_to(self):
        with open(os.path.join(MODELS, "body.obj"), encoding="utf-8") as file:
            lines = file.read().splitlines()
        c, s, moved = math.cos(0.02), math.sin(0.02), []
        for line in lines:
            if line.startswith("v "):
                x, y, z = map(float, line.split()[1:4])
                line = f"v {c * x - s * y + 0.02!r} {s * x + c * y!r} {z - 0.01!r}"
            moved.append(line)
        old, new = self.write("body.obj", "\n".join(lines)), self.write("moved.obj", "\n".join(moved))
        views = self.write("view.txt", "--eye 3,-4,2 --target 0,0,0\n")
        arguments = (old, new, "--limit", "rotation_deg=off", "--line-eye", "9,1,5", "--views", views)

        def near_black(name):
            """The share of a map's surface that shows less than an eighth of its scale."""
            _, _, rows = read_png(os.path.join(self.folder, "report", name))
            pixels = [bytes(row[i:i + 3]) for row in rows for i in range(0, len(row), 3)]
            surface = [pixel for pixel in pixels if pixel != b"\x9a\x9a\x9a"]
            self.assertGreater(len(surface), 5000)
            return sum(max(pixel) < 100 and pixel[0] < 30 for pixel in surface) / len(surface)

        self.report(*arguments, code=1)
        self.assertLess(max(near_black(f"p0-v0-{kind}.png") for kind in ("angle", "distance")), 0.9)
        page, _ = self.report(*arguments, "--align", code=0)
        self.assertEqual(page.text.count("new, moved onto old"), 2)
        self.assertGreater(min(near_black(f"p0-v0-{kind}.png") for kind in ("angle", "distance")), 0.97)
        rows = [read_png(os.path.join(self.folder, "report", f"p0-v0-{which}.png"))[2] for which in ("old", "new")]
        differing = sum(abs(a - b) > 8 for x, y in zip(*rows) for a, b in zip(x, y))
        self.assertLess(differing, 0.01 * sum(map(len, rows[0])))

    def test_one_file(self):
        path = os.path.join(self.folder, "one.html")
        _, _ = self.report(self.flat, self.lifted, "--html", path, code=1)
        with open(path, encoding="utf-8") as file:
            page = Page(file.read())
        self.assertEqual(set(page.files), set(page.images))  # nothing else is loaded
        pictures = [base64.b64decode(image.removeprefix("data:image/png;base64,"), validate=True)
                    for image in page.images]
        files = []
        with open(os.path.join(self.folder, "report", "index.html"), encoding="utf-8") as file:
            for name in Page(file.read()).images:
                with open(os.path.join(self.folder, "report", name), "rb") as picture:
                    files.append(picture.read())
        self.assertEqual(pictures, files)
        self.assertEqual([tag for tag, _ in page.forbidden], ["style", "script"])
        self.assertIn("lifted.obj: differs", page.text)

    def test_views(self):
        views = self.write("views.txt", "# a comment\n\n--view front --up 0,0,1\n--eye 3,3,9 --target 3,3,0 --fov 40\n")
        page, colours = self.report(self.flat, self.lifted, "--views", views, code=1)
        self.assertEqual(len(page.files), 3 + 2 * 4)
        self.assertIn("--eye 3,3,9 --target 3,3,0 --fov 40", page.text)
        self.assertGreater(len(colours("p0-v1-distance.png")), 10)
        report = ("--report", os.path.join(self.folder, "report"))
        longest = "--view front".ljust(499)  # views.h
        views = self.write("long.txt", longest + "\n" + longest + "\r\n" + longest)
        self.compare(self.flat, self.flat, *report, "--views", views, code=0)
        for text in (longest + " ", longest + " \n", longest + "\n" + longest + " \r\n"):
            done = self.compare(self.flat, self.flat, *report, "--views", self.write("long.txt", text), code=2)
            self.assertIn(f"line {text.strip().count(chr(10)) + 1}: is too long", done.stderr)
        for text, words in (("--view front\n--light tunnel\n", "line 2: "), ("--view nowhere", "line 1: --view 'nowhere'"),
                            ("--eye 1,2,3", "needs a --target"), ("front", "argument too many"), ("# nothing\n", "no view"),
                            ("--view front\n" * 65, "more than 64 views"), ("#" * 1000, "line 1: is too long")):
            wrong = self.write("wrong.txt", text)
            self.assertIn(words, self.compare(self.flat, self.flat, *report, "--views", wrong, code=2).stderr)
        self.assertIn("--report or --html", self.compare(self.flat, self.flat, "--views", views, code=2).stderr)
        self.compare(self.flat, self.flat, *report, "--views", os.path.join(self.folder, "missing"), code=2)

    def test_strange_names_and_bad_folders(self):
        strange = self.write("a<b>&\"c\"'\x01.obj", sheet())
        page, _ = self.report(self.flat, strange, code=0)
        self.assertIn("a<b>&\"c\"'?.obj", page.text)
        self.compare(self.flat, self.flat, "--report", os.path.join(self.folder, "no", "folder"), code=3)


if __name__ == "__main__":
    unittest.main()

"""sheen pick, and the same in Python: the numbers are those of the planes of the picture."""
import csv
import json
import math
import os
import random
import re
import subprocess
import tempfile

import numpy as np

import between
import exr
import sheen
import wire
from daemon import MODELS, SHEEN, Daemon, DaemonCase

FENDER = os.path.join(MODELS, "fender.gltf")
SIZE, WIDTH, HEIGHT = "320x240", 320, 240
SCENE = ("--view", "left", "--zoom", "1.5", "--lines", "highlight", "--light", "rectangle")
COLUMNS = ("x,y,point.x,point.y,point.z,normal.x,normal.y,normal.z,k.min,k.max,radius,face,u,v,light.s,"
           "light.t").split(",")
CHANNELS = dict(zip(COLUMNS[2:], ("P.X", "P.Y", "P.Z", "N.X", "N.Y", "N.Z", "k.min", "k.max", None, "ptex.face", "ptex.u",
                                  "ptex.v", "light.s", "light.t")))


class Pick(DaemonCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        folder = tempfile.TemporaryDirectory(prefix="sheen-test-")
        cls.addClassCleanup(folder.cleanup)
        path = os.path.join(folder.name, "a.exr")
        subprocess.run([SHEEN, "render", FENDER, "-o", path, "--aov", "P,N,ptex,light,k", "--size", SIZE, *SCENE, "-q",
                        "--server", cls.daemon.unix], check=True, timeout=60)
        with open(path, "rb") as file:
            cls.planes = exr.read(file.read())
        cls.is_hit = cls.planes["ptex.face"] != 0xffffffff

    def run_it(self, *words, model=FENDER):
        return subprocess.run([SHEEN, "pick", model, *words, "--size", SIZE, *SCENE, "--server", self.daemon.unix],
                              capture_output=True, text=True, timeout=60)

    def pick(self, *words):
        done = self.run_it(*words)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout

    def expected(self, column, x, y):
        """The number of the EXR file; None if it has none."""
        if column == "radius":
            value = 1 / max(abs(float(self.planes[name][y, x])) for name in ("k.min", "k.max"))
        else:
            value = self.planes[CHANNELS[column]][y, x].item()
        return None if math.isnan(value) or not self.is_hit[y, x] else value

    def found(self, one):
        """The numbers of a JSON object by the names of columns."""
        row = {"radius": one.get("radius"), "face": one.get("face"), "k.min": one.get("k_min"), "k.max": one.get("k_max")}
        for key, names in (("point", COLUMNS[2:5]), ("normal", COLUMNS[5:8]), ("uv", ("u", "v")),
                           ("light_st", ("light.s", "light.t"))):
            row.update(zip(names, one.get(key) or (None,) * len(names)))
        return row

    def test_the_numbers_of_the_planes(self):
        chance = random.Random(3)
        some = [tuple(place[::-1]) for place in chance.sample(np.argwhere(self.is_hit).tolist(), 18)]
        some += [tuple(place[::-1]) for place in chance.sample(np.argwhere(~self.is_hit).tolist(), 2)]
        self.assertEqual(len(some), 20)
        met = 0
        with sheen.connect(self.daemon.unix) as session:
            camera = session.render(FENDER, size=SIZE, view="left", zoom=1.5).camera
            for x, y in some:
                one = json.loads(self.pick(f"{x},{y}", "--json"))
                self.assertEqual((one["x"], one["y"], one["hit"]), (x, y, bool(self.is_hit[y, x])))
                row = self.found(one)
                for column in COLUMNS[2:]:
                    self.assertEqual(row[column], self.expected(column, x, y), (column, x, y))
                met += "light_st" in one
                same = session.pick(FENDER, camera, x, y, size=SIZE, lines="highlight", light="rectangle")
                self.assertEqual((same.hit, same.face, same.radius), (one["hit"], row["face"], row["radius"]))
                self.assertEqual([list(value) if value else None for value in (same.point, same.normal, same.light)],
                                 [one.get(key) for key in ("point", "normal", "light_st")])
                if one["hit"]:
                    self.assertEqual((same.mean_curvature, same.gaussian_curvature, list(same.curvature), same.u, same.v),
                                     (one["mean"], one["gaussian"], [one["k_min"], one["k_max"]], *one["uv"]))
        self.assertTrue(0 < met < 18)  # the light is met at some places

    def test_words(self):
        y, x = np.argwhere(self.is_hit)[1000]
        text = self.pick(f"{x},{y}")
        for name, columns in (("point", COLUMNS[2:5]), ("normal", COLUMNS[5:8]), ("curvatures", COLUMNS[8:10]),
                              ("radius", COLUMNS[10:11]), ("face", COLUMNS[11:12]), ("u v", COLUMNS[12:14])):
            numbers = re.search(rf"(?m)^{name} +(.*)$", text).group(1).split()
            self.assertTrue(np.allclose([float(number) for number in numbers],
                                        [self.expected(column, x, y) for column in columns], rtol=1e-8), name)
        y, x = np.argwhere(~self.is_hit)[0]
        self.assertEqual(self.pick(f"{x},{y}").splitlines()[1],
                         "nothing there   no surface is visible at this place")

    def test_section(self):
        """At places that are whole numbers of pixels the numbers are those of the planes."""
        y = int(self.is_hit.sum(axis=1).argmax())
        self.assertLess(self.is_hit[y].sum(), WIDTH)
        line = ("--section", f"0,{y},319,{y}", "--samples", "320")
        text = self.pick(*line)
        rows = list(csv.DictReader(text.splitlines()))
        self.assertEqual(list(rows[0]), COLUMNS)
        objects = json.loads(self.pick(*line, "--json"))["samples"]
        self.assertEqual((len(rows), len(objects)), (320, 320))
        hits = 0
        for x, (row, one) in enumerate(zip(rows, objects)):
            self.assertEqual((one["x"], one["y"], float(row["x"]), float(row["y"])), (x, y, x, y))
            for column in COLUMNS[2:]:
                expected, found = self.expected(column, x, y), self.found(one)[column]
                self.assertEqual(found, expected)
                if expected is None:
                    self.assertEqual(row[column], "", (column, x))
                else:
                    self.assertTrue(np.isclose(float(row[column]), expected, rtol=5e-9, atol=0), (column, x))
            hits += one["hit"]
        self.assertGreater(hits, 20)
        self.assertEqual(len(self.pick("--section", "10.5,3,200,239").splitlines()), 101)
        with sheen.connect(self.daemon.unix) as session:
            section = session.section(FENDER, None, (0, y), (319, y), 320, size=SIZE, view="left", zoom=1.5,
                                      lines="highlight", light="rectangle")
        self.assertEqual((section.position.shape, section.light.shape), ((320, 3), (320, 2)))
        self.assertEqual(section.hit.tolist(), [one["hit"] for one in objects])
        for name, key in (("position", "point"), ("normal", "normal"), ("light", "light_st")):
            found = [array.tolist() for array in getattr(section, name)]
            self.assertEqual([array if not math.isnan(array[0]) else None for array in found],
                             [one.get(key) for one in objects])

    def test_notices_are_those_of_the_picture(self):
        """Of the model's file and of the guessed up direction, once for all samples, and none with -q."""
        with tempfile.TemporaryDirectory(prefix="sheen-test-") as folder:
            model = os.path.join(folder, "tall.obj")
            with open(os.path.join(MODELS, "sheet.obj"), encoding="utf-8") as file, open(model, "w",
                                                                                      encoding="utf-8") as copy:
                copy.write(file.read() + "t vertexedit 0/0/1 set\n")
            common = ("--size", SIZE, "--server", self.daemon.unix)
            drawn = subprocess.run([SHEEN, "render", model, "-o", os.path.join(folder, "a.png"), *common],
                                   capture_output=True, text=True, timeout=60)
            notices = drawn.stderr.splitlines()[:-1]
            self.assertEqual(len(notices), 2, drawn.stderr)
            for words in (("160,120",), ("--section", "0,120,319,120", "--samples", "5")):
                done = subprocess.run([SHEEN, "pick", model, *words, *common], capture_output=True, text=True, timeout=60)
                self.assertEqual((done.returncode, done.stderr.splitlines()), (0, notices))
                self.assertEqual(self.run_it(*words, "-q", model=model).stderr, "")

    def test_places_that_are_refused(self):
        for words, text in (((), "X,Y or --section is missing"), (("1",), "two numbers X,Y"), (("320,0",), "0,0 to 319,239"),
                            (("0,-1",), "is not in the picture"), (("1,1", "2,2"), "one argument too many"),
                            (("1,1", "--section", "0,0,1,1"), "exclude each other"), (("1,1", "--samples", "5"),
                                                                                      "--samples is for --section"),
                            (("--section", "0,0,1"), "four numbers"), (("--section", "0,0,1,240"), "0,0 to 319,239"),
                            (("--section", "0,0,1,1", "--samples", "1"), "from 2 to 4096"), (("nan,1",), "two numbers")):
            with self.subTest(words=words):
                done = self.run_it(*words)
                self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1))
                self.assertIn(text, done.stderr)
        self.assertEqual(self.run_it("1,1", model="/no/such.obj").returncode, 3)
        with sheen.connect(self.daemon.unix) as session:
            for place in ((320, 0), (0, -0.5), (float("nan"), 0)):
                with self.assertRaises(sheen.BadArgument):
                    session.pick(FENDER, None, *place, size=SIZE)
            with self.assertRaises(sheen.BadArgument):
                session.section(FENDER, None, (0, 0), (1, 1), 1)

    def test_a_section_goes_on_after_a_loss(self):
        """The connection is cut at a request in the middle; what has no answer is asked again."""
        line = ("--section", "10,20,300,200", "--samples", "60")
        whole = self.pick(*line)
        with between.Between(self.daemon, between.cut_at(wire.RENDER, 40)) as relay:
            done = subprocess.run([SHEEN, "pick", FENDER, *line, "--size", SIZE, *SCENE, "--server", relay.unix],
                                  capture_output=True, text=True, timeout=60)
            self.assertEqual(relay.n_connections, 2)
        self.assertEqual((done.returncode, done.stdout), (0, whole))
        self.assertIn("connecting again", done.stderr)

    def test_server_is_lost(self):
        """A private daemon serves it as well, and a server that goes is named."""
        daemon = Daemon()
        daemon.process.kill()
        daemon.process.wait()
        done = subprocess.run([SHEEN, "pick", FENDER, "1,1", "--server", daemon.unix, "--reconnect", "0"],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 4, done.stderr)
        done = subprocess.run([SHEEN, "pick", FENDER, "640,360", "--device", "software"], capture_output=True, text=True,
                              timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("\nface ", done.stdout)

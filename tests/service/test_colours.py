"""Colours mix as linear light, premultiplied by alpha."""
import os
import re
import shutil
import subprocess
import unittest

from daemon import MODELS, SHEEN, DaemonCase
from test_client import sheen
from test_surface import read_png

PLANE = os.path.join(MODELS, "plane.obj")
# A plane that fills the picture, so that no pixel is at an edge, and a light above the plane.
VIEW = ("--size", "40x30", "--eye", "0,-2,3", "--target", "0,0,0", "--fov", "10")
HERE = ("--light-u", "1,0,0", "--light-v", "0,1,0")
PLANE_LIGHT = ("--light", "plane", "--light-center", "0,0,4", *HERE)
MIDDLE = 15, 20


@unittest.skipUnless(os.path.exists(SHEEN), "no client in this build")
class Colours(DaemonCase):
    def draw(self, name, *arguments):
        path = os.path.join(self.daemon.folder, name)
        done = sheen("render", PLANE, "-o", path, "--server", self.daemon.unix, "-q", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return path

    def pixels(self, *arguments):
        """The rows of pixels, with three channels, or four if any pixel is not opaque."""
        width, _, rows = read_png(self.draw("a.png", *arguments))
        n = len(rows[0]) // width
        return [[tuple(row[n * x:n * x + n]) for x in range(width)] for row in rows]

    def middle(self, *arguments):
        return self.pixels(*VIEW, *arguments)[MIDDLE[0]][MIDDLE[1]]

    def assert_near(self, found, want, most=1):
        self.assertEqual(len(found), len(want), found)
        self.assertLessEqual(max(abs(a - b) for a, b in zip(found, want)), most, (found, want))

    def test_a_light_thinner_than_a_pixel_is_a_share_of_it(self):
        """Where rays run along the light's plane, places on the light change far from linearly within a pixel. 0.42
        of 20 x 20 samples of the pixel are on the light, which is displayed as 173."""
        rows = self.pixels(*VIEW, "--light", "rectangle", "--light-center", "0,2.7,4", "--light-u",
                           "0.05,0.005,0", "--light-v=-.1,1,0", "--pattern", "stripes:duty=1",
                           "--miss", "#000000")
        self.assert_near(rows[6][19], (173,) * 3, 2)

    def test_a_corner_has_its_share(self):
        """White in front of black: the outermost pixel at the corner of a plain square, whose centre sees nothing.
        0.415 of it shows surface, which is displayed as 172."""
        rows = self.pixels("--size", "320x240", "--light", "plane", "--light-center", "0,0,90",
                           *HERE, "--pattern", "stripes:duty=1", "--miss", "#ffffff", "--empty",
                           "#000000")
        self.assert_near(rows[65][304], (172,) * 3, 8)

    def test_fine_stripes_are_half_the_light(self):
        """Half the light is displayed as 188, which differs from the grey of `empty`."""
        self.assert_near(self.middle(*PLANE_LIGHT, "--pattern", "stripes:count=5000"),
                         (188, 188, 188))

    def test_a_clear_colour_is_in_no_mean(self):
        for clear in "#00000000", "#0000ff00":
            with self.subTest(clear=clear):
                self.assert_near(self.middle(
                    *PLANE_LIGHT, "--pattern", f"stripes:count=5000,bg={clear}",
                    "--light", "plane", "--light-center", "0,0,5", *HERE,
                    "--pattern", "stripes:duty=1,fg=#ff0000"), (255, 188, 188))

    def test_a_light_that_is_not_met_changes_nothing(self):
        one = PLANE_LIGHT + ("--pattern", "stripes:duty=1,fg=#ff000066")
        far = ("--light", "rectangle", "--light-center", "100,0,5", *HERE)
        self.assertEqual(self.middle(*one), (255, 0, 0, 102))
        self.assertEqual(self.middle(*one, *far), (255, 0, 0, 102))
        self.assertEqual(self.middle(*far, *one), (255, 0, 0, 102))

    def test_opacity_paints_no_clear_colour(self):
        """Half of the light is the base, in the base's own colour."""
        red, green, blue, alpha = self.middle(
            *PLANE_LIGHT, "--pattern", "stripes:duty=1,fg=#ff000000,opacity=.5", "--base",
            "#0000ff")
        self.assertEqual((red, green, alpha), (0, 0, 128))
        self.assertGreater(blue, 200)

    def test_an_edge_shows_each_light_once(self):
        """Two lights of alpha 0.4, one over the other, give 0.64; at an edge the pixel's share of that."""
        both = [word for z in (4, 5) for word in
                ("--light", "plane", "--light-center", f"0,0,{z}", *HERE, "--pattern",
                 "stripes:duty=1,fg=#ff000066")]
        found = {pixel for row in self.pixels("--size", "64x48", "--empty", "#00000000", *both)
                 for pixel in row}
        inside = (255, 0, 0, 163)
        self.assertIn(inside, found)
        edges = {pixel for pixel in found if 0 < pixel[3] < 163}
        self.assertGreater(len(edges), 3)
        self.assertEqual({pixel[:3] for pixel in edges}, {(255, 0, 0)})
        self.assertEqual(max(pixel[3] for pixel in found), 163)

    def test_images_at_borders(self):
        """Images wrap around on lights that close, repeat on planes, and elsewhere continue their border's colour. An
        orthographic view of the plane, which reflects it towards azimuth 180 degrees."""
        view = ("--size", "9x9", "--eye", "3,0,3", "--target", "0,0,0", "--ortho", "0.002")
        at = ("--light-center", "-4.75,0,4")  # the ray comes from x = 0.75, relative to the centre
        red, blue, both = (255, 0, 0), (0, 0, 255), (188, 0, 188)
        for size, options, want in (
                ("1 2", ("--lines", "zebra:0,0,1"), both),
                ("2 1", ("--lines", "environment:0,0,1"), both),
                ("2 1", ("--light", "sphere", *at, "--light-u", "1,0,0", "--light-v", "0,0,1"), both),
                ("2 1", ("--lines", "isophote:0,0,1"), red),
                ("2 1", ("--lines", "isophote:0,0,-1"), blue),
                ("1 2", ("--lines", "environment:-1,0,1"), red),
                ("2 1", ("--light", "plane", *at, *HERE), red),
                ("2 1", ("--light", "rectangle", *at, "--light-u", "1.6,0,0", "--light-v",
                         "0,1,0"), blue)):
            with self.subTest(size=size, options=options):
                path = os.path.join(self.daemon.folder, f"{size[0]}.ppm")
                with open(path, "wb") as file:
                    file.write(f"P6 {size} 255\n".encode() + bytes(red + blue))
                found = self.pixels(*view, *options, "--pattern", f"image:{path}")[4][4]
                self.assert_near(found, want)

    def told(self, *arguments):
        return subprocess.run(["oiiotool", *arguments], capture_output=True, text=True, timeout=60,
                              check=True).stdout

    @unittest.skipUnless(shutil.which("oiiotool"), "no oiiotool here")
    def test_files_say_how_colours_are_meant(self):
        """EXR holds linear, premultiplied values and says so; PNG holds sRGB with straight alpha."""
        away = ("--size", "8x6", "--eye", "0,-2,3", "--target", "0,-4,6", "--empty")
        for colour, straight, light in (
                ("#808080", (128, 128, 128), (0.2158, 0.2158, 0.2158, 1)),
                ("#80ff0080", (128, 255, 0, 128), (0.2158 * 128 / 255, 128 / 255, 0, 128 / 255))):
            with self.subTest(colour=colour):
                self.assertEqual({p for row in self.pixels(*away, colour) for p in row}, {straight})
                path = self.draw("a.exr", *away, colour)
                told = self.told("--dumpdata", path)
                found = re.search(r"Pixel \(3, 2\): ([0-9.]+) ([0-9.]+) ([0-9.]+) ([0-9.]+)", told)
                self.assertTrue(found, told)
                for value, want in zip(found.groups(), light):
                    self.assertAlmostEqual(float(value), want, delta=2e-4)
        told = self.told("--info", "-v", path)
        self.assertRegex(told, r'oiio:ColorSpace: "([Ll]inear|lin_rec709(_scene)?)"')
        self.assertRegex(told, r"chromaticities: 0\.64, 0\.33, 0\.3, 0\.6, 0\.15, 0\.06, 0\.3127, 0\.329")
        told = self.told("--info", "-v", os.path.join(self.daemon.folder, "a.png"))
        self.assertRegex(told, r'oiio:ColorSpace: "(sRGB|srgb_rec709_scene)"')

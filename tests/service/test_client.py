"""The real client with the real daemon, over each kind of address."""
import base64
import hashlib
import json
import os
import re
import socket
import subprocess
import tempfile
import time
import unittest

import wire
from daemon import BUILD, CUBE, MODELS, SHEEN, SHEEND, Daemon, grid

FENDER = os.path.join(MODELS, "fender.obj")


def sheen(*arguments, timeout=120, **options):
    return subprocess.run([SHEEN, *arguments], capture_output=True, text=True, timeout=timeout,
                          **options)


@unittest.skipUnless(os.path.exists(SHEEN), "no client in this build")
class Client(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = Daemon("--share-models")

    @classmethod
    def tearDownClass(cls):
        if cls.daemon.stop() != 0:
            raise AssertionError("the daemon did not end well")

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def render(self, name, *arguments, model=FENDER):
        done = sheen("render", model, "-o", self.path(name), "--size", "320x240", "--json",
                     *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.path(name), "rb") as file:
            return json.loads(done.stdout), file.read()

    def test_the_same_file_by_every_way(self):
        for name, *planes in (("a.png",), ("a.exr", "--aov", "P,N,ptex,light,k"), ("a.jpg",),
                              ("a.tif",)):
            files = {self.render(name, "--device", "software", *planes)[1]}
            for address in (self.daemon.unix, self.daemon.tcp):
                files.add(self.render(name, "--server", address, *planes)[1])
            with self.subTest(name=name):
                self.assertEqual(len(files), 1)

    def test_jpeg_quality(self):
        at = ("--server", self.daemon.unix)
        sizes = [len(self.render("a.jpg", *at, *options)[1])
                 for options in ((), ("--jpeg-subsampling", "420"),
                                 ("--jpeg-subsampling", "420", "--jpeg-quality", "40"))]
        self.assertEqual(sizes, sorted(sizes, reverse=True))
        self.assertEqual(len(set(sizes)), 3)
        self.assert_fails(2, ".jpg", "render", FENDER, "-o", self.path("x.png"),
                          "--jpeg-quality", "95")

    def test_second_frame_builds_nothing(self):
        model = self.path("new.obj")
        with open(model, "wb") as file:
            file.write(CUBE + b"# of this test\n")
        first, _ = self.render("a.png", "--server", self.daemon.unix, model=model)
        second, _ = self.render("b.png", "--server", self.daemon.tcp, model=model)
        self.assertGreater(first["tables_us"], 0)
        self.assertEqual(second["tables_us"], 0)

    def assert_fails(self, code, words, *arguments):
        for address in (self.daemon.unix, self.daemon.tcp):
            done = sheen(*arguments, "--server", address)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(words, done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

    def test_bad_files(self):
        for name, data in (("empty.obj", b""), ("words.obj", b"not a model\n"),
                           ("cut.glb", b"glTF\2\0\0\0\xff\0\0\0"),
                           ("range.obj", CUBE + b"f 1 2 99\n"), ("two.obj", b"v 0 0 0\nv 1 0 0\nf 1 2\n"),
                           ("none.obj", b"v 0 0 0\n"),
                           ("nan.obj", CUBE.replace(b"-1", b"nan", 1)),
                           ("huge.obj", CUBE.replace(b"-1", b"1e308", 1))):
            with open(self.path(name), "wb") as file:
                file.write(data)
            with self.subTest(name=name):
                self.assert_fails(3, name, "render", self.path(name), "-o", self.path("x.png"))
                self.assertFalse(os.path.exists(self.path("x.png")))
        with open(self.path("light.png"), "wb") as file:
            file.write(b"no image at all")
        self.assert_fails(3, "light.png", "render", FENDER, "-o", self.path("x.png"), "--pattern",
                          "image:" + self.path("light.png"))

    def test_help(self):
        for command in ("render", "stats", "figure7"):
            self.assertEqual(sheen("help", command).stdout, sheen(command, "--help").stdout)
        self.assertIn("usage: sheen render", sheen("help", "render").stdout)
        self.assertEqual(sheen("help").stdout, sheen("--help").stdout)
        done = sheen("help", "draw")
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("'draw' is no command", done.stderr)

    def test_output_to_a_full_disk(self):
        for program, code, *arguments in (
                (SHEEN, 3, "--help"), (SHEEN, 3, "help"), (SHEEN, 3, "--version"), (SHEEN, 3, "render", "--help"),
                (SHEEN, 3, "lights"), (SHEEND, 4, "--help"), (SHEEND, 4, "--version"),
                (SHEEND, 4, "--check-config")):
            with self.subTest(arguments=arguments), open("/dev/full", "w", encoding="ascii") as full:
                done = subprocess.run([program, *arguments], stdout=full, stderr=subprocess.PIPE, text=True,
                                      timeout=60)
                self.assertEqual(done.returncode, code, done.stderr)
                self.assertIn("standard output cannot be written", done.stderr)

    def test_missed_deadline(self):
        """The first frame waits for the tables of a model that the daemon does not have yet."""
        with open(self.path("sheet.obj"), "wb") as file:
            file.write(grid(300))
        done = sheen("render", self.path("sheet.obj"), "-o", self.path("x.png"), "--deadline", "1",
                     "--server", self.daemon.unix)
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertIn("within --deadline 1 ", done.stderr)

    def test_an_obj_that_is_called_gltf(self):
        for name, data, words in (("obj.gltf", CUBE, ".obj"), ("cut.gltf", b'{"asset":', "JSON")):
            with open(self.path(name), "wb") as file:
                file.write(data)
            done = sheen("info", self.path(name), "--server", self.daemon.unix)
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertRegex(done.stderr, name + ": not a glTF file.*" + words)
            self.assertNotIn("exception", done.stderr)

    def test_gltf_with_a_file_beside_it(self):
        """The picture is the same as that of the file with an embedded buffer. The model's identity is the hash of
        the GLB that the client makes."""
        with open(os.path.join(MODELS, "fender.gltf"), "rb") as file:
            gltf = json.load(file)
        uri = gltf["buffers"][0]["uri"]
        binary = base64.b64decode(uri.partition(",")[2])
        os.mkdir(self.path("a part"))
        gltf["buffers"][0]["uri"] = "a%20part/fender.bin"
        model, beside = self.path("fender.gltf"), self.path("a part/fender.bin")
        with open(model, "w") as file:
            json.dump(gltf, file)
        with open(beside, "wb") as file:
            file.write(binary)
        for address in (self.daemon.unix, self.daemon.tcp):
            embedded, picture = self.render("a.png", "--server", address,
                                            model=os.path.join(MODELS, "fender.gltf"))
            split, again = self.render("b.png", "--server", address, model=model)
            self.assertEqual(pixels_of(picture), pixels_of(again))
            self.assertNotEqual(embedded["model_sha256"], split["model_sha256"])
        info = json.loads(sheen("info", model, "--json", "--server", self.daemon.unix).stdout)
        self.assertGreater(info["file_bytes"], len(binary))
        with open(beside, "ab") as file:
            file.write(b"more than the buffer says")
        same = json.loads(sheen("info", model, "--json", "--server", self.daemon.unix).stdout)
        self.assertEqual(same["sha256"], info["sha256"])
        self.assert_fails(3, "sheen: the model's name is empty", "info", "")
        os.rename(beside, self.path("fender.bin"))
        self.assert_fails(3, "fender.bin: No such file", "info", model)
        os.symlink("../../fender.bin", beside)
        self.assert_fails(3, "fender.bin: No such file", "info", model)
        os.unlink(beside)
        os.symlink("../fender.bin", beside)
        self.assertEqual(sheen("info", model, "--server", self.daemon.unix).returncode, 0)
        for name, words in (("../x.bin", "outside of the model's folder"),
                            ("https://localhost/x.bin", "is a URL")):
            gltf["buffers"][0]["uri"] = name
            with open(model, "w") as file:
                json.dump(gltf, file)
            self.assert_fails(3, words, "render", model, "-o", self.path("c.png"))
            self.assertFalse(os.path.exists(self.path("c.png")))

    def test_json_names_every_option(self):
        """Every option's value is in --json, and render --help has no option whose value is missing there."""
        image = self.path("light.png")
        self.render("light.png", "--server", self.daemon.unix)
        first = ("--light", "plane:one-sided", "--light-center", "0,0,9", "--light-u", "8,0,0",
                 "--light-v", "0,6,0", "--pattern",
                 "lines:at=0.25/0.5,width=0.125,rotation=30,soft=0.5,fg=#102030,bg=#40506080")
        camera = ("--eye", "1,-8,6", "--target", "0,0,1", "--up", "0,1,0")
        scene = (*camera, "--fov", "30", "--lines", "isophote:0,0,2", "--line-eye", "dir:0,0,-1",
                 *first, "--light", "sphere", "--pattern", "image:" + image, "--base", "#010203",
                 "--miss", "#040506", "--empty", "#07080940", "--filter", "off", "--class",
                 "batch", "--deadline", "100000")
        found, _ = self.render("a.exr", "--server", self.daemon.unix, *scene, "--aov", "N,k",
                               "--weld")
        light = found["lights"][0]
        said = {
            "output": (found["file"], self.path("a.exr")), "aov": (found["aov"], ["N", "k"]),
            "size": ((found["width"], found["height"]), (320, 240)),
            "eye": (found["camera"]["eye"], [1, -8, 6]),
            "target": (found["camera"]["target"], [0, 0, 1]),
            "up": (found["camera"]["up"], [0, 1, 0]), "fov": (found["camera"]["fov_deg"], 30),
            "lines": ((found["lines"], found["lines_direction"]), ("isophote", [0, 0, 2])),
            "light": ((light["kind"], light["one_sided"], found["lights"][1]["kind"]),
                      ("plane", True, "sphere")),
            "light-center": (light["center"], [0, 0, 9]), "light-u": (light["u"], [8, 0, 0]),
            "light-v": (light["v"], [0, 6, 0]),
            "pattern": (light["pattern"], {
                "kind": "lines", "count": 40, "duty": 0.5, "rotation_deg": 30, "offset": 0,
                "soft": 0.5, "opacity": 1, "at": [0.25, 0.5], "width": 0.125, "fg": "#102030ff",
                "bg": "#40506080"}),
            "line-eye": (found["line_eye"], {"kind": "direction", "direction": [0, 0, -1]}),
            "base": (found["base"], "#010203ff"), "miss": (found["miss"], "#040506ff"),
            "empty": (found["empty"], "#07080940"), "filter": (found["filter"], "off"),
            "server": (found["address"], self.daemon.unix), "class": (found["class"], "batch"),
            "deadline": (found["deadline_ms"], 100000), "weld": (found["weld"], True),
        }
        closer, _ = self.render("b.png", "--server", self.daemon.unix, "--view", "top", "--zoom",
                                "4@0.25,0.75")
        said.update({"view": (closer["view"], "top"),
                     "zoom": (closer["zoom"], {"factor": 4, "at": [0.25, 0.75]})})
        with open(image, "rb") as file:
            self.assertEqual(found["lights"][1]["pattern"]["image_sha256"],
                             hashlib.sha256(file.read()).hexdigest())
        found, _ = self.render("a.png", "--device", "software", *camera, "--ortho", "3",
                               "--surface", "polygon:2", "--show", "draft:0,1,0", "--show-range",
                               "5", "--legend", "off")
        self.assertEqual((found["filter"], found["antialias"], found["line_eye"]),
                         ("exact", "exact", {"kind": "camera"}))
        self.assertEqual((found["miss"], found["empty"], found["base"]),
                         ("#29303bff", "#808080ff", "#b3b8bfff"))
        said.update({
            "ortho": (found["camera"]["ortho_height"], 3),
            "surface": ((found["surface"], found["surface_level"]), ("polygon", 2)),
            "show": ((found["show"], found["show_direction"]), ("draft", [0, 1, 0])),
            "show-range": (found["show_range"], 5), "legend": (found["legend"], "off"),
            "device": ((found["address"], found["software"]), ("private", True)),
        })
        found, _ = self.render("a.jpg", "--server", self.daemon.unix, "--jpeg-quality", "80",
                               "--jpeg-subsampling", "420", "--antialias", "off")
        self.assertEqual(found["filter"], "exact")
        said.update({"antialias": (found["antialias"], "off"),
                     "jpeg-quality": (found["jpeg_quality"], 80),
                     "jpeg-subsampling": (found["jpeg_subsampling"], "420")})
        for name, (value, wanted) in said.items():
            self.assertEqual(value, wanted, name)
        options = set(re.findall(r"^ +(?:-., )?--([a-z-]+)", sheen("render", "--help").stdout, re.M))
        not_of_the_frame = {"quiet", "json", "help", "ca", "cert", "key", "token-file", "share",
                            "reconnect", "memory-budget", "native-threads", "native-isa"}
        self.assertEqual(options - not_of_the_frame, set(said))

    def test_json_asked_again(self):
        """If the view that --json reports is requested explicitly, the picture's file is the same, byte for byte."""
        found, picture = self.render("a.exr", "--server", self.daemon.unix, "--aov", "P,N")
        places = {"--" + name: found["camera"][name] for name in ("eye", "target", "up")}
        for name in ("center", "u", "v"):
            places["--light-" + name] = found["light"][name]
        again = ["--light", found["light"]["kind"]]
        for option, value in places.items():
            again += option, ",".join(repr(number) for number in value)
        self.assertEqual(self.render("b.exr", "--server", self.daemon.unix, *again, "--aov",
                                     "P,N")[1], picture)

    def test_cameras_in_part(self):
        """--fov and --ortho alone change the default camera, which frames the model; --up alone changes how it frames
        the model."""
        whole = self.render("a.png", "--server", self.daemon.unix)
        views = {whole[1]}
        for option, value, key, want in (("--fov", "20", "fov_deg", 20),
                                         ("--ortho", "900", "ortho_height", 900),
                                         ("--up", "1,0,0", "up", [1, 0, 0])):
            answer, picture = self.render("b.png", "--server", self.daemon.unix, option, value)
            self.assertEqual(answer["camera"][key], want)
            self.assertEqual(answer["camera"]["target"] == whole[0]["camera"]["target"], key != "up")
            self.assertNotIn(picture, views)
            views.add(picture)
        self.assert_fails(2, "--up 0,0,1", "render", FENDER, "-o", self.path("x.png"), "--eye",
                          "0,5,0", "--target", "0,0,0", "--up", "0,1,0")

    def test_info_counts_tags(self):
        with open(self.path("tagged.obj"), "wb") as file:
            file.write(CUBE + b"t crease 2/1/0 0 1 10\nt crease 2/1/0 1 2 2.5\n"
                              b"t corner 1/1/0 6 3\nt hole 1/0/0 1\n")
        done = sheen("info", self.path("tagged.obj"), "--server", self.daemon.unix, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        info = json.loads(done.stdout)
        self.assertEqual([info[key] for key in ("sharp_edges", "semisharp_edges", "sharp_vertices",
                                                "holes", "nonmanifold_edges",
                                                "nonmanifold_vertices")], [1, 1, 1, 1, 0, 0])
        self.assertGreater(info["strip_patches"], 0)

    def test_frames_in_flight_outlive_the_daemon(self):
        for ending in ("png", "exr", "jpg", "tif"):
            daemon = Daemon(tcp=False)
            with subprocess.Popen([SHEEN, "render", FENDER, "-o", self.path("x." + ending),
                                   "--size", "2000x2000", "--server", daemon.unix, "--json"],
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  text=True) as client:
                with wire.Client(daemon.unix) as watcher:
                    while watcher.stats()[5] == [0] and client.poll() is None:
                        time.sleep(0.01)  # waits until the daemon has the model
                daemon.terminate()
                answer, errors = client.communicate(timeout=60)
            with self.subTest(ending=ending):
                self.assertEqual(client.returncode, 0, errors)
                self.assertEqual(json.loads(answer)["width"], 2000)
                self.assertGreater(os.path.getsize(self.path("x." + ending)), 10000)
            self.assertEqual(daemon.stop(), 0)

    def test_stream_within_its_credits(self):
        daemon = Daemon("--credits", "1", tcp=False)
        self.addCleanup(daemon.stop)
        done = sheen("stream", FENDER, "--frames", "5", "--size", "64x48", "--server", daemon.unix,
                     "--json", "--up", "z")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(len(json.loads(done.stdout)["frames"]), 5)

    def test_version(self):
        """sheen --version prints what a bug report needs: the versions of the program and of the protocol."""
        self.assertRegex(sheen("--version").stdout, r"^sheen \d+\.\d+\.\d+, protocol 1\.\d+\n$")

    def test_readme_shares_a_daemon(self):
        """The block of README.md works when it is pasted as it is: the client waits until the daemon listens."""
        with open(os.path.join(MODELS, "..", "..", "README.md"), encoding="utf-8") as file:
            block = re.search(r"## Share a daemon\n\n((?:    .*\n)+)", file.read()).group(1)
        for theirs, ours in (("/tmp/", self.folder + "/"), (" build/", f" {BUILD}/"),
                             ("part.obj", FENDER), ("part.png", self.path("part.png"))):
            self.assertIn(theirs, block)
            block = block.replace(theirs, ours)
        done = subprocess.run(["sh", "-ec", "trap 'kill $!' EXIT\n" + block], capture_output=True,
                              text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(os.path.exists(self.path("part.png")))
        self.assertIn("requests", done.stdout)

    def test_example_lights_are_seen(self):
        """The pattern of every example light is visible on the fender: another pattern gives another picture."""
        lights = json.loads(sheen("lights", "--json").stdout)["lights"]
        self.assertEqual(len(lights), 4)
        for light in lights:
            placed = light["example"].split(" --pattern ")[0].split()
            pictures = {pixels_of(self.render("a.png", *placed, "--pattern", pattern, "--server",
                                              self.daemon.unix)[1])
                        for pattern in ("stripes", "circles")}
            self.assertEqual(len(pictures), 2, light["name"])

    def test_warnings_name_the_file_once(self):
        model = self.path("t.obj")
        with open(model, "wb") as file:
            file.write(CUBE + b"t vertexedit 0/0/1 set\n")
        for command in (("info", model), ("render", model, "-o", self.path("t.png"))):
            done = sheen(*command, "--server", self.daemon.unix)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(done.stderr.splitlines()[0],
                             "sheen: warning: t.obj:15: t vertexedit is not read: the surface is drawn "
                             "as if it were not there")
            self.assertEqual(sheen(*command, "-q", "--server", self.daemon.unix).stderr, "")

    def test_schemes_of_obj_files(self):
        """A scheme that is not evaluated is refused by name, never drawn as Catmull-Clark's."""
        model = self.path("s.obj")
        for scheme, name in (("loop", "Loop"), ("bilinear", "bilinear"), ("catmark", None)):
            with open(model, "wb") as file:
                file.write(CUBE + b"t scheme 0/0/1 " + scheme.encode() + b"\n")
            for command in (("info", model), ("render", model, "-o", self.path("s.png"))):
                done = sheen(*command, "-q", "--server", self.daemon.unix)
                self.assertEqual((done.returncode, done.stderr), (0, "") if not name else
                                 (3, f"sheen: s.obj: the cage uses the {name} scheme, which sheen does not evaluate yet\n"))

    def test_nothing_to_see(self):
        """The notice appears once, not with -q, and with every command that draws."""
        away = ("--eye", "0,0,5000", "--target", "0,0,9000", "--up", "0,1,0")
        for surface in ("exact", "polygon:1", "wireframe:1"):
            for size in ("320x240", "2000x1000"):
                arguments = ("render", FENDER, "-o", self.path("a.png"), "--surface", surface,
                             "--size", size, "--class", "batch", "--server", self.daemon.unix)
                done = sheen(*arguments, *away, "--json")
                self.assertRegex(done.stderr, "^sheen: warning: no pixel shows the surface: see --eye")
                self.assertEqual(len(done.stderr.splitlines()), 2)
                self.assertTrue(json.loads(done.stdout)["blank"])
                self.assertEqual(sheen(*arguments, *away, "-q").stderr, "")
                done = sheen(*arguments, "--json")
                self.assertNotIn("warning", done.stderr)
                self.assertFalse(json.loads(done.stdout)["blank"])

    def test_bad_sizes(self):
        for size in ("0x0", "0x10", "100000x100000"):
            with self.subTest(size=size):
                self.assert_fails(2, "", "render", FENDER, "-o", self.path("x.png"), "--size", size)

    def test_no_device(self):
        done = sheen("render", FENDER, "-o", self.path("x.png"), "--device", "0",
                     env={**os.environ, "__EGL_VENDOR_LIBRARY_FILENAMES": "/dev/null"})
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertIn("EGL", done.stderr)

    def test_server_gone_in_the_middle_of_a_frame(self):
        for kind in ("unix", "tcp"):
            daemon = Daemon()
            address = daemon.unix if kind == "unix" else daemon.tcp
            with subprocess.Popen([SHEEN, "render", FENDER, "-o", self.path("x.png"), "--size",
                                   "6000x6000", "--server", address, "--reconnect", "0"], stderr=subprocess.PIPE,
                                  text=True) as client:
                time.sleep(0.5)
                daemon.process.kill()
                _, errors = client.communicate(timeout=30)
            self.assertEqual(client.returncode, 4, errors)
            self.assertEqual(len(errors.splitlines()), 1, errors)
            self.assertFalse(os.path.exists(self.path("x.png")))
            daemon.stop()

    def test_server_that_hangs_up_within_a_frame(self):
        """A relay that passes the daemon's answers on and closes the connection after some byte of them."""
        for cut in (10, 60, 400, 2000):
            with socket.create_server(("127.0.0.1", 0)) as server:
                address = f"tcp:127.0.0.1:{server.getsockname()[1]}"
                with subprocess.Popen([SHEEN, "render", FENDER, "-o", self.path("x.png"),
                                       "--server", address, "--reconnect", "0"], stderr=subprocess.PIPE,
                                      text=True) as client:
                    relay(server, self.daemon.tcp, cut)
                    _, errors = client.communicate(timeout=30)
            self.assertEqual(client.returncode, 4, errors)
            self.assertFalse(os.path.exists(self.path("x.png")))


def pixels_of(png):
    """The compressed pixels, without the texts that tell how the picture was made."""
    pixels, at = b"", 8
    while at < len(png):
        end = at + 12 + int.from_bytes(png[at:at + 4], "big")
        pixels += png[at:end] if png[at + 4:at + 8] == b"IDAT" else b""
        at = end
    return pixels


def relay(server, address, cut):
    """Passes bytes both ways until `cut` bytes of answers have been passed, then closes."""
    ours, _ = server.accept()
    host, port = address[4:].rsplit(":", 1)
    with ours, socket.create_connection((host, int(port))) as theirs:
        ours.settimeout(0.05)
        theirs.settimeout(0.05)
        while cut > 0:
            for source, target in ((ours, theirs), (theirs, ours)):
                try:
                    data = source.recv(65536 if source is ours else cut)
                except TimeoutError:
                    continue
                if not data:
                    return
                target.sendall(data)
                cut -= len(data) if source is theirs else 0

"""make install: the files that it installs, that it builds nothing, and that programs can be built with the installed
library."""
import base64
import hashlib
import importlib.metadata
import json
import os
import re
import shutil
import stat
import subprocess
import sys
import tempfile
import unittest
import zipfile

from daemon import BUILD, MODELS, SANITIZED, SHEEN, Daemon

ROOT = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
PREFIX, LIBDIR = "/opt/sheen", "/opt/sheen/lib/here"
PYTHON = f"lib/python3.{sys.version_info.minor}/dist-packages"
MODULES = ("__init__", "__main__", "breaks", "comparison", "connection", "curves", "daemon", "errors", "files", "frame",
           "header", "messages", "options", "picks", "planes", "protobuf", "scene", "session", "values", "version")
EXAMPLES = os.path.join(ROOT, "client", "examples")
STRICT = ["-Wall", "-Wextra", "-pedantic", "-Werror"]
COMMANDS = ("breaks", "compare", "info", "levels", "lights", "lines", "patterns", "pick", "render", "stats", "stream")

with open(os.path.join(ROOT, "Makefile"), encoding="utf-8") as _file:
    VERSION = re.search(r"^VERSION := (.*)$", _file.read(), re.M).group(1)

PROGRAMS = ["bin/sheen", "bin/sheend", "libexec/sheen/sheend-cage", "libexec/sheen/sheend-image"]
LINKS = {"lib/here/libsheen.so": "libsheen.so.0", "lib/here/libsheen.so.0": f"libsheen.so.{VERSION}"}
HEADERS = ("include/sheen.h", *(f"include/sheen/{part}.h" for part in (
    "base", "breaks", "compare", "curves", "files", "frame", "model", "request", "scene", "session", "stats")))
FILES = sorted([
    *PROGRAMS,
    *LINKS,
    f"lib/here/libsheen.so.{VERSION}",
    "lib/here/libsheen.a",
    "lib/here/pkgconfig/sheen.pc",
    *HEADERS,
    *(f"{PYTHON}/sheen/{module}.py" for module in MODULES),
    f"{PYTHON}/sheen/py.typed",
    f"{PYTHON}/sheen-{VERSION}.dist-info/METADATA",
    "share/man/man1/sheen.1",
    *(f"share/man/man1/sheen-{command}.1" for command in COMMANDS),
    "share/man/man5/sheend.conf.5",
    "share/man/man8/sheend.8",
    "share/bash-completion/completions/sheen",
    "share/bash-completion/completions/sheend",
    "share/zsh/site-functions/_sheen",
    "share/zsh/site-functions/_sheend",
    "share/fish/vendor_completions.d/sheen.fish",
    "share/fish/vendor_completions.d/sheend.fish",
    "share/doc/sheen/sheend.conf",
    "lib/systemd/system/sheend.service",
    "lib/systemd/system/sheend.socket",
    "lib/systemd/system/sheend-metrics.socket",
    "lib/sysusers.d/sheend.conf",
])


def install(folder):
    kind = os.path.basename(BUILD)
    sanitize = {"sanitize": ["SANITIZE=1"], "thread": ["SANITIZE=thread"]}.get(kind, [])
    env = {name: value for name, value in os.environ.items()
           if name not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "LD_PRELOAD")}
    return subprocess.run(["make", "install", f"DESTDIR={folder}", f"PREFIX={PREFIX}",
                           f"LIBDIR={LIBDIR}", *sanitize], cwd=ROOT, env=env, capture_output=True,
                          text=True, timeout=300)


def built():
    """When each file that make builds was changed; without files that tests write in the meantime."""
    times = {}
    for folder in ("", "gen", "manual", "obj/client", "obj/server", "obj/protocol", "obj/deploy"):
        top = os.path.join(BUILD, folder)
        for path, folders, names in os.walk(top):
            if not folder:
                folders.clear()
            times.update({os.path.join(path, name): os.stat(os.path.join(path, name)).st_mtime_ns
                          for name in names})
    return times


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="sheen-test-")
        cls.addClassCleanup(folder.cleanup)
        cls.root = os.path.join(folder.name, "root")
        before = built()
        done = install(cls.root)
        assert done.returncode == 0, done.stderr
        cls.output = done.stdout
        cls.rebuilt = [path for path, time in built().items() if before.get(path) != time]
        cls.prefix = cls.root + PREFIX
        cls.libdir = cls.root + LIBDIR
        cls.work = folder.name

    def path(self, *names):
        return os.path.join(self.prefix, *names)

    def there(self):
        return sorted(os.path.relpath(os.path.join(path, name), self.prefix)
                      for path, _, names in os.walk(self.root) for name in names)


class Files(Installed):
    def test_the_list(self):
        self.assertEqual(self.there(), FILES)
        self.assertEqual(install(self.root).returncode, 0)  # installs over an existing installation
        self.assertEqual(self.there(), FILES)

    def test_nothing_is_built_again(self):
        self.assertEqual(self.rebuilt, [])
        self.assertNotRegex(self.output, r"(?m)^  (CC|CXX|LD|AR|MAN) ")

    def test_modes_and_links(self):
        for name in FILES:
            with self.subTest(name=name):
                mode = os.lstat(self.path(name)).st_mode
                if name in LINKS:
                    self.assertEqual(os.readlink(self.path(name)), LINKS[name])
                else:
                    self.assertTrue(stat.S_ISREG(mode))
                    self.assertEqual(stat.S_IMODE(mode), 0o755 if name in PROGRAMS else 0o644)

    def test_no_file_names_where_it_was_installed_or_built(self):
        for name in FILES:
            with self.subTest(name=name), open(self.path(name), "rb") as file:
                text = file.read()
            self.assertNotIn(self.root.encode(), text)
            self.assertNotIn(ROOT.encode() + b"/", text)

    def test_two_folders_give_equal_objects(self):
        """Programs contain the paths that their objects contain, mostly for the debugger."""
        made = []
        env = {name: value for name, value in os.environ.items() if not name.startswith("MAKE") and name != "SANITIZE"}
        for folder in ("one", "another_folder"):
            top = os.path.join(self.work, folder)
            os.mkdir(top)
            for name in ("Makefile", "client", "protocol", "shaders"):
                os.symlink(os.path.join(ROOT, name), os.path.join(top, name))
            objects = ["build/obj/client/lib/status.c.o", "build/obj/protocol/ranges.c.o"]
            subprocess.run(["make", *objects], cwd=top, check=True, capture_output=True, env=env,
                           timeout=120)
            for name in objects:
                with open(os.path.join(top, name), "rb") as file:
                    made.append(file.read())
        self.assertEqual(made[:2], made[2:])

    def test_the_unit_starts_what_was_installed(self):
        with open(self.path("lib/systemd/system/sheend.service"), encoding="utf-8") as file:
            started = re.findall(r"^Exec(?:Start|Reload)=(\S*sheend) ", file.read(), re.M)
        self.assertEqual(started, [PREFIX + "/bin/sheend"] * 2)
        done = subprocess.run([self.path("bin/sheend"), "--config",
                               self.path("share/doc/sheen/sheend.conf"), "--check-config"],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_the_command_renders(self):
        """The installed sheen uses the installed sheend, which finds its workers. The loader needs no path."""
        picture = os.path.join(self.work, "a.png")
        env = {name: value for name, value in os.environ.items()
               if name not in ("LD_LIBRARY_PATH", "SHEEN_DAEMON", "SHEEN_SERVER")}
        done = subprocess.run([self.path("bin/sheen"), "render", os.path.join(MODELS, "plane.obj"),
                               "-o", picture, "--size", "64x48", "--device", "software"],
                              env=env, capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(os.path.exists(picture))


class Python(Installed):
    def render(self, folder):
        """Python with this folder of packages uses the installed sheend."""
        text = ("import sheen; session = sheen.connect(device='software'); "
                f"frame = session.render({os.path.join(MODELS, 'plane.obj')!r}, size=(64, 48)); session.close(); "
                "print(sheen.__file__, frame.colour.shape)")
        env = {name: value for name, value in os.environ.items() if name not in ("SHEEN_DAEMON", "SHEEN_SERVER")}
        done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=60, cwd=self.work,
                              env={**env, "PYTHONPATH": folder, "PYTHONDONTWRITEBYTECODE": "1",
                                   "PATH": self.path("bin") + ":" + os.environ["PATH"]})
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout, f"{folder}/sheen/__init__.py (48, 64, 4)\n")

    def test_package(self):
        self.render(self.path(PYTHON))
        found = [(each.name, each.version) for each in importlib.metadata.distributions(path=[self.path(PYTHON)])]
        self.assertEqual(found, [("sheen", VERSION)])

    def test_wheel(self):
        """Its files are those that are installed, with the right hashes; two folders give equal wheels."""
        name = f"sheen-{VERSION}-py3-none-any.whl"
        wheels = []
        for folder in ("one", "two"):
            made = os.path.join(self.work, folder)
            subprocess.run([sys.executable, os.path.join(ROOT, "client/python/package.py"), VERSION, made], check=True,
                           timeout=60, env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"})
            with open(os.path.join(made, name), "rb") as file:
                wheels.append(file.read())
        with open(os.path.join(BUILD, "python", name), "rb") as file:
            self.assertEqual([file.read()] * 2, wheels)
        target = os.path.join(self.work, "site")
        with zipfile.ZipFile(os.path.join(made, name)) as wheel:
            wheel.extractall(target)
            record = wheel.read(f"sheen-{VERSION}.dist-info/RECORD").decode()
            names = sorted(wheel.namelist())
        self.assertEqual(sorted(row.split(",")[0] for row in record.splitlines()), names)
        for row in record.splitlines()[:-1]:
            file_name, digest, size = row.split(",")
            with open(os.path.join(target, file_name), "rb") as file:
                data = file.read()
            found = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip("=")
            self.assertEqual(("sha256=" + found, str(len(data))), (digest, size))
        self.assertEqual([each for each in names if ".dist-info" not in each],
                         sorted([*(f"sheen/{module}.py" for module in MODULES), "sheen/py.typed"]))
        self.render(target)


class Library(Installed):
    def names(self, *command):
        text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        return re.findall(r"^[0-9a-f]+ ([A-Z]) (\S+)$", text, re.M)

    def test_it_shows_what_sheen_h_declares(self):
        header = ""
        for name in HEADERS:
            with open(self.path(name), encoding="utf-8") as file:
                header += re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)
        header = re.sub(r"^static inline .*?^}", "", header, flags=re.S | re.M)
        declared = sorted(re.findall(r"^\w[\w \n*]*?\b(sheen_\w+)\(", header, re.M))
        self.assertGreater(len(declared), 20)
        with open(os.path.join(ROOT, "client/lib/sheen.map"), encoding="utf-8") as file:
            script = re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)
        self.assertEqual(sorted(re.findall(r"(sheen_\w+);", script)), declared)
        shared = self.names("nm", "-D", "--defined-only", os.path.join(self.libdir, "libsheen.so"))
        self.assertEqual(sorted(name for kind, name in shared if kind != "A"),
                         [name + "@@SHEEN_0.1" for name in declared])
        if not SANITIZED:  # sanitizers add names of their own
            static = self.names("nm", "-g", "--defined-only", os.path.join(self.libdir, "libsheen.a"))
            self.assertEqual(sorted(name for _, name in static), declared)

    def test_its_soname(self):
        text = subprocess.run(["readelf", "-d", os.path.join(self.libdir, "libsheen.so")], check=True,
                              capture_output=True, text=True).stdout
        self.assertIn("Library soname: [libsheen.so.0]", text)

    def test_each_header_stands_alone(self):
        sources = []
        for name in HEADERS:
            sources.append(os.path.join(self.work, name.replace("/", "_") + ".c"))
            with open(sources[-1], "w", encoding="ascii") as file:
                file.write(f"#include <{name.partition('/')[2]}>\n")
        languages = (["-x", "c", "-std=c11"], ["-x", "c++", "-std=c++17"])
        compilers = [name for name in ("gcc", "clang", "clang-14") if shutil.which(name)]
        for compiler in compilers:
            for language in languages:
                with self.subTest(compiler=compiler, language=language):
                    done = subprocess.run([compiler, *language, *STRICT, "-Wshadow", "-fsyntax-only",
                                           f"-I{self.path('include')}", *sources],
                                          capture_output=True, text=True, timeout=60)
                    self.assertEqual(done.returncode, 0, done.stderr)


@unittest.skipIf(SANITIZED, "a program must have the sanitizer that the library has")
class Examples(Installed):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.daemon = Daemon()

    @classmethod
    def tearDownClass(cls):
        assert cls.daemon.stop() == 0

    def pkg_config(self, *options):
        env = {**os.environ, "PKG_CONFIG_PATH": self.libdir + "/pkgconfig",
               "PKG_CONFIG_SYSROOT_DIR": self.root}
        text = subprocess.run(["pkg-config", *options, "sheen"], env=env, check=True,
                              capture_output=True, text=True).stdout
        # The system's own libraries lie outside of the folder.
        return [word.replace(self.root + "/usr", "/usr") for word in text.split()]

    def build(self, compiler, source, name, *options):
        program = os.path.join(self.work, name)
        done = subprocess.run([*compiler, *STRICT, os.path.join(EXAMPLES, source), *options,
                               "-o", program], capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)
        return program

    def run_it(self, program, *arguments):
        done = subprocess.run([program, *arguments], capture_output=True, text=True, timeout=60,
                              env={**os.environ, "LD_LIBRARY_PATH": self.libdir})
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def expected(self, model):
        picture = os.path.join(self.work, "expected.png")
        subprocess.run([SHEEN, "render", model, "-o", picture, "--size", "320x240", "--server",
                        self.daemon.unix], check=True, capture_output=True, timeout=60)
        with open(picture, "rb") as file:
            return file.read()

    def assert_same_picture(self, program, model):
        picture = os.path.join(self.work, "example.png")
        self.run_it(program, model, picture, self.daemon.unix)
        with open(picture, "rb") as file:
            self.assertEqual(file.read(), self.expected(model))

    def test_pkg_config(self):
        self.assertEqual(self.pkg_config("--modversion"), [VERSION])
        self.assertEqual(self.pkg_config("--variable=libdir"), [self.root + LIBDIR])
        self.assertNotIn("-lssl", self.pkg_config("--libs"))
        self.assertIn("-lssl", self.pkg_config("--static", "--libs"))

    def split_gltf(self):
        """fender.gltf with its buffer in a file beside it."""
        with open(os.path.join(MODELS, "fender.gltf"), encoding="utf-8") as file:
            gltf = json.load(file)
        with open(os.path.join(self.work, "fender.bin"), "wb") as file:
            file.write(base64.b64decode(gltf["buffers"][0]["uri"].partition(",")[2]))
        gltf["buffers"][0]["uri"] = "fender.bin"
        model = os.path.join(self.work, "fender.gltf")
        with open(model, "w", encoding="utf-8") as file:
            json.dump(gltf, file)
        return model

    def test_c(self):
        model = os.path.join(MODELS, "fender.obj")
        program = self.build(["gcc", "-std=c11"], "picture.c", "picture",
                             *self.pkg_config("--cflags", "--libs"))
        needed = subprocess.run(["readelf", "-d", program], check=True, capture_output=True,
                                text=True).stdout
        self.assertIn("[libsheen.so.0]", needed)
        self.assert_same_picture(program, model)
        self.assert_same_picture(program, self.split_gltf())

    def test_c_without_the_shared_library(self):
        model = os.path.join(MODELS, "fender.obj")
        libraries = [os.path.join(self.libdir, "libsheen.a") if word == "-lsheen" else word
                     for word in self.pkg_config("--static", "--libs")]
        program = self.build(["gcc", "-std=c11"], "picture.c", "static_picture",
                             *self.pkg_config("--cflags"), *libraries)
        needed = subprocess.run(["readelf", "-d", program], check=True, capture_output=True,
                                text=True).stdout
        self.assertNotIn("libsheen", needed)
        self.assert_same_picture(program, model)

    def test_cplusplus(self):
        program = self.build(["g++", "-std=c++17"], "turntable.cpp", "turntable",
                             *self.pkg_config("--cflags", "--libs"))
        text = self.run_it(program, os.path.join(MODELS, "fender.obj"), "3", self.daemon.unix)
        shares = re.findall(r"^(\d): (0\.\d+)$", text, re.M)
        self.assertEqual([number for number, _ in shares], ["0", "1", "2"], text)
        for _, share in shares:
            self.assertTrue(0.01 < float(share) < 0.95, text)

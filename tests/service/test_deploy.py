"""deploy/: the commands in its READMEs run as they stand, and the files that it names exist."""
import json
import os
import re
import shutil
import struct
import subprocess
import tempfile
import unittest

from daemon import BUILD, CUBE, MODELS, Daemon
from test_operations import get, metrics_address
from wire import Client, PNG

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
DEPLOY = os.path.join(ROOT, "deploy")


def read(*path):
    with open(os.path.join(DEPLOY, *path), encoding="utf-8") as file:
        return file.read()


def commands(folder, kind):
    """The lines of a README's code blocks of this kind."""
    blocks = re.findall(rf"^```sh {kind}\n(.*?)^```$", read(folder, "README.md"), re.M | re.S)
    assert blocks, (folder, kind)
    return "".join(blocks).splitlines()


def shell(command, **env):
    # The READMEs name build/; the build under test may be another folder.
    command = re.sub(r"^build/", BUILD + "/", command)
    return subprocess.run(["sh", "-c", command], cwd=ROOT, capture_output=True, text=True,
                          timeout=60, env={**os.environ, **env})


class Readmes(unittest.TestCase):
    def assert_all_run(self, lines, **env):
        n = 0
        for line in lines:
            program = line.split()[0]
            if "/" not in program and not shutil.which(program):
                continue
            with self.subTest(command=line):
                done = shell(line, **env)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            n += 1
        return n

    def test_systemd(self):
        self.assertGreater(self.assert_all_run(commands("systemd", "check")), 0)
        with tempfile.TemporaryDirectory() as folder:
            lines = commands("systemd", "install")
            self.assertEqual(self.assert_all_run(lines, DESTDIR=folder), len(lines))
            there = {os.path.join(path, name)[len(folder):]
                     for path, _, names in os.walk(folder) for name in names}
        # The unit's own commands, with the installed programs.
        for path in re.findall(r"--config (\S+)", read("systemd", "sheend.service")):
            self.assertIn(path, there)

    def test_prometheus(self):
        if self.assert_all_run(commands("prometheus", "check")) == 0:
            self.skipTest("no promtool here")


class Tls(unittest.TestCase):
    def test_the_readme(self):
        """Certificates, a daemon and its clients: the README's commands word for word, except for the port."""
        with tempfile.TemporaryDirectory() as folder:
            def in_folder(line):
                return f"cd {folder} && PATH={BUILD}:$PATH {line}"

            for line in commands("tls", "make"):
                done = shell(in_folder(line))
                self.assertEqual(done.returncode, 0, line + done.stderr)
            serve, = commands("tls", "serve")
            self.assertTrue(serve.startswith("sheend --listen tls:127.0.0.1:7410 "))
            options = serve.split()[3:]
            old = os.getcwd()
            os.chdir(folder)
            try:
                daemon = Daemon("--listen", "tls:127.0.0.1:0", *options)
            finally:
                os.chdir(old)
            address = re.search(r"tls:127\.0\.0\.1:\d+", daemon.errors()).group()
            lines = commands("tls", "use")
            self.assertEqual(len(lines), 2)
            for line in lines:
                done = shell(in_folder(line.replace("tls:127.0.0.1:7410", address)))
                self.assertEqual(done.returncode, 0, done.stderr)
            said = daemon.errors()
            self.assertIn('identity="cert:CN=anna,O=Design"', said)
            self.assertIn("identity=token:farm", said)
            self.assertEqual(daemon.stop(), 0)


class Systemd(unittest.TestCase):
    @unittest.skipUnless(shutil.which("systemd-analyze"), "no systemd-analyze here")
    def test_the_threshold_is_one_that_can_fail(self):
        line = next(c for c in commands("systemd", "check") if "--threshold" in c)
        bare = re.sub(r"(?m)^(CapabilityBoundingSet|SystemCallFilter|Private\w+|Protect\w+)=.*$", "",
                      read("systemd", "sheend.service"))
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "sheend.service")
            with open(path, "w", encoding="ascii") as file:
                file.write(bare)
            done = shell(line.replace("deploy/systemd/sheend.service", path))
        self.assertNotEqual(done.returncode, 0)

    @unittest.skipUnless(shutil.which("systemd-analyze"), "no systemd-analyze here")
    def test_the_exposure_is_what_the_readme_says(self):
        line = next(c for c in commands("systemd", "check") if "--threshold" in c)
        measured = re.search(r"Overall exposure level for sheend.service: ([\d.]+)",
                             shell(line).stdout).group(1)
        said = re.search(r"with Debian 12's systemd it is ([\d.]+)\.", read("systemd", "README.md"))
        version = subprocess.run(["systemd-analyze", "--version"], capture_output=True, text=True,
                                 check=True).stdout
        if not version.startswith("systemd 252 "):
            self.skipTest("the README's figure is of systemd 252")
        self.assertEqual(said.group(1), measured)

    def test_the_drain_ends_before_its_time_to_stop(self):
        drain, = re.findall(r"(?m)^drain-timeout = (\d+)$", read("systemd", "sheend.conf"))
        stop, = re.findall(r"(?m)^TimeoutStopSec=(\d+)$", read("systemd", "sheend.service"))
        self.assertGreaterEqual(int(stop), int(drain) + 4 + 5)  # a margin

    def test_clients_keep_their_users(self):
        """In a user namespace of its own the daemon could not tell users apart."""
        for unit in ("sheend.service", "sheend.socket", "sheend-metrics.socket"):
            self.assertNotRegex(read("systemd", unit), r"(?m)^\s*PrivateUsers\s*=")

    def system_calls(self):
        """The list of system calls of the unit's SystemCallFilter; '@' names a set of systemd's, '~' removes."""
        def expand(name):
            if not name.startswith("@"):
                return {name}
            text = subprocess.run(["systemd-analyze", "syscall-filter", name], check=True,
                                  capture_output=True, text=True).stdout
            inner = re.findall(r"^ {4}([-@a-z0-9_]+)$", text, re.M)
            return set().union(*map(expand, inner))

        allowed = set()
        for line in re.findall(r"^SystemCallFilter=(.*)$", read("systemd", "sheend.service"), re.M):
            names = set().union(*map(expand, line.lstrip("~").split()))
            allowed = allowed - names if line[0] == "~" else allowed | names
        return allowed

    def numbers(self, names):
        text = subprocess.run(["gcc", "-E", "-dM", "-include", "sys/syscall.h", "-x", "c",
                               "/dev/null"], check=True, capture_output=True, text=True).stdout
        known = dict(re.findall(r"^#define __NR_(\w+) (\d+)$", text, re.M))
        return sorted(int(known[name]) for name in names if name in known)

    @unittest.skipUnless(shutil.which("systemd-analyze"), "no systemd-analyze here")
    def test_it_renders_with_the_units_system_calls(self):
        """The unit's SystemCallFilter as a seccomp program made here, because there may be no systemd."""
        numbers = self.numbers(self.system_calls())
        self.assertGreater(len(numbers), 150)
        eperm = 0x00050000 | 1
        program = struct.pack("HBBI", 0x20, 0, 0, 0)  # loads the number of the system call
        for number in numbers:
            program += struct.pack("HBBI", 0x15, 0, 1, number) + struct.pack("HBBI", 0x06, 0, 0,
                                                                            0x7fff0000)
        program += struct.pack("HBBI", 0x06, 0, 0, eperm)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "filter")
            with open(path, "wb") as file:
                file.write(program)
            script = ("import ctypes, os, sys\n"
                      "libc = ctypes.CDLL(None)\n"
                      "code = open(sys.argv[1], 'rb').read()\n"
                      "class Program(ctypes.Structure):\n"
                      "    _fields_ = [('n', ctypes.c_ushort), ('code', ctypes.c_char_p)]\n"
                      "filter = Program(len(code) // 8, code)\n"
                      "assert libc.prctl(38, 1, 0, 0, 0) == 0\n"
                      "assert libc.prctl(22, 2, ctypes.byref(filter), 0, 0) == 0\n"
                      "os.execv(sys.argv[2], sys.argv[2:])\n")
            under = ["/usr/bin/python3", "-c", script, path]
            done = subprocess.run([*under, "/bin/unshare", "--mount", "true"], capture_output=True,
                                  text=True, timeout=20)
            self.assertNotEqual(done.returncode, 0, "the filter filters nothing")
            # The leak checker of a build with sanitizers traces the process, which no unit allows.
            daemon = Daemon(under=under, env={"ASAN_OPTIONS": "detect_leaks=0"})
            with Client(daemon.unix) as client:
                frame = client.render(client.upload(CUBE, "cube.obj"), encoding=PNG)
                self.assertTrue(frame.data.startswith(b"\x89PNG"))
                with open(os.path.join(MODELS, "fender.gltf"), "rb") as file:
                    client.render(client.upload(file.read(), "fender.gltf"))
            self.assertEqual(daemon.stop(), 0)


class Prometheus(unittest.TestCase):
    def test_every_metric_that_is_named_is_there(self):
        daemon = Daemon("--metrics", "tcp:127.0.0.1:0")
        text = get(metrics_address(daemon), "/metrics")[1]
        self.assertEqual(daemon.stop(), 0)
        names = set(re.findall(r"^([a-z_]+)", text, re.M))
        labels = set(re.findall(r'(\w+)="', text)) | {"instance", "job"}
        rules, dashboard = read("prometheus", "sheen.rules.yml"), read("prometheus",
                                                                       "sheen.dashboard.json")
        expressions = re.findall(r"expr: (.*)", rules)
        expressions += [target["expr"] for panel in json.loads(dashboard)["panels"]
                        for target in panel["targets"]]
        self.assertGreater(len(expressions), 25)
        for expression in expressions:
            with self.subTest(expression=expression):
                used = set(re.findall(r"\b((?:sheen|process)_\w+)", expression))
                self.assertLessEqual(used, names)
                self.assertLessEqual(set(re.findall(r"[{,]\s*(\w+)(?:=|!)", expression)), labels)
                for label, value in re.findall(r'(stage|code|reason|answer|thread)=~?"([^"]+)"',
                                               expression):
                    for one in value.split("|"):
                        self.assertIn(f'{label}="{one}"', text)
        readme = read("prometheus", "README.md")
        for name in names - {n for n in names if n.startswith("process_")}:
            base = re.sub("_(bucket|sum|count)$", "", name)
            short = base.replace("sheen_model_cache", "")
            self.assertTrue(f"`{base}" in readme or f"`{short}`" in readme, base)

    def test_every_alert_is_tested(self):
        alerts = re.findall(r"- alert: (\w+)", read("prometheus", "sheen.rules.yml"))
        tests = read("prometheus", "rules_test.yml")
        for alert in alerts:
            self.assertEqual(len(re.findall(rf"alertname: {alert}\b", tests)), 2, alert)

"""Manual pages and completions agree with --help, and the shells understand the completions."""
import os
import pty
import re
import select
import shutil
import subprocess
import tempfile
import time
import unittest

from daemon import BUILD, SHEEN, SHEEND

MANUAL = os.path.join(BUILD, "manual")
COMMANDS = ("breaks", "compare", "info", "levels", "lights", "lines", "patterns", "pick", "render", "stats", "stream")


def read(name):
    with open(os.path.join(MANUAL, name), encoding="utf-8") as file:
        return file.read()


def output(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=60).stdout


def options_of(text):
    """(letter or '', name, takes a value) for each option of a --help."""
    rows = re.findall(r"^[ *] {1,5}(?:-(\w), )?--([a-z-]+)( \S)?", text, re.M)
    return [(letter, name, value != "") for letter, name, value in rows]


def command_options(command):
    return options_of(output(SHEEN, command, "--help"))


def daemon_options():
    return options_of(output(SHEEND, "--help"))


def items(page):
    """The bold words at the head of each entry of a page's lists, with the italic words behind them."""
    return {term.replace("\\-", "-"): argument for term, argument in
            re.findall(r"^\.TP\n\\fB(.*?)\\fR(?: \\fI(.*?)\\fR)?$", page, re.M)}


class Pages(unittest.TestCase):
    def test_every_option_of_a_command(self):
        for command in COMMANDS:
            rows = command_options(command)
            self.assertGreater(len(rows), 1)
            found = items(read(f"sheen-{command}.1"))
            for letter, name, has_value in rows:
                with self.subTest(command=command, option=name):
                    term = f"-{letter}, --{name}" if letter else f"--{name}"
                    self.assertIn(term, found)
                    self.assertEqual(found[term] != "", has_value)

    def test_every_option_of_the_daemon(self):
        rows, found = daemon_options(), items(read("sheend.8"))
        self.assertGreater(len(rows), 40)
        for _, name, has_value in rows:
            with self.subTest(option=name):
                self.assertIn("--" + name, found)
                self.assertEqual(found["--" + name] != "", has_value)

    def test_the_file_has_what_the_daemon_reads_from_it(self):
        names = {term[:-2] for term in items(read("sheend.conf.5")) if term.endswith(" =")}
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "sheend.conf")
            for _, option, _ in daemon_options():
                with open(path, "w", encoding="ascii") as file:
                    file.write(f"{option} = \x7f\n")  # bold words that are no option
                done = subprocess.run([SHEEND, "--config", path, "--check-config"],
                                      capture_output=True, text=True, timeout=60)
                with self.subTest(option=option):
                    self.assertEqual(option in names, "unknown name" not in done.stderr)

    def test_ranges_and_defaults_are_there(self):
        self.assertIn("from 1e\\-6 to 179 degrees", read("sheen-render.1").replace("\n", " "))
        self.assertNotIn("{}", read("sheen-render.1"))
        self.assertIn("1 to 86400", read("sheend.8").replace("\n", " "))
        self.assertIn("(default: auto)", read("sheend.conf.5").replace("\n", " "))

    def test_the_overview_has_every_command(self):
        page = read("sheen.1")
        listed = re.findall(r"^  sheen (\w+) [A-Z\[]", output(SHEEN, "--help"), re.M)
        self.assertEqual(sorted(listed), sorted(COMMANDS))
        for command in listed:
            self.assertIn(f"\\fBsheen {command}\\fR", page)
            self.assertIn(f"sheen\\-{command} (1)", page)

    @unittest.skipUnless(shutil.which("mandoc"), "no mandoc here")
    def test_mandoc_has_nothing_to_say(self):
        pages = [os.path.join(MANUAL, name) for name in sorted(os.listdir(MANUAL))
                 if re.search(r"\.\d$", name)]
        self.assertEqual(len(pages), 3 + len(COMMANDS))
        done = subprocess.run(["mandoc", "-Tlint", *pages], capture_output=True, text=True,
                              timeout=60)
        self.assertEqual((done.stdout + done.stderr, done.returncode), ("", 0))


class Completions(unittest.TestCase):
    """Every option is in each shell's file. The tests below run the shells themselves."""
    def test_bash(self):
        text = read("sheen.bash")
        for command in COMMANDS:
            names = re.search(rf"^        {command}\) words='(.*?)'", text, re.M).group(1).split()
            for letter, name, has_value in command_options(command):
                with self.subTest(command=command, option=name):
                    self.assertIn("--" + name, names)
                    self.assertEqual(f"{command}:--{name}" in text, has_value)
                    if letter:
                        self.assertIn("-" + letter, names)

    def test_zsh(self):
        text = read("_sheen")
        for command in COMMANDS:
            part = re.search(rf"^    {command}\)\n(.*?);;$", text, re.M | re.S).group(1)
            for letter, name, has_value in command_options(command):
                with self.subTest(command=command, option=name):
                    head = f"{{-{letter},--{name}}}'[" if letter else f"'*--{name}["
                    self.assertEqual(part.count(head), 1)
                    line = next(line for line in part.splitlines() if head in line)
                    self.assertEqual(bool(re.search(r"\]:", line)), has_value)

    def test_fish(self):
        lines = read("sheen.fish").splitlines()
        for command in COMMANDS:
            for letter, name, has_value in command_options(command):
                with self.subTest(command=command, option=name):
                    head = f"complete -c sheen -n '__fish_seen_subcommand_from {command}' -l {name} "
                    line, = [line for line in lines if line.startswith(head)]
                    self.assertEqual(" -x" in line or " -r" in line, has_value)
                    self.assertEqual(f" -s {letter} " in line, letter != "")

    def test_the_daemon(self):
        bash, zsh, fish = read("sheend.bash"), read("_sheend"), read("sheend.fish")
        for _, name, _ in daemon_options():
            with self.subTest(option=name):
                self.assertRegex(bash, rf"--{name}[ ']")
                self.assertIn(f"'*--{name}[", zsh)
                self.assertIn(f"complete -c sheend -l {name} ", fish)


    def test_what_zsh_and_fish_say(self):
        """zsh and fish show the first part of a help text, whole, and its default if that is short and the only
        one."""
        said = {"size": "width and height of the picture (default: 1280x720)",
                "fov": "vertical field of view, from 1e-6 to 179 degrees (default: 35)",
                "cert": "PEM file with the certificate to present to a TLS server",
                "show-range": "value at which the colours of --show end, on both sides",
                "memory-budget": "memory of the private daemon for the model, its tables, images and frames together, "
                                 "in main memory and on the device, at least 36M"}
        zsh, fish = read("_sheen"), read("sheen.fish")
        for name, words in said.items():
            with self.subTest(option=name):
                self.assertIn(f"--{name}[{words.replace(':', chr(92) + ':')}]", zsh)
                self.assertRegex(fish, rf"from render' -l {name} .*-d '{re.escape(words)}'\n")


class Terminal:
    """An interactive shell on a pseudo-terminal, to which the test types."""
    def __init__(self, *command):
        self.pid, self.fd = pty.fork()
        if self.pid == 0:
            os.chdir("/")
            os.execvpe(command[0], command, {"PATH": os.environ["PATH"], "TERM": "dumb", "PS1": "> ",
                                             "HOME": "/nonexistent", "INPUTRC": "/dev/null"})
        self.seen = ""

    def type(self, text, until, timeout=60):
        """Types the text, and reads until the new output matches."""
        os.write(self.fd, text.encode())
        seen, end = "", time.monotonic() + timeout
        while not re.search(until, seen):
            if not select.select([self.fd], [], [], max(0, end - time.monotonic()))[0]:
                raise AssertionError(f"no {until!r} in {seen!r}")
            seen += os.read(self.fd, 65536).decode(errors="replace")
        return seen

    def close(self):
        os.close(self.fd)
        os.waitpid(self.pid, 0)


class Bash(unittest.TestCase):
    def complete(self, program, *words):
        """The words that bash offers for the last word, cut as readline cuts it."""
        cut = [piece for word in words for piece in (re.findall(r"[:=]|[^:=]+", word) or [""])]
        quoted = " ".join("'" + word + "'" for word in (program, *cut))
        script = (f". {MANUAL}/{program}.bash; COMP_WORDS=({quoted}); "
                  f"COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); cd {MANUAL}; _{program}; "
                  "printf '%s\\n' \"${COMPREPLY[@]}\"")
        done = subprocess.run(["bash", "--norc", "-u", "-c", script], capture_output=True, text=True,
                              timeout=60)
        self.assertEqual((done.stderr, done.returncode), ("", 0))
        return done.stdout.split()

    def test_it_completes(self):
        for words, wanted in {
                ("sheen", "ren"): ["render"],
                ("sheen", "--v"): ["--version"],
                ("sheen", "render", "a.obj", "--light-"): ["--light-center", "--light-u", "--light-v"],
                ("sheen", "render", "--legend", "o"): ["on", "off"],
                ("sheen", "render", "--legend=of"): ["off"],
                ("sheen", "render", "--legend="): ["on", "off"],
                ("sheen", "render", "--surface", "polygon:"): ["1", "2", "3"],
                ("sheen", "render", "--surface", "wire"): ["wireframe:1", "wireframe:2",
                                                           "wireframe:3"],
                ("sheen", "render", "--light", "plane:o"): ["one-sided"],
                ("sheen", "stream", "--class", ""): ["interactive", "still", "batch"],
                ("sheen", "render", "--size", ""): [],
                ("sheen", "stats", ""): ["--server", "--ca", "--cert", "--key", "--token-file",
                                         "--share", "--device", "--native-threads",
                                         "--native-isa", "--memory-budget", "--quiet", "-q",
                                         "--json", "--help", "-h"],
                ("sheen", "stats", "--leg"): [],
                ("sheen", "render", "sheen.f"): ["sheen.fish"],
                ("sheen", "render", "-o", "sheen.f"): ["sheen.fish"],
                ("sheen", "render", "--ca", "sheen.f"): ["sheen.fish"],
                ("sheend", "--tls-c"): ["--tls-cert", "--tls-crl"],
                ("sheend", "--device", "s"): ["software"],
                ("sheend", "--native-isa", "v"): ["v2", "v3", "v4"],
                ("sheen", "render", "--native-isa", ""): ["auto", "v2", "v3", "v4"],
        }.items():
            with self.subTest(words=words):
                self.assertEqual(self.complete(*words), wanted)

    def test_at_a_terminal(self):
        shell = Terminal("bash", "--norc", "--noprofile", "-i")
        self.addCleanup(shell.close)
        shell.type(f"cd {MANUAL}; . ./sheen.bash; echo read''y\n", r"\nready")
        shell.type("sheen render m.obj --legend of\t", r"--legend off ")
        shell.type("\x15sheen render m.obj --surface polygon:1\t\x01echo \n",
                   r"\nsheen render m.obj --surface polygon:1")
        shell.type("sheen stat\t", r"sheen stats ")


@unittest.skipUnless(shutil.which("zsh"), "no zsh here")
class Zsh(unittest.TestCase):
    def test_at_a_terminal(self):
        shell = Terminal("zsh", "-f", "-i")
        self.addCleanup(shell.close)
        shell.type(f"PS1='> '; unsetopt zle_bracketed_paste; cd {MANUAL}; fpath=($PWD $fpath)\n", "> ")
        shell.type("autoload -U compinit; compinit -u -D; echo read''y\n", r"\nready")
        for line, wanted in {"sheen rend": "render",
                             "sheen render m.obj --legend of": "off",
                             "sheen render m.obj --light-c": "--light-center",
                             "sheen stream m.obj --class inter": "interactive",
                             "sheend --tls-ce": "--tls-cert"}.items():
            with self.subTest(line=line):
                # The completed line, printed by the shell.
                shell.type(f"\x15{line}\t\x01print -r -- '\x05|'\n",
                           r"\n" + re.escape(line[:line.rfind(' ') + 1] + wanted) + r"\|")


@unittest.skipUnless(shutil.which("fish"), "no fish here")
class Fish(unittest.TestCase):
    def complete(self, line):
        with tempfile.TemporaryDirectory() as home:
            done = subprocess.run(["fish", "--no-config", "-c",
                                   f"source {MANUAL}/sheen.fish; source {MANUAL}/sheend.fish; "
                                   f"complete -C '{line}'"], capture_output=True, text=True,
                                  timeout=60, cwd=MANUAL, env={**os.environ, "HOME": home})
        self.assertEqual((done.stderr, done.returncode), ("", 0))
        return [row.split("\t")[0] for row in done.stdout.splitlines()]

    def test_it_completes(self):
        for line, wanted in {"sheen ren": ["render"],
                             "sheen render m.obj --light-": ["--light-center", "--light-u",
                                                             "--light-v"],
                             "sheen render m.obj --legend o": ["off", "on"],
                             "sheen stream m.obj --class i": ["interactive"],
                             "sheen stats --leg": [],
                             "sheen info sheen.f": ["sheen.fish"],
                             "sheend --tls-c": ["--tls-cert", "--tls-crl"]}.items():
            with self.subTest(line=line):
                self.assertEqual(sorted(self.complete(line)), wanted)

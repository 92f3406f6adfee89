"""deploy/ci: the commands of its files run as they stand, in a repository with a target branch and a change."""
import os
import re
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as xml

from daemon import BUILD, CUBE, MODELS, SHEEN

CI = os.path.join(MODELS, "..", "..", "deploy", "ci")
CHANGED = CUBE.replace(b"v 1 1 1\n", b"v 1 1 1.01\n")


def commands(name):
    """The lines of `run: |`, or the entries of `script:`."""
    with open(os.path.join(CI, name), encoding="utf-8") as file:
        text = file.read()
    block = re.search(r"^( *)(?:- run: \||script:)\n((?:\1 {2,}.*\n)+)", text, re.M)[2]
    return "".join(re.sub(r"^ *(?:- )?", "", line) for line in re.findall(r".*(?:git show|sheen) .*\n", block))


def readme_commands():
    with open(os.path.join(CI, "README.md"), encoding="utf-8") as file:
        return "mkdir old\n" + "".join(line.strip() + "\n" for line in file if line.startswith("    "))


@unittest.skipUnless(os.path.exists(SHEEN), "no client in this build")
class Ci(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder, self.work = folder.name, os.path.join(folder.name, "work")
        self.summary = os.path.join(self.folder, "summary.md")
        self.env = {**os.environ, "PATH": f"{os.path.abspath(BUILD)}:{os.environ['PATH']}", "GITHUB_BASE_REF": "main",
                    "CI_MERGE_REQUEST_TARGET_BRANCH_NAME": "main", "RUNNER_TEMP": self.folder,
                    "GITHUB_STEP_SUMMARY": self.summary, "GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_SYSTEM": os.devnull,
                    **{f"GIT_{who}_{what}": "t@example.org" for who in ("AUTHOR", "COMMITTER")
                       for what in ("NAME", "EMAIL")}}
        origin = os.path.join(self.folder, "origin")
        self.shell(f"git init -q -b main {origin} && mkdir {origin}/parts", cwd=self.folder)
        self.write(os.path.join(origin, "parts", "hood.obj"), CUBE)
        self.shell("git add . && git commit -q -m old", cwd=origin)
        self.shell(f"git clone -q {origin} {self.work}", cwd=self.folder)

    @staticmethod
    def write(path, data):
        with open(path, "wb") as file:
            file.write(data)

    def shell(self, script, cwd, code=0):
        done = subprocess.run(["bash", "-e", "-c", script], cwd=cwd, env=self.env, capture_output=True, text=True,
                              timeout=120)
        self.assertEqual(done.returncode, code, done.stderr)

    def failures(self):
        return sum(int(suite.get("failures")) for suite in xml.parse(os.path.join(self.work, "junit.xml")).getroot())

    def both(self, script):
        """0 for the same part, 1 for a changed one."""
        self.assertIn("sheen compare", script)
        self.shell(script, self.work)
        self.assertEqual(self.failures(), 0)
        self.shell("rm -rf old", self.work)
        self.write(os.path.join(self.work, "parts", "hood.obj"), CHANGED)
        self.shell(script, self.work, code=1)
        self.assertGreater(self.failures(), 0)

    def test_github(self):
        self.both(commands("github.yml"))
        with open(self.summary, encoding="utf-8") as file:
            self.assertIn("hood.obj | differs", file.read())
        self.assertTrue(os.path.exists(os.path.join(self.work, "report", "index.html")))

    def test_gitlab(self):
        self.both(commands("gitlab.yml"))
        self.assertTrue(os.path.exists(os.path.join(self.work, "report", "index.html")))

    def test_folders(self):
        self.both(readme_commands())


if __name__ == "__main__":
    unittest.main()

"""JUnit files against what the two schemas that are most in use demand: schemas/junit_ant.xsd and junit_jenkins.xsd."""
import os
import subprocess
import xml.etree.ElementTree as xml

SCHEMAS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "schemas")


def check(path):
    """Raises AssertionError if either schema refuses the file, or if a suite's numbers are not those of its cases."""
    for name in ("junit_ant", "junit_jenkins"):
        done = subprocess.run(["xmllint", "--noout", "--nonet", "--schema", os.path.join(SCHEMAS, name + ".xsd"), path],
                              capture_output=True, text=True, timeout=60)
        if done.returncode != 0:
            raise AssertionError(f"{name}: {done.stderr}")
    for at, suite in enumerate(xml.parse(path).getroot()):
        found = {"tests": len(suite.findall("testcase")), "failures": len(suite.findall("testcase/failure")),
                 "errors": len(suite.findall("testcase/error")), "id": at}
        told = {name: int(suite.get(name)) for name in found}
        if told != found:
            raise AssertionError(f"suite {suite.get('name')} tells {told}, and has {found}")

#!/usr/bin/python3
"""Black-box tests of the daemon: run.py BUILD_DIR [unittest names]. Needs only Python's standard library,
and the package of client/python, which needs numpy."""
import os
import sys
import unittest


class Result(unittest.TextTestResult):
    """Counts the passed tests. What fails before a test begins is in `errors` and in no other count."""
    passed = 0

    def addSuccess(self, test):
        super().addSuccess(test)
        self.passed += 1


def main():
    if len(sys.argv) < 2:
        sys.exit("usage: run.py BUILD_DIR [test_module.Class.test ...]")
    os.environ["SHEEN_BUILD"] = os.path.abspath(sys.argv[1])
    folder = os.path.dirname(os.path.abspath(__file__))
    sys.path[:0] = [folder, os.path.join(os.environ["SHEEN_BUILD"], "python")]
    sys.dont_write_bytecode = True
    loader = unittest.defaultTestLoader
    names = sys.argv[2:]
    suite = loader.loadTestsFromNames(names) if names else loader.discover(folder)
    result = unittest.TextTestRunner(verbosity=2, resultclass=Result).run(suite)
    failed = len(result.failures) + len(result.errors) + len(result.unexpectedSuccesses)
    print(f"{result.passed} passed, {failed} failed")
    sys.exit(1 if failed or result.passed == 0 else 0)


if __name__ == "__main__":
    main()

"""Runs the tests of this folder and prints what Rust's test harness prints, which `cargo xtask test` counts.

    RELUME=target/debug/relume target/venv/bin/python tests/python/run.py [PATTERN]

PATTERN is a file name pattern, `test_*.py` unless given. Exits 1 when a test fails.
"""

import sys
import time
import unittest
from pathlib import Path


class Harness(unittest.TestResult):
    """One line per test, then the details of those that failed, then the counts."""

    def __init__(self):
        super().__init__()
        self.outcomes = {"ok": 0, "FAILED": 0, "ignored": 0}

    def line(self, test, outcome, why=""):
        self.outcomes[outcome] += 1
        print(f"test {test.id()} ... {outcome}{why and ', ' + ' '.join(why.split())}", flush=True)

    def addSuccess(self, test):
        self.line(test, "ok")

    def addSkip(self, test, reason):
        self.line(test, "ignored", reason)

    def addFailure(self, test, err):
        super().addFailure(test, err)
        self.line(test, "FAILED")

    def addError(self, test, err):
        # Also what fails before a test starts: a file that does not import, a setUpClass.
        super().addError(test, err)
        self.line(test, "FAILED")

    def addSubTest(self, test, subtest, err):
        super().addSubTest(test, subtest, err)
        if err is not None:
            self.line(subtest, "FAILED")

    def addExpectedFailure(self, test, err):
        self.addFailure(test, err)  # There is no expected failure here.

    def addUnexpectedSuccess(self, test):
        self.line(test, "FAILED")


def main():
    pattern = sys.argv[1] if len(sys.argv) > 1 else "test_*.py"
    folder = str(Path(__file__).resolve().parent)
    suite = unittest.TestLoader().discover(folder, pattern, folder)
    print(f"\nrunning {suite.countTestCases()} tests", flush=True)
    start, harness = time.monotonic(), Harness()
    suite.run(harness)
    details = harness.failures + harness.errors
    if details:
        print("\nfailures:")
    for test, trace in details:
        print(f"\n---- {test.id()} ----\n{trace}")
    passed, failed, ignored = harness.outcomes.values()
    word = "FAILED" if failed else "ok"
    print(
        f"\ntest result: {word}. {passed} passed; {failed} failed; {ignored} ignored; "
        f"0 measured; 0 filtered out; finished in {time.monotonic() - start:.2f}s"
    )
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

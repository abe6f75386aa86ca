"""A plugin for pytest that prints what Rust's test harness prints, which `cargo xtask test` counts.

    RELUME=target/debug/relume python -m pytest -p no:terminal -p libtest crates/relume-py/tests
"""

import time


class Harness:
    """One line per test, then the details of those that failed, then the counts."""

    def __init__(self):
        self.start = time.monotonic()
        self.outcomes = {"ok": 0, "FAILED": 0, "ignored": 0}
        self.details = []

    def line(self, name, outcome, why=""):
        self.outcomes[outcome] += 1
        print(f"test {name} ... {outcome}{why and ', ' + ' '.join(why.split())}", flush=True)

    def pytest_collectreport(self, report):
        # A file that does not import, or skips itself whole.
        if report.failed:
            self.details.append((report.nodeid, report.longreprtext))
            self.line(report.nodeid, "FAILED")
        elif report.skipped:
            self.line(report.nodeid, "ignored", report.longrepr[2])

    def pytest_collection_finish(self, session):
        print(f"\nrunning {len(session.items)} tests", flush=True)

    def pytest_runtest_logreport(self, report):
        if report.failed:
            self.details.append((report.nodeid, report.longreprtext))
            self.line(report.nodeid, "FAILED")
        elif report.skipped:
            self.line(report.nodeid, "ignored", report.longrepr[2] if isinstance(report.longrepr, tuple) else "")
        elif report.when == "call":
            self.line(report.nodeid, "ok")

    def pytest_sessionfinish(self):
        if self.details:
            print("\nfailures:")
        for name, trace in self.details:
            print(f"\n---- {name} ----\n{trace}")
        passed, failed, ignored = self.outcomes.values()
        word = "FAILED" if failed else "ok"
        print(
            f"\ntest result: {word}. {passed} passed; {failed} failed; {ignored} ignored; "
            f"0 measured; 0 filtered out; finished in {time.monotonic() - self.start:.2f}s",
            flush=True,
        )


def pytest_configure(config):
    config.pluginmanager.register(Harness())

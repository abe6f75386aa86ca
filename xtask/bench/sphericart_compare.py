"""Real spherical harmonics in f32 on one thread, ours against sphericart: `cargo xtask bench sh`.

For each degree, both evaluate directions in one large call and in calls that fit the cache, in turns; of each the faster kind counts, by the
median over rounds of the fastest call in each round. Both write row-major [direction][(degree+1)^2]. sphericart makes a new array with
each call and normalises the directions it is given; ours writes into the caller's and wants them normalised.

Prints one line per degree: name, ours, theirs in million values per second, separated by tabs.
"""

import argparse
import statistics
import subprocess
import time

import numpy as np
import sphericart

LARGE = 100_000
CACHED = [256, 1000, 4000]


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--relume", required=True, help="the example sh_rate")
    parser.add_argument("--degrees", default="4,10,13")
    parser.add_argument("--rounds", type=int, default=9)
    return parser.parse_args()


class Ours:
    """The example, answering measurements."""

    def __init__(self, program):
        self.process = subprocess.Popen([program, "serve"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def rate(self, degree, count, repeats):
        self.process.stdin.write(f"{degree} {count} {repeats}\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline()
        if not answer:
            raise SystemExit("error: the example sh_rate ended early")
        return float(answer)

    def close(self):
        self.process.stdin.close()
        self.process.wait()


class Theirs:
    def __init__(self):
        self.basis = {}

    def rate(self, degree, count, repeats):
        basis = self.basis.setdefault(degree, sphericart.SphericalHarmonics(degree))
        i = np.arange(count)
        z = 1 - (2 * i + 1) / count
        r, phi = np.sqrt(1 - z * z), 2.399963229728653 * i
        directions = np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=1).astype(np.float32)
        best = float("inf")
        for _ in range(repeats):
            start = time.perf_counter()
            values = basis.compute(directions)
            best = min(best, time.perf_counter() - start)
        assert values.dtype == np.float32 and values.shape == (count, (degree + 1) ** 2)
        return values.size / best


def main():
    arguments = parse()
    ours, theirs = Ours(arguments.relume), Theirs()
    for degree in map(int, arguments.degrees.split(",")):
        figures = {}
        for _ in range(arguments.rounds):
            for count in [LARGE, *CACHED]:
                repeats = max(3, 200_000 // count)
                for name, side in (("ours", ours), ("theirs", theirs)):
                    figures.setdefault((name, count), []).append(side.rate(degree, count, repeats) * 1e-6)
        middle = {key: statistics.median(rates) for key, rates in figures.items()}
        for count in [LARGE, *CACHED]:
            print(f"degree {degree}, {count} directions a call: {middle['ours', count]:.0f} and {middle['theirs', count]:.0f}")
        best = [max(rate for (name, _), rate in middle.items() if name == side) for side in ("ours", "theirs")]
        print(f"SH degree {degree} / sphericart\t{best[0]}\t{best[1]}", flush=True)
    ours.close()


if __name__ == "__main__":
    main()

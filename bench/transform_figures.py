#!/usr/bin/env python3
"""Times of transforms beside FFTW (pyFFTW, plans measured) and ducc0, on one thread, as ratios of alternating runs.

Usage: transform_figures.py [ROUNDS]     in a Python with numpy, pyfftw and ducc0, after a release build

    lines    64 transforms of contiguous samples, one after the other: the time of one
    columns  16 transforms along the first axis of an array of length × 16 samples
"""

import json
import statistics
import subprocess
import sys
import time
from pathlib import Path

import ducc0
import numpy as np
import pyfftw

BENCH = Path(__file__).resolve().parents[1] / "build" / "release" / "bench" / "holotrace_bench"
TYPES = {"float": np.complex64, "double": np.complex128}


def holotrace_times():
    """Microseconds of each benchmark, by its kind, type and length."""
    done = subprocess.run([BENCH, "--benchmark_filter=^(lines|columns)<", "--benchmark_format=json", "--benchmark_min_time=0.02",
                           "--benchmark_min_warmup_time=0.02"],
                          capture_output=True, check=True)
    times = {}
    for run in json.loads(done.stdout)["benchmarks"]:
        name, length = run["name"].split("/")
        kind, real = name.rstrip(">").split("<")
        times[kind, real, int(length)] = run["real_time"] / (64 if kind == "lines" else 1)
    return times


def microseconds(work):
    """Of one call, the best of some series of them: a call from Python itself takes about half a microsecond."""
    work()
    best = float("inf")
    for _ in range(5):
        start, count = time.perf_counter(), 0
        while (passed := time.perf_counter() - start) < 0.005:
            for _ in range(8):
                work()
            count += 8
        best = min(best, passed / count)
    return 1e6 * best


def other_times(kind, real, length):
    shape, axis, parts = ((64, length), 1, 64) if kind == "lines" else ((length, 16), 0, 1)
    data, result = pyfftw.ones_aligned(shape, TYPES[real]), pyfftw.empty_aligned(shape, TYPES[real])
    plan = pyfftw.FFTW(data, result, axes=(axis,), flags=("FFTW_MEASURE",), threads=1)
    data[:] = 1
    return (microseconds(plan.execute) / parts,
            microseconds(lambda: ducc0.fft.c2c(data, axes=[axis], out=result, nthreads=1)) / parts)


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    ours, others = [], []
    for _ in range(rounds):
        ours.append(holotrace_times())
        others.append({key: other_times(*key) for key in ours[-1]})
    print("kind     type    length   holotrace      FFTW     ducc0  [µs]   holotrace/FFTW  holotrace/ducc0")
    for key in ours[0]:
        mine = statistics.median(one[key] for one in ours)
        fftw, ducc = (statistics.median(one[key][i] for one in others) for i in (0, 1))
        print(f"{key[0]:<8} {key[1]:<7} {key[2]:>6} {mine:>11.2f} {fftw:>9.2f} {ducc:>9.2f} {mine / fftw:>21.2f} {mine / ducc:>16.2f}")


if __name__ == "__main__":
    main()

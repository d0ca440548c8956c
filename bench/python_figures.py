#!/usr/bin/env python3
"""Figures of the Python package on a full-HD panel, as medians and ratios of alternating runs.

Usage: python_figures.py [ROUNDS]     in a Python with holotrace (PYTHONPATH=build/release/python) and, for some lines, SciPy and PyTorch

    propagate   time of np.asarray(ht.propagate(ht.Field(array))) less that of the C++ verb (build/release/bench/holotrace_bench)
    pocketfft   ht.propagate against the same by SciPy's transforms (pocketfft), without those of lines that are known to be zero
                and with the transfer function kept, for sizes that are padded to smooth numbers and one that is not
    import      time of `import holotrace` in a new interpreter, NumPy included
    sgd         an iteration of ht.encode(method="sgd"), which takes the mean over four samples of each pixel, against loops of
                plain PyTorch (exp(i phase), zero-padded FFTs, Adam) with the same four samples and with one
    torch step  a step of an optimiser of PyTorch through holotrace.torch.Propagation against the same with torch's FFTs
"""

import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import holotrace as ht

BENCH = Path(__file__).resolve().parents[1] / "build" / "release" / "bench" / "holotrace_bench"
ROWS, COLUMNS, PITCH, WAVELENGTH, DISTANCE = 1080, 1920, 8e-6, 532e-9, 0.3


def seconds(work):
    """Seconds of the clock, and of all processors: other programs on the machine make the first longer, hardly the second."""
    start, used = time.perf_counter(), time.process_time()
    work()
    return np.array([time.perf_counter() - start, time.process_time() - used])


def cost(values):
    """The median of the processor time."""
    return statistics.median(one[1] for one in values)


def state(name, values, unit=1e3):
    clock = [unit * one[0] for one in values]
    print(f"  {name:<28} clock: median {statistics.median(clock):9.2f}, best {min(clock):9.2f}   processors: median {unit * cost(values):9.2f}")


def measure_propagate(rounds):
    print("propagate, full HD, complex64 [ms]")
    rng = np.random.default_rng(1)
    array = np.exp(2j * np.pi * rng.uniform(size=(ROWS, COLUMNS))).astype(np.complex64)
    verb = lambda: np.asarray(ht.propagate(ht.Field(array, PITCH, WAVELENGTH), DISTANCE, progress=False))  # noqa: E731
    verb()
    ours, twin, wrap = [], [], []
    for _ in range(rounds):
        ours += [seconds(verb) for _ in range(7)]
        wrap += [seconds(lambda: ht.Field(array, PITCH, WAVELENGTH)) for _ in range(7)]
        done = subprocess.run([BENCH, "--benchmark_filter=propagation_verb", "--benchmark_format=json",
                               "--benchmark_min_time=0.01", "--benchmark_repetitions=7"], capture_output=True, check=True)
        twin += [(run["real_time"] / 1e3, run["cpu_time"] / 1e3) for run in json.loads(done.stdout)["benchmarks"] if run["run_type"] == "iteration"]
    state("Python, array to array", ours)
    state("C++ verb", twin)
    state("ht.Field(array) by itself", wrap)
    clocks = [[1e3 * one[0] for one in values] for values in (ours, twin)]
    print(f"  overhead by the clock: {statistics.median(clocks[0]) - statistics.median(clocks[1]):.2f} by medians, "
          f"{min(clocks[0]) - min(clocks[1]):.2f} by the best")


def measure_import(rounds):
    print("import [s]")
    for module in ("numpy", "holotrace"):
        code = f"import time as t; a, b = t.perf_counter(), t.process_time(); import {module}; print(t.perf_counter() - a, t.process_time() - b)"
        runs = [subprocess.run([sys.executable, "-c", code], capture_output=True, check=True) for _ in range(5 * rounds)]
        times = [tuple(map(float, run.stdout.split())) for run in runs]
        state(module, times, 1)


def transfer_function(rows=2 * ROWS, columns=2 * COLUMNS):
    """Of the padded window of rows × columns samples, as the packages have it: complex64."""
    fy, fx = np.fft.fftfreq(rows, PITCH)[:, None], np.fft.fftfreq(columns, PITCH)
    kz = np.sqrt(np.maximum(0, 1 / WAVELENGTH**2 - fx**2 - fy**2))
    return np.exp(2j * np.pi * DISTANCE * kz).astype(np.complex64)


def measure_pocketfft(rounds):
    import scipy
    import scipy.fft

    print(f"propagate against SciPy {scipy.__version__} [ms]")
    workers = os.cpu_count() or 1
    rng = np.random.default_rng(1)
    for rows, columns in ((ROWS, COLUMNS), (1087, 2003)):
        # A field near the axis that fades towards its edges: no band limit matters, and both ways give the same.
        fy, fx = np.fft.fftfreq(rows)[:, None], np.fft.fftfreq(columns)
        spectrum = np.fft.fft2(np.exp(2j * np.pi * rng.uniform(size=(rows, columns)))) * (np.maximum(abs(fx), abs(fy)) < 0.2)
        array = (np.fft.ifft2(spectrum) * np.outer(np.hanning(rows), np.hanning(columns))).astype(np.complex64)
        padded = [scipy.fft.next_fast_len(2 * length) for length in (rows, columns)]
        kernel = transfer_function(*padded)

        def by_scipy():
            lines = scipy.fft.fft(array, padded[1], axis=1, workers=workers)
            spectrum = scipy.fft.fft(lines, padded[0], axis=0, workers=workers, overwrite_x=True)
            spectrum *= kernel
            lines = scipy.fft.ifft(spectrum, axis=0, workers=workers, overwrite_x=True)[:rows]
            return scipy.fft.ifft(lines, axis=1, workers=workers, overwrite_x=True)[:, :columns]

        def by_us():
            return np.asarray(ht.propagate(ht.Field(array, PITCH, WAVELENGTH), DISTANCE, progress=False))

        near = np.linalg.norm(by_scipy() - by_us()) / np.linalg.norm(by_us())
        ours, theirs = [], []
        for _ in range(rounds):
            ours += [seconds(by_us) for _ in range(5)]
            theirs += [seconds(by_scipy) for _ in range(5)]
        state(f"holotrace, {columns}×{rows}", ours)
        state(f"SciPy, padded to {padded[1]}×{padded[0]}", theirs)
        print(f"  ratio of processor time {cost(theirs) / cost(ours):.2f}, of the clock "
              f"{statistics.median(one[0] for one in theirs) / statistics.median(one[0] for one in ours):.2f}; fields differ by {near:.1e}")


def by_torch(torch, kernel):
    """The modulus in the plane, at one sample per pixel."""
    return lambda u: torch.fft.ifft2(torch.fft.fft2(u, s=(2 * ROWS, 2 * COLUMNS)) * kernel)[:ROWS, :COLUMNS].abs()


def by_torch_over_pixels(torch, kernel):
    """The root of the mean irradiance of four samples of each pixel, a quarter of the pitch from its middle."""
    fy, fx = np.fft.fftfreq(2 * ROWS)[:, None], np.fft.fftfreq(2 * COLUMNS)
    shifts = [np.exp(2j * np.pi * (fx * x + fy * y)).astype(np.complex64) for x in (-0.25, 0.25) for y in (-0.25, 0.25)]
    kernels = [kernel * torch.from_numpy(shift) for shift in shifts]

    def seen(u):
        spectrum = torch.fft.fft2(u, s=(2 * ROWS, 2 * COLUMNS))
        parts = [torch.fft.ifft2(spectrum * one)[:ROWS, :COLUMNS] for one in kernels]
        return (sum(part.real**2 + part.imag**2 for part in parts) / 4).sqrt()

    return seen


def optimiser_step(torch, to_plane, target):
    phase = (6.28 * torch.rand(ROWS, COLUMNS)).requires_grad_()
    optimiser = torch.optim.Adam([phase], lr=0.1)
    ones = torch.ones(ROWS, COLUMNS)

    def step():
        optimiser.zero_grad()
        seen = to_plane(torch.polar(ones, phase))
        scale = ((seen * target).sum() / (seen**2).sum()).detach()
        ((scale * seen - target) ** 2).mean().backward()
        optimiser.step()

    return step


def measure_torch(rounds):
    import torch

    import holotrace.torch as htt

    torch.set_num_threads(os.cpu_count() or 1)
    picture = np.random.default_rng(2).uniform(size=(ROWS, COLUMNS)).astype(np.float32)
    kernel = torch.from_numpy(transfer_function())
    space = htt.Propagation((ROWS, COLUMNS), PITCH, WAVELENGTH, DISTANCE)
    target = torch.from_numpy(picture)
    steps = {
        "torch, one sample": optimiser_step(torch, by_torch(torch, kernel), target),
        "torch, four samples": optimiser_step(torch, by_torch_over_pixels(torch, kernel), target),
        "holotrace.torch, one sample": optimiser_step(torch, lambda u: space(u).abs(), target),
    }
    panel = ht.Slm(columns=COLUMNS, rows=ROWS, pitch=PITCH)
    image = ht.Image(picture)

    def encode(iterations):
        return seconds(lambda: ht.encode(image, panel, wavelength=WAVELENGTH, method="sgd", iterations=iterations, seed=1,
                                         target_distances=DISTANCE, progress=False))

    for step in steps.values():
        step()
    encode(2)
    times = {name: [] for name in steps}
    sgd = []
    for _ in range(rounds):
        for name, step in steps.items():
            times[name] += [seconds(step) for _ in range(3)]
        sgd.append((encode(24) - encode(4)) / 20)
    print("a step of an optimiser, full HD [ms]")
    for name, values in times.items():
        state(name, values)
    state("an iteration of sgd", sgd)
    one, four, own, iteration = (cost(values) for values in (*times.values(), sgd))
    print(f"  ratios of processor time: torch step {one / own:.2f} times as fast as with torch's FFTs; sgd {four / iteration:.2f} times "
          f"as fast as the same in PyTorch, {one / iteration:.2f} times as fast as PyTorch with one sample")


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors, Python {sys.version.split()[0]}")
    measure_import(rounds)
    measure_propagate(rounds)
    for package, measure in {"SciPy": measure_pocketfft, "PyTorch": measure_torch}.items():
        try:
            measure(rounds)
        except ImportError:
            print(f"{package} is not installed: its lines are left out")
    print(f"load {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()

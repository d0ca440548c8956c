#!/usr/bin/env python3
"""Holotrace and other packages on the same tasks: time, and error against a reference that none of them has made.

Usage: compare.py [ROUNDS]     by bench/peers/compare, which installs the packages; prints a page in Markdown

    propagation   a full-HD field over 0.1 m, against the direct Rayleigh-Sommerfeld sum (NumPy, double) at some points
    points        the field of 1000 points on a full-HD panel, against their sum in double at some pixels
    picture       a phase hologram of a picture at 0.15 m by gradient descent, 40 iterations, against the picture, simulated by NumPy
    projections   the same by Gerchberg-Saxton, 20 iterations, beside slmsuite's, whose picture is in the far field
    render        the Cornell box of Mitsuba, 64 paths per pixel (bench/mitsuba_figures.py does this more thoroughly)

Times are medians of alternating rounds, the first of which is not counted.
"""

import contextlib
import importlib.metadata
import os
import platform
import statistics
import subprocess
import sys
import time
import warnings
from pathlib import Path

import numpy as np

warnings.filterwarnings("ignore")
ROUNDS = int(sys.argv[1]) if len(sys.argv) > 1 else 5
ROWS, COLUMNS, PITCH, WAVELENGTH = 1080, 1920, 8e-6, 532e-9
K = 2 * np.pi / WAVELENGTH
X = (np.arange(COLUMNS) - (COLUMNS - 1) / 2) * PITCH
Y = ((ROWS - 1) / 2 - np.arange(ROWS)) * PITCH
RNG = np.random.default_rng(1)
LEFT_OUT = {}  # package -> why


def version(package):
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return ""


def measure(contestants):
    """{name: (median seconds, last result)} of functions that are called in turn, and of those only that work."""
    times, results = {name: [] for name in contestants}, {}
    for round_ in range(ROUNDS + 1):
        for name, work in contestants.items():
            if name in LEFT_OUT:
                continue
            try:
                start = time.perf_counter()
                results[name] = work()
                if round_ > 0:
                    times[name].append(time.perf_counter() - start)
            except Exception as error:  # a package of others
                if name.startswith("Holotrace"):
                    raise
                LEFT_OUT[name] = f"{type(error).__name__}: {error}".splitlines()[0][:120]
    return {name: (statistics.median(taken), results[name]) for name, taken in times.items() if taken}


def table(title, text, rows, columns):
    print(f"\n## {title}\n\n{text}\n")
    print("| " + " | ".join(["package", *columns]) + " |")
    print("|" + "---|" * (len(columns) + 1))
    for name, *values in rows:
        print("| " + " | ".join([name, *values]) + " |")


def seconds_text(seconds):
    return f"{1e3 * seconds:.0f} ms" if seconds < 1 else f"{seconds:.1f} s"


def spherical(points, columns, rows):
    """The sum of unit spherical waves in double, for rows x columns of places."""
    u = np.zeros((len(rows), len(columns)), complex)
    for x, y, z in points:
        r = np.sqrt((columns[None, :] - x) ** 2 + (rows[:, None] - y) ** 2 + z**2)
        u += abs(z) / r * np.exp(1j * K * r)
    return u


# Propagation

def torch_transfer_function(distance):
    """Exact kz at the frequencies of the padded field, from double to complex64."""
    import torch

    fy, fx = (torch.fft.fftfreq(2 * n, PITCH, dtype=torch.float64) for n in (ROWS, COLUMNS))
    kz2 = 1 / WAVELENGTH**2 - fy[:, None] ** 2 - fx[None, :] ** 2
    return torch.exp(2j * np.pi * distance * torch.sqrt(kz2.clamp(min=0))).to(torch.complex64)


def torch_propagation(field, transfer):
    """Plain PyTorch as its users write it."""
    import torch

    spectrum = torch.fft.fft2(torch.from_numpy(field), s=(2 * ROWS, 2 * COLUMNS))
    return torch.fft.ifft2(spectrum * transfer)[:ROWS, :COLUMNS].numpy()


def compare_propagation():
    import holotrace as ht

    distance = 0.1
    points = np.c_[RNG.uniform(-2e-3, 2e-3, 20), RNG.uniform(-1e-3, 1e-3, 20), np.full(20, -0.3)]

    def light(columns, rows):
        """Spherical waves of 20 points 300 mm behind, within a window whose edges are smooth."""
        window = np.exp(-((columns[None, :] / 5e-3) ** 8)) * np.exp(-((rows[:, None] / 2.8e-3) ** 8))
        return spherical(points, columns, rows) * window

    field = light(X, Y).astype(np.complex64)
    kept = torch_transfer_function(distance) if version("torch") else None

    def of_torchoptics():
        import torch
        import torchoptics

        before = torchoptics.Field(torch.from_numpy(field), wavelength=WAVELENGTH, z=0, spacing=PITCH)
        return before.propagate_to_z(distance, propagation_method="ASM").data.numpy()

    def of_odak():
        import torch
        from odak.learn.wave import propagate_beam

        return propagate_beam(torch.from_numpy(field), K, distance, PITCH, WAVELENGTH,
                              propagation_type="Bandlimited Angular Spectrum", zero_padding=[True, False, True]).numpy()

    found = measure({
        "Holotrace": lambda: np.asarray(ht.propagate(ht.Field(field, PITCH, WAVELENGTH), distance, progress=False)),
        "PyTorch loop, transfer function kept": lambda: torch_propagation(field, kept),
        "PyTorch loop": lambda: torch_propagation(field, torch_transfer_function(distance)),
        "torchoptics": of_torchoptics,
        "odak": of_odak,
    })
    # The direct sum at places in the middle half. At three times the samples the kernel is sampled finely enough, too.
    places = [(int(j), int(i)) for j, i in zip(RNG.integers(270, 810, 8), RNG.integers(480, 1440, 8))]
    columns, rows = (np.arange(3 * n) - (3 * n - 1) / 2 for n in (COLUMNS, ROWS))
    columns, rows = columns * PITCH / 3, -rows * PITCH / 3
    fine, exact = light(columns, rows), []
    for j, i in places:
        r = np.sqrt((columns[None, :] - X[i]) ** 2 + (rows[:, None] - Y[j]) ** 2 + distance**2)
        exact.append((fine * (distance / (2 * np.pi) * (1 / r - 1j * K) * np.exp(1j * K * r) / r**2)).sum() * (PITCH / 3) ** 2)
    exact = np.array(exact)

    def error(got):
        at = np.array([got[place] for place in places], complex)
        return np.linalg.norm(at - exact) / np.linalg.norm(exact)

    lines = [(name, seconds_text(taken), f"{taken / found['Holotrace'][0]:.1f}", f"{error(got):.1e}")
             for name, (taken, got) in found.items()]
    table("Propagation", f"A full-HD field ({COLUMNS} × {ROWS}, 8 µm, 532 nm) over 100 mm, with zeros around it. Holotrace keeps the transfer function "
          "of a distance from one call to the next; so does the second line; the others make it anew. torchoptics computes in double. "
          "The error is the relative L2 distance from the direct Rayleigh–Sommerfeld sum in double at 8 places.",
          lines, ["time", "× Holotrace", "error"])


# Points

def compare_points():
    import holotrace as ht

    count = 1000
    # So near to the axis that the panel's pixels hold every wave on the whole panel (Holotrace cuts a wave off where they do not).
    points = np.c_[RNG.uniform(-1.5e-3, 1.5e-3, count), RNG.uniform(-3e-3, 3e-3, count), RNG.uniform(-0.32, -0.29, count)]

    def of_torch():
        import torch

        x, y = torch.from_numpy(X), torch.from_numpy(Y)
        u = torch.zeros((ROWS, COLUMNS), dtype=torch.complex64)
        for px, py, pz in points:
            r = torch.sqrt((x[None, :] - px) ** 2 + (y[:, None] - py) ** 2 + pz**2)
            turns = (r / WAVELENGTH).remainder(1).to(torch.float32)  # in double: a float has no digits left for the phase
            u += torch.polar((abs(pz) / r).to(torch.float32), 2 * np.pi * turns)
        return u.numpy()

    sources = ht.Sources(points, wavelength=WAVELENGTH)
    panel = ht.Slm(columns=COLUMNS, rows=ROWS, pitch=PITCH)
    found = measure({
        "Holotrace, tolerance 1e-3": lambda: np.asarray(ht.synthesize(sources, panel, progress=False)),
        "Holotrace, tolerance 1e-4": lambda: np.asarray(ht.synthesize(sources, panel, tolerance=1e-4, progress=False)),
        "PyTorch loop": of_torch,
    })
    rows_, columns_ = RNG.integers(0, ROWS, 12), RNG.integers(0, COLUMNS, 12)
    exact = spherical(points, X[columns_], Y[rows_])
    first = found["Holotrace, tolerance 1e-3"][0]
    rows = [(name, seconds_text(taken), f"{taken / first:.1f}",
             f"{np.linalg.norm(got[np.ix_(rows_, columns_)] - exact) / np.linalg.norm(exact):.1e}")
            for name, (taken, got) in found.items()]
    table("Points", "The field of 1000 points 290 to 320 mm behind a full-HD panel. The error is the relative L2 distance from the sum in double at 144 pixels.",
          rows, ["time", "× Holotrace", "error"])


# Picture

def chart():
    """A picture with edges, fine lines and grey ramps; amplitude."""
    y, x = np.mgrid[0:ROWS, 0:COLUMNS]
    light = 0.25 + 0.25 * np.sin(2 * np.pi * x / np.maximum(8, 64 - x / 40)) * (y > 540) + 0.5 * (((x // 120) + (y // 120)) % 2) * (y <= 540)
    margin = (x > 160) & (x < COLUMNS - 160) & (y > 120) & (y < ROWS - 120)
    return np.sqrt(np.where(margin, light, 0)).astype(np.float32)


def psnr(seen, target):
    """Of amplitudes, at the best scale."""
    scale = (seen * target).sum() / (seen * seen).sum()
    return 10 * np.log10(target.max() ** 2 / ((scale * seen - target) ** 2).mean())


def transfer_function(distance):
    fy, fx = (np.fft.fftfreq(2 * n, PITCH) for n in (ROWS, COLUMNS))
    return np.exp(2j * np.pi * distance * np.sqrt(1 / WAVELENGTH**2 - fy[:, None] ** 2 - fx[None, :] ** 2))


def seen_at(distance, phase):
    """The amplitude that a panel of these phases makes at a distance, by NumPy in double."""
    spectrum = np.fft.fft2(np.exp(1j * phase), s=(2 * ROWS, 2 * COLUMNS))
    return abs(np.fft.ifft2(spectrum * transfer_function(distance))[:ROWS, :COLUMNS])


def phase_by_holotrace(target, distance, **parameters):
    import holotrace as ht

    hologram = ht.encode(ht.Image(target**2, pitch=PITCH), ht.Slm(columns=COLUMNS, rows=ROWS, pitch=PITCH), wavelength=WAVELENGTH,
                         target_distances=distance, image="real", progress=False, **parameters)
    return hologram.phase


def compare_picture():
    distance, iterations, target = 0.15, 40, chart()
    transfer = transfer_function(distance)

    def of_torch():
        import torch

        h, wanted = torch.from_numpy(transfer.astype(np.complex64)), torch.from_numpy(target)
        phase = (2 * np.pi * torch.rand((ROWS, COLUMNS))).requires_grad_()
        scale = torch.ones((), requires_grad=True)
        # The best of six starts and rates that were tried.
        optimiser = torch.optim.Adam([{"params": [phase], "lr": 0.3}, {"params": [scale], "lr": 0.01}])
        for _ in range(iterations):
            optimiser.zero_grad()
            spectrum = torch.fft.fft2(torch.polar(torch.ones_like(phase), phase), s=(2 * ROWS, 2 * COLUMNS))
            seen = torch.fft.ifft2(spectrum * h)[:ROWS, :COLUMNS].abs()
            torch.mean((scale * seen - wanted) ** 2).backward()
            optimiser.step()
        return (torch.round(phase.detach() / (2 * np.pi) * 256) * (2 * np.pi / 256)).numpy()  # levels of a panel

    found = measure({"Holotrace, `sgd`": lambda: phase_by_holotrace(target, distance, method="sgd", iterations=iterations),
                     "PyTorch loop, Adam": of_torch})
    first = found["Holotrace, `sgd`"][0]
    rows = [(name, seconds_text(taken), f"{taken / first:.1f}", f"{psnr(seen_at(distance, got), target):.1f} dB")
            for name, (taken, got) in found.items()]
    table("Picture", f"A phase hologram of 256 levels of a picture 150 mm in front of a full-HD panel after {iterations} iterations. PSNR of the amplitude at the pixels' "
          "middles, by NumPy in double. Holotrace integrates light over pixels and takes care of the aperture as well, which this measure does not reward.",
          rows, ["time", "× Holotrace", "PSNR"])


def compare_projections():
    distance, iterations, target = 0.15, 20, chart()

    def of_slmsuite():
        with contextlib.redirect_stdout(sys.stderr):  # it greets
            from slmsuite.holography.algorithms import Hologram

            hologram = Hologram(target)
            hologram.optimize("GS", maxiter=iterations, verbose=False)
        return hologram.get_phase()

    found = measure({"Holotrace": lambda: phase_by_holotrace(target, distance, method="gerchberg-saxton", iterations=iterations),
                     "slmsuite": of_slmsuite})
    seen = {"Holotrace": lambda phase: seen_at(distance, phase),
            "slmsuite": lambda phase: abs(np.fft.fftshift(np.fft.fft2(np.exp(1j * phase))))}
    first = found["Holotrace"][0]
    rows = [(name, seconds_text(taken), f"{taken / first:.1f}", f"{psnr(seen[name](got), target):.1f} dB")
            for name, (taken, got) in found.items()]
    table("Gerchberg–Saxton", f"A phase hologram of the same picture by {iterations} iterations of Gerchberg–Saxton: Holotrace's picture is 150 mm in front of the panel, with zeros "
          "around the panel; slmsuite's is in the far field, behind a lens, on as many samples as the panel has pixels: a quarter of the transforms' samples, and a plane in which a random start leaves speckle. "
          "The PSNR is that of the amplitude in each one's own plane.",
          rows, ["time", "× Holotrace", "PSNR"])


def compare_render():
    program = Path(__file__).resolve().parents[1] / "mitsuba_figures.py"
    done = subprocess.run([sys.executable, program, str(max(2, ROUNDS // 2))], capture_output=True, text=True, check=False)
    print("\n## Render\n\nProcessor time and squared error of two scenes at 64 paths per pixel, on one thread, beside Mitsuba 3 "
          "(`bench/mitsuba_figures.py`).\n")
    if done.returncode != 0:
        LEFT_OUT["Mitsuba"] = (done.stderr.strip().splitlines() or ["no output"])[-1][:120]
        print("Not measured in this run.")
    else:
        print("```text\n" + done.stdout.strip() + "\n```")


def head():
    commit = subprocess.run(["git", "rev-parse", "--short=8", "HEAD"], capture_output=True, text=True, check=False).stdout.strip()
    cpu = next((line.split(":", 1)[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")),
               platform.machine())
    packages = ", ".join(f"{name} {version(name)}" for name in ("torch", "torchoptics", "odak", "slmsuite", "mitsuba") if version(name))
    print("# Holotrace beside others\n\nThe same tasks by Holotrace, by other packages, and by the loop in PyTorch that many labs write, on one machine in one run. "
          "`bench/peers/compare` makes this page; do not edit it by hand. "
          "[Coming from other packages](../how_to/come_from_other_packages.md) says what differs in axes, units and signs.\n")
    print(f"Commit {commit}; {cpu}, {os.cpu_count()} threads; {packages}; medians of {ROUNDS} rounds.")


if __name__ == "__main__":
    head()
    for task in (compare_propagation, compare_points, compare_picture, compare_projections, compare_render):
        task()
    if LEFT_OUT:
        print("\n## Left out\n")
        for name, why in LEFT_OUT.items():
            print(f"- {name}: {why}")

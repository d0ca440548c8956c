#!/usr/bin/env python3
"""
Runs the same jobs by builds of the program for two processors, and compares their files by tolerance, with NumPy and readers
that are not the program's:

  compare_processors.py PROGRAM OTHER

Bytes hold on processors with the same instruction set only: other vectors, fused products and other libraries of mathematics
round in another way. Both programs read the files of PROGRAM, so that a job shows what its own stage does. The exit code is 1
if a difference is above its limit or a job fails.
"""
import dataclasses
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "scripts" / "pins"))

from differences import READERS  # noqa: E402

PANEL = "--columns 160 --rows 120 --pitch '8 um'"
SMALL = "--columns 48 --rows 36"


def values(path):
    """All numbers of a file, as one array of doubles."""
    parts = READERS[path.suffix](path.read_bytes())
    arrays = [np.asarray(part, float) for part in parts.values() if not isinstance(part, (str, dict))]
    return np.concatenate([array.ravel() for array in arrays])


def error(a, b):
    """‖a − b‖/‖a‖."""
    return np.linalg.norm(a - b) / np.linalg.norm(a) if a.shape == b.shape else np.inf


def share_of_levels(a, b):
    """Pixels whose levels differ by one step, between 255 and 0, too; infinite if any differs by more."""
    if a.shape != b.shape:
        return np.inf
    steps = np.abs(a - b)
    steps = np.minimum(steps, 256 - steps)
    return np.mean(steps > 0) if steps.max() <= 1 else np.inf


def share_of_numbers(a, b):
    """Numbers that differ by more than a ten-thousandth of the largest."""
    return np.mean(np.abs(a - b) > 1e-4 * np.abs(a).max()) if a.shape == b.shape else np.inf


@dataclasses.dataclass
class Job:
    """
    command  of the program, without its output; FILES stands for the folder of those that PROGRAM wrote before
    output   name of its file
    measure  of the difference
    limit    of the measure
    """
    command: str
    output: str
    measure: object
    limit: float


# Limits are a few times what rounding does. In double precision the path of a wave keeps an epsilon of the 6·10⁴ wavelengths to
# its plane, 1e-11 cycles, at worst, and as a rule, with the path beyond the axis alone, a thousandth of that. In single precision
# phases are fractions of a cycle, of an epsilon of 6e-8, in sums of 300 waves. A level changes where its phase lies, within about
# 1e-6 cycles, between two of 256. A path that rounds past an edge or a random choice becomes another one.
JOBS = [
    Job(f"field FILES/waves.ply {PANEL} --method exact --double", "exact.npy", error, 1e-12),
    Job(f"field FILES/waves.ply {PANEL} --method tiled", "tiled.npy", error, 5e-6),
    Job(f"field FILES/waves.ply {PANEL} --method planes", "planes.npy", error, 5e-6),
    Job(f"field FILES/waves.ply {PANEL} --method layers --tolerance 0.9", "layers.npy", error, 5e-6),
    Job("propagate FILES/exact.npy --distance '30 mm' --double", "double.npy", error, 1e-12),
    Job("propagate FILES/tiled.npy --distance '30 mm'", "single.npy", error, 5e-6),
    Job("encode FILES/exact.npy --method phase", "phase.png", share_of_levels, 1e-3),
    Job("encode FILES/exact.npy --method double-phase", "double_phase.png", share_of_levels, 1e-3),
    Job("encode FILES/exact.npy --method off-axis", "off_axis.png", share_of_levels, 1e-3),
    Job("show FILES/phase.png --distance '31 mm'", "view.exr", error, 5e-6),
    Job(f"render {ROOT}/examples/cornell_box.toml {SMALL} --paths 4 --denoise none", "render.exr", share_of_numbers, 5e-3),
    Job(f"trace {ROOT}/examples/glass_and_mirror.toml {SMALL} --paths 2", "sources.ply", share_of_numbers, 5e-3),
]


def write_waves(path):
    """300 waves behind a panel of 1.3 mm × 1 mm, as the program reads them."""
    random, count = np.random.default_rng(1), 300
    columns = {"x": ("<f8", -5e-4, 5e-4), "y": ("<f8", -4e-4, 4e-4), "z": ("<f8", -0.034, -0.028),
               "amplitude": ("<f4", 0.2, 1), "phase": ("<f4", 0, 2 * np.pi)}
    waves = np.zeros(count, [(name, kind) for name, (kind, _, _) in columns.items()])
    for name, (_, low, high) in columns.items():
        waves[name] = random.uniform(low, high, count)
    properties = "".join(f"property {'double' if kind == '<f8' else 'float'} {name}\n" for name, (kind, _, _) in columns.items())
    head = f"ply\nformat binary_little_endian 1.0\ncomment wavelength_m 5.32e-07\nelement vertex {count}\n{properties}end_header\n"
    path.write_bytes(head.encode() + waves.tobytes())


def run(program, job, files, folder):
    """The numbers that a job writes into a folder; none if it fails, which is printed."""
    command = [str(program), *shlex.split(job.command.replace("FILES", str(files))), "-o", str(folder / job.output)]
    environment = os.environ | {"XDG_CACHE_HOME": os.devnull}  # rates by which a method plans are then not measured, but the same
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    if done.returncode:
        print(f"{shlex.join(command)}\n{done.stderr.strip()}")
        return None
    return values(folder / job.output)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__.strip())
    programs = [pathlib.Path(name).resolve() for name in sys.argv[1:]]
    is_within = True
    with tempfile.TemporaryDirectory() as work:
        folders = [pathlib.Path(work, name) for name in ("one", "other")]
        for folder in folders:
            folder.mkdir()
        write_waves(folders[0] / "waves.ply")
        print(f"{'file':18} {'difference':>10} {'limit':>8}")
        for job in JOBS:
            found = [run(program, job, folders[0], folder) for program, folder in zip(programs, folders)]
            if any(numbers is None for numbers in found):
                is_within = False
                continue
            difference = job.measure(*found)
            is_within &= difference <= job.limit
            print(f"{job.output:18} {difference:10.1e} {job.limit:8.0e}{'' if difference <= job.limit else '  too large'}", flush=True)
    return 0 if is_within else 1


if __name__ == "__main__":
    sys.exit(main())

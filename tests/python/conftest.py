"""What the tests of the Python package share: the program, whose files are the reference, and small nouns."""

import os
import subprocess

import numpy as np
import pytest

import holotrace as ht


@pytest.fixture
def program(tmp_path):
    """Runs the program in a folder of its own; returns its standard output."""

    def run(*arguments):
        command = [os.environ["HOLOTRACE_PROGRAM"], *map(str, arguments)]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture
def program_error(tmp_path):
    """Runs the program, which must fail; returns its sentence."""

    def run(*arguments):
        command = [os.environ["HOLOTRACE_PROGRAM"], *map(str, arguments)]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 1
        return done.stderr.removeprefix("holotrace: ").strip()

    return run


def random_samples(shape, dtype=np.complex64, seed=1):
    rng = np.random.default_rng(seed)
    return (rng.normal(size=shape) + 1j * rng.normal(size=shape)).astype(dtype)


@pytest.fixture
def field():
    """A random field of odd and even sides: rows and columns cannot be confused."""
    return ht.Field(random_samples((33, 48)), pitch="8 um", wavelength="632.8 nm")


@pytest.fixture
def points():
    """Waves of a few points at several depths, from a fixed seed."""
    rng = np.random.default_rng(2)
    places = np.column_stack([rng.uniform(-1e-3, 1e-3, (20, 2)), rng.uniform(-0.12, -0.08, 20)])
    return ht.Sources(places, rng.uniform(0.5, 1, 20), rng.uniform(0, 6, 20), wavelength=532e-9)

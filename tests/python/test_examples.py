"""The examples run, and mypy accepts them and the package."""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import holotrace

SOURCE = Path(__file__).parents[2]
sys.path.insert(0, str(SOURCE / "tests" / "docs"))
from pages import blocks_of, pages  # noqa: E402
from run_commands import is_of_package, make_folder  # noqa: E402

EXAMPLES = sorted((SOURCE / "python" / "examples").glob("*.py"))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs(example, tmp_path):
    if "import torch" in example.read_text() and importlib.util.find_spec("torch") is None:
        pytest.skip("torch is not installed; pip install torch")
    done = subprocess.run([sys.executable, example], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    assert done.stdout
    for name in re.findall(r'\.save\("([^"]+)"', example.read_text()):
        assert (tmp_path / name).stat().st_size > 0


PAGES = [page for page in pages() if is_of_package(page)]


def code_of(page):
    """The Python blocks of a page, less those of PyTorch and JAX where these are not installed."""
    blocks = [block.text for block in blocks_of(page) if block.words == ["python"]]
    absent = [name for name in ("torch", "jax") if importlib.util.find_spec(name) is None]
    return "\n".join(text for text in blocks if not any(f"import {name}" in text for name in absent))


def test_the_pages_with_examples_are_found():
    """Among them the README, whose example is at most 10 lines."""
    names = {str(page.relative_to(SOURCE)) for page in PAGES}
    assert {"README.md", "docs/python.md", "docs/tutorial/first_hologram_in_python.md"} <= names
    assert len(code_of(SOURCE / "README.md").strip().splitlines()) <= 10


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_examples_of_a_page_run(page, tmp_path):
    """Every ```python block, one after the other in one interpreter, with stand-ins for the files that a reader brings."""
    make_folder(tmp_path)
    done = subprocess.run([sys.executable, "-c", code_of(page)], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_the_reference_names_all_of_the_package():
    page = (SOURCE / "docs" / "reference" / "python.md").read_text()
    assert [name for name in holotrace.__all__ if name != "__version__" and not re.search(rf":: (holotrace\.)?{name}\b", page)] == []


def test_mypy_passes(tmp_path):
    """mypy reads the package as it is installed: with the stubs that are made from the lists of parameters."""
    if shutil.which("mypy") is None:
        pytest.skip("mypy is not installed")
    package = os.environ["PYTHONPATH"]
    (tmp_path / "modules.py").write_text("import holotrace.interchange, holotrace.jax, holotrace.torch\n")
    done = subprocess.run(
        ["mypy", "--config-file", Path(__file__).with_name("mypy.ini"), "--cache-dir", os.devnull, "--python-executable",
         sys.executable, tmp_path / "modules.py", *EXAMPLES],
        env={**os.environ, "MYPYPATH": package}, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_mypy_knows_the_parameters(tmp_path):
    if shutil.which("mypy") is None:
        pytest.skip("mypy is not installed")
    (tmp_path / "wrong.py").write_text(
        'import holotrace as ht\nht.propagate(ht.load_field("f.npy"), 0.1, method="fresnell")\n'
        'ht.propagate(ht.load_field("f.npy"), 0.1, periodical=True)\n')
    done = subprocess.run(
        ["mypy", "--cache-dir", os.devnull, "--python-executable", sys.executable, tmp_path / "wrong.py"],
        env={**os.environ, "MYPYPATH": os.environ["PYTHONPATH"]}, capture_output=True, text=True)
    assert 'incompatible type "Literal[\'fresnell\']"' in done.stdout and "periodical" in done.stdout, done.stdout

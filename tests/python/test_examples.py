"""The examples run, and mypy accepts them and the package."""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2]
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


def test_the_examples_of_the_pages_run(tmp_path):
    """Every ```python block of a page, one after the other in one interpreter; README's is at most 10 lines."""
    shutil.copytree(SOURCE / "examples", tmp_path / "examples")
    for page in ("README.md", "docs/python.md"):
        blocks = re.findall(r"^```python\n(.*?)^```", (SOURCE / page).read_text(), re.MULTILINE | re.DOTALL)
        assert blocks, page
        if page == "README.md":
            assert sum(len(block.strip().splitlines()) for block in blocks) <= 10
        code = "\n".join(block for block in blocks if "torch" not in block or importlib.util.find_spec("torch"))
        done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, f"{page}: {done.stderr}"


def test_mypy_passes():
    """mypy reads the package as it is installed: with the stubs that are made from the lists of parameters."""
    if shutil.which("mypy") is None:
        pytest.skip("mypy is not installed")
    package = os.environ["PYTHONPATH"]
    done = subprocess.run(
        ["mypy", "--config-file", Path(__file__).with_name("mypy.ini"), "--cache-dir", os.devnull, "--python-executable",
         sys.executable, *EXAMPLES],
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

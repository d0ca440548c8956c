"""The notebooks of the documentation run from their first cell to the last, and show pictures."""

import importlib.util
import json
from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).parents[2] / "docs" / "notebooks").glob("*.ipynb"))


def test_there_are_notebooks_and_their_outputs_are_stripped():
    assert len(NOTEBOOKS) >= 3
    for path in NOTEBOOKS:
        for cell in json.loads(path.read_text())["cells"]:
            assert not cell.get("outputs") and cell.get("execution_count") is None, path.name


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_shows_pictures(path, tmp_path):
    nbformat = pytest.importorskip("nbformat", reason="nbformat is not installed; scripts/setup --tests installs it")
    nbclient = pytest.importorskip("nbclient", reason="nbclient is not installed; scripts/setup --tests installs it")
    pytest.importorskip("ipykernel", reason="ipykernel is not installed; scripts/setup --tests installs it")
    if "import torch" in path.read_text() and importlib.util.find_spec("torch") is None:
        pytest.skip("torch is not installed; pip install torch")
    notebook = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    said = "".join(output["text"] for output in outputs if output.get("name") == "stderr")  # progress bars alone
    # A package that PyTorch brings wants progress bars as widgets, which no notebook here needs.
    assert "Warning" not in said.replace("TqdmWarning: IProgress not found", ""), said
    pages = [output["data"]["text/html"] for output in outputs if "text/html" in output.get("data", {})]
    assert any("data:image/png;base64," in page for page in pages)

"""Notebooks as pages: they run while the site is built, and each cell stands above what it shows."""

import importlib.util
import re
import tempfile

import nbclient
import nbformat
from myst_parser.parsers.sphinx_ import MystParser


def missing_modules(source):
    return sorted({name for name in re.findall(r"^import (\w+)", source, re.M) if importlib.util.find_spec(name) is None})


def shown(output):
    """What a cell shows, as Markdown: a page, a picture or text. Progress, on standard error, is left out."""
    data = output.get("data", {})
    if "text/html" in data:
        return f"```{{raw}} html\n<div class=\"output\">{data['text/html']}</div>\n```\n"
    if "image/png" in data:
        return f"![](data:image/png;base64,{data['image/png']})\n"
    text = data.get("text/plain") or (output.get("text", "") if output.get("name") == "stdout" else "")
    return f"```{{code-block}} text\n:class: output\n\n{text.rstrip()}\n```\n" if text else ""


def page_of(source, name):
    """The Markdown of a notebook that has run. Without a module that it imports, it stands there as it is."""
    notebook = nbformat.reads(source, as_version=4)
    missing = missing_modules("\n".join(cell.source for cell in notebook.cells))
    if not missing:
        with tempfile.TemporaryDirectory() as folder:
            nbclient.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": folder}}).execute()
    blocks = []
    for cell in notebook.cells:
        blocks.append(cell.source + "\n" if cell.cell_type == "markdown" else f"```python\n{cell.source}\n```\n")
        blocks += [shown(output) for output in cell.get("outputs", [])]
    if missing:
        blocks.append(f"*Without its pictures: {', '.join(missing)} was not installed where this page was built.*\n")
    blocks.append(f"{{download}}`Download this notebook <{name}>`\n")
    return "\n".join(blocks)


class NotebookParser(MystParser):
    supported = ("notebook",)

    def parse(self, inputstring, document):
        super().parse(page_of(inputstring, document.current_source.rpartition("/")[2]), document)


def setup(app):
    app.add_source_suffix(".ipynb", "notebook")
    app.add_source_parser(NotebookParser)
    return {"parallel_read_safe": True}

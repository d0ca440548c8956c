"""The documentation site: the pages of docs/ as they are, the Python package, and the C++ library by Doxygen.

scripts/docs builds it. Nothing here is a second source of text: first page and navigation are made from README.md and
docs/README.md (pages.py), the Python reference from the package, and the C++ reference from the headers.
"""

import os
import re
import sys
from pathlib import Path

SITE = Path(__file__).parent
ROOT = SITE.parents[1]
sys.path.insert(0, str(SITE))

from sphinx.domains.cpp import CPPObject  # noqa: E402

import holotrace  # noqa: E402  of the build tree: scripts/docs sets the path

project = "Holotrace"
version = release = holotrace.__version__
extensions = [
    "breathe",
    "mathml",
    "myst_parser",
    "notebook_pages",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
]
nitpicky = False

# Markdown as GitHub reads it, and $mathematics$.
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4

breathe_projects = {"holotrace": os.environ["HOLOTRACE_DOXYGEN_XML"]}
breathe_default_project = "holotrace"
breathe_default_members = ("members", "undoc-members")
highlight_language = "none"

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_type_aliases = {name: name for name in ("Angle", "Length", "Lengths", "Panel", "Path", "Progress", "Target")}
autodoc_mock_imports = [name for name in ("torch", "jax") if name not in sys.modules]
napoleon_google_docstring = False
napoleon_use_param = False

html_theme = "furo"
html_title = "Holotrace"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_favicon = "static/icon.svg"
html_show_sphinx = False
html_show_copyright = False
html_copy_source = False
html_theme_options = {"navigation_with_keys": True}
copybutton_prompt_text = r"\$ |>>> "
copybutton_prompt_is_regexp = True


# The names of exceptions and parameters are text: as links they fail in Sphinx 5 inside Markdown.
for _kind in (CPPObject, *CPPObject.__subclasses__()):
    for _field in _kind.doc_field_types:
        _field.rolename = ""


def escape_bars(app, what, name, obj, options, lines):
    """The help texts of parameters are plain text: |U| is a modulus in them, not a substitution."""
    lines[:] = [re.sub(r"(``.*?``)|\|", lambda found: found.group(1) or r"\|", line) for line in lines]


def leave_source_file(app, env, node, text):
    """A link to a file of the repository that is no page, such as ../CONTRIBUTING.md, stays as its text."""
    page = ROOT / "docs" / env.doc2path(node.get("refdoc", app.config.root_doc), base=False)
    return text if (page.parent / node.get("reftarget", "").partition("#")[0]).is_file() else None


def setup(app):
    app.connect("autodoc-process-docstring", escape_bars, priority=400)  # before napoleon
    app.connect("missing-reference", leave_source_file)

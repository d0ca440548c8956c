"""The pages that Sphinx reads: those of docs/ as they are, a first page, and a page for each group of docs/README.md.

docs/README.md is the navigation: below each of its kinds of pages stand pages and, under headings, groups of pages. The
first page has the opening and the Python example of README.md, and the kinds with their pages and groups.
"""

import re
import shutil
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FIRST = "index"  # what browsers open in a folder
KINDS = ("Learn", "Do", "Look up", "Understand")


def sections(text, mark):
    """What stands before the first heading of a level, and a dict from these headings to what stands below them."""
    before, *rest = re.split(rf"^{mark} (.*)\n", text, flags=re.M)
    return before, dict(zip(rest[::2], rest[1::2]))


def pages_in(text, kind="md"):
    return re.findall(rf"\]\(([\w/]+\.{kind})\)", text)


def toctree(pages, *options):
    return "\n".join(["\n```{toctree}", ":hidden:", *options, "", *pages, "```\n"])


def write_groups(folder, groups):
    """A page for each group: its text, which is a list, and that list as navigation. Returns the lines of their own list."""
    lines = []
    for title, text in groups.items():
        name = title.lower().replace(" ", "_") + ".md"
        (folder / name).write_text(f"# {title}\n{text}{toctree(pages_in(text))}")
        about = text.strip().partition("\n")[0]
        lines.append(f"- [{title}]({name}): {about[0].lower()}{about[1:].rstrip('.')}")
    return "\n".join(lines)


def write_first_page(folder):
    readme = (ROOT / "README.md").read_text().replace("](docs/", "](")
    title, parts = sections((ROOT / "docs" / "README.md").read_text(), "##")
    text = readme.partition("\n```")[0] + "\n## In Python\n" + sections(readme, "##")[1]["In Python"]
    text += "## Documentation\n" + title.partition("\n")[2]
    navigation = ""
    for kind in KINDS:
        own, groups = sections(parts.pop(kind), "###")
        own = own.rstrip() + "\n" * (2 if not pages_in(own) else 1) + write_groups(folder, groups)
        text += f"### {kind}\n{own}\n\n"
        navigation += toctree(pages_in(own), f":caption: {kind}")
    text += "".join(f"## {heading}\n{part}" for heading, part in parts.items())
    (folder / f"{FIRST}.md").write_text(text + navigation)


def write_pages(folder):
    shutil.copytree(ROOT / "docs", folder, ignore=shutil.ignore_patterns("site"))
    (folder / "README.md").unlink()
    write_first_page(folder)
    notebooks = folder / "notebooks" / "README.md"
    notebooks.write_text(notebooks.read_text() + toctree(pages_in(notebooks.read_text(), "ipynb")))
    for page in folder.glob("*/*.md"):
        page.write_text(page.read_text().replace("](../README.md", f"](../{FIRST}.md"))

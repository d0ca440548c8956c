#!/usr/bin/env python3
"""Every link of the documentation leads to a file that exists, and every #anchor to a heading of that page.

Also every path and every name of a source file in `backquotes`, every page that a source file names, and every fact of
the program's reports, which docs/reference/report.md lists.
Links to the web are not followed. Usage: check_links.py
"""

import os
import re
import subprocess
import sys

from pages import ROOT, pages, text_without_blocks

SOURCES = [entry for folder in ("src", "apps", "bench", "tests") for entry in os.walk(ROOT / folder)]
FOLDERS = ("python/", "src/", "apps/", "tests/", "docs/", "examples/", "scripts/", "panels/", "bench/", "cmake/")


def anchor(heading):
    """The name that GitHub gives to a heading: lower case, spaces as dashes, punctuation left out."""
    plain = re.sub(r"`|\*|\[([^]]*)\]\([^)]*\)", r"\1", heading).strip().lower()
    return re.sub(r"[^\w\- ]", "", plain).replace(" ", "-")


def anchors(page):
    return {anchor(h) for h in re.findall(r"^#+ (.*)$", text_without_blocks(page), re.M)}


def dead_links(page):
    text = text_without_blocks(page)
    for match in re.finditer(r"\]\(([^)\s]+)\)", text):
        target, _, name = match.group(1).partition("#")
        if re.match(r"[a-z]+:", target):
            continue
        file = (page.parent / target).resolve() if target else page
        if not file.exists():
            yield text, match, f"the file {target} does not exist"
        elif name and name not in anchors(file):
            yield text, match, f"{target or page.name} has no heading #{name}"


def dead_paths(page):
    text = text_without_blocks(page)
    for match in re.finditer(r"`(\w[\w./-]+)`", text):
        path = match.group(1)
        if "NAME" in path:
            continue
        if path.startswith(FOLDERS):
            if not (ROOT / path).exists():
                yield text, match, f"the file {path} does not exist"
        elif path.endswith((".h", ".cpp")) and not is_source(path):
            yield text, match, f"no source file is called {path}"


def is_source(path):
    """Whether a path as wave/bands.h, or a bare name as bands.h, is a file of the library, the program or its tests."""
    if "/" not in path:
        return any(path in names for _, _, names in SOURCES)
    return any((ROOT / folder / path).exists() for folder in ("src/holotrace", "apps", "bench", "tests"))


def dead_mentions():
    """Mentions of docs/…md in the sources, and of files that are not a part of the repository."""
    files = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    for name in files:
        if not name.endswith((".h", ".cpp", ".py", ".toml", ".txt", ".cmake")) and "scripts/" not in name:
            continue
        for number, line in enumerate((ROOT / name).read_text().splitlines(), 1):
            for mention in re.findall(r"\bdocs/[\w/]+\.(?:md|png|jpg)", line):
                if not (ROOT / mention).exists():
                    yield f"{name}:{number}: the file {mention} does not exist"
            for mention in re.findall(r"\b[\w]+\.md\b", line):
                if "docs/" not in line and not any(p.name == mention for p in pages()) and mention != "README.md":
                    yield f"{name}:{number}: no page is called {mention}"


def unlisted_facts():
    """Facts and curves that a stage notes, and that the page of the report does not explain."""
    listed = set(re.findall(r"`(\w+)", (ROOT / "docs" / "reference" / "report.md").read_text()))
    for source in sorted((ROOT / "src" / "holotrace").rglob("*.cpp")):
        for fact in re.findall(r'\b(?:fact|curve)\("(\w+)"', source.read_text()):
            if fact not in listed:
                yield f"{source.relative_to(ROOT)}: docs/reference/report.md does not explain the fact {fact}"


def main():
    problems = []
    for page in pages():
        found = list(dead_links(page))
        if page.name != "CHANGELOG.md":  # it may name what older versions had
            found += dead_paths(page)
        for text, match, why in found:
            problems.append(f"{page.relative_to(ROOT)}:{text.count(chr(10), 0, match.start()) + 1}: {why}")
    problems += unlisted_facts()
    if (ROOT / ".git").exists():
        problems += dead_mentions()
    print("\n".join(problems) or f"{len(pages())} pages, no dead link")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())

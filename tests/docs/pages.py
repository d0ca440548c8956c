"""The pages of the documentation and their fenced blocks."""

import dataclasses
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]


def pages():
    """Every Markdown page for readers, in a fixed order."""
    return [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").rglob("*.md"))]


@dataclasses.dataclass
class Block:
    page: pathlib.Path
    line: int  # of its first line of text, from 1
    words: list  # behind the opening fence: the language, then marks, as in ```sh long
    text: str

    def place(self):
        return f"{self.page.relative_to(ROOT)}:{self.line}"


def blocks_of(page):
    """The fenced blocks of a page in their order."""
    blocks, opened = [], None
    for number, line in enumerate(page.read_text().splitlines(), 1):
        fence = re.match(r"\s*```(.*)$", line)
        if fence and opened is None:
            opened = Block(page, number + 1, fence.group(1).split(), "")
        elif fence:
            blocks.append(opened)
            opened = None
        elif opened is not None:
            opened.text += line + "\n"
    if opened is not None:
        raise ValueError(f"{opened.place()}: expected the end of this block, ```, got the end of the page")
    return blocks


def text_without_blocks(page):
    """The page with its fenced blocks blanked, so that line numbers stay."""
    kept, inside = [], False
    for line in page.read_text().splitlines():
        fence = re.match(r"\s*```", line)
        kept.append("" if fence or inside else line)
        inside ^= bool(fence)
    return "\n".join(kept)

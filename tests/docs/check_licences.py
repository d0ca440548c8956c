"""Every library that a program loads is in the table of docs/reference/licences.md.

Usage: check_licences.py PROGRAM …
"""

import re
import subprocess
import sys
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "licences.md"


def linked_in_table():
    section = PAGE.read_text().split("## Linked")[1].split("\n## ")[0]
    files = set()
    for line in section.splitlines():
        if line.startswith("|"):
            files |= set(re.findall(r"`([^`]+)`", line))
    return files


def loaded_by(program):
    listed = subprocess.run(["ldd", program], capture_output=True, text=True, check=True).stdout
    names = [Path(line.split()[0]).name for line in listed.splitlines() if line.strip()]
    return {name.split(".so")[0] for name in names}


def main():
    table, missing = linked_in_table(), []
    for program in sys.argv[1:]:
        missing += [f"{program} loads {name}" for name in sorted(loaded_by(program) - table)]
    for sentence in missing:
        print(f"{sentence}, which is not in {PAGE.name}: add it with its licence, or load it at run time", file=sys.stderr)
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())

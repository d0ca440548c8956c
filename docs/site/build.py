#!/usr/bin/env python3
"""Builds the documentation site. Usage: build.py PACKAGE OUT

PACKAGE is the folder that has the built package holotrace; OUT receives html/. Warnings are errors. Ends with 77 where
Sphinx, its extensions or Doxygen are not installed (scripts/setup installs them).
"""

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

from pages import write_pages

SITE = Path(__file__).resolve().parent
ROOT = SITE.parents[1]
MODULES = ("sphinx", "myst_parser", "breathe", "furo", "sphinx_copybutton", "nbclient", "ipykernel")


def main():
    package, out = (Path(name).resolve() for name in sys.argv[1:3])
    missing = [name for name in MODULES if importlib.util.find_spec(name) is None]
    if shutil.which("doxygen") is None:
        missing.append("doxygen")
    if missing:
        for name in missing:
            print(f"skipped: {name} is not installed, which the site needs; run scripts/setup --tests")
        return 77
    shutil.rmtree(out, ignore_errors=True)  # a page that is gone leaves nothing
    out.mkdir(parents=True)
    write_pages(out / "pages")
    settings = f"@INCLUDE = {SITE / 'Doxyfile'}\nOUTPUT_DIRECTORY = {out / 'doxygen'}\n"
    subprocess.run(["doxygen", "-"], input=settings, text=True, cwd=ROOT, check=True)
    environment = {**os.environ, "PYTHONPATH": str(package), "PYTHONDONTWRITEBYTECODE": "1",
                   "PYDEVD_DISABLE_FILE_VALIDATION": "1",  # no warnings of the notebooks' debugger
                   "HOLOTRACE_DOXYGEN_XML": str(out / "doxygen" / "xml")}
    sphinx = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html", "-c", SITE, "-d", out / "doctrees"]
    done = subprocess.run([*sphinx, out / "pages", out / "html"], env=environment, check=False)
    if done.returncode == 0:
        print(f"the site: {out / 'html' / 'index.html'}")
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())

"""The packages that a wheel is built with have one list of versions."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_builds_of_wheels_take_the_versions_of_scripts_setup():
    (requires,) = re.findall(r"^requires = \[\n(.*?)^\]", (ROOT / "pyproject.toml").read_text(), re.DOTALL | re.MULTILINE)
    pins = re.findall(r'"([^"]*)"', requires)
    assert all(re.fullmatch(r"[a-z-]+==[0-9.]+(; .*)?", pin) for pin in pins)
    listed = re.findall(r"^[a-z-]+==[0-9.]+", (ROOT / "scripts/requirements/build.txt").read_text(), re.MULTILINE)
    assert [pin for pin in pins if not pin.startswith("numpy==")] == listed

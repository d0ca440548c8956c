#!/usr/bin/env python3
"""The files that hosts, package managers and citations read agree with the project: python3 test_project_files.py PROGRAM.

PYTHONPATH names the built Python package, if there is one.
"""

import importlib.util
import json
import os
import re
import subprocess
import sys
import tempfile
import tomllib
import unittest

import jinja2
import yaml

from pages import ROOT, pages

PROGRAM = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else ROOT / "build" / "release" / "holotrace"


def text_of(name):
    return (ROOT / name).read_text()


def yaml_of(name):
    return yaml.safe_load(text_of(name))


def output_of(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def recipe():
    """The conda recipe, with the functions of conda as their names."""
    functions = {name: lambda language, name=name: f"{name}_{language}" for name in ("compiler", "stdlib")}
    return yaml.safe_load(jinja2.Template(text_of("conda/recipe/meta.yaml"), undefined=jinja2.StrictUndefined).render(
        PYTHON="python", **functions))


VERSION = re.search(r"^project\(holotrace VERSION (\d+\.\d+\.\d+) ", text_of("CMakeLists.txt"), re.M).group(1)


class TheVersion(unittest.TestCase):
    """It stands in CMakeLists.txt. Whatever else names it is made from that, or compared with it here."""

    def test_is_that_of_the_program(self):
        self.assertEqual(output_of(PROGRAM, "--version"), f"holotrace {VERSION}\n")

    def test_is_that_of_reports(self):
        with tempfile.TemporaryDirectory() as folder:
            output_of(PROGRAM, "trace", ROOT / "examples/fig06_wireframe_cube.toml", "-o", f"{folder}/sources.ply",
                      "--report", f"{folder}/report.json")
            with open(f"{folder}/report.json", encoding="utf-8") as file:
                self.assertEqual(json.load(file)["versions"]["holotrace"], VERSION)

    @unittest.skipUnless(importlib.util.find_spec("holotrace"), "the Python package is not built; run scripts/setup")
    def test_is_that_of_the_python_package(self):
        self.assertEqual(output_of(sys.executable, "-c", "import holotrace; print(holotrace.__version__)"), f"{VERSION}\n")

    def test_is_that_of_wheels(self):
        project = tomllib.loads(text_of("pyproject.toml"))
        source = project["tool"]["scikit-build"]["metadata"]["version"]
        self.assertIn("version", project["project"]["dynamic"])
        self.assertEqual(re.search(source["regex"], text_of(source["input"])).group("value"), VERSION)

    def test_is_that_of_the_changelog(self):
        self.assertEqual(re.search(r"^## (\d\S*)", text_of("CHANGELOG.md"), re.M).group(1), VERSION)

    def test_is_that_of_the_citation(self):
        self.assertEqual(yaml_of("CITATION.cff")["version"], VERSION)

    def test_is_that_of_the_conda_recipe(self):
        self.assertEqual(recipe()["package"]["version"], VERSION)

    def test_is_that_of_wheels_on_pages(self):
        for page in pages():
            for version in re.findall(r"holotrace-(\d[\d.]*)-", page.read_text()):
                self.assertEqual(version, VERSION, page)


class FilesForHosts(unittest.TestCase):
    def test_cite_by_what_the_format_requires(self):
        """Keys that Citation File Format 1.2.0 requires."""
        citation = yaml_of("CITATION.cff")
        self.assertEqual(citation["cff-version"], "1.2.0")
        self.assertTrue(citation["message"] and citation["title"] and citation["authors"])
        self.assertEqual(citation["license"], tomllib.loads(text_of("pyproject.toml"))["project"]["license"])

    def test_ask_for_what_a_report_of_a_fault_needs(self):
        """GitHub's forms: each element but text has an id of its own, and a label."""
        for form in sorted((ROOT / ".github/ISSUE_TEMPLATE").glob("*.yml")):
            content = yaml.safe_load(form.read_text())
            if form.name == "config.yml":
                continue
            self.assertTrue(content["name"] and content["description"], form)
            asked = [element for element in content["body"] if element["type"] != "markdown"]
            self.assertEqual(len({element["id"] for element in asked}), len(asked), form)
            self.assertTrue(all(element["attributes"]["label"] for element in asked), form)
        bug = text_of(".github/ISSUE_TEMPLATE/bug.yml")
        for needed in ("holotrace --version", "holotrace info --devices", "report.json"):
            self.assertIn(needed, bug)

    def test_run_what_a_change_must_pass_on_debian_12(self):
        jobs = yaml_of(".github/workflows/check.yml")["jobs"]
        self.assertTrue(any(job.get("container") == "debian:12" and {"run": ".ci/run"} in job["steps"] for job in jobs.values()))
        self.assertTrue(os.access(ROOT / ".ci/run", os.X_OK))

    def test_name_files_and_steps_that_exist(self):
        texts = [path.read_text() for path in (ROOT / ".github").rglob("*") if path.is_file()]
        texts += [text_of(name) for name in ("Dockerfile", ".pre-commit-config.yaml", "SECURITY.md", "CODE_OF_CONDUCT.md")]
        named = {name for text in texts for name in re.findall(r"(?<![\w/])(?:scripts|\.ci|docs|examples)/[\w./]*\w", text)}
        self.assertLessEqual({"scripts/setup", "scripts/check", ".ci/run"}, named)
        self.assertEqual([name for name in sorted(named) if not (ROOT / name).exists()], [])

    def test_check_commits_by_local_tools(self):
        """No hook of pre-commit is fetched, and the checks are those of .ci/run."""
        repositories = yaml_of(".pre-commit-config.yaml")["repos"]
        self.assertEqual({repository["repo"] for repository in repositories}, {"local"})
        hooks = {hook["id"]: hook for repository in repositories for hook in repository["hooks"]}
        self.assertEqual({hook["language"] for hook in hooks.values()}, {"system"})
        self.assertEqual(hooks["clang-format"]["entry"], "clang-format -i")
        self.assertIn(hooks["check"]["entry"], text_of(".ci/run").splitlines())


class Packages(unittest.TestCase):
    def test_need_in_conda_what_they_need_from_the_index(self):
        project = tomllib.loads(text_of("pyproject.toml"))
        needs = {kind: {name.split()[0] for name in names} for kind, names in recipe()["requirements"].items()}
        name_of = lambda requirement: re.match(r"[\w-]+", requirement).group()  # noqa: E731
        self.assertLessEqual({name_of(one) for one in project["build-system"]["requires"]}, needs["host"])
        self.assertLessEqual({name_of(one) for one in project["project"]["dependencies"]}, needs["run"])

    def test_copy_into_the_container_what_is_there(self):
        lines = re.sub(r"\\\n\s*", "", text_of("Dockerfile")).splitlines()
        copied = [line.split()[1:-1] for line in lines if line.startswith("COPY ") and "--from" not in line]
        self.assertTrue(copied)
        self.assertEqual([name for names in copied for name in names if not (ROOT / name).exists()], [])
        self.assertIn("USER holotrace", lines)


class ThePromise(unittest.TestCase):
    """docs/reference/api_promise.md, against the page of the command line, which another test compares with the program."""

    def test_names_commands_and_flags_of_the_program(self):
        sections = dict(re.findall(r"^## `holotrace ([\w ]+)`\n(.*?)(?=^## |\Z)", text_of("docs/reference/command_line.md"), re.M | re.S))
        rows = re.findall(r"^ *\| (`[^|]*`) \|([^|]*)\|$", text_of("docs/reference/api_promise.md"), re.M)
        promised = [(command, flag) for commands, flags in rows
                    for command in re.findall(r"`([^`]+)`", commands) for flag in re.findall(r"`(--[\w-]+)`", flags) or [""]]
        self.assertEqual({command for command, _ in promised}, set(sections) - {"calibrate"})  # which is its two parts
        for command, flag in promised:
            self.assertRegex(sections[command], rf"\| `(?:[^`]*,)?{flag}\b", f"holotrace {command} has no {flag}")


if __name__ == "__main__":
    unittest.main()

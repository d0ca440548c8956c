#!/usr/bin/env python3
"""Runs every command line of the documentation: the ```sh and ```python blocks of README.md and docs/, page by page.

Usage: run_commands.py PROGRAM [PAGE…]

Each page has a folder of its own, in which its blocks run in their order, so that a block finds what an earlier one
wrote. It has a small stand-in for each file that a reader brings (INPUTS). Panels have 1440 x 144 pixels, and each
example scene has few rays (SMALLER). A ```toml or ```text block whose first line is "# NAME.toml" (or .csv) becomes that file. Marks behind
```sh:

  long     takes minutes: each command is started, and ended after one second of processor time; a wrong flag or a
           missing file shows before that
  not-run  no command of this program, as an installation; nothing is run

A block of commands that are not marked must end with exit code 0. Python blocks run where NumPy is there, but for those
of the pages about the Python package: tests/python/test_examples.py runs them, page by page.
"""

import os
import pathlib
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import zlib

from pages import ROOT, blocks_of, pages

# Few rays, and every stage still runs.
SMALLER = """extends = "{scene}"

[trace]
columns = 48
rows = 27
samples = 2000
paths = 2
frames = {frames}

[render]
columns = 64
rows = 36
paths = 2
"""

# What the pages call the files that a reader brings, and the file that stands for each in small.
INPUTS = {
    "MODEL.glb": "tests/data_files/pump.glb",
    "PICTURE.png": "tests/data_files/ramp.png",
    "PHOTOGRAPH.png": "examples/test_chart.png",
    "SIMULATION.png": "examples/test_chart.png",
}

# Commands of minutes or gigabytes in the words of the page, and the same in small.
SHORTER = [
    (r'--width "56 mm" --height "14 mm"', '--width "14 mm" --height "2 mm"'),
    (r'--times "0.2, 0.4 s" --quality', '--times "0.2 s" --quality'),
    (r"run MODEL.glb", "run MODEL.glb --planes 1 --iterations 1 --paths 2"),
    (r"animate MODEL.glb", "animate MODEL.glb --planes 1 --iterations 1 --paths 2"),
    (r"--columns 32768 --rows 32768", "--columns 1024 --rows 1024"),
    (r"--target-columns 1600 --target-rows 880", "--target-columns 200 --target-rows 110 --resample true --iterations 3"),
    (r"--target-columns 1000 --target-rows 500", "--target-columns 200 --target-rows 110"),
    (r"--frames 4 --iterations", "--frames 2 --iterations"),
    (r"--iterations \d\d+", "--iterations 2"),
]
LONG_SECONDS = 1  # of processor time, so that a busy machine ends no command before its flags are read
BLOCK_SECONDS = 300  # a block takes a few seconds; this ends one that hangs


def write_depths(path):
    """A grey picture of 96 x 64 pixels, as large as PICTURE.png, whose depths run from left to right."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + bytes(range(0, 192, 2)) for _ in range(64))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 96, 64, 8, 0, 0, 0, 0)) +
                     chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def make_folder(folder):
    """The files that stand for a reader's own, and the small examples."""
    write_depths(folder / "DEPTHS.png")
    write_depths(folder / "HOLOGRAM.png")  # greys without metadata
    for name, source in INPUTS.items():
        shutil.copy(ROOT / source, folder / name)
    (folder / "panels").symlink_to(ROOT / "panels")
    (folder / "examples").mkdir()
    for scene in sorted((ROOT / "examples").glob("*.toml")):
        write_smaller(folder / "examples" / scene.name, scene)


def write_smaller(path, scene):
    frames = 4 if re.search(r"^frames = ", scene.read_text(), re.M) else 1
    path.write_text(SMALLER.format(scene=scene, frames=frames))


def is_of_package(page):
    """Whether the Python blocks of a page are for the package holotrace."""
    return any(block.words[:1] == ["python"] and "import holotrace" in block.text for block in blocks_of(page))


def make_panels(folder):
    """The panels of the project under their names, with 1440 x 144 pixels: as wide as eyes 6 mm apart need, and low."""
    folder.mkdir()
    for panel in (ROOT / "panels").glob("*.toml"):
        text = re.sub(r"^columns = .*", "columns = 1440", panel.read_text(), flags=re.M)
        (folder / panel.name).write_text(re.sub(r"^rows = .*", "rows = 144", text, flags=re.M))
    for table in (ROOT / "panels").glob("*.csv"):
        shutil.copy(table, folder)


def shorter(text):
    for long, short in SHORTER:
        text = re.sub(long, short, text)
    return text


def commands_of(text):
    """The command lines of a block, those that a backslash continues as one."""
    lines = re.sub(r"\\\n\s*", "", text).splitlines()
    return [line for line in lines if line.strip() and not line.lstrip().startswith("#")]


def run(command, folder, environment):
    done = subprocess.run(command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False)
    return done.returncode, done.stdout


def run_shell(text, folder, environment):
    """Exit code and output of a block."""
    return run(["timeout", str(BLOCK_SECONDS), "bash", "-euo", "pipefail", "-c", shorter(text)], folder, environment)


def start_each(text, folder, environment):
    """The same of a block marked long: 0 if each command was ended by its limit of processor time, or ended well."""
    for command in commands_of(text):
        code, output = run(["bash", "-c", f"ulimit -t {LONG_SECONDS}; exec {command}"], folder, environment)
        if code not in (0, -signal.SIGXCPU, -signal.SIGKILL):
            return code, command + "\n" + output
    return 0, ""


def find_numpy():
    for python in (sys.executable, "/usr/bin/python3"):
        if subprocess.run([python, "-c", "import numpy"], capture_output=True, check=False).returncode == 0:
            return python
    return None


def run_block(block, folder, environment, numpy):
    """Exit code and output; None where there is nothing to run."""
    language, marks = (block.words or [""])[0], block.words[1:]
    if language == "text":
        name = re.match(r"# (\w+\.csv)\n", block.text)
        if name:
            (folder / name.group(1)).write_text(block.text)
        return None
    if language == "toml":
        name = re.match(r"# (\w+\.toml)\n", block.text)
        if name and "[[object]]" in block.text:
            scene = folder / ("whole_" + name.group(1))
            scene.write_text(block.text)
            write_smaller(folder / name.group(1), scene)
        elif name:
            (folder / name.group(1)).write_text(block.text)
        return None
    if language == "python" and numpy and not is_of_package(block.page):
        return run(["timeout", str(BLOCK_SECONDS), numpy, "-c", block.text], folder, environment)
    if language != "sh" or "not-run" in marks:
        return None
    return (start_each if "long" in marks else run_shell)(block.text, folder, environment)


def unmarked_commands(page):
    """Blocks that hold command lines of the program and would not be run."""
    for block in blocks_of(page):
        if block.words[:1] in ([], ["bash"], ["console"]) and re.search(r"^(\$ )?(\S*/)?holotrace \w", block.text, re.M):
            yield f"{block.place()}: expected ```sh above commands of holotrace, so that they are run"


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    if program.name != "holotrace" or not program.exists():
        sys.exit(f"expected the program, called holotrace as on the pages, got {program}")
    wanted = [pathlib.Path(name).resolve() for name in sys.argv[2:]] or pages()
    numpy = find_numpy()
    if not numpy:
        print("python blocks are left out: expected NumPy (Debian: python3-numpy), found none")
    problems, count = [], 0
    with tempfile.TemporaryDirectory(prefix="holotrace-docs-") as top:
        make_panels(pathlib.Path(top) / "panels")
        environment = {**os.environ, "HOLOTRACE_PANELS": f"{top}/panels", "XDG_CACHE_HOME": f"{top}/cache", "XDG_CONFIG_HOME": f"{top}/config",
                       "PATH": f"{program.parent}:{os.environ['PATH']}", "OMPI_ALLOW_RUN_AS_ROOT": "1",
                       "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1"}
        for page in wanted:
            for problem in unmarked_commands(page):
                problems.append(problem)
                print(problem)
            folder = pathlib.Path(top) / str(page.relative_to(ROOT)).replace("/", "_")
            folder.mkdir()
            make_folder(folder)
            start, in_page = time.monotonic(), 0
            for block in blocks_of(page):
                outcome = run_block(block, folder, environment, numpy)
                if outcome is None:
                    continue
                in_page += 1
                if outcome[0] != 0:
                    why = f"still ran after {BLOCK_SECONDS} s; make it shorter, or mark it: sh long" * (outcome[0] == 124)
                    problems.append(f"{block.place()}: exit code {outcome[0]} {why}\n{block.text}--> {outcome[1]}")
                    print(problems[-1], flush=True)
            if in_page:
                print(f"{time.monotonic() - start:6.1f} s  {in_page:3d} blocks  {page.relative_to(ROOT)}", flush=True)
            count += in_page
    print(f"{count} blocks, {len(problems)} problems")
    return 1 if problems or (count == 0 and len(sys.argv) == 2) else 0


if __name__ == "__main__":
    sys.exit(main())

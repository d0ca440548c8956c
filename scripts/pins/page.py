"""What the page of `holotrace view` gets from its server: page.py FOLDER PATH, whose answers become files of a folder."""
import os
import pathlib
import re
import subprocess
import sys
import urllib.error
import urllib.request

QUESTIONS = {
    "session.json": "session", "view.bin": "view?distance=30+mm", "draft.bin": "view?distance=29+mm&draft=2",
    "eye.bin": "view?distance=30+mm&pupil=1+mm&eye=0+0+50+mm", "reference.bin": "reference?distance=30+mm",
    "level.bin": "panel?item=0&as=level", "amplitude.bin": "panel?item=0&as=amplitude", "phase.bin": "panel?item=0&as=phase",
    "metrics.json": "metrics?distance=30+mm", "values.json": "values?distance=30+mm&column=10&row=10&columns=6&rows=4",
    "command.json": "command?distance=30+mm", "report.json": "report", "points.bin": "points",
    "view.png": "view.png?distance=30+mm", "view.exr": "view.exr?distance=30+mm", "unknown.json": "view?depth=30+mm"}

folder, path = pathlib.Path(sys.argv[1]), sys.argv[2]
folder.mkdir()
with subprocess.Popen([os.environ["HOLOTRACE_PROGRAM"], "view", "--no-browser", "--threads", "2", path], stdout=subprocess.PIPE,
                      text=True) as server:
    url = server.stdout.readline().strip()
    for name, question in QUESTIONS.items():
        try:
            with urllib.request.urlopen(url + question, timeout=60) as answer:
                data = answer.read()
        except urllib.error.HTTPError as error:  # a field has no levels
            data = f"{error.code} ".encode() + error.read()
        if b'"seconds":' in data[:4096] and name.endswith(".bin"):  # in the head of a picture, behind its length
            data = re.sub(rb'("seconds":)[-+.\de]+', rb"\1 ", data[4:])
        (folder / name).write_bytes(data)
    server.terminate()

"""Starts the program, and ends it as soon as a file is there: stopped.py INT|KILL FILE [TEXT] -- ARGUMENTS…

With a text, the file must have it.
"""
import os
import pathlib
import signal
import subprocess
import sys
import time

split = sys.argv.index("--")
name, file, *text = sys.argv[1:split]
path = pathlib.Path(file)
with subprocess.Popen([os.environ["HOLOTRACE_PROGRAM"], *sys.argv[split + 1:], "--threads", "2", "--quiet"],
                      stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as program:
    while program.poll() is None and not (path.exists() and (not text or text[0] in path.read_text())):
        time.sleep(0.0005)
    if program.poll() is not None:
        sys.exit(f"the program ended before {file} was there")
    program.send_signal(signal.Signals["SIG" + name])

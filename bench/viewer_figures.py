#!/usr/bin/env python3
"""Figures of `holotrace view` on full-HD holograms, from the click to the picture on screen, in headless Chromium.

Usage: viewer_figures.py PROGRAM [HOLOGRAM FOLDER]      with the Python that has Selenium (python3-selenium)

HOLOGRAM is one hologram, FOLDER has 3 colours x 8 frames; without them, both are made first (some seconds). On a busy machine,
run it under `chrt -r 5`, so that programs of others wait. All times are medians, in milliseconds unless a unit stands beside.
"""

import os
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

if len(sys.argv) not in (2, 4):
    sys.exit(__doc__)
PROGRAM = os.path.abspath(sys.argv[1])

SCENE = """
wavelength = ["638 nm", "532 nm", "450 nm"]
[slm]
preset = "pluto"
[trace]
columns = 48
rows = 27
paths = 2
frames = 8
[render]
reference = "none"
[camera]
distances = "300 mm"
[[light]]
type = "rectangle"
corner = "-50 -50 50 mm"
edge_u = "0 100 0 mm"
edge_v = "100 0 0 mm"
radiance = 5
[[object]]
type = "quad"
width = "8 mm"
height = "5 mm"
position = "0 0 -300 mm"
"""

# Sets the focus, and waits until the status, which follows the picture, is on screen. {kind}: "draft" or "still".
CHANGE = """
const done = arguments[arguments.length - 1], number = document.getElementById('distance-number');
const status = document.getElementById('status'), isDraft = arguments[1];
const start = performance.now();
const seen = new MutationObserver(() => {
  if (status.textContent.includes('draft') !== isDraft) return;
  seen.disconnect();
  requestAnimationFrame(() => done([performance.now() - start, Number(document.body.dataset.milliseconds)]));
});
seen.observe(status, {childList: true, characterData: true, subtree: true});
number.value = arguments[0];
number.dispatchEvent(new Event('input'));
"""

# Turns the wheel 50 times a second for five seconds. The pictures that come per second.
DRAG = """
const done = arguments[0], frame = document.getElementById('frame');
let pictures = 0, step = 0;
const seen = new MutationObserver(() => { ++pictures; });
seen.observe(document.getElementById('status'), {childList: true, characterData: true, subtree: true});
const moving = setInterval(() => {
  frame.dispatchEvent(new WheelEvent('wheel', {deltaY: step++ % 100 < 50 ? 20 : -20, bubbles: true, cancelable: true}));
}, 20);
setTimeout(() => { clearInterval(moving); seen.disconnect(); done(pictures / 5); }, 5000);
"""


def make_holograms(folder):
    scene = os.path.join(folder, "scene.toml")
    with open(scene, "w") as file:
        file.write(SCENE)
    out = os.path.join(folder, "out")
    subprocess.run([PROGRAM, "-q", "run", scene, "-o", out], check=True)
    return os.path.join(out, "hologram.png"), out


def new_browser():
    options = webdriver.ChromeOptions()
    for argument in ("--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                     "--ignore-gpu-blocklist", "--disable-dev-shm-usage", "--window-size=1280,720"):
        options.add_argument(argument)
    browser = webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))
    browser.set_script_timeout(120)
    return browser


def status(browser):
    return browser.execute_script("return document.getElementById('status')?.textContent ?? ''")


def wait(condition, seconds=120):
    end = time.time() + seconds
    while not condition():
        if time.time() > end:
            raise SystemExit(f"waited {seconds} s for the page")
        time.sleep(0.005)


def peak_memory(process):
    """[MiB]"""
    with open(f"/proc/{process.pid}/status") as file:
        return next(int(line.split()[1]) / 1024 for line in file if line.startswith("VmHWM"))


def measure(browser, path, rounds):
    browser.get("about:blank")
    start = time.time()
    server = subprocess.Popen([PROGRAM, "view", "--no-browser", path], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        url = server.stdout.readline().strip()
        said = server.stderr.readline().strip()
        browser.get(url)
        wait(lambda: "ms" in status(browser))
        first = time.time() - start
        complete = lambda: browser.execute_script("return Boolean(document.body.dataset.complete)")
        wait(complete)
        still, drafts = [], []
        for i in range(rounds):
            drafts.append(browser.execute_async_script(CHANGE, str(285 + 0.37 * i), True)[0])
            time.sleep(0.05)
            wait(lambda: "draft" not in status(browser))
            still.append(float(browser.execute_script("return document.body.dataset.milliseconds")))
            time.sleep(0.2)
        rate = browser.execute_async_script(DRAG)
        print(f"{path}: {said}")
        print(f"  start to the first picture   {first:6.2f} s")
        print(f"  change of focus, draft       {statistics.median(drafts):6.0f}   (best {min(drafts):.0f}, worst {max(drafts):.0f})")
        print(f"  still picture                {statistics.median(still):6.0f}   (best {min(still):.0f}, worst {max(still):.0f})")
        print(f"  pictures while dragging      {rate:6.1f} /s")
        print(f"  peak memory                  {peak_memory(server):6.0f} MiB")
    finally:
        server.send_signal(signal.SIGINT)
        server.communicate(timeout=60)


def main():
    with tempfile.TemporaryDirectory() as folder:
        one, many = sys.argv[2:4] if len(sys.argv) > 3 else make_holograms(folder)
        browser = new_browser()
        try:
            print(f"load before: {os.getloadavg()[0]:.1f}")
            measure(browser, one, 12)
            measure(browser, many, 6)
        finally:
            browser.quit()


if __name__ == "__main__":
    main()

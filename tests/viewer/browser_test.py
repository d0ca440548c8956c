#!/usr/bin/env python3
"""The page of `holotrace view` in a real browser: headless Chromium, driven by Selenium.

Usage: browser_test.py PROGRAM [unittest arguments]. Without Chromium, its driver, Selenium or Pillow: exit code 77.
HOLOTRACE_SCREENSHOTS=FOLDER writes pictures of the page.
"""

import base64
import http.server
import io
import json
import os
import shlex
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import urllib.request
import zlib

try:
    from PIL import Image
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.actions.wheel_input import ScrollOrigin
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
except ImportError as error:
    print(f"skipped: {error}; scripts/setup --tests installs what is missing")
    sys.exit(77)

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from browser import new_browser  # noqa: E402

PROGRAM = os.path.abspath(sys.argv.pop(1))

# A near and a far square, left and right, lit from the front.
SCENE = """
wavelength = "532 nm"
[slm]
columns = 320
rows = 180
pitch = "8 um"
[trace]
columns = 96
rows = 54
field_of_view = "1.1 deg"
paths = 4
[render]
columns = 160
rows = 90
paths = 8
[camera]
distances = "40 mm"
[[light]]
type = "rectangle"
corner = "-5 -5 5 mm"
edge_u = "0 10 0 mm"
edge_v = "10 0 0 mm"
radiance = 5
[[object]]
type = "quad"
width = "0.7 mm"
height = "0.9 mm"
position = "-0.5 0 -40 mm"
[[object]]
type = "quad"
width = "0.7 mm"
height = "0.9 mm"
position = "0.5 0 -60 mm"
"""


# Two lamps, one in front of the panel, on the left, and one behind it, on the right.
FRONT = """
extends = "scene.toml"
light = []
[camera]
distances = "-30 mm"
[materials.lamp]
type = "diffuse"
emission = 1
[[object]]
type = "quad"
material = "lamp"
width = "0.7 mm"
height = "0.9 mm"
position = "-0.5 0 30 mm"
[[object]]
type = "quad"
material = "lamp"
width = "0.3 mm"
height = "0.3 mm"
position = "0.2 0 -60 mm"
"""


def wait_until(work, seconds=20, what="the page"):
    end = time.time() + seconds
    while time.time() < end:
        try:
            if work():
                return
        except Exception:  # the page is loading
            pass
        time.sleep(0.03)
    raise AssertionError(f"waited {seconds} s for {what}")


class Server:
    def __init__(self, *arguments, stdin=None):
        self.process = subprocess.Popen([PROGRAM, "view", "--no-browser", *arguments], stdin=stdin,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.url = self.process.stdout.readline().strip()

    def stop(self):
        self.process.send_signal(signal.SIGINT)
        try:
            self.process.communicate(timeout=20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
        return self.process.returncode


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="holotrace_browser_")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        scene = os.path.join(cls.folder, "scene.toml")
        with open(scene, "w") as file:
            file.write(SCENE)
        cls.out = os.path.join(cls.folder, "out")
        subprocess.run([PROGRAM, "-q", "run", scene, "-o", cls.out], check=True)
        cls.browser = new_browser(1280, 720)
        cls.addClassCleanup(cls.browser.quit)

    def setUp(self):
        self.server = Server(self.out)
        self.addCleanup(self.stop)
        self.open()

    def stop(self):
        if self.server.process.returncode is None:
            self.assertEqual(self.server.stop(), 0)

    def open(self):
        self.browser.get(self.server.url)
        self.settle()

    def script(self, text, *arguments):
        return self.browser.execute_script(text, *arguments)

    def get(self, identity):
        return self.browser.find_element(By.ID, identity)

    def settle(self):
        """Waits for the still view of the present state, with its command line, render and quality."""
        wait_until(lambda: self.script("""
            const page = document.body.dataset, still = document.getElementById('picture').dataset.still;
            return still && page.complete === still;"""), what="a complete still view")

    def change(self, work):
        """Does something that changes the state, and waits for the view of the new one."""
        before = self.script("return document.body.dataset.complete")
        work()
        wait_until(lambda: self.script("return document.body.dataset.complete") != before, what="a new view")
        self.settle()

    def canvas(self):
        data = self.script("""
            const canvas = document.getElementById('picture');
            return canvas.toDataURL('image/png');""")
        return Image.open(io.BytesIO(base64.b64decode(data.split(",")[1]))).convert("RGB")

    def assert_view_is_that_of_show(self):
        """The bytes of the canvas are those of the command line that the page offers."""
        command = shlex.split(self.get("command").text)
        self.assertEqual(command[:2], ["holotrace", "show"])
        path = os.path.join(self.folder, "view.png")
        subprocess.run([PROGRAM, "-q"] + command[1:-1] + [path], check=True)
        expected = Image.open(path).convert("RGB")
        shown = self.canvas()
        self.assertEqual(shown.size, expected.size)
        self.assertEqual(shown.tobytes(), expected.tobytes())

    def distance(self):
        return float(self.get("distance-number").get_attribute("value"))

    def set_number(self, identity, value):
        field = self.get(identity)
        self.script("""
            arguments[0].value = arguments[1];
            arguments[0].dispatchEvent(new Event('input', {bubbles: true}));""", field, str(value))

    def test_shows_the_bytes_of_show(self):
        self.assertEqual(self.distance(), 40)
        self.assert_view_is_that_of_show()
        with urllib.request.urlopen(self.get("png").get_attribute("href")) as download:
            with open(os.path.join(self.folder, "view.png"), "rb") as file:  # of show
                self.assertEqual(download.read(), file.read())

    def test_focuses_by_wheel_number_and_keys(self):
        frame = self.get("frame")
        self.change(lambda: ActionChains(self.browser).scroll_from_origin(
            ScrollOrigin.from_element(frame), 0, -100).perform())
        wheeled = self.distance()
        self.assertGreater(wheeled, 40)
        self.assert_view_is_that_of_show()
        self.change(lambda: self.set_number("distance-number", 55.5))
        self.assertEqual(self.distance(), 55.5)
        self.assert_view_is_that_of_show()
        self.change(lambda: frame.send_keys(Keys.ARROW_DOWN))
        self.assertLess(self.distance(), 55.5)

    def test_focuses_at_what_is_clicked(self):
        for side, depth in ((0.195, 60), (-0.195, 40)):  # 0.5 mm of the panel's 2.56 mm beside the middle
            self.click_beside_the_middle(side)
            self.assertAlmostEqual(self.distance(), depth, delta=0.01)
        self.assert_view_is_that_of_show()

    def click_beside_the_middle(self, side):
        """Clicks into the view, `side` of its width beside the middle."""
        frame = self.get("frame")
        self.change(lambda: ActionChains(self.browser).move_to_element_with_offset(
            frame, int(side * frame.size["width"]), 0).click().perform())

    def test_moves_the_eye(self):
        self.change(lambda: self.set_number("pupil", 1))
        self.change(lambda: self.set_number("eye-z", 50))
        dark = self.canvas()
        self.change(lambda: ActionChains(self.browser).drag_and_drop_by_offset(self.get("frame"), 40, 0).perform())
        self.assertGreater(float(self.get("eye-x").get_attribute("value")), 0.5)
        self.assertNotEqual(self.canvas().tobytes(), dark.tobytes())
        self.assert_view_is_that_of_show()
        # The eye in the picture in space.
        space = self.get("space")
        self.script("arguments[0].scrollIntoView()", space)
        before = float(self.get("eye-x").get_attribute("value"))
        x, y = (float(space.get_attribute(name)) for name in ("data-eye-x", "data-eye-y"))
        self.change(lambda: ActionChains(self.browser).move_to_element_with_offset(
            space, int(x - space.size["width"] / 2), int(y - space.size["height"] / 2)).click_and_hold()
            .move_by_offset(-15, 0).release().perform())
        self.assertLess(float(self.get("eye-x").get_attribute("value")), before)

    def test_looks_as_an_eye_does(self):
        frame = self.get("frame")
        ActionChains(self.browser).drag_and_drop_by_offset(frame, 40, 0).perform()
        self.assertIn("there is no eye to move", self.get("readout").text)
        self.change(self.get("preset-eye").click)
        self.assertEqual([float(self.get(name).get_attribute("value")) for name in ("pupil", "eye-x", "eye-z")], [3, 0, 250])
        self.assert_view_is_that_of_show()
        self.change(self.get("preset-all").click)
        self.assertEqual(float(self.get("pupil").get_attribute("value")), 0)

    def test_dims_figures_of_an_earlier_view(self):
        is_old = "return document.getElementById('quality').classList.contains('old')"
        self.assertFalse(self.script(is_old))
        field = self.get("distance-number")
        self.assertTrue(self.script("arguments[0].value = '55'; arguments[0].dispatchEvent(new Event('input'));" + is_old, field))
        wait_until(lambda: not self.script(is_old), what="new figures")
        self.settle()

    def test_plays_focus_and_parallax(self):
        def places(kind, identity):
            """Places that are passed while it plays: several, and none after it was stopped."""
            value = lambda: self.get(identity).get_attribute("value")
            self.get("play-" + kind).click()
            seen = set()
            wait_until(lambda: seen.add(value()) or len(seen) > 5, what=f"play {kind}")
            self.assertEqual(self.get("play-" + kind).get_attribute("aria-pressed"), "true")
            return sorted(map(float, seen))
        focus = places("focus", "distance-number")
        low, high = (float(self.get("distance").get_attribute(name)) for name in ("min", "max"))
        self.assertTrue(low <= focus[0] < focus[-1] <= high, focus)
        self.get("play-focus").click()  # again: stop
        self.settle()
        rest = self.distance()
        time.sleep(0.5)
        self.assertEqual(self.distance(), rest)
        self.assert_view_is_that_of_show()
        eye = places("parallax", "eye-x")  # gets an eye
        self.assertEqual(float(self.get("eye-z").get_attribute("value")), 250)
        self.assertLess(eye[0], eye[-1])
        ActionChains(self.browser).send_keys(Keys.ESCAPE).perform()  # any key stops it
        self.assertEqual(self.get("play-parallax").get_attribute("aria-pressed"), "false")
        self.settle()

    def test_saves_films(self):
        """Those of `holotrace show --sweep`, with its bytes."""
        self.browser.execute_cdp_cmd("Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": self.folder})
        low, high = (self.get("distance").get_attribute(name) for name in ("min", "max"))
        command = shlex.split(self.get("command").text)
        for ending in ("gif", "webp"):
            self.get(ending).click()
            path = os.path.join(self.folder, f"focus.{ending}")
            wait_until(lambda: os.path.exists(path), what=f"the {ending}")
            shown = os.path.join(self.folder, f"show.{ending}")
            subprocess.run([PROGRAM, "-q"] + command[1:-1] + [shown, "--sweep", "focus", "--sweep-from",
                           f"{max(0, float(low))} mm", "--sweep-to", f"{high} mm"], check=True)
            with open(path, "rb") as film, open(shown, "rb") as expected:
                self.assertEqual(film.read(), expected.read())
            with Image.open(path) as made:
                self.assertEqual(made.n_frames, 46)  # 24 there, and 22 back
            os.remove(path)
        if not shutil.which("ffmpeg"):
            self.get("mp4").click()
            wait_until(lambda: "ffmpeg" in self.get("film-text").text, what="what is missing")

    def test_switches_orders(self):
        orders = self.get("orders")
        self.change(orders.click)
        self.assertIn("--subpixels 3", self.get("command").text)
        self.assert_view_is_that_of_show()

    def test_compares_with_the_render(self):
        quality = self.get("quality").text
        for name in ("PSNR", "SSIM", "Speckle contrast"):
            self.assertIn(name, quality)
        self.script("""
            const split = document.getElementById('split');
            split.value = 50;
            split.dispatchEvent(new Event('input'));""")
        self.assertTrue(self.get("divider").is_displayed())
        self.assertIn("50%", self.get("render").value_of_css_property("clip-path"))

    def test_shows_numbers_in_pixels(self):
        for _ in range(14):
            self.get("zoom-in").click()
        wait_until(lambda: self.script("""
            const canvas = document.getElementById('numbers');
            const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
            return data.some(value => value > 0);"""), what="numbers in the pixels")

    def test_shows_the_hologram(self):
        for quantity in ("amplitude", "phase", "level"):
            self.script("""
                const choice = document.getElementById('panel-as');
                choice.value = arguments[0];
                choice.dispatchEvent(new Event('change'));""", quantity)
            wait_until(lambda: quantity in self.get("panel").get_attribute("aria-label"))
        levels = Image.open(os.path.join(self.out, "hologram.png")).convert("L")
        wait_until(lambda: self.panel_bytes() == levels.tobytes(), what="the levels")

    def panel_bytes(self):
        data = self.script("return document.getElementById('panel').toDataURL('image/png')")
        return Image.open(io.BytesIO(base64.b64decode(data.split(",")[1]))).convert("L").tobytes()

    def test_draws_space(self):
        self.assertTrue(self.script("""
            const canvas = document.getElementById('space'), copy = document.createElement('canvas');
            return canvas.getContext('webgl2') !== null && canvas.dataset.eyeX !== undefined;"""))

    def test_starts_with_the_eye_of_the_run(self):
        folder = os.path.join(self.folder, "eye")
        scene = os.path.join(self.folder, "eye.toml")
        with open(scene, "w") as file:
            file.write('extends = "scene.toml"\n[camera]\ndistances = "60 mm"\npupil = "1 mm"\neye = "0.2 0 50 mm"\n')
        subprocess.run([PROGRAM, "-q", "run", scene, "-o", folder], check=True)
        self.open_other(folder)
        self.assertEqual(self.distance(), 60)
        self.assertEqual([float(self.get(name).get_attribute("value")) for name in ("pupil", "eye-x", "eye-z")], [1, 0.2, 50])
        self.assert_view_is_that_of_show()
        through_pupil = self.canvas()
        self.change(lambda: self.set_number("pupil", 0))  # all light of the panel
        self.assert_view_is_that_of_show()
        self.assertNotEqual(self.canvas().tobytes(), through_pupil.tobytes())

    def open_other(self, *arguments):
        """The page of other files than those of setUp."""
        server = Server(*arguments)
        self.addCleanup(server.stop)
        self.browser.get(server.url)
        self.settle()

    def slider(self):
        """The ends of the slider of distances, and where it stands [mm]."""
        return [float(self.get("distance").get_attribute(name)) for name in ("min", "max", "value")]

    def test_focuses_in_front_of_the_panel(self):
        folder = os.path.join(self.folder, "front")
        scene = os.path.join(self.folder, "front.toml")
        with open(scene, "w") as file:
            file.write(FRONT)
        subprocess.run([PROGRAM, "-q", "run", scene, "-o", folder], check=True)
        self.open_other(folder)
        self.assertEqual(self.distance(), -30)
        self.assert_view_is_that_of_show()
        low, high, at = self.slider()
        self.assertLess(low, -30)
        self.assertGreater(high, 60)
        self.assertEqual(at, -30)
        frame = self.get("frame")
        self.change(lambda: self.set_number("distance-number", 0.4))
        self.change(lambda: frame.send_keys(Keys.ARROW_DOWN))  # through the panel
        self.assertLess(self.distance(), 0)
        self.assert_view_is_that_of_show()
        self.change(lambda: self.set_number("distance", -25.5))  # the slider
        self.assertEqual(self.distance(), -25.5)
        before = self.distance()
        self.change(lambda: ActionChains(self.browser).scroll_from_origin(
            ScrollOrigin.from_element(frame), 0, 100).perform())
        self.assertLess(self.distance(), before)
        self.change(lambda: self.set_number("distance-number", -80))  # beyond the slider, which follows
        self.assertLess(self.slider()[0], -80)
        self.assertEqual(self.slider()[2], -80)
        for side, depth in ((0.078, 60), (-0.195, -30)):  # 0.2 mm and −0.5 mm of the panel's 2.56 mm
            self.change(lambda: self.set_number("distance-number", depth + 0.1))
            self.click_beside_the_middle(side)
            self.assertAlmostEqual(self.distance(), depth, delta=0.01)

    def test_shows_holograms_of_other_programs(self):
        path = os.path.join(self.folder, "other.png")
        Image.open(os.path.join(self.out, "hologram.png")).convert("L").save(path)  # without metadata
        self.open_other(path, "--wavelength", "532 nm", "--image", "real", "--pitch", "8 um")
        self.change(lambda: self.set_number("distance-number", -40))
        self.assertIn("--image real", self.get("command").text)
        self.assert_view_is_that_of_show()
        self.assertLess(self.slider()[0], -40)

    def test_survives_reload_and_two_tabs(self):
        self.change(lambda: self.set_number("distance-number", 50))
        self.browser.refresh()
        self.settle()
        first = self.browser.current_window_handle
        self.browser.switch_to.new_window("tab")
        self.open()
        self.change(lambda: self.set_number("distance-number", 45))
        self.browser.close()
        self.browser.switch_to.window(first)
        self.change(lambda: self.set_number("distance-number", 42))
        self.assert_view_is_that_of_show()

    def test_watches_a_running_job(self):
        folder = os.path.join(self.folder, "optimised")
        os.makedirs(folder)
        scene = os.path.join(self.folder, "optimised.toml")
        with open(scene, "w") as file:
            file.write('extends = "scene.toml"\n[encode]\nmethod = "sgd"\ntarget = "render"\niterations = 100000\n')
        server = Server(folder)
        self.addCleanup(server.stop)
        self.browser.get(server.url)
        wait_until(lambda: "no hologram.png" in self.get("problem").text)
        job = subprocess.Popen([PROGRAM, "-q", "run", scene, "-o", folder, "--checkpoint",
                                os.path.join(self.folder, "state.h5")], stderr=subprocess.DEVNULL)
        points = lambda: int(self.get("convergence").get_attribute("data-points") or 0)
        wait_until(lambda: points() > 10, what="the first part of the curve")
        first = points()
        wait_until(lambda: points() != first, what="more of the curve")
        self.assertIn("loss", self.get("progress-text").text)
        self.assertIn("dB", self.get("convergence").get_attribute("aria-label"))
        job.kill()
        job.wait()
        wait_until(lambda: self.get("progress-text").text == "", what="the end of the job")
        # The job goes on with fewer iterations, and its result appears by itself.
        subprocess.run([PROGRAM, "-q", "run", scene, "-o", folder, "--iterations", "20"], check=True)
        self.settle()
        self.assertEqual(self.get("problem").text, "")
        self.assertEqual(points(), 21)  # 20 iterations, and the error at the end
        self.assertEqual([name for name in os.listdir(folder) if name.startswith(".")], [])
        # It has made no waves, but a click focuses at the scene's depth there all the same.
        wait_until(lambda: self.get("space").get_attribute("data-eye-x"), what="the points of the scene")
        self.assertEqual(self.distance(), 40)  # that of the run's view, though the page was open before
        self.click_beside_the_middle(0.195)
        self.assertAlmostEqual(self.distance(), 60, delta=0.01)

    def test_says_what_it_cannot_show(self):
        """A hologram larger than memory, and one that is cut short, beside one that is whole."""
        def chunk(kind, data):
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        folder = os.path.join(self.folder, "odd")
        os.makedirs(folder)
        with open(os.path.join(self.out, "hologram.png"), "rb") as file:
            whole = file.read()
        side = 300000  # 180 GB of levels
        contents = (whole, whole[:len(whole) // 2],
                    b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)) +
                    chunk(b"IDAT", zlib.compress(b"\0" * 1000)) + chunk(b"IEND", b""))
        for number, content in enumerate(contents, 1):
            with open(os.path.join(folder, "hologram.png" if number == 1 else f"hologram_{number}.png"), "wb") as file:
                file.write(content)
        server = Server(folder)
        self.addCleanup(server.stop)
        self.browser.get(server.url)
        self.settle()
        problem = self.get("problem").text
        self.assertIn("hologram_2.png", problem)
        self.assertIn("its header claims 300000 × 300000 pixels", problem)
        self.assert_view_is_that_of_show()  # of the whole one

    def test_traces_the_render_of_a_scene(self):
        server = Server(os.path.join(self.folder, "scene.toml"))
        self.addCleanup(server.stop)
        self.browser.get(server.url)
        self.settle()
        self.assertTrue(self.get("split").is_displayed())
        self.assertIn("PSNR", self.get("quality").text)
        self.change(lambda: self.set_number("distance-number", 60))
        self.assertIn("PSNR", self.get("quality").text)

    def test_changes_a_live_scene(self):
        self.stop()
        scene = os.path.join(self.folder, "scene.toml")
        self.server = Server(scene, "--live")
        self.open()
        wait_until(lambda: "optimised" in self.get("status").text or "waves" in self.get("status").text)
        self.assertEqual(self.get("live-section").get_attribute("hidden"), None)
        places = self.script("""
            return [...document.querySelectorAll('#live input')].filter(i => /^object.1.position/.test(i.ariaLabel)).map(i => i.value);""")
        self.assertEqual(places, ["-0.5", "0", "-40"])

        def brightest_column():
            picture = self.canvas().convert("L")
            sums = [sum(picture.getpixel((x, y)) for y in range(picture.height)) for x in range(picture.width)]
            half = max(sums) / 2
            lit = [x for x, value in enumerate(sums) if value > half and x < picture.width * 0.6]
            return (lit[0] + lit[-1]) / 2

        before = brightest_column()
        x = self.browser.find_element(By.CSS_SELECTOR, "[aria-label='object.1.position, x']")
        self.change(lambda: self.script("""
            arguments[0].value = '-0.3';
            arguments[0].dispatchEvent(new Event('input', {bubbles: true}));""", x))
        # 0.2 mm to the right in the plane in focus are 25 pixels of 8 um; the edges are noisy to some pixels.
        self.assertAlmostEqual(brightest_column() - before, 25, delta=5)
        self.assertIn("object.1.position=-0.3 0 -40 mm", shlex.split(self.get("command").text))
        # Dragging moves what is pressed by the same way: 20 pixels of the view up are 0.16 mm.
        frame, scale = self.get("frame"), float(self.get("zoom-text").text.split()[0]) / 100
        self.change(lambda: ActionChains(self.browser).move_to_element(frame).click_and_hold().move_by_offset(
            0, -round(20 * scale)).release().perform())
        y = self.browser.find_element(By.CSS_SELECTOR, "[aria-label='object.1.position, y']")
        self.assertAlmostEqual(float(y.get_attribute("value")), 0.16, delta=0.01)
        self.change(lambda: self.get("live-reset").click())
        self.assertEqual(y.get_attribute("value"), "0")
        self.assertNotIn("--set", self.get("command").text)

    def test_says_that_the_server_is_gone(self):
        self.server.stop()
        self.set_number("distance-number", 50)
        wait_until(lambda: "does not answer" in self.get("problem").text)

    def test_loads_again_what_failed(self):
        added = self.browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": """
            const original = window.fetch;
            window.fetch = (path, options) => {
              if (path !== 'points' || window.hasFailed) return original(path, options);
              window.hasFailed = true;
              return Promise.reject(new TypeError('lost'));
            };"""})
        self.addCleanup(self.browser.execute_cdp_cmd, "Page.removeScriptToEvaluateOnNewDocument", added)
        self.browser.get(self.server.url)
        wait_until(lambda: self.script("return window.hasFailed"))
        wait_until(lambda: self.get("space").get_attribute("data-eye-x"), what="the points at the second try")
        wait_until(lambda: self.get("problem").text == "")

    def test_opens_by_a_private_file(self):
        bin_folder = os.path.join(self.folder, "bin")
        os.makedirs(bin_folder)
        noted = os.path.join(self.folder, "noted")
        program = os.path.join(bin_folder, "xdg-open")
        with open(program, "w") as file:  # what the program was called with, and its session
            file.write(f'#!/bin/sh\necho "$1 $(cut -d " " -f 6 /proc/$$/stat) $$" > {noted}.new && mv {noted}.new {noted}\n')
        os.chmod(program, 0o755)
        server = subprocess.Popen([PROGRAM, "view", self.out], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                  env={**os.environ, "DISPLAY": ":99", "PATH": bin_folder + ":" + os.environ["PATH"]})
        self.addCleanup(server.kill)
        url = server.stdout.readline().strip()
        wait_until(lambda: os.path.exists(noted), what="xdg-open")
        with open(noted) as file:
            path, session, process = file.read().split()
        self.assertEqual(session, process)  # a session of its own: Ctrl-C does not reach it
        self.assertNotIn(url.split("/")[3], path)
        self.assertEqual(os.stat(path).st_mode & 0o777, 0o600)
        self.assertEqual(os.stat(os.path.dirname(path)).st_mode & 0o777, 0o700)
        self.browser.get("file://" + path)
        wait_until(lambda: self.browser.current_url == url, what="the page")
        self.settle()
        server.send_signal(signal.SIGINT)
        server.communicate(timeout=20)
        self.assertFalse(os.path.exists(os.path.dirname(path)))

    def test_shows_in_a_frame_of_this_machine_if_asked_to(self):
        """A page of another server stands for a notebook: its origin is of another site (localhost), then of another port."""
        class Notebook(http.server.BaseHTTPRequestHandler):
            url = ""

            def do_GET(self):
                page = f'<!doctype html><iframe id="viewer" src="{self.url}" width="900" height="600"></iframe>'.encode()
                self.send_response(200)
                self.send_header("Content-Type", "text/html")
                self.end_headers()
                self.wfile.write(page)

            def log_message(self, *arguments):
                pass

        notebook = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Notebook)
        threading.Thread(target=notebook.serve_forever, daemon=True).start()
        self.addCleanup(notebook.server_close)
        self.addCleanup(notebook.shutdown)
        embedded = Server("--embed", self.out, stdin=subprocess.PIPE)
        self.addCleanup(embedded.stop)
        for server, host, is_shown in ((embedded, "localhost", True), (embedded, "127.0.0.1", True),
                                       (self.server, "localhost", False), (self.server, "127.0.0.1", False)):
            Notebook.url = server.url
            self.browser.get(f"http://{host}:{notebook.server_address[1]}/")
            self.browser.switch_to.frame("viewer")
            if is_shown:
                self.settle()
                self.change(lambda: self.get("frame").send_keys(Keys.ARROW_UP))
            else:
                wait_until(lambda: self.script("return document.readyState") == "complete", what="the frame")
                self.assertFalse(self.browser.find_elements(By.ID, "picture"))
            self.browser.switch_to.default_content()

    def test_loads_nothing_from_elsewhere(self):
        origin = self.script("return location.origin")
        for name in self.script("return performance.getEntriesByType('resource').map(entry => entry.name)"):
            self.assertTrue(name.startswith(origin) or name.startswith("data:"), name)
        self.browser.get_log("browser")  # of earlier tests
        self.open()
        self.assertEqual([entry["message"] for entry in self.browser.get_log("browser")], [])

    def test_is_accessible(self):
        for theme in ("light", "dark"):
            self.script("document.documentElement.dataset.theme = arguments[0]", theme)
            self.script("document.querySelectorAll('details').forEach(box => { box.open = true; })")
            self.assertEqual(self.script(FAULTS), [], theme)
        nodes = self.browser.execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]
        needing = {"button", "slider", "spinbutton", "checkbox", "combobox", "link", "image", "application"}
        for node in nodes:
            if not node.get("ignored") and node.get("role", {}).get("value") in needing:
                self.assertTrue(node.get("name", {}).get("value"), json.dumps(node)[:300])

    def test_works_by_keyboard(self):
        """Tab reaches every control once, in the order of the page, and shows where the focus is."""
        for theme in ("light", "dark"):
            self.script("document.documentElement.dataset.theme = arguments[0]", theme)
            self.script("document.querySelectorAll('details').forEach(box => { box.open = true; })")
            expected = self.script(CONTROLS + "return controls.map(nameOf)")
            self.assertGreater(len(expected), 25)
            self.script("document.querySelector('.skip').focus()")
            reached = expected[:1]
            while len(reached) < len(expected):
                ActionChains(self.browser).send_keys(Keys.TAB).perform()
                name, fault = self.script(CONTROLS + FOCUS)
                reached.append(name)
                self.assertEqual(fault, "", f"{name}, {theme}")
            self.assertEqual(reached, expected)

    def test_fits_a_phone(self):
        phone = new_browser(390, 844, True)
        self.addCleanup(phone.quit)
        phone.get(self.server.url)
        wait_until(lambda: phone.execute_script("return document.body.dataset.complete"))
        phone.execute_script("document.querySelectorAll('details').forEach(box => { box.open = true; })")
        self.assertLessEqual(phone.execute_script("return document.documentElement.scrollWidth"), 390)
        self.assertEqual(phone.execute_script("""  // What lies in the view is cut at its frame.
            return [...document.querySelectorAll('body *:not(#sheet, #sheet *, .hidden, .skip)')].filter(e => {
              const box = e.getBoundingClientRect();
              return box.width > 0 && (box.left < -0.5 || box.right > 390.5);
            }).map(e => e.id || e.outerHTML.slice(0, 80))"""), [])
        self.assertEqual(phone.execute_script(FAULTS), [])
        self.keep_screenshot(phone, "viewer_phone")

    def test_fits_a_desktop(self):
        self.assertLessEqual(self.script("return document.documentElement.scrollHeight"), 720)
        self.keep_screenshot(self.browser, "viewer_desktop")

    def keep_screenshot(self, browser, name):
        folder = os.environ.get("HOLOTRACE_SCREENSHOTS")
        if folder:
            browser.save_screenshot(os.path.join(folder, name + ".png"))


# All that Tab should reach.
CONTROLS = """
const controls = [...document.querySelectorAll('a[href], button, input, select, summary, [tabindex="0"]')]
  .filter(e => !e.disabled && e.getClientRects().length > 0 && getComputedStyle(e).visibility !== 'hidden');
const nameOf = e => e.id || (e.labels && e.labels[0] ? e.labels[0].textContent.trim() : e.textContent.trim());
"""

# The control in focus, and what is wrong with it: no ring around it, or beyond the window.
FOCUS = """
const e = document.activeElement, style = getComputedStyle(e), box = e.getBoundingClientRect();
const ring = style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) >= 1;
const isInside = box.bottom > 0 && box.right > 0 && box.top < innerHeight && box.left < innerWidth;
return [nameOf(e), !ring ? 'no ring' : !isInside ? 'not in the window' : ''];
"""

# Faults that WCAG 2.2 AA names and a program can find: controls and pictures without a name, text whose contrast is
# below 4.5, targets smaller than 24 pixels, names that are used twice, headings that skip a level.
FAULTS = """
const faults = [];
const isShown = e => e.getClientRects().length > 0 && getComputedStyle(e).visibility !== 'hidden';
for (const e of document.querySelectorAll('input, select, button, a[href]')) {
  const name = (e.labels && [...e.labels].map(l => l.textContent).join('')) || e.getAttribute('aria-label') || e.textContent;
  if (!name.trim()) faults.push('no name: ' + e.outerHTML.slice(0, 80));
  const box = (e.labels && e.labels[0] && e.type === 'checkbox' ? e.labels[0] : e).getBoundingClientRect();
  if (isShown(e) && !e.classList.contains('skip') && (box.width < 24 || box.height < 24))
    faults.push(`small: ${e.id || e.outerHTML.slice(0, 60)} ${box.width} x ${box.height}`);
}
const ids = [...document.querySelectorAll('[id]')].map(e => e.id);
for (const id of ids) if (ids.indexOf(id) !== ids.lastIndexOf(id)) faults.push('twice: ' + id);
let level = 0;
for (const e of document.querySelectorAll('h1, h2, h3, h4')) {
  if (Number(e.tagName[1]) > level + 1) faults.push('heading skips: ' + e.textContent);
  level = Number(e.tagName[1]);
}
const numbers = colour => (colour.match(/[\\d.]+/g) || []).map(Number);
const light = ([r, g, b]) => [r, g, b].map(v => v / 255).map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
  .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
const ground = e => { for (; e; e = e.parentElement) { const c = numbers(getComputedStyle(e).backgroundColor); if (c.length === 3 || c[3] > 0.5) return c; } return [255, 255, 255]; };
for (const e of document.querySelectorAll('body *')) {
  if (!isShown(e) || ![...e.childNodes].some(n => n.nodeType === 3 && n.textContent.trim())) continue;
  if (['SCRIPT', 'STYLE', 'OPTION'].includes(e.tagName)) continue;
  const [a, b] = [light(numbers(getComputedStyle(e).color)), light(ground(e))].sort((x, y) => y - x);
  if ((a + 0.05) / (b + 0.05) < 4.5) faults.push(`contrast ${((a + 0.05) / (b + 0.05)).toFixed(2)}: ${e.id || e.textContent.slice(0, 30)}`);
}
return faults;
"""

if __name__ == "__main__":
    unittest.main(argv=["browser_test.py", *sys.argv[1:]], verbosity=2)

#!/usr/bin/env python3
"""The built documentation site, in its files and in a real browser: headless Chromium, driven by Selenium.

Usage: site_test.py HTML [unittest arguments]. Without the site, Chromium, its driver or Selenium: exit code 77.
HOLOTRACE_SCREENSHOTS=FOLDER writes pictures of all pages: on a desktop, light and dark, and on a phone.
"""

import functools
import html.parser
import http.server
import json
import os
import pathlib
import re
import sys
import threading
import time
import unittest
import urllib.parse

SITE = pathlib.Path(sys.argv.pop(1)).resolve()
if not (SITE / "index.html").exists():
    print(f"skipped: the site was not built in {SITE}; scripts/docs builds it")
    sys.exit(77)

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from browser import new_browser  # noqa: E402

PAGES = sorted(str(page.relative_to(SITE)) for page in SITE.rglob("*.html") if "_static" not in page.parts)
MOST_ENTRIES = 12  # of the navigation: more are not taken in at a glance
PHONE = 390  # pixels: the width of today's most common phones


class Links(html.parser.HTMLParser):
    """Links, sources and anchors of a page."""

    def __init__(self, text):
        super().__init__()
        self.targets, self.anchors = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("href", "src") and value:
                self.targets.append(value)
            elif name == "id":
                self.anchors.add(value)


@functools.cache
def links(page):
    return Links((SITE / page).read_text())


def dead_links(page):
    for target in links(page).targets:
        url = urllib.parse.urlsplit(target)
        if url.scheme or url.netloc:
            continue
        file = (SITE / page).parent / urllib.parse.unquote(url.path) if url.path else SITE / page
        if not file.is_file():
            yield f"{page}: {target} is no file"
        elif url.fragment and file.suffix == ".html":
            if urllib.parse.unquote(url.fragment) not in links(os.path.relpath(file, SITE)).anchors:
                yield f"{page}: {target} is no anchor"


class Files(http.server.SimpleHTTPRequestHandler):
    def __init__(self, *arguments):
        super().__init__(*arguments, directory=SITE)

    def log_message(self, *arguments):
        pass


class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Files)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        cls.addClassCleanup(server.server_close)
        cls.addClassCleanup(server.shutdown)
        cls.address = f"http://127.0.0.1:{server.server_port}/"
        cls.browser = new_browser(1280, 800, logs=("browser", "performance"))
        cls.addClassCleanup(cls.browser.quit)

    def set_width(self, columns, rows, is_phone=False):
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                     {"width": columns, "height": rows, "deviceScaleFactor": 1, "mobile": is_phone})

    def open(self, page):
        self.browser.get(self.address + page)

    def script(self, text):
        return self.browser.execute_script(text)

    def failed_requests(self):
        """Answers that are errors, and requests that leave the site."""
        for entry in self.browser.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            about = message["params"]
            if message["method"] == "Network.responseReceived" and about["response"]["status"] >= 400:
                yield f"{about['response']['status']} {about['response']['url']}"
            elif message["method"] == "Network.loadingFailed" and not about.get("canceled"):
                yield about["errorText"]
            elif message["method"] == "Network.requestWillBeSent":
                url = about["request"]["url"]
                if not url.startswith((self.address, "data:", "blob:")):
                    yield f"a request to {url}"

    def test_every_link_and_anchor_leads_somewhere(self):
        self.assertEqual([dead for page in PAGES for dead in dead_links(page)], [])

    def test_every_page_works_on_a_phone(self):
        """No error in the console, no failed request, no picture that is missing, nothing wider than the screen."""
        self.assertGreater(len(PAGES), 50)  # 36 pages of docs/, 9 groups, 3 notebooks, index, search, gallery
        self.set_width(PHONE, 844, True)
        for page in PAGES:
            with self.subTest(page):
                self.open(page)
                faults = [*self.failed_requests(), *(entry["message"] for entry in self.browser.get_log("browser"))]
                faults += self.script("""
                    return [...document.images].filter(one => one.complete && !one.naturalWidth)
                      .map(one => `no picture ${one.src}`)""")
                width = self.script("""  // of the page and of the theme's box of text, which scrolls by itself
                    return Math.max(...[...document.querySelectorAll('html, .content')].map(one => one.scrollWidth))""")
                self.assertEqual(faults + [f"{width} pixels wide"], [f"{PHONE} pixels wide"])

    def test_the_navigation_is_short_and_reaches_every_page(self):
        self.set_width(1280, 800)
        self.open("index.html")
        self.assertLessEqual(self.script("return document.querySelectorAll('.sidebar-tree li.toctree-l1').length"), MOST_ENTRIES)
        reached = set(self.script("""
            return [...document.querySelectorAll('.sidebar-tree a')].map(one => one.getAttribute('href'))"""))
        made = {"index.html", "genindex.html", "search.html", "py-modindex.html"}  # by Sphinx
        self.assertEqual(set(PAGES) - reached - made, set())

    def test_the_first_page_shows_what_it_is(self):
        self.set_width(1280, 800)
        self.open("index.html")
        text = self.script("return document.querySelector('article').innerText")
        for part in ("pip install", "import holotrace as ht", "Learn", "Do", "Look up", "Understand", "More pictures"):
            self.assertIn(part, text)
        self.assertTrue(self.script("""
            const picture = document.querySelector('article img').getBoundingClientRect();
            return picture.top < innerHeight && picture.width > 500;"""))

    def test_the_gallery_has_pictures_with_commands_and_figures(self):
        self.open("gallery.html")
        for what in ("img", "pre"):
            count = self.script(f"return document.querySelectorAll('article section {what}').length")
            self.assertGreaterEqual(count, 20, what)
        figures = self.script("return document.querySelector('article').innerText.match(/^Figures: .*\\d.*$/gm)")
        self.assertGreaterEqual(len(figures), 20)

    def test_notebooks_show_their_pictures(self):
        for page in (page for page in PAGES if page.startswith("notebooks/") and not page.endswith("README.html")):
            with self.subTest(page):
                text = (SITE / page).read_text()
                if "was not installed where this page was built" not in text:
                    self.assertIn("data:image/png;base64,", text)

    def test_the_theme_switches_and_is_remembered(self):
        """The button goes through the system's theme, the other one and its own; the pages' colours follow."""
        self.set_width(1280, 800)
        light = {"features": [{"name": "prefers-color-scheme", "value": "light"}]}
        self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", light)
        self.open("index.html")
        self.script("localStorage.clear()")
        self.open("index.html")
        colours = {}
        for _ in range(3):
            theme = self.script("return document.body.dataset.theme")
            colours[theme] = self.script("return getComputedStyle(document.body).backgroundColor")
            self.script("""[...document.querySelectorAll('.theme-toggle')].find(one => one.offsetParent).click()""")
        self.assertEqual(set(colours), {"auto", "light", "dark"})
        self.assertEqual(colours["auto"], colours["light"])
        self.assertLess(brightness(colours["dark"]), 0.2)
        self.assertGreater(brightness(colours["light"]), 0.9)
        while self.script("return document.body.dataset.theme") != "dark":
            self.script("""[...document.querySelectorAll('.theme-toggle')].find(one => one.offsetParent).click()""")
        self.open("gallery.html")
        self.assertEqual(self.script("return document.body.dataset.theme"), "dark")
        self.script("localStorage.clear()")

    def test_the_search_finds_pages(self):
        self.set_width(1280, 800)
        self.open("search.html?q=speckle")
        end, found = time.time() + 20, []
        while "Reduce speckle" not in found:
            self.assertLess(time.time(), end, found)
            time.sleep(0.1)
            found = self.script("return [...document.querySelectorAll('#search-results li a')].map(one => one.innerText)")

    @unittest.skipUnless("HOLOTRACE_SCREENSHOTS" in os.environ, "no folder for pictures")
    def test_pictures_of_all_pages(self):
        folder = pathlib.Path(os.environ["HOLOTRACE_SCREENSHOTS"])
        folder.mkdir(parents=True, exist_ok=True)
        for theme, columns, rows in (("light", 1280, 1600), ("dark", 1280, 1600), ("light", PHONE, 1400)):
            self.set_width(columns, rows, columns == PHONE)
            for page in PAGES:
                self.open(page)
                self.script(f"document.body.dataset.theme = '{theme}'")
                self.browser.save_screenshot(str(folder / f"{page.replace('/', '_')}_{theme}_{columns}.png"))


def brightness(colour):
    """Of "rgb(r, g, b)", from 0 to 1."""
    return sum(int(value) for value in re.findall(r"\d+", colour)[:3]) / (3 * 255)


if __name__ == "__main__":
    unittest.main(argv=["site_test.py", *sys.argv[1:]], verbosity=2)

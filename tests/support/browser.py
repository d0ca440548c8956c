"""A headless Chromium for tests, driven by Selenium. Importing it ends a test with 77 where one of them is missing."""

import shutil
import sys

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
except ImportError as error:
    print(f"skipped: {error}; scripts/setup --tests installs what is missing")
    sys.exit(77)

DRIVER = shutil.which("chromedriver")
if not DRIVER or not (shutil.which("chromium") or shutil.which("google-chrome")):
    print("skipped: no chromium with chromedriver; scripts/setup --tests installs them")
    sys.exit(77)


def new_browser(columns, rows, is_phone=False, logs=("browser",)):
    options = webdriver.ChromeOptions()
    for argument in ("--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                     "--ignore-gpu-blocklist", "--hide-scrollbars", "--disable-dev-shm-usage"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {log: "ALL" for log in logs})
    browser = webdriver.Chrome(options=options, service=Service(DRIVER))
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                            {"width": columns, "height": rows, "deviceScaleFactor": 1, "mobile": is_phone})
    return browser

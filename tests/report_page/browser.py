"""A headless Chromium over the WebDriver protocol, with nothing but Python's standard library."""

import base64
import json
import shutil
import socket
import subprocess
import tempfile
import time
import urllib.error
import urllib.request
from pathlib import Path

# A browser for tests calls nobody.
FLAGS = [
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--force-color-profile=srgb", "--hide-scrollbars",
]


def is_installed():
    return bool(shutil.which("chromium") and shutil.which("chromedriver"))


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Browser:
    """Use as a context: `with Browser() as browser: browser.open(path)`."""

    def __init__(self, width=1280, height=900, scale=1):
        self.flags = FLAGS + [f"--window-size={width},{height}", f"--force-device-scale-factor={scale}"]

    def __enter__(self):
        self.profile = tempfile.TemporaryDirectory(prefix="batten-page-")
        port = free_port()
        self.root = f"http://127.0.0.1:{port}"
        self.driver = subprocess.Popen(
            [shutil.which("chromedriver"), f"--port={port}"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.wait_for_driver()
        options = {
            "binary": shutil.which("chromium"),
            "args": self.flags + [f"--user-data-dir={self.profile.name}"],
        }
        session = self.send("POST", "/session", {"capabilities": {"alwaysMatch": {
            "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}}})
        self.session = "/session/" + session["sessionId"]
        return self

    def __exit__(self, *_):
        try:
            self.send("DELETE", self.session)
        finally:
            self.driver.terminate()
            self.driver.wait()
            self.profile.cleanup()

    def wait_for_driver(self):
        for _ in range(300):
            try:
                if self.send("GET", "/status")["ready"]:
                    return
            except (urllib.error.URLError, ConnectionError):
                pass
            time.sleep(0.1)
        raise RuntimeError("chromedriver does not answer")

    def send(self, method, path, body=None):
        data = None if body is None and method != "POST" else json.dumps(body or {}).encode()
        request = urllib.request.Request(self.root + path, data=data, method=method)
        request.add_header("Content-Type", "application/json")
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"]) from None

    # --- what a user does ---------------------------------------------------------------------

    def open(self, page):
        self.send("POST", self.session + "/url", {"url": Path(page).resolve().as_uri()})

    def run(self, script, *arguments):
        """The value of a function body that runs in the page."""
        return self.send("POST", self.session + "/execute/sync", {"script": script, "args": list(arguments)})

    def find(self, selector):
        found = self.send("POST", self.session + "/element", {"using": "css selector", "value": selector})
        return next(iter(found.values()))

    def click(self, selector):
        self.send("POST", f"{self.session}/element/{self.find(selector)}/click")

    def keys(self, text, selector="body"):
        self.send("POST", f"{self.session}/element/{self.find(selector)}/value", {"text": text})

    def tab(self):
        """The Tab key, wherever the focus is."""
        for kind in ("rawKeyDown", "keyUp"):
            self.devtools("Input.dispatchKeyEvent", type=kind, key="Tab", code="Tab", windowsVirtualKeyCode=9)

    def point(self, selector, right=0, down=0, drag=None):
        """Moves the mouse to a place from an element's middle; `drag`: and holds it for that way."""
        origin = {"element-6066-11e4-a52e-4f735466cecf": self.find(selector)}
        steps = [{"type": "pointerMove", "duration": 0, "x": right, "y": down, "origin": origin}]
        if drag:
            steps += [{"type": "pointerDown", "button": 0},
                      {"type": "pointerMove", "duration": 50, "x": right + drag[0], "y": down + drag[1], "origin": origin},
                      {"type": "pointerUp", "button": 0}]
        self.send("POST", self.session + "/actions", {"actions": [
            {"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": steps}]})

    def wheel(self, selector, turn):
        origin = {"element-6066-11e4-a52e-4f735466cecf": self.find(selector)}
        self.send("POST", self.session + "/actions", {"actions": [{"type": "wheel", "id": "wheel", "actions": [
            {"type": "scroll", "x": 0, "y": 0, "deltaX": 0, "deltaY": turn, "duration": 0, "origin": origin}]}]})

    def wait(self, condition, seconds=30):
        """Until the expression is true in the page."""
        for _ in range(int(seconds / 0.05)):
            if self.run(f"return !!({condition})"):
                return
            time.sleep(0.05)
        raise RuntimeError(f"never true: {condition}")

    def complaints(self):
        log = self.send("POST", self.session + "/se/log", {"type": "browser"})
        return [entry["message"] for entry in log if entry["level"] in ("SEVERE", "WARNING")]

    def devtools(self, command, **parameters):
        return self.send("POST", self.session + "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def dark(self, wanted):
        value = "dark" if wanted else "light"
        self.devtools("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": value}])

    def size(self, width, height):
        """Of the page in CSS pixels; narrower than a window can be, too."""
        self.devtools("Emulation.setDeviceMetricsOverride", width=width, height=height,
                      deviceScaleFactor=1, mobile=False)

    def picture(self, file, whole=True):
        shot = self.devtools("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        Path(file).write_bytes(base64.b64decode(shot["data"]))

    def paper(self, file):
        printed = self.devtools("Page.printToPDF", printBackground=True)
        Path(file).write_bytes(base64.b64decode(printed["data"]))

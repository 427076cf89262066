"""A real Chromium by its driver, over the WebDriver protocol: as much of it as the page's tests and figures need."""

from __future__ import annotations

import base64
import json
import shutil
import subprocess
import urllib.error
import urllib.request
from pathlib import Path
from typing import Any

BROWSER = shutil.which("chromium") or shutil.which("google-chrome") or shutil.which("chromium-browser")
DRIVER = shutil.which("chromedriver")
ELEMENT = "element-6066-11e4-a52e-4f735466cecf"  # the key of an element in WebDriver's JSON
FLAGS = ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars",
         "--window-size=1400,900")
KEYS = {"Delete": "\ue017", "Insert": "\ue016", "PageDown": "\ue00f", "PageUp": "\ue00e", "Left": "\ue012",
        "Up": "\ue013", "Right": "\ue014", "Down": "\ue015", "Tab": "\ue004", "Shift": "\ue008", "Control": "\ue009"}


class Browser:
    """One window. Elements are named by their id, or by any CSS selector."""

    def __init__(self, first: str = "") -> None:
        """first: JavaScript that runs in each page before its own."""
        assert BROWSER and DRIVER
        self.driver = subprocess.Popen([DRIVER, "--port=0"], stdout=subprocess.PIPE, text=True)
        assert self.driver.stdout is not None
        started = next(line for line in self.driver.stdout if "successfully on port" in line)
        self.base = f"http://127.0.0.1:{started.split()[-1].rstrip('.')}"
        options = {"args": list(FLAGS), "binary": BROWSER}
        capabilities = {"goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}
        self.session = ""
        self.session = "/session/" + self.call("/session", {"capabilities": {"alwaysMatch": capabilities}})["sessionId"]
        if first:
            self.chromium("Page.addScriptToEvaluateOnNewDocument", source=first)

    def call(self, path: str, body: dict[str, Any] | None = None, method: str = "POST") -> Any:
        data = None if body is None else json.dumps(body).encode()
        headers = {"Content-Type": "application/json"}
        request = urllib.request.Request(self.base + self.session + path, data, headers, method=method)
        try:
            with urllib.request.urlopen(request, timeout=60) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as refused:
            raise AssertionError(json.load(refused)["value"]["message"]) from None

    def close(self) -> None:
        try:
            self.call("", method="DELETE")
        finally:
            self.driver.terminate()
            self.driver.wait()

    def chromium(self, command: str, **parameters: Any) -> Any:
        """A command of Chromium's own protocol."""
        return self.call("/goog/cdp/execute", {"cmd": command, "params": parameters})

    def open(self, page: Path, width: int = 1400, height: int = 900, **media: str) -> None:
        """Loads a file in a window of that size, with media features such as prefers_color_scheme="dark"."""
        features = [{"name": name.replace("_", "-"), "value": value} for name, value in media.items()]
        self.chromium("Emulation.setEmulatedMedia", features=features)
        self.chromium("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1,
                      mobile=width < 600)
        self.call("/url", {"url": page.resolve().as_uri()})
        self.wait("return document.getElementById('bits').dataset.same")

    def js(self, code: str, *arguments: Any) -> Any:
        return self.call("/execute/sync", {"script": code, "args": list(arguments)})

    def wait(self, condition: str) -> Any:
        """Until it holds: looked at in every frame, 20 s at most."""
        script = f"""const done = arguments[0], end = performance.now() + 20000, holds = () => {{ {condition} }};
            const ends = () => holds() || performance.now() > end;
            const look = () => ends() ? done(holds() || false) : requestAnimationFrame(look);
            look();"""
        found = self.call("/execute/async", {"script": script, "args": []})
        assert found, f"never: {condition}"
        return found

    def element(self, name: str) -> str:
        selector = name if any(sign in name for sign in "[# >") else f"[id='{name}']"
        return str(self.call("/element", {"using": "css selector", "value": selector})[ELEMENT])

    def click(self, name: str) -> None:
        """A real click, which fails where something else lies above."""
        self.call(f"/element/{self.element(name)}/click", {})

    def type(self, name: str, text: str) -> None:
        """Replaces what a field has by keys, and leaves it."""
        element = self.element(name)
        self.call(f"/element/{element}/value", {"text": f"{KEYS['Control']}a\ue000\ue003{text}{KEYS['Tab']}"})

    def choose(self, name: str, value: str) -> None:
        """An option of a list, or the place of a slider."""
        self.js("""const [id, value] = arguments, each = document.getElementById(id);
            each.value = value;
            each.dispatchEvent(new Event(each.type === "range" ? "input" : "change"));""", name, value)

    def text(self, name: str) -> str:
        return str(self.js("return document.getElementById(arguments[0]).textContent", name))

    def value(self, name: str) -> str:
        return str(self.js("return document.getElementById(arguments[0]).value", name))

    def key(self, *steps: tuple[str, str]) -> None:
        """Keys down and up: ("keyDown", "w") …"""
        actions = [{"type": kind, "value": KEYS.get(key, key)} for kind, key in steps]
        self.call("/actions", {"actions": [{"type": "key", "id": "keys", "actions": actions}]})

    def press(self, *keys: str) -> None:
        self.key(*((kind, key) for key in keys for kind in ("keyDown", "keyUp")))

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """The pointer from one place of the window to another, its button down."""
        actions: list[dict[str, Any]] = [
            {"type": "pointerMove", "x": round(start[0]), "y": round(start[1])}, {"type": "pointerDown", "button": 0},
            {"type": "pointerMove", "x": round(end[0]), "y": round(end[1])}, {"type": "pointerUp", "button": 0}]
        self.call("/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": actions}]})

    def shot(self, path: Path, *, whole: bool = False) -> None:
        """A picture of what the window shows, or of the whole page."""
        picture = self.chromium("Page.captureScreenshot", format="png", captureBeyondViewport=whole)["data"]
        path.write_bytes(base64.b64decode(picture))

    def errors(self) -> list[str]:
        """What the console said since the last call."""
        return [line["message"] for line in self.call("/se/log", {"type": "browser"})]

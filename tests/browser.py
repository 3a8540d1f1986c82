"""Chromium without a window, for tests of pages: how wide they are, what they say, how they print.

A test asks for it by `CHROMIUM`, and is skipped where there is none.
"""

from __future__ import annotations

import asyncio
import base64
import json
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tornado.websocket import WebSocketClientConnection, websocket_connect

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
WIDTHS = (390, 1280)
"""px: a phone, a desk."""
LOOK = """(() => {
  const wide = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  const body = getComputedStyle(document.body);
  const broken = [...document.images].filter(i => !i.complete || !i.naturalWidth).length;
  const blocks = [...document.querySelectorAll('h1,h2,p,li,figure,.box,details,.scroll,pre')]
    .filter(e => !e.parentElement.closest('.box,figure,details,ul'))
    .map(e => e.getBoundingClientRect()).filter(r => r.height);
  let overlaps = 0;
  for (let i = 0; i < blocks.length; i++) for (let j = i + 1; j < blocks.length; j++) {
    const a = blocks[i], b = blocks[j];
    if (Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 &&
        Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1) overlaps++;
  }
  return {wide, overlaps, broken, ink: body.color, paper: body.backgroundColor,
          height: document.documentElement.scrollHeight};
})()"""
"""What a page looks like: px beyond the window, blocks over one another, broken pictures."""


class Page:
    """One page, open."""

    def __init__(self, socket: WebSocketClientConnection, loop: asyncio.AbstractEventLoop) -> None:
        self._socket, self._loop, self._number = socket, loop, 0
        self.console: list[str] = []
        self.asked: list[str] = []

    def call(self, method: str, **arguments: object) -> dict[str, Any]:
        """One call of the browser's protocol."""
        return self._loop.run_until_complete(self._call(method, arguments))

    async def _call(self, method: str, arguments: dict[str, object]) -> dict[str, Any]:
        self._number += 1
        said = {"id": self._number, "method": method, "params": arguments}
        await self._socket.write_message(json.dumps(said))
        while True:
            told = await self._told()
            if told.get("id") == self._number:
                assert "error" not in told, told
                answer: dict[str, Any] = told["result"]
                return answer

    async def _told(self) -> dict[str, Any]:
        text = await asyncio.wait_for(self._socket.read_message(), timeout=120)
        assert text is not None, "the browser has gone"
        told: dict[str, Any] = json.loads(text)
        if told.get("method") in ("Runtime.exceptionThrown", "Log.entryAdded"):
            self.console.append(json.dumps(told["params"]))
        if told.get("method") == "Network.requestWillBeSent":
            self.asked.append(told["params"]["request"]["url"])
        return told

    def open(self, path: Path, width: int, *, dark: bool = False) -> dict[str, Any]:
        """Open a file; what it looks like."""
        self.call("Page.enable")
        for domain in ("Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        metrics = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
        self.call("Emulation.setDeviceMetricsOverride", **metrics)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.call("Emulation.setEmulatedMedia", features=[scheme])
        self.call("Page.navigate", url=path.as_uri())
        self._loop.run_until_complete(self._loaded())
        found: dict[str, Any] = self.evaluate(LOOK)
        return found

    async def _loaded(self) -> None:
        while (await self._told()).get("method") != "Page.loadEventFired":
            pass

    def evaluate(self, expression: str) -> Any:
        """The value of an expression of JavaScript."""
        found = self.call(
            "Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in found, found
        return found["result"].get("value")

    def sheets(self) -> int:
        """Of A4, printed."""
        told = self.call("Page.printToPDF", preferCSSPageSize=True, printBackground=True)
        content = base64.b64decode(told["data"])
        return content.count(b"/Type /Page\n") or content.count(b"/Type /Page /")

    def picture(self, path: Path) -> None:
        """The whole page as a PNG."""
        told = self.call("Page.captureScreenshot", captureBeyondViewport=True)
        path.write_bytes(base64.b64decode(told["data"]))


def check_fits(path: Path, scratch: Path) -> None:
    """A page fits phone and desk, has no fault on its console and asks nobody for anything."""
    with browser(scratch) as page:
        for width in WIDTHS:
            look = page.open(path, width)
            assert (look["wide"], look["overlaps"], look["broken"]) == (0, 0, 0), width
        assert page.console == []
        assert [one for one in page.asked if not one.startswith(("file:", "data:"))] == []


@contextmanager
def browser(scratch: Path) -> Iterator[Page]:
    """A page of a browser of its own, gone after the block."""
    assert CHROMIUM is not None
    words = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync"]
    words += ["--disable-background-networking", "--disable-component-update"]
    words += ["--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"]
    words += ["--remote-debugging-port=0", f"--user-data-dir={scratch / 'profile'}", "about:blank"]
    loop = asyncio.new_event_loop()
    process = subprocess.Popen(
        [CHROMIUM, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        socket = loop.run_until_complete(_connected(scratch / "profile" / "DevToolsActivePort"))
        yield Page(socket, loop)
        socket.close()
    finally:
        process.terminate()
        process.wait()
        loop.close()


async def _connected(port_file: Path) -> WebSocketClientConnection:
    from tornado.httpclient import AsyncHTTPClient

    for _ in range(1200):
        if port_file.is_file() and port_file.read_text().strip():
            break
        await asyncio.sleep(0.05)
    port = port_file.read_text().split()[0]
    told = await AsyncHTTPClient().fetch(f"http://127.0.0.1:{port}/json/list")
    page = next(one for one in json.loads(told.body) if one["type"] == "page")
    return await websocket_connect(page["webSocketDebuggerUrl"], max_message_size=2**28)

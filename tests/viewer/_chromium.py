"""A headless Chromium, told what to do over the DevTools protocol; nothing but aiohttp is needed."""

import asyncio
import base64
import json
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = (
    *("--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    *("--hide-scrollbars", "--mute-audio", "--no-first-run", "--disable-extensions", "--disable-background-networking"),
    *("--disable-dev-shm-usage", "--remote-allow-origins=*", "--remote-debugging-port=0"),
)


def installed() -> str | None:
    """The browser's program; None where there is none."""
    return next(filter(None, map(shutil.which, NAMES)), None)


class Page:
    """One page of a browser of its own; use it as a context manager."""

    def __init__(self, size: tuple[int, int] = (1280, 800), *more: str) -> None:
        self.folder = tempfile.TemporaryDirectory(prefix="chromium-")
        program = installed()
        assert program is not None
        self.log = (Path(self.folder.name) / "log").open("w")
        self.process = subprocess.Popen(
            [
                program,
                *FLAGS,
                *more,
                f"--window-size={size[0]},{size[1]}",
                f"--user-data-dir={self.folder.name}/user",
                "about:blank",
            ],
            stdout=self.log,
            stderr=subprocess.STDOUT,
        )
        self.loop, self.count, self.said = asyncio.new_event_loop(), 0, []
        self.loop.run_until_complete(self.connect())
        self.size(*size)

    async def connect(self) -> None:
        import aiohttp

        ports = Path(self.folder.name) / "user" / "DevToolsActivePort"
        end = time.monotonic() + 60.0
        while not (ports.exists() and ports.read_text().strip()):
            assert time.monotonic() < end and self.process.poll() is None, "Chromium did not start"
            await asyncio.sleep(0.1)
        port = ports.read_text().split()[0]
        self.session = aiohttp.ClientSession()
        while True:
            async with self.session.get(f"http://127.0.0.1:{port}/json") as reply:
                pages = [one for one in json.loads(await reply.text()) if one["type"] == "page"]
            if pages:
                break
            await asyncio.sleep(0.1)
        self.socket = await self.session.ws_connect(pages[0]["webSocketDebuggerUrl"], max_msg_size=0)
        for domain in ("Page", "Runtime", "Log"):
            await self.asked(f"{domain}.enable", {})

    async def asked(self, method: str, values: dict[str, Any]) -> dict[str, Any]:
        self.count += 1
        number = self.count
        await self.socket.send_json({"id": number, "method": method, "params": values})
        while True:
            message = json.loads((await asyncio.wait_for(self.socket.receive(), 120.0)).data)
            if message.get("id") == number:
                assert "error" not in message, message
                return message["result"]
            if message.get("method") in ("Runtime.exceptionThrown", "Log.entryAdded"):
                self.said.append(json.dumps(message["params"])[:600])
            if message.get("method") == "Runtime.consoleAPICalled" and message["params"]["type"] in (
                "error",
                "warning",
            ):
                self.said.append(str([one.get("value", one.get("description")) for one in message["params"]["args"]]))

    def ask(self, method: str, **values: Any) -> dict[str, Any]:
        """One command of the DevTools protocol, and its answer."""
        return self.loop.run_until_complete(self.asked(method, values))

    def size(self, width: int, height: int, mobile: bool = False) -> None:
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=mobile)

    def go(self, address: str) -> None:
        self.ask("Page.navigate", url=address)

    def js(self, expression: str) -> Any:
        """The value of an expression in the page; a promise is waited for."""
        found = self.ask("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def wait(self, expression: str, seconds: float = 60.0) -> Any:
        """The first value of an expression that counts as true."""
        end = time.monotonic() + seconds
        while not (value := self.js(f"(() => {{ try {{ return {expression}; }} catch {{ return null; }} }})()")):
            assert time.monotonic() < end, f"{expression} within {seconds} s; the page said {self.said[-5:]}"
            self.loop.run_until_complete(asyncio.sleep(0.05))
        return value

    def key(self, key: str, down: float = 0.0) -> None:
        """Press a key for so long [s]."""
        code = {" ": 32, "ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40, "Tab": 9, "Enter": 13}.get(
            key, ord(key[0].upper())
        )
        values = {"key": key, "windowsVirtualKeyCode": code}
        text = {"text": "\r" if key == "Enter" else key} if len(key) == 1 or key == "Enter" else {}
        self.ask("Input.dispatchKeyEvent", type="keyDown", **values, **text)
        if down:
            self.loop.run_until_complete(asyncio.sleep(down))
        self.ask("Input.dispatchKeyEvent", type="keyUp", **values)

    def picture(self, path: Path | None = None) -> bytes:
        """What is seen, as PNG."""
        data = base64.b64decode(self.ask("Page.captureScreenshot", format="png")["data"])
        if path is not None:
            path.write_bytes(data)
        return data

    def close(self) -> None:
        async def end() -> None:
            await self.socket.close()
            await self.session.close()

        self.loop.run_until_complete(end())
        self.loop.close()
        self.process.terminate()
        self.process.wait(10.0)
        self.log.close()
        self.folder.cleanup()

    def __enter__(self) -> "Page":
        return self

    def __exit__(self, *failure: object) -> None:
        self.close()

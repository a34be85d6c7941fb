"""How long an order takes from the socket of the page to the pose of a platform: median and 99 % of some hundreds.

`python docs/examples/rig_latency.py 200` serves the yacht in waves, steers it as a page would, receives the stream as a
platform does, and asks the water for 50 heights after each order.
"""

import asyncio
import json
import socket
import sys
import tempfile
import threading
from pathlib import Path
from time import perf_counter

import aiohttp
import numpy as np

from ocean_sim.parts import library
from ocean_sim.platform.shared import datagrams
from ocean_sim.viewer.server import Order, Server
from ocean_sim.viewer.session import Session, Source

WARM, STEP = 12.0, 0.02  # [s] until all is compiled, and of a step
KEYS = {"duration": 1e4, "ship.controls": [], "frames": None, "render": None, "time_step.kind": "fixed"}


class Timed(Session):
    """Session that records when it obeyed each order to steer."""

    obeyed: dict[float, float]  # simulated time [s] by throttle

    def take(self, order: Order) -> bool:
        changed = super().take(order)
        if order.command.do == "steer":
            self.obeyed[round(order.command.throttle, 6)] = self.simulation.time
        return changed


async def orders(address: str, count: int, sent: dict[float, float], asked: list[float]) -> None:
    """Act as a page: `count` times, send an order to steer, then a wave query.

    Records in `sent` the time [s] of each order by throttle, and in `asked` the time [s] until each reply.
    """
    random = np.random.default_rng(1)
    async with aiohttp.ClientSession() as session, session.ws_connect(f"{address}watch", max_msg_size=0) as page:
        await asyncio.sleep(WARM)
        for k in range(count):
            throttle = round(0.3 + 1e-3 * k, 6)
            sent[throttle] = perf_counter()
            await page.send_json({"do": "steer", "ship": "ship", "throttle": throttle, "rudder": 0.1})
            await asyncio.sleep(random.uniform(0.05, 0.15))
            begin = perf_counter()
            await page.send_json({"do": "waves", "verb": "elevation", "id": k, "points": [[0.0, 0.0]] * 50})
            async for message in page:
                if message.type == aiohttp.WSMsgType.TEXT and json.loads(message.data).get("id") == k:
                    asked.append(perf_counter() - begin)
                    break
        await asyncio.sleep(1.0)


def show(name: str, seconds: list[float]) -> None:
    median, most = 1e3 * np.percentile(seconds, [50.0, 99.0])
    print(f"{name}: median {median:.1f} ms, 99 % within {most:.1f} ms, of {len(seconds)}")


def main(count: int) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        url = f"udp://127.0.0.1:{free.getsockname()[1]}"
    poses: list[tuple[float, float]] = []  # time of a pose [s], and when it came [s]
    sent: dict[float, float] = {}
    asked: list[float] = []

    def platform() -> None:
        datagrams.receive_stream(url, 60.0, lambda packet: poses.append((packet.time, perf_counter())))

    threading.Thread(target=platform, daemon=True).start()
    source = Source.of(
        library("scenes") / "gallery" / "yacht_in_waves.yaml",
        None,
        KEYS | {"time_step.dt": STEP, "stream.to": url, "runtime.threads": 1},
    )
    page = {"/": ("text/html", lambda: b"")}
    Timed.obeyed = {}
    with Server(page, port=0, hello={"drives": True}) as server, tempfile.TemporaryDirectory() as folder:
        with Timed(source, server, Path(folder), list) as session:

            def steer() -> None:
                asyncio.run(orders(server.address, count, sent, asked))
                session.done = True

            threading.Thread(target=steer, daemon=True).start()
            session.play()
            times, came = np.array(poses).T
            after = {throttle: np.searchsorted(times, moment + 1e-9) for throttle, moment in session.obeyed.items()}
            show("order to pose", [came[k] - sent[each] for each, k in after.items() if k < len(came)])
            show("question to answer", asked)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200)

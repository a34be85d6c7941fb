"""The server behind the page: a thread of its own that sends the newest frame to each watcher and takes commands.

A watcher that cannot keep up gets fewer frames: each waits for its own socket alone, and only the newest frame is kept.
What comes in is bounded in length, in rate and in number. A connection without a whole request is closed, after
MAX_REQUEST_SECONDS or as soon as others need its place.
"""

import asyncio
import errno
import hmac
import json
import logging
import socket
import threading
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import AsyncExitStack, suppress
from time import monotonic
from typing import TYPE_CHECKING, Any, NamedTuple

from ocean_sim.conventions import Failed, Lacking, Refused
from ocean_sim.machine import resource_limit
from ocean_sim.viewer.protocol import LONGEST, LOOKS, VERSION, BadMessage, Command, command

if TYPE_CHECKING:
    from aiohttp import web

PORT = 8765
LOCAL = ("127.0.0.1", "localhost", "::1")
MOST_WATCHERS = 64
MAX_CONNECTIONS = 256  # open at once, and of the files that this process may open at most
MAX_FILE_SHARE = 0.25
MAX_REQUEST_SECONDS = 10.0  # [s] until a whole request is there
WAITING = 256  # commands that are not obeyed yet, and messages that are not sent to one watcher
BURST, A_SECOND = 240, 120  # messages that one watcher may send
STALLED = 30.0  # [s] that a watcher may take for one message, and who gets a file for some of it
REASON = 120  # bytes of why a connection is closed; a frame that closes holds 123
IDLE = 60.0  # [s] after which another may take the helm from who does not touch it
POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
    "connect-src 'self' {socket}; base-uri 'none'; form-action 'none'"
)
NO_FRAMES = "; frame-ancestors 'none'"
HEADERS = {
    "Cache-Control": "no-cache",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
}  # of every answer
NO_FILES = (errno.EMFILE, errno.ENFILE)

File = Callable[[], bytes]  # the content of an address


class Order(NamedTuple):
    """A command, and who gave it."""

    watcher: int
    command: Command


class Watcher:
    """A page that is open."""

    def __init__(self, number: int, socket: "web.WebSocketResponse") -> None:
        self.number, self.socket = number, socket
        self.texts: deque[str] = deque(maxlen=WAITING)
        self.still: bytes | None = None  # the last that was sent
        self.frame: bytes | None = None
        self.woken = asyncio.Event()
        self.allowance, self.asked = float(BURST), monotonic()

    def may_ask(self) -> bool:
        """Whether one more message is within the rate."""
        now = monotonic()
        self.allowance = min(BURST, self.allowance + A_SECOND * (now - self.asked))
        self.asked = now
        self.allowance -= 1.0
        return self.allowance >= 0.0


def ours(record: logging.LogRecord) -> bool:
    """Whether what went wrong is this program's: what is no HTTP is answered, and nobody here has to know."""
    from aiohttp.http_exceptions import HttpProcessingError

    return not (record.exc_info and isinstance(record.exc_info[1], HttpProcessingError))


class Connections:
    """Factory of aiohttp's protocols, and the ones that are open."""

    def __init__(self, protocols: "web.Server") -> None:
        self.protocols = protocols
        self.limit = max(1, min(MAX_CONNECTIONS, int(MAX_FILE_SHARE * resource_limit("RLIMIT_NOFILE"))))
        self.answering: set[Any] = set()  # a whole request has come, and no answer is ready
        self.progress: dict[Any, tuple[float, int]] = {}  # when anything was sent last [s], and bytes to be sent

    def waiting(self) -> list[Any]:
        """Transports of connections without a whole request, the oldest first."""
        lines = [one.transport for one in self.protocols.connections if one not in self.answering]
        return [line for line in lines if line is not None and not line.is_closing()]

    def __call__(self) -> asyncio.BaseProtocol:
        """Protocol of one more connection; beyond the limit the oldest that is waiting is closed, else this one."""
        if len(self.protocols.connections) < self.limit:
            return self.protocols()
        if not (lines := self.waiting()):
            return Closing()
        min(lines, key=lambda line: line.get_write_buffer_size() > 0).abort()
        return self.protocols()

    async def watch(self) -> None:
        """Close those that take too long."""
        while True:
            await asyncio.sleep(0.1 * MAX_REQUEST_SECONDS)
            before, self.progress, now = self.progress, {}, monotonic()
            for line in self.waiting():
                unsent = line.get_write_buffer_size()
                since, then = before.get(line, (now, unsent))
                self.progress[line] = (since if unsent == then else now, unsent)
                if unsent == then and now - since > (STALLED if unsent else MAX_REQUEST_SECONDS):
                    line.abort()


class Closing(asyncio.Protocol):
    """Closes a connection for which there is no place."""

    def connection_made(self, transport: Any) -> None:
        transport.abort()


class Server:
    """An address that a browser can open; an `Audience` for a `Watch`. Use it as a context manager."""

    def __init__(
        self,
        files: Mapping[str, tuple[str, File]],
        host: str = "127.0.0.1",
        port: int | None = None,
        token: str = "",
        hello: Mapping[str, Any] | None = None,
        framed: bool = False,
    ) -> None:
        """`files`: type and content by path; `token`: what an address must hold, if anything; `hello`: what a page is
        told first; `framed`: pages of others may show it inside of theirs. Raises Lacking where aiohttp is not
        installed, and Refused where the port is taken."""
        try:
            import aiohttp.web  # noqa: F401
        except ImportError:
            raise Lacking("the page needs aiohttp: pip install 'ocean-sim[browser]'") from None
        self.files, self.host, self.token, self.hello = files, host, token, dict(hello or {})
        self.policy, self.full = POLICY + ("" if framed else NO_FRAMES), False
        self.all: dict[int, Watcher] = {}
        self.inbox: deque[Order] = deque()
        self.arrived = threading.Event()  # a command, or a watcher
        self.fresh = True  # whether the next frame is for somebody new
        self.watchers, self.helm, self.touched = 0, 0, 0.0
        self.still: bytes | None = None
        self.frame: bytes | None = None
        self.panel: dict[str, Any] = {}
        self.made: dict[str, asyncio.Future[bytes]] = {}  # contents by path, each made once
        self.count = self.refused = 0
        self.loop = asyncio.new_event_loop()
        self.ready, self.failure, self.port = threading.Event(), "", port
        self.thread = threading.Thread(target=self.work, name="viewer", daemon=True)
        self.thread.start()
        self.ready.wait()
        if self.failure:
            self.thread.join()
            raise Refused(self.failure)

    @property
    def local(self) -> bool:
        """Whether only this machine can reach it."""
        return self.host in LOCAL

    @property
    def address(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"http://{host}:{self.port}/" + (f"?token={self.token}" if self.token else "")

    # in the thread of the simulation

    def begin(self, still: bytes) -> None:
        self.loop.call_soon_threadsafe(self.take, still, None)

    def show(self, frame: bytes) -> None:
        self.fresh = False
        self.loop.call_soon_threadsafe(self.take, None, frame)

    def tell(self, watcher: int | None, **message: Any) -> None:
        """Text to one watcher, or to all; a `panel` is kept for those who come later."""
        self.loop.call_soon_threadsafe(self.post, watcher, message)

    def orders(self) -> list[Order]:
        """The commands that have come in since the last call."""
        return [self.inbox.popleft() for _ in range(len(self.inbox))]

    def close(self) -> None:
        """Say goodbye to all watchers, and stop."""
        if self.thread.is_alive():
            with suppress(RuntimeError):
                self.loop.call_soon_threadsafe(self.stopping.set)
            self.thread.join(5.0)

    def __enter__(self) -> "Server":
        return self

    def __exit__(self, *failure: object) -> None:
        self.close()

    # in its own thread

    def work(self) -> None:
        asyncio.set_event_loop(self.loop)
        try:
            self.loop.run_until_complete(self.serve())
        finally:
            self.ready.set()
            self.loop.close()

    async def serve(self) -> None:
        from aiohttp import web

        self.stopping = asyncio.Event()

        @web.middleware
        async def guard(request: web.Request, handler: Any) -> Any:
            return await self.guarded(request, handler)

        async def protect(request: web.Request, response: web.StreamResponse) -> None:
            response.headers.update(HEADERS)
            response.headers["Content-Security-Policy"] = self.policy.format(socket=f"ws://{request.host}")

        app = web.Application(middlewares=[guard])
        app.on_response_prepare.append(protect)
        app.router.add_get("/watch", self.watched)
        for path in self.files:
            app.router.add_get(path, self.given)
        self.log = logging.getLogger("aiohttp.server.ocean_sim")
        self.log.addFilter(ours)
        self.loop.set_exception_handler(self.handle)
        runner = web.AppRunner(app, access_log=None, logger=self.log, shutdown_timeout=1.0)
        await runner.setup()
        assert runner.server is not None
        self.connections = Connections(runner.server)
        async with AsyncExitStack() as last:
            last.push_async_callback(runner.cleanup)
            for port in [self.port] if self.port is not None else [PORT, 0]:
                try:
                    most = max(1, self.connections.limit // 8)  # taken at once, up to three times before any is closed
                    make = self.loop.create_server
                    line = await make(self.connections, self.host, port, reuse_address=True, backlog=most)
                    break
                except OSError as error:
                    self.failure = f"--port {port} on {self.host}: {error.strerror or error}; choose another"
            else:
                return
            last.callback(line.close)
            for each in line.sockets:
                with socket.fromfd(each.fileno(), each.family, each.type) as own:
                    own.listen(self.connections.limit)  # that many wait to be taken
            self.port, self.failure = line.sockets[0].getsockname()[1], ""
            self.ready.set()
            last.callback(asyncio.create_task(self.connections.watch()).cancel)
            await self.stopping.wait()
            for watcher in [*self.all.values()]:
                with suppress(Exception):
                    await watcher.socket.close(code=1001, message=b"the server has stopped")

    def handle(self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Say once that no more files can be opened; asyncio tries again, and reports anything else."""
        failure = context.get("exception")
        if not (isinstance(failure, OSError) and failure.errno in NO_FILES):
            loop.default_exception_handler(context)
        elif not self.full:
            self.full = True
            self.log.error(f"{failure.strerror}: new pages wait until others are closed; raise `ulimit -n`")

    async def guarded(self, request: "web.Request", handler: Any) -> Any:
        """Refuse who has not the token; where there is none, pages of other sites, and names of other machines."""
        from aiohttp import web

        if self.token:
            if not hmac.compare_digest(request.query.get("token", "").encode(), self.token.encode()):
                raise web.HTTPForbidden(text="This address needs the token that the server printed.\n")
        else:
            name = request.host.rsplit(":", 1)[0].strip("[]")
            origin = request.headers.get("Origin")
            if name not in LOCAL or origin not in (None, f"{request.scheme}://{request.host}"):
                raise web.HTTPForbidden(text="This server answers only pages of its own, on this machine.\n")
        self.connections.answering.add(request.protocol)
        try:
            return await handler(request)
        finally:
            self.connections.answering.discard(request.protocol)

    async def given(self, request: "web.Request") -> Any:
        from aiohttp import web

        kind, content = self.files[request.path]
        try:
            if request.path not in self.made:
                self.made[request.path] = asyncio.get_running_loop().run_in_executor(None, content)
            body = await asyncio.shield(self.made[request.path])
        except Failed as error:
            self.made.pop(request.path, None)
            raise web.HTTPNotFound(text=error.sentence) from None
        return web.Response(body=body, headers={"Content-Type": kind})

    async def watched(self, request: "web.Request") -> Any:
        """The socket of one page."""
        from aiohttp import WSMsgType, web

        if len(self.all) >= MOST_WATCHERS:
            raise web.HTTPServiceUnavailable(text="too many watchers\n")
        socket = web.WebSocketResponse(max_msg_size=LONGEST, heartbeat=15.0, compress=False)
        await socket.prepare(request)
        if not self.all and self.hello.get("drives"):
            self.frame = None  # made when somebody watched last; a fresh one comes
        self.count += 1
        watcher = self.all[self.count] = Watcher(self.count, socket)
        self.watchers, self.fresh = len(self.all), True
        self.arrived.set()
        self.post(watcher.number, {"type": "hello", "protocol": VERSION, "you": watcher.number, **self.hello})
        if self.panel:
            self.post(watcher.number, self.panel)
        self.stands()
        sending, why = asyncio.create_task(self.send(watcher)), ""
        try:
            async for message in socket:
                if message.type != WSMsgType.TEXT:
                    break
                self.heard(watcher, message.data)
        except BadMessage as error:
            self.refused += 1
            why = error.sentence
        finally:
            sending.cancel()
            del self.all[watcher.number]
            self.watchers = len(self.all)
            if self.helm == watcher.number:
                self.helm = 0
            self.stands()
            with suppress(Exception):
                await socket.close(
                    code=1008 if socket.close_code is None else 1000, message=why.encode("ascii", "replace")[:REASON]
                )
        return socket

    def heard(self, watcher: Watcher, text: str) -> None:
        """Take one message; raises BadMessage, which ends the connection."""
        if not watcher.may_ask():
            raise BadMessage("too many messages")
        order = command(text)
        if order.do == "take":
            self.grasp(watcher.number)
        elif order.do == "leave":
            self.helm = 0 if self.helm == watcher.number else self.helm
            self.stands()
        elif order.do not in LOOKS and not self.grasp(watcher.number):
            self.refuse(watcher, "Another page has the helm.")
        elif len(self.inbox) >= WAITING:
            self.refuse(watcher, "The simulation is busy; your command was not taken.")
        else:
            self.inbox.append(Order(watcher.number, order))
            self.arrived.set()

    def refuse(self, watcher: Watcher, text: str) -> None:
        """Say why a command is not taken."""
        self.post(watcher.number, {"type": "said", "text": text, "bad": True})

    def grasp(self, number: int) -> bool:
        """Give the helm to a watcher where it is free, or its holder idle; whether this one has it."""
        now = monotonic()
        if self.helm in (0, number) or now - self.touched > IDLE:
            before, self.helm, self.touched = self.helm, number, now
            if before != number:
                self.stands()
        return self.helm == number

    def stands(self) -> None:
        """Tell everybody who has the helm."""
        self.post(None, {"type": "helm", "holder": self.helm, "watchers": len(self.all)})

    def post(self, number: int | None, message: dict[str, Any]) -> None:
        if message.get("type") == "panel" and number is None:
            self.panel = message
        text = json.dumps(message, allow_nan=False, default=str)
        for watcher in self.all.values() if number is None else filter(None, [self.all.get(number)]):
            watcher.texts.append(text)
            watcher.woken.set()

    def take(self, still: bytes | None, frame: bytes | None) -> None:
        """Keep the newest frame, or another still, of which there is no frame yet, for all watchers."""
        self.still, self.frame = still or self.still, frame
        for watcher in self.all.values():
            watcher.woken.set()

    async def send(self, watcher: Watcher) -> None:
        """What is new, whenever this watcher is ready for it."""
        watcher.woken.set()
        with suppress(ConnectionError, TimeoutError):
            while True:
                await watcher.woken.wait()
                watcher.woken.clear()
                while watcher.texts:
                    await asyncio.wait_for(watcher.socket.send_str(watcher.texts.popleft()), STALLED)
                if self.still is not None and watcher.still is not self.still:
                    watcher.still = self.still
                    await asyncio.wait_for(watcher.socket.send_bytes(self.still), STALLED)
                frame = self.frame
                if frame is not None and watcher.frame is not frame and watcher.still is self.still:
                    watcher.frame = frame
                    await asyncio.wait_for(watcher.socket.send_bytes(frame), STALLED)
        with suppress(Exception):
            await watcher.socket.close(code=1008)

"""Web server of the page: a thread of its own that sends the newest frame to each watcher, that is, each open page, and
receives commands.

A slow watcher gets fewer frames: each waits for its own socket alone, and only the newest frame is kept. Commands are
bounded in length, rate and number. A connection without a whole request is closed after MAX_REQUEST_SECONDS, or as soon
as others need its place.
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
from contextlib import AbstractContextManager, AsyncExitStack, suppress
from time import monotonic
from typing import TYPE_CHECKING, Any, NamedTuple

from ocean_sim.conventions import Failed, Lacking, Refused
from ocean_sim.machine import resource_limit
from ocean_sim.viewer import protocol
from ocean_sim.viewer.protocol import BadMessage, Command, parse_command

if TYPE_CHECKING:
    from aiohttp import web

DEFAULT_PORT = 8765
LOCAL_HOSTS = ("127.0.0.1", "localhost", "::1")
MAX_WATCHERS = 64
MAX_CONNECTIONS = 256  # open at once, and of the files that this process may open at most
MAX_FILE_SHARE = 0.25
MAX_REQUEST_SECONDS = 10.0  # [s] until a whole request is there
QUEUE_LENGTH = 256  # of commands, and of messages to one watcher
MESSAGE_BURST, MESSAGE_RATE = 240, 120  # of one watcher, at once and in a second
MAX_SEND_SECONDS = 30.0  # [s] for one message to a watcher, or for some progress with a file
REASON_BYTES = 120  # of the reason of a close; its frame holds 123
HISTORY_SECONDS, HISTORY_MOMENTS, HISTORY_BYTES = 60.0, 600, 48_000_000  # simulated [s], frames, bytes for a new page
HISTORY_GAP = 2.0  # simulated [s] without a frame, as at great pace without a page, over which nothing is kept
HELM_IDLE_SECONDS = 60.0  # [s] without a command, until another page may take the helm
SECURITY_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src 'self' data: blob:; "
    "connect-src 'self' {socket}; base-uri 'none'; form-action 'none'"
)
ANSWER_HEADERS = {
    "Cache-Control": "no-cache",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
}

File = Callable[[], bytes]  # the content of an address


class Order(NamedTuple):
    """Command from a page, with the number of the watcher (open page) that sent it."""

    watcher: int
    command: Command


class Watcher:
    """Open page: its number, its socket, and the texts and packets still to be sent to it."""

    def __init__(self, number: int, socket: "web.WebSocketResponse") -> None:
        self.number, self.socket = number, socket
        self.texts: deque[str] = deque(maxlen=QUEUE_LENGTH)
        self.still: bytes | None = None  # the last that was sent
        self.frame: bytes | None = None
        self.woken = asyncio.Event()
        self.allowance, self.asked = float(MESSAGE_BURST), monotonic()

    def may_ask(self) -> bool:
        """Count one more message from this page; True if it keeps within the allowed rate."""
        now = monotonic()
        self.allowance = min(MESSAGE_BURST, self.allowance + MESSAGE_RATE * (now - self.asked))
        self.asked = now
        self.allowance -= 1.0
        return self.allowance >= 0.0


def is_own_failure(record: logging.LogRecord) -> bool:
    """True for log records to keep: all but those of requests that are not HTTP. Filter of the web server's log."""
    from aiohttp.http_exceptions import HttpProcessingError

    return not (record.exc_info and isinstance(record.exc_info[1], HttpProcessingError))


class History:
    """Frames of the last HISTORY_SECONDS, for pages that open late. A page keeps its own frames by the same rule."""

    def __init__(self) -> None:
        self.frames: deque[tuple[float, bytes]] = deque()  # time [s] and packet
        self.interval = 0.0  # [s] between frames, at least

    def add(self, time: float, frame: bytes) -> None:
        """Keep a frame of a time [s]; drop every second one if they are too many or too large, and all before a gap."""
        if self.frames and time < self.frames[-1][0] + max(self.interval, 1e-6):
            return
        if self.frames and time > self.frames[-1][0] + max(3.0 * self.interval, HISTORY_GAP):
            self.frames.clear()
        self.frames.append((time, frame))
        while self.frames[0][0] < time - HISTORY_SECONDS:
            self.frames.popleft()
        if len(self.frames) > HISTORY_MOMENTS or sum(len(each) for _, each in self.frames) > HISTORY_BYTES:
            self.frames = deque([*self.frames][::-2][::-1])
            self.interval = (time - self.frames[0][0]) / len(self.frames)


class Connections:
    """Factory of network protocols (aiohttp), one per connection, that limits the number of open connections."""

    def __init__(self, protocols: "web.Server") -> None:
        self.protocols = protocols
        self.limit = max(1, min(MAX_CONNECTIONS, int(MAX_FILE_SHARE * resource_limit("RLIMIT_NOFILE"))))
        self.answering: set[Any] = set()  # with a whole request, and no answer yet
        self.progress: dict[Any, tuple[float, int]] = {}  # time of the last progress [s], and bytes to be sent

    def incomplete_transports(self) -> list[Any]:
        """Transports of the open connections without a whole request, the oldest first."""
        lines = [one.transport for one in self.protocols.connections if one not in self.answering]
        return [line for line in lines if line is not None and not line.is_closing()]

    def __call__(self) -> asyncio.BaseProtocol:
        """Protocol of a new connection. At the limit, one without a whole request is closed, or else the new one."""
        if len(self.protocols.connections) < self.limit:
            return self.protocols()
        if not (lines := self.incomplete_transports()):
            return Closing()
        min(lines, key=lambda line: line.get_write_buffer_size() > 0).abort()
        return self.protocols()

    async def close_slow(self) -> None:
        """Close connections that take too long over a request or an answer; runs as long as the server."""
        while True:
            await asyncio.sleep(0.1 * MAX_REQUEST_SECONDS)
            before, self.progress, now = self.progress, {}, monotonic()
            for line in self.incomplete_transports():
                unsent = line.get_write_buffer_size()
                since, then = before.get(line, (now, unsent))
                self.progress[line] = (since if unsent == then else now, unsent)
                if unsent == then and now - since > (MAX_SEND_SECONDS if unsent else MAX_REQUEST_SECONDS):
                    line.abort()


class Closing(asyncio.Protocol):
    """Protocol that closes a connection at once, since the limit of connections is reached."""

    def connection_made(self, transport: Any) -> None:
        transport.abort()


class Server(AbstractContextManager["Server"]):
    """Web server that shows a simulation on open pages and collects their commands; a context manager."""

    def __init__(
        self,
        files: Mapping[str, tuple[str, File]],
        host: str = "127.0.0.1",
        port: int | None = None,
        token: str = "",
        hello: Mapping[str, Any] | None = None,
        framed: bool = False,
    ) -> None:
        """`files`: content type and content by path; `host`: address to listen at; `port`, if None: DEFAULT_PORT or, if
        that is taken, any; `token`: secret of the address, or empty; `hello`: first message to a page; `framed`: other
        sites may frame it. Raises Lacking without aiohttp, Refused if the port is taken."""
        try:
            import aiohttp.web  # noqa: F401
        except ImportError:
            raise Lacking("the page needs aiohttp: pip install 'ocean-sim[browser]'") from None
        self.files, self.host, self.token, self.hello = files, host, token, dict(hello or {})
        self.policy, self.full = SECURITY_POLICY + ("" if framed else "; frame-ancestors 'none'"), False
        self.all: dict[int, Watcher] = {}
        self.inbox: deque[Order] = deque()
        self.arrived = threading.Event()  # a command, or a watcher
        self.fresh = True  # True: a watcher has had no frame yet
        self.watchers, self.helm, self.touched = 0, 0, 0.0
        self.still: bytes | None = None
        self.frame: bytes | None = None
        self.history = History()
        self.panel: dict[str, Any] = {}
        self.made: dict[str, asyncio.Future[bytes]] = {}  # contents by path, each built once
        self.count = self.refused = 0
        self.loop = asyncio.new_event_loop()
        self.ready, self.failure, self.port = threading.Event(), "", port
        self.thread = threading.Thread(target=self.run_loop, name="viewer", daemon=True)
        self.thread.start()
        self.ready.wait()
        if self.failure:
            self.thread.join()
            raise Refused(self.failure)

    @property
    def address(self) -> str:
        """URL of the page, with the token."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"http://{host}:{self.port}/" + (f"?token={self.token}" if self.token else "")

    # in the thread of the simulation

    def begin(self, still: bytes) -> None:
        """Send all pages the static part of a new simulation, a packet of kind `still`."""
        self.loop.call_soon_threadsafe(self.keep_packets, still, None, 0.0)

    def show(self, frame: bytes, time: float) -> None:
        """Send all pages a packet of kind `frame` of a time [s]; it replaces one that a page has not yet received."""
        self.fresh = False
        self.loop.call_soon_threadsafe(self.keep_packets, None, frame, time)

    def tell(self, watcher: int | None, **message: Any) -> None:
        """Send a text message (`type` and its fields) to page number `watcher`, or all (None)."""
        self.loop.call_soon_threadsafe(self.queue_text, watcher, message)

    def orders(self) -> list[Order]:
        """Take the commands that have arrived since the last call out of the inbox, and return them."""
        return [self.inbox.popleft() for _ in range(len(self.inbox))]

    def close(self) -> None:
        if self.thread.is_alive():
            with suppress(RuntimeError):
                self.loop.call_soon_threadsafe(self.stopping.set)
            self.thread.join(5.0)

    def __exit__(self, *failure: object) -> None:
        self.close()

    # in its own thread

    def run_loop(self) -> None:
        """Serve pages until the server is stopped; main function of the server's thread."""
        try:
            with asyncio.Runner(loop_factory=lambda: self.loop) as runner:
                runner.run(self.serve())
        finally:
            self.ready.set()

    async def serve(self) -> None:
        """Serve pages at the port until `stopping` is set, then close them; sets `failure` if the port is taken."""
        from aiohttp import web

        self.stopping = asyncio.Event()

        @web.middleware
        async def guard(request: web.Request, handler: Any) -> Any:
            return await self.guard_request(request, handler)

        async def protect(request: web.Request, response: web.StreamResponse) -> None:
            """Add security headers to a response; called before each one is sent."""
            response.headers.update(ANSWER_HEADERS)
            response.headers["Content-Security-Policy"] = self.policy.format(socket=f"ws://{request.host}")

        app = web.Application(middlewares=[guard])
        app.on_response_prepare.append(protect)
        app.router.add_get("/watch", self.serve_socket)
        app.router.add_get("/past", self.serve_past)
        for path in self.files:
            app.router.add_get(path, self.serve_file)
        self.log = logging.getLogger("aiohttp.server.ocean_sim")
        self.log.addFilter(is_own_failure)
        self.loop.set_exception_handler(self.handle_loop_failure)
        runner = web.AppRunner(app, access_log=None, logger=self.log, shutdown_timeout=1.0)
        await runner.setup()
        assert runner.server is not None
        self.connections = Connections(runner.server)
        async with AsyncExitStack() as last:
            last.push_async_callback(runner.cleanup)
            for port in [self.port] if self.port is not None else [DEFAULT_PORT, 0]:
                try:
                    most = max(1, self.connections.limit // 8)  # accepted at once, before any is closed
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
                    own.listen(self.connections.limit)  # that many wait to be accepted
            self.port, self.failure = line.sockets[0].getsockname()[1], ""
            self.ready.set()
            last.callback(asyncio.create_task(self.connections.close_slow()).cancel)
            await self.stopping.wait()
            for watcher in [*self.all.values()]:
                with suppress(Exception):
                    await watcher.socket.close(code=1001, message=b"the server has stopped")

    def handle_loop_failure(self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Failure handler: log once that too many files are open, as asyncio tries again; leave the rest to asyncio."""
        failure = context.get("exception")
        if not (isinstance(failure, OSError) and failure.errno in (errno.EMFILE, errno.ENFILE)):
            loop.default_exception_handler(context)
        elif not self.full:
            self.full = True
            self.log.error(f"{failure.strerror}: new pages wait until others are closed; raise `ulimit -n`")

    async def guard_request(self, request: "web.Request", handler: Any) -> Any:
        """Refuse a request without the token, or, if the server has no token, from another site or for another host."""
        from aiohttp import web

        if self.token:
            if not hmac.compare_digest(request.query.get("token", "").encode(), self.token.encode()):
                raise web.HTTPForbidden(text="This address needs the token that the server printed.\n")
        else:
            name = request.host.rsplit(":", 1)[0].strip("[]")
            origin = request.headers.get("Origin")
            if name not in LOCAL_HOSTS or origin not in (None, f"{request.scheme}://{request.host}"):
                raise web.HTTPForbidden(text="This server answers only pages of its own, on this machine.\n")
        self.connections.answering.add(request.protocol)
        try:
            return await handler(request)
        finally:
            self.connections.answering.discard(request.protocol)

    async def serve_file(self, request: "web.Request") -> Any:
        """Response with the content of a path in `files`, computed once; 404 if computing it raises Failed."""
        from aiohttp import web

        kind, content = self.files[request.path]
        try:
            if request.path not in self.made:
                self.made[request.path] = asyncio.get_running_loop().run_in_executor(None, content)
            body = await asyncio.shield(self.made[request.path])
        except Exception as error:  # the next request tries again
            self.made.pop(request.path, None)
            raise (web.HTTPNotFound(text=error.sentence) if isinstance(error, Failed) else error) from None
        return web.Response(body=body, headers={"Content-Type": kind})

    async def serve_past(self, request: "web.Request") -> Any:
        """Response with the frames of the last minute, one after the other, for a page that opens late."""
        from aiohttp import web

        return web.Response(body=b"".join(frame for _, frame in self.history.frames))

    async def serve_socket(self, request: "web.Request") -> Any:
        """Exchange messages with one page until its socket closes."""
        from aiohttp import WSMsgType, web

        if len(self.all) >= MAX_WATCHERS:
            raise web.HTTPServiceUnavailable(text="too many watchers\n")
        socket = web.WebSocketResponse(max_msg_size=protocol.MAX_MESSAGE_BYTES, heartbeat=15.0, compress=False)
        await socket.prepare(request)
        if not self.all and self.hello.get("drives"):
            self.frame = None  # it is old; a new one comes
        self.count += 1
        watcher = self.all[self.count] = Watcher(self.count, socket)
        self.watchers, self.fresh = len(self.all), True
        self.arrived.set()
        hello = {"type": "hello", "protocol": protocol.PROTOCOL_VERSION, "you": watcher.number}
        self.queue_text(watcher.number, hello | self.hello)
        if self.panel:
            self.queue_text(watcher.number, self.panel)
        self.tell_helm()
        sending, why = asyncio.create_task(self.send_to(watcher)), ""
        try:
            async for message in socket:
                if message.type != WSMsgType.TEXT:
                    break
                self.receive(watcher, message.data)
        except BadMessage as error:
            self.refused += 1
            why = error.sentence
        finally:
            sending.cancel()
            del self.all[watcher.number]
            self.watchers = len(self.all)
            if self.helm == watcher.number:
                self.helm = 0
            self.tell_helm()
            with suppress(Exception):
                code = 1008 if socket.close_code is None else 1000
                await socket.close(code=code, message=why.encode("ascii", "replace")[:REASON_BYTES])
        return socket

    def receive(self, watcher: Watcher, text: str) -> None:
        """Handle a page's JSON `text`: pass the helm (right to command) or queue it. BadMessage ends the connection."""
        if not watcher.may_ask():
            raise BadMessage("too many messages")
        order = parse_command(text)
        if order.do == "take":
            self.take_helm(watcher.number)
        elif order.do == "leave":
            self.helm = 0 if self.helm == watcher.number else self.helm
            self.tell_helm()
        elif order.do not in protocol.QUERY_NAMES and not self.take_helm(watcher.number):
            self.refuse_command(watcher, "The helm is at another page.")
        elif len(self.inbox) >= QUEUE_LENGTH:
            self.refuse_command(watcher, "The simulation is busy; your command was not taken.")
        else:
            self.inbox.append(Order(watcher.number, order))
            self.arrived.set()

    def refuse_command(self, watcher: Watcher, text: str) -> None:
        self.queue_text(watcher.number, {"type": "said", "text": text, "bad": True})

    def take_helm(self, number: int) -> bool:
        """Give page `number` the helm (right to command) if it is free or its holder is idle; True if it has it now."""
        now = monotonic()
        if self.helm in (0, number) or now - self.touched > HELM_IDLE_SECONDS:
            before, self.helm, self.touched = self.helm, number, now
            if before != number:
                self.tell_helm()
        return self.helm == number

    def tell_helm(self) -> None:
        """Tell all pages which page, by number, has the helm, the right to command the simulation."""
        self.queue_text(None, {"type": "helm", "holder": self.helm, "watchers": len(self.all)})

    def queue_text(self, number: int | None, message: dict[str, Any]) -> None:
        """Queue a message for page `number`, or all (None); keep the last `panel` (settings) for new pages."""
        if message.get("type") == "panel" and number is None:
            self.panel = message
        text = json.dumps(message, allow_nan=False, default=str)
        for watcher in self.all.values() if number is None else filter(None, [self.all.get(number)]):
            watcher.texts.append(text)
            watcher.woken.set()

    def keep_packets(self, still: bytes | None, frame: bytes | None, time: float) -> None:
        """Store the newest frame for all pages, or a new static part (`still`), which discards the frames before it."""
        self.still, self.frame = still or self.still, frame
        if frame is None:
            self.history = History()
        else:
            self.history.add(time, frame)
        for watcher in self.all.values():
            watcher.woken.set()

    async def send_to(self, watcher: Watcher) -> None:
        """Send a page its new texts and packets as fast as it accepts them; close its socket if it stops accepting."""
        watcher.woken.set()
        with suppress(ConnectionError, TimeoutError):
            while True:
                await watcher.woken.wait()
                watcher.woken.clear()
                while watcher.texts:
                    await asyncio.wait_for(watcher.socket.send_str(watcher.texts.popleft()), MAX_SEND_SECONDS)
                if self.still is not None and watcher.still is not self.still:
                    watcher.still = self.still
                    await asyncio.wait_for(watcher.socket.send_bytes(self.still), MAX_SEND_SECONDS)
                frame = self.frame
                if frame is not None and watcher.frame is not frame and watcher.still is self.still:
                    watcher.frame = frame
                    await asyncio.wait_for(watcher.socket.send_bytes(frame), MAX_SEND_SECONDS)
        with suppress(Exception):
            await watcher.socket.close(code=1008)

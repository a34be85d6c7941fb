"""The server: who may come in, who has the helm, what is refused, and that a slow watcher holds up nobody."""

import asyncio
import json
import os
import subprocess
import sys
import time
import urllib.request
from contextlib import contextmanager, suppress
from itertools import pairwise
from socket import SO_RCVBUF, SOL_SOCKET, create_connection, socket

import pytest

aiohttp = pytest.importorskip("aiohttp", reason="the page needs aiohttp: pip install '.[browser]'")

from ocean_sim.conventions import Refused  # noqa: E402
from ocean_sim.viewer.protocol import BadMessage, packet, parse_command  # noqa: E402
from ocean_sim.viewer.server import Server  # noqa: E402
from tests.conftest import quickly  # noqa: E402

FILES = {"/": ("text/html; charset=utf-8", lambda: b"<!doctype html>")}


@pytest.fixture
def server():
    with Server(FILES, port=0, hello={"drives": True}) as one:
        yield one


def talk(server, conversation, **more):
    """What a conversation returns that is held in a session."""

    async def held():
        async with aiohttp.ClientSession() as session:
            return await asyncio.wait_for(conversation(session, server.address.split("?")[0]), 30.0)

    return asyncio.run(held())


async def until(socket, kind):
    """The first text of a type."""
    while True:
        message = await socket.receive(10.0)
        assert message.type in (aiohttp.WSMsgType.TEXT, aiohttp.WSMsgType.BINARY), message
        if message.type == aiohttp.WSMsgType.TEXT and json.loads(message.data)["type"] == kind:
            return json.loads(message.data)


def test_a_watcher_is_greeted_and_given_what_is_shown(server):
    server.begin(packet("still", {}))
    server.tell(None, type="panel", paused=True)

    async def conversation(session, address):
        async with session.ws_connect(f"{address}watch") as socket:
            hello, panel = await until(socket, "hello"), await until(socket, "panel")
            while (message := await socket.receive(10.0)).type != aiohttp.WSMsgType.BINARY:
                pass
            return hello, panel, message.data

    hello, panel, still = talk(server, conversation)
    assert hello["protocol"] == 1 and hello["drives"] and panel["paused"] and still == packet("still", {})
    assert server.arrived.is_set()


def test_a_page_that_opens_late_finds_the_last_minute_and_nothing_of_the_scene_before(server):
    """At most so many frames and bytes, from the newest back to a minute before it [s], and evenly spread."""

    async def past(session, address):
        async with session.get(f"{address}past") as reply:
            return await reply.read()

    def times(size):
        data = talk(server, past)
        return [0.05 * int.from_bytes(data[k : k + 4], "little") for k in range(0, len(data), size)]

    for size, fewest in ((4, 300), (400_000, 60)):
        server.begin(packet("still", {}))
        assert times(size) == []
        for k in range(3000):
            server.show(k.to_bytes(4, "little") + bytes(size - 4), 0.05 * k)
        found = times(size)
        assert fewest <= len(found) <= 600 and len(found) * size <= 48e6
        assert 149.0 < found[-1] < 150.0 and 58.0 < found[-1] - found[0] <= 60.0
        assert max(b - a for a, b in pairwise(found)) < 1.5
        server.show((3200).to_bytes(4, "little") + bytes(size - 4), 160.0)  # after 10 s that no page saw
        assert times(size) == [160.0]


@pytest.mark.parametrize("bad", ["{", b"\0\1\2", '{"do": "fly"}', "x" * 300_000])
def test_garbage_ends_the_connection_and_nothing_else(server, bad):
    async def conversation(session, address):
        async with session.ws_connect(f"{address}watch") as other, session.ws_connect(f"{address}watch") as socket:
            await (socket.send_bytes(bad) if isinstance(bad, bytes) else socket.send_str(bad))
            while (message := await socket.receive(10.0)).type in (aiohttp.WSMsgType.TEXT, aiohttp.WSMsgType.BINARY):
                pass
            assert message.type in (aiohttp.WSMsgType.CLOSE, aiohttp.WSMsgType.CLOSED, aiohttp.WSMsgType.CLOSING)
            if bad[:1] == "{":
                assert "this is not a command" in message.extra
            await other.send_str('{"do": "play"}')
            await until(other, "helm")
            while not server.inbox:
                await asyncio.sleep(0.01)

    talk(server, conversation)
    assert [order.command.do for order in server.orders()] == ["play"]


@pytest.mark.parametrize(
    "bad",
    [
        b"GARBAGE\r\n\r\n",
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n",
        b"GET / HTTP/9.9\r\nHost: 127.0.0.1\r\n\r\n",
        b"GET /" + b"x" * 20_000 + b" HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: chunked\r\n\r\nxyz\r\n",
    ],
)
def test_what_is_no_http_is_answered_and_prints_nothing(server, bad, caplog, capfd):
    with create_connection(("127.0.0.1", server.port), timeout=10.0) as line:
        line.sendall(bad)
        assert line.recv(4096).startswith(b"HTTP/1.")
    assert caplog.records == [] and capfd.readouterr() == ("", "")


def test_a_flood_is_cut_off_and_the_inbox_stays_bounded(server):
    async def conversation(session, address):
        async with session.ws_connect(f"{address}watch") as socket:
            sent = 0
            while sent < 5000 and not socket.closed:
                try:
                    await socket.send_str('{"do": "pause"}')
                except ConnectionError:
                    break
                sent += 1
                if sent % 100 == 0:
                    await asyncio.sleep(0)
            while (await socket.receive(10.0)).type in (aiohttp.WSMsgType.TEXT, aiohttp.WSMsgType.BINARY):
                pass
            return socket.close_code

    assert talk(server, conversation) == 1008
    assert len(server.inbox) <= 256


def test_one_has_the_helm_until_it_leaves(server):
    async def conversation(session, address):
        async with session.ws_connect(f"{address}watch") as first, session.ws_connect(f"{address}watch") as second:
            me, you = (await until(first, "hello"))["you"], (await until(second, "hello"))["you"]
            await first.send_str('{"do": "take"}')
            while (await until(second, "helm"))["holder"] != me:
                pass
            await second.send_str('{"do": "reset"}')
            assert "helm" in (await until(second, "said"))["text"]
            await first.close()
            while (await until(second, "helm"))["holder"] != 0:
                pass
            await second.send_str('{"do": "reset"}')
            while (await until(second, "helm"))["holder"] != you:
                pass

    talk(server, conversation)
    assert [order.command.do for order in server.orders()] == ["reset"]


def test_twenty_watchers_with_a_slow_one_among_them_lose_nothing(server):
    """Frames of 200 kB fill what the network holds for the one that does not read; the newest reaches it in the end."""
    count, worst = 40, 0.0

    async def newest(socket):
        while (message := await socket.receive(10.0)).type != aiohttp.WSMsgType.BINARY or len(message.data) < 100_000:
            pass
        return int.from_bytes(message.data[:4], "little")

    async def conversation(session, address):
        nonlocal worst
        slow, *quick = [await session.ws_connect(f"{address}watch", max_msg_size=0) for _ in range(20)]
        server.begin(packet("still", {}))
        seen = []
        for k in range(count):
            entered = time.perf_counter()
            server.show(k.to_bytes(4, "little") + bytes(200_000), 0.05 * k)
            worst = max(worst, time.perf_counter() - entered)
            seen.append(await asyncio.gather(*map(newest, quick)))
        late = [await newest(slow)]
        while late[-1] != count - 1:
            late.append(await newest(slow))
        for one in (slow, *quick):
            await one.close()
        return seen, late

    seen, late = talk(server, conversation)
    assert seen == [[k] * 19 for k in range(count)]
    assert late == sorted(late) and len(late) < count
    assert worst < 0.5  # [s] whoever simulates only hands a frame over


def test_pages_of_others_are_refused(server):
    async def conversation(session, address):
        found = []
        for head in ({"Origin": "http://evil.example"}, {"Host": "evil.example"}, {}):
            async with session.get(address, headers=head) as reply:
                found.append(reply.status)
        return found

    assert talk(server, conversation) == [403, 403, 200]


def test_beyond_this_machine_an_address_needs_its_token():
    with Server(FILES, host="0.0.0.0", port=0, token="secret") as server:
        assert server.address.endswith("?token=secret")
        server.host = "127.0.0.1"  # where this test can reach it

        async def conversation(session, address):
            found = []
            for end in ("", "?token=wrong", "?token=secret", "watch", "watch?token=secrets"):
                async with session.get(address + end) as reply:
                    found.append(reply.status)
            return found

        assert talk(server, conversation) == [403, 403, 200, 403, 403]


def test_a_port_that_is_taken_is_named(server):
    with pytest.raises(Refused, match=f"--port {server.port}"):
        Server(FILES, port=server.port)


def test_a_question_about_the_water_takes_no_helm_and_its_answer_goes_to_who_asked(server):
    async def conversation(session, address):
        async with session.ws_connect(f"{address}watch") as other, session.ws_connect(f"{address}watch") as socket:
            hello = await until(socket, "hello")
            question = {"do": "waves", "verb": "velocity", "id": 5, "points": [[1.0, -2.0, 3.0]]}
            await socket.send_str(json.dumps(question))
            while not (orders := server.orders()):
                await asyncio.sleep(0.01)
            server.tell(orders[0].watcher, type="waves", id=5, values=[[0.0, 0.0, 0.0]])
            found = await until(socket, "waves")
            server.tell(None, type="said", text="end", bad=False)
            while (message := await until(other, "said"))["type"] == "waves":
                pass
            return hello, orders, found, message

    hello, orders, found, message = talk(server, conversation)
    assert [order.watcher for order in orders] == [hello["you"]] and orders[0].command.points == [(1.0, -2.0, 3.0)]
    assert found["id"] == 5 and message["text"] == "end" and server.helm == 0


BEYOND = [
    {"points": [[0.0] * 2] * 5000},
    {"points": [[1.0]]},
    {"points": [[1e300, 0.0]]},
    {"cells": 1000},
    {"side": 0.0},
]


@pytest.mark.parametrize("more", BEYOND)
def test_questions_have_bounds(more):
    with pytest.raises(BadMessage):
        parse_command(json.dumps({"do": "waves", "verb": "elevation", **more}))


HALF_OPEN = """
import resource, socket, sys, time
hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, 4096) if hard > 0 else 4096, hard))
lines = []
for k in range(int(sys.argv[2])):
    line = socket.create_connection(("127.0.0.1", int(sys.argv[1])), 20.0)
    line.sendall(b"GET / HTTP/1.1\\r\\nX: ")
    lines.append(line)
print(len(lines), flush=True)
sys.stdin.read()
"""


@contextmanager
def half_open(port, count):
    """Connections of another process without a whole request, held until the block is left."""
    command = [sys.executable, "-c", HALF_OPEN, str(port), str(count)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as child:
        try:
            assert child.stdout.readline() == f"{count}\n"
            yield
        finally:
            child.stdin.close()


@pytest.mark.skipif(sys.platform != "linux", reason="files that are open are counted as Linux tells them")
@pytest.mark.parametrize("count", quickly(500, 2000))
def test_a_page_still_gets_in_beside_many_half_open_connections(server, count, caplog, capfd):
    """And one that watched before goes on."""

    async def watching(session, address):
        async with session.ws_connect(f"{address}watch") as socket:
            await until(socket, "hello")
            with half_open(server.port, count):
                files = len(os.listdir("/proc/self/fd"))
                with urllib.request.urlopen(server.address, timeout=10.0) as reply:
                    assert reply.status == 200
                server.tell(None, type="said", text="here", bad=False)
                return files, (await until(socket, "said"))["text"]

    files = len(os.listdir("/proc/self/fd"))
    more, said = talk(server, watching)
    assert said == "here" and more - files < 400
    assert caplog.records == [] and capfd.readouterr() == ("", "")


def test_who_sends_no_whole_request_or_takes_no_answer_is_closed_in_time(monkeypatch):
    """Silent, a letter now and then, idle after an answer, and one that takes no answer; not one who watches."""
    monkeypatch.setattr("ocean_sim.viewer.server.MAX_REQUEST_SECONDS", 0.5)
    monkeypatch.setattr("ocean_sim.viewer.server.MAX_SEND_SECONDS", 0.5)
    files = {**FILES, "/long": ("text/plain", lambda: bytes(30_000_000))}
    with Server(files, port=0) as server:

        async def conversation(session, address):
            async with session.ws_connect(f"{address}watch") as socket:
                lines = [create_connection(("127.0.0.1", server.port), timeout=10.0) for _ in range(4)]
                request = f" HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n\r\n".encode()
                lines[1].sendall(b"GET / HTTP/1.1\r\nX: ")
                lines[2].sendall(b"GET /" + request)
                lines[3].sendall(b"GET /long" + request)
                for _ in range(15):
                    await asyncio.sleep(0.1)
                    with suppress(OSError):
                        lines[1].sendall(b"x")
                with pytest.raises(OSError):
                    for _ in range(3):
                        lines[1].sendall(b"x")
                        await asyncio.sleep(0.1)
                ended = []
                for line in (lines[0], lines[2], lines[3]):
                    with suppress(ConnectionError):
                        while data := line.recv(1 << 20):
                            ended.append(len(data))
                    line.close()
                lines[1].close()
                server.tell(None, type="said", text="here", bad=False)
                return sum(ended), (await until(socket, "said"))["text"]

        taken, said = talk(server, conversation)
        assert taken < 30_000_000 and said == "here"


def test_a_slow_reader_gets_all_of_a_long_answer(monkeypatch):
    monkeypatch.setattr("ocean_sim.viewer.server.MAX_REQUEST_SECONDS", 0.5)
    size = 12_000_000
    with Server({"/": ("text/plain", lambda: bytes(size))}, port=0) as server:
        line = socket()
        line.setsockopt(SOL_SOCKET, SO_RCVBUF, 65536)
        line.connect(("127.0.0.1", server.port))
        line.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n" % server.port)
        taken, begin = 0, time.monotonic()
        while taken < size:
            data = line.recv(600_000)
            assert data, taken
            taken += len(data)
            if time.monotonic() - begin < 2.0:
                time.sleep(0.1)
        line.close()
        assert time.monotonic() - begin > 1.5


FEW_FILES = """
import os, resource, sys, time
from socket import create_connection
from ocean_sim.viewer.server import Server
with Server({"/": ("text/html", lambda: b"here")}, port=0) as server:
    resource.setrlimit(resource.RLIMIT_NOFILE, (len(os.listdir("/proc/self/fd")) + 12, 4096))
    held = [open(os.devnull) for _ in range(12)]
    time.sleep(0.1)
    child = os.fork()
    if child == 0:
        for file in held:
            file.close()
        lines = [create_connection(("127.0.0.1", server.port)) for _ in range(5)]
        time.sleep(4.0)
        os._exit(0)
    os.waitpid(child, 0)
    for file in held:
        file.close()
    time.sleep(1.5)
    with create_connection(("127.0.0.1", server.port), 10.0) as line:
        line.sendall(b"GET / HTTP/1.0\\r\\nHost: 127.0.0.1:%d\\r\\n\\r\\n" % server.port)
        print(line.recv(4096).split()[1].decode())
"""


@pytest.mark.skipif(sys.platform != "linux", reason="files that are open are counted as Linux tells them")
def test_that_no_more_files_can_be_opened_is_said_once():
    done = subprocess.run([sys.executable, "-c", FEW_FILES], capture_output=True, text=True, timeout=60.0)
    assert done.stdout == "200\n" and done.returncode == 0, done.stderr
    assert done.stderr.count("Too many open files") == 1 and "Traceback" not in done.stderr, done.stderr


@pytest.mark.parametrize(("origin", "answer"), [("http://", 200), ("https://", 403), ("ws://", 403), ("", 403)])
def test_an_origin_counts_with_its_scheme(server, origin, answer):
    async def conversation(session, address):
        async with session.get(address, headers={"Origin": f"{origin}127.0.0.1:{server.port}"}) as reply:
            return reply.status

    assert talk(server, conversation) == answer


@pytest.mark.parametrize("path", ["", "nothing", "watch"])
def test_every_answer_keeps_to_its_own_site(server, path):
    """A page, an error, and an address that is no page."""

    async def conversation(session, address):
        async with session.get(address + path) as reply:
            return reply.headers

    head = talk(server, conversation)
    assert "frame-ancestors 'none'" in head["Content-Security-Policy"]
    assert head["Cross-Origin-Resource-Policy"] == "same-origin" and head["X-Content-Type-Options"] == "nosniff"
    assert head["Referrer-Policy"] == "no-referrer"

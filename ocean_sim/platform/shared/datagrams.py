"""Poses of a platform as datagrams: a sender that keeps time, a receiver without jumps, and what it reports back.

`python -m ocean_sim.platform.shared.datagrams udp://127.0.0.1:5005` receives packets, reports where the legs are to
where they come from, and prints what comes; a further word names the file of a key. With `stop` in front of the
address it stops the platform that listens there.
"""

import socket
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from select import select
from typing import NamedTuple
from urllib.parse import urlsplit

import numpy as np

from ocean_sim.files import input_file
from ocean_sim.parts import preset
from ocean_sim.platform.shared.kinematics import Geometry, Hexapod, smoothly
from ocean_sim.platform.shared.limits import EVERY, Drive, Judge
from ocean_sim.platform.shared.packets import (
    Packet,
    Reading,
    along_flu,
    halt,
    halts,
    packed,
    reading,
    reported,
    signed,
    unpacked,
    verified,
)

LEAST_KEY, MOST_KEY = 16, 4096  # bytes
LOOPBACK = "127.0.0.1"
BRAKE = 0.15  # [s] in which a platform that is stopped loses its speed
USAGE = """usage: python -m ocean_sim.platform.shared.datagrams [udp://127.0.0.1:5005] [KEYFILE]
       python -m ocean_sim.platform.shared.datagrams stop udp://127.0.0.1:5005 [KEYFILE]
The first receives packets, prints what comes, and reports where the legs are; the second stops that platform."""
SPIN = 0.0005  # [s] before its time for which a packet is waited for without sleeping
KEY = input_file.Rule(f"a key has {LEAST_KEY} to {MOST_KEY} bytes")
CHECKS = (input_file.Checked("A key, `stream.key`", (KEY,)),)


def key_in(file: str) -> bytes:
    """The key in a file, which sender and receiver share; raises Unreadable, a ValueError."""
    key = input_file.read_bytes(file, MOST_KEY).strip()
    if len(key) < LEAST_KEY:
        raise KEY.broken(file, f"it has {len(key)} bytes")
    return key


def address(url: str) -> tuple[str, int]:
    """Host and port of `udp://127.0.0.1:5005`; without a host it is this machine. Raises ValueError."""
    try:
        parts = urlsplit(url if "//" in url else f"//{url}", scheme="udp")
        host, port = parts.hostname or LOOPBACK, parts.port
    except ValueError:
        host, port, parts = LOOPBACK, None, None
    if parts is None or parts.scheme != "udp" or not port or parts.path not in ("", "/"):
        raise ValueError(f"{url!r} is not like udp://{LOOPBACK}:5005")
    return host, port


class Jitter(NamedTuple):
    """How evenly packets went out."""

    packets: int
    interval: float  # mean time from packet to packet [s]
    deviation: float  # its standard deviation [s]
    longest: float  # [s]
    late: float  # part of the packets that came more than two intervals after the one before

    def __str__(self) -> str:
        ms = [f"{1e3 * value:.3f} ms" for value in (self.interval, self.deviation, self.longest)]
        return (
            f"{self.packets} packets, every {ms[0]}, deviation {ms[1]}, longest {ms[2]}, {100 * self.late:.2g} % late"
        )


class Latency(NamedTuple):
    """The way of packets to a platform and of its reports back."""

    packets: int
    median: float  # [s]
    most: float  # of 99 % of them [s]
    longest: float  # [s]

    def __str__(self) -> str:
        ms = [f"{1e3 * value:.3f} ms" for value in (self.median, self.most, self.longest)]
        return f"there and back: median {ms[0]}, 99 % within {ms[1]}, longest {ms[2]}, of {self.packets} packets"


class Sender:
    """Sends rows at the pace of their own time, with a key signed. Raises ValueError where the address is malformed or
    the layout has no place for a signature, OSError where the host is unknown.

    A row that comes too late is sent at once and the clock is set by it: what follows keeps its pace, there is no
    burst.
    """

    left_out = ("socket", "start", "sent", "due", "left", "readings", "key", "began")  # by a checkpoint

    def __init__(self, url: str, layout: str = "ocean_sim", key: bytes = b"") -> None:
        if key and layout != "ocean_sim":
            raise ValueError(f"packets of {layout} have no place for a signature; take ocean_sim")
        self.address, self.layout = address(url), layout
        self.key, self.began = key, time.time_ns()
        try:
            kind = socket.getaddrinfo(*self.address, type=socket.SOCK_DGRAM)[0][0]
        except OSError as error:
            raise OSError(error.errno, error.strerror or str(error), url) from None
        self.socket = socket.socket(kind, socket.SOCK_DGRAM)
        self.start: float | None = None  # what the clock shows at time 0 of the rows [s]
        self.sent: list[float] = []  # [s]
        self.due: list[float] = []  # times of the rows [s]
        self.left: dict[int, float] = {}  # when each packet was sent [s], by its number
        self.readings: list[tuple[float, Reading]] = []  # what the platform reports, and when it came [s]

    def send(self, packet: Packet) -> None:
        """Wait until it is time, taking reports as they come, then send."""
        data, now = packed(packet, self.layout), time.perf_counter()
        data = signed(data, self.key, self.began) if self.key else data
        if self.start is None or now > self.start + packet.time:
            self.start = now - packet.time
        while (left := self.start + packet.time - time.perf_counter()) > 0.0:
            if left > SPIN and select([self.socket], [], [], left - SPIN)[0]:
                self.listen()
        self.socket.sendto(data, self.address)
        self.sent.append(time.perf_counter())
        self.due.append(packet.time)
        self.left[packet.seq] = self.sent[-1]
        self.listen()

    def listen(self) -> None:
        """Take what the platform has reported, if it does."""
        while True:
            try:
                data = self.socket.recv(2048, socket.MSG_DONTWAIT)
            except OSError:  # nothing has come, or nobody listens there
                return
            with suppress(ValueError):
                self.readings.append((time.perf_counter(), reading(data)))

    def latency(self) -> "Latency | None":
        """From sending a packet to the report that it counted; None where nothing reports."""
        first: dict[int, float] = {}
        for came, found in self.readings:
            first.setdefault(found.seq, came)
        ways = [came - self.left[seq] for seq, came in first.items() if seq in self.left]
        if not ways:
            return None
        median, most = np.percentile(ways, [50.0, 99.0]).tolist()
        return Latency(len(ways), median, most, max(ways))

    def stopped(self) -> str:
        """What the platform says of a stop, in words; empty where it was not stopped."""
        came = next((came for came, found in self.readings if found.stopped), None)
        return "" if came is None else f"the platform was stopped, {came - self.sent[0]:.2f} s after the first packet"

    def jitter(self) -> Jitter:
        """How evenly the packets went out so far."""
        gaps, wanted = np.diff(self.sent), np.diff(self.due)
        if not len(gaps):
            return Jitter(len(self.sent), 0.0, 0.0, 0.0, 0.0)
        late = float((gaps > 2.0 * wanted).mean())
        return Jitter(len(self.sent), float(gaps.mean()), float(gaps.std()), float(gaps.max()), late)

    def close(self) -> None:
        self.socket.close()


class Smooth:
    """The pose that a platform is driven to by packets that come as they come.

    It lies on the line between the last two packets, one interval behind. Without packets it is held, and when
    they begin or return it moves over to them within `ramp` [s], also to those of a new stream. After `home` [s]
    without packets it moves back to neutral. Packets that are out of order are dropped and counted.
    """

    def __init__(self, hold: float = 0.1, ramp: float = 3.0, home: float = np.inf) -> None:
        self.hold, self.ramp, self.home = hold, ramp, home
        self.last: Packet | None = None
        self.line: list[tuple[float, np.ndarray]] = []  # the last two poses, and when they came [s]
        self.returned, self.held = -np.inf, np.zeros(6)  # when packets came back [s], and the pose until then
        self.came = self.lost = self.reordered = self.stalls = self.strange = 0
        self.glide: tuple[float, np.ndarray, np.ndarray] | None = None  # since when, from which pose, how fast

    def stop(self, now: float) -> None:
        """Glide to rest from where it is at `now` [s], and stay there."""
        if self.glide is None:
            pose = self.pose(now)
            self.glide = now, pose, (pose - self.pose(now - EVERY)) / EVERY

    def silence(self, now: float) -> float:
        """Time since the last packet [s]."""
        return now - self.line[-1][0] if self.line else np.inf

    def take(self, packet: Packet, now: float) -> None:
        """A packet that came at `now` [s]."""
        self.came += 1
        if self.last is None:
            self.returned = now
        else:
            silent, ahead = self.silence(now) > self.hold, packet.seq - self.last.seq
            if ahead <= 0 and not silent:
                self.reordered += 1
                return
            self.lost += max(0, ahead - 1)
            if silent:
                self.held, self.returned, self.line = self.pose(now), now, []
                self.stalls += 1
        self.last = packet
        self.line = [*self.line[-1:], (now, np.array(packet.pose))]

    def pose(self, now: float) -> np.ndarray:
        """(6,) x, y, z [m], roll, pitch, yaw [rad] at `now` [s]."""
        if self.glide is not None and now >= self.glide[0]:
            since, pose, speed = self.glide
            return pose + speed * BRAKE * (1.0 - np.exp((since - now) / BRAKE))
        if not self.line:
            return self.held
        (first, before), (second, after) = self.line[0], self.line[-1]
        part = min(1.0, (now - second) / (second - first)) if second > first else 1.0
        pose = before + part * (after - before)
        pose = self.held + smoothly(np.clip((now - self.returned) / self.ramp, 0.0, 1.0)) * (pose - self.held)
        return pose * (1.0 - smoothly(np.clip((self.silence(now) - self.home) / self.ramp, 0.0, 1.0)))


class Receiver(Smooth):
    """The pose, and the legs, of a platform that trusts no network.

    A packet counts where it is whole and finite, from the source that the stream began with, newer than the one before,
    and a pose to which the legs can have come since; with a `key`, also signed, and of no stream older than one seen.
    One that stops the platform counts from anywhere, with a key if it is signed. All else is counted and dropped. In
    silence the platform brakes and holds its pose, then it goes home, and only there a stream may come from elsewhere.
    The legs keep their limits whatever comes.
    """

    def __init__(
        self, geometry: Geometry, key: bytes = b"", hold: float = 0.1, ramp: float = 3.0, home: float = 2.0
    ) -> None:
        super().__init__(hold, ramp, home)
        hexapod = Hexapod(geometry)
        self.judge, self.drive = Judge(geometry, hexapod, hold), Drive(geometry, hexapod)
        self.key, self.began = key, 0  # when the stream began [ns], by its signature
        self.source: object = None
        self.foreign = self.implausible = 0

    def hear(self, data: bytes, source: object, now: float) -> Packet | None:
        """The packet in what came from a source at `now` [s], or None where it does not count."""
        if halts(data, self.key):
            self.stop(now)
            return None
        if self.glide is not None:
            return None
        try:
            inner, began = verified(data, self.key) if self.key else (data, 0)
            packet = unpacked(inner)
        except ValueError:
            self.strange += 1
            return None
        if self.source not in (None, source) and self.silence(now) < self.home + self.ramp:
            self.foreign += 1
            return None
        silent, pose = self.silence(now) > self.hold, along_flu(packet)
        old = self.last is not None and packet.seq <= self.last.seq
        again = began < self.began or (old and began == self.began)
        if self.key and (again or (began > self.began and not silent)):
            self.reordered += 1  # a signed stream goes on, or gives way to a later one; none is played again
            return None
        if (silent or not old) and not self.judge.passes(pose, packet.time, now, silent):
            self.implausible += 1
            return None
        self.source, self.began = source, began
        self.take(packet._replace(pose=tuple(pose)), now)
        return packet

    def advance(self, now: float) -> tuple[np.ndarray, np.ndarray]:
        """(n, 6) lengths [m] and (n, 6) speeds [m/s] of the legs in the rows that are due until `now` [s]."""
        return self.drive.advance(self.pose, now)

    def report(self) -> bytes:
        """Where its legs are, and the last packet that counted, as bytes."""
        seq, moment = (self.last.seq, self.last.time) if self.last is not None else (0, 0.0)
        return reported(Reading(seq, moment, tuple(self.drive.legs.length.tolist()), self.glide is not None))


def ready_made(name: str) -> Geometry:
    """The geometry configs/geometry/<name>.yaml."""
    return Geometry.model_validate(preset("geometry", name))


def received(url: str, patience: float, report: Callable[[Packet], None], platform: Receiver | None = None) -> Receiver:
    """Wait for a first packet that counts, then receive until none came for `patience` [s], whatever else came,
    reporting every packet, and to its sender where the legs are, also when the platform is stopped; by default for the
    platform `hexapod_a`. Raises OSError or ValueError."""
    host, port = address(url)
    platform = platform or Receiver(ready_made("hexapod_a"))
    with socket.socket(socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0][0], socket.SOCK_DGRAM) as listening:
        listening.bind((host, port))
        listening.settimeout(EVERY)
        while not platform.line or platform.silence(time.perf_counter()) < patience:
            platform.advance(time.perf_counter())
            try:
                data, source = listening.recvfrom(2048)
            except TimeoutError:
                continue
            packet = platform.hear(data, source, time.perf_counter())
            if packet is not None or (platform.glide is not None and source == platform.source):
                listening.sendto(platform.report(), source)
            if packet is not None:
                report(packet)
        return platform


def print_some(packet: Packet) -> None:
    """Print a line for every hundredth packet."""
    if packet.seq % 100 == 0:
        pose = ", ".join(f"{value:+.4f}" for value in packet.pose)
        print(f"{packet.time:8.2f} s  {packet.frame}  x y z roll pitch yaw: {pose}", flush=True)


def stop(url: str, key: bytes = b"") -> None:
    """Stop the platform that listens at an address. Raises OSError or ValueError."""
    host, port = address(url)
    with socket.socket(socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0][0], socket.SOCK_DGRAM) as sending:
        sending.sendto(halt(key, time.time_ns()), (host, port))


def listens(url: str, key: bytes = b"") -> None:
    """Receive a stream, and print how it came. Raises OSError or ValueError."""
    print(f"waiting for packets at {url}", flush=True)
    seen = received(url, 10.0, print_some, Receiver(ready_made("hexapod_a"), key))
    kinds = ("lost", "out of order", "strange", "from elsewhere", "implausible")
    counts = zip(kinds, (seen.lost, seen.reordered, seen.strange, seen.foreign, seen.implausible))
    ends = "; it was stopped" if seen.glide is not None else ""
    told = ", ".join(f"{count} {kind}" for kind, count in counts)
    print(f"{seen.came} packets, {told}; {seen.stalls} stalls{ends}")


def main(words: Sequence[str]) -> int:
    """Receive a stream, or stop a platform, as the words of a command say; its exit code."""
    stops = [*words[:1]] == ["stop"]
    rest = words[1:] if stops else words or [f"udp://{LOOPBACK}:5005"]
    if "--help" in words or not 1 <= len(rest) <= 2:
        print(USAGE, file=sys.stdout if "--help" in words else sys.stderr)
        return 0 if "--help" in words else 2
    url = rest[0]
    try:
        secret = key_in(rest[1]) if len(rest) > 1 else b""
        if stops:
            stop(url, secret)
            print(f"stop sent to {url}")
        else:
            listens(url, secret)
    except (OSError, ValueError) as error:
        print(error if isinstance(error, ValueError) else f"{url}: {error.strerror or error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

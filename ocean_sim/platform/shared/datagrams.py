"""Poses of a platform as datagrams: two packet formats, a sender that keeps time, a receiver without jumps.

`ocean_sim`, version 1, 120 bytes, little-endian: 4 bytes `OSPF`, uint16 version, uint16 frame (0 flu, 1 ned, 2 ship),
uint32 sequence number, uint32 what was limited, float64 time [s], 6 float64 x, y, z [m] from neutral, roll, pitch, yaw
[rad], 6 float64 leg lengths [m].

`openmotionsim`, 20 bytes, little-endian: 5 float32 time [s], yaw, pitch, roll [degrees], height [m].

`python -m ocean_sim.platform.shared.datagrams udp://127.0.0.1:5005` receives packets and
prints what comes.
"""

import socket
import struct
import sys
import time
from collections.abc import Callable, Iterator
from typing import NamedTuple
from urllib.parse import urlsplit

import numpy as np

from ocean_sim.platform import Commands
from ocean_sim.platform.shared.motion_log import AXES, signs

MAGIC, VERSION = b"OSPF", 1
OURS = struct.Struct("<4sHHIId6d6d")
THEIRS = struct.Struct("<5f")
FORMATS = ("ocean_sim", "openmotionsim")
FRAMES = ("flu", "ned", "ship")
LOOPBACK = "127.0.0.1"
SPIN = 0.0005  # [s] before its time for which a packet is waited for without sleeping


class Packet(NamedTuple):
    """One row of platform.csv on its way."""

    seq: int
    time: float  # [s]
    frame: str
    pose: tuple[float, ...]  # x, y, z [m], roll, pitch, yaw [rad]
    legs: tuple[float, ...]  # [m]; none in `openmotionsim`
    limited: int


def in_frame(pose: np.ndarray, frame: str) -> np.ndarray:
    """(n, 6) poses along FLU, along the axes of another frame: x, y, z along them, roll, pitch, yaw about what is
    forward, abeam and upright there."""
    return np.hstack([pose[:, :3] @ AXES[frame].T, pose[:, 3:] * signs(frame)])


def packets(rows: Commands, frame: str) -> Iterator[Packet]:
    """Rows of platform.csv as packets whose poses are along the axes of a frame."""
    poses = in_frame(rows.pose, frame).tolist()
    columns = (rows.seq.tolist(), rows.time.tolist(), poses, rows.legs.tolist(), rows.limited.tolist())
    for seq, moment, pose, lengths, limited in zip(*columns):
        yield Packet(seq, moment, frame, tuple(pose), tuple(lengths), limited)


def packed(packet: Packet, layout: str) -> bytes:
    """A packet as bytes."""
    if layout == "ocean_sim":
        head = (MAGIC, VERSION, FRAMES.index(packet.frame), packet.seq, packet.limited, packet.time)
        return OURS.pack(*head, *packet.pose, *packet.legs)
    upward = AXES[packet.frame] @ [0.0, 0.0, 1.0]
    roll, pitch, yaw = np.degrees(packet.pose[3:])
    return THEIRS.pack(packet.time, yaw, pitch, roll, float(upward @ packet.pose[:3]))


def unpacked(data: bytes) -> Packet:
    """A packet from the bytes of our own format; raises ValueError."""
    if len(data) != OURS.size or data[:4] != MAGIC:
        raise ValueError(f"{len(data)} bytes that are not a packet of ours")
    _, version, frame, seq, limited, moment, *rest = OURS.unpack(data)
    if version != VERSION or frame >= len(FRAMES):
        raise ValueError(f"a packet of version {version}, frame {frame}")
    return Packet(seq, moment, FRAMES[frame], tuple(rest[:6]), tuple(rest[6:]), limited)


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


class Sender:
    """Sends rows at the pace of their own time. Raises ValueError where the address is malformed, OSError where the
    host is unknown.

    A row that comes too late is sent at once and the clock is set by it: what follows keeps its pace, there is no
    burst.
    """

    left_out = ("socket", "start", "sent", "due")  # what a checkpoint of it does not hold

    def __init__(self, url: str, layout: str = "ocean_sim") -> None:
        self.address, self.layout = address(url), layout
        try:
            kind = socket.getaddrinfo(*self.address, type=socket.SOCK_DGRAM)[0][0]
        except OSError as error:
            raise OSError(error.errno, error.strerror or str(error), url) from None
        self.socket = socket.socket(kind, socket.SOCK_DGRAM)
        self.start: float | None = None  # what the clock shows at time 0 of the rows [s]
        self.sent: list[float] = []  # [s]
        self.due: list[float] = []  # times of the rows [s]

    def send(self, packet: Packet) -> None:
        """Wait until it is time, then send."""
        data, now = packed(packet, self.layout), time.perf_counter()
        if self.start is None or now > self.start + packet.time:
            self.start = now - packet.time
        while (left := self.start + packet.time - time.perf_counter()) > 0.0:
            time.sleep(max(0.0, left - SPIN))
        self.socket.sendto(data, self.address)
        self.sent.append(time.perf_counter())
        self.due.append(packet.time)

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
    they return it moves over to them within `ramp` [s], also to those of a new stream. Packets that are
    out of order are dropped and counted.
    """

    def __init__(self, hold: float = 0.1, ramp: float = 3.0) -> None:
        self.hold, self.ramp = hold, ramp
        self.last: Packet | None = None
        self.line: list[tuple[float, np.ndarray]] = []  # the last two poses, and when they came [s]
        self.returned, self.held = -np.inf, np.zeros(6)  # when packets came back [s], and the pose until then
        self.came = self.lost = self.reordered = self.stalls = self.strange = 0

    def take(self, packet: Packet, now: float) -> None:
        """A packet that came at `now` [s]."""
        self.came += 1
        if self.last is not None:
            silent, ahead = now - self.line[-1][0] > self.hold, packet.seq - self.last.seq
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
        if not self.line:
            return self.held
        (first, before), (second, after) = self.line[0], self.line[-1]
        part = min(1.0, (now - second) / (second - first)) if second > first else 1.0
        pose = before + part * (after - before)
        s = min(1.0, max(0.0, (now - self.returned) / self.ramp))
        return self.held + s**3 * (10.0 - 15.0 * s + 6.0 * s * s) * (pose - self.held)


def received(url: str, patience: float, report: Callable[[Packet], None]) -> Smooth:
    """Wait for a first packet, then receive until nothing came for `patience` [s], reporting every packet; what is not
    one of ours is counted as strange. Raises OSError or ValueError."""
    host, port = address(url)
    platform = Smooth()
    with socket.socket(socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0][0], socket.SOCK_DGRAM) as listening:
        listening.bind((host, port))
        while True:
            try:
                packet = unpacked(listening.recv(2048))
            except TimeoutError:
                return platform
            except ValueError:
                platform.strange += 1
                continue
            listening.settimeout(patience)
            platform.take(packet, time.perf_counter())
            report(packet)


def print_some(packet: Packet) -> None:
    """Print a line for every hundredth packet."""
    if packet.seq % 100 == 0:
        pose = ", ".join(f"{value:+.4f}" for value in packet.pose)
        print(f"{packet.time:8.2f} s  {packet.frame}  x y z roll pitch yaw: {pose}", flush=True)


def main(url: str = f"udp://{LOOPBACK}:5005") -> None:
    """Receive a stream and print how it came."""
    print(f"waiting for packets at {url}", flush=True)
    try:
        seen = received(url, 10.0, print_some)
    except (OSError, ValueError) as error:
        print(error if isinstance(error, ValueError) else f"{url}: {error.strerror or error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        sys.exit(130)
    kinds = ("lost", "out of order", "strange")
    counts = zip(kinds, (seen.lost, seen.reordered, seen.strange))
    print(f"{seen.came} packets, " + ", ".join(f"{count} {kind}" for kind, count in counts) + f"; {seen.stalls} stalls")


if __name__ == "__main__":
    main(*sys.argv[1:2])

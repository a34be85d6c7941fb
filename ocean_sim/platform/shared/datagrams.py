"""Poses of a platform as datagrams: two packet formats, a sender that keeps time, a receiver without jumps.

`ocean_sim`, version 1, 120 bytes, little-endian: 4 bytes `OSPF`, uint16 version, uint16 frame (0 flu, 1 ned, 2 ship),
uint32 sequence number, uint32 what was limited, float64 time [s], 6 float64 x, y, z [m] from neutral, roll, pitch, yaw
[rad], 6 float64 leg lengths [m].

With a key, 160 bytes: the 120, uint64 when the stream began [ns, since 1970], and HMAC-SHA256 of these 128.

`openmotionsim`, 20 bytes, little-endian: 5 float32 time [s], yaw, pitch, roll [degrees], height [m].

`python -m ocean_sim.platform.shared.datagrams udp://127.0.0.1:5005` receives packets and
prints what comes; a further word names the file of a key.
"""

import hmac
import socket
import struct
import sys
import time
from collections.abc import Callable, Iterator
from typing import NamedTuple
from urllib.parse import urlsplit

import numpy as np

from ocean_sim.files import input_file, yaml_file
from ocean_sim.parts import library
from ocean_sim.platform import Commands
from ocean_sim.platform.shared.guard import EVERY, Drive, Judge
from ocean_sim.platform.shared.kinematics import Geometry, Hexapod, smoothly
from ocean_sim.platform.shared.motion_log import AXES, signs

MAGIC, VERSION = b"OSPF", 1
OURS = struct.Struct("<4sHHIId6d6d")
THEIRS = struct.Struct("<5f")
BEGAN, DIGEST = struct.Struct("<Q"), 32  # what a signed packet has besides: when its stream began, and its signature
LEAST_KEY, MOST_KEY = 16, 4096  # bytes
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
    if not np.isfinite([moment, *rest]).all():
        raise ValueError("a packet that holds what is not a number")
    return Packet(seq, moment, FRAMES[frame], tuple(rest[:6]), tuple(rest[6:]), limited)


def along_flu(packet: Packet) -> np.ndarray:
    """(6,) the pose of a packet along FLU."""
    pose = np.array(packet.pose)
    return np.concatenate([pose[:3] @ AXES[packet.frame], pose[3:] * signs(packet.frame)])


def key_in(file: str) -> bytes:
    """The key in a file, which sender and receiver share; raises Unreadable, a ValueError."""
    key = input_file.content(file, MOST_KEY).strip()
    if len(key) < LEAST_KEY:
        raise input_file.Unreadable(file, f"a key has at least {LEAST_KEY} bytes, this one {len(key)}")
    return key


def signed(data: bytes, key: bytes, began: int) -> bytes:
    """A packet with a signature, of a stream that began at a time [ns]."""
    data += BEGAN.pack(began)
    return data + hmac.digest(key, data, "sha256")


def verified(data: bytes, key: bytes) -> tuple[bytes, int]:
    """A packet without its signature, and when its stream began [ns]; raises ValueError."""
    told, signature = data[:-DIGEST], data[-DIGEST:]
    if len(data) != OURS.size + BEGAN.size + DIGEST or not hmac.compare_digest(
        signature, hmac.digest(key, told, "sha256")
    ):
        raise ValueError("a packet that is not signed with our key")
    return told[: OURS.size], BEGAN.unpack(told[OURS.size :])[0]


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
    """Sends rows at the pace of their own time, with a key signed. Raises ValueError where the address is malformed or
    the layout has no place for a signature, OSError where the host is unknown.

    A row that comes too late is sent at once and the clock is set by it: what follows keeps its pace, there is no
    burst.
    """

    left_out = ("socket", "start", "sent", "due", "key", "began")  # what a checkpoint of it does not hold

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

    def send(self, packet: Packet) -> None:
        """Wait until it is time, then send."""
        data, now = packed(packet, self.layout), time.perf_counter()
        data = signed(data, self.key, self.began) if self.key else data
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
    they begin or return it moves over to them within `ramp` [s], also to those of a new stream. After `home` [s]
    without packets it moves back to neutral. Packets that are out of order are dropped and counted.
    """

    def __init__(self, hold: float = 0.1, ramp: float = 3.0, home: float = np.inf) -> None:
        self.hold, self.ramp, self.home = hold, ramp, home
        self.last: Packet | None = None
        self.line: list[tuple[float, np.ndarray]] = []  # the last two poses, and when they came [s]
        self.returned, self.held = -np.inf, np.zeros(6)  # when packets came back [s], and the pose until then
        self.came = self.lost = self.reordered = self.stalls = self.strange = 0

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
    All else is counted and dropped. In silence the platform brakes and holds its pose, then it goes home, and only
    there a stream may come from elsewhere. The legs keep their limits whatever comes.
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


def ready_made(name: str) -> Geometry:
    """The geometry configs/geometry/<name>.yaml."""
    return Geometry.model_validate(yaml_file.read(library("configs") / "geometry" / f"{name}.yaml").plain())


def received(url: str, patience: float, report: Callable[[Packet], None], platform: Receiver | None = None) -> Receiver:
    """Wait for a first packet that counts, then receive until none came for `patience` [s], whatever else came,
    reporting every packet; by default for the platform `hexapod_a`. Raises OSError or ValueError."""
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
            if packet is not None:
                report(packet)
        return platform


def print_some(packet: Packet) -> None:
    """Print a line for every hundredth packet."""
    if packet.seq % 100 == 0:
        pose = ", ".join(f"{value:+.4f}" for value in packet.pose)
        print(f"{packet.time:8.2f} s  {packet.frame}  x y z roll pitch yaw: {pose}", flush=True)


def main(url: str = f"udp://{LOOPBACK}:5005", key: str = "") -> None:
    """Receive a stream and print how it came."""
    print(f"waiting for packets at {url}", flush=True)
    try:
        platform = Receiver(ready_made("hexapod_a"), key_in(key) if key else b"")
        seen = received(url, 10.0, print_some, platform)
    except (OSError, ValueError) as error:
        print(error if isinstance(error, ValueError) else f"{url}: {error.strerror or error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        sys.exit(130)
    kinds = ("lost", "out of order", "strange", "from elsewhere", "implausible")
    counts = zip(kinds, (seen.lost, seen.reordered, seen.strange, seen.foreign, seen.implausible))
    print(f"{seen.came} packets, " + ", ".join(f"{count} {kind}" for kind, count in counts) + f"; {seen.stalls} stalls")


if __name__ == "__main__":
    main(*sys.argv[1:3])

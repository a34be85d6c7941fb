"""Poses of a platform as datagrams: a sender that keeps time, and a receiver that moves without jumps and reports back.

`python -m ocean_sim.platform.shared.datagrams udp://127.0.0.1:5005` receives packets, prints them, and reports the legs
to their sender; a further word names the file of a key. With `stop` before the address it stops the platform that
listens there.
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
from ocean_sim.platform.shared import packets as wire
from ocean_sim.platform.shared.kinematics import Geometry, Hexapod, smooth_step
from ocean_sim.platform.shared.limits import Legs

MIN_KEY_BYTES, MAX_KEY_BYTES = 16, 4096  # bytes
LOOPBACK_HOST = "127.0.0.1"
COMMAND_INTERVAL = 0.01  # [s] between two commands to the legs
CLOCK_RESTART_GAP = 1.0  # [s] without a call, after which the clock of the legs starts again
NUMBER_TOLERANCE = 1e-3  # [m] and [m/s] of a leg, lost in the number format of packets
UNKNOWN_SPEEDS = np.full(6, np.nan)  # [m/s] of legs in a pose that is compared with no other
LEG_MARGIN = 1.02  # times the limits of the legs, beyond which a pose is refused
BRAKE_TIME = 0.15  # [s] in which a platform that is stopped loses its speed
USAGE = """usage: python -m ocean_sim.platform.shared.datagrams [udp://127.0.0.1:5005] [KEYFILE]
       python -m ocean_sim.platform.shared.datagrams stop udp://127.0.0.1:5005 [KEYFILE]
The first receives packets, prints what comes, and reports where the legs are; the second stops that platform."""
SPIN_TIME = 0.0005  # [s] before its time for which a packet is waited for without sleeping
KEY_RULE = input_file.Rule(f"a key has {MIN_KEY_BYTES} to {MAX_KEY_BYTES} bytes")
CHECKS = (input_file.Checked("A key, `stream.key`", (KEY_RULE,)),)


def read_key(file: str) -> bytes:
    """Read the signature key that sender and receiver share; raises Unreadable, a ValueError, for a wrong length."""
    key = input_file.read_bytes(file, MAX_KEY_BYTES).strip()
    if len(key) < MIN_KEY_BYTES:
        raise KEY_RULE.broken(file, f"it has {len(key)} bytes")
    return key


def parse_address(url: str) -> tuple[str, int]:
    """Host (by default this machine) and port of a URL like `udp://127.0.0.1:5005`. Raises ValueError if malformed."""
    try:
        parts = urlsplit(url if "//" in url else f"//{url}", scheme="udp")
        host, port = parts.hostname or LOOPBACK_HOST, parts.port
    except ValueError:
        host, port, parts = LOOPBACK_HOST, None, None
    if parts is None or parts.scheme != "udp" or not port or parts.path not in ("", "/"):
        raise ValueError(f"{url!r} is not like udp://{LOOPBACK_HOST}:5005")
    return host, port


class Jitter(NamedTuple):
    """Statistics of the time intervals between packets sent."""

    packets: int
    interval: float  # mean time from packet to packet [s]
    deviation: float  # its standard deviation [s]
    longest: float  # [s]
    late: float  # part of the packets that came more than two intervals after the one before

    def __str__(self) -> str:
        ms = [f"{1e3 * value:.3f} ms" for value in (self.interval, self.deviation, self.longest)]
        late = f"{100 * self.late:.2g} % late"
        return f"{self.packets} packets, every {ms[0]}, deviation {ms[1]}, longest {ms[2]}, {late}"


class Latency(NamedTuple):
    """Statistics of the times from sending a packet to the platform's report on it."""

    packets: int
    median: float  # [s]
    most: float  # of 99 % of them [s]
    longest: float  # [s]

    def __str__(self) -> str:
        ms = [f"{1e3 * value:.3f} ms" for value in (self.median, self.most, self.longest)]
        return f"there and back: median {ms[0]}, 99 % within {ms[1]}, longest {ms[2]}, of {self.packets} packets"


class Sender:
    """UDP sender of packets at the pace of their own times, signed if it has a key. Raises ValueError for a malformed
    address or a layout without place for a signature, OSError for an unknown host or a broadcast.

    A packet that comes too late is sent at once and resets the clock: later ones keep their pace, without a burst.
    """

    left_out = ("socket", "start", "sent", "due", "left", "readings", "key", "began")  # by a checkpoint

    def __init__(self, url: str, layout: str = "ocean_sim", key: bytes = b"") -> None:
        """`url`: where to, udp://HOST:PORT; `layout`: one of PACKET_LAYOUTS; `key`: signature key, empty for none."""
        if key and layout != "ocean_sim":
            raise ValueError(f"packets of {layout} have no place for a signature; take ocean_sim")
        self.address, self.layout = parse_address(url), layout
        self.key, self.began = key, time.time_ns()
        try:
            kind = socket.getaddrinfo(*self.address, type=socket.SOCK_DGRAM)[0][0]
            with socket.socket(kind, socket.SOCK_DGRAM) as probe:
                probe.connect(self.address)  # sends nothing
        except OSError as error:
            why = "it is that of all machines, name one" if isinstance(error, PermissionError) else error.strerror
            raise OSError(error.errno, why or str(error), url) from None
        self.socket = socket.socket(kind, socket.SOCK_DGRAM)
        self.start: float | None = None  # what the clock shows at time 0 of the rows [s]
        self.sent: list[float] = []  # [s]
        self.due: list[float] = []  # times of the rows [s]
        self.left: dict[int, float] = {}  # when each packet was sent [s], by its number
        self.readings: list[tuple[float, wire.LegReport]] = []  # what the platform reports, and when it came [s]

    def send(self, packet: wire.Packet) -> None:
        """Wait until a packet is due, receiving reports meanwhile, then send it."""
        data, now = wire.pack(packet, self.layout), time.perf_counter()
        data = wire.sign(data, self.key, self.began) if self.key else data
        if self.start is None or now > self.start + packet.time:
            self.start = now - packet.time
        while (left := self.start + packet.time - time.perf_counter()) > 0.0:
            if left > SPIN_TIME and select([self.socket], [], [], left - SPIN_TIME)[0]:
                self.listen()
        self.socket.sendto(data, self.address)
        self.sent.append(time.perf_counter())
        self.due.append(packet.time)
        self.left[packet.seq] = self.sent[-1]
        self.listen()

    def listen(self) -> None:
        """Receive all reports that the platform has sent so far into `readings`; malformed ones are dropped."""
        while True:
            try:
                data = self.socket.recv(2048, socket.MSG_DONTWAIT)
            except OSError:  # nothing has come, or nobody listens there
                return
            with suppress(ValueError):
                self.readings.append((time.perf_counter(), wire.parse_report(data)))

    def latency(self) -> "Latency | None":
        """Statistics of the delay from sending a packet to the platform's first report on it; None without reports."""
        first: dict[int, float] = {}
        for came, found in self.readings:
            first.setdefault(found.seq, came)
        ways = [came - self.left[seq] for seq, came in first.items() if seq in self.left]
        if not ways:
            return None
        median, most = np.percentile(ways, [50.0, 99.0]).tolist()
        return Latency(len(ways), median, most, max(ways))

    def stop_report(self) -> str:
        """Sentence that says when the platform reported a stop, after the first packet; empty if it reported none."""
        came = next((came for came, found in self.readings if found.stopped), None)
        return "" if came is None else f"the platform was stopped, {came - self.sent[0]:.2f} s after the first packet"

    def jitter(self) -> Jitter:
        gaps, wanted = np.diff(self.sent), np.diff(self.due)
        if not len(gaps):
            return Jitter(len(self.sent), 0.0, 0.0, 0.0, 0.0)
        late = float((gaps > 2.0 * wanted).mean())
        return Jitter(len(self.sent), float(gaps.mean()), float(gaps.std()), float(gaps.max()), late)

    def close(self) -> None:
        self.socket.close()


class SmoothPose:
    """Continuous pose of a platform from packets that may be late, lost or out of order.

    The pose is interpolated between the last two packets, one interval behind. Without packets it is held; when packets
    begin or return, or a new stream starts, it blends into their poses within `ramp` [s]. After `home` [s] without
    packets it returns to neutral. Packets that are out of order are dropped and counted.
    """

    def __init__(self, hold: float = 0.1, ramp: float = 3.0, home: float = np.inf) -> None:
        """Times [s]: silence `hold` that interrupts a stream; `ramp` of a blend into other poses; silence `home` before
        the return to neutral."""
        self.hold, self.ramp, self.home = hold, ramp, home
        self.last: wire.Packet | None = None
        self.line: list[tuple[float, np.ndarray]] = []  # the last two poses, and when they came [s]
        self.returned, self.held = -np.inf, np.zeros(6)  # when packets came back [s], and the pose until then
        self.came = self.lost = self.reordered = self.stalls = self.strange = 0
        self.glide: tuple[float, np.ndarray, np.ndarray] | None = None  # since when, from which pose, how fast

    def stop(self, now: float) -> None:
        """Stop for good: from the pose at `now` [s] glide to rest within about BRAKE_TIME, and stay there."""
        if self.glide is None:
            pose = self.pose(now)
            self.glide = now, pose, (pose - self.pose(now - COMMAND_INTERVAL)) / COMMAND_INTERVAL

    def silent_time(self, now: float) -> float:
        """Time [s] from the last accepted packet to `now` [s], on the receiver's clock; infinite before the first."""
        return now - self.line[-1][0] if self.line else np.inf

    def accept(self, packet: wire.Packet, now: float) -> None:
        """Use a packet that came at `now` [s]; one that is out of order is only counted."""
        self.came += 1
        if self.last is None:
            self.returned = now
        else:
            silent, ahead = self.silent_time(now) > self.hold, packet.seq - self.last.seq
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
        """Interpolated pose (6,) at `now` [s]: x, y, z [m], roll, pitch, yaw [rad]."""
        if self.glide is not None and now >= self.glide[0]:
            since, pose, speed = self.glide
            return pose + speed * BRAKE_TIME * (1.0 - np.exp((since - now) / BRAKE_TIME))
        if not self.line:
            return self.held
        (first, before), (second, after) = self.line[0], self.line[-1]
        part = min(1.0, (now - second) / (second - first)) if second > first else 1.0
        pose = before + part * (after - before)
        pose = self.held + smooth_step(np.clip((now - self.returned) / self.ramp, 0.0, 1.0)) * (pose - self.held)
        return pose * (1.0 - smooth_step(np.clip((self.silent_time(now) - self.home) / self.ramp, 0.0, 1.0)))


class Receiver(SmoothPose):
    """Pose and legs of a platform that checks every packet from the network.

    A packet is accepted if it is complete and finite, comes from the stream's own source, is newer than the last one,
    and has a pose that the legs can have reached since; with a `key`, it must also be signed and of no earlier stream.
    A stop packet is accepted from any source, with a key only if signed. All others are counted and dropped. In silence
    the platform brakes, holds its pose, then returns to neutral, after which another source may start a stream. The
    legs never exceed their limits, whatever packets say.
    """

    def __init__(
        self, geometry: Geometry, key: bytes = b"", hold: float = 0.1, ramp: float = 3.0, home: float = 2.0
    ) -> None:
        """`key`: signature key, empty for none. Times [s]: silence `hold` that interrupts a stream; `ramp` of a blend
        into other poses; silence `home` before the return to neutral."""
        super().__init__(hold, ramp, home)
        self.hexapod = Hexapod(geometry)
        self.speeds = UNKNOWN_SPEEDS  # (6,) of the legs, from the last pose but one to the last [m/s]
        self.interval = 0.0  # [s] between these two
        self.legs = Legs(geometry, COMMAND_INTERVAL, self.hexapod.neutral_legs)
        self.commanded = -np.inf  # [s] time of the last command to the legs
        self.key, self.began = key, 0  # when the stream began [ns], by its signature
        self.source: object = None
        self.foreign = self.implausible = 0

    def accept_datagram(self, data: bytes, source: object, now: float) -> wire.Packet | None:
        """Packet in a datagram that came from `source` at `now` [s]; None if malformed, refused, or a stop."""
        if wire.is_stop_packet(data, self.key):
            self.stop(now)
            return None
        if self.glide is not None:
            return None
        try:
            inner, began = wire.verify(data, self.key) if self.key else (data, 0)
            packet = wire.unpack(inner)
        except ValueError:
            self.strange += 1
            return None
        if self.source not in (None, source) and self.silent_time(now) < self.home + self.ramp:
            self.foreign += 1
            return None
        silent, pose = self.silent_time(now) > self.hold, wire.pose_along_flu(packet)
        old = self.last is not None and packet.seq <= self.last.seq
        again = began < self.began or (old and began == self.began)
        if self.key and (again or (began > self.began and not silent)):
            self.reordered += 1  # a signed stream goes on, or gives way to a later one; none is played again
            return None
        if (silent or not old) and not self.is_plausible(pose, packet.time, now, silent):
            self.implausible += 1
            return None
        self.source, self.began = source, began
        self.accept(packet._replace(pose=tuple(pose)), now)
        return packet

    @np.errstate(all="ignore")
    def is_plausible(self, pose: np.ndarray, time: float, now: float, silent: bool) -> bool:
        """True if the legs can reach a pose (6,) by their stroke, speed and acceleration. `time` [s]: in the stream;
        `now` [s]: of arrival. After a silence (`silent`) only the stroke is checked."""
        lengths, speeds = self.hexapod.legs(pose[None])[0], UNKNOWN_SPEEDS
        low, high = self.hexapod.low - NUMBER_TOLERANCE, self.hexapod.high + NUMBER_TOLERANCE
        if not ((lengths > low) & (lengths < high)).all():
            return False
        if self.last is not None and not silent:
            interval, before = time - self.last.time, self.hexapod.legs(self.line[-1][1][None])[0]
            if not 0.0 <= interval <= self.silent_time(now) + self.hold:
                return False
            moved = np.abs(lengths - before).max()
            if moved > LEG_MARGIN * self.legs.speed * interval + NUMBER_TOLERANCE:
                return False
            if interval > 0.0:
                speeds = (lengths - before) / interval
                turned = np.abs(speeds - self.speeds).max() - NUMBER_TOLERANCE / interval
                most = LEG_MARGIN * self.legs.acceleration * 0.5 * (interval + self.interval)
                if turned > most + NUMBER_TOLERANCE:  # never where the last pose has no speed
                    return False
                self.interval = interval
        self.speeds = speeds
        return True

    def advance(self, now: float) -> tuple[np.ndarray, np.ndarray]:
        """Command the legs up to `now` [s]; returns lengths (n, 6) [m] and speeds (n, 6) [m/s], one row a command."""
        if now - self.commanded > CLOCK_RESTART_GAP:
            self.commanded = now - COMMAND_INTERVAL
        count = int((now - self.commanded) / COMMAND_INTERVAL + 1e-6)
        if count == 0:
            return np.zeros((0, 6)), np.zeros((0, 6))
        times = self.commanded + COMMAND_INTERVAL * np.arange(1, count + 1)
        wanted = self.hexapod.legs(np.array([self.pose(time) for time in times]))
        lengths, speeds, _ = self.legs.follow(np.clip(wanted, self.hexapod.low, self.hexapod.high))
        self.commanded = float(times[-1])
        return lengths, speeds

    def report(self) -> bytes:
        """Packed report to the sender: leg lengths, number and time of the last accepted packet, stopped or not."""
        seq, moment = (self.last.seq, self.last.time) if self.last is not None else (0, 0.0)
        head = wire.LEGS_MAGIC, wire.FORMAT_VERSION, int(self.glide is not None), seq, moment
        return wire.LEGS_STRUCT.pack(*head, *self.legs.length)


def preset_geometry(name: str) -> Geometry:
    """Geometry of the hexapod in configs/geometry/<name>.yaml."""
    return Geometry.model_validate(preset("geometry", name))


def receive_stream(
    url: str, patience: float, report: Callable[[wire.Packet], None], platform: Receiver | None = None
) -> Receiver:
    """Receive at a UDP address until no packet has been accepted for `patience` [s], and return the receiver.

    It waits for the first packet without limit, calls `report` with every accepted one, and replies to its sender with
    the leg lengths, also once stopped. `platform`: by default `hexapod_a`. Raises OSError or ValueError for a bad URL.
    """
    host, port = parse_address(url)
    platform = platform or Receiver(preset_geometry("hexapod_a"))
    with socket.socket(socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0][0], socket.SOCK_DGRAM) as listening:
        listening.bind((host, port))
        listening.settimeout(COMMAND_INTERVAL)
        while not platform.line or platform.silent_time(time.perf_counter()) < patience:
            platform.advance(time.perf_counter())
            try:
                data, source = listening.recvfrom(2048)
            except TimeoutError:
                continue
            packet = platform.accept_datagram(data, source, time.perf_counter())
            if packet is not None or (platform.glide is not None and source == platform.source):
                listening.sendto(platform.report(), source)
            if packet is not None:
                report(packet)
        return platform


def print_some(packet: wire.Packet) -> None:
    if packet.seq % 100 == 0:
        pose = ", ".join(f"{value:+.4f}" for value in packet.pose)
        print(f"{packet.time:8.2f} s  {packet.frame}  x y z roll pitch yaw: {pose}", flush=True)


def print_stream(url: str, key: bytes = b"") -> None:
    """Receive a stream at `url`, udp://HOST:PORT, and print a summary. OSError or ValueError if it is bad."""
    print(f"waiting for packets at {url}", flush=True)
    seen = receive_stream(url, 10.0, print_some, Receiver(preset_geometry("hexapod_a"), key))
    kinds = ("lost", "out of order", "strange", "from elsewhere", "implausible")
    counts = zip(kinds, (seen.lost, seen.reordered, seen.strange, seen.foreign, seen.implausible))
    ends = "; it was stopped" if seen.glide is not None else ""
    totals = ", ".join(f"{count} {kind}" for kind, count in counts)
    print(f"{seen.came} packets, {totals}; {seen.stalls} stalls{ends}")


def main(words: Sequence[str]) -> int:
    """Run the command line `words` (USAGE, from the URL on): receive a stream or stop a platform; returns exit code."""
    stops = [*words[:1]] == ["stop"]
    rest = words[1:] if stops else words or [f"udp://{LOOPBACK_HOST}:5005"]
    if "--help" in words or not 1 <= len(rest) <= 2:
        print(USAGE, file=sys.stdout if "--help" in words else sys.stderr)
        return 0 if "--help" in words else 2
    url = rest[0]
    try:
        secret = read_key(rest[1]) if len(rest) > 1 else b""
        if stops:
            host, port = parse_address(url)
            family = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0][0]
            with socket.socket(family, socket.SOCK_DGRAM) as sending:
                sending.sendto(wire.stop_packet(secret, time.time_ns()), (host, port))
            print(f"stop sent to {url}")
        else:
            print_stream(url, secret)
    except (OSError, ValueError) as error:
        print(error if isinstance(error, ValueError) else f"{url}: {error.strerror or error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

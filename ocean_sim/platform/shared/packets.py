"""What goes over the wire between a run, motion software and a platform, byte by byte; all numbers little-endian.

`ocean_sim`, version 1, 120 bytes: 4 bytes `OSPF`, uint16 version, uint16 frame (0 flu, 1 ned, 2 ship), uint32 sequence
number, uint32 what was limited, float64 time [s], 6 float64 x, y, z [m] from neutral, roll, pitch, yaw [rad], 6 float64
leg lengths [m]. With a key, 160 bytes: the 120, uint64 when the stream began [ns, since 1970], and HMAC-SHA256 of these
128.

`openmotionsim`, 20 bytes: 5 float32 time [s], yaw, pitch, roll [degrees], height [m].

`floats`, 36 bytes, for software whose source is set up field by field (FlyPt Mover, SimHub): offset 0 float32 time [s],
4 float32 sequence number, 8 surge, 12 sway, 16 heave [mm], 20 roll, 24 pitch, 28 yaw [degrees] as float32, 32 uint32
what was limited.

`text`, one line of ASCII, for software that splits text (SimTools, SimHub): `time,surge,sway,heave,roll,pitch,yaw` [s],
[mm], [degrees] with three decimals, and a line feed.

Back from a platform, `legs`, 68 bytes: 4 bytes `OSPL`, uint16 version, uint16 state (0 following, 1 stopped), uint32
sequence number of the last packet that counted, float64 its time [s], 6 float64 lengths of the legs as they are [m].

To stop one, `stop`, 12 bytes: 4 bytes `OSPE`, uint16 version, uint16 0, uint32 0; with a key, followed like a pose by
uint64 the time [ns, since 1970] and the signature of these 20, 52 bytes in all. It brakes within the limits of its
legs, holds, and takes no further pose until it is started again.
"""

import hmac
import struct
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from ocean_sim.platform import Commands
from ocean_sim.platform.shared.motion_log import AXES, signs

MAGIC, LEGS, STOP, VERSION = b"OSPF", b"OSPL", b"OSPE", 1
OURS = struct.Struct("<4sHHIId6d6d")
OPENMOTIONSIM = struct.Struct("<5f")
FLOATS = struct.Struct("<8fI")
BACK = struct.Struct("<4sHHId6d")
HALT = struct.Struct("<4sHHI")
BEGAN, DIGEST = struct.Struct("<Q"), 32  # what a signed packet has besides: when its stream began, and its signature
FRAMES = ("flu", "ned", "ship")


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


def ours(packet: Packet) -> bytes:
    head = (MAGIC, VERSION, FRAMES.index(packet.frame), packet.seq, packet.limited, packet.time)
    return OURS.pack(*head, *packet.pose, *packet.legs)


def openmotionsim(packet: Packet) -> bytes:
    upward = AXES[packet.frame] @ [0.0, 0.0, 1.0]
    roll, pitch, yaw = np.degrees(packet.pose[3:])
    return OPENMOTIONSIM.pack(packet.time, yaw, pitch, roll, float(upward @ packet.pose[:3]))


def six(packet: Packet) -> list[float]:
    """Along the axes of its frame: what is forward, abeam and upright [mm], about them [degrees]."""
    shift = np.array(packet.pose[:3]) * 1e3
    if packet.frame == "ship":  # x is to port, y upright, z forward
        shift = shift[[2, 0, 1]]
    return [*shift.tolist(), *np.degrees(packet.pose[3:]).tolist()]


def floats(packet: Packet) -> bytes:
    return FLOATS.pack(packet.time, packet.seq, *six(packet), packet.limited)


def text(packet: Packet) -> bytes:
    return (",".join(f"{value:.3f}" for value in [packet.time, *six(packet)]) + "\n").encode()


LAYOUTS: dict[str, Callable[[Packet], bytes]] = {
    "ocean_sim": ours,
    "openmotionsim": openmotionsim,
    "floats": floats,
    "text": text,
}
FORMATS = tuple(LAYOUTS)


def packed(packet: Packet, layout: str) -> bytes:
    """A packet as bytes."""
    return LAYOUTS[layout](packet)


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


def signed(data: bytes, key: bytes, began: int) -> bytes:
    """A packet with a signature, of a stream that began at a time [ns]."""
    data += BEGAN.pack(began)
    return data + hmac.digest(key, data, "sha256")


def verified(data: bytes, key: bytes) -> tuple[bytes, int]:
    """A packet without its signature, and when its stream began [ns]; raises ValueError."""
    if not is_signed(data, OURS.size, key):
        raise ValueError("a packet that is not signed with our key")
    return data[: OURS.size], BEGAN.unpack_from(data, OURS.size)[0]


def is_signed(data: bytes, size: int, key: bytes) -> bool:
    """True if this is a packet of so many bytes, followed by a time and its signature with a key."""
    told, signature = data[:-DIGEST], data[-DIGEST:]
    return len(told) == size + BEGAN.size and hmac.compare_digest(signature, hmac.digest(key, told, "sha256"))


class Reading(NamedTuple):
    """Where the legs of a platform are, as it reports."""

    seq: int  # of the last packet that counted
    time: float  # its time [s]
    legs: tuple[float, ...]  # lengths [m]
    stopped: bool


def reading(data: bytes) -> Reading:
    """What a platform reports; raises ValueError."""
    if len(data) != BACK.size or data[:4] != LEGS:
        raise ValueError(f"{len(data)} bytes that are not a report of legs")
    _, version, state, seq, moment, *legs = BACK.unpack(data)
    if version != VERSION or not np.isfinite([moment, *legs]).all():
        raise ValueError("a report of another version, or with a value that is not a number")
    return Reading(seq, moment, tuple(legs), state == 1)


def reported(found: Reading) -> bytes:
    """A report as bytes."""
    return BACK.pack(LEGS, VERSION, int(found.stopped), found.seq, found.time, *found.legs)


def halt(key: bytes = b"", now: int = 0) -> bytes:
    """The packet that stops a platform; signed with a key at a time [ns]."""
    data = HALT.pack(STOP, VERSION, 0, 0)
    return signed(data, key, now) if key else data


def halts(data: bytes, key: bytes = b"") -> bool:
    """Whether this is a packet that stops a platform, with a key one that is signed with it."""
    return data[:4] == STOP and (is_signed(data, HALT.size, key) if key else len(data) == HALT.size)

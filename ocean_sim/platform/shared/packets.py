"""Packets between a run, motion software and a platform, byte by byte; all numbers little-endian.

`ocean_sim`, version 1, 120 bytes: 4 bytes `OSPF`, uint16 version, uint16 frame (0 flu, 1 ned, 2 ship), uint32 sequence
number, uint32 limits that acted, float64 time [s], 6 float64 x, y, z [m] from neutral, roll, pitch, yaw [rad],
6 float64 leg lengths [m]. With a key, 160 bytes: the 120, uint64 start of the stream [ns, since 1970], and HMAC-SHA256
of these 128.

`openmotionsim`, 20 bytes: 5 float32 time [s], yaw, pitch, roll [degrees], height [m].

`floats`, 36 bytes, for software whose source is set up field by field (FlyPt Mover, SimHub): offset 0 float32 time [s],
4 float32 sequence number, 8 surge, 12 sway, 16 heave [mm], 20 roll, 24 pitch, 28 yaw [degrees] as float32, 32 uint32
limits that acted.

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
from ocean_sim.platform.shared.motion_log import FRAME_AXES, frame_signs

POSE_MAGIC, LEGS_MAGIC, STOP_MAGIC, FORMAT_VERSION = b"OSPF", b"OSPL", b"OSPE", 1
POSE_STRUCT = struct.Struct("<4sHHIId6d6d")
OPENMOTIONSIM_STRUCT = struct.Struct("<5f")
FLOATS_STRUCT = struct.Struct("<8fI")
LEGS_STRUCT = struct.Struct("<4sHHId6d")
STOP_STRUCT = struct.Struct("<4sHHI")
START_STRUCT, DIGEST_BYTES = struct.Struct("<Q"), 32  # end of a signed packet: start of its stream, signature
FRAME_NAMES = ("flu", "ned", "ship")


class Packet(NamedTuple):
    """Row of platform.csv as sent: number, time, pose in axes `frame` (flu, ned, ship), legs, limits that acted."""

    seq: int
    time: float  # [s]
    frame: str
    pose: tuple[float, ...]  # x, y, z [m], roll, pitch, yaw [rad]
    legs: tuple[float, ...]  # [m]; none in `openmotionsim`
    limited: int


def turn_to_frame(pose: np.ndarray, frame: str) -> np.ndarray:
    """Turn poses (n, 6) from FLU to axes `frame`; roll, pitch, yaw turn about its forward, lateral, vertical axis."""
    return np.hstack([pose[:, :3] @ FRAME_AXES[frame].T, pose[:, 3:] * frame_signs(frame)])


def row_packets(rows: Commands, frame: str) -> Iterator[Packet]:
    """Yield one packet for each row of commands, with poses along the axes of `frame`."""
    poses = turn_to_frame(rows.pose, frame).tolist()
    columns = (rows.seq.tolist(), rows.time.tolist(), poses, rows.legs.tolist(), rows.limited.tolist())
    for seq, moment, pose, lengths, limited in zip(*columns):
        yield Packet(seq, moment, frame, tuple(pose), tuple(lengths), limited)


def pack_ocean_sim(packet: Packet) -> bytes:
    """Bytes of a packet in the layout `ocean_sim`: all values, without a signature."""
    head = (POSE_MAGIC, FORMAT_VERSION, FRAME_NAMES.index(packet.frame), packet.seq, packet.limited, packet.time)
    return POSE_STRUCT.pack(*head, *packet.pose, *packet.legs)


def pack_openmotionsim(packet: Packet) -> bytes:
    upward = FRAME_AXES[packet.frame] @ [0.0, 0.0, 1.0]
    roll, pitch, yaw = np.degrees(packet.pose[3:])
    return OPENMOTIONSIM_STRUCT.pack(packet.time, yaw, pitch, roll, float(upward @ packet.pose[:3]))


def six_motions(packet: Packet) -> list[float]:
    """Displacements forward, lateral, vertical [mm], turns about these axes [degrees]; signs of its `frame`."""
    shift = np.array(packet.pose[:3]) * 1e3
    if packet.frame == "ship":  # x is to port, y upright, z forward
        shift = shift[[2, 0, 1]]
    return [*shift.tolist(), *np.degrees(packet.pose[3:]).tolist()]


PACKET_LAYOUTS: dict[str, Callable[[Packet], bytes]] = {
    "ocean_sim": pack_ocean_sim,
    "openmotionsim": pack_openmotionsim,
    "floats": lambda packet: FLOATS_STRUCT.pack(packet.time, packet.seq, *six_motions(packet), packet.limited),
    "text": lambda packet: ",".join(f"{value:.3f}" for value in [packet.time, *six_motions(packet)]).encode() + b"\n",
}
FORMAT_NAMES = tuple(PACKET_LAYOUTS)


def pack(packet: Packet, layout: str) -> bytes:
    """Bytes of a packet in a layout, one of PACKET_LAYOUTS."""
    return PACKET_LAYOUTS[layout](packet)


def unpack(data: bytes) -> Packet:
    """Packet from bytes of the layout `ocean_sim` without signature; raises ValueError if malformed or not finite."""
    if len(data) != POSE_STRUCT.size or data[:4] != POSE_MAGIC:
        raise ValueError(f"{len(data)} bytes that are not a packet of ours")
    _, version, frame, seq, limited, moment, *rest = POSE_STRUCT.unpack(data)
    if version != FORMAT_VERSION or frame >= len(FRAME_NAMES):
        raise ValueError(f"a packet of version {version}, frame {frame}")
    if not np.isfinite([moment, *rest]).all():
        raise ValueError("a packet that holds what is not a number")
    return Packet(seq, moment, FRAME_NAMES[frame], tuple(rest[:6]), tuple(rest[6:]), limited)


def pose_along_flu(packet: Packet) -> np.ndarray:
    """Pose (6,) of a packet, turned from the axes of its frame to FLU."""
    pose = np.array(packet.pose)
    return np.concatenate([pose[:3] @ FRAME_AXES[packet.frame], pose[3:] * frame_signs(packet.frame)])


def sign(data: bytes, key: bytes, began: int) -> bytes:
    """Data followed by the start of the stream `began` [ns since 1970] and an HMAC-SHA256 signature of both."""
    data += START_STRUCT.pack(began)
    return data + hmac.digest(key, data, "sha256")


def verify(data: bytes, key: bytes) -> tuple[bytes, int]:
    """Packet without its signature, and start of its stream [ns since 1970]; raises ValueError if not signed so."""
    if not is_signed(data, POSE_STRUCT.size, key):
        raise ValueError("a packet that is not signed with our key")
    return data[: POSE_STRUCT.size], START_STRUCT.unpack_from(data, POSE_STRUCT.size)[0]


def is_signed(data: bytes, size: int, key: bytes) -> bool:
    """True if data is a packet of `size` bytes, then a time, then the HMAC-SHA256 signature of both with this key."""
    content, signature = data[:-DIGEST_BYTES], data[-DIGEST_BYTES:]
    right = hmac.compare_digest(signature, hmac.digest(key, content, "sha256"))
    return len(content) == size + START_STRUCT.size and right


class LegReport(NamedTuple):
    """Report from a platform to the sender: its leg lengths, the last accepted packet, and whether it was stopped."""

    seq: int  # of the last packet that counted
    time: float  # its time [s]
    legs: tuple[float, ...]  # lengths [m]
    stopped: bool


def parse_report(data: bytes) -> LegReport:
    """Report from its bytes; raises ValueError if they are malformed or not finite."""
    if len(data) != LEGS_STRUCT.size or data[:4] != LEGS_MAGIC:
        raise ValueError(f"{len(data)} bytes that are not a report of legs")
    _, version, state, seq, moment, *legs = LEGS_STRUCT.unpack(data)
    if version != FORMAT_VERSION or not np.isfinite([moment, *legs]).all():
        raise ValueError("a report of another version, or with a value that is not a number")
    return LegReport(seq, moment, tuple(legs), state == 1)


def stop_packet(key: bytes = b"", now: int = 0) -> bytes:
    """Bytes of a packet that stops a platform; with a key it is signed with the time `now` [ns since 1970]."""
    data = STOP_STRUCT.pack(STOP_MAGIC, FORMAT_VERSION, 0, 0)
    return sign(data, key, now) if key else data


def is_stop_packet(data: bytes, key: bytes = b"") -> bool:
    """True if data is a packet that stops a platform; if a key is given, only if it is signed with that key."""
    return data[:4] == STOP_MAGIC and (is_signed(data, STOP_STRUCT.size, key) if key else len(data) == STOP_STRUCT.size)

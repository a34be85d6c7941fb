"""Rides and motion logs that are computed, not simulated."""

import socket
import threading
from pathlib import Path

import numpy as np
import pytest

from ocean_sim.platform.shared.datagrams import Receiver, preset_geometry, receive_stream
from ocean_sim.platform.shared.motion_log import Ride
from ocean_sim.platform.shared.packets import unpack
from tests.processes import wait_for

DATA = Path(__file__).parent / "data"
G = 9.81


def ride(n, dt, force=(0.0, 0.0, 0.0), rate=(0.0, 0.0, 0.0), attitude=(0.0, 0.0, 0.0)):
    """A level ship at rest with something added, the same in every row or (n, 3)."""
    still = np.zeros((n, 3))
    return Ride(np.arange(n) * dt, np.arange(n), still + force + [0.0, 0.0, G], still + rate, still + attitude)


def columns(seconds=10.0, dt=0.01, heave=1.0, roll=0.05, period=6.0):
    """The columns of a motion log, ship axes: a sea that begins with its crest, so that the ship has no speed."""
    n = round(seconds / dt) + 1
    t, omega = np.arange(n) * dt, 2.0 * np.pi / period
    zero, angle, up = 0.0 * t, roll * np.sin(omega * t), -heave * omega**2 * np.cos(omega * t)
    table = {"time_s": t, "seq": np.arange(n), "sway_m": zero, "heave_m": heave * np.cos(omega * t), "surge_m": 2.0 * t}
    table |= {"pitch_rad": zero, "yaw_rad": zero, "roll_rad": angle}
    table |= {"qw": np.cos(angle / 2.0), "qx": zero, "qy": zero, "qz": np.sin(angle / 2.0)}
    table |= {"pitch_rate_rad_s": zero, "yaw_rate_rad_s": zero, "roll_rate_rad_s": roll * omega * np.cos(omega * t)}
    force = np.sin(angle) * (G + up), np.cos(angle) * (G + up), zero
    table |= {f"specific_force_{axis}_m_s2": value for axis, value in zip("xyz", force)}
    return table | {
        "force_buoyancy_x_N": zero + 1.0,
        "force_buoyancy_y_N": zero + 2.0,
        "force_buoyancy_z_N": zero + 3.0,
    }


def write(path, table, frame="world"):
    lines = [f"# frame: {frame}", "# seed: 7", ",".join(table)]
    rows = [",".join(format(value, ".9g") for value in row) for row in zip(*table.values())]
    path.write_text("\n".join([*lines, *rows]) + "\n")
    return path


@pytest.fixture
def log(tmp_path):
    """A motion log of 10 s, and how to write another."""
    return write(tmp_path / "motion.csv", columns())


class Listener:
    """A receiver on a free port of this machine that waits for so many packets."""

    def __init__(self, count):
        self.socket, self.seen = socket.socket(socket.AF_INET, socket.SOCK_DGRAM), []
        self.socket.bind(("127.0.0.1", 0))
        self.socket.settimeout(60.0)
        self.url = f"udp://127.0.0.1:{self.socket.getsockname()[1]}"
        self.thread = threading.Thread(target=self.listen, args=(count,))
        self.thread.start()

    def listen(self, count):
        while len(self.seen) < count:
            self.seen.append(unpack(self.socket.recv(2048)))

    def packets(self):
        """All packets, when they are there."""
        self.thread.join()
        self.socket.close()
        return self.seen


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asked:
        asked.bind(("127.0.0.1", 0))
        return asked.getsockname()[1]


class Heard(Receiver):
    """A receiver that tells when it listens, and hears nothing any more when it is over."""

    def __init__(self, *words, **keywords):
        super().__init__(*words, **keywords)
        self.listens, self.over = threading.Event(), False

    def advance(self, now):
        self.listens.set()
        return super().advance(now)

    def silent_time(self, now):
        return np.inf if self.over else super().silent_time(now)


class Receiving:
    """A platform on a free port of this machine that listens already, for the time of its patience [s] or until it is
    ended."""

    def __init__(self, report=lambda packet: None, patience=60.0, **keywords):
        self.url, self.platform = f"udp://127.0.0.1:{free_port()}", Heard(preset_geometry("hexapod_a"), **keywords)
        self.thread = threading.Thread(
            target=receive_stream, args=(self.url, patience, report, self.platform), daemon=True
        )
        self.thread.start()
        assert self.platform.listens.wait(60.0)

    def ended(self):
        """The receiver, when it has heard what was sent."""
        self.platform.over = True
        self.thread.join(60.0)
        assert not self.thread.is_alive()
        return self.platform


def until(holds):
    """Wait until something holds."""
    wait_for("that the condition of this test holds", holds)

"""A game pad at the helm of a window, as Linux hands it over: its joystick interface, which needs no library.

The left stick is the wheel, the right one or the triggers are pedals, the first button puts the rudder amidships, in
the order of the driver `xpad`, which most pads follow. Without a pad, or without such an interface, nothing is held.
"""

import os
from pathlib import Path
from struct import iter_unpack

DEVICES = Path("/dev/input")
EVENT = "<IhBB"  # milliseconds, value, kind, number (linux/joystick.h)
BUTTON, AXIS, ALREADY = 0x01, 0x02, 0x80  # kinds; the last is added to what stood so before it was opened
EVENTS = 64  # read at once
WHEEL, PEDALS, BRAKE, THROTTLE, AMIDSHIPS = 0, 4, 2, 5, 0
IDLE, MOST = 0.15, 32767.0  # what counts as no deflection of a stick, and a whole one


class Pad:
    """The first pad there is; one may come and go."""

    def __init__(self, devices: Path = DEVICES) -> None:
        self.devices, self.device = devices, -1
        self.axes: dict[int, float] = {}  # -1 to 1: right, down, pressed
        self.pressed: set[int] = set()  # buttons that went down since the last look
        self.released: set[int] = set()  # axes that have rested at -1, as triggers do and sticks do not

    def look(self) -> None:
        """Take what was moved since the last look."""
        self.pressed = set()
        if self.device < 0:
            self.open()
        try:
            while self.device >= 0 and (events := os.read(self.device, 8 * EVENTS)):
                self.take(events)
        except BlockingIOError:
            pass
        except OSError:  # it was pulled out
            self.close()

    def open(self) -> None:
        for path in sorted(self.devices.glob("js*")):
            try:
                self.device = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
                return
            except OSError:  # not ours to read
                continue

    def take(self, events: bytes) -> None:
        """What happened, in whole events."""
        for _, value, kind, number in iter_unpack(EVENT, events):
            if kind & ~ALREADY == AXIS:
                self.axes[number] = value / MOST
                if value == -MOST:
                    self.released.add(number)
            elif kind == BUTTON and value:
                self.pressed.add(number)

    @property
    def held(self) -> tuple[float, float]:
        """Pedal, ahead positive, and wheel, to port positive, each -1 to 1."""
        throttle, brake = (
            0.5 * (1.0 + self.axes[axis]) if axis in self.released else 0.0 for axis in (THROTTLE, BRAKE)
        )
        pedal = throttle - brake - self.stick(PEDALS)
        return min(max(pedal, -1.0), 1.0), -self.stick(WHEEL)

    @property
    def amidships(self) -> bool:
        """Whether the rudder is to be put amidships."""
        return AMIDSHIPS in self.pressed

    def stick(self, axis: int) -> float:
        deflection = self.axes.get(axis, 0.0)
        return deflection if abs(deflection) > IDLE else 0.0

    def close(self) -> None:
        """Let go of it, and of what it held."""
        if self.device >= 0:
            os.close(self.device)
        self.device, self.axes, self.pressed, self.released = -1, {}, set(), set()

"""What a person may set while looking at a simulation: pause, camera, sliders, wind and helm; it knows no window."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import radians
from typing import Any

import numpy as np

from ocean_sim.pictures.curves import Curves
from ocean_sim.pictures.subject import Subject

CAMERAS = ("third_person", "helm", "top", "side")
CONTENTS = ("surface", "particles", "both")
KEYS = {
    " ": "pause",
    "n": "step",
    "r": "reset",
    "w": "rewind",
    "c": "camera",
    "v": "content",
    "m": "next wind",
    "b": "wind before",
    "p": "snapshot",
    "o": "record",
    "x": "rudder amidships",
    "h": "next ship",
    "z": "camera back",
    "u": "hide or show",
    "Escape": "quit",
}
HELM = {  # throttle pedal, brake pedal, wheel to port and to starboard
    "Up": (1.0, 0.0),
    "Down": (-1.0, 0.0),
    "Left": (0.0, 1.0),
    "Right": (0.0, -1.0),
}
PEDAL, WHEEL = 0.5, radians(20.0)  # [1/s], [rad/s] how fast an order changes while a key is held
AZIMUTH, HEIGHT = radians(38.0), radians(20.0)  # [rad] of the eye at first
STEEPEST, CLOSEST, FARTHEST = radians(85.0), 0.2, 4.0


@dataclass
class Slider:
    """A number that a person moves; `apply` takes it into the running simulation."""

    label: str
    value: float
    low: float
    high: float
    apply: Callable[[float], None]

    def move(self, value: float) -> bool:
        """Take a value, held within the ends; whether anything changed. A window knows single precision only: what
        differs by less is no move."""
        value = min(max(value, self.low), self.high)
        if np.float32(value) == np.float32(self.value):
            return False
        self.value = value
        self.apply(value)
        return True


@dataclass
class Panel:
    """The state of the panel, and what each key and button does to it."""

    winds: list[str]
    """The presets there are."""
    wind: str
    camera: str = "third_person"
    content: str = "surface"
    contents: tuple[str, ...] = CONTENTS
    cameras: tuple[str, ...] = CAMERAS
    sliders: list[Slider] = field(default_factory=list)
    paused: bool = False
    recording: bool = False
    closed: bool = False
    hidden: bool = False  # the panel itself, and the curves
    azimuth: float = AZIMUTH  # of the eye around what it looks at [rad]
    height: float = HEIGHT  # of the eye over the horizon [rad]
    distance: float = 1.0  # over that at which everything is in the picture
    message: str = ""
    """What went wrong last."""
    ships: tuple[str, ...] = ()
    """The names of those there are."""
    ship: str = ""
    """The one that is steered and followed."""
    person: Any = None
    """Who steers it, once a person does: `give(throttle, rudder)`."""
    curves: Curves = field(default_factory=Curves)
    asked: list[str] = field(default_factory=list)
    """What is to be done before the next picture: step, reset, rewind, wind, snapshot, helm."""

    def press(self, key: str) -> None:
        """A key goes down; unknown keys do nothing."""
        if key in KEYS:
            self.do(KEYS[key])

    def do(self, action: str) -> None:
        """What a button or a key stands for."""
        if action == "pause":
            self.paused = not self.paused
        elif action == "step":
            self.paused = True
            self.asked.append("step")
        elif action == "record":
            self.recording = not self.recording
        elif action == "quit":
            self.closed = True
        elif action == "hide or show":
            self.hidden = not self.hidden
        elif action == "camera back":
            self.azimuth, self.height, self.distance = AZIMUTH, HEIGHT, 1.0
        elif action == "camera":
            self.camera = after(self.camera, self.cameras)
        elif action == "content":
            self.content = after(self.content, self.contents)
        elif action in ("next wind", "wind before") and self.winds:
            self.wind = after(self.wind, self.winds, -1 if action == "wind before" else 1)
            self.asked.append("wind")
        elif action == "next ship" and len(self.ships) > 1:
            self.ship, self.person = after(self.ship, self.ships), None
        elif action == "rudder amidships" and self.person is not None:
            self.person.give(self.person.throttle, 0.0)
        elif action in ("reset", "rewind", "snapshot"):
            self.asked.append(action)

    def hold(self, keys: set[str], seconds: float) -> None:
        """Keys of the helm that were held for so long [s]."""
        pedal, wheel = (sum(HELM[key][k] for key in keys if key in HELM) for k in range(2))
        self.steer(pedal, wheel, seconds)

    def steer(self, pedal: float, wheel: float, seconds: float) -> None:
        """Pedal, ahead positive, and wheel, to port positive, -1 to 1, that were held for so long [s]; the first touch
        takes the helm from the scene's controls."""
        if not pedal and not wheel:
            return
        if self.person is None:
            if "helm" not in self.asked:
                self.asked.append("helm")
            return
        person = self.person
        person.give(person.throttle + seconds * PEDAL * pedal, person.rudder + seconds * WHEEL * wheel)

    def orbit(self, right: float, up: float) -> None:
        """The mouse was dragged, in parts of the picture."""
        self.azimuth -= 3.0 * right
        self.height = min(max(self.height - 2.0 * up, radians(2.0)), STEEPEST)

    def nearer(self, factor: float) -> None:
        """Come nearer (a factor below 1) or go away."""
        self.distance = min(max(self.distance * factor, CLOSEST), FARTHEST)

    def take(self, action: str) -> bool:
        """Whether this was asked for; it is no longer."""
        if action not in self.asked:
            return False
        self.asked.remove(action)
        return True

    def bind(self, sliders: list[Slider]) -> None:
        """Sliders of a simulation that was built anew: they keep what a person had set."""
        before = {slider.label: slider.value for slider in self.sliders}
        self.sliders = sliders
        for slider in sliders:
            slider.move(before.get(slider.label, slider.value))


def after(name: str, names: Sequence[str], step: int = 1) -> str:
    """The next of some names, round and round; the first where `name` is none of them."""
    return names[(names.index(name) + step) % len(names)] if name in names else names[0]


WORDS = {"courant_number": ("Courant number", 1.0), "dt": ("time step [ms]", 1e-3)}  # and the unit that is shown


def sliders_of(simulation: Subject) -> list[Slider]:
    """What may be moved in this simulation without building it anew."""
    found = []
    fluid, time_step = simulation.fluid, simulation.time_step
    if not simulation.scene.wind.still:
        found.append(Slider("wind strength, x the preset", 1.0, 0.0, 3.0, simulation.wind.strengthen))
    for name, (now, unit) in fluid.adjustable.items():
        ends = (0.25 * now, 4.0 * now) if name == "stiffness" else (0.0, max(4.0 * now, 1.0))

        def adjust(value: float, name: str = name) -> None:
            fluid.adjust(**{name: value})
            simulation.next_dt = time_step.next(simulation)

        found.append(Slider(f"{name.replace('_', ' ')} [{unit}]", now, *ends, adjust))
    for name, (now, _) in time_step.adjustable.items():
        label, shown = WORDS[name]

        def pace(value: float, name: str = name, shown: float = shown) -> None:
            time_step.adjust(**{name: value * shown})
            simulation.next_dt = time_step.next(simulation)

        given = now / shown
        found.append(Slider(label, given, 0.2 * given, 1.6 * given, pace))
    return found

"""State of a preview that a person sets: pause, camera, content, wind and helm; it knows no window."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import degrees, radians
from textwrap import wrap
from typing import Any

from ocean_sim.pictures.live.preview_scene import Balls, Subject

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
KEYS_IN_WORDS = """
space  pause or go on     n  one step
r  reset      w  back by some moments
c  next camera     z  camera back
v  surface, particles or both
m, b  next, previous wind (restarts)
o  record or stop        p  snapshot
u  hide this panel     Escape  close
drag  orbit       q, e  nearer, away"""
HELM_IN_WORDS = """
Up, Down  throttle, brake
Left, Right  port, starboard
x  rudder amidships    h  next ship"""
HELM = {  # throttle pedal, brake pedal, wheel to port and to starboard
    "Up": (1.0, 0.0),
    "Down": (-1.0, 0.0),
    "Left": (0.0, 1.0),
    "Right": (0.0, -1.0),
}
PEDAL_RATE, WHEEL_RATE = 0.5, radians(20.0)  # [1/s], [rad/s] by which an order changes while a key is held
FIRST_AZIMUTH, FIRST_HEIGHT = radians(38.0), radians(20.0)  # [rad] of the eye
STEEPEST_VIEW, CLOSEST_VIEW, FARTHEST_VIEW = radians(85.0), 0.2, 4.0
LINE_LETTERS, MESSAGE_LINES = 38, 12


@dataclass
class Panel:
    """Settings of a preview, and the effect of each key on them."""

    winds: list[str]
    """Names of the presets of wind."""
    wind: str
    camera: str = "third_person"
    content: str = "surface"
    contents: tuple[str, ...] = CONTENTS
    cameras: tuple[str, ...] = CAMERAS
    paused: bool = False
    recording: bool = False
    closed: bool = False
    hidden: bool = False
    azimuth: float = FIRST_AZIMUTH  # of the eye around its target [rad]
    height: float = FIRST_HEIGHT  # of the eye over the horizon [rad]
    distance: float = 1.0  # over that at which everything is in the picture
    message: str = ""
    """Sentence about the last failure."""
    ships: tuple[str, ...] = ()
    ship: str = ""
    """Name of the ship that is steered and followed."""
    person: Any = None
    """The `Person` at her helm, once a key was held: `give(throttle, rudder)`."""
    asked: list[str] = field(default_factory=list)
    """Actions due before the next picture: step, reset, rewind, wind, snapshot, helm."""

    def press(self, key: str) -> None:
        """Do the action of a key; unknown keys do nothing."""
        if key in KEYS:
            self.do(KEYS[key])

    def do(self, action: str) -> None:
        """Do an action of KEYS."""
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
            self.azimuth, self.height, self.distance = FIRST_AZIMUTH, FIRST_HEIGHT, 1.0
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
        """Turn wheel and throttle by keys held for some seconds; the first touch takes the helm from the scene's
        controls."""
        pedal, wheel = (sum(HELM[key][k] for key in keys if key in HELM) for k in range(2))
        if not pedal and not wheel:
            return
        if self.person is not None:
            throttle, rudder = self.person.throttle, self.person.rudder
            self.person.give(throttle + seconds * PEDAL_RATE * pedal, rudder + seconds * WHEEL_RATE * wheel)
        elif "helm" not in self.asked:
            self.asked.append("helm")

    def orbit(self, right: float, up: float) -> None:
        """Turn the eye as the mouse was dragged, in shares of the picture."""
        self.azimuth -= 3.0 * right
        self.height = min(max(self.height - 2.0 * up, radians(2.0)), STEEPEST_VIEW)

    def zoom(self, factor: float) -> None:
        """Multiply the distance of the eye."""
        self.distance = min(max(self.distance * factor, CLOSEST_VIEW), FARTHEST_VIEW)

    def take(self, action: str) -> bool:
        """True if an action was asked for; it is no longer."""
        if action not in self.asked:
            return False
        self.asked.remove(action)
        return True

    def words(self, simulation: Subject, balls: Balls | None, pace: float | None) -> str:
        """Text of the panel; `pace`: simulated over wall time."""
        state = "paused" if self.paused else "" if pace is None else f"{pace:.2g} x real time"
        water = simulation.fluid.particles
        lines = [
            f"t = {simulation.time:.2f} s  {state}{'  recording' if self.recording else ''}",
            "closed form, no particles" if water is None else f"{water.n} particles, {simulation.fluid.config.kind}",
            f"wind: {self.wind}",
            f"camera: {self.camera}",
            f"shown: {self.content}",
        ]
        if not simulation.scene.wind.still:
            lines.append("yellow: where it blows  red: push")
        if balls is not None:
            part = f", 1 of {balls.every}" if balls.every > 1 else ""
            lines.append(f"dark to bright: 0 to {balls.fastest:.2g} m/s{part}")
        if self.ship:
            throttle, rudder = simulation.ships[self.ship].orders
            by = "hand" if self.person is not None else "the scene"
            lines.append(f"{self.ship}, steered by {by}:")
            lines.append(f"throttle {throttle:+.2f}  rudder {degrees(rudder):+.0f} deg")
            lines.append(HELM_IN_WORDS)
        return "\n".join([*lines, KEYS_IN_WORDS, "", *wrap(self.message, LINE_LETTERS)[:MESSAGE_LINES]])


def after(name: str, names: Sequence[str], step: int = 1) -> str:
    """The next of some names, round and round; the first where `name` is none of them."""
    return names[(names.index(name) + step) % len(names)] if name in names else names[0]

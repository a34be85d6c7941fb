"""State of the preview window that the user sets: pause, camera, content and helm. It does not depend on a window."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import degrees, radians
from textwrap import wrap
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation

KEY_TEXT = """
space  pause or go on     n  one step
r  reset      c  next camera
v  surface, particles or both
p  snapshot     Escape  close
drag  orbit       q, e  nearer, away"""
HELM_TEXT = """
Up, Down  throttle, brake
Left, Right  port, starboard
x  rudder amidships    h  next ship"""
REQUEST_KEYS = {"n": "step", "r": "reset", "p": "snapshot"}  # actions of the preview loop
HELM_KEYS = {"Up": (1.0, 0.0), "Down": (-1.0, 0.0), "Left": (0.0, 1.0), "Right": (0.0, -1.0)}  # throttle; wheel to port
PEDAL_RATE, WHEEL_RATE = 0.5, radians(20.0)  # [1/s], [rad/s] of an order while a key is held
MIN_EYE_HEIGHT, MAX_EYE_HEIGHT = radians(2.0), radians(85.0)  # [rad] over the horizon
MIN_EYE_DISTANCE, MAX_EYE_DISTANCE = 0.2, 4.0  # over that at which everything is in the picture
LINE_LETTERS, MESSAGE_LINES = 38, 12


@dataclass
class Panel:
    """User settings of a preview window, and the effect of each key and mouse drag on them."""

    camera: str = "third_person"
    content: str = "surface"
    ship: str = ""
    """Name of the ship that is steered and followed."""
    cameras: tuple[str, ...] = ("third_person", "helm", "top", "side")
    contents: tuple[str, ...] = ("surface", "particles", "both")
    ships: tuple[str, ...] = ()
    paused: bool = False
    closed: bool = False
    hidden: bool = False
    azimuth: float = radians(38.0)  # of the eye around its target [rad]
    height: float = radians(20.0)  # of the eye over the horizon [rad]
    distance: float = 1.0  # over that at which everything is in the picture
    message: str = ""
    """Sentence about the last failure."""
    person: Any = None
    """The `Person` at her helm, once a key was held: `give(throttle, rudder)`."""
    requests: set[str] = field(default_factory=set)
    """Actions due before the next picture: step, reset, snapshot, helm."""

    def offer(self, cameras: tuple[str, ...], contents: tuple[str, ...], ships: tuple[str, ...]) -> None:
        """Set the names of cameras, contents (surface, particles or both) and ships that can be chosen by keyboard; a
        present choice that is not among them becomes the first."""
        self.cameras, self.contents, self.ships, self.person = cameras, contents, ships, None
        chosen = (self.camera, cameras), (self.content, contents or ("surface",)), (self.ship, ships or ("",))
        self.camera, self.content, self.ship = (name if name in names else names[0] for name, names in chosen)

    def press(self, key: str) -> None:
        """Do the action of a key (see KEY_TEXT, HELM_TEXT), or add it to `requests` for others; ignore other keys."""
        match key:
            case " ":
                self.paused = not self.paused
            case "Escape":
                self.closed = True
            case "c":
                self.camera = next_name(self.camera, self.cameras)
            case "v":
                self.content = next_name(self.content, self.contents)
            case "h" if len(self.ships) > 1:
                self.ship, self.person = next_name(self.ship, self.ships), None
            case "x" if self.person is not None:
                self.person.give(self.person.throttle, 0.0)
            case _ if key in REQUEST_KEYS:
                self.paused = self.paused or key == "n"
                self.requests.add(REQUEST_KEYS[key])

    def hold(self, keys: set[str], seconds: float) -> None:
        """Change throttle and rudder by helm keys held for `seconds`. Before the helm is the user's (`person`), add
        "helm" to `requests` instead, and it will be given before the next picture."""
        pedal, wheel = (sum(HELM_KEYS[key][k] for key in keys if key in HELM_KEYS) for k in range(2))
        if not pedal and not wheel:
            return
        if self.person is not None:
            throttle, rudder = self.person.throttle, self.person.rudder
            self.person.give(throttle + seconds * PEDAL_RATE * pedal, rudder + seconds * WHEEL_RATE * wheel)
        else:
            self.requests.add("helm")

    def orbit(self, right: float, up: float) -> None:
        """Turn the eye around its target by a mouse drag; `right`, `up`: shares of the picture's width and height."""
        self.azimuth -= 3.0 * right
        self.height = min(max(self.height - 2.0 * up, MIN_EYE_HEIGHT), MAX_EYE_HEIGHT)

    def zoom(self, factor: float) -> None:
        self.distance = min(max(self.distance * factor, MIN_EYE_DISTANCE), MAX_EYE_DISTANCE)

    def take(self, action: str) -> bool:
        """Remove an action such as "step" from the user's requests; True if it was among them."""
        requested = action in self.requests
        self.requests.discard(action)
        return requested

    def text(self, simulation: "Simulation", fastest: float | None, pace: float | None) -> str:
        """Text of the panel; `fastest`: particle speed [m/s] of the last colour; `pace`: simulated over real time."""
        state = "paused" if self.paused else "" if pace is None else f"{pace:.2g} x real time"
        water = simulation.fluid.particles
        lines = [
            f"t = {simulation.time:.2f} s  {state}",
            "closed form, no particles" if water is None else f"{water.n} particles, {simulation.fluid.config.kind}",
            f"camera: {self.camera}",
            f"shown: {self.content}",
        ]
        if fastest is not None:
            lines.append(f"dark to bright: 0 to {fastest:.2g} m/s")
        if self.ship:
            throttle, rudder = simulation.ships[self.ship].orders
            lines.append(f"{self.ship}, steered by {'hand' if self.person is not None else 'the scene'}:")
            lines.append(f"throttle {throttle:+.2f}  rudder {degrees(rudder):+.0f} deg")
            lines.append(HELM_TEXT)
        return "\n".join([*lines, KEY_TEXT, "", *wrap(self.message, LINE_LETTERS)[:MESSAGE_LINES]])


def next_name(name: str, names: Sequence[str]) -> str:
    """Name that follows `name` in a cycle through `names`; the first if `name` is not among them."""
    return names[(names.index(name) + 1) % len(names)] if name in names else names[0]

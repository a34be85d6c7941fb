"""Options of the pictures of a run, and the exception for a failed one."""

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import Field, field_validator

from ocean_sim.conventions import Failed
from ocean_sim.model import Model, Vector3, quantity
from ocean_sim.pictures.stage.camera import CameraName

DEFAULT_SIZE = 1280, 720  # [pixels] of a picture whose size no scene names
Quality = Literal["draft", "final"]
StillTime = Annotated[float, Field(ge=0.0, strict=False)]


class RenderFailed(Failed):
    """A picture could not be drawn; the message gives the reason."""


class Drawing(Model):
    """Options for the pictures of a run that a scene may set: camera, size, frames and contents."""

    camera: CameraName = "third_person"
    """`third_person` sees the whole basin, in a long one of open sea the ship; `follow` is behind the ship,
    `first_person` at its helm; `orbit` goes around in a film; `fixed` is at `eye`; `top`, `side`."""
    eye: Vector3 | None = quantity("m", None)
    """Position of the fixed camera."""
    target: Vector3 | None = quantity("m", None)
    """Target of the fixed camera."""
    ship: str | None = None
    """The name of the ship that a camera follows; null: the first."""
    size: tuple[int, int] | None = Field(None, strict=False, json_schema_extra={"unit": "pixels"})
    """Width and height of the pictures, even numbers; null: 1280 x 720, of a long slice less high."""
    particles: bool = False
    """Draw the particles, coloured by speed, in place of the surface of the water."""
    quality: Quality = "draft"
    """`draft`: quick; `final`: a finer mesh and four samples of each pixel."""
    far_sea: bool = True
    """Draw the sea around the basin out to the horizon; without it, a block of water with cut sides. A basin that
    moves, has a wavemaker, a lid or obstacles, runs dry somewhere or is up to 12 m long is a tank: it stays a block,
    and so does a surface that folds."""
    ripples: bool = True
    """Draw waves finer than the particles, of the wind's strength and heading."""
    foam: bool = True
    """Draw white water on crests that converge, along the hull, and spray."""
    foam_cover: float | None = quantity("1", None, ge=0.0, le=0.5)
    """Share of the sea that is white, as measured under a wind; by default what its crests call for."""
    sky: bool = True
    """Draw a scattered sky with clouds; without it, a clear gradient."""
    caption: bool = True
    """Write the time into the pictures."""
    outline: bool = False
    """Draw where the basin ends, on the water."""
    scale_bar: bool = False
    """Draw a scale bar in metres, right at the ship or else in the middle of the basin; from `top` also a bar with
    the colours of heights, and with `wind` what an arrow stands for."""
    wind: bool = False
    """Draw where the wind blows, as tinted volumes with an arrow along what it does there, and a cross where it is
    nothing but noise."""
    film: bool = True
    """Make film.mp4."""
    stills: list[StillTime] = Field([], strict=False, json_schema_extra={"unit": "s"})
    """Times of further pictures, still_<time>.png each."""
    strip: int = Field(0, ge=0, le=24)
    """Make strip.png of so many pictures side by side, from the beginning to the end."""

    @field_validator("size")
    @classmethod
    def even(cls, size: tuple[int, int] | None) -> tuple[int, int] | None:
        if size is not None and any(n % 2 or not 64 <= n <= 7680 for n in size):
            raise ValueError(f"a film needs an even width and height between 64 and 7680 pixels, not {list(size)}")
        return size

    def contradictions(self) -> Iterator[str]:
        if self.camera == "fixed" and (self.eye is None or self.target is None):
            yield "a fixed camera needs an eye and a target, [x, y, z] in metres each"
        if self.camera != "fixed" and not (self.eye is None and self.target is None):
            yield f"eye and target belong to the camera fixed, not to {self.camera}"
        if self.camera == "fixed" and self.eye == self.target:
            yield "a fixed camera cannot look at its own position; let eye and target differ"


class Order(Drawing):
    """Request for the pictures of a run: the options that a scene may set, the run's folder, the one for the pictures,
    and switches of the water's look (mirrored sky, glint of the sun, light from within)."""

    folder: str
    out: str
    every: float = 0.033  # [s] of simulated time between pictures of the film
    painters: int = 1  # processes that draw the film by turns
    preview: bool = True
    fresnel: bool = True  # of the water: else a constant share of the sky is mirrored
    glint: Literal["physical", "thesis", "none"] = "physical"  # of the sun in the water
    reflection: bool = True  # of the sky in the water
    body: bool = True  # light from within the water

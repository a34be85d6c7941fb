"""Options of the pictures of a run, and the exception for a failed one."""

from dataclasses import dataclass
from typing import Literal

from ocean_sim.conventions import Failed
from ocean_sim.pictures.stage.camera import CameraName

Quality = Literal["draft", "final"]


class RenderFailed(Failed):
    """A picture could not be drawn; the message gives the reason."""


@dataclass(frozen=True)
class Order:
    """Options for drawing the pictures of a run: folders, camera, size, frames and contents."""

    folder: str
    out: str
    camera: CameraName = "third_person"
    size: tuple[int, int] = (1280, 720)
    particles: bool = False
    quality: Quality = "draft"
    every: float = 0.033
    film: bool = True
    eye: tuple[float, float, float] | None = None
    target: tuple[float, float, float] | None = None
    stills: tuple[float, ...] = ()
    strip: int = 0
    painters: int = 1  # processes that draw the film by turns
    ship: str | None = None  # the name of the one that the camera follows; None: the first
    preview: bool = True
    caption: bool = True
    outline: bool = False  # of the basin, on the water
    scale_bar: bool = False
    wind: bool = False  # volumes and arrows of the wind
    far_sea: bool = True
    ripples: bool = True
    foam: bool = True
    sky: bool = True
    fresnel: bool = True  # of the water: else a constant share of the sky is mirrored
    glint: Literal["physical", "thesis", "none"] = "physical"  # of the sun in the water
    reflection: bool = True  # of the sky in the water
    body: bool = True  # light from within the water
    foam_cover: float | None = None  # share of the sea that is white; None: what its crests call for

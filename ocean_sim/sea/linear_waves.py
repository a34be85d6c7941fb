"""A sea by linear theory: calm, regular, random, or a list of plane waves."""

from typing import Literal

from ocean_sim.sea import Written


class Config(Written):
    """Calm water, regular waves (`height`, `period`, `heading_deg`) or a `spectrum`, and more `spectra` on top. Random
    waves shorter than ten particle spacings are left out with their part of the height; `check` says how much."""

    kind: Literal["linear_waves"] = "linear_waves"

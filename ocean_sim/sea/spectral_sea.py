"""A nonlinear sea, evolved in time on a tile as large as the patch: what `fluid.kind: spectral_sea` is at order 3."""

from typing import Literal

from ocean_sim.basin.open_sea import MOST_PARTS, Nonlinear, width_over_length
from ocean_sim.model import Faults
from ocean_sim.parts import SceneFacts
from ocean_sim.sea import Written
from ocean_sim.waves.seas import Steepening


class Config(Steepening, Written):
    """Regular waves (`height`, `period`, `heading_deg`) or a `spectrum`, and more `spectra` on top: nonlinear up to the
    third order in their slope. Random waves shorter than ten particle spacings are left out at the start, with their
    part of the height; `check` says how much."""

    kind: Literal["spectral_sea"] = "spectral_sea"
    order: Literal[1, 3] = 3
    """`3`: nonlinear up to the third order in its slope, on a cell a particle spacing; `1`: linear, as
    `linear_waves`."""

    @property
    def nonlinear(self) -> Nonlinear | None:
        if self.order == 1 or self.highest is None:
            return None
        return Nonlinear(self.onset_in(self.highest[1]), self.breaking)

    def problems(self, preflight: SceneFacts) -> Faults:
        found = list(super().problems(preflight))
        yield from found
        if not found and self.nonlinear is not None and width_over_length(preflight.tank.periods) is None:
            sentence = f"the sides of the patch are not multiples of one cell; take a ratio of at most {MOST_PARTS}"
            yield ("kind",), f"{sentence}, or kind linear_waves"

"""The sea around a patch of particles: every module of this folder is a kind that a scene may name."""

from ocean_sim import waves
from ocean_sim.basin.open_sea import Rim
from ocean_sim.model import Faults, quantity
from ocean_sim.parts import SceneFacts, SeaConfig
from ocean_sim.waves.seas import Seas


class Written(Seas, SeaConfig):
    """Calm water, regular waves (`height`, `period`, `heading_deg`) or a `spectrum`, and more `spectra` on top. Random
    waves shorter than ten particle spacings are left out with their part of the height; `check` says how much."""

    rim: Rim = Rim()
    feed: float | None = quantity("1/s", None, ge=0.0)
    """Rate at which the velocity of the sea is added to that of all water, which holds the waves up between the rims;
    null: what the scheme takes from waves of each length, and by how much it delays them, as far as that has been
    measured; 0: none, but for what lets the sea grow over its `ramp`."""

    @property
    def significant_height(self) -> float:
        """Significant height of the highest wave train [m]; 0 in calm water."""
        return 0.0 if self.highest is None else self.highest[0]

    ramp: float | None = quantity("s", None, ge=0.0)
    """Time over which the sea grows on the whole patch, from calm water; null: two periods of the highest waves
    where a ship is in the water, since waves that are there at once would run through her; else 0, at once."""

    def plane_waves(self, basin: waves.Tank) -> waves.Components | None:
        sea = self.sea_of(basin)
        return sea if sea.amplitude.any() else None

    def problems(self, preflight: SceneFacts) -> Faults:
        yield from self.sea_faults(preflight.tank) or super().problems(preflight)
        if preflight.tank.ground is not None:
            yield ("kind",), "a patch of open sea lies over a flat bed; leave the shape of basin.floor out"

    def warnings(self, preflight: SceneFacts) -> list[str]:
        return [*self.like_radians(), *super().warnings(preflight)]

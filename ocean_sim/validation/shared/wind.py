"""What the cases of wind share: a stress of so many Pa, and the same water under still air."""

from ocean_sim.parts import config_of
from ocean_sim.reading.scene import SceneConfig
from ocean_sim.simulation import Simulation

U10 = 10.0  # [m/s]
REAL = 0.177625  # [Pa] its stress by Wu (1982) in air of 1.225 kg/m3


def blowing(stress: float, **keys: float) -> dict:
    """A wind along +x."""
    return {"kind": "stress", "u10": U10, "heading_deg": 90.0, "gain": stress / REAL, **keys}


def stilled(simulation: Simulation) -> Simulation:
    """The same scene without wind, from the start."""
    assert isinstance(simulation.scene, SceneConfig)
    return Simulation(
        simulation.scene.model_copy(update={"wind": config_of("wind", "still").model_validate({"kind": "still"})})
    )

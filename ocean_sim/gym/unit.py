"""A boat in a random sea as a functional mock-up unit, FMI 2.0 co-simulation: helm and throttle in, motions out.

`python -m ocean_sim.gym.unit FOLDER` writes `OceanBoat.fmu` (extra `fmi`). The unit holds no interpreter: the machine
that runs it needs Python with `ocean-sim` and `pythonfmu`. Parameters are the sea's significant height [m], peak period
[s], heading [deg] and seed; outputs are surge, sway, heave [m], roll, pitch, yaw [rad] in the axes of the world (x to
the bow of heading 0, y to port, z up), the speed [m/s] and the elevation under the bow [m].
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ocean_sim.gym.boats import WAVE_COUNT, Boat, Boats, random_sea

try:
    from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real
except ImportError:
    raise ImportError("ocean_sim.gym.unit needs pythonfmu: pip install 'ocean-sim[fmi]'") from None

USAGE = "usage: python -m ocean_sim.gym.unit [FOLDER]\nWrites OceanBoat.fmu into the folder, by default this one."
WATER_DEPTH, MAX_STEP = 50.0, 0.1  # [m], and at most [s] at once
INPUT_NAMES = ("helm", "throttle")
OUTPUT_NAMES = ("surge", "sway", "heave", "roll", "pitch", "yaw", "speed", "elevation")
PARAMETERS = {"significant_height": 1.0, "peak_period": 6.0, "heading_deg": 0.0, "seed": 0.0}


class OceanBoat(Fmi2Slave):
    """Functional mock-up unit of one boat; it divides the master's steps into steps of at most MAX_STEP [s]."""

    author = "Ocean Sim"
    description = "A boat in a random sea"

    def __init__(self, **keys: Any) -> None:
        """Register parameters, inputs and outputs as FMI variables; `keys` are those of pythonfmu."""
        super().__init__(**keys)
        for name, value in PARAMETERS.items():
            setattr(self, name, value)
            cause = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.fixed}
            self.register_variable(Real(name, **cause))
        for names, causality in ((INPUT_NAMES, Fmi2Causality.input), (OUTPUT_NAMES, Fmi2Causality.output)):
            for name in names:
                setattr(self, name, 0.0)
                self.register_variable(Real(name, causality=causality))

    def exit_initialization_mode(self) -> None:
        """Start the boat in the sea of the parameters; the simulation master calls this once it has set them."""
        height, period, heading, seed = (float(getattr(self, name)) for name in PARAMETERS)
        sea, boat = random_sea(height, period, heading, WATER_DEPTH, int(seed)), Boat()
        self.boats = Boats(boat, 1, WAVE_COUNT, WATER_DEPTH)
        self.boats.begin(np.ones(1, dtype=bool), [sea], np.zeros(1), boat.cruise)
        self.set_outputs()

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Advance the boat by `step_size` [s]; returns False (FMI: error) unless all is finite, and the step >= 0."""
        if not np.isfinite([self.helm, self.throttle, step_size]).all() or step_size < 0.0:
            return False
        orders = np.clip(float(self.helm), -1.0, 1.0), np.clip(float(self.throttle), 0.0, 1.0)
        count = max(1, int(np.ceil(step_size / MAX_STEP - 1e-9)))
        for _ in range(count):
            self.boats.advance(np.array([orders[0]]), np.array([orders[1]]), step_size / count)
        self.set_outputs()
        return True

    def set_outputs(self) -> None:
        boats = self.boats
        (sway, surge), (roll, pitch) = boats.place[0].tolist(), boats.angles[0].tolist()
        motions = (surge, sway, boats.heave[0], roll, pitch, boats.heading[0], boats.speed[0])
        for name, value in zip(OUTPUT_NAMES, (*motions, boats.elevation_at_bow(0.0)[0])):
            setattr(self, name, float(value))


def main(words: Sequence[str]) -> int:
    """Write `OceanBoat.fmu` into the folder named on the command line, `words`; returns the exit code (2: error)."""
    from pythonfmu.builder import FmuBuilder

    if len(words) > 1 or any(word.startswith("-") for word in words):
        helped = "--help" in words
        print(USAGE, file=sys.stdout if helped else sys.stderr)
        return 0 if helped else 2
    folder = Path(*words)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        print(FmuBuilder.build_FMU(__file__, dest=folder))
    except OSError as error:
        print(f"{folder}: {error.strerror or error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

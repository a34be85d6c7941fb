"""A ship on waves in closed form, step by step: how fast her motion comes right as steps become short."""

import numpy as np

from ocean_sim.reading.scene import load, observer_names
from ocean_sim.ship.body.vessel import Vessel
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.ship import at_sea

QUIET = {name: None for name in observer_names() if name != "manifest"}


def heave(dt: float) -> np.ndarray:
    """Of a barge in waves of 6 s from ahead, every 0.2 s [m]."""
    ship = {"kind": "dynamic", "hull": "barge20", "cells_per_draught": 4}
    scene = at_sea(ship, 20.0, dt, height=1.0, period=6.0, heading_deg=180.0)
    rows, every = [], round(0.2 / dt)
    with Simulation(load(scene, QUIET)) as simulation:
        while simulation.time < 24.0:
            simulation.step()
            if simulation.steps % every == 0:
                rows.append(next(iter(simulation.ships.values())).body.position[1])
    return np.array(rows)


def test_the_error_of_a_step_falls_as_its_square(monkeypatch):
    """A negative control: with the velocities of half a step before, it falls as the step only."""
    exact = heave(0.0125)
    coarse, fine = (np.std(heave(dt) - exact) / exact.std() for dt in (0.1, 0.05))
    assert coarse < 0.01 and coarse > 3.0 * fine, (coarse, fine)
    monkeypatch.setattr(Vessel, "centred_body", property(lambda ship: ship.body))
    assert np.std(heave(0.1) - exact) / exact.std() > 2.0 * coarse

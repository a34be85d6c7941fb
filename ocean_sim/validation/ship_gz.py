"""Righting levers of three hulls at large heel, by the forces of the ship itself.

References by clipping polygons: a barge 20 x 8 x 4 m (draught 2 m, KG 2.5 m), Wigley's hull of 3 m (KG 0.12 m), and a
cylinder half under water, of which GZ = (R - KG) sin(heel) at every heel. The thesis's columns push on the vertical
through the hull's bottom, so its own lever is another: of its metacentric height only BM - KG is left.
"""

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, absolute_error
from ocean_sim.validation.shared.ship import COMPARED_SHIPS, at_sea, balance_heave, ship_of, turn_quaternion

RIGHTING_LEVERS = {  # by hull: heel [deg]: GZ [m]
    "barge20": {10: 0.20979, 20: 0.45944, 30: 0.76036, 40: 0.77401, 60: 0.37254, 90: -0.5},
    "wigley": {10: 0.00671, 20: 0.01356, 30: 0.02081, 40: 0.02897, 60: 0.04252},
    "cylinder": {heel: 0.2 * np.sin(np.radians(heel)) for heel in (10, 20, 30, 60, 90)},
}
HULL_SIZE = {"barge20": 20.0, "wigley": 3.0, "cylinder": 6.0}
COLUMN_LEVERS = {10: 0.022, 30: -0.095}  # heel [deg]: GZ [m] of a barge by the thesis's columns
SOURCE_TEXT = "hull sections clipped as polygons"


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: three hulls at two resolutions (coarse: one), and the barge on the thesis's water columns."""
    cells = ((8, 4.0),) if coarse else ((8, 4.0), (16, 2.0))
    return [*(hull_problem(hull, n, limit) for n, limit in cells for hull in RIGHTING_LEVERS), thesis_problem()]


def hull_problem(hull: str, cells: int, limit: float) -> Problem:
    """Set-up of a hull of RIGHTING_LEVERS with `cells` cubes over its draught; `limit`: tolerance of the lever [%]."""
    name = f"{hull}, {cells} cells"
    scene = at_sea({"hull": hull, "cells_per_draught": cells}, HULL_SIZE[hull], 0.01)
    promise = Promise(f"{name}: largest error of GZ", "%", SOURCE_TEXT, dict.fromkeys(COMPARED_SHIPS, limit))

    def measure(simulation: Simulation) -> Finding:
        """Compare the righting levers with the exact ones; the worst counts."""
        heels, exact = np.array(list(RIGHTING_LEVERS[hull])), np.array(list(RIGHTING_LEVERS[hull].values()))
        found = righting_levers(simulation, heels)
        error = 100.0 * (found / exact - 1.0)
        worst = int(np.abs(error).argmax())
        numbers = [(found[worst], exact[worst], error[worst])]
        measured = [Curve("GZ", heels, found, points=True)]
        return Finding(numbers, measured, [Curve("exact", heels, exact)], ("heel [deg]", "GZ [m]"))

    return Problem(scene, (promise,), measure, name, slot="ship", schemes=("hydrostatic",))


def thesis_problem() -> Problem:
    """Set-up of the barge carried by columns of water that push on the vertical line through the hull's bottom, as the
    thesis prints; compared with the righting levers that such columns have."""
    scene = at_sea({"hull": "barge20", "cells_per_draught": 16}, 20.0, 0.01)
    source, limit = "columns on the vertical through the bottom", {"thesis": 0.004}
    promises = tuple(Promise(f"as printed: GZ at {heel} degrees [m]", "m", source, limit) for heel in COLUMN_LEVERS)

    def measure(simulation: Simulation) -> Finding:
        found = righting_levers(simulation, np.array(list(COLUMN_LEVERS)))
        return Finding([absolute_error(*pair) for pair in zip(found, COLUMN_LEVERS.values(), strict=True)])

    return Problem(scene, promises, measure, "as printed", slot="ship", schemes=("thesis",))


def righting_levers(simulation: Simulation, heels: np.ndarray) -> np.ndarray:
    """Righting levers GZ (n,) [m] at heel angles (n,) [deg], with weight and buoyancy balanced at each."""
    weight = ship_of(simulation).body.mass * 9.81
    return np.array([-balance_heave(simulation, turn_quaternion(2, float(heel))).torque[2] / weight for heel in heels])

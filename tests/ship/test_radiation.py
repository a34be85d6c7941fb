"""The memory of radiated waves: what a table tells comes back out of it, and what it leaves untold is refused."""

from math import pi
from pathlib import Path

import numpy as np
import pytest

from ocean_sim import Simulation, load
from ocean_sim.files.csv_file import columns
from ocean_sim.reading.scene import SceneError
from ocean_sim.ship.shared.damping import Damping
from ocean_sim.ship.shared.radiation import Memory, Radiation
from ocean_sim.validation.shared.ship import at_sea, posed, voyage
from ocean_sim.validation.shared.tables import place

SPHERE, BARGE = place("sphere_radiation"), place("barge20_radiation")
HALF = 2.0 / 3.0 * pi * 1000.0 * 5.0**3  # [kg] of water that the sphere displaces


def test_a_hemisphere_that_heaves_at_once_takes_half_of_its_displacement_along():
    """Hulme 1982: A(infinity) is 1/2 in closed form; the table ends at K a = 10."""
    assert Radiation(str(SPHERE)).response.added[0] == pytest.approx(0.5 * HALF, rel=0.005)


@pytest.mark.parametrize("file, motions", [(SPHERE, ["heave"]), (BARGE, ["heave", "pitch"])])
def test_what_the_table_tells_comes_back(file, motions):
    told, found = columns(file), Radiation(str(file)).response
    omega, t = told["omega_rad_s"], found.times
    for k, motion in enumerate(motions):
        unit = "kg" if motion == "heave" else "kg_m2"
        added, damping = told[f"{motion}_added_{unit}"], told[f"{motion}_damping_{unit}_s"]
        cosines = np.trapezoid(found.kernels[k] * np.cos(omega[:, None] * t), t, axis=1)
        sines = np.trapezoid(found.kernels[k] * np.sin(omega[:, None] * t), t, axis=1)
        np.testing.assert_allclose(cosines, damping, atol=0.03 * damping.max())
        np.testing.assert_allclose(found.added[k] - sines / omega, added, rtol=0.03)


def test_a_steady_oscillation_is_held_back_by_damping_and_carried_by_added_mass():
    """At one frequency the memory is -B v less (A - A(infinity)) times the acceleration, however steps fall."""
    omega = 1.2531  # K a = 0.8
    memory, random, time = Memory(Radiation(str(SPHERE))), np.random.default_rng(3), 0.0
    rows = []
    while time < 60.0:
        motion = np.zeros(6)
        motion[1] = np.cos(omega * time)
        if time > 45.0:
            rows.append((np.cos(omega * time), -omega * np.sin(omega * time), memory.load(time, motion)[0, 1]))
        memory.keep(time, motion)
        time += random.uniform(0.005, 0.04)
    speed, rate, force = np.array(rows).T
    (damping, added), *_ = np.linalg.lstsq(-np.stack([speed, rate], axis=1), force, rcond=None)
    told = columns(SPHERE)
    assert damping == pytest.approx(np.interp(omega, told["omega_rad_s"], told["heave_damping_kg_s"]), rel=0.03)
    exact = np.interp(omega, told["omega_rad_s"], told["heave_added_kg"])
    assert memory.response.added[0] + added == pytest.approx(exact, rel=0.03)
    assert len(memory.when) * memory.often < memory.response.times[-1] + 3.0 * memory.often  # it forgets


def test_a_sphere_let_go_a_little_swings_as_linear_theory_says():
    """Extrema of the Cummins equation, solved in the frequency domain with Hulme's coefficients."""
    ship = {"kind": "dynamic", "hull": "sphere", "free": ["heave"], "radiation": str(SPHERE)}
    with Simulation(load(at_sea(ship, 10.0, 0.02))) as simulation:
        rest = simulation.ship.body.position.copy()
        posed(simulation, position=rest + [0.0, 0.05, 0.0])
        path = [(t, (b.position[1] - rest[1]) / 0.05) for t, b in voyage(simulation, 7.0)]
    t, y = np.array(path).T
    for time, height in ((2.21, -0.8670), (4.42, 0.6349), (6.60, -0.4648)):
        near = np.abs(t - time) < 0.6
        k = np.argmax(np.abs(y[near]))
        assert y[near][k] == pytest.approx(height, abs=0.015)
        assert t[near][k] == pytest.approx(time, abs=0.06)


def test_damping_beside_a_table_is_what_is_given_and_no_default():
    beside = Damping(roll=0.07).beside(["heave", "roll"])
    assert (beside.heave, beside.roll, beside.pitch) == (0.0, 0.07, Damping().pitch)


def changed(rows: list[str], what: str) -> list[str]:
    if what == "no damping":
        return [",".join(row.split(",")[:2]) for row in rows]
    if what == "not a number":
        return [*rows[:3], "0.9,much,3.0", *rows[4:]]
    if what == "frequencies fall":
        return [rows[0], *rows[:0:-1]]
    if what == "ends early":
        return rows[:6]
    if what == "no waves":
        return [rows[0], *(",".join([*row.split(",")[:2], "0"]) for row in rows[1:])]
    return ["a,b", "1,2", "2,3"]


@pytest.mark.parametrize(
    "what, sentence",
    [
        ("no damping", "has no column heave_damping_kg_s"),
        ("not a number", "holds what is not a number"),
        ("frequencies fall", "4 to 300 frequencies above 0 in rising order"),
        ("ends early", "the damping of heave still is 100% of its most"),
        ("no waves", "heave has no damping, so no waves to remember"),
        ("another table", "has no column of added mass, such as heave_added_kg"),
    ],
)
def test_a_table_that_tells_too_little_is_refused(tmp_path: Path, what, sentence):
    rows = [line for line in SPHERE.read_text().splitlines() if not line.startswith("#")]
    file = tmp_path / "table.csv"
    file.write_text("\n".join(changed(rows, what)))
    scene = at_sea({"kind": "dynamic", "hull": "sphere", "radiation": str(file)}, 10.0, 0.02)
    with pytest.raises(SceneError, match=r"ship\.radiation") as refused:
        load(scene)
    assert sentence in str(refused.value)

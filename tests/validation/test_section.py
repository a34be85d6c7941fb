"""The table of a section in waves: by the method that made it, which is held against closed forms."""

import numpy as np
import pytest
from panels import (
    AXIS,
    BOX,
    DENSITY,
    DEPTH,
    FLUME,
    LENGTH,
    MOTIONS,
    SECTION,
    SPRINGS,
    G,
    answers,
    by_reciprocity,
    drift,
    group_speed,
    solve,
)

from ocean_sim import Simulation, load, waves
from ocean_sim.files import csv_file
from ocean_sim.validation import section_in_waves
from ocean_sim.validation.shared.ship import at_sea, floating_ship
from ocean_sim.validation.shared.tables import table_path

UNITS = {"sway": "kg", "heave": "kg", "roll": "kg_m2"}


def test_a_semicircle_at_k_a_one_has_ursells_added_mass_and_damping():
    radius = 0.2
    omega = np.sqrt(G / radius)
    added, damping, _, _ = answers(omega, (0.4, radius, radius * (1.0 - 1e-9)), 1.0, 1.0)
    of_water = np.pi / 2.0 * DENSITY * radius**2
    assert added[1, 1] / of_water == pytest.approx(0.605, abs=0.003)
    assert damping[1, 1] / of_water / omega == pytest.approx(0.396, abs=0.005)


def test_without_slots_waves_push_as_reciprocity_demands():
    added, damping, scattered, undisturbed = answers(6.0, flume=LENGTH)
    assert np.abs(scattered + undisturbed) == pytest.approx(by_reciprocity(6.0, damping, LENGTH), rel=3e-3)
    assert added[0, 2] == pytest.approx(added[2, 0], rel=5e-3)
    push = scattered + undisturbed
    assert push[2] / push[0] == pytest.approx(damping[0, 2] / damping[0, 0], rel=3e-3)  # its sign, too


def test_waves_that_leave_have_the_energy_that_arrives_and_that_a_motion_gives():
    """R^2 + T^2 = 1 of the section held, and two waves carry away what the damping takes, without slots."""
    _, damping, _, _, left = solve(6.0, SECTION, LENGTH, LENGTH, 1, AXIS)
    assert (np.abs(left[:, 3]) ** 2).sum() == pytest.approx(1.0, abs=2e-3)
    power = DENSITY * G * group_speed(6.0) * LENGTH * (np.abs(left[:, :3]) ** 2).sum(axis=0)
    assert power == pytest.approx(np.diag(damping), rel=5e-3)


def test_the_table_of_drift_is_what_the_panels_say():
    """Short waves push as on a wall, by rho g a^2 / 2 a metre of the flume, long ones hardly."""
    table = csv_file.Table(table_path("section_drift"))
    row = int(np.flatnonzero(table["omega_rad_s"] == 7.0)[0])
    assert table["sway_N_m2"][row] == pytest.approx(drift(7.0, *SPRINGS), rel=1e-4)
    assert drift(16.0, *SPRINGS) == pytest.approx(0.5 * DENSITY * G * FLUME, rel=0.03)
    assert drift(3.0, *SPRINGS) < 0.02 * 0.5 * DENSITY * G * FLUME


@pytest.mark.parametrize("name, body", [("section_radiation", {}), ("box_radiation", BOX)])
def test_the_table_is_what_the_panels_say(name, body):
    table = csv_file.Table(table_path(name))
    row = int(np.flatnonzero(table["omega_rad_s"] == 7.0)[0])
    added, damping, scattered, _ = answers(7.0, **body)
    for k, motion in enumerate(MOTIONS):
        assert table[f"{motion}_added_{UNITS[motion]}"][row] == pytest.approx(added[k, k], rel=1e-4)
        assert table[f"{motion}_damping_{UNITS[motion]}_s"][row] == pytest.approx(damping[k, k], rel=1e-4)
        found = table[f"{motion}_scattered_90_re"][row] + 1j * table[f"{motion}_scattered_90_im"][row]
        assert abs(found - scattered[k]) < 1e-4 * abs(scattered[k])
    for name, whole in (("added_kg_m", added), ("damping_kg_m_s", damping)):
        assert table[f"sway_roll_{name}"][row] == pytest.approx(0.5 * (whole[0, 2] + whole[2, 0]), rel=1e-4)


def test_free_in_sway_and_roll_the_section_moves_as_coupled_potential_flow_says(monkeypatch):
    """(C - omega^2 (M + A) - i omega B) z = X of the panels, in waves of 1 mm; the lattice on which the ship asks the
    water accounts for 2 to 3 % (`section_in_waves`). Without what sway and roll do to each other roll is 36 % more."""
    monkeypatch.setattr(section_in_waves, "AMPLITUDE", 0.0005)
    ship = section_in_waves.section_keys(8) | {"kind": "dynamic", "free": list(MOTIONS)}
    ship |= {"radiation": str(table_path("section_radiation")), "damping": {"cross_flow": 0.0}}
    scene = at_sea(ship, 1.0, 0.01, heading_deg=90.0)
    scene["basin"]["depth"] = DEPTH
    period = 0.897
    with Simulation(load(scene)) as simulation:
        found, still = section_in_waves.wave_response(simulation, period), floating_ship(simulation).hydrostatics
    omega = 2.0 * np.pi / period
    added, damping, scattered, undisturbed = answers(omega)
    mass = np.diag([still.matter.mass, still.matter.mass, still.inertia["roll"]])
    stiffness = np.diag([0.0, still.stiffness["heave"], still.stiffness["roll"]])

    def moved(share: np.ndarray) -> np.ndarray:
        whole = stiffness - omega**2 * (mass + share * added) - 1j * omega * share * damping
        return np.abs(np.linalg.solve(whole, scattered + undisturbed))

    over = np.array([1.0, 1.0, float(waves.wavenumber(omega, DEPTH, G))])
    assert list(found.values()) == pytest.approx(list(moved(np.ones((3, 3))) / over), rel=0.04)
    assert moved(np.eye(3))[2] > 1.3 * moved(np.ones((3, 3)))[2]

"""The table of a section in waves: by the method that made it, which is held against closed forms."""

import numpy as np
import pytest
from panels import BOX, DENSITY, LENGTH, MOTIONS, G, answers, by_reciprocity

from ocean_sim.files import csv_file
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

"""The case of sections forced to roll: its references, the work that it measures, and what coarse particles give."""

from math import pi
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from ocean_sim.files import csv_file
from ocean_sim.validation import problems, roll_sections

SOURCE = Path(__file__).parents[1] / "ship" / "data" / "ikeda1978_sections.csv"
QUICK = {"runtime.threads": 1, "fluid.spacing": 0.01}  # 28 to the breadth
WAVES = 0.0036  # damping of B by waves alone, linear potential flow (panels.answers, axis at the waterline)


def test_the_references_are_rows_of_the_published_table():
    rows = csv_file.read_records(SOURCE.read_text())
    names = ("area_coefficient", "phi", "omega_hat", "total")
    published = {(row["model"], *(float(row[name]) for name in names)) for row in rows}
    assert set(map(tuple, roll_sections.MEASURED_SWINGS)) <= published
    for row in (row for row in rows if row["model"] in "AB"):
        assert (float(row["breadth_m"]), float(row["draught_m"])) == (
            roll_sections.SECTION_BREADTH,
            roll_sections.SECTION_DRAUGHT,
        )


def test_a_linear_torque_gives_its_own_coefficient_whatever_stiffness_and_inertia_add(monkeypatch):
    swing, told = roll_sections.MEASURED_SWINGS[1], {}
    period = 2.0 * pi / swing.omega
    damping = 0.03 * 1000.0 * 0.28 * 0.112 * 0.28**2 * np.sqrt(2.0 * 9.81 / 0.28)  # [N m s] a metre
    ship = SimpleNamespace(last=SimpleNamespace(torque=np.zeros(3)))
    run = SimpleNamespace(time=0.0, scene=SimpleNamespace(duration=4.0 * period), ships={"ship": ship})

    def step() -> None:
        roll, rate, turning = told.get("moved", (0.0, 0.0, 0.0))
        ship.last.torque[2] = -damping * rate - 5.0 * roll - 0.1 * turning
        run.time += period / 2000.0

    run.step = step
    monkeypatch.setattr(roll_sections, "impose_motion", lambda simulation, motion, moved: told.update(moved=moved))
    ((value, reference, _),) = roll_sections.measure_damping(run, swing).numbers
    assert value == pytest.approx(0.03, rel=2e-3) and reference == swing.damping


@pytest.mark.slow
def test_eddies_of_coarse_particles_take_part_of_what_was_measured_and_round_bilges_spare_some():
    sharp, _, rounded = problems("roll_sections", slow=True)
    box, bilged = (problem.run("roll_sections", "pressure", QUICK)[0][0] for problem in (sharp, rounded))
    assert 0.4 < box["value"] / box["reference"] < 0.6
    assert WAVES < bilged["value"] < 0.6 * box["value"]

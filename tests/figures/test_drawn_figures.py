"""Figures that only draw, in one process, and the data again in another; their numbers are those of closed forms."""

import csv
import os
import subprocess
import sys

import numpy as np
import pytest

from ocean_sim.conventions import Motions
from ocean_sim.parts import PACKAGE, kinds, library
from ocean_sim.studies.shared import study as table

DRAWN = ("fig2_1", "fig3_2", "fig3_7", "fig4_2", "fig4_3", "fig4_4", "fig6_4", "fig6_9", "fig6_10")
ALL = """
import runpy, sys
folder, out, pictures, *names = sys.argv[1:]
sys.path.insert(0, folder)
import _paper
if pictures == "no":
    import _kept
    _paper.save_figure = _kept.save_picture = lambda *what: None
    _kept.take_pictures = lambda folder, time, switched, **options: [[[[0]]]] * len(switched)
for name in names:
    sys.argv = [name, "--fast", "--out", out]
    runpy.run_path(f"{folder}/{name}.py", run_name="__main__")
"""


def draw(out, pictures: str, names) -> None:
    here = os.environ | {"PYTHONPATH": str(PACKAGE.parent)}
    command = [sys.executable, "-c", ALL, str(library("figures")), str(out), pictures, *names]
    done = subprocess.run(command, capture_output=True, text=True, env=here)
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def figures(tmp_path_factory):
    out = tmp_path_factory.mktemp("figures")
    draw(out, "yes", DRAWN)
    return out


def rows(path) -> list[dict[str, str]]:
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def numbers(path, *columns: str) -> np.ndarray:
    return np.array([[float(row[column]) for column in columns] for row in rows(path)])


def test_every_figure_has_its_data_and_its_picture(figures):
    for name in DRAWN:
        assert (figures / f"{name}.png").stat().st_size > 20_000, name
        assert len(rows(figures / f"{name}.csv")) > 4, name


def test_figure_3_2_has_the_fifteen_patterns_of_256_cases(figures):
    found = rows(figures / "fig3_2.csv")
    assert len(found) == 15 and sum(int(row["alike"]) for row in found) == 256


def test_every_picture_carries_number_and_caption_and_only_a_coarse_one_says_so(tmp_path):
    """`save_figure` is handed what a figure has; what it writes is read back from the figure's texts."""
    code = """
import sys
sys.path.insert(0, sys.argv[1])
from pathlib import Path
from _options import Said
from _paper import HASTY, WHOLE, paper, save_figure
for whole, width, found in ((False, 6.0, "12 cells"), (True, 6.0, "12 cells"), (False, 2.8, "Figure 9-9, wide")):
    Said.caption, Said.fast, Said.whole = "Figure 9-9: what it shows", True, whole
    figure = paper(width, 2.0)
    save_figure(figure, Path(sys.argv[2], "a.png"), found)
    words = " ".join(text.get_text() for text in [*figure.texts, figure._supxlabel]).replace(chr(10), " ")
    assert (HASTY in words) is not whole and (WHOLE in words) is whole, words
    assert "Figure 9-9" in words and found in words, words
"""
    here = os.environ | {"PYTHONPATH": str(PACKAGE.parent)}
    command = [sys.executable, "-c", code, str(library("figures")), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, env=here)
    assert done.returncode == 0, done.stderr


def test_maps_of_figures_and_of_the_camera_from_above_turn_alike():
    """A turn from x to z is seen the same way round, on paper and in pictures."""
    code = """
import sys
sys.path.insert(0, sys.argv[1])
import numpy as np
from _paper import paper, set_plan
from ocean_sim.pictures.stage.camera import camera_on_box
axes = paper(4.0, 4.0).subplots()
set_plan(axes, xlim=(-20.0, 20.0), ylim=(-20.0, 20.0))
origin, x, z = axes.transData.transform([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])
seen = camera_on_box("top", np.array([-20.0, -5.0, -20.0]), np.array([20.0, 2.0, 20.0]), 16 / 9)
across = np.cross(seen.forward, seen.up)
for drawn, axis in ((x - origin, [1.0, 0.0, 0.0]), (z - origin, [0.0, 0.0, 1.0])):
    assert np.allclose(np.sign(np.round(drawn, 6)), [np.round(across @ axis), np.round(seen.up @ axis)]), drawn
"""
    here = os.environ | {"PYTHONPATH": str(PACKAGE.parent)}
    command = [sys.executable, "-c", code, str(library("figures"))]
    done = subprocess.run(command, capture_output=True, text=True, env=here)
    assert done.returncode == 0, done.stderr


def test_a_map_of_stability_carries_its_caption_and_says_that_it_is_coarse(tmp_path):
    row = {"map": "spacing", "scheme": "mueller", "value": 0.1, "dt_s": 1e-3, "verdict": "stable", "acoustic_s": 2e-3}
    table.write_table(tmp_path / "study.csv", [row])
    code = """
import sys
sys.path.insert(0, sys.argv[1])
from matplotlib.figure import Figure
import stability
from _paper import HASTY
seen = []
Figure.savefig = lambda self, *_, **__: seen.append(" ".join(t.get_text() for t in [*self.texts, self._supxlabel]))
sys.argv = ["stability.py", "--fast", "--study", sys.argv[2] + "/study.csv", "--out", sys.argv[2]]
stability.main()
[words] = seen
assert "Stability of water" in words and "spacing" in words and HASTY in words, words
"""
    here = os.environ | {"PYTHONPATH": str(PACKAGE.parent)}
    command = [sys.executable, "-c", code, str(library("figures")), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, env=here)
    assert done.returncode == 0, done.stderr


def test_the_data_are_the_same_bytes_from_another_process(figures, tmp_path):
    names = [name for name in DRAWN if name not in ("fig3_2", "fig4_4")]  # they draw much and reckon little
    draw(tmp_path, "no", names)
    for name in names:
        assert (tmp_path / f"{name}.csv").read_bytes() == (figures / f"{name}.csv").read_bytes()


def test_figure_2_1_a_particle_cools_alone_and_a_place_sees_smoke_come_and_go(figures):
    time, place, along, x = numbers(figures / "fig2_1.csv", "time_s", "at_o_degC", "on_A_degC", "A_x_m").T
    aboard = np.isfinite(along)
    assert time[aboard][0] == pytest.approx(17.0)
    assert along[aboard] == pytest.approx(15.0 + 60.0 * np.exp(-(time[aboard] - 17.0) / 5.0), rel=1e-6)
    assert x[aboard] == pytest.approx(3.0 * (time[aboard] - 17.0), abs=1e-5)
    peaks = (place[1:-1] > place[:-2]) & (place[1:-1] > place[2:]) & (place[1:-1] > 20.0)
    assert 5 <= peaks.sum() <= 6 and place.min() == pytest.approx(15.0)  # twice in a swing of 12 s


@pytest.mark.parametrize(
    "angle, transmitted, exact, schlick",
    [
        (0.0, 0.0, 0.020373, 0.020373),
        (45.0, 32.036723, 0.027898, 0.022485),
        (60.0, 40.517591, 0.059691, 0.050987),
        (80.0, 47.628487, 0.347917, 0.397846),
        (90.0, 48.6066, 1.0, 1.0),
    ],
)
def test_figure_3_7_has_fresnels_numbers(figures, angle, transmitted, exact, schlick):
    """Fresnel's formulae for n = 1.333 in s and p polarisation apart; Schlick (1994)."""
    row = next(row for row in rows(figures / "fig3_7.csv") if float(row["incident_deg"]) == angle)
    assert float(row["transmitted_deg"]) == pytest.approx(transmitted, abs=1e-4)
    assert float(row["reflectance"]) == pytest.approx(exact, abs=1e-6)
    assert float(row["schlick"]) == pytest.approx(schlick, abs=1e-6)
    if angle == 0.0:
        assert row["thesis_3_8"] == row["listing"] == "nan"
    else:
        assert float(row["thesis_3_8"]) == pytest.approx(exact, abs=1e-6)
        assert float(row["listing"]) == pytest.approx(min(exact + 0.02, 1.0), abs=1e-6)


def test_figure_4_2_the_impulses_leave_momentum_alone_only_where_the_ball_takes_them_all(figures):
    response, speed, made, _ = numbers(
        figures / "fig4_2_response.csv", "response", "ball_y_m_s", "momentum_made_Ns", "energy_lost_J"
    ).T
    push = numbers(figures / "fig4_2.csv", "impulse_x_Ns", "impulse_y_Ns", "impulse_z_Ns")
    normal = numbers(figures / "fig4_2.csv", "normal_x", "normal_y", "normal_z")
    assert made == pytest.approx((1.0 - response) * np.linalg.norm(push.sum(axis=0)), rel=1e-5, abs=1e-6)
    body = 500.0 * 4.0 / 3.0 * np.pi * 4.0**3
    assert speed == pytest.approx(-2.0 - response * push.sum(axis=0)[1] / body, rel=1e-6)
    along = (push * normal).sum(axis=1)
    across = np.linalg.norm(push - along[:, None] * normal, axis=1)
    assert (along >= 0.0).all() and (across <= 0.5 * along * (1.0 + 1e-5) + 1e-6).all()  # Coulomb's cone
    steepest = normal @ [-0.4, 2.0, 0.0] < -1.9  # hit head-on: 1.5 m v over 1 + m / M, and no spin to speak of
    expected = 1.5 * 1953.125 * -(normal[steepest] @ [-0.4, 2.0, 0.0]) / (1.0 + 1953.125 / body)
    assert along[steepest] == pytest.approx(expected, rel=1e-5)


def test_figure_4_2_half_of_the_impulses_makes_energy_and_all_of_them_lose_it(figures):
    """The thesis's coefficient is 0.5."""
    names = ("energy_lost_J", "together_energy_lost_J", "together_momentum_made_Ns")
    alone, together, made = numbers(figures / "fig4_2_response.csv", *names)[[10, -1]].T
    assert alone[0] < together[0] < 0.0 < alone[1] < together[1]
    assert abs(made[1]) < 1e-6 and made[0] > 1e4


def test_figure_4_3_each_motion_does_what_the_conventions_say(figures):
    moved = {(row["motion"], row["place"]): row for row in rows(figures / "fig4_3.csv")}
    assert {motion for motion, _ in moved} == set(Motions._fields)
    assert float(moved["pitch", "bow"]["y_m"]) < -1.0 and float(moved["yaw", "bow"]["x_m"]) > 1.0
    assert float(moved["roll", "port side"]["y_m"]) > 0.5
    for motion, axis in (("sway", "x_m"), ("heave", "y_m"), ("surge", "z_m")):
        assert float(moved[motion, "keel"][axis]) == 2.0
    assert [moved["surge", "bow"][f"ned_{axis}"] for axis in "xyz"] == ["1", "0", "0"]


def test_figure_4_4_the_cubes_carry_the_ship(figures):
    buoyancy = numbers(figures / "fig4_4.csv", "buoyancy_N")
    assert buoyancy.sum() == pytest.approx(30.0e3 * 9.81, rel=1e-5)
    cells, lift, plain = numbers(
        figures / "fig4_4_cells.csv", "cells_per_draught", "lift_over_weight", "whole_cubes_lift_over_weight"
    ).T
    assert (np.abs(lift - 1.0) < 0.2 * np.abs(plain - 1.0)).all()
    assert (np.abs(lift[cells >= 6.0] - 1.0) < 1e-3).all()


def test_figure_6_4_foam_covers_what_was_measured_at_sea(figures):
    wind, wanted, drawn, thesis, expected = numbers(
        figures / "fig6_4.csv", "u10_m_s", "measured_at_sea", "drawn", "thesis", "thesis_closed_form"
    ).T
    assert wanted == pytest.approx(3.84e-6 * wind**3.41, rel=1e-6)
    assert drawn[wind >= 7.0] == pytest.approx(wanted[wind >= 7.0], rel=0.05)
    assert thesis == pytest.approx(expected, rel=0.1)
    assert expected[-1] > 0.4 and expected.max() < 0.5  # the thesis's rule makes half of any high sea white


def test_figure_6_9_has_the_stages_of_the_step(figures):
    stages = {row["stage"]: row for row in rows(figures / "fig6_9.csv")}
    assert list(stages)[:4] == ["wind", "fluid", "surface", "ship"]
    assert stages["fluid"]["reads"].split() == ["wind", "ship"]  # two-way: ships push the water
    assert stages["surface"]["reads"] == "fluid"  # one-way, and no wind
    assert {"wind", "fluid", "surface"} <= set(stages["ship"]["reads"].split())
    assert stages["ship"]["kinds"].split() == list(kinds("ship"))


def test_figure_6_10_legs_lead_back_to_the_pose(figures):
    table = rows(figures / "fig6_10.csv")
    assert max(float(row["error"]) for row in table) < 1e-8
    for motion in ("pitch", "roll", "yaw"):
        mine = [row for row in table if row["motion"] == motion]
        time = np.array([float(row["time_s"]) for row in mine])
        angle = np.array([float(row["angle_deg"]) for row in mine])
        assert angle == pytest.approx(12.0 * np.cos(2.0 * np.pi * time / 6.0), abs=1e-5)
        for leg in range(1, 7):
            length = np.array([float(row[f"leg{leg}_m"]) for row in mine])
            speed = np.array([float(row[f"leg{leg}_m_s"]) for row in mine])
            assert np.gradient(length, time)[1:-1] == pytest.approx(speed[1:-1], abs=1e-3)

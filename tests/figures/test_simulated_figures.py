"""Figures that simulate, in haste; one always, the others where there is time."""

import csv
import os
import subprocess
import sys

import numpy as np
import pytest

from ocean_sim.parts import PACKAGE, library


def drawn(name: str, out) -> list[dict[str, str]]:
    """The rows of a figure, made by its script."""
    command = [sys.executable, str(library("figures") / f"{name}.py"), "--fast", "--out", str(out)]
    here = os.environ | {"PYTHONPATH": str(PACKAGE.parent)}
    done = subprocess.run(command, capture_output=True, text=True, env=here)
    assert done.returncode == 0, done.stderr
    assert (out / f"{name}.png").stat().st_size > 20_000
    lines = [line for line in (out / f"{name}.csv").read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def test_figure_2_2_grid_and_particles_tell_of_the_same_wave(tmp_path):
    table = drawn("fig2_2", tmp_path)
    grid = [row for row in table if row["kind"] == "grid"]
    found = np.array([[float(row[name]) for name in ("u_m_s", "v_m_s")] for row in grid])
    theory = np.array([[float(row[f"theory_{name}"]) for name in ("u_m_s", "v_m_s")] for row in grid])
    assert np.sqrt(((found - theory) ** 2).sum() / (theory**2).sum()) < 0.2  # particles 20 to a wave
    assert len(table) - len(grid) == 100


@pytest.mark.slow
def test_figure_6_3_only_the_vortex_turns_the_water_and_fetch_raises_waves(tmp_path):
    rows = drawn("fig6_3", tmp_path)
    short, _, long = (float(row["hm0_m"]) for row in rows if row["what"] == "fetch [m]")
    assert long > 1.2 * short
    assert all(row["hm0_sd_m"] == "" for row in rows)  # of one seed
    assert all(float(row["still_over_hm0"]) < 0.05 for row in rows if row["what"] != "preset")
    table = {row["value"]: row for row in rows if row["what"] == "preset"}
    assert all((tmp_path / f"fig6_3_{name}.png").stat().st_size > 10_000 for name in table)
    turn = {name: abs(float(row["circulation_m2_s"])) for name, row in table.items()}
    assert turn["vortex"] > 3.0 * max(value for name, value in turn.items() if name != "vortex")
    assert all(float(row["hm0_m"]) > float(row["still_hm0_m"]) for row in table.values())


@pytest.mark.slow
def test_figure_6_8_ships_turn_to_the_side_of_the_rudder(tmp_path):
    table = drawn("fig6_8", tmp_path)
    otter = [row for row in table if "Otter" in row["voyage"]]
    yaw, rudder, ahead = (
        np.array([float(row[name]) for row in otter]) for name in ("yaw_deg", "rudder_deg", "speed_ahead_m_s")
    )
    turning = np.gradient(yaw, 0.1)
    assert turning[rudder > 5.0].mean() > 5.0 and turning[rudder < -5.0].mean() < -5.0
    assert 1.0 < ahead[-1] < 1.5
    assert len({row["voyage"] for row in table}) == 3


@pytest.mark.slow
def test_figure_6_5_each_switch_changes_the_light_as_it_should(tmp_path):
    table = {row["picture"]: row for row in drawn("fig6_5", tmp_path)}
    light = {name: float(row["mean_luminance"]) for name, row in table.items()}
    if len(set(light.values())) == 1:
        pytest.skip("no OpenGL on this machine: all pictures are grey")
    for rest in ("no white caps, no HDR", "with white caps, with HDR"):
        assert light[f"with Fresnel, {rest}"] < light[f"no Fresnel, {rest}"]  # water seen from above mirrors little
    for way in ("no", "with"):
        assert light[f"{way} Fresnel, with white caps, no HDR"] > light[f"{way} Fresnel, no white caps, no HDR"]
        glint = [float(table[f"{way} Fresnel, no white caps, {hdr} HDR"]["share_of_glint"]) for hdr in ("no", "with")]
        assert glint[1] > 2.0 * glint[0]
    assert (tmp_path / "fig6_5_bare.png").stat().st_size > 2_000


@pytest.mark.slow
def test_figure_6_7_ship_and_water_keep_their_momentum(tmp_path):
    table = drawn("fig6_7", tmp_path)
    both, walls, ship = (
        np.array([float(row[name]) for row in table]) for name in ("both_kg_m_s", "given_by_walls_Ns", "ship_kg_m_s")
    )
    assert ship[-1] < 0.97 * ship[0]  # it has given some away
    np.testing.assert_allclose(both - walls, both[0], rtol=0.03)  # 2.2 % with water this coarse


@pytest.mark.slow
def test_a_map_of_stability_in_haste_ends_with_a_verdict_at_each_of_its_points(tmp_path):
    """The script runs its own study where it is given none."""
    command = [sys.executable, str(library("figures") / "stability.py"), "--fast", "--out", str(tmp_path)]
    here = os.environ | {"PYTHONPATH": str(PACKAGE.parent)}
    done = subprocess.run(command, capture_output=True, text=True, env=here)
    assert done.returncode == 0, done.stderr
    rows = list(csv.DictReader((tmp_path / "stability.csv").open()))
    assert {float(row["dt_over_courant"]): row["verdict"] for row in rows} == {1.0: "stable", 4.0: "stopped"}
    assert (tmp_path / "stability_compression.png").stat().st_size > 20_000


@pytest.mark.slow
def test_speed_against_accuracy_in_haste_has_an_error_of_each_scheme(tmp_path):
    schemes = {row["scheme"] for row in drawn("speed_accuracy", tmp_path)}
    assert schemes >= {"mueller", "dfsph", "delta_sph", "cloth", "marching_cubes"}

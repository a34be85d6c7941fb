"""The map of stability: what it goes through, and verdicts that can be each of four."""

import csv
from pathlib import Path

import numpy as np
import pytest

from ocean_sim.__main__ import run_command_line
from ocean_sim.parts import compared
from ocean_sim.reading.scene import load
from ocean_sim.studies import reads_key
from ocean_sim.studies.shared import study
from ocean_sim.studies.stability import COLUMN_SCENE, EXTREME_AXES, grid_points, map_summary, verdict_of

TANK = """basin: {length: 1.0, depth: 0.5}
fluid: {kind: delta_sph, spacing: 0.1}
duration: 0.1
"""
DONE = {"outcome": "done", "reason": ""}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("tank.yaml").write_text(TANK)


@pytest.fixture(scope="module")
def scene():
    return load(COLUMN_SCENE | {"fluid": COLUMN_SCENE["fluid"] | {"kind": "mueller"}})


def table(gain: float = 0.0, dense: float = 0.0, given: float = 0.0) -> dict[str, np.ndarray]:
    """Energies that grow by a share of m v^2 = 250 kg x 9.81 m/s2 x 0.5 m, or a density that does."""
    scale, rise = 250.0 * 9.81 * 0.5, np.linspace(0.0, 1.0, 11)
    still = np.zeros(11)
    energies = {"kinetic_energy_J": gain * scale * rise, "potential_energy_J": still, "internal_energy_J": still}
    return energies | {"compression_mean": dense * rise, "work_wind_J": given * scale * rise}


def test_every_verdict_can_be_given(scene):
    assert verdict_of(DONE, table(0.005, 0.04), scene, False)[0] == "stable"
    said, why, numbers = verdict_of(DONE, table(gain=0.03), scene, False)
    assert said == "degraded" and why.startswith("energy from nowhere: 3 %")
    assert numbers["energy_gain"] == pytest.approx(0.03, rel=1e-6)
    assert verdict_of(DONE, table(dense=0.06), scene, False)[:2] == ("degraded", "mean compression 6 % (bound 5 %)")
    assert verdict_of({"outcome": "stopped", "reason": "too fast"}, {}, scene, False)[:2] == ("stopped", "too fast")
    assert verdict_of({"outcome": "failed", "reason": "SIGSEGV"}, {}, scene, False)[:2] == ("none", "SIGSEGV")


def test_a_number_that_is_none_is_never_stable(scene):
    assert verdict_of(DONE, table(gain=np.nan), scene, False)[0] == "degraded"
    assert verdict_of(DONE, table(dense=np.nan), scene, False)[0] == "degraded"


def test_under_a_wind_only_what_it_did_not_give_counts(scene):
    assert verdict_of(DONE, table(gain=5.0, given=5.0), scene, True)[0] == "stable"
    assert verdict_of(DONE, table(gain=5.0, given=4.98), scene, True)[0] == "degraded"


def test_a_map_goes_beyond_the_limits_that_theory_sets():
    plan = grid_points(True, "tank.yaml")
    assert {spot.axis.name for spot in plan} == {axis.name for axis in EXTREME_AXES} - {"mass ratio"}
    stiff = [spot for spot in plan if spot.axis.name == "compression" and spot.value == 0.0025]
    assert [spot.factor for spot in stiff] == [0.5, 1.0, 2.0, 4.0]
    assert stiff[0].dt < 0.6 * stiff[0].limits["acoustic"] < stiff[-1].limits["acoustic"] < stiff[-1].dt
    assert all(spot.scene.time_step.dt == pytest.approx(spot.dt) for spot in plan)
    thick = next(spot for spot in plan if spot.axis.name == "viscosity" and spot.value == 10.0)
    assert thick.limits["viscous"] < thick.limits["acoustic"]
    assert all(20 <= round(spot.scene.duration / spot.dt) <= 4000 for spot in plan)


def test_no_map_goes_over_a_setting_that_changes_no_number():
    maps = {(spot.axis.name, spot.scheme) for spot in grid_points(True)}
    compressed = {scheme for name, scheme in maps if name == "compression"}
    assert compressed == {scheme for scheme in compared("fluid") if reads_key(scheme, "fluid.compression")}
    assert {"mueller", "delta_sph"} <= compressed and "dfsph" not in compressed
    assert {scheme for name, scheme in maps if name == "viscosity"} == set(compared("fluid"))


def test_the_longest_stable_step_is_the_one_before_the_first_that_is_not():
    place = {"map": "viscosity", "scheme": "mueller", "value": 1.0, "acoustic_s": 0.1}
    verdicts = {0.5: "stable", 1.0: "stable", 2.0: "degraded", 4.0: "stable"}
    rows = [place | {"dt_over_courant": k, "dt_s": 0.06 * k, "verdict": said} for k, said in verdicts.items()]
    (line,) = map_summary(rows)
    assert (line["stable_to"], line["first_break"], line["verdict"]) == (1.0, 2.0, "degraded")
    assert line["acoustic_number"] == pytest.approx(0.6) and line["viscous_number"] is None


def test_the_study_leaves_tables_and_pictures_and_tells_what_has_no_verdict(capsys, monkeypatch):
    """Runs are made up: long steps stop, and one process dies."""

    def made_up(order, folder, limit):
        Path(folder).mkdir(parents=True)
        columns = table(gain=0.05 if order["scene"]["fluid"]["compression"] == 1.0 else 0.0)
        rows = [dict(zip(columns, values)) for values in zip(*columns.values())]
        study.write_table(Path(folder) / "accuracy.csv", rows)
        if order["scene"]["wind"]["kind"] == "gusts":
            return study.failure_row("its process was ended by SIGSEGV")
        return {"outcome": "stopped", "reason": "too fast"} if order["scene"]["time_step"]["dt"] > 0.08 else DONE

    monkeypatch.setattr(study, "perform_run", made_up)
    assert run_command_line(["stability", "tank.yaml", "--quick", "--out", "out"]) == 1
    said = capsys.readouterr().out
    assert "4 without a verdict" in said and "no verdict: wind 24.4, delta_sph" in said and "SIGSEGV" in said
    rows = list(csv.DictReader(Path("out/stability.csv").open()))
    assert {row["verdict"] for row in rows} == {"stable", "degraded", "stopped", "none"}
    names = {
        "stability.csv",
        "limits.csv",
        "stability_compression.png",
        "stability_wind.png",
        "stability_viscosity.png",
    }
    assert names <= {path.name for path in Path("out").iterdir()}


def test_water_without_particles_has_no_map(capsys):
    Path("sea.yaml").write_text(TANK.replace("delta_sph, spacing: 0.1", "linear_waves, height: 0.1, period: 2.0"))
    assert run_command_line(["stability", "sea.yaml"]) == 2
    assert "no setting to take to an extreme" in capsys.readouterr().err

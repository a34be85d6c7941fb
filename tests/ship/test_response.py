"""Response amplitude operators: a linear system is found again, a ship in long waves goes with the water."""

import json
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from ocean_sim import waves
from ocean_sim.conventions import Refused
from ocean_sim.reading.scene import load
from ocean_sim.ship.naval import response
from ocean_sim.validation.shared.tables import table
from ocean_sim.verbs.rao import refuse_short

EVERY, SECONDS, SPEED = 0.1, 1200.0, 3.0
CALM = {
    "basin": {"length": 1e4, "width": 1e4, "depth": 1e3},
    "fluid": {"kind": "linear_waves", "height": 0.0, "period": 9.0},
}
SCENE = """
duration: {seconds}
basin: {{length: 4000.0, width: 4000.0, depth: 2000.0, walls: none}}
fluid: {{kind: linear_waves, {waves}, heading_deg: 180.0}}
ship: {{kind: dynamic, hull: barge20, position: [0.0, 0.0], free: [surge, heave, pitch]}}
motion: {{every: 0.1}}
time_step: {{kind: fixed, dt: 0.1}}
"""


@pytest.fixture
def ask(ask, tmp_path, monkeypatch):
    """Answer of `ocean-sim rao` as JSON in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return partial(ask, "rao")


def oscillators(omega: np.ndarray) -> np.ndarray:
    """Responses (n, 6) of six damped oscillators, each with its own resonance."""
    natural, damping = np.array([0.5, 0.6, 1.0, 1.2, 1.4, 0.7]), np.array([0.7, 0.7, 0.5, 0.15, 0.4, 0.6])
    share = omega[:, None] / natural
    return 1.0 / (1.0 - share**2 + 2j * damping * share)


def ship_at_sea(seed: int) -> tuple[waves.Components, np.ndarray, np.ndarray, np.ndarray]:
    """A bow sea of many waves; times, places and motions of a linear system that moves along z through it."""
    rng, omega = np.random.default_rng(seed), np.linspace(0.5, 2.2, 600)
    density = omega**-5 * np.exp(-1.25 * (0.9 / omega) ** 4)
    wavevector = (omega**2 / 9.81)[:, None] * np.array([np.sin(2.6), np.cos(2.6)])
    sea = waves.Components(0.4 * np.sqrt(density), wavevector, rng.uniform(0.0, 2.0 * np.pi, 600), 1e4)
    time = np.arange(0.0, SECONDS, EVERY)
    place = np.column_stack([0.0 * time, SPEED * time])
    ratio = oscillators(np.abs(sea.omega - sea.wavevector @ [0.0, SPEED]))
    angle = place @ sea.wavevector.T - np.outer(time, sea.omega) + sea.phase
    sizes = sea.amplitude[:, None] * np.where(np.arange(6) < 3, 1.0, sea.wavenumber[:, None])
    # met head on, a wave goes as exp(i omega t) where its phase k . x - omega t falls
    motions = (np.exp(-1j * angle) @ (sizes * ratio)).real
    return sea, time, place, motions


def test_a_linear_system_is_found_again_from_one_irregular_record():
    """Ratios within 5 %, and phases within 2 degrees, where the coherence is above 0.99."""
    sea, time, place, motions = ship_at_sea(5)
    found = response.irregular_response(response.waves_at(sea, time, place), motions, EVERY, 5.0)
    exact = oscillators(found.omega)
    sure = found.coherence > 0.99
    assert sure.mean() > 0.8 and len(found.omega) > 20
    error = found.ratio[sure] / exact[sure]
    assert np.abs(np.abs(error) - 1.0).max() < 0.05 and np.degrees(np.abs(np.angle(error))).max() < 2.0
    noisy = motions + np.random.default_rng(1).normal(0.0, 3.0 * motions.std(axis=0), motions.shape)
    apart = response.irregular_response(response.waves_at(sea, time, place), noisy, EVERY, 5.0)
    assert apart.coherence.mean() < found.coherence.mean()


def test_one_regular_wave_gives_one_point():
    sea, time, place, _ = ship_at_sea(1)
    one = waves.Components(sea.amplitude[:1], sea.wavevector[:1], sea.phase[:1], sea.depth)
    record = response.waves_at(one, time, place)
    late = np.roll(record[:, :1], 4, axis=0)[200:] * np.array([1.0, 1.0, 2.0, 1.0, 1.0, 0.0])
    met = float(np.abs(one.omega - one.wavevector @ [0.0, SPEED])[0])
    found = response.regular_response(record[200:], late, time[200:], met)
    np.testing.assert_allclose(found.ratio[0, 2], 2.0 * np.exp(-0.4j * met), rtol=1e-6)
    assert found.coherence[0, 2] > 1.0 - 1e-9 and found.coherence[0, 5] == 0.0


def test_a_record_that_is_too_short_is_refused():
    sea = ship_at_sea(1)[0]
    with pytest.raises(Refused, match=r"every 8 s need 170 s .* --set duration=650"):
        refuse_short(replace(sea, ramp=10.0), 160.0, 0.0, 8.0)
    refuse_short(replace(sea, ramp=10.0), 171.0, 0.0, 8.0)


def test_motions_lie_along_the_mean_heading():
    position, angles = np.array([[1.0, 2.0, 3.0]] * 5), np.radians([[0.0, 0.0, 90.0]] * 5)
    np.testing.assert_allclose(response.ship_motions(position, angles)[0, :3], [2.0, -1.0, 3.0])  # bow to port


def test_the_closed_form_of_a_box_is_near_potential_flow():
    """Head sea, up to 0.8 rad/s (a wave of five lengths): heave within 5 %, pitch within 3 %."""
    config = load(CALM | {"ship": "barge20"})
    still, known = config.ships["ship"].hydrostatics_of(config.preflight), table("barge20_rao")
    omega = known["omega_rad_s"][known["omega_rad_s"] <= 0.8]
    heave, pitch = response.box_response(still, omega, 0.0, -1.0).T
    np.testing.assert_allclose(heave, known["head_heave"][: len(omega)], rtol=0.05)
    slope = np.degrees(omega**2 / 9.81)
    np.testing.assert_allclose(pitch * slope, known["head_pitch"][: len(omega)], rtol=0.03)
    assert np.isnan(response.box_response(still, omega, 5.0, 1.0)).all()  # she overtakes waves


def test_a_ship_in_long_waves_goes_with_the_water(ask):
    """Per amplitude or slope in a wave of 30 lengths: heave and pitch 1 within 1 %, surge within 2 %."""
    Path("long.yaml").write_text(SCENE.format(seconds=200.0, waves="height: 1.0, period: 20.0"))
    code, out, _ = ask("long.yaml", "--json")
    answer = json.loads(out)
    (row,) = answer["rows"]
    assert code == 0 and row["period_s"] == pytest.approx(20.0, rel=1e-3)
    assert row["heave_m_per_m"] == pytest.approx(1.0, abs=0.01) == row["pitch_rad_per_rad"]
    assert row["surge_m_per_m"] == pytest.approx(1.0, abs=0.02)
    assert row["heave_phase_deg"] == pytest.approx(0.0, abs=1.0)
    assert row["pitch_phase_deg"] == pytest.approx(-90.0, abs=1.0)
    assert row["heave_closed_form_m_per_m"] == pytest.approx(1.0, abs=0.01)
    assert {Path(name).name for name in answer["files"]} == {"rao.csv", "rao.png"}


def test_one_run_in_an_irregular_sea_has_all_motions(ask):
    sea = "spectrum: {kind: jonswap, significant_wave_height: 0.3, peak_period: 7.0, seed: 3}"
    Path("sea.yaml").write_text(SCENE.format(seconds=300.0, waves=sea).replace(", heading_deg: 180.0", ""))
    code, out, err = ask("sea.yaml")
    assert (code, err) == (0, "") and "roll" in out and "180: a head sea" in out
    code, again, _ = ask("runs/sea-rao", "--begin", "20")
    assert code == 0 and "omega [rad/s]" in again


def test_what_has_no_response_is_refused_in_a_sentence(ask):
    Path("calm.yaml").write_text(SCENE.format(seconds=20.0, waves="height: 0.0, period: 5.0"))
    assert "its water is still" in ask("calm.yaml")[2]
    assert "name a ship by --ship; there are ship" in ask("runs/calm-rao", "--ship", "tug")[2]
    assert ask("nothing.yaml")[0] == 2

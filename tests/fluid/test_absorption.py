"""Zones before absorbing sides: chosen from the waves of a scene, and what they do to water."""

import numpy as np
import pytest

from ocean_sim import waves
from ocean_sim.basin import Config as BasinConfig
from ocean_sim.conventions import GRAVITY
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.fluid.bodies.walls import Zone, zones
from ocean_sim.fluid.delta_sph import Config
from ocean_sim.fluid.sph.initial_state import fitted_waves
from ocean_sim.reading.scene import load
from ocean_sim.waves.absorption import DAMPING_POWER
from tests.fluid.conftest import put

FLUME = {"length": 12.0, "depth": 0.5}
REGULAR = {"height": 0.04, "period": 1.5}
RANDOM = {"spectrum": {"significant_wave_height": 0.04, "peak_period": 1.5, "seed": 3}}
LENGTH = 2.8265  # [m] of waves of 1.5 s


def chosen(basin: dict, **keys) -> tuple[Zone, ...]:
    """The zones of a flume that absorbs at x_max, or as `basin` has it."""
    place = BasinConfig(**(FLUME | {"walls": {"x_max": "absorbing"}} | basin)).build()
    return zones(Config(spacing=0.1, **keys).lattice(place))


def test_a_zone_is_as_long_as_the_waves_that_come():
    (one,) = chosen({"wavemaker": REGULAR})
    k = 2.0 * np.pi / LENGTH
    assert one.length == pytest.approx(LENGTH, rel=1e-3) and one.end == 6.0
    assert one.rate == pytest.approx(2.0 * k * float(waves.group_speed(k, 0.5)), rel=1e-3)
    (longer,) = chosen({"wavemaker": RANDOM})
    assert longer.length == pytest.approx(2.0 * LENGTH, rel=0.02)
    (swung,) = chosen({"motion": {"axis": "x", "amplitude": 0.01, "period": 1.5}})
    assert swung.length == pytest.approx(one.length) and swung.rate == pytest.approx(one.rate)
    (begun,) = chosen({"length": 11.306}, initial={"kind": "standing_wave", "height": 0.02, "mode": 8})
    assert begun.length == pytest.approx(LENGTH, rel=1e-3)


def test_a_recorded_motion_has_a_mean_frequency(tmp_path):
    t = np.arange(0.0, 30.0, 0.05)
    rows = "\n".join(f"{a},{b}" for a, b in zip(t, 0.01 * np.sin(2.0 * np.pi / 1.5 * t), strict=True))
    (tmp_path / "tank.csv").write_text("time_s,x_m\n" + rows)
    (one,) = chosen({"motion": {"file": str(tmp_path / "tank.csv")}})
    assert one.length == pytest.approx(LENGTH, rel=0.01)


def test_where_nobody_names_waves_it_is_a_quarter_of_the_basin():
    (one,) = chosen({})
    assert one.length == 3.0 and one.rate == pytest.approx(2.5 * (GRAVITY / 0.5) ** 0.5)
    assert "names no waves" in one.statement and one.warning is None


def test_what_the_user_says_counts():
    side = {"kind": "absorbing", "length": 2.0, "rate": 3.0}
    (one,) = chosen({"wavemaker": REGULAR, "walls": {"x_max": side}})
    assert (one.length, one.rate, one.begin) == (2.0, 3.0, 4.0)


def test_zones_leave_half_the_basin_free():
    both = chosen({"length": 6.0, "walls": {"x": "absorbing"}}, initial={"kind": "standing_wave", "height": 0.02})
    assert [one.length for one in both] == [1.5, 1.5]


SCENE = {
    "basin": FLUME | {"walls": {"x_max": "absorbing"}, "wavemaker": REGULAR},
    "fluid": {"kind": "delta_sph", "spacing": 0.1},
}


def side(**keys) -> dict:
    """The scene with keys of its absorbing side."""
    return SCENE | {"basin": SCENE["basin"] | {"walls": {"x_max": {"kind": "absorbing"} | keys}}}


def test_a_dump_shows_what_is_left_open_and_loads_to_the_same():
    scene = load(SCENE)
    shown = scene.resolved()
    assert shown["basin"]["walls"]["x_max"] == {"kind": "absorbing", "length": None, "rate": None, "target": None}
    assert load(shown).resolved() == shown
    everywhere = load(SCENE | {"basin": FLUME | {"walls": "absorbing"}})
    assert [side.absorbing is not None for side in everywhere.preflight.tank.sides] == [True, True, False]


def test_check_states_a_zone_in_numbers_and_warns_of_a_poor_one():
    def told(scene: dict) -> tuple[str, str]:
        config = load(scene)
        (statement,) = [s for s in config.fluid.statements(config.preflight) if s.startswith("absorbing")]
        return statement, " ".join(w for w in config.warnings() if "absorbing" in w)

    statement, warning = told(SCENE)
    assert "2.83 m, 1 times the wavelength of 2.83 m, rate 6.23 1/s" in statement
    assert "1.09% of the height of waves of 1.5 s" in statement and warning == ""
    assert "less than half the wavelength of 2.83 m: it sends back" in told(side(length=1.0))[1]
    assert "take 58% of the basin along x" in told(side(length=7.0))[1]
    assert "towards a current of [0.1, 0.0, 0.0] m/s" in told(side(target={"current": [0.1, 0.0, 0.0]}))[0]
    sea = told({**side(target={"waves": {"height": 0.02, "period": 2.0}})})[0]
    assert "towards waves of 4.056 m" in sea and "waves of 2 s" in sea


@pytest.mark.parametrize(
    "keys, sentence",
    [
        ({"length": 20.0}, "basin.walls.x_max.length: a zone of 20 m is longer than the basin, 12 m"),
        ({"rate": -1.0}, "basin.walls.x_max.rate: -1.0 is not greater than 0 [1/s]"),
        ({"lenght": 1.0}, "basin.walls.x_max.lenght: unknown key; did you mean 'length'?"),
        ({"target": {"current": [0.0, 0.1, 0.0]}}, "basin.walls.x_max.target.current: a current of this basin is"),
        ({"target": {"waves": {"height": 3.0, "period": 1.5}}}, "basin.walls.x_max.target.waves.height: a wave of"),
        (
            {"target": {"waves": REGULAR | {"heading_deg": 10.0}}},
            "basin.walls.x_max.target.waves.heading_deg: in 2-D waves go along",
        ),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(keys, sentence):
    with pytest.raises(SceneError, match="basin") as refused:
        load(side(**keys))
    assert sentence in str(refused.value)


BAY = {"length": 1.0, "width": 0.4, "depth": 0.3}
CURRENT = 0.2  # [m/s]


@pytest.fixture(scope="module")
def stream(water):
    """Water at rest between sides that absorb towards a current along them, 1 s on."""
    absorbing = {"kind": "absorbing", "length": 0.5, "rate": 8.0, "target": {"current": [0.0, 0.0, CURRENT]}}
    basin = BAY | {"walls": {"x": absorbing, "z": "periodic"}}
    fluid = water("delta_sph", basin=basin, spacing=0.05, accounts=True)
    while fluid.time < 1.0:
        fluid.advance(min(0.8 * fluid.limits().acoustic, 1.0 - fluid.time + 1e-9))
    return fluid


def test_water_takes_on_the_current_that_it_is_absorbed_towards(stream):
    """u = U (1 - exp(-rate s^DAMPING_POWER t)) where nothing rubs; next to the sides all of it flows."""
    x, u = stream.particles.position.to_numpy()[:, 0], stream.particles.velocity.to_numpy()[:, 2]
    expected = CURRENT * (1.0 - np.exp(-8.0 * (np.abs(x) / 0.5) ** DAMPING_POWER * stream.time))
    near = np.abs(x) > 0.4
    np.testing.assert_allclose(u[near], CURRENT, rtol=0.02)
    assert np.sqrt(((u - expected) ** 2).mean()) < 0.05 * CURRENT
    assert np.abs(stream.particles.velocity.to_numpy()[:, :2]).max() < 0.2 * CURRENT


def test_what_a_zone_gives_is_told_with_the_walls(stream):
    v, mass = stream.particles.velocity.to_numpy(), stream.particles.mass
    momentum = mass * v.sum(axis=0)
    np.testing.assert_allclose(sum(stream.impulse.values()), momentum, atol=1e-9 * momentum[2])
    assert stream.impulse["walls"][2] == pytest.approx(momentum[2], rel=1e-9)
    assert stream.work["walls"] == pytest.approx(0.5 * mass * (v[:, 2] ** 2).sum(), rel=0.05)


PERIOD = 0.8
WAVE = {"height": 0.04, "period": PERIOD, "heading_deg": 0.0}


def amplitude(again, target: dict | None, ahead: float = 0.0) -> complex:
    """Of a wave along z after two periods between sides that absorb, over that of linear theory then: the part of the
    velocity that is this wave's, and a quarter of a period late. It begins so much of its length ahead. Between walls
    this coarse water keeps 0.89 of it."""
    rough = waves.regular_wave(0.04, PERIOD, np.array([0.0, 1.0]), 0.4)
    width = 2.0 * np.pi / float(rough.wavenumber[0])
    side = {"kind": "absorbing", "length": 0.15, "rate": 20.0, "target": target}
    basin = {"length": 0.3, "width": width, "depth": 0.4, "walls": {"x": side, "z": "periodic"}}
    fluid = again("delta_sph", basin=basin, spacing=0.05, initial={"kind": "regular_wave"} | WAVE)
    x, v = fluid.particles.position.to_numpy(), fluid.particles.velocity.to_numpy()
    x[:, 2] = (x[:, 2] + (0.5 + ahead) * width) % width - 0.5 * width
    put(fluid, x, v)
    while fluid.time < 2.0 * PERIOD:
        fluid.advance(0.8 * fluid.limits().acoustic)
    sea = fitted_waves(rough, fluid.grid.basin)
    x, v = fluid.particles.position.to_numpy(), fluid.particles.velocity.to_numpy()
    now, late = (waves.linear_velocity(sea, x, t) for t in (fluid.time, fluid.time - 0.25 * PERIOD))
    return complex((v * now).sum() / (now * now).sum(), (v * late).sum() / (late * late).sum())


@pytest.mark.slow
def test_a_zone_leaves_the_wave_alone_that_it_is_to_let_pass(again):
    """And turns one round that has the opposite phase; towards rest it calms it."""
    kept = amplitude(again, {"waves": WAVE})
    assert abs(kept) == pytest.approx(1.0, abs=0.05) and abs(kept.imag) < 0.1
    assert amplitude(again, {"waves": WAVE}, ahead=0.5).real > 0.9
    assert abs(amplitude(again, None)) < 0.3

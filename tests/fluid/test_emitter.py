"""An emitter: so much water a second, on parabolas, up to its cap, whatever the time step."""

import numpy as np
import pytest

from ocean_sim import load
from ocean_sim.conventions import GRAVITY
from ocean_sim.reading.scene import SceneError
from tests.conftest import quickly
from tests.fluid.conftest import by_id

G = np.array([0.0, -GRAVITY, 0.0])
JET = {"position": [-0.3, 0.2, 0.1], "velocity": [1.0, 0.5, 0.0], "rate": 0.04, "cap": 500}  # 4 particles across
OPEN = {"walls": "none", "floor": "none"}


def fountain(water, kind: str = "ballistic", *, emitter: dict | None = None, **keys):
    return water(kind, **({"basin": OPEN, "emitter": JET | (emitter or {})} | keys))


def number(fluid) -> int:
    return len(fluid.particles.position.to_numpy())


def test_as_much_water_leaves_as_the_rate_says_until_the_cap_and_no_more(water):
    fluid = fountain(water, accounts=True)
    volume = fluid.particles.mass / fluid.particles.rest_density
    assert volume == pytest.approx(0.1**3)
    assert number(fluid) == 4
    for step in range(1, 381):
        fluid.advance(0.033)
        t = 0.033 * step
        assert number(fluid) == min(500, 4 * (1 + int(0.04 * t / (4 * volume) + 1e-6)))
        assert abs(number(fluid) * volume - 0.04 * t) <= 4.001 * volume or number(fluid) == 500
    assert number(fluid) == 500
    assert sorted(fluid.particles.id.to_numpy()) == list(range(500))
    for array in (fluid.particles.velocity, fluid.particles.density, fluid.particles.pressure):
        assert len(array.to_numpy()) == 500


def parabola(fluid, t: float) -> np.ndarray:
    """Where the particles should be, in the order of their ids."""
    age = t - 0.1 * (np.arange(number(fluid)) // 4)[:, None]
    v = np.array(JET["velocity"])
    return np.array(JET["position"]) + age * v + 0.5 * age**2 * G


@pytest.mark.parametrize("dt", [0.05, 0.0173, 0.26])
def test_layers_fly_on_parabolas_whatever_the_step(again, dt):
    fluid, t = fountain(again), 0.0
    while t < 0.9:
        fluid.advance(dt)
        t += dt
    x = by_id(fluid, fluid.particles.position.to_numpy())
    whole = len(x) // 4 * 4
    middles = x[:whole].reshape(-1, 4, 3).mean(axis=1)
    np.testing.assert_allclose(middles, parabola(fluid, t)[:whole:4], atol=1e-12)
    v = by_id(fluid, fluid.particles.velocity.to_numpy())
    age = t - 0.1 * (np.arange(len(v)) // 4)[:, None]
    np.testing.assert_allclose(v, np.array(JET["velocity"]) + age * G, atol=1e-12)


def test_without_gravity_in_the_first_partial_step_they_would_not(again, monkeypatch):
    fluid = fountain(again)
    monkeypatch.setattr(type(fluid.pull), "at_mouth", lambda self: np.zeros(3))
    for _ in range(4):
        fluid.advance(0.26)
    middles = by_id(fluid, fluid.particles.position.to_numpy()).reshape(-1, 4, 3).mean(axis=1)
    assert np.abs(middles - parabola(fluid, 1.04)[::4]).max() > 1e-2


def test_a_layer_lies_across_the_jet_as_dense_as_water(water):
    fluid = fountain(water, emitter={"rate": 0.0894427191 * 2})  # 0.16 m2 of mouth, 16 particles
    x = fluid.particles.position.to_numpy()
    assert len(x) == 16
    across = x - JET["position"]
    assert np.abs(across @ np.array(JET["velocity"])).max() < 1e-12
    apart = np.linalg.norm(across[:, None] - across[None], axis=2)
    assert apart[~np.eye(16, dtype=bool)].min() == pytest.approx(0.1, rel=1e-6)
    assert np.linalg.norm(x.mean(axis=0) - JET["position"]) < 1e-12


@pytest.mark.parametrize("kind", quickly("delta_sph", "mueller", "dfsph"))
def test_water_of_any_scheme_pours_and_its_momentum_is_told(water, kind):
    basin = {"width": None, "walls": "none", "floor": "none"}
    emitter = {"position": [0.0, 0.2], "velocity": [1.5, 0.0], "rate": 0.3, "cap": 60}
    fluid = fountain(water, kind, emitter=emitter, basin=basin, spacing=0.05, accounts=True)
    start = fluid.particles.mass * fluid.particles.velocity.to_numpy().astype(float).sum(axis=0)
    t = 0.0
    while t < 0.6:
        fluid.advance(0.004)
        t += 0.004
    assert number(fluid) == 60
    x, v = fluid.particles.position.to_numpy(), fluid.particles.velocity.to_numpy()
    assert np.isfinite(x).all() and sorted(fluid.particles.id.to_numpy()) == list(range(60))
    assert v[:, 0].mean() == pytest.approx(1.5, abs=0.02)  # inner forces keep the jet's momentum
    momentum = fluid.particles.mass * v.sum(axis=0)
    given = sum(fluid.impulse.values()) + start
    np.testing.assert_allclose(momentum, given, atol=1e-9 * abs(momentum).max())
    assert fluid.impulse["emitter"][0] == pytest.approx(56 * fluid.particles.mass * 1.5, rel=1e-9)
    assert fluid.status.max_density < 1.3 * fluid.particles.rest_density


def test_the_same_bytes_again(water):
    def poured() -> bytes:
        fluid = fountain(water, "mueller", basin={"width": None}, spacing=0.05, fill=FILL, emitter=INTO)
        for _ in range(80):
            fluid.advance(0.002)
        assert number(fluid) > fluid.jet.first + 4
        return fluid.particles.position.to_numpy().tobytes() + fluid.particles.velocity.to_numpy().tobytes()

    assert poured() == poured()


FILL = [{"min": [-0.5, -0.5], "max": [0.5, -0.3]}]
INTO = {"position": [0.0, -0.1], "velocity": [0.0, -1.0], "rate": 0.15, "cap": 120}
WALLED = {"position": [-0.5, -0.1], "velocity": [1.0, 0.0]}


@pytest.mark.parametrize(
    ("emitter", "key", "sentence"),
    [
        ({"cap": 80}, "emitter.cap", "nothing would be left to emit"),
        ({"velocity": [0.0, 0.0]}, "emitter.velocity", "must not be zero"),
        ({"position": [0.0, -0.1, 0.2]}, "emitter.position", "has 2 numbers"),
        ({"position": [0.48, -0.1]}, "emitter.position", "reaches out of the basin along x"),
        (WALLED, "emitter.position", "too near x_min, the wall behind it"),
        (WALLED | {"position": [-0.46, -0.1]}, "emitter.position", "0.05 m, must be free; move it 0.01 m further in"),
        ({"position": [0.0, -0.48], "velocity": [0.1, 1.0]}, "emitter.position", "too near y_min"),
        ({"cap": 10**9}, "emitter.cap", "is not at most"),
        ({"rate": 0.0}, "emitter.rate", "greater than 0"),
    ],
)
def test_what_cannot_be_is_said(emitter, key, sentence):
    fluid = {"kind": "mueller", "spacing": 0.05, "fill": FILL, "emitter": INTO | emitter}
    with pytest.raises(SceneError) as failure:
        load({"basin": {"length": 1.0, "depth": 0.5}, "fluid": fluid})
    assert key in str(failure.value) and sentence in str(failure.value)


@pytest.mark.parametrize(("position", "velocity"), [([-0.45, -0.1], [1.0, 0.0]), ([-0.425, -0.1], [0.0, -1.0])])
def test_a_mouth_may_lie_a_spacing_in_front_of_a_wall_and_reach_along_one(position, velocity, water):
    """Water that leaves does not fly apart."""
    emitter = INTO | {"position": position, "velocity": velocity}
    fluid = water("delta_sph", basin={"length": 1.0, "width": None}, spacing=0.05, fill=FILL, emitter=emitter)
    for _ in range(300):
        fluid.advance(0.0005)
    assert np.linalg.norm(fluid.particles.velocity.to_numpy(), axis=1).max() < 3.0


def test_a_closed_basin_has_no_room_for_more_than_it_holds():
    basin = {"length": 1.0, "depth": 0.5, "lid": {}}
    with pytest.raises(SceneError, match="at most 200"):
        load({"basin": basin, "fluid": {"kind": "delta_sph", "spacing": 0.05, "emitter": INTO | {"cap": 250}}})


@pytest.mark.parametrize("motion", [None, {"axis": "x", "amplitude": 0.05, "period": 0.5}])
def test_a_run_tells_what_was_emitted(motion, tmp_path):
    from ocean_sim import run

    fluid = {"kind": "ballistic", "spacing": 0.05, "emitter": INTO}
    scene = {
        "duration": 0.16,
        "accuracy": {"every": 0.04},
        "basin": {"length": 1.0, "depth": 0.5, "motion": motion},
        "fluid": fluid,
        "runtime": {"threads": 1},
    }
    result = run(load(scene | {"render": None, "gauges": {"pressure": {"bed": [0.0, -0.5]}}}), tmp_path / "run")
    account = result.accuracy
    left = account["momentum_y_kg_m_s"] - sum(
        account[name] for name in account if name.startswith("impulse_") and name.endswith("_y_Ns")
    )
    assert np.ptp(left) < 1e-3 * np.abs(account["momentum_y_kg_m_s"]).max()
    assert np.abs(account["energy_residual_J"]).max() < 1e-4 * np.abs(account["work_emitter_J"]).max()
    assert np.all(result.gauges["bed_Pa"] == 0.0)

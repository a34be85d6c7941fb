"""A bed that rubs: its stress on the water next to it, by closed forms; what it may be, and what it is called."""

import re
from math import log, sqrt, tanh

import numpy as np
import pytest

import ocean_sim
from ocean_sim.files.csv_file import read_columns
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.parts import config_of, kinds
from ocean_sim.reading.scene import load
from tests.conftest import quickly
from tests.fluid.conftest import put

SCHEMES = quickly(*(kind for kind in kinds("fluid") if config_of("fluid", kind).compared))
SPEED, ALONG = 0.5, np.array([0.6, 0.0, 0.8])  # [m/s] and its direction
DENSITY = 1000.0  # [kg/m3]


def row(water, scheme: str, floor: object, keys: dict | None = None, **place: object):
    """One row of particles, 0.1 m high, without gravity: whatever the bed does, it moves as a plug."""
    basin = {"length": 1.0, "width": None, "depth": 0.1, "gravity": [0.0, 0.0, 0.0], "walls": {"x": "periodic"}}
    return water(scheme, basin=basin | {"floor": floor} | place, spacing=0.1, reference_speed=1.0, **keys or {})


def stream(fluid, velocity: np.ndarray) -> None:
    x = fluid.particles.position.to_numpy()
    put(fluid, x, np.tile(velocity, (len(x), 1)))


def speed(fluid) -> np.ndarray:
    return fluid.particles.velocity.to_numpy()[:, 0]


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_stream_over_a_friction_factor_decays_as_the_closed_form(water, scheme):
    """h du/dt = -f u^2 / 2: u = u0 / (1 + f u0 t / (2 h)), at any time step."""
    f, height = 0.2, 0.1
    fluid = row(water, scheme, {"friction_factor": f})
    stream(fluid, [SPEED, 0.0, 0.0])
    for dt in (0.01, 0.002, 0.03) * 20:
        fluid.advance(dt)
    exact = SPEED / (1.0 + f * SPEED * fluid.time / (2.0 * height))
    assert exact < 0.8 * SPEED
    np.testing.assert_allclose(speed(fluid), exact, rtol=1e-9)


def test_without_it_the_stream_goes_on(water):
    """The negative control."""
    fluid = row(water, "delta_sph", "free_slip")
    stream(fluid, [SPEED, 0.0, 0.0])
    for _ in range(60):
        fluid.advance(0.014)
    np.testing.assert_allclose(speed(fluid), SPEED, rtol=1e-12)


@pytest.mark.parametrize(
    "scheme, floor",
    [("delta_sph", {"roughness": 0.003}), ("dfsph", {"friction_factor": 0.03}), ("mueller", {"roughness": 0.003})],
)
def test_the_stress_on_a_lattice_is_that_of_the_law(water, scheme, floor):
    """tau times the area of the bed, on the lowest row alone and against its velocity, wherever it lies within a
    quarter of a row; a row that does not fit the spacing counts as what it is."""
    height, dt = 0.46 / 5, 1e-3
    basin = {"depth": 0.46, "gravity": [0.0, 0.0, 0.0], "walls": "periodic", "floor": floor}
    fluid = water(scheme, basin=basin, spacing=0.1, reference_speed=1.0, accounts=True)
    lattice, before = fluid.particles.position.to_numpy(), np.zeros(3)
    for moved in (0.0, -0.24, 0.24):
        put(fluid, lattice + [0.0, moved * height, 0.0], np.tile(SPEED * ALONG, (len(lattice), 1)))
        fluid.advance(dt)
        drag = 0.015 if "friction_factor" in floor else (0.41 / log(30.0 * (0.5 + moved) * height / 0.003)) ** 2
        lost = drag * SPEED**2 * dt / height  # [m/s] of the row in a step, if the stress held through it
        exact = -DENSITY * height * lost / (1.0 + lost / SPEED) * ALONG
        np.testing.assert_allclose(fluid.impulse["bed"] - before, exact, rtol=1e-9, atol=1e-12)
        before = fluid.impulse["bed"]


@pytest.mark.parametrize("scheme", quickly("delta_sph", "dfsph"))
def test_a_sheet_thinner_than_a_row_bears_the_share_that_is_filled(water, scheme):
    """h du/dt = -s f u^2 / 2: s is 2/3 of ten particles on the length of fifteen; it is 1 of the middle one of nine in
    a row, 0.57 of an end, 0.13 of a lone one."""
    f, height, dt, box = 0.2, 0.1, 1e-3, {"min": [-0.75, -0.1], "max": [0.25, 0.0]}
    fluid = row(water, scheme, {"friction_factor": f}, {"fill": [box]}, length=1.5)
    x = fluid.particles.position.to_numpy()

    def shares(along: np.ndarray) -> np.ndarray:
        x[:, 0] = along
        put(fluid, x, np.tile([SPEED, 0.0, 0.0], (len(x), 1)))
        fluid.advance(dt)
        slowed = speed(fluid)[np.argsort(fluid.particles.id.to_numpy())]
        return (SPEED / slowed - 1.0) / (f * SPEED * dt / (2.0 * height))

    np.testing.assert_allclose(shares(0.15 * np.arange(10) - 0.7), 2.0 / 3.0, rtol=0.02)
    found = shares(np.append(0.1 * np.arange(9) - 0.5, 0.65))
    np.testing.assert_allclose(found[[0, 4, 8, 9]], [0.57, 1.0, 0.57, 0.13], atol=6e-3)
    np.testing.assert_allclose(found[4], 1.0, rtol=1e-9)


@pytest.mark.parametrize("scheme", quickly("dfsph", "mueller"))
def test_it_stops_water_and_never_turns_it_round(water, scheme):
    fluid = row(water, scheme, {"friction_factor": 1e6})
    stream(fluid, [SPEED, 0.0, 0.0])
    for _ in range(5):
        fluid.advance(0.01)
        assert (speed(fluid) >= 0.0).all()
    assert speed(fluid).max() < 1e-5 * SPEED


def test_the_shares_of_scattered_particles_sum_to_the_bed(water):
    """To the noise of 400 particles in the lowest row."""
    f, basin = 0.03, {"length": 2.0, "width": 2.0, "gravity": [0.0, 0.0, 0.0], "walls": "periodic"}
    fluid = water("dfsph", basin=basin | {"floor": {"friction_factor": f}}, reference_speed=1.0, accounts=True)
    x = fluid.particles.position.to_numpy()
    x += 0.04 * np.random.default_rng(3).uniform(-1.0, 1.0, x.shape)
    put(fluid, x, np.tile(SPEED * ALONG, (len(x), 1)))
    fluid.advance(1e-4)
    stress = -fluid.impulse["bed"] / (1e-4 * 4.0)
    np.testing.assert_allclose(stress, 0.5 * DENSITY * f * SPEED**2 * ALONG, rtol=0.03)


def test_a_tank_that_accelerates_takes_its_water_along(water, tmp_path):
    """In the axes of the tank, where the bed rests, du/dt = -a - k |u| u: u = -U tanh(a t / U), U = sqrt(a / k)."""
    times, a, f = np.linspace(0.0, 2.0, 201), 0.4, 0.5
    path = tmp_path / "motion.csv"
    path.write_text("time_s,x_m\n" + "".join(f"{t!r},{0.5 * a * t * t!r}\n" for t in times.tolist()))
    fluid = row(water, "dfsph", {"friction_factor": f}, motion={"file": str(path)})
    while fluid.time < 1.5:
        fluid.advance(0.0025)
    ultimate = sqrt(a / (f / (2.0 * 0.1)))
    exact = -ultimate * tanh(a * fluid.time / ultimate)
    assert abs(exact) < 0.75 * a * fluid.time
    np.testing.assert_allclose(speed(fluid), exact, rtol=5e-3)


CHANNEL = {
    "duration": 0.3,
    "basin": {"length": 0.8, "depth": 0.3, "walls": {"x": "periodic"}},
    "runtime": {"precision": "f64", "threads": 1},
    "accuracy": {"every": 0.05},
    **dict.fromkeys(("frames", "render", "report")),
}


BEDS = {"rough": {"roughness": 0.01}, "smooth": "free_slip"}


def accuracy(tmp_path, scheme: str, **basin: object) -> dict:
    """accuracy.csv of water that is driven down a channel."""
    fluid = {"kind": scheme, "spacing": 0.05, "kinematic_viscosity": 0.01, "body_force": [3.0, 0.0, 0.0]}
    scene = CHANNEL | {"fluid": fluid, "basin": CHANNEL["basin"] | basin}
    ocean_sim.run(load(scene), tmp_path)
    return read_columns(tmp_path / "accuracy.csv")


@pytest.mark.parametrize("scheme", SCHEMES)
def test_its_impulse_and_work_are_told_and_all_closes(tmp_path, scheme):
    """Momentum to the digits of the file, and energy as well as over a bed that does not rub and is no column: within
    3e-5 of what the bed takes, but for `mueller`, whose boiling takes another course (1.5e-3)."""
    rough, smooth = (accuracy(tmp_path / name, scheme, floor=floor) for name, floor in BEDS.items())
    for table in (rough, smooth):
        given = sum(values for name, values in table.items() if name.startswith("impulse") and "_x_" in name)
        np.testing.assert_allclose(given, table["momentum_x_kg_m_s"], rtol=1e-8, atol=1e-12)
    taken = abs(rough["work_bed_J"][-1])
    assert rough["impulse_bed_x_Ns"][-1] < -0.3 and rough["work_bed_J"][-1] < -0.1
    np.testing.assert_allclose(rough["impulse_bed_y_Ns"], 0.0, atol=1e-12)
    np.testing.assert_allclose(rough["energy_residual_J"], smooth["energy_residual_J"], atol=3e-3 * taken)
    assert set(rough) - set(smooth) == {"work_bed_J", *(f"impulse_bed_{axis}_Ns" for axis in "xyz")}


def scene(floor: object, **fluid: object) -> dict:
    basin = {"length": 1.0, "depth": 0.5, "walls": {"x": "periodic"}, "floor": floor}
    return {"basin": basin, "fluid": {"kind": "delta_sph", "spacing": 0.1} | fluid}


@pytest.mark.parametrize(
    "data, sentence",
    [
        (scene({}), "basin.floor: give a profile [m], a grid, a roughness [m] or a friction_factor"),
        (scene({"roughness": 0.01, "friction_factor": 0.1}), "basin.floor: give either roughness [m] or"),
        (scene({"roughness": 0.0}), "basin.floor.roughness: 0.0 is not greater than 0 [m]"),
        (scene({"rouhgness": 0.01}), "basin.floor.rouhgness: unknown key; did you mean 'roughness'?"),
        (scene({"roughness": 0.8}), "fluid.spacing: the bed's z0 of 0.0267 m, a thirtieth of its roughness"),
        (scene({"roughness": 0.01}, kind="ballistic"), "fluid.kind: particles that ignore each other have no layer"),
        (
            {"fluid": {"kind": "linear_waves", "height": 0.02, "period": 1.0}}
            | {"basin": {"length": 4.0, "depth": 0.5, "floor": {"friction_factor": 0.1}}},
            "fluid.kind: a sea in closed form has no friction; leave basin.floor out",
        ),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(data, sentence):
    with pytest.raises(SceneError, match=re.escape(sentence)):
        load(data)


def test_what_the_bed_is_stands_in_check():
    fine, coarse = load(scene({"roughness": 0.003})), load(scene({"roughness": 0.06}))
    said = " ".join(fine.fluid.statements(fine.preflight))
    factor = 2.0 * (0.41 / log(0.05 / 1e-4)) ** 2
    assert "roughness 0.003 m, z0 0.0001 m" in said and "0.05 m or 500 z0" in said and f"factor of {factor:.4g}" in said
    assert not [sentence for sentence in fine.warnings() if "grains" in sentence]
    assert [sentence for sentence in coarse.warnings() if "grains of 0.06 m reach above the middle" in sentence]
    given = load(scene({"friction_factor": 0.02}))
    assert "friction factor of 0.02" in " ".join(given.fluid.statements(given.preflight))
    smooth = load(scene("free_slip"))
    assert "rubs" not in " ".join(smooth.fluid.statements(smooth.preflight))


def test_a_dump_reads_as_the_same_bed():
    config = load(scene({"roughness": 0.003}))
    shape = {"profile": None, "grid": None, "grid_centre": None, "slip": "free_slip"}
    assert config.resolved()["basin"]["floor"] == shape | {"roughness": 0.003, "friction_factor": None}
    assert load(config.resolved()).basin == config.basin

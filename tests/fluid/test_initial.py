"""States that water starts from: they keep its density, its surface without pressure, and the theory's velocity."""

from math import pi

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from ocean_sim import waves
from ocean_sim.basin import Basin
from ocean_sim.basin import Config as BasinConfig
from ocean_sim.conventions import GRAVITY
from ocean_sim.fluid.sph.initial_state import (
    Initial,
    displaced_state,
    fitted_waves,
    given_positions,
    problems,
    start_state,
)

TANK = {"length": 2.0, "depth": 1.0, "gravity": (0.0, -1.0, 0.0)}  # Colagrossi et al. 2013, with H = g = 1
FLUME = {"length": 2.0 * 2.0944, "depth": 0.5, "walls": {"x": "periodic"}}  # two waves of 1.21738 s
BOX = {
    "length": 1.0,
    "depth": 1.0,
    "gravity": (0.0, 0.0, 0.0),
    "floor": "none",
    "walls": {"x": "periodic", "y": "periodic"},
}


def place(**keys) -> Basin:
    return BasinConfig(**keys).build()


def initial(**keys) -> Initial:
    return TypeAdapter(Initial).validate_python(keys)


def lattice(basin: Basin, n: int, m: int, surface: float = 0.0) -> np.ndarray:
    """(n * m, 3) middles of equal cells from the bed to a surface, x running fastest."""
    x = basin.lower[0] + (np.arange(n) + 0.5) * basin.config.length / n
    y = basin.lower[1] + (np.arange(m) + 0.5) * (surface - basin.lower[1]) / m
    grid = np.meshgrid(y, x, indexing="ij")
    return np.stack([grid[1].ravel(), grid[0].ravel(), np.zeros(n * m)], axis=1)


def said(basin: Basin, **keys) -> str:
    found = problems(initial(**keys), basin)
    return "; ".join(f"{'.'.join(path)}: {sentence}" for path, sentence in found)


def test_still_water_is_hydrostatic_below_its_own_surface():
    basin = place(length=2.0, depth=1.0)
    x = lattice(basin, 4, 8)
    positions, velocities, pressures = start_state(None, x, basin, 1000.0)
    assert positions is x and not velocities.any()
    np.testing.assert_allclose(pressures, -1000.0 * GRAVITY * x[:, 1])
    lower = start_state(None, x, basin, 1000.0, surface=-0.5)[2]
    np.testing.assert_allclose(lower, 1000.0 * GRAVITY * np.maximum(-0.5 - x[:, 1], 0.0))
    assert not start_state(None, lattice(place(**BOX), 4, 4), place(**BOX), 1000.0)[2].any()


@pytest.mark.parametrize("keys", [{"height": 0.1}, {"amplitude": 0.05}])
def test_a_standing_wave_at_its_crest_rests_and_is_as_high_as_asked(keys):
    basin = place(**TANK)
    top = np.stack([np.linspace(-1.0, 1.0, 41), np.zeros(41), np.zeros(41)], axis=1)
    positions, velocities, pressures = start_state(initial(kind="standing_wave", mode=2, **keys), top, basin, 1000.0)
    assert np.abs(velocities).max() < 1e-15
    np.testing.assert_allclose(pressures, 0.0, atol=1e-12)
    assert positions[0, 1] - positions[20, 1] == pytest.approx(0.1, rel=0.01)  # to (ka)^2; x_min and middle
    np.testing.assert_allclose(positions[[0, 20, 40], 0], [-1.0, 0.0, 1.0], atol=1e-15)  # nothing crosses the walls
    k, mean = pi, (positions[0, 1] + positions[20, 1]) / 2.0
    assert mean == pytest.approx(0.5 * k * 0.05**2, rel=0.1)  # crests sharper than troughs, as Stokes has them


def test_a_flat_standing_wave_has_the_energy_of_the_closed_form():
    """KE(0) = rho eps^2 g H^2 lambda / 16 for the amplitude eps H / 2 (Colagrossi et al. 2013)."""
    basin, eps = place(**TANK), 0.1
    x = lattice(basin, 200, 100)
    positions, velocities, pressures = start_state(
        initial(kind="standing_wave", mode=2, amplitude=eps / 2.0, phase="flat"), x, basin, 1000.0
    )
    np.testing.assert_allclose(positions, x, atol=1e-15)
    np.testing.assert_allclose(pressures, -1000.0 * x[:, 1], atol=1e-10)
    mass = 1000.0 * 2.0 / len(x)
    assert 0.5 * mass * (velocities**2).sum() == pytest.approx(1000.0 * eps**2 * 2.0 / 16.0, rel=2e-4)
    crest = start_state(initial(kind="standing_wave", mode=2, amplitude=eps / 2.0), x, basin, 1000.0)[0]
    raised = 1000.0 * 2.0 / len(x) * (crest[:, 1] - x[:, 1]).sum()
    assert raised == pytest.approx(1000.0 * eps**2 * 2.0 / 16.0, rel=0.03)  # as much potential energy, to (ka)^2


def areas(positions: np.ndarray, n: int, m: int) -> np.ndarray:
    """Areas of the quadrilaterals between neighbours of a lattice."""
    p = positions[:, :2].reshape(m, n, 2)
    one, two = p[1:, 1:] - p[:-1, :-1], p[1:, :-1] - p[:-1, 1:]
    return 0.5 * np.abs(one[..., 0] * two[..., 1] - one[..., 1] * two[..., 0])


def test_waves_keep_the_density_of_the_lattice_where_one_displacement_would_not():
    basin, n, m = place(**TANK), 160, 80
    x = lattice(basin, n, m)
    wave = initial(kind="standing_wave", mode=2, amplitude=0.1)
    rest = areas(x, n, m)
    kept = areas(start_state(wave, x, basin, 1000.0)[0], n, m) / rest
    moved = areas(x + waves.displacement(wave.sea(basin), x), n, m) / rest
    assert np.abs(kept - 1.0).max() < 5e-4
    assert np.abs(moved - 1.0).max() > 0.05  # (ka)^2


def test_a_regular_wave_travels_where_its_heading_says_and_its_water_stays_periodic():
    basin = place(**FLUME)
    x = lattice(basin, 84, 10)
    wave = initial(kind="regular_wave", height=0.04, period=1.21738)
    assert not [*problems(wave, basin)]
    positions, velocities, _ = start_state(wave, x, basin, 1000.0)
    assert positions[:, 0].min() >= basin.lower[0] and positions[:, 0].max() < basin.upper[0]
    top = slice(-84, None)
    assert np.corrcoef(velocities[top, 0], positions[top, 1])[0, 1] > 0.99  # water goes with the crest
    backwards = start_state(
        initial(kind="regular_wave", height=0.04, period=1.21738, heading_deg=270.0), x, basin, 1000.0
    )
    assert np.corrcoef(backwards[1][top, 0], backwards[0][top, 1])[0, 1] < -0.99
    sea = fitted_waves(wave.sea(basin), basin)
    assert sea.wavevector[0] * FLUME["length"] / (2.0 * pi) == pytest.approx([2.0, 0.0], abs=1e-12)


def test_velocity_and_pressure_satisfy_the_equation_of_motion():
    """To first order: what a tiny wave does a moment later is what its pressure makes it do."""
    basin, dt = place(**FLUME), 1e-4
    x = lattice(basin, 20, 10)
    sea = fitted_waves(initial(kind="regular_wave", height=1e-6, period=1.21738).sea(basin), basin)

    def head(p):
        return displaced_state(sea, p, basin, 1.0)[2] / sea.gravity + p[:, 1] + waves.displacement(sea, p)[:, 1]

    step = 1e-4
    push = [(head(x + d) - head(x - d)) / (2 * step) for d in step * np.eye(3)]
    acceleration = (waves.linear_velocity(sea, x, dt) - waves.linear_velocity(sea, x, -dt)) / (2 * dt)
    scale = np.abs(acceleration).max()
    np.testing.assert_allclose(acceleration / scale, -sea.gravity * np.stack(push, axis=1) / scale, atol=1e-5)


def test_a_sea_in_a_periodic_basin_repeats_itself_and_keeps_its_height():
    basin = place(length=30.0, width=30.0, depth=5.0, walls="periodic")
    spectrum = {"significant_wave_height": 0.3, "peak_period": 2.5, "heading_deg": 60.0, "seed": 2}
    wave = initial(kind="spectrum", spectrum=spectrum)
    assert not [*problems(wave, basin)]
    sea = fitted_waves(wave.sea(basin), basin)
    assert 4.0 * np.linalg.norm(sea.amplitude) / 2.0**0.5 == pytest.approx(0.3)
    points = np.random.default_rng(0).uniform(-15.0, 15.0, (20, 3))
    np.testing.assert_allclose(waves.elevation(sea, points + [30.0, 0, -30.0]), waves.elevation(sea, points), atol=1e-9)
    row = np.linspace(-15.0, 15.0, 30, endpoint=False)
    grid = np.stack([axis.ravel() for axis in np.meshgrid(row, [-0.5], row)], axis=1)
    positions, velocities, pressures = start_state(wave, grid, basin, 1000.0)
    assert np.isfinite(positions).all() and 0.05 < np.abs(velocities).max() < 2.0
    assert pressures.mean() == pytest.approx(1000.0 * GRAVITY * 0.5, rel=0.05)


def test_taylor_green_is_the_published_field():
    """u = -U cos 2 pi x sin 2 pi y, v = U sin 2 pi x cos 2 pi y, p = -rho U^2 / 4 (cos 4 pi x + cos 4 pi y)."""
    basin = place(**BOX)
    positions, velocities, pressures = start_state(
        initial(kind="taylor_green", speed=2.0), lattice(basin, 8, 8), basin, 3.0
    )
    x, y = 2.0 * pi * (positions[:, 0] + 0.5), 2.0 * pi * (positions[:, 1] + 1.0)
    np.testing.assert_allclose(velocities[:, 0], -2.0 * np.cos(x) * np.sin(y), atol=1e-14)
    np.testing.assert_allclose(velocities[:, 1], 2.0 * np.sin(x) * np.cos(y), atol=1e-14)
    np.testing.assert_allclose(pressures, -0.25 * 3.0 * 4.0 * (np.cos(2 * x) + np.cos(2 * y)), atol=1e-13)


def test_disorder_moves_particles_by_its_share_of_a_spacing_and_the_same_each_time():
    basin = place(**BOX)
    x = lattice(basin, 20, 20)
    wave = initial(kind="taylor_green", speed=1.0, disorder=0.1, seed=4)
    positions = start_state(wave, x, basin, 1.0)[0]
    off = positions - x
    assert 0.09 < np.abs(off).max() / 0.05 < 0.1 and not off[:, 2].any()
    np.testing.assert_array_equal(start_state(wave, x, basin, 1.0)[0], positions)


@pytest.mark.parametrize("ending", ["csv", "npz"])
def test_a_file_gives_places_velocities_and_pressure(tmp_path, ending):
    basin = place(length=2.0, depth=1.0)
    rows = np.random.default_rng(0).uniform([-1, -1, -5, -5, 0], [1, 0, 5, 5, 9], (7, 5))
    path = tmp_path / f"drop.{ending}"
    if ending == "csv":
        np.savetxt(path, rows, delimiter=",", header="x_m,y_m,u_m_s,v_m_s,p_Pa", comments="", fmt="%.17g")
    else:
        np.savez(path, **dict(zip("xyuvp", rows.T)))
    drop = initial(kind="file", path=str(path))
    assert not [*problems(drop, basin)]
    positions, velocities, pressures = start_state(drop, np.zeros((3, 3)), basin, 1000.0)
    np.testing.assert_array_equal(positions[:, :2], rows[:, :2])
    np.testing.assert_array_equal(velocities[:, :2], rows[:, 2:4])
    np.testing.assert_array_equal(pressures, rows[:, 4])
    np.testing.assert_array_equal(given_positions(drop, basin), positions)
    assert given_positions(None, basin) is None


def test_what_a_file_lacks_is_said(tmp_path):
    basin = place(length=2.0, width=1.0, depth=1.0)
    path = tmp_path / "drop.csv"
    assert "there is no such file" in said(basin, kind="file", path=str(path))
    path.write_text("x,y,u,v\n0,0,0,0\n")
    assert "no column z and no column w" in said(basin, kind="file", path=str(path))
    path.write_text("x,y,z,u,v,w\n0,0,0,0,,0\n")
    assert "v is nan in row 1" in said(basin, kind="file", path=str(path))
    path.write_text("x,y,z,u,v,w\n0,0,0,0,0,0\n9,0,0,0,0,0\n")
    assert "1 particles are outside the basin" in said(basin, kind="file", path=str(path))


def test_waves_that_cannot_be_are_said():
    walls, ring = place(length=4.0, depth=0.5), place(**FLUME)
    assert "periodic sides" in said(walls, kind="regular_wave", height=0.04, period=1.2)
    assert "period 1.2" in said(ring, kind="regular_wave", height=0.04, period=1.3)  # 2.31 m: 1.8 waves
    assert "would break" in said(ring, kind="regular_wave", height=0.5, period=1.21738)
    assert "would break" in said(walls, kind="standing_wave", height=2.0, mode=4)
    assert "must be even" in said(ring, kind="standing_wave", height=0.01, mode=1)
    assert "straight down" in said(place(**TANK | {"gravity": (0.0, 0.0, 0.0)}), kind="standing_wave", height=0.1)
    assert "free surface" in said(place(**TANK, lid={}), kind="standing_wave", height=0.1)
    assert "x must be periodic" in said(walls, kind="taylor_green", speed=1.0)
    with pytest.raises(ValidationError, match="either height"):
        initial(kind="standing_wave", height=0.1, amplitude=0.05)
    with pytest.raises(ValidationError):
        initial(kind="tsunami", height=0.1)

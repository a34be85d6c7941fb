"""An open sea that answers: its tiles, its ships and winds, and what kernels read of it."""

from math import pi

import numpy as np
import pytest
from pydantic import ValidationError

from ocean_sim import waves
from ocean_sim.basin import Config as BasinConfig
from ocean_sim.basin.points import grid_points
from ocean_sim.fluid.open_sea.high_order import HighOrder
from ocean_sim.fluid.open_sea.wave_tile import Layer, Tile
from ocean_sim.fluid.spectral_sea import Config, snapped
from ocean_sim.kernel_library import ti
from ocean_sim.parts import SceneFacts
from ocean_sim.reading.scene import load, observer_names
from ocean_sim.result import Result
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.sea import nearest_image, stokes_wave, travel_ahead
from ocean_sim.wind.gusts import Config as Gusts
from ocean_sim.wind.still import Config as Still
from ocean_sim.wind.stress import Config as Stress
from tests.fluid.conftest import read

BAY = {"length": 60.0, "width": 60.0, "depth": 40.0, "walls": "none"}
FLUME = {"length": 60.0, "depth": 40.0, "walls": "none"}
G = 9.81
KNOWN = ("elevation", "velocity", "acceleration")


class Float:
    """Something of some volume that displaces water where it is told to be, evenly down to its draught."""

    def __init__(self, x: float = 0.0, z: float = 0.0, volume: float = 8.0, draught: float = 0.0) -> None:
        self.body, self.volume = Body(np.array([x, 0.0, z])), volume
        self.depths = draught * (np.arange(20) + 0.5) / 20

    def displaced(self):
        x, _, z = self.body.position
        points = np.stack([np.full(20, x), np.full(20, z), self.depths], axis=1)
        return points, np.full(20, self.volume / 20)


class Body:
    def __init__(self, position: np.ndarray) -> None:
        self.position = position


@pytest.fixture(scope="module")
def sea(taichi_cpu):
    """Builds a sea: `sea(basin, wind, **keys of the fluid)`."""

    def build(basin: dict = BAY, wind=None, **keys):
        place = BasinConfig(**basin).build()
        air = (wind or Still()).build(place, 7)
        fluid = Config(**({"cells": 32, "ramp": 0.0} | keys)).build(place, 7, accounts=False, wind=air.on("fluid"))
        fluid.blowing = air
        return fluid

    return build


@pytest.mark.anchor
def test_a_tile_keeps_energy_and_phase_at_any_step():
    tile = Tile(50.0, 32, 32, 30.0, G)
    layer = Layer(tile, rim=False)
    travel_ahead(
        layer, tile.to_values(tile.to_modes(np.random.default_rng(0).normal(size=tile.shape)) * (tile.k < 1.0))
    )
    layer.eta -= layer.eta.mean()
    first, before = tile.energy(layer.eta, layer.phi), tile.to_modes(layer.eta)[3, 2]
    for dt in (0.01, 0.3, 7.0):
        layer.advance(dt, np.zeros(tile.k.shape), np.zeros(2))
    turned = before * np.exp(-1j * tile.omega[3, 2] * 7.31)
    assert tile.energy(layer.eta, layer.phi) == pytest.approx(first, rel=1e-12)
    assert tile.to_modes(layer.eta)[3, 2] == pytest.approx(turned, rel=1e-9)


def test_a_moving_pressure_has_havelocks_resistance_at_second_order_in_the_step():
    """A push that lags by a cell, the way of a step, is the control."""
    from ocean_sim.validation.spectral_wake import PRESSURE_PEAK, havelock_resistance

    found = {}
    for late in (0.0, 1.0):
        tile, u, dt, resistance = Tile(96.0, 96, 96, 500.0, G), 5.0, 0.2, []
        layer = Layer(tile)
        for n in range(1, 401):
            centre = np.array([u * n * dt, 0.0])
            x, z = nearest_image(tile, centre)
            patch = PRESSURE_PEAK / 1000.0 * np.exp(-((x / 3.0) ** 2) - (z / 1.5) ** 2)
            behind = np.roll(patch, -1, axis=0) if late else patch
            layer.advance(dt, tile.to_modes(min(1.0, n * dt / 10.0) * behind), centre)
            if n > 320:
                slope = tile.to_values(tile.slopes(tile.to_modes(layer.eta))[0])
                resistance.append(1000.0 * (patch * slope).sum() * tile.cell**2)
        found[late] = np.mean(resistance) / havelock_resistance(u) - 1.0
    assert abs(found[0.0]) < 0.01 and abs(found[1.0]) > 0.03


def test_what_is_displaced_weighs_as_much_and_lowers_the_water_without_a_mean():
    tile = Tile(40.0, 64, 64, 30.0, G)
    points, volume = np.array([[0.3, -1.1], [5.0, 19.9]]), np.array([3.0, 2.0])
    depth = tile.spread_modes(points, volume)
    assert depth[0, 0].real * tile.cell**2 == pytest.approx(5.0, rel=1e-12)
    layer = Layer(tile)
    layer.begin(G * depth, np.zeros(2), 0.2)
    first = layer.eta.copy()
    assert abs(layer.eta.mean()) < 1e-15
    layer.rim = False
    for _ in range(50):
        layer.advance(0.2, G * depth, np.zeros(2))
    np.testing.assert_allclose(layer.eta, first, atol=1e-12)  # at rest it stays so


def test_kernels_read_the_plane_waves_and_the_current(sea):
    spectrum = {"significant_wave_height": 0.5, "peak_period": 4.0, "spreading": 8.0, "heading_deg": 40.0}
    fluid = sea(spectrum=spectrum, spectra=[{"height": 0.2, "period": 6.0, "heading_deg": 200.0}], current=(1.0, -0.5))
    for dt in (0.1, 3.0):
        fluid.advance(dt)
    points = np.random.default_rng(0).uniform([-20.0, -7.5, -20.0], [20.0, 0.4, 20.0], (100, 3))
    found, moved = read(fluid, points, *KNOWN), points - np.array([3.1, 0.0, -1.55])
    np.testing.assert_allclose(found[:, 0], fluid.elevations(points[:, [0, 2]]), atol=1e-10)
    np.testing.assert_allclose(found[:, 0], waves.elevation(fluid.plane_waves, moved, 3.1), atol=1e-10)
    np.testing.assert_allclose(found[:, 1:4], fluid.velocities(points), atol=1e-10)
    deep = fluid.velocities(np.array([[0.0, -39.0, 0.0]]))[0]
    np.testing.assert_allclose(deep, [1.0, 0.0, -0.5], atol=0.02)
    assert fluid.pressures(np.array([[0.0, -10.0, 0.0]]))[0] == pytest.approx(98100.0, rel=0.02)


@pytest.mark.parametrize("order", [1, 3])
def test_kernels_read_the_tiles_as_python_does(sea, order):
    """The wind's waves at order 1, the nonlinear sea at order 3, against sums over the modes; of waves of eleven cells
    straight lines between them leave out (2 pi / 11)^2 / 8, 4 %."""
    keys = {"order": 3, "height": 0.3, "period": 4.0, "breaking": False} if order == 3 else {"tile": 60.0}
    fluid = sea(wind=None if order == 3 else Stress(u10=5.0), **(keys | {"cells": 64, "step": 0.05}))
    if order == 1:
        travel_ahead(
            fluid.raised.layer, 0.1 * np.cos(2.0 * pi / 10.0 * fluid.tile.nodes()[0])[:, None] + np.zeros((64, 64))
        )
        fluid.write_waves(fluid.raised, fluid.sheets[-1])
        fluid.time = 0.02
        fluid.set_clocks()
    else:
        for _ in range(5):
            fluid.advance(0.03)
    points = np.random.default_rng(0).uniform([-18.0, -6.0, -18.0], [18.0, -0.2, 18.0], (60, 3))
    found, eta = read(fluid, points, *KNOWN), fluid.elevations(points[:, [0, 2]])
    np.testing.assert_allclose(found[:, 0], eta, atol=0.004 * np.abs(eta).max())
    v = fluid.velocities(points)
    np.testing.assert_allclose(found[:, 1:4], v, atol=0.06 * np.abs(v).max())
    omega = 2.0 * pi / 4.0 if order == 3 else np.sqrt(G * 2.0 * pi / 10.0)
    assert np.abs(found[:, 4:]).max() == pytest.approx(omega * np.abs(v).max(), rel=0.1)


def test_the_velocity_at_many_points_of_the_surface_is_that_at_each(sea):
    """Between nodes as the elevation is, within 1 %; at a few points it is the sum over the modes. Under the surface it
    is that for many points, too."""
    fluid = sea(order=3, height=0.3, period=4.0, breaking=False, cells=64, step=0.05, current=(1.0, -0.5))
    for _ in range(5):
        fluid.advance(0.03)
    points = np.insert(grid_points(np.linspace(-15.0, 14.0, 18), np.linspace(-12.0, 11.0, 17)), 1, 0.0, axis=1)
    points[:, 1] = fluid.elevations(points[:, [0, 2]])
    for depth, tolerance in ((0.0, 0.01), (0.1, 1e-12)):
        there = points - [0.0, depth, 0.0]
        each = np.concatenate([fluid.velocities(some) for some in np.array_split(there, 3)])
        still = np.abs(each - [1.0, 0.0, -0.5]).max()
        np.testing.assert_allclose(fluid.velocities(there), each, rtol=0.0, atol=tolerance * still)


@pytest.mark.parametrize("far", [0.0, 9000.0])
def test_a_window_holds_the_waves_within_a_few_thousandths(sea, far):
    """Against the sums over all waves, wherever it lies: elevation to 0.02 % of the significant height; velocity and
    acceleration, whose short waves turn the most, by their own rms to 0.1 and 0.6 %."""
    spectrum = {"significant_wave_height": 1.2, "peak_period": 5.5, "spreading": 12.0, "heading_deg": 150.0}
    fluid = sea(spectrum=spectrum, current=(0.5, 0.0))
    fluid.advance(600.0)
    fluid.advance(0.1)
    size, step, depths = (25, 13), (0.7, 0.5), (0.0, 0.6, 1.2)
    window, heading = fluid.window(size, step, depths), (0.6, 0.8)
    middle = np.array([far + 0.3, -0.5 * far])
    assert not window.now()[2]  # nothing has been laid
    window.lay(middle, heading)
    found = np.zeros((size[0] * size[1] * len(depths), 7))

    @ti.kernel
    def look(late: float, found: ti.types.ndarray(ndim=2)):
        for i, k, l in ti.ndrange(25, 13, 3):
            row = (i * 13 + k) * 3 + l
            v, a = window.moving(i, k, l, late)
            found[row, 0] = window.elevation(i, k, late)
            for c in ti.static(range(3)):
                found[row, 1 + c], found[row, 4 + c] = v[c], a[c]

    i, k, l = (axis.ravel() for axis in np.meshgrid(*(np.arange(n) for n in (*size, 3)), indexing="ij"))
    ahead, aside = (i - 12) * step[0], (k - 6) * step[1]
    x = middle[0] + ahead * heading[0] + aside * heading[1] - fluid.before * fluid.current[0]
    z = middle[1] + ahead * heading[1] - aside * heading[0]
    at = np.stack([x, -np.array(depths)[l], z], axis=1)
    apart = []
    for late in (0.0, 0.2, 0.5, 0.8, 1.0):
        look(late, found)
        time, d = fluid.before + late * window.span, 1e-3
        v = [waves.linear_velocity(fluid.plane_waves, at, time + shift) for shift in (-d, 0.0, d)]
        exact = [waves.elevation(fluid.plane_waves, at, time)[:, None], v[1], (v[2] - v[0]) / (2.0 * d)]
        parts = (found[:, :1], found[:, 1:4], found[:, 4:])
        apart.append([np.sqrt(np.mean((a - b) ** 2) / np.mean(b**2)) for a, b in zip(parts, exact)])
    eta, speed, pull = np.max(apart, axis=0)
    assert eta / 4.0 < 2e-4 and speed < 1e-3 and pull < 6e-3, (eta, speed, pull)
    assert pull > 1e-4  # a cubic it is
    assert window.span > 0.15


def test_a_ship_alone_does_not_feel_what_she_makes_and_others_do(sea):
    alone, pair = sea(tile=60.0), sea(tile=60.0)
    ship, other = Float(), Float(12.0)
    (hers,) = alone.add_ships([ship])
    mine, yours = pair.add_ships([ship, other])
    for n in range(30):
        ship.body.position[0] = 0.1 * n
        alone.advance(0.1)
        pair.advance(0.1)
    points = np.array([[3.0, -0.5, 1.0], [12.0, -0.5, 0.0], [8.0, -0.5, -4.0]])
    assert not read(hers, points, *KNOWN).any()  # calm water, whatever she does
    np.testing.assert_array_equal(
        alone.made[0].layer.eta, pair.made[0].layer.eta
    )  # and the other changes nothing of it
    felt, flat = read(yours, points, *KNOWN), points[:, [0, 2]]
    np.testing.assert_allclose(felt[:, 0], alone.elevations(flat), atol=2e-3)
    np.testing.assert_allclose(mine.elevations(flat) + yours.elevations(flat), pair.elevations(flat), atol=1e-12)
    assert np.abs(alone.elevations(flat)).max() > 0.01
    assert not alone.undisturbed_elevations(flat, alone.elevations(flat)).any()


def test_a_body_at_rest_leaves_the_surface_level_and_one_that_moves_makes_lower_waves_the_deeper_it_is(sea):
    u, height = 4.0, {}
    for draught in (0.0, 2.0):
        water, body = sea(FLUME, tile=120.0, cells=256, step=0.05), Float(draught=draught, volume=0.3)
        water.add_ships([body])
        water.advance(0.05)
        x = np.linspace(4.0, 15.0, 50)
        points = np.stack([x, 0.0 * x], axis=1)
        assert np.ptp(water.elevations(points)) < 1e-4
        for n in range(1, 801):
            body.body.position[0] = u * 0.05 * n
            water.advance(0.05)
        wake = np.stack([u * 40.0 - np.linspace(10.0, 30.0, 400), np.zeros(400)], axis=1)
        height[draught] = water.elevations(wake).std()
    k = G / u**2
    assert height[2.0] / height[0.0] == pytest.approx((1.0 - np.exp(-2.0 * k)) / (2.0 * k), rel=0.01)


def test_a_sea_undisturbed_by_ships_is_what_comes_from_afar_and_what_winds_make(sea):
    gust = Gusts(
        volumes=[{"include": [{"kind": "sphere", "centre": [0, 0, 0], "radius": 6.0}], "acceleration": [0, 2, 0]}]
    )
    keys = {"tile": 60.0, "height": 0.4, "period": 3.0, "current": (0.5, 0.0), "wind": gust}
    fluid, empty = sea(**keys), sea(**keys)
    fluid.add_ships([Float(3.0)])
    for water in (fluid, empty):
        for _ in range(10):
            water.blowing.advance(0.1)
            water.advance(0.1)
    points = np.array([[3.0, 1.0], [-4.0, 2.0], [0.0, -6.0]])
    assert np.abs(fluid.elevations(points) - empty.elevations(points)).max() > 0.01
    found = fluid.undisturbed_elevations(points, fluid.elevations(points))
    np.testing.assert_allclose(found, empty.elevations(points), atol=1e-3)  # the rim is hers
    for water in (fluid, empty):
        there = np.insert(points, 1, water.elevations(points), axis=1)
        np.testing.assert_array_equal(water.surface_velocities(points), water.velocities(there))


def test_a_ship_goes_through_a_sea_that_answers_as_through_one_in_closed_form():
    """To the byte, with and without her push: her own waves are in her law of motion, and count once."""
    ship = {"kind": "dynamic", "hull": "wigley", "velocity": [0.0, 0.0, 1.5]}
    quiet = {name: None for name in observer_names() if name != "manifest"}
    plain = {"basin": BAY, "ship": ship, "runtime": {"threads": 1}, **quiet}
    found, deepest = [], []
    for kind, pushes in (("spectral_sea", True), ("spectral_sea", False), ("linear_waves", False)):
        water = {"kind": kind, "spectrum": {"significant_wave_height": 0.1, "peak_period": 2.0, "spreading": 10.0}}
        with Simulation(load(plain | {"fluid": water})) as simulation:
            if pushes:
                deepest.append(simulation.fluid.made[0])
            elif kind == "spectral_sea":
                simulation.fluid.made.clear()
            simulation.run(1.0)
            body = simulation.ships["ship"].body
            found.append(np.concatenate([body.position, body.orientation, body.velocity, body.angular_momentum]))
    np.testing.assert_array_equal(found[0], found[1])
    np.testing.assert_array_equal(found[0], found[2])
    assert np.abs(deepest[0].layer.eta).max() > 0.01


def test_a_tile_travels_with_her_and_no_number_grows(sea):
    """After 9 km her waves are those that she made after 9 m, in the same place beside her."""
    near, far = sea(tile=60.0, cells=64), sea(tile=60.0, cells=64)
    ships = [Float(), Float(9000.0)]
    for fluid, ship in zip((near, far), ships):
        fluid.add_ships([ship])
        for _ in range(40):
            ship.body.position[0] += 0.5
            fluid.advance(0.1)
    points = np.array([[10.0, 0.0], [16.0, 3.0], [25.0, -2.0]])
    np.testing.assert_allclose(near.elevations(points), far.elevations(points + [9000.0, 0.0]), atol=1e-9)
    assert not far.elevations(np.array([[9020.0 + 40.0, 0.0]])).any()  # off her tile


@pytest.mark.parametrize(
    "wind",
    [
        Gusts(
            volumes=[{"include": [{"kind": "sphere", "centre": [0, 0, 0], "radius": 6.0}], "acceleration": [0, 2, 0]}]
        ),
        Stress(u10=20.0, sheltering=0.3),
    ],
)
def test_winds_press_on_calm_water(sea, wind):
    """A gust that pulls upwards raises the water under it; a sheltered wind makes waves grow that run along with it."""
    fluid = sea(wind=wind, tile=60.0)
    if isinstance(wind, Stress):
        layer = fluid.raised.layer
        layer.rim = False
        z = fluid.tile.nodes()[1]
        layer.eta = 0.05 * np.cos(2.0 * pi / 15.0 * z)[None, :] + np.zeros((32, 1))
        omega = np.sqrt(G * 2.0 * pi / 15.0)
        layer.phi = G / omega * 0.05 * np.sin(2.0 * pi / 15.0 * z)[None, :] + np.zeros((32, 1))
        first = fluid.tile.energy(layer.eta, layer.phi)
    for _ in range(40):
        fluid.blowing.advance(0.1)
        fluid.advance(0.1)
    layer = fluid.raised.layer
    if isinstance(wind, Stress):
        rate = wind.sheltered(20.0) * omega / (1000.0 * (G / omega) ** 2)
        grown = np.log(fluid.tile.energy(layer.eta, layer.phi) / first) / fluid.then
        assert grown == pytest.approx(rate, rel=0.05)
    else:
        assert np.abs(layer.eta).max() > 0.1 and abs(layer.eta.mean()) < 1e-12
        calm = sea(tile=60.0)
        assert not calm.made and not calm.sheets  # absent means absent


def test_a_steep_wave_keeps_speed_and_energy():
    tile = Tile(2.0 * pi, 32, 1, 100.0, G)
    eta, phi, speed = stokes_wave(0.2, 1.0, tile.nodes()[0][:, None])
    wave, dt = HighOrder(tile, 0.0), 2.0 * pi / speed / 60
    wave.begin(eta, phi)
    first, start = wave.energy(), np.angle(tile.to_modes(wave.eta)[1, 0])
    for _ in range(240):
        wave.advance(dt)
    assert wave.energy() == pytest.approx(first, rel=1e-4)
    lag = np.angle(
        tile.to_modes(wave.eta)[1, 0] * np.exp(-1j * start)
    )  # after four periods; linear theory is 28 deg off
    assert abs(lag) < np.radians(0.003 * 360 * 4)


def test_breaking_takes_energy_from_steep_crests_alone_and_books_it(sea):
    for steepness, breaks in ((0.2, False), (0.42, True)):
        k = 2.0 * pi / 10.0
        fluid = sea(FLUME, order=3, tile=40.0, cells=128, height=0.1, period=2.0 * pi / np.sqrt(G * k), onset=0.0)
        wave, tile = fluid.steep.sea, fluid.steep.tile
        wave.begin(*stokes_wave(steepness, k, tile.nodes()[0][:, None])[:2])
        first = wave.energy()
        for _ in range(60):
            wave.advance(0.03)
        assert (wave.breaking.lost > 0.0) == breaks
        assert wave.energy() + wave.breaking.lost == pytest.approx(first, rel=0.03)
        assert wave.energy() < first * (1.0 - 1e-3) or not breaks


def test_where_crests_broke_the_water_is_white_for_a_while_and_the_log_counts_their_energy(tmp_path):
    k = 2.0 * pi / 10.0
    scene = {
        "duration": 1.2,
        "basin": FLUME,
        "fluid": {"kind": "spectral_sea", "order": 3, "tile": 40.0, "cells": 128, "height": 0.1, "onset": 0.0}
        | {"period": 2.0 * pi / np.sqrt(G * k), "ramp": 0.0},
        "frames": {"every": 0.4, "spacing": 0.5},
    }
    quiet = {name: None for name in observer_names() if name not in ("accuracy", "frames", "manifest")}
    config = load(scene, quiet)
    with Simulation(config, tmp_path) as simulation:
        wave = simulation.fluid.steep.sea
        wave.begin(*stokes_wave(0.42, k, wave.tile.nodes()[0][:, None])[:2])
        simulation.run(config.duration)
        broken = wave.breaking
        assert simulation.fluid.work["breaking"] == pytest.approx(-1000.0 * broken.lost)
    works = Result(tmp_path).table("accuracy")["work_breaking_J"]
    assert works[0] == 0.0 and works[-1] < works[len(works) // 2] < 0.0
    foam = [np.load(tmp_path / "frames" / f"frame_{n:05d}.npz")["foam"] for n in (0, 3)]
    assert foam[0].max() == 0.0 and foam[1].max() == pytest.approx(1.0, abs=0.01) and foam[1].min() < 0.5


def test_a_spectrum_fitted_to_a_tile_keeps_its_energy_and_direction():
    spectrum = waves.SpreadSpectrum(significant_wave_height=1.0, peak_period=5.0, spreading=15.0, cut_off=2.0)
    sea = spectrum.components(np.array([0.6, 0.8]), 100.0, G, 4000)
    fitted = snapped(sea, Tile(400.0, 256, 256, 100.0, G))
    assert (fitted.amplitude**2).sum() == pytest.approx((sea.amplitude**2).sum())
    ahead = (fitted.amplitude[:, None] ** 2 * fitted.wavevector / fitted.wavenumber[:, None]).sum(axis=0)
    assert np.degrees(np.arctan2(*ahead)) == pytest.approx(np.degrees(np.arctan2(0.6, 0.8)), abs=0.5)


@pytest.mark.parametrize(
    ("keys", "wrong"),
    [
        ({"tile": 60.0, "cells": 128}, False),
        ({"tile": 60.0, "cells": 32}, False),
        ({"tile": 200.0, "cells": 32}, True),  # all are shorter than four cells
        ({"tile": 2.0, "cells": 32}, True),  # all are longer than the tile
        ({"tile": 2.0, "order": 1}, False),  # whose sea needs no tile
    ],
)
def test_a_nonlinear_sea_that_its_tile_cannot_hold_is_refused(keys, wrong):
    """It would lie still, without a word. What is left out of Pierson and Moskowitz's spectrum beyond n times the peak
    frequency is 1 - exp(-1.25 / n^4) of its energy, n^2 being the peak's wavelength of 14.05 m over four cells."""
    spectrum = {"kind": "pierson_moskowitz", "significant_wave_height": 0.2, "peak_period": 3.0}
    bay, config = (
        SceneFacts({}, BasinConfig(**BAY).build(), 8, 1.0),
        Config(**{"order": 3, "spectrum": spectrum} | keys),
    )
    assert [key for key, _ in config.problems(bay)] == [("tile",)] * wrong
    if not wrong and config.order == 3:
        left_out = 1.0 - np.exp(-1.25 * (4.0 * config.tile / config.cells / 14.05) ** 2)
        assert 1.0 - config.energy_share(bay.tank) == pytest.approx(left_out, rel=0.25)


def test_a_file_of_components_is_the_sea_that_it_says(sea, tmp_path):
    path = tmp_path / "sea.csv"
    path.write_text("amplitude_m,period_s,heading_deg,phase_deg\n0.2,5.0,90.0,30.0\n0.1,3.0,0.0,0.0\n")
    fluid = sea(components=str(path))
    assert fluid.elevations(np.zeros((1, 2)))[0] == pytest.approx(0.2 * np.cos(np.radians(30.0)) + 0.1)
    assert not Config(components=str(path)).like_radians()
    path.write_text("amplitude_m,period_s,heading_deg,phase_deg\n0.2,5.0,0.0,3.05\n0.1,3.0,2.0,0.3\n")
    told = load({"duration": 60.0, "basin": BAY, "fluid": {"kind": "spectral_sea", "components": str(path)}}).warnings()
    assert any("sea.csv: is phase_deg in radians?" in sentence for sentence in told)
    path.write_text("amplitude_m,period_s\n0.2,5.0\n")
    (problem,) = Config(components=str(path)).problems(SceneFacts({}, BasinConfig(**BAY).build(), 8, 1.0))
    assert problem[0] == ("components",) and "heading_deg" in problem[1]


def test_what_is_wrong_is_said():
    bay, flume = (SceneFacts({}, BasinConfig(**basin).build(), 8, 1.0) for basin in (BAY, FLUME))
    spread = {"significant_wave_height": 0.1, "peak_period": 2.0, "spreading": 5.0}
    assert [key for key, _ in Config(spectrum=spread).problems(flume)] == [("spectrum", "spreading")]
    said = Config(spectra=[{"height": 5.0, "period": 2.0}], current=(0.0, 1.0)).problems(flume)
    assert [key for key, _ in said] == [("spectra", 0, "height"), ("current",)]
    oblique = {"order": 3, "height": 0.2, "period": 4.0}
    assert not [*Config(**oblique).problems(bay)]
    assert [key for key, _ in Config(**oblique, tile=70.0).problems(bay)] == [("tile",)]
    with pytest.raises(ValidationError, match="neither"):
        Config(height=0.2)


def test_what_the_model_leaves_out_is_a_note_and_what_a_user_can_mend_a_warning():
    scene = {
        "basin": BAY,
        "fluid": {"kind": "spectral_sea", "height": 0.3, "period": 4.0, "order": 3, "cells": 256},
        "ship": {"kind": "dynamic", "hull": "yacht"},
    }
    config = load(scene)
    assert any("not on herself" in note for note in config.notes)
    assert any("repeats itself after" in note for note in config.notes)
    assert any("take more fluid.cells" in warning for warning in load(scene, {"fluid.cells": 64}).warnings())
    assert not set(config.notes) & set(config.warnings())

"""Circulation and white-cap cover over time of frames whose values are closed forms."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from ocean_sim.waves.orbits import Grid, surface_record


@dataclass
class Seen:
    """A frame."""

    time: float
    elevation: np.ndarray
    position: np.ndarray | None = None
    velocity: np.ndarray | None = None
    origin: np.ndarray = field(default_factory=lambda: np.zeros(2))


SIDE = np.arange(40) - 19.5
CORNER = np.array([20.0, 5.0, 20.0])
WATER = Grid(SIDE, SIDE, -CORNER, CORNER, 5.0, 1.0)
FINE = 0.1 * np.arange(400) - 19.95
CANAL = Grid(FINE, SIDE, -CORNER, CORNER, 5.0, 1.0)
SLICE = Grid(FINE, np.zeros(1), -CORNER * [1, 1, 0], CORNER * [1, 1, 0], 5.0, 1.0)


def turning(time: float, rate: float) -> Seen:
    """Flat water that turns as a whole [rad/s] about the vertical."""
    x, z = (a.ravel() for a in np.meshgrid(SIDE, SIDE, indexing="ij"))
    position = np.stack([x, 0.0 * x, z], axis=1)
    return Seen(time, np.zeros((40, 40)), position, rate * np.stack([z, 0.0 * x, -x], axis=1))


def test_the_circulation_of_water_that_turns_grows_with_its_rate():
    found = surface_record(WATER, [turning(t, 0.1 * t) for t in (0.0, 1.0, 2.0, 3.0)], begin=1.0)
    assert found is not None and found.circulation is not None and found.radius == 10.0
    np.testing.assert_array_equal(found.time, [1.0, 2.0, 3.0])
    np.testing.assert_allclose(found.circulation, 2.0 * np.pi * 100.0 * 0.1 * found.time, rtol=0.02)
    assert found.means() == {"circulation_m2_s": pytest.approx(found.circulation.mean()), "white_cap_cover": 0.0}


def test_the_circle_goes_with_a_patch_that_is_kept_around_its_ship():
    """Water that flows alike everywhere does not turn; about the middle of the basin half of the circle is missing."""
    away, still = np.array([18.0, 0.0]), turning(0.0, 0.0)
    assert still.position is not None
    flow = np.tile([0.0, 0.0, 2.0], (len(still.position), 1))
    frame = Seen(0.0, still.elevation, still.position + np.insert(away, 1, 0.0), flow, away)
    found = surface_record(WATER, [frame], begin=0.0)
    assert found is not None and found.circulation is not None and abs(found.circulation[0]) < 1e-9
    frame.origin = np.zeros(2)
    found = surface_record(WATER, [frame], begin=0.0)
    assert found is not None and found.circulation is not None and abs(found.circulation[0]) > 50.0


def test_frames_without_particles_and_slices_have_white_caps_alone():
    wave = 1.5 * np.cos(np.pi * FINE / 5.0)  # it falls by 0.94 g at its crests
    for grid, elevation in ((CANAL, np.tile(wave[:, None], (1, 40))), (SLICE, wave[:, None])):
        found = surface_record(grid, [Seen(0.0, elevation), Seen(1.0, 0.2 * elevation)], begin=0.0)
        assert found is not None and found.circulation is None and found.means()["circulation_m2_s"] is None
        assert found.cover[0] == pytest.approx(np.arccos(0.4 / (1.5 * np.pi / 5.0)) / np.pi, abs=0.01)
        assert found.cover[1] == 0.0
        assert found.shortest == pytest.approx(4.0 if grid is CANAL else 0.4)  # coarser across than along


def test_no_frame_has_no_record():
    assert surface_record(WATER, [turning(1.0, 0.1)], begin=2.0) is None

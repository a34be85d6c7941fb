"""The strength of a wind that a person moves, without compiling anything, and its lines and arrows where it blows."""

import numpy as np
import pytest

from ocean_sim import runtime

SPHERE = {"kind": "sphere", "radius": 3.0, "centre": [1.0, 0.0, -2.0]}
BOX = {"kind": "box", "half_size": [2.0, 3.0, 5.0], "centre": [1.0, 0.0, 0.5], "yaw_deg": 30.0}
WINDS = {
    "gusts": {"volumes": [{"include": [BOX], "acceleration": [1.0, 2.0, 0.5], "noise": [0.5, 0.5, 0.5], "drift": 2.0}]},
    "vortex": {"core_radius": 4.0, "acceleration": 3.0, "inward": 1.0},
    "stress": {"u10": 12.0, "drag_law": "wu"},
}


@pytest.mark.parametrize("kind", WINDS)
def test_strength_changes_what_is_felt_next_and_compiles_nothing(build, force, kind):
    wind, area = build(kind, **WINDS[kind]), (0.0, 2.0, 0.0)
    wind.advance(0.01)
    before = force(wind, [1.0, -0.5, 0.5], area=area)
    compiled = sum(len(kernel.compiled_kernels) for kernel in runtime.impl.get_runtime().kernels)
    wind.strengthen(2.0)
    after = force(wind, [1.0, -0.5, 0.5], area=area)
    wind.strengthen(1.0)
    again = force(wind, [1.0, -0.5, 0.5], area=area)
    assert sum(len(kernel.compiled_kernels) for kernel in runtime.impl.get_runtime().kernels) == compiled
    if kind == "stress":  # of twice the wind: (2.20) with Wu's coefficient, 0.8 + 0.065 U
        factor = 4.0 * (0.8 + 0.065 * 24.0) / (0.8 + 0.065 * 12.0)
    else:
        factor = 2.0
    np.testing.assert_allclose(after, factor * before, rtol=1e-12)
    np.testing.assert_array_equal(again, before)
    assert np.abs(before).max() > 0.0


def test_a_box_is_drawn_by_its_twelve_edges_where_it_is_now(build):
    wind = build("gusts", **WINDS["gusts"])
    for _ in range(100):
        wind.advance(0.01)
    drawing = wind.drawing()
    assert drawing.lines.shape == (12, 2, 3)
    lengths = np.sort(np.linalg.norm(drawing.lines[:, 1] - drawing.lines[:, 0], axis=1))
    np.testing.assert_allclose(lengths, np.repeat([4.0, 6.0, 10.0], 4))
    centre = np.array([1.0, 0.0, 0.5]) + 2.0 * np.array([1.0, 0.0, 0.5]) / np.hypot(1.0, 0.5)
    np.testing.assert_allclose(drawing.lines.mean(axis=(0, 1)), centre)
    np.testing.assert_allclose(drawing.tails.mean(axis=0), centre)


def test_the_lines_of_a_volume_lie_on_its_border(build, force):
    """A little inside it blows, a little outside it does not."""
    for shape in (SPHERE, BOX):
        wind = build("gusts", volumes=[{"include": [shape], "acceleration": [1.0, 0.0, 0.0]}])
        centre = np.array(shape["centre"])
        ends = wind.drawing().lines.reshape(-1, 3) - centre
        assert (force(wind, centre + 0.999 * ends)[:, 0] == 1.0).all()
        assert (force(wind, centre + 1.001 * ends)[:, 0] == 0.0).all()


def test_arrows_point_where_the_wind_pushes(build, force):
    for kind in ("gusts", "vortex"):
        wind = build(kind, **WINDS[kind])
        drawing = wind.drawing()
        felt = force(wind, drawing.tails)
        if kind == "gusts":
            felt = np.tile([1.0, 2.0, 0.5], (len(drawing.tails), 1))  # without its noise
        along, length = (felt * drawing.arrows).sum(axis=1), np.linalg.norm(drawing.arrows, axis=1)
        np.testing.assert_allclose(along, np.linalg.norm(felt, axis=1) * length, rtol=1e-9)
        np.testing.assert_allclose(length, 1.0)
        wind.strengthen(0.5)
        np.testing.assert_allclose(wind.drawing().arrows, 0.5 * drawing.arrows)


def test_still_air_shows_nothing(build):
    wind = build("still")
    wind.strengthen(3.0)
    assert not len(wind.drawing().lines) and not len(wind.drawing().tails)

"""What pictures add to the water of a run: wakes, a wanted cover of foam, boxes of concrete; and sets of pictures."""

import numpy as np
import pytest

from ocean_sim.observers import render
from ocean_sim.pictures import obstacles, opengl, wake
from ocean_sim.pictures.camera import Track, Vessel

with_opengl = pytest.mark.skipif(opengl.probe() is not None, reason="no OpenGL on this machine")
NODES = np.arange(-60.0, 60.1, 0.5)


def steaming(speed: float) -> wake.Wake:
    """A ship of 15 m that goes along +z for 12 s, at z = 0 at the end."""
    time = np.linspace(0.0, 12.0, 25)
    place = np.stack([0.0 * time, 0.0 * time, speed * (time - 12.0)], axis=1)
    track = Track(time, place, np.tile(np.eye(3), (25, 1, 1)))
    return wake.Wake(Vessel(15.0, np.zeros(3), track), 4.0, NODES, NODES)


def test_a_wake_lies_where_the_stern_was_and_fades_with_age():
    share = steaming(4.0).share(12.0, np.zeros(2))
    middle, stern = np.abs(NODES).argmin(), -wake.STERN * 15.0
    on_track = share[middle]
    assert not on_track[NODES > stern + 4.0].any()  # none before the stern
    behind = on_track[(NODES < stern - 1.0) & (NODES > stern - 40.0)]
    assert (np.diff(behind) > 0.0).all() and behind.max() <= wake.WHITEST
    ages = (stern - NODES[(NODES < stern - 1.0) & (NODES > stern - 40.0)]) / 4.0
    step = 12.0 / (wake.STEPS - 1)  # [s] between the places of the stern that are kept
    wanted = wake.WHITEST * np.exp(-ages / wake.LASTS)
    np.testing.assert_allclose(behind, wanted, rtol=np.expm1(step / wake.LASTS))
    np.testing.assert_allclose(share, share[::-1], atol=1e-9)  # the same on both sides
    assert not share[np.abs(NODES) > 8.0].any()


def test_a_wake_stays_where_it_is_while_the_nodes_follow_the_ship():
    there, then = steaming(4.0).share(12.0, np.zeros(2)), steaming(4.0).share(12.0, np.array([0.0, -10.0]))
    np.testing.assert_allclose(there[:, :-20], then[:, 20:], atol=1e-12)


def test_a_ship_that_rests_leaves_no_wake():
    assert not steaming(0.0).share(12.0, np.zeros(2)).any()
    assert steaming(2.0).share(12.0, np.zeros(2)).max() == pytest.approx(
        0.5 * steaming(4.0).share(12.0, np.zeros(2)).max(), rel=0.05
    )


def test_a_box_has_six_faces_that_look_outwards():
    low, up = np.array([1.0, -2.0, 3.0]), np.array([2.0, 0.5, 3.5])
    points, normals = obstacles.faces(low, up)
    assert points.shape == normals.shape == (24, 3)
    assert ((points == low) | (points == up)).all()
    middle = points.reshape(6, 4, 3).mean(axis=1)
    outwards = ((middle - 0.5 * (low + up)) * normals[::4]).sum(axis=1)
    np.testing.assert_allclose(np.sort(outwards), np.sort(np.tile(0.5 * (up - low), 2)))
    sides = points.reshape(6, 4, 3)
    area = np.linalg.norm(np.cross(sides[:, 1] - sides[:, 0], sides[:, 3] - sides[:, 0]), axis=1).sum()
    assert area == pytest.approx(2.0 * (1.0 * 2.5 + 2.5 * 0.5 + 1.0 * 0.5))


@pytest.fixture(scope="module")
def tank(tmp_path_factory):
    """One frame of still water with, in `grid.npz`, a box that stands out of it."""
    folder = tmp_path_factory.mktemp("tank")
    (folder / "frames").mkdir()
    axis = np.arange(-3.75, 4.0, 0.5)
    box = np.array([[[-1.0, -2.0, -1.0], [1.0, 1.0, 1.0]]])
    ground = {"x": axis, "z": axis, "lower": [-4.0, -2.0, -4.0], "upper": [4.0, 0.0, 4.0], "depth": 2.0}
    ground |= {"spacing": 0.5, "every": 1.0, "has_surface": True, "obstacles": box}
    np.savez(folder / "frames" / "grid.npz", **{key: np.array(value) for key, value in ground.items()})
    np.savez(folder / "frames" / "frame_00000.npz", time=0.0, elevation=np.zeros((16, 16)))
    (folder / "manifest.json").write_text('{"scene": {"basin": {"obstacles": [1]}}}')
    return folder


@with_opengl
def test_an_obstacle_is_drawn_as_grey_concrete_in_blue_water(tank):
    pictures = render.variants(tank, 0.0, [{"camera": "top"}, {"camera": "third_person"}], size=(160, 120))
    assert pictures.shape == (2, 120, 160, 3)
    top = pictures[0].astype(float)
    red, _, blue = top[55:65, 75:85].mean(axis=(0, 1))
    assert red > 0.9 * blue  # concrete in the middle
    red, _, blue = top[55:65, 110:115].mean(axis=(0, 1))
    assert red < 0.8 * blue  # water beside it


def test_a_set_of_pictures_at_a_time_without_frames_is_refused(tank):
    with pytest.raises(render.RenderFailed, match="reach from 0 to 0 s"):
        render.variants(tank, 3.0, [{}], size=(160, 120))

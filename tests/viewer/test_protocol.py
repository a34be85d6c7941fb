"""Packets come back as they were sent, within what they are rounded to; nothing but a command is taken."""

import json
import zlib

import numpy as np
import pytest

from ocean_sim.viewer import protocol as p
from ocean_sim.viewer.still import shared_exponent
from tests.viewer import page_packets


def test_a_packet_comes_back():
    arrays = {
        "height": np.linspace(-2.0, 2.0, 7).astype(np.float16),
        "speed": np.arange(5, dtype=np.uint8),
        "poses": np.array([[1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0]], np.float32),
    }
    data = p.packet("frame", arrays, {"speed": {"high": 3.0}}, time=1.5)
    for sent in (data, zlib.compress(data)):
        head, found = page_packets.unpack(sent)
        assert head["kind"] == "frame" and head["time"] == 1.5 and head["arrays"][1]["high"] == 3.0
        assert all(
            np.array_equal(found[name], array) and found[name].dtype == array.dtype for name, array in arrays.items()
        )
    assert data.startswith(p.PACKET_MAGIC)


def test_positions_in_a_box_are_kept_to_half_a_step():
    low, high = np.array([-20.0, -7.5, -3.0]), np.array([20.0, 15.0, 3.0])
    inside = low + np.random.default_rng(1).random((500, 3)) * (high - low)
    back = page_packets.opened(p.box_positions(inside, low, high), low, high)
    assert np.abs(back - inside).max(axis=0) == pytest.approx((high - low) / p.FULL_SCALE / 4.0, rel=0.05)
    assert (p.box_positions(np.array([[99.0, -99.0, np.nan]]), low, high) == [[p.FULL_SCALE, -p.FULL_SCALE, 0]]).all()


def test_differences_add_up_again():
    values = np.random.default_rng(2).integers(-32768, 32768, (9, 40)).astype(np.int16)
    assert np.array_equal(page_packets.summed(p.moment_differences(values)), values)


@pytest.mark.parametrize(
    "message",
    [
        *("", "null", "[]", "{", '"do"', '{"do": "fly"}', '{"do": "speed"}', '{"do": "speed", "value": 1e9}'),
        *('{"do": "steer", "ship": "a", "throttle": NaN, "rudder": 0}', '{"do": "pause", "more": 1}'),
        *('{"do": "save", "name": "../../x"}', '{"do": "slide", "key": "k", "value": "1"}', "[" * 5000),
        json.dumps({"do": "change", "key": "k" * 300, "value": "1"}),
    ],
)
def test_what_is_no_command_is_refused(message):
    with pytest.raises(p.BadMessage, match="not a command"):
        p.parse_command(message)


def test_commands():
    assert p.parse_command('{"do": "pause"}') == p.Act(do="pause")
    assert p.parse_command('{"do": "steer", "ship": "tug", "throttle": 1, "rudder": -0.2}').throttle == 1.0
    assert p.parse_command('{"do": "route", "ship": "tug", "points": [[1, 2], [3.5, 4]]}').points == [
        (1.0, 2.0),
        (3.5, 4.0),
    ]


def test_colours_with_a_shared_exponent_are_kept_to_a_half_percent_of_the_brightest():
    image = np.random.default_rng(3).random((8, 8, 3)) * np.array([0.01, 1.0, 40.0])
    word = shared_exponent(image)
    unit = 2.0 ** ((word >> 27).astype(float) - 15 - 9)
    back = np.stack([(word >> shift & 511) * unit for shift in (0, 9, 18)], axis=-1)
    assert (np.abs(back - image).max(axis=-1) <= 0.005 * image.max(axis=-1)).all()

"""Metacentric heights by the faces of a hull against closed forms, and where its cubes differ from them."""

import json

import pytest

from ocean_sim.__main__ import run_command_line
from ocean_sim.parts import ALONE
from ocean_sim.reading.scene import load
from ocean_sim.ship.hull.hull import Hull, hull_of
from ocean_sim.ship.naval.hydrostatics import metacentric_heights


def heights(hull):
    return metacentric_heights(hull.shape, hull.in_still_water(6.0, 1000.0, 9.81))


def test_a_box_has_its_closed_form():
    """KB + B^2 / 12 T - KG, 20 x 8 m on 2 m, KG 2.5 m."""
    assert heights(hull_of("barge20")) == pytest.approx((1.0 + 64.0 / 24.0 - 2.5, 1.0 + 400.0 / 24.0 - 2.5), rel=1e-4)


def test_a_wedge_has_its_closed_form():
    """Breadth b at the water on a draught T: KB = 2 T / 3, BM = b^2 / 6 T across and L^2 / 6 T along."""
    length, breadth, height, draught, kg = 6.0, 4.0, 2.0, 1.2, 1.0
    points = [[breadth / 2, height, z] for z in (-3.0, 3.0)] + [[0.0, 0.0, z] for z in (-3.0, 3.0)]
    b = breadth * draught / height
    wedge = Hull.model_validate(
        {
            "shape": {"kind": "outline", "points": points},
            "mass": 500.0 * b * draught * length,
            "centre_of_mass": [0.0, kg, 0.0],
        }
    )
    km = 2.0 * draught / 3.0 + b**2 / 6.0 / draught, 2.0 * draught / 3.0 + length**2 / 6.0 / draught
    assert heights(wedge) == pytest.approx((km[0] - kg, km[1] - kg), rel=1e-9)


def test_a_hull_that_is_round_or_sinks_has_none():
    assert heights(hull_of("sphere")) is None
    barge = hull_of("barge20")
    assert heights(barge.model_copy(update={"mass": 1.0e6})) is None


def test_check_states_both_and_warns_where_the_cubes_differ(capsys):
    """The yacht's flare lies within a cube's height: her cubes are as broad as she is a little above the water."""
    assert run_command_line(["check", "showcase", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    (yacht,) = found["ships"].values()
    assert yacht["gm_of_faces_m"] == pytest.approx(0.8115, abs=1e-3) and yacht["gm_m"] == pytest.approx(0.895, abs=1e-3)
    assert any(
        "GM of the ship's cubes is 0.895 m, that of her hull 0.811 m" in warning for warning in found["warnings"]
    )
    assert run_command_line(["check", "showcase"]) == 0
    assert (
        "GM by her cubes 0.895 m in roll (0.811 m by the faces of her hull), 16.2 m in pitch" in capsys.readouterr().out
    )
    assert any("6.25 rows of cubes are under water" in warning for warning in found["warnings"])
    half = load("showcase", {"ship.cells_per_draught": 7.5})
    assert not any("cubes is" in warning for warning in half.ships[ALONE].warnings(half.preflight))
    barge = load("showcase", {"ship": "barge20", "basin.length": 80.0, "basin.width": 80.0})
    assert not any("cubes is" in warning for warning in barge.ships[ALONE].warnings(barge.preflight))


def test_a_ship_that_floats_by_pressure_has_periods_with_the_mass_of_the_water():
    """Of kind `hydrostatic` the law has none, and heaves in 2 pi sqrt(draught / g)."""
    scene = {"basin.length": 80.0, "basin.width": 80.0, "fluid": {"kind": "delta_sph", "spacing": 2.0}, "surface": None}
    by = {
        kind: load("showcase", scene | {"ship": {"kind": kind, "hull": "barge20"}, "surface": surface})
        for kind, surface in (("hydrostatic", {"kind": "cloth"}), ("pressure", None))
    }
    heave = {kind: found.ships[ALONE].floats(found.preflight).periods["heave"] for kind, found in by.items()}
    assert heave["hydrostatic"] == pytest.approx(2.837, rel=0.01)
    assert heave["pressure"] == pytest.approx(4.25, rel=0.02)


def test_a_picture_needs_a_name_that_says_its_format(capsys, tmp_path):
    assert run_command_line(["hull", "barge20", "--cells", "4", "--out", str(tmp_path / "folder")]) == 2
    assert "is no picture's name: end it in .png, .svg or .pdf" in capsys.readouterr().err

"""What is likely to be a mistake is told before it runs, and what is sound is not."""

import pytest

import ocean_sim
from ocean_sim.files.yaml_file import SceneError

TANK = {"length": 20.0, "width": 20.0, "depth": 2.0}
SHIP = {"kind": "hydrostatic", "hull": "wigley"}
WATER = {"kind": "mueller", "spacing": 0.5}
SLICE = {"length": 4.0, "depth": 1.0}


def told(**parts) -> list[str]:
    over = {"surface": "cloth"} if "ship" in parts and parts["fluid"]["kind"] != "linear_waves" else {}
    return ocean_sim.load({"duration": 1.0, "render": None} | over | parts).warnings()


@pytest.mark.parametrize("contact", [{}, {"contact": None}])
def test_a_ship_larger_than_the_tank_is_refused_however_it_touches_the_water(contact):
    with pytest.raises(SceneError, match="hull"):
        told(basin=TANK | {"length": 0.2, "width": 0.2}, fluid=WATER | {"spacing": 0.05}, ship=SHIP | contact)
    narrow = TANK | {"width": 1.0}  # it fits when it lies along x
    with pytest.raises(SceneError, match="hull"):
        told(basin=narrow, fluid=WATER | {"spacing": 0.1}, ship=SHIP | contact)
    told(basin=narrow, fluid=WATER | {"spacing": 0.1}, ship=SHIP | contact | {"heading_deg": 90.0})


SEA = {"kind": "linear_waves", "height": 0.1, "period": 3.0}
CORNER = {"fill": [{"min": [-10.0, -2.0, -10.0], "max": [-5.0, 0.0, 10.0]}]}
BAD = {
    "only the basin": ({"basin": TANK | {"width": 0.2}, "fluid": SEA}, {"basin": TANK, "fluid": SEA}, SHIP),
    "only a bed carries the ship": (
        {"basin": TANK, "fluid": WATER | {"kind": "ballistic"}},
        {"basin": TANK, "fluid": WATER},
        SHIP,
    ),
    "no water under the ship": (
        {"basin": TANK, "fluid": WATER | CORNER, "ship": SHIP | {"position": [5.0, 0.0]}},
        {"basin": TANK, "fluid": WATER | CORNER, "ship": SHIP | {"position": [-7.0, 0.0]}},
        None,
    ),
    "has no floor": (
        {"basin": SLICE | {"floor": "none"}, "fluid": WATER},
        {"basin": SLICE | {"floor": "no_slip"}, "fluid": WATER},
        None,
    ),
    "gravity points upwards": (
        {"basin": SLICE | {"gravity": [0.0, 9.81, 0.0]}, "fluid": WATER},
        {"basin": SLICE},
        None,
    ),
    "single precision": (
        {
            "basin": {"length": 120000.0, "depth": 2.0},
            "fluid": WATER | {"fill": [{"min": [59900.0, -2.0], "max": [59950.0, 0.0]}]},
        },
        {
            "basin": {"length": 120000.0, "depth": 2.0},
            "fluid": WATER | {"fill": [{"min": [59900.0, -2.0], "max": [59950.0, 0.0]}]},
            "runtime": {"precision": "f64"},
        },
        None,
    ),
}


@pytest.mark.parametrize("words", BAD)
def test_a_likely_mistake_is_told_and_its_cure_is_not(words):
    bad, good, ship = BAD[words]
    ship = {"ship": ship} if ship is not None else {}
    assert any(words in sentence for sentence in told(**bad | ship))
    assert not any(words in sentence for sentence in told(**{"fluid": WATER} | good | ship))


def test_a_step_longer_than_a_thousand_rows_has_two(tmp_path):
    """Ten thousand rows lie on the line between two states 1000 s apart, and say no more than its ends."""
    scene = {"duration": 5000.0, "basin": TANK | {"walls": "none"}, "fluid": SEA, "render": None, "frames": None}
    scene |= {"time_step": {"kind": "fixed", "dt": 1000.0}, "runtime": {"threads": 1}}
    time = ocean_sim.run(scene, tmp_path / "run").accuracy["time_s"]
    assert len(time) == 11 and time[0] == 0.0 and time[-1] == 5000.0

"""Stability of loaded ships against closed forms of a box, and the verbs that print it."""

import json
from math import atan, degrees, radians, sin, tan

import numpy as np
import pytest

from ocean_sim.__main__ import answered
from ocean_sim.ship.shared.hull import hull_of
from ocean_sim.ship.shared.stability import CROSS, Loading, Stability

BREADTH, DRAUGHT, KG = 8.0, 2.0, 2.5  # [m] of barge20, which is 20 m long and 4 m high
GM = DRAUGHT / 2.0 + BREADTH**2 / 12.0 / DRAUGHT - KG


@pytest.fixture(scope="module")
def barge():
    return hull_of("barge20").afloat(8.0, 1000.0, 9.81)


@pytest.fixture
def ask(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def asked(*words):
        code = answered([*map(str, words)])
        return code, *capsys.readouterr()

    return asked


def test_areas_of_a_barge_are_those_of_its_sections(barge):
    """By clipping polygons: 0.1830 and 0.3207 m rad to 30 and 40 degrees, 0.800 m at 35 degrees, 0 at 73.15."""
    found = Stability(barge)
    to_thirty, to_forty, between, lever, heel, gm = (row.value for row in found.criteria)
    assert to_thirty == pytest.approx(0.1830, rel=0.02) and to_forty == pytest.approx(0.3207, rel=0.02)
    assert between == pytest.approx(0.1377, rel=0.02) and lever == pytest.approx(0.800, rel=0.02)
    assert (
        heel == pytest.approx(35.0, abs=1.5)
        and found.vanishing == pytest.approx(73.15, abs=0.5)
        and gm == pytest.approx(GM, rel=0.02)
    )
    assert all(row.ok for row in found.criteria)


def test_a_free_surface_costs_what_its_second_moment_says(barge):
    loading = Loading.model_validate(
        {
            "light": {"mass": 3.0e5, "at": [0.0, 2.5, 0.0]},
            "weights": {"crate": {"mass": 1.0e4, "at": [0.0, 2.5, 5.0]}},
            "tanks": {"fuel": {"mass": 1.0e4, "at": [0.0, 2.5, -5.0], "length": 5.0, "breadth": 4.0, "density": 900.0}},
        }
    )
    mass, centre = loading.matter
    assert mass == 3.2e5 and centre == pytest.approx([0.0, 2.5, 0.0])
    lost = 900.0 * 5.0 * 4.0**3 / 12.0 / mass
    found, dry = Stability(barge, loading.moment / mass), Stability(barge)
    assert found.gm == pytest.approx(dry.gm - lost)
    assert found.levers - dry.levers == pytest.approx(-lost * np.sin(np.radians(found.heels)))


def test_water_comes_in_where_the_edge_of_the_deck_goes_under_and_no_area_counts_beyond(barge):
    found = Stability(barge, openings={"hatch": (4.0, 4.0, 0.0), "vent": (0.0, 6.0, 0.0)})
    angle, where = found.flooding
    assert angle == pytest.approx(degrees(atan(2.0 * DRAUGHT / BREADTH)), abs=0.5) and where == "hatch"
    to_thirty, to_flooding, between = (row.value for row in found.criteria[:3])
    assert to_thirty == to_flooding and between == 0.0


def test_cross_curves_do_not_know_the_centre_of_mass(barge):
    mass, levers = list(Stability(barge).cross_curves().items())[3]
    heel = CROSS[1]
    wall_sided = (GM + 0.5 * BREADTH**2 / 12.0 / DRAUGHT * tan(radians(heel)) ** 2) * sin(radians(heel))
    assert mass == barge.matter.mass and levers[1] == pytest.approx(wall_sided + KG * sin(radians(heel)), rel=0.01)


def test_a_weight_that_is_moved_aft_trims_the_ship(ask, tmp_path):
    """w d / (m GM_L): 10 t by 5 m, 0.5903 degrees."""
    (tmp_path / "load.yaml").write_text(
        "light: {mass: 310000, at: [0, 2.5, 0]}\nweights:\n  crate: {mass: 10000, at: [0, 2.5, -5]}\n"
    )
    code, out, _ = ask("hull", "barge20", "--loading", "load.yaml", "--cells", 6, "--json")
    answer = json.loads(out)
    assert code == 0 and answer["trim_deg"] == pytest.approx(-0.5903, rel=0.03)  # the bow goes up
    assert answer["displacement_kg"] == 320000.0 and abs(answer["heel_deg"]) < 0.01


def test_a_centre_of_mass_a_draught_and_a_ship_of_a_scene_are_taken(ask, tmp_path):
    code, out, _ = ask("hull", "wigley", "--kg", 0.17, "--mass", 75, "--cells", 6, "--json")
    assert code == 0 and json.loads(out)["gm_m"] == pytest.approx(0.1583304 - 0.17, abs=0.001)
    assert "90 deg or more" in ask("hull", "wigley", "--kg", 0.12, "--cells", 6)[1]
    code, out, _ = ask("hull", "barge20", "--draught", 1.0, "--cg", "0,1.0,0", "--cells", 6, "--json", "--cross")
    found = json.loads(out)
    assert found["displacement_kg"] == pytest.approx(160000.0, rel=0.01) and found["cross"]
    assert found["gm_m"] == pytest.approx(0.5 + 64.0 / 12.0 - 1.0, rel=0.02)
    code, out, _ = ask("hull", "gallery/yacht_in_waves", "--cells", 4, "--json")
    assert code == 0 and json.loads(out)["displacement_kg"] == 30000.0
    code, _, err = ask("hull", "gallery/two_ships")
    assert code == 2 and "name one with --ship: " in err
    code, _, err = ask("hull", "barge20", "--draught", 5.0)
    assert code == 2 and "the hull is 4 m high" in err
    (tmp_path / "load.yaml").write_text("light: {mass: 1, at: [0, 0, 0]}\ntank: {}\n")
    code, _, err = ask("hull", "barge20", "--loading", "load.yaml")
    assert code == 2 and "load.yaml:2:1: tank: unknown key; did you mean 'tanks'?" in err


@pytest.mark.parametrize(
    "options",
    [("--mass", 75, "--draught", 0.1), ("--kg", 0.12, "--cg", "0,0.1,0"), ("--loading", "a.yaml", "--kg", 0.1)],
)
def test_two_options_that_say_the_same_are_refused(ask, options):
    code, _, err = ask("hull", "wigley", *options)
    assert code == 2 and f"{options[0]} and {options[2]} each say" in err


def test_check_states_how_a_ship_floats(ask):
    code, out, _ = ask("check", "gallery/yacht_in_waves", "--json")
    (ship,) = json.loads(out)["ships"].values()
    assert code == 0 and ship["displacement_kg"] == 30000.0 and ship["gm_m"] > 0.0
    assert ship["periods_s"]["heave"] > 1.0
    code, out, _ = ask("check", "gallery/yacht_in_waves")
    assert "draught" in out and "GM" in out and "natural periods: heave" in out

"""Stability of loaded ships against closed forms of a box, and the verbs that print it."""

import json
from dataclasses import replace
from math import atan, degrees, radians, sin, sqrt, tan

import numpy as np
import pytest

from ocean_sim.__main__ import run_command_line
from ocean_sim.ship.hull.hull import hull_of
from ocean_sim.ship.naval.stability import CROSS_HEELS, Loading, Stability

BREADTH, DRAUGHT, KG = 8.0, 2.0, 2.5  # [m] of barge20, which is 20 m long and 4 m high
GM = DRAUGHT / 2.0 + BREADTH**2 / 12.0 / DRAUGHT - KG


@pytest.fixture(scope="module")
def barge():
    return hull_of("barge20").in_still_water(8.0, 1000.0, 9.81)


@pytest.fixture
def ask(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def asked(*words):
        code = run_command_line([*map(str, words)])
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
        and found.vanishing_heel == pytest.approx(73.15, abs=0.5)
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
    along = 900.0 * 4.0 * 5.0**3 / 12.0 / mass
    assert loading.free_surface_loss == pytest.approx((lost, along))
    wet = replace(barge, free_surface_loss=loading.free_surface_loss)
    found, dry = Stability(wet), Stability(barge)
    assert found.gm == pytest.approx(dry.gm - lost)
    assert found.levers - dry.levers == pytest.approx(-lost * np.sin(np.radians(found.heels)))
    assert wet.metacentric_height(0) == pytest.approx(barge.metacentric_height(0) - along)
    assert wet.periods(np.zeros(6))["roll"] == pytest.approx(
        barge.periods(np.zeros(6))["roll"] * sqrt(dry.gm / found.gm)
    )


def test_a_list_is_that_of_the_free_surface_too_and_levers_are_those_of_the_side_to_which_she_lies(ask, tmp_path):
    """A crate of 40 t, 0.2 m to port: w d / (m GM), without what the fuel costs; trim, draughts by w d / (m GM_L)."""
    (tmp_path / "load.yaml").write_text(
        "light: {mass: 250000, at: [0, 2.5, 0]}\n"
        "weights: {cargo: {mass: 40000, at: [0.2, 3.0, 1.0]}}\n"
        "tanks: {fuel: {mass: 30000, at: [0, 1.0, -4.0], length: 4.0, breadth: 6.0, density: 850.0}}\n"
    )
    kg = (250.0 * 2.5 + 40.0 * 3.0 + 30.0 * 1.0) / 320.0
    across = GM + KG - kg - 850.0 * 4.0 * 6.0**3 / 12.0 / 3.2e5
    along = DRAUGHT / 2.0 + 20.0**2 / 12.0 / DRAUGHT - kg - 850.0 * 6.0 * 4.0**3 / 12.0 / 3.2e5
    code, out, _ = ask("hull", "barge20", "--loading", "load.yaml", "--cells", 8, "--json")
    found = json.loads(out)
    assert code == 0 and found["gm_m"] == pytest.approx(across, rel=0.005)
    assert found["gm_longitudinal_m"] == pytest.approx(along, rel=0.005)
    list_deg, trim_deg = degrees(atan(40.0 * 0.2 / 320.0 / across)), degrees(atan((40.0 - 120.0) / 320.0 / along))
    assert found["heel_deg"] == pytest.approx(-list_deg, rel=0.01) and found["trim_deg"] == pytest.approx(
        trim_deg, rel=0.01
    )
    dip = 10.0 * tan(radians(trim_deg))
    assert found["draught_fore_m"] == pytest.approx(DRAUGHT + dip, abs=0.005)
    assert found["draught_aft_m"] == pytest.approx(DRAUGHT - dip, abs=0.005)
    levers = {row["heel_deg"]: row["gz_m"] for row in found["gz"]}
    ten = radians(10.0)
    wall_sided = sin(ten) * (across + 0.5 * BREADTH**2 / 12.0 / DRAUGHT * tan(ten) ** 2) - 0.025 * np.cos(ten)
    assert found["gz_to"] == "port" and levers[0.0] == pytest.approx(-0.025, abs=1e-4)
    assert levers[10.0] == pytest.approx(wall_sided, rel=0.01)
    code, out, _ = ask("hull", "barge20", "--loading", "load.yaml", "--cells", 8)
    assert code == 0 and "deg to port" in out and "deg by the stern" in out and "heel to port [deg]" in out


def test_an_unstable_barge_lolls_where_the_wall_sided_formula_says():
    """tan^2 = -2 GM / BM, within the deck's edge at 26.6 degrees."""
    found = Stability(
        hull_of("barge20").model_copy(update={"centre_of_mass": (0.0, 3.8, 0.0)}).in_still_water(8.0, 1000.0, 9.81)
    )
    assert found.gm < 0.0 and found.rest_heel == pytest.approx(
        degrees(atan(sqrt(-2.0 * (GM + KG - 3.8) * DRAUGHT * 12.0) / BREADTH)), abs=0.5
    )
    assert found.vanishing_heel > found.rest_heel + 5.0


def test_water_comes_in_where_the_edge_of_the_deck_goes_under_and_no_area_counts_beyond(barge):
    found = Stability(barge, openings={"hatch": (4.0, 4.0, 0.0), "vent": (0.0, 6.0, 0.0)})
    angle, where = found.flooding_heel
    assert angle == pytest.approx(degrees(atan(2.0 * DRAUGHT / BREADTH)), abs=0.5) and where == "hatch"
    to_thirty, to_flooding, between = (row.value for row in found.criteria[:3])
    assert to_thirty == to_flooding and between == 0.0
    lever, heel = found.criteria[3], found.criteria[4]
    assert lever.value == 0.0 and not lever.ok and heel.value == pytest.approx(angle, abs=0.1)  # no lever counts beyond


def test_cross_curves_do_not_know_the_centre_of_mass(barge):
    mass, levers = list(Stability(barge).cross_curves().items())[3]
    heel = CROSS_HEELS[1]
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
    ("options", "sentence"),
    [
        (("--kg", "nan"), "--kg: expected finite numbers"),
        (("--mass", "inf"), "--mass: expected finite numbers"),
        (("--cg", "0,nan,0"), "--cg: expected finite numbers"),
        (("--ship", "tug"), "--ship names one of the ships of a scene, and barge20 is none"),
        (("--bilge-keels", "60,0.2"), "60 m are longer than her waterline of 20 m"),
    ],
)
def test_options_that_cannot_be_meant_are_refused(ask, options, sentence):
    code, _, err = ask("hull", "barge20", "--cells", 4, *options)
    assert code == 2 and sentence in err


@pytest.mark.parametrize(("name", "meant"), [("two_ships", "gallery/two_ships"), ("bargee", "barge20")])
def test_a_wrong_name_gets_the_likeliest(ask, name, meant):
    code, _, err = ask("hull", name)
    assert code == 2 and f"did you mean '{meant}'?" in err


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--cg", "30,2.5,0"), "within 30 degrees of trim and heel she has no pose at rest"),
        (
            ("--cg", "30,2.5,0"),
            "her centre of mass, (30, 2.5, 0) m, lies outside the hull, which takes -4 to 4, 0 to 4",
        ),
        (("--kg", 3.8), "unstable upright: GM = -0.135 m; she lolls to 17"),
        (("--kg", 6.0), "no lever rights her"),
        (("--draught", 0.1, "--cells", 64), "0.875 cubes over the draught, not 64: no more than 400000 cubes are made"),
    ],
)
def test_a_ship_that_will_not_stay_as_she_is_put_is_told_of(ask, options, sentence):
    code, out, _ = ask("hull", "barge20", "--cells", 6, *options)
    assert code == 0 and sentence in " ".join(out.split())


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        ("tanks: {fuel: {mass: 3, at: [0, 1, 0], length: 3}}", "a free surface has a length and a breadth"),
        ("tanks: {fuel: {mass: 3, at: [0, 1, 0], length: 3, breadth: 9}}", "tanks.fuel.breadth is 9 m, more than the"),
        ("weights: {crate: {mass: 3, at: [0, 1, 12]}}", "weights.crate lies 2 m ahead or astern of the hull"),
        ("openings: {vent: [5, 6, 0]}", "openings.vent lies 1 m abeam of the hull"),
        ("openings: {vent: [0, 1, 0]}", "openings.vent lies under the water"),
    ],
)
def test_a_loading_condition_that_cannot_be_meant_is_told_of(ask, tmp_path, more, sentence):
    (tmp_path / "load.yaml").write_text(f"light: {{mass: 320000, at: [0, 2.5, 0]}}\n{more}\n")
    _, out, err = ask("hull", "barge20", "--cells", 4, "--loading", "load.yaml")
    assert sentence in " ".join((out + err).split())


def test_check_warns_of_a_ship_that_cannot_rest_near_upright(ask, tmp_path):
    (tmp_path / "scene.yaml").write_text(
        "basin: {length: 100.0, width: 100.0, depth: 20.0}\nfluid: {kind: linear_waves, height: 0.0, period: 5.0}\n"
        "ship: {kind: dynamic, hull: barge20, centre_of_mass: [0.0, 2.5, 9.0], position: [0.0, 0.0]}\n"
    )
    code, out, _ = ask("check", "scene.yaml")
    assert code == 0 and "within 30 degrees of trim and heel the ship has no pose at rest" in " ".join(out.split())


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

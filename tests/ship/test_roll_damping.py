"""Roll damping by components: published numbers, a closed form, and the decay that it gives a ship."""

from math import log, pi, radians, sqrt
from pathlib import Path

import numpy as np
import pytest

from ocean_sim import Simulation, load
from ocean_sim.__main__ import run_command_line
from ocean_sim.files import csv_file
from ocean_sim.ship.forces.damping import Damping, Resistance
from ocean_sim.ship.forces.roll_damping import (
    WATER_VISCOSITY,
    BilgeKeels,
    Form,
    Ikeda,
    RollDamping,
    damping_components,
    lift_damping,
    ratios_beyond,
    regressions,
    skin_friction,
)
from ocean_sim.ship.hull.hull import hull_of
from ocean_sim.validation.shared.ship import at_sea, follow_body, set_pose

# Of Kawahara, Maekawa & Ikeda: L/B 6, B/d 4, C_B 0.65, C_M 0.98, OG/d -0.2, omega 0.6, keels 0.2 L x 0.025 B.
EXAMPLE = Form(300.0, 50.0, 12.5, 0.65, 0.98, -0.2, 0.6, (0.2, 0.025))


def test_the_example_of_the_paper_as_others_compute_it():
    """0.0101561488 at 10 degrees, by the published program in another's hands (Alexandersson et al. 2021, whose own
    test holds it)."""
    assert sum(damping_components(EXAMPLE, 10.0, WATER_VISCOSITY, 9.81)) == pytest.approx(0.010156148773, rel=1e-8)


def test_friction_is_that_of_a_laminar_layer_in_closed_form():
    """Kato: a cylinder of the mean radius; linear in the rate, as the drag falls with the amplitude."""
    length, broad, deep, cb, _, og, frequency, _ = EXAMPLE
    radius = deep * ((0.887 + 0.145 * cb) * (1.7 + cb * broad / deep) - 2.0 * og) / pi
    wetted, omega = length * (1.75 * deep + cb * broad), frequency / sqrt(broad / 2.0 / 9.81)
    exact = 4.0 / 3.0 / pi * 1000.0 * wetted * radius**2 * 1.328 * sqrt(2.0 * pi * WATER_VISCOSITY / 3.22 * omega)
    scale = 1000.0 * cb * length * broad**3 * deep / sqrt(broad / 2.0 / 9.81)
    for amplitude in (2.0, 15.0):
        assert scale * skin_friction(EXAMPLE, amplitude, WATER_VISCOSITY, 9.81) == pytest.approx(exact, rel=1e-9)


def test_lift_of_a_round_hull_is_that_of_a_low_aspect_wing():
    """C_M at most 0.91: k_N is 2 pi d / L; with the axis in the water the arms are 0.3 d and 0.5 d."""
    flat = EXAMPLE._replace(midship=0.9, axis=0.0)
    assert lift_damping(flat, 1000.0) == pytest.approx(500.0 * 12.5 * 2.0 * pi * 12.5 * 0.15 * 12.5**2)


def test_cylinders_forced_to_roll_lie_beyond_the_rule_which_gives_too_few_eddies():
    """Ikeda, Himeno & Tanaka (1978): a cylinder's block coefficient is that of its section, and no hull within the
    regressions has both alike. The 16 measured dampings are underrated, sections fuller than 0.84 have none at all."""
    found = csv_file.read_records((Path(__file__).parent / "data" / "ikeda1978_sections.csv").read_text())
    assert len(found) == 16
    for row in found:
        length, broad, deep, area = (float(row[k]) for k in ("length_m", "breadth_m", "draught_m", "area_coefficient"))
        form = Form(length, broad, deep, area, area, 0.0, float(row["omega_hat"]), None)
        ruled = damping_components(form, np.degrees(float(row["phi"])), WATER_VISCOSITY, 9.81).eddies
        assert ratios_beyond(form) and 0.0 <= ruled < float(row["eddies"])
        assert (ruled == 0.0) == (area > 0.84)


def test_bilge_keels_damp_and_beyond_the_regressions_a_sentence_says_so():
    still = hull_of("wigley").in_still_water(12.0, 1000.0, 9.81)
    bare = RollDamping(Ikeda(), still, 0.0, True)
    broad, long = bare.form.breadth, bare.form.length
    keels = BilgeKeels(length=0.3 * long, breadth=0.03 * broad)
    kept = RollDamping(Ikeda(bilge_keels=keels), still, 0.0, True)
    assert kept.critical_share(10.0) > 1.1 * bare.critical_share(10.0)
    assert kept.linear + kept.quadratic > bare.linear + bare.quadratic
    assert "midship section coefficient 0.667 (0.9 to 0.99)" in bare.warnings[0]  # two thirds, in closed form
    assert RollDamping(Ikeda(), still, 0.0, False).critical_share(10.0) < bare.critical_share(10.0)  # waves: table
    assert all(low < high for low, high in regressions()["limits"].values())


def test_every_component_takes_energy_wherever_the_regressions_hold():
    """The published one of eddies falls below zero beyond a block coefficient of 0.84."""
    for cb, cm, bd, og, frequency, broad, long in np.random.default_rng(3).uniform(
        *zip(*regressions()["limits"].values()), (2000, 7)
    ):
        form = EXAMPLE._replace(
            block=cb, midship=cm, breadth=12.5 * bd, axis=og, frequency=frequency, keels=(long, broad)
        )
        for amplitude in (1.0, 20.0):
            assert min(damping_components(form, amplitude, WATER_VISCOSITY, 9.81)) >= 0.0
    full = RollDamping(Ikeda(), hull_of("barge20").in_still_water(8.0, 1000.0, 9.81), 0.0, True)
    assert full.parts[10.0].eddies == 0.0 and "counted as 0" in full.warnings[-1]
    assert len(RollDamping(Ikeda(), hull_of("wigley").in_still_water(8.0, 1000.0, 9.81), 0.0, True).warnings) == 1


def test_the_linear_and_quadratic_parts_do_the_work_of_the_components():
    still = hull_of("wigley").in_still_water(8.0, 1000.0, 9.81)
    found = RollDamping(Ikeda(bilge_keels=BilgeKeels(length=0.9, breadth=0.009)), still, 0.01, True)
    for amplitude in (5.0, 10.0, 20.0):
        rate = found.omega * radians(amplitude) * np.cos(np.linspace(0.0, 2.0 * pi, 4001))
        work = -np.trapezoid([found.roll_moment(r, 0.0) * r for r in rate], dx=2.0 * pi / found.omega / 4000.0)
        whole = pi * found.omega * radians(amplitude) ** 2 * found.scale * sum(found.parts[amplitude])
        assert work == pytest.approx(whole, rel=0.03)


def test_a_ship_that_is_let_go_decays_as_the_parts_say():
    """Energy over a half swing: the decrement is pi (b1 + 8/(3 pi) omega phi b2) over the critical half."""
    ikeda = {"bilge_keels": {"length": 0.9, "breadth": 0.012}}
    ship = {"kind": "hydrostatic", "hull": "wigley", "free": ["roll"], "damping": {"cross_flow": 0.0, "ikeda": ikeda}}
    with Simulation(load(at_sea(ship, 6.0, 0.02))) as simulation:
        body = simulation.ships["ship"].body
        found = simulation.ships["ship"].resistance.rolling
        tilt = radians(8.0)
        set_pose(
            simulation, position=body.position, orientation=np.array([np.cos(tilt / 2), 0.0, 0.0, np.sin(tilt / 2)])
        )
        roll = np.array([b.angles[2] for _, b in follow_body(simulation, 6.0)])
    turns = np.flatnonzero(np.diff(np.sign(np.diff(roll)))) + 1
    high = np.abs(roll[turns])
    middle = sqrt(high[0] * high[1])
    equal = found.linear + 8.0 / (3.0 * pi) * found.omega * middle * found.quadratic
    assert log(high[0] / high[1]) == pytest.approx(pi * equal / found.critical, rel=0.05)


def test_it_takes_the_place_of_the_rule_and_of_what_the_sections_did():
    """No share of critical beside it, and no drag of the sections as she rolls; the sway's own moment stays."""
    still, added = hull_of("wigley").in_still_water(8.0, 1000.0, 9.81), np.zeros(6)
    ruled, predicted = (Resistance(Damping(ikeda=each), still, added) for each in (None, Ikeda()))
    rolls, sways = np.eye(6)[5], np.eye(6)[0]
    assert ruled.linear["roll"] > 0.0 == predicted.linear["roll"]
    assert predicted.load(rolls)[1, 2] == pytest.approx(predicted.rolling.roll_moment(1.0, 0.0))
    assert predicted.load(rolls)[0, 0] == 0.0 != ruled.load(rolls)[0, 0]
    np.testing.assert_array_equal(predicted.load(sways), ruled.load(sways))


def test_hull_prints_it_and_check_warns(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run_command_line(["hull", "wigley", "--cells", "6", "--bilge-keels", "0.9,0.009"]) == 0
    said = capsys.readouterr().out
    assert "roll damping at rest" in said and "beyond Ikeda's regressions" in said
    assert run_command_line(["hull", "wigley", "--bilge-keels", "0.9"]) == 2
    assert "is not like 12,0.3" in capsys.readouterr().err

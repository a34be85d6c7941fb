"""Every case loads under every scheme with one set of constants, and gives rows as agreed."""

import csv
import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ocean_sim.__main__ import run_command_line
from ocean_sim.conventions import Diverged
from ocean_sim.parts import compared, kinds
from ocean_sim.validation import case_names, problems
from ocean_sim.validation.shared.case import COARSE_BASIS, ROW_KEYS, Curve, Finding, Problem, Promise
from ocean_sim.validation.shared.tables import coarse_tolerances, too_long_for_gate
from ocean_sim.verbs import validate

SCHEMES = list(compared("fluid"))
OF_A_CASE = {"spacing", "fill", "initial", "rest_density", "kinematic_viscosity", "reference_speed", "body_force"}
QUICK = {"runtime.threads": 1}


def every_problem(slot: str | None = None) -> list[Problem]:
    """Those whose schemes are kinds of a slot; by default all."""
    found = [problem for name in case_names() for problem in problems(name, slow=True)]
    return [problem for problem in found if slot in (None, problem.slot)]


def test_the_cases_asked_for_are_there():
    wanted = "hydrostatic poiseuille couette taylor_green elliptical_drop square_patch standing_wave dam_break_front"
    assert {
        *wanted.split(),
        "wall_impact",
        "conservation",
        "sloshing",
        "piston_flume",
        "wind_stress",
        "wind_setup",
        "wind_growth",
        "rough_channel",
    } <= set(case_names())


def test_coarse_set_ups_have_tolerances_of_their_own_and_fine_ones_keep_theirs():
    for (case, quantity), own in coarse_tolerances().items():
        rough, fine = (
            [
                p
                for problem in problems(case, slow=True, coarse=those)
                for p in problem.promises
                if p.quantity == quantity
            ]
            for those in (True, False)
        )
        assert rough and fine
        for scheme, limit in own.items():
            assert all(p.tolerance[scheme] == limit for p in rough) and all(p.tolerance[scheme] < limit for p in fine)
        assert all(COARSE_BASIS in p.source for p in rough) and not any(COARSE_BASIS in p.source for p in fine)


def test_a_gate_runs_what_it_can_judge_and_has_time_for():
    there = {(name, problem.name) for name in case_names() for problem in problems(name, slow=True, coarse=True)}
    assert set(too_long_for_gate()) <= there
    gate = [(name, problem) for name in case_names() for problem in problems(name, coarse=True)]
    assert not {(name, problem.name) for name, problem in gate} & set(too_long_for_gate())
    assert len({name for name, _ in gate}) >= 25
    for _, problem in gate:
        assert any(scheme in promise.tolerance for promise in problem.promises for scheme in problem.schemes)


def test_what_was_left_out_is_said_in_one_sentence(tmp_path, capsys, monkeypatch):
    """Whatever those give that are run; here none is."""
    monkeypatch.setattr(validate, "case_answers", lambda orders, workers: [])
    words = ["validate", "poiseuille", "couette", "ship_o*", "--out", str(tmp_path)]
    assert run_command_line([*words, "--coarse"]) == 0
    said = capsys.readouterr().out
    assert said.count("left out") == 1
    assert "or have no tolerance (--slow adds them): ship_otter (turn)" in said
    assert run_command_line(["validate", "obstacle", "--coarse", "--out", str(tmp_path)]) == 2
    assert "too long for a gate: add --slow" in capsys.readouterr().err
    assert run_command_line(["validate", "open_sea_box", "--coarse", "--slow", "--out", str(tmp_path)]) == 2
    assert "open_sea_box has no coarse set-up: leave --coarse out" in capsys.readouterr().err


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_scheme_has_one_set_of_constants(scheme):
    """What a case may say is not compared; all that is left is the same in all of them."""
    constants = set()
    for problem in every_problem("fluid"):
        if "delta_sph" not in problem.schemes:
            continue
        scene = problem.load(scheme)
        fluid = {key: value for key, value in scene.fluid.model_dump().items() if key not in OF_A_CASE}
        constants.add(json.dumps({"fluid": fluid, "time_step": scene.time_step.model_dump()}, sort_keys=True))
    assert len(constants) == 1


def test_a_case_says_nothing_of_a_scheme():
    for problem in every_problem("fluid"):
        if "delta_sph" not in problem.schemes:
            continue
        assert set(problem.scene) <= {"duration", "basin", "sea", "fluid", "wind", "runtime"}
        assert set(problem.scene["fluid"]) <= OF_A_CASE
        assert set(problem.scene.get("runtime", {})) <= {"precision"}


def test_every_tolerance_is_that_of_a_scheme_and_says_where_it_comes_from():
    for problem in every_problem():
        assert problem.promises
        for promise in problem.promises:
            assert set(promise.tolerance) <= set(kinds(problem.slot))
            assert promise.source and promise.unit


def test_a_row_has_the_agreed_keys_and_judges_by_the_size_of_the_error():
    promise = Promise("depth [m]", "%", "a rule", {"delta_sph": 1.0})
    row = promise.row("a_case", "delta_sph", 0.98, 1.0, -2.0)
    assert tuple(row) == ROW_KEYS
    assert row["ok"] is False and row["tolerance"] == 1.0
    assert promise.row("a_case", "delta_sph", 0.995, 1.0, -0.5)["ok"] is True
    reported = promise.row("a_case", "mueller", 0.5, 1.0, -50.0)
    assert reported["ok"] is True and reported["tolerance"] is None
    assert promise.row("a_case", "delta_sph", 1.0, 1.0, float("nan"))["ok"] is False


def test_a_run_that_diverged_gives_rows_that_say_so():

    def fall_apart(simulation: object) -> Finding:
        raise Diverged("velocities are no numbers; t = 0.1 s")

    promises = (Promise("x", "1", "a rule", {"mueller": 1.0}), Promise("y", "1", "a rule"))
    problem = replace(problems("hydrostatic", coarse=True)[0], promises=promises, measure=fall_apart)
    rows, found = problem.run("hydrostatic", "mueller", QUICK)
    assert not found.numbers
    assert [(row["value"], row["ok"]) for row in rows] == [(None, False), (None, True)]
    assert all("diverged: velocities are no numbers" in row["source"] for row in rows)


@pytest.mark.anchor
def test_the_command_writes_a_table_and_a_picture(tmp_path, capsys):
    code = run_command_line(
        ["validate", "conservation", "--scheme", "mueller", "--coarse", "--set", "runtime.threads=1"]
        + ["--out", str(tmp_path), "--json"]
    )
    rows = json.loads(capsys.readouterr().out)
    assert code == 0 and all(tuple(row) == ROW_KEYS and row["ok"] for row in rows)
    with (tmp_path / "validate.csv").open() as file:
        table = list(csv.DictReader(file))
    assert [row["quantity"] for row in table] == [row["quantity"] for row in rows]
    assert (tmp_path / "conservation.png").stat().st_size > 10_000


def test_a_missed_tolerance_is_exit_code_1(tmp_path, capsys, monkeypatch):
    from ocean_sim.validation import conservation

    monkeypatch.setitem(conservation.LIMITS, "f32", 1e-12)
    monkeypatch.setattr(conservation, "STEP_COUNT", 3)
    words = ["validate", "conservation", "--scheme", "mueller", "--coarse", "--set", "runtime.threads=1"]
    assert run_command_line([*words, "--out", str(tmp_path)]) == 1
    assert "MISSED" in capsys.readouterr().out


def test_cases_at_a_time_give_the_rows_of_one_after_the_other(tmp_path, capsys):
    words = ["validate", "poiseuille", "couette", "ship_draught", "--coarse"]
    tables = []
    for workers in (1, 2):
        out = tmp_path / str(workers)
        written = ["--out", str(out), "--junit", str(out / "new" / "j.xml")]
        assert run_command_line([*words, "--workers", str(workers), *written]) == 0
        tables.append((out / "validate.csv").read_bytes())
        assert (out / "couette.png").is_file() and (out / "new" / "j.xml").is_file()
        assert str(out / "new" / "j.xml") in capsys.readouterr().out
    assert tables[0] == tables[1]


def test_a_folder_in_place_of_the_report_is_refused_before_anything_runs(tmp_path, capsys):
    assert run_command_line(["validate", "couette", "--junit", str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    assert "this is a folder, not a file" in capsys.readouterr().err


def test_what_is_not_a_case_is_exit_code_2(capsys, tmp_path):
    assert run_command_line(["validate", "hydrostatics", "--out", str(tmp_path / "none")]) == 2
    assert "did you mean 'hydrostatic'" in capsys.readouterr().err
    assert run_command_line(["validate", "hydrostatic", "--scheme", "muller"]) == 2
    assert not (tmp_path / "none").exists()


def test_the_cases_are_listed(capsys):
    assert run_command_line(["list", "cases", "--json"]) == 0
    assert [row["name"] for row in json.loads(capsys.readouterr().out)] == case_names()


def test_a_picture_has_rows_of_panels_and_none_for_a_set_up_without_curves(tmp_path):
    imread = pytest.importorskip("matplotlib.image").imread
    line = [Curve("h", np.array([0.0, 1.0]), np.array([0.0, 1.0]))]
    seen = Finding([(1.0, 1.0, 0.0)], line)
    runs = [(SimpleNamespace(name=f"{k}"), "delta_sph", seen) for k in range(5)]
    runs.append((SimpleNamespace(name="numbers"), "delta_sph", Finding([(1.0, 1.0, 0.0)])))
    validate.draw_case(tmp_path / "five.png", "case", runs)
    runs.append((SimpleNamespace(name="over"), "delta_sph", Finding(())))
    validate.draw_case(tmp_path / "six.png", "case", runs[3:])
    sizes = [imread(tmp_path / f"{name}.png").shape[:2] for name in ("five", "six")]
    assert sizes == [(960, 2560), (480, 1920)]
    validate.draw_case(tmp_path / "none.png", "case", runs[5:6])
    assert not (tmp_path / "none.png").exists()

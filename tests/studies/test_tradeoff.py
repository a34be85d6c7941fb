"""The trade of speed for accuracy: what is compared, which points are best, and what a budget allows."""

from pathlib import Path
from statistics import median

import numpy as np
import pytest

from ocean_sim import load, run
from ocean_sim.__main__ import run_command_line
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.parts import compared
from ocean_sim.result import Result
from ocean_sim.studies import reads_key, tradeoff
from ocean_sim.studies.scene_tradeoff import (
    SEED_COUNTS,
    Budget,
    best_setting,
    clock_note,
    errors_against,
    finest_setting,
    measure_label,
    setting_grid,
    tradeoff_summary,
    vary_setting,
)
from ocean_sim.studies.shared import pareto, study
from ocean_sim.studies.shared.scene_run import Clocked, run_measures
from ocean_sim.studies.tradeoff import TRIAL_CASES, clock_column, equal_cost_rows, pareto_front, study_points
from ocean_sim.validation import problems
from ocean_sim.verbs import tradeoff as verb

SEA = """basin: {length: 40.0, width: 40.0, depth: 7.5}
fluid: {kind: linear_waves, height: 0.2, period: 1.0}
duration: 3.0
runtime: {threads: 1}
"""
FALL = {
    "basin": {"length": 0.8, "depth": 0.4},
    "fluid": {"kind": "dfsph", "spacing": 0.1},
    "time_step": {"kind": "fixed", "dt": 0.002},
    "duration": 0.02,
    "accuracy": {"every": 0.01},
    **dict.fromkeys(("render", "frames", "report")),
}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("sea.yaml").write_text(SEA)
    return tmp_path


def test_the_front_is_what_nobody_betters():
    pairs = [(1.0, 5.0), (2.0, 3.0), (3.0, 4.0), (2.0, 3.5), (4.0, 1.0), (4.5, 1.0)]
    assert pareto_front(pairs) == [0, 1, 4]
    assert pareto_front([]) == []


def test_the_study_has_every_compared_scheme_on_six_cases_and_every_setting_is_another():
    plan = study_points(quick=True)
    of_water = [point for point in plan if point.trial.slot == "fluid"]
    assert len({point.trial.case for point in of_water}) == 6
    assert {point.scheme for point in of_water} == set(compared("fluid")) >= {"mueller", "delta_sph", "dfsph"}
    addresses = [study.run_address(point.order) for point in study_points(quick=False)]
    assert len(set(addresses)) == len(addresses) > len(plan)
    changed = {(point.scheme, point.changed) for point in plan if point.trial.case == "standing_wave"}
    assert ("delta_sph", "fluid.support_ratio=2.0") in changed
    assert ("mueller", "fluid.support_ratio=2.0") not in changed  # it is the scheme's own


def test_no_setting_is_varied_that_changes_no_number():
    for plan in (study_points(quick=True), study_points(quick=False)):
        varied = {p.scheme for p in plan if "fluid.compression" in p.settings}
        assert varied == {scheme for scheme in compared("fluid") if reads_key(scheme, "fluid.compression")}
        assert {"mueller", "delta_sph"} <= varied and "dfsph" not in varied


@pytest.mark.parametrize("scheme", ["dfsph", pytest.param("delta_sph", marks=pytest.mark.slow)])
def test_a_wanted_compression_changes_no_number_of_water_that_has_none(scheme):
    """And those of other water: the negative control."""
    tables = set()
    for compression in (0.0025, 0.04):
        run(load(FALL, {"fluid.kind": scheme, "fluid.compression": compression}), f"{compression}")
        tables.add(Path(f"{compression}/accuracy.csv").read_bytes())
    assert len(tables) == 1 + reads_key(scheme, "fluid.compression") == (1 if scheme == "dfsph" else 2)


def test_every_trial_draws_an_error_that_its_case_promises():
    for trial in TRIAL_CASES:
        promised = [
            p.quantity
            for coarse in (True, False)
            for q in problems(trial.case, slow=True, coarse=coarse)
            if q.name == trial.set_up
            for p in q.promises
        ]
        assert trial.quantity in promised, trial.case


def row(scheme: str, wall: float, error: float | None, particles: int = 100, changed: str = "") -> dict:
    facts = {"case": "a", "quantity": "q", "scheme": scheme, "wall_per_s": wall, "cpu_per_s": wall, "unit": "%"}
    return facts | {"error": error, "particles": particles, "changed": changed, "outcome": "done", "reason": ""}


def test_schemes_are_compared_at_equal_time_and_at_equal_number():
    rows = [row("slow", 4.0, 1.0), row("slow", 9.0, 0.1, 400), row("fast", 1.0, -3.0), row("fast", 3.5, 2.0, 400)]
    found = {(line["at equal"], line["scheme"]): line["error"] for line in equal_cost_rows(rows, "wall_per_s")}
    assert found["time up to 4 s/s", "slow"] == 1.0 and found["time up to 4 s/s", "fast"] == 2.0
    assert found["100 particles", "fast"] == -3.0 and found["400 particles", "slow"] == 0.1


def test_a_busy_machine_is_told_by_its_clocks():
    assert clock_column([row("a", 1.0, 1.0)]) == "wall_per_s"
    assert clock_column([row("a", 2.0, 1.0) | {"cpu_per_s": 1.0}]) == "cpu_per_s"


def test_a_run_is_timed_three_times_over():
    """Parts of the same run: a disturbance of some steps in a row does not move their median."""
    seen = Clocked.__new__(Clocked)
    seen.spent = [(0.1, 0.2, 0.1)] * 3 + [(0.1, 5.0 if 30 <= k < 35 else 0.2, 0.1) for k in range(63)]
    found = [cost["wall_per_s"] for cost in seen.costs()]
    assert len(found) == 3 and median(found) == pytest.approx(2.0)
    assert seen.cost()["wall_per_s"] > 5.0
    seen.spent = seen.spent[:3]
    assert seen.costs() == [] and seen.cost()["wall_per_s"] is None


def test_surfaces_are_run_coarse_and_fine():
    of_surfaces = [point for point in study_points(quick=True) if point.trial.case == "surface_slab"]
    assert {(point.scheme, point.settings.get("resolution", 1.0)) for point in of_surfaces if not point.changed} == {
        (kind, factor) for kind in ("cloth", "marching_cubes") for factor in (1.0, 0.5)
    }


def test_a_table_is_read_as_it_was_written(tmp_path):
    rows = [{"a": 1.5, "b": None, "c": "x=1", "d": True}, {"a": 2, "b": [1], "c": "", "d": False}]
    study.write_table(tmp_path / "a.csv", rows)
    assert study.read_table(tmp_path / "a.csv") == [rows[0], rows[1] | {"c": None}]


def test_pictures_hold_failures_too(tmp_path):
    rows = [row("mueller", 1.0, 0.0), row("dfsph", 2.0, 1.0, changed="fluid.compression=0.04"), row("dfsph", 3.0, None)]
    pareto.draw_pareto(tmp_path / "a.png", TRIAL_CASES[2], rows, "wall_per_s")
    assert (tmp_path / "a.png").stat().st_size > 10_000


@pytest.mark.parametrize("text, most", [("16ms", 16.0), ("realtime", 1.0), ("30s", 30.0), ("2.5s", 2.5)])
def test_a_budget_is_a_time(text, most):
    assert Budget.of(text).most == most


@pytest.mark.parametrize("text", ["16", "fast", "-3s", "0ms", "ms", "1h"])
def test_anything_else_is_no_budget(text):
    with pytest.raises(ValueError, match="give realtime"):
        Budget.of(text)
    assert run_command_line(["tradeoff", "sea.yaml", "--budget", text]) == 2


def test_a_budget_counts_in_its_own_unit():
    cost = {"wall_per_s": 0.6, "wall_s": 20.0}
    assert Budget.of("16ms").spent(cost) == pytest.approx(10.0)
    assert (Budget.of("realtime").spent(cost), Budget.of("30s").spent(cost)) == (0.6, 20.0)


def test_a_budget_counts_processor_time_where_a_run_has_waited_for_others():
    """Wall time tells of an idle machine, where several cores work for a run, and of nothing where others have them."""
    waited, shared = {"wall_per_s": 8.0, "cpu_per_s": 0.8}, {"wall_per_s": 0.7, "cpu_per_s": 1.4}
    assert Budget.of("realtime").spent(waited) == 0.8 and Budget.of("realtime").spent(shared) == 0.7
    assert Budget.of("16ms").spent(waited) == pytest.approx(1e3 * 0.8 / 60.0)
    assert Budget.of("30s").spent({"wall_s": 300.0, "cpu_s": 29.0}) == 29.0
    rows = [
        {"setting": "coarse", "wall_per_s": 0.9, "cpu_per_s": 0.1, "x": 2.0, "x_spread": 0.0},
        {"setting": "fine", "wall_per_s": 8.0, "cpu_per_s": 0.8, "x": 1.0, "x_spread": 0.0},
        {"setting": "too fine", "wall_per_s": 15.0, "cpu_per_s": 1.5, "x": 0.0, "x_spread": 0.0},
    ]
    found = best_setting(rows, "x", Budget.of("realtime"))
    assert found is not None and found["setting"] == "fine"
    assert clock_note(rows).startswith("the machine was busy: wall time is 10 times processor time")
    assert "wall time is 0.5 times processor time" in clock_note([shared])
    assert clock_note([{"wall_per_s": 1.4, "cpu_per_s": 1.0}]) == clock_note([]) == ""


@pytest.mark.parametrize(
    "wind, seeds",
    [
        ("wind: still", 1),
        ("wind: {kind: stress, u10: 5.0}", 1),
        ("wind: {kind: vortex, noise: [1.0, 0.0, 0.0]}", SEED_COUNTS[True]),
        ("wind: wide", SEED_COUNTS[True]),
    ],
)
def test_where_nothing_is_drawn_from_the_seed_one_is_enough(monkeypatch, capsys, wind, seeds):
    """Runs are made up: each finished; a seed more would be the same bytes again."""

    def made_up(order, folder, limit=None):
        out = Path(folder)
        out.mkdir(parents=True)
        time = np.arange(0.0, 20.0, 0.05)
        size = order["scene"]["fluid"]["height"]
        study.write_table(out / "gauges.csv", [{"time_s": t, "centre_m": size * np.sin(2.0 * t)} for t in time])
        return {"outcome": "done", "reason": "", "wall_per_s": 5.0, "cpu_per_s": 0.5, "wall_s": 9.0, "cpu_s": 1.0}

    monkeypatch.setattr(study, "perform_run", made_up)
    Path("sea.yaml").write_text(SEA + wind + "\n")
    words = ["tradeoff", "sea.yaml", "--vary", "fluid.height=0.2,0.1", "--budget", "realtime", "--quick", "--out", "o"]
    assert run_command_line(words) == 0
    said = capsys.readouterr().out
    assert len([*Path("o/runs").iterdir()]) == 2 * seeds + 1  # and once again the best, which is the finest
    assert ("nothing is drawn from it" in said) == (seeds == 1)
    assert "most accurate within realtime" in said and "wall time is 10 times processor time" in said


def test_the_finest_value_is_known_by_its_key():
    assert finest_setting("fluid.spacing", [1.0, 0.5, 0.8]) == 0.5
    assert finest_setting("fluid.particles", [1000, 6000]) == 6000
    assert finest_setting("runtime.precision", ["f64", "f32"]) == "f64"
    assert finest_setting("profile", ["reference", "ci"]) == "reference"
    assert finest_setting("title", ["a", "b"]) == "b"


def test_what_varies_is_said_and_what_is_wrong_with_it():
    vary = vary_setting(["fluid.height=0.5, 0.25", "basin.walls=[none, periodic]"])
    assert [node.plain() for node in vary["fluid.height"]] == [0.5, 0.25]
    for text, said in (("fluid.height", "expected KEY=A,B,C"), ("=1,2", "expected KEY"), ("a=[1", "not valid YAML")):
        with pytest.raises(SceneError, match=said):
            vary_setting([text])
    with pytest.raises(SceneError, match="2 to 200 can be compared"):
        setting_grid("sea.yaml", None, {}, vary_setting(["fluid.height=0.5"]), True)
    with pytest.raises(SceneError, match=r"--vary fluid\.hight=1,2: fluid\.hight: unknown key; did you mean"):
        setting_grid("sea.yaml", None, {}, vary_setting(["fluid.hight=1,2"]), True)


def test_a_setting_has_its_seeds_a_gauge_and_a_line_to_paste():
    plan = setting_grid("sea.yaml", None, {}, vary_setting(["fluid.height=0.2,0.1", "runtime.precision=f32,f64"]), True)
    assert len(plan) == 4 and [one.finest for one in plan].count(True) == 1
    assert plan[0].line() == "--set fluid.height=0.2 --set runtime.precision=f32"
    assert [scene.seed for scene in plan[0].scenes] == [0, 1, 2]
    assert "gauges" in plan[0].scenes[0].observers


def test_a_line_can_be_pasted_whatever_the_values():
    plan = setting_grid(
        "sea.yaml", None, {}, vary_setting(["runtime.pin=true,false", "health=null,{every: 1.0}"]), True
    )
    assert plan[0].line() == "--set runtime.pin=true --set health=null"
    assert plan[1].line() == """--set runtime.pin=true --set 'health={"every": 1.0}'"""


def test_the_study_of_cases_leaves_tables_and_pictures(monkeypatch, capsys):
    """Runs are made up: one scheme fails, and others had the cores, too."""

    def made_up(order, folder, limit):
        if order["scheme"] == "mueller":
            return {"outcome": "stopped", "reason": "too fast", "errors": []}
        fine = order["set"].get("resolution", 1.0)
        errors = [{"quantity": trial.quantity, "error": -fine, "unit": "%"} for trial in few]
        facts = {"particles": 100 / fine**2, "neighbours": 20.0, "wall_per_s": 2.0 / fine, "cpu_per_s": 1.0 / fine}
        return {"outcome": "done", "reason": "", "errors": errors} | facts

    few = tuple(trial for trial in TRIAL_CASES if trial.case in ("dam_break_front", "ship_rao"))
    monkeypatch.setattr(tradeoff, "TRIAL_CASES", few)
    monkeypatch.setattr(verb, "TRIAL_CASES", few)
    monkeypatch.setattr(study, "perform_run", made_up)
    assert run_command_line(["tradeoff", "--quick", "--out", "out"]) == 0
    said = capsys.readouterr().out
    assert "processor time is compared" in said and "too fast" in said and "400" in said
    names = {"tradeoff.csv", "equal.csv", "tradeoff_dam_break_front.png", "tradeoff_ship_rao.png"}
    assert names <= {path.name for path in Path("out").iterdir()}


def written(folder: str, amplitude: float, period: float) -> Result:
    time = np.arange(0.0, 20.0, 0.05)
    height = amplitude * np.sin(2.0 * np.pi * time / period)
    Path(folder).mkdir()
    study.write_table(Path(folder) / "gauges.csv", [{"time_s": t, "a_m": y} for t, y in zip(time, height)])
    study.write_table(Path(folder) / "motion.csv", [{"time_s": t, "heave_m": y + 3.0} for t, y in zip(time, height)])
    legs = [{"time_s": t} | {f"leg{k}_m": y for k in range(1, 7)} for t, y in zip(time, height)]
    study.write_table(Path(folder) / "platform.csv", legs)
    return Result(folder)


def test_errors_are_those_that_were_put_in():
    found = errors_against(written("one", 0.5, 2.0), written("other", 0.4, 2.0))
    assert found["a_hs_m"] == pytest.approx(0.2, rel=0.01) and found["a_tz_s"] == pytest.approx(0.0, abs=1e-6)
    for name in ("a_rms_m", "heave_rms_m", "legs_rms_m"):
        assert found[name] == pytest.approx(0.1 / np.sqrt(2.0), rel=0.01)
    assert errors_against(Result("one"), written("third", 0.5, 2.5))["a_tz_s"] == pytest.approx(0.5, rel=0.01)


def heading(folder: str, ahead: float, swing: float) -> Result:
    """A ship whose bow swings about a heading [rad], as a motion log shows it: from -pi to pi."""
    time = np.arange(0.0, 20.0, 0.05)
    yaw = np.remainder(ahead + swing * np.sin(2.0 * np.pi * time / 2.0) + np.pi, 2.0 * np.pi) - np.pi
    Path(folder).mkdir()
    study.write_table(Path(folder) / "motion.csv", [{"time_s": t, "yaw_rad": y} for t, y in zip(time, yaw)])
    return Result(folder)


@pytest.mark.parametrize("ahead", [0.3, np.pi - 1e-3, np.pi])
def test_a_ship_that_heads_for_minus_z_swings_as_much_as_any(ahead):
    """Her yaw leaps from pi to -pi: sweeps and studies took that for a swing of up to 0.9 rad."""
    one, other = heading("one", ahead, 0.02), heading("other", ahead - 0.01, 0.02)
    assert run_measures(one)["yaw_rms_rad"] == pytest.approx(0.02 / np.sqrt(2.0), rel=1e-6)
    assert errors_against(one, other)["yaw_rms_rad"] == pytest.approx(0.01, rel=1e-6)


def choice(name: str, wall: float, error: float | None, spread: float = 0.0) -> dict:
    return {"setting": name, "wall_per_s": wall, "wall_s": wall, "e": error, "e_spread": spread}


def test_a_setting_is_better_only_beyond_the_spread():
    rows = [choice("cheap", 0.2, 1.1, 0.05), choice("dear", 0.8, 1.0, 0.05), choice("finest", 5.0, 0.0)]
    assert best_setting(rows, "e", Budget.of("realtime"))["setting"] == "dear"
    rows[0]["e_spread"] = 0.2  # now nobody can tell
    assert best_setting(rows, "e", Budget.of("realtime"))["setting"] == "cheap"
    assert best_setting(rows, "e", Budget.of("30s"))["setting"] == "finest"
    assert best_setting(rows, "e", Budget.of("1ms")) is None
    assert best_setting([choice("lost", 0.1, None)], "e", Budget.of("realtime")) is None


def test_a_setting_that_failed_once_has_no_error():
    plan = setting_grid("sea.yaml", None, {}, vary_setting(["fluid.height=0.2,0.1"]), True)
    done = {"outcome": "done", "reason": "", "wall_per_s": 1.0, "wall_s": 2.0}
    whole = tradeoff_summary(plan[0], [done, done | {"wall_per_s": 3.0}], [{"e": 1.0}, {"e": 2.0}])
    assert (whole["e"], whole["wall_per_s"]) == (1.5, 2.0) and whole["e_spread"] == pytest.approx(np.sqrt(0.5))
    lost = tradeoff_summary(plan[0], [done, {"outcome": "stopped", "reason": "too fast"}], [{"e": 1.0}, {}])
    assert (lost["e"], lost["outcome"], lost["reason"]) == (None, "stopped", "too fast")


def test_the_study_of_a_scene_answers_with_a_line_to_paste_and_proves_it(capsys, monkeypatch):
    monkeypatch.setitem(SEED_COUNTS, True, 1)
    asked = ["tradeoff", "sea.yaml", "--vary", "fluid.height=0.2,0.1", "--quick", "--out", "out"]
    assert run_command_line([*asked, "--budget", "600s"]) == 0
    said = capsys.readouterr().out
    assert "the reference is --set fluid.height=0.1" in said
    assert "most accurate within 600s, by the rms error of gauge `centre` [m]: --set fluid.height=0.1" in said
    assert "run again" in said and "  0%  0 of 2 runs; the first compiles its kernels\n" in said
    assert {"tradeoff.csv", "seeds.csv", "tradeoff.png"} <= {path.name for path in Path("out").iterdir()}
    assert run_command_line([*asked, "--budget", "0.001ms"]) == 0  # the runs are there already
    assert "nothing fits 0.001ms: the cheapest takes" in capsys.readouterr().out
    assert run_command_line([*asked, "--by", "centre_hz_m"]) == 2
    monkeypatch.setattr("ocean_sim.verbs.tradeoff.Study", None)  # no run begins
    capsys.readouterr()
    assert run_command_line([*asked[:-1], "new", "--by", "centre_hm1_m"]) == 2
    assert "--by centre_hm1_m: there is no such error; did you mean" in capsys.readouterr().err


@pytest.mark.parametrize(
    "name, words",
    [
        ("end_rms_m", "rms error of gauge `end` [m]"),
        ("at_the_bow_tz_s", "error of the mean period of gauge `at_the_bow` [s]"),
        ("tug_heave_rms_m", "rms error of tug heave [m]"),
        ("legs_rms_m", "rms error of legs [m]"),
    ],
)
def test_an_error_is_named_in_words(name, words):
    assert measure_label(name) == words


def test_options_of_a_scene_need_a_scene(capsys):
    assert run_command_line(["tradeoff", "--budget", "16ms"]) == 2
    assert "--budget needs a scene" in capsys.readouterr().err


def test_names_of_points_that_lie_together_stay_apart():
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.text import Annotation, Text

    figure = Figure(figsize=(7.0, 5.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(0.0, 1.0)
    for k in range(8):
        pareto.name_points(axes, f"a long setting {k}", (0.5 + 0.01 * k, 0.5 + 0.003 * k), fontsize=6)
    pareto.shift_apart(figure)
    boxes = [Text.get_window_extent(name) for name in axes.get_children() if isinstance(name, Annotation)]
    assert len(boxes) == 8
    assert not any(a.overlaps(b) for k, a in enumerate(boxes) for b in boxes[:k])

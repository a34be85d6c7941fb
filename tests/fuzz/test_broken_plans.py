"""Broken plans of a sweep: each is refused with sentences that have a place, or all its runs can be built."""

import warnings
from pathlib import Path

import pytest
from _breakers import Broken, slips, spoilt
from _settings import few, many
from hypothesis import given, settings
from test_broken_scenes import complaints

from ocean_sim.files.yaml_file import SceneError
from ocean_sim.studies.sweep import read_plan

SEA = """basin: {length: 40.0, width: 40.0, depth: 7.5}
fluid: {kind: linear_waves, height: 0.5, period: 4.0}
duration: 0.4
gauges: {every: 0.02, elevation: {centre: [0.0, 0.0]}}
"""
PLAN = {
    "scene": "sea.yaml",
    "profile": "ci",
    "set": {"duration": 0.5, "gauges.every": 0.05, "wind": "wide"},
    "list": [{"fluid.height": 0.5}, {"fluid.height": 0.6, "fluid.period": 5.0}],
    "grid": {"fluid.heading_deg": [0.0, 45.0], "ship": [None, {"kind": "hydrostatic", "hull": "wigley"}]},
    "seeds": [1, 2],
}


def judged(broken: Broken) -> bool:
    """Whether the plan is refused, and rightly."""
    Path("sea.yaml").write_text(SEA)
    Path("plan.yaml").write_bytes(broken.content)
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        try:
            runs = read_plan(Path("plan.yaml"))
        except SceneError as error:
            assert error.problems
            for problem in error.problems:
                assert not complaints(problem), (broken.how, str(problem))
                assert problem.file == "plan.yaml", (broken.how, str(problem))
            if broken.suggestion is not None:  # of a key with dots, the word that is wrong
                wanted = broken.suggestion.split(".")
                assert any(p.suggestion in (*wanted, broken.suggestion) for p in error.problems), (
                    broken.how,
                    str(error),
                )
            return True
    assert runs and broken.suggestion is None, broken.how
    return False


@few
@given(slips(PLAN))
def test_a_slip_in_a_plan_is_named_with_its_place(traps, broken):
    judged(broken)


@settings(few, max_examples=8)
@given(spoilt(PLAN))
def test_a_file_that_is_no_plan_is_refused(traps, broken):
    judged(broken)


def test_the_plan_that_is_broken_here_is_whole(traps):
    from _breakers import yaml

    assert not judged(Broken(yaml(PLAN).encode(), "nothing"))


@pytest.mark.slow
@many
@given(slips(PLAN))
def test_many_slips_in_a_plan(traps, broken):
    judged(broken)


@pytest.mark.slow
@many
@given(spoilt(PLAN))
def test_many_files_that_are_no_plans(traps, broken):
    judged(broken)

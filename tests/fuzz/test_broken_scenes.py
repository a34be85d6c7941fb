"""Broken scenes: each is refused with sentences that name the key and its place, or it can be built; never a traceback.

A few are drawn here, always the same; `-m slow` draws two thousand.
"""

import warnings
from pathlib import Path

import pytest
from _breakers import Broken, misnamed, slips, spoilt
from _settings import few, many
from _valid_scenes import scenes, settled
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from ocean_sim.files.yaml_file import Problem, SceneError
from ocean_sim.reading.scene import load
from ocean_sim.verbs.check import preflight

MACHINE_TALK = ("Errno", "Traceback", "pydantic", "Input should", "array(", "<class", "object at")
ABOUT_THE_FILE = ("not valid YAML", "this ", "there is no", "expected a mapping", "nested", "cannot", "more than")
LONGEST = 600  # characters of a sentence


@st.composite
def broken(draw, how) -> Broken:
    scene = draw(scenes())
    assume(settled(scene) is not None)
    return draw(how(scene))


def complaints(problem: Problem) -> list[str]:
    """What is wrong with a message."""
    about_the_file = problem.message.startswith(ABOUT_THE_FILE)
    found = {
        "no sentence": not problem.message,
        "names no key": not problem.key and not about_the_file and "a key must be a word" not in problem.message,
        "has no place": problem.line is None and not about_the_file,
        "speaks of the program": any(word in problem.message for word in MACHINE_TALK),
        "has no end": len(problem.message) > LONGEST,
        "has several lines": not str(problem).isprintable(),
    }
    return [what for what, here in found.items() if here]


def judged(broken: Broken) -> bool:
    """Whether the scene is refused, and rightly."""
    path = Path("s.yaml")
    path.write_bytes(broken.content)
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        try:
            config = load(path)
        except SceneError as error:
            assert error.problems
            for problem in error.problems:
                assert not complaints(problem), (broken.how, str(problem))
                assert problem.file == "s.yaml", broken.how
            if broken.suggestion is not None:
                assert broken.suggestion in [problem.suggestion for problem in error.problems], (broken.how, str(error))
            return True
        assert broken.suggestion is None, broken.how
        preflight(config)
    return False


@few
@given(broken(slips))
def test_a_slip_is_named_with_its_place_and_the_likeliest_intention(traps, broken):
    judged(broken)


@settings(few, max_examples=8)
@given(broken(spoilt))
def test_a_file_that_is_no_scene_is_refused(traps, broken):
    judged(broken)


@few
@given(broken(misnamed))
def test_a_file_that_is_not_what_a_scene_needs_is_refused(traps, broken):
    assert judged(broken)


@pytest.mark.slow
@many
@given(broken(slips))
def test_many_slips(traps, broken):
    judged(broken)


@pytest.mark.slow
@many
@given(broken(spoilt))
def test_many_files_that_are_no_scenes(traps, broken):
    judged(broken)


@pytest.mark.slow
@many
@given(broken(misnamed))
def test_many_files_that_are_not_what_a_scene_needs(traps, broken):
    assert judged(broken)


@settings(few, max_examples=60)
@given(scenes())
def test_the_scenes_that_are_broken_here_can_be_mended(scene):
    """Taking away what is complained of, by the keys that are named, leads to a scene that is in order."""
    assert settled(scene, rounds=10) is not None

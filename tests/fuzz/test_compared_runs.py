"""Valid scenes, each from several starts run twice in two ways that must agree, and the books of every run close.

    OCEAN_SIM_TWINS=250 OCEAN_SIM_LEDGER=twins.jsonl pytest tests/fuzz/test_compared_runs.py -m slow -n 0 -s

What stands in the ledger is not run again, so a run that was ended goes on. OCEAN_SIM_SEED draws other scenes; so does
another number of them. Two of these can run side by side, with another seed and another ledger.
"""

import json
import os
import random
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from _compared import COMPARISONS, Built, State, Twins, judged, parted, starts
from test_valid_scenes import drawn

from ocean_sim.reading.scene import SceneConfig, load

TWINS = int(os.environ.get("OCEAN_SIM_TWINS", 40))  # scenes
SEED = int(os.environ.get("OCEAN_SIM_SEED", 0))
STARTS = 4  # of a scene with particles: the first as it says, and others that share its kernels
DRAWN = 2  # comparisons of each of them


def resting(**changes) -> State:
    x = np.zeros((5, 3))
    return State("", x, x, np.zeros((1, 13)), 0.0, ())._replace(**changes)


@pytest.mark.parametrize(
    ("other", "words"),
    [
        (resting(), ""),
        (resting(position=np.full((5, 3), 2e-3)), "0.002 m apart"),
        (resting(position=np.full((5, 3), np.nan)), "nan m apart"),
        (resting(position=np.zeros((4, 3))), "inf m apart"),
        (resting(ships=np.full((1, 13), 0.1)), "0.1 m apart"),
        (resting(stopped="swollen"), "one stops"),
        (resting(wrong=("momentum is off",)), "second: momentum is off"),
    ],
)
def test_what_disagrees_is_said(other, words):
    found = judged(SceneConfig.model_construct(), resting(), other, 1e-3)
    assert bool(found) == bool(words) and words in found


@pytest.fixture
def slice_of_water() -> Iterator[Twins]:
    """Water by two boxes, one taller than the other, between periodic sides; from two starts."""
    boxes = [{"min": [-0.5, -0.5], "max": [0.0, 0.0]}, {"min": [0.0, -0.5], "max": [0.5, -0.2]}]
    basin = {"length": 1.0, "depth": 0.5, "walls": "periodic"}
    config = load({"basin": basin, "fluid": {"kind": "ballistic", "spacing": 0.1, "fill": boxes}})
    twins = Twins(config, starts(config, 2, "a slice"))
    yield twins
    twins.close()


def test_a_slice_agrees_with_its_mirror_image_and_with_itself_a_little_further(slice_of_water):
    assert COMPARISONS["mirrored"](slice_of_water) == COMPARISONS["shifted"](slice_of_water) == ["", ""]


def test_eddies_that_are_not_mirrored_are_told(slice_of_water, monkeypatch):
    begin = Built.begin
    monkeypatch.setattr(Built, "begin", lambda built, start, side=1.0: begin(built, start))
    at_rest, moving = COMPARISONS["mirrored"](slice_of_water)
    assert at_rest == "" and "m apart" in moving


def test_starts_differ_and_the_first_comes_back_byte_for_byte(slice_of_water):
    built, (first, other) = slice_of_water.built(slice_of_water.plain), slice_of_water.starts
    ends = []
    for start in (first, other, first):
        built.begin(start)
        ends.append(built.on())
    assert parted(ends[0], ends[2]) == 0.0 and np.array_equal(ends[0].velocity, ends[2].velocity)
    assert parted(ends[0], ends[1]) > 0.01 * slice_of_water.config.preflight.spacing


@pytest.mark.slow
def test_many_scenes_agree_with_themselves(tmp_path):
    ledger = Path(os.environ.get("OCEAN_SIM_LEDGER", tmp_path / "twins.jsonl"))
    known = [json.loads(line) for line in ledger.read_text().splitlines()] if ledger.exists() else []
    done = {row["scene"] for row in known if (row["seed"], row["of"]) == (SEED, TWINS)}
    with ledger.open("a", encoding="utf-8") as file:
        for number, config in enumerate(drawn(TWINS, SEED)):
            if number in done:
                continue
            row = {"seed": SEED, "of": TWINS, "scene": number}
            draw = f"{SEED} {number}"
            known += (rows := [row | {"start": k, "found": found} for k, found in enumerate(compared(draw, config))])
            file.writelines(json.dumps(row) + "\n" for row in rows)
            file.flush()
    wrong = [row for row in known if any(row["found"].values())]
    print(f"{sum(len(row['found']) for row in known)} comparisons of {len(known)} starts")
    assert not wrong


def compared(draw: str, config: SceneConfig) -> list[dict[str, str]]:
    """What the first comparisons that suit the scene say of each start, by name, in an order that is drawn."""
    twins = Twins(config, starts(config, STARTS, draw))
    found: list[dict[str, str]] = [{} for _ in twins.starts]
    try:
        for name in random.Random(draw).sample(list(COMPARISONS), len(COMPARISONS)):
            if len(found[0]) < DRAWN and (said := COMPARISONS[name](twins)) is not None:
                found = [one | {name: words} for one, words in zip(found, said, strict=True)]
        return found
    finally:
        twins.close()

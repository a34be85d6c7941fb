"""Valid scenes, each run twice in two ways that must agree, and the books of every run close.

    OCEAN_SIM_TWINS=1000 OCEAN_SIM_LEDGER=twins.jsonl pytest tests/fuzz/test_compared_runs.py -m slow -n 0 -s

What stands in the ledger is not run again, so a run that was ended goes on. OCEAN_SIM_SEED draws other scenes; so does
another number of them.
"""

import json
import os
import random
from pathlib import Path

import numpy as np
import pytest
from _compared import COMPARISONS, State, judged
from test_valid_scenes import drawn

from ocean_sim.reading.scene import SceneConfig, load

TWINS = int(os.environ.get("OCEAN_SIM_TWINS", 40))  # scenes; two comparisons of one take a minute of one core
SEED = int(os.environ.get("OCEAN_SIM_SEED", 0))
DRAWN = 2  # comparisons of a scene


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


def test_a_slice_at_rest_agrees_with_its_mirror_image_and_with_itself_a_little_further():
    """Water by two boxes, one taller than the other, between periodic sides."""
    boxes = [{"min": [-0.5, -0.5], "max": [0.0, 0.0]}, {"min": [0.0, -0.5], "max": [0.5, -0.2]}]
    basin = {"length": 1.0, "depth": 0.5, "walls": "periodic"}
    config = load({"basin": basin, "fluid": {"kind": "ballistic", "spacing": 0.1, "fill": boxes}})
    assert COMPARISONS["mirrored"](config) == "" and COMPARISONS["shifted"](config) == ""


@pytest.mark.slow
def test_many_scenes_agree_with_themselves(tmp_path):
    ledger = Path(os.environ.get("OCEAN_SIM_LEDGER", tmp_path / "twins.jsonl"))
    known = [json.loads(line) for line in ledger.read_text().splitlines()] if ledger.exists() else []
    done = {row["scene"] for row in known if (row["seed"], row["of"]) == (SEED, TWINS)}
    with ledger.open("a", encoding="utf-8") as file:
        for number, config in enumerate(drawn(TWINS, SEED)):
            if number in done:
                continue
            row = {"seed": SEED, "of": TWINS, "scene": number, "found": compared(f"{SEED} {number}", config)}
            known.append(row)
            file.write(json.dumps(row) + "\n")
            file.flush()
    wrong = [row for row in known if any(row["found"].values())]
    print(f"{sum(len(row['found']) for row in known)} comparisons of {len(known)} scenes")
    assert not wrong


def compared(draw: str, config: SceneConfig) -> dict[str, str]:
    """What the first comparisons that suit the scene say, by name, in an order that is drawn."""
    found: dict[str, str] = {}
    for name in random.Random(draw).sample(list(COMPARISONS), len(COMPARISONS)):
        if len(found) < DRAWN and (said := COMPARISONS[name](config)) is not None:
            found[name] = said
    return found

"""Keys that may stand beside the part that they belong to, and a sea that names no kind."""

import pytest

from ocean_sim import load
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.reading.keys import keys_at

PATCH = {
    "basin": {"length": 3.0, "depth": 0.5, "walls": "periodic"},
    "fluid": {"kind": "delta_sph", "spacing": 0.05},
    "duration": 1.0,
}
SEA = {"height": 0.05, "period": 0.8}


def test_the_rim_of_a_patch_stands_in_its_sea_or_beside_it():
    inside, beside = (
        load(PATCH | {"sea": SEA | {"rim": {"width": 0.6}}}),
        load(PATCH | {"sea": SEA, "rim": {"width": 0.6}}),
    )
    assert beside.resolved() == inside.resolved() and "rim" not in beside.resolved()
    assert load(PATCH | {"sea": SEA, "rim": {"width": 0.6}}, {"rim.width": 0.4}).sea.rim.width == 0.4
    assert load(PATCH | {"sea": "calm", "rim": {"rate": 3.0}}).sea.rim.rate == 3.0
    assert load(PATCH | {"rim": {"width": 0.6}}, {"sea": SEA}).sea.rim.width == 0.6
    assert load(PATCH | {"sea": SEA, "rim": None}).resolved() == load(PATCH | {"sea": SEA}).resolved()
    assert [key.path for key in keys_at("rim.width")] == [key.path for key in keys_at("sea.rim.width")]


@pytest.mark.parametrize(
    ("keys", "sentence"),
    [
        ({"rim": {"width": 0.6}}, "there is no `sea` that it could belong to"),
        ({"sea": SEA | {"rim": {"rate": 1.0}}, "rim": {"width": 0.6}}, "give either `rim` or `sea.rim`, not both"),
        ({"sea": SEA, "rim": {"widht": 0.6}}, "did you mean 'width'?"),
    ],
)
def test_a_rim_that_is_wrong_is_said_in_a_sentence(keys, sentence):
    with pytest.raises(SceneError, match=sentence.replace("?", r"\?")):
        load(PATCH | keys)


def test_a_sea_without_a_kind_is_linear_waves():
    assert load(PATCH | {"sea": SEA}).resolved() == load(PATCH | {"sea": SEA | {"kind": "linear_waves"}}).resolved()

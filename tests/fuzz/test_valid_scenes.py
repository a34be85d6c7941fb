"""Small scenes that are in order run: every number that they leave is one, and each that stops says why."""

import os
from collections import Counter

import pytest
from _small_runs import not_numbers, ran
from _valid_scenes import scenes, settled
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis.internal.conjecture import providers

from ocean_sim.reading.scene import SceneConfig
from ocean_sim.verbs.check import preflight

FROM_NOWHERE = ("momentum from nowhere", "particles from nowhere", "energy that no work has given")
MANY = int(os.environ.get("OCEAN_SIM_SCENES", 500))  # each takes 3 to 10 s of one core, most of it compiling
PART = 20  # scenes from one seed: a longer series dwells on what it drew, and may leave a kind out


def drawn(count: int, number: int = 0) -> list[SceneConfig]:
    """So many scenes, always the same for a number, without pictures; those of the same kinds stand together and share
    kernels."""
    found: list[SceneConfig] = []
    few = settings(max_examples=PART, database=None, deadline=None, phases=[Phase.generate])

    @settings(few, suppress_health_check=list(HealthCheck))
    @given(scenes())
    def draw(scene):
        config = settled(scene | {"render": None, "report": None, "preview": None})
        if config is not None:
            found.append(config)

    with pytest.MonkeyPatch.context() as patch:
        # Hypothesis also draws constants of the modules that are imported, which depend on what a process has tested.
        patch.setattr(providers, "_get_local_constants", lambda: providers.GLOBAL_CONSTANTS)
        patch.setattr(providers, "CONSTANTS_CACHE", providers.LRUCache(1024))
        for first in range(0, 2 * count, PART):
            if len(found) < count:
                seed(100_000 * number + first)(draw)()
    kinds = ("fluid", "surface", "ship", "wind", "sea")
    return sorted(found[:count], key=lambda scene: [getattr(scene.parts().get(slot), "kind", "") for slot in kinds])


def test_scenes_of_every_kind_are_drawn_and_their_preflight_is_made():
    scenes = drawn(120)
    kinds = Counter(getattr(part, "kind", "") for scene in scenes for part in scene.parts().values())
    assert len(scenes) == 120
    water = {"mueller", "delta_sph", "dfsph", "ballistic", "linear_waves", "spectral_sea"}
    assert water | {"cloth", "marching_cubes"} <= set(kinds)
    assert sum(scene.sea is not None for scene in scenes) >= 3
    assert sum(bool(scene.ships) for scene in scenes) >= 5
    assert sum(len(scene.ships) > 1 for scene in scenes) >= 2
    for scene in scenes:
        found = preflight(scene)
        assert found["time_step"] > 0.0 and found["memory_mb"] > 0.0


@pytest.mark.slow
def test_many_small_scenes_run_or_say_why_not(tmp_path):
    for k, scene in enumerate(drawn(MANY)):
        outcome = ran(scene, tmp_path / str(k))
        assert outcome == "done" or "try" in outcome or "sunk" in outcome, (scene.resolved(), outcome)
        assert not not_numbers(tmp_path / str(k)), scene.resolved()
        told = (tmp_path / str(k) / "events.jsonl").read_text()
        heats = scene.fluid.kind == "mueller"
        assert not [what for what in FROM_NOWHERE[: 2 if heats else 3] if what in told], scene.resolved()

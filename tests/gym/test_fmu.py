"""The boat as a mock-up unit, opened by a reader that is not ours."""

import os
import subprocess
import sys

import pytest

pytest.importorskip("pythonfmu", reason="pythonfmu is absent: pip install .[fmi]")


@pytest.mark.parametrize(
    ("words", "code", "sentence"),
    [(["--help"], 0, "usage: "), (["a", "b"], 2, "usage: "), (["--here"], 2, "usage: "), (["file"], 2, "file: ")],
)
def test_what_cannot_be_meant_writes_nothing(tmp_path, monkeypatch, capsys, words, code, sentence):
    from ocean_sim.gym.unit import main

    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    assert main(words) == code and sentence in "".join(capsys.readouterr())
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


@pytest.mark.parametrize("helm, step", [(float("nan"), 0.1), (0.2, float("nan")), (0.2, -0.1)])
def test_a_step_that_cannot_be_taken_is_an_error_and_changes_nothing(helm, step):
    from ocean_sim.gym.unit import OUTPUT_NAMES, OceanBoat

    boat = OceanBoat(instance_name="boat", resources="")
    boat.exit_initialization_mode()
    boat.throttle = 0.5
    assert boat.do_step(0.0, 0.1)
    before = [getattr(boat, name) for name in OUTPUT_NAMES]
    boat.helm = helm
    assert not boat.do_step(0.1, step)
    assert [getattr(boat, name) for name in OUTPUT_NAMES] == before
    boat.helm = 0.2
    assert boat.do_step(0.1, 0.1) and boat.surge > before[0]


def test_a_unit_is_opened_and_run_by_fmpy(tmp_path):
    fmpy = pytest.importorskip("fmpy", reason="fmpy, a reader of units that is not ours, is absent")
    done = subprocess.run(
        [sys.executable, "-m", "ocean_sim.gym.unit", str(tmp_path)],
        capture_output=True,
        text=True,
        env=os.environ.copy(),
    )
    assert done.returncode == 0, done.stderr
    unit = str(tmp_path / "OceanBoat.fmu")
    found = fmpy.read_model_description(unit)
    assert found.fmiVersion == "2.0" and {"helm", "throttle", "heave", "yaw"} <= {v.name for v in found.modelVariables}
    keys = {"stop_time": 20.0, "step_size": 0.1, "output_interval": 0.1, "output": ["heave", "yaw"]}
    one, same, other = (
        fmpy.simulate_fmu(unit, start_values={"seed": seed, "throttle": 0.5, "helm": 0.2}, **keys)
        for seed in (3.0, 3.0, 4.0)
    )
    assert one.tobytes() == same.tobytes() != other.tobytes()
    assert one["yaw"][-1] > 0.3  # to port

"""What a run shows while it goes on and while its film is drawn."""

from types import SimpleNamespace

import pytest

from ocean_sim import machine
from ocean_sim import result as result_module
from ocean_sim.machine import available_cores
from ocean_sim.observers.render import PICTURE_SECONDS, START_SECONDS
from ocean_sim.reading.scene import load
from ocean_sim.state import checkpoint_file
from ocean_sim.verbs import run as run_verb
from ocean_sim.verbs.check import picture_time, preflight, wall_time
from ocean_sim.verbs.shared import bar as bar_module
from ocean_sim.verbs.shared import progress as progress_module
from ocean_sim.verbs.shared.bar import FILM_CURE, MIN_TIMED_PICTURES, Drawing
from ocean_sim.verbs.shared.progress import Progress

SEA = {
    "basin": {"length": 20.0, "width": 20.0, "depth": 5.0, "walls": "none"},
    "fluid": {"kind": "linear_waves", "height": 0.5, "period": 3.0},
    "duration": 0.9,
    "render": {"every": 0.1},
}


@pytest.fixture
def clock(monkeypatch):
    """A clock that is set by hand."""
    now = SimpleNamespace(wall=100.0)
    monkeypatch.setattr(progress_module, "perf_counter", lambda: now.wall)
    monkeypatch.setattr(bar_module, "perf_counter", lambda: now.wall)
    return now


def at(time: float, steps: int) -> SimpleNamespace:
    return SimpleNamespace(
        time=time,
        steps=steps,
        observers=[],
        fluid=SimpleNamespace(count=0, solvers={}),
        time_step=SimpleNamespace(limited_by="acoustic"),
    )


def shown(progress: Progress, clock, states: list[tuple[float, int]]) -> list[str]:
    """What the bar shows of states one second apart."""
    lines: list[str] = []
    progress.bar.show = lambda done, text: lines.append(text)
    for time, steps in states:
        clock.wall += 1.0
        progress.observe(at(time, steps))
    return lines


def test_no_speed_is_shown_before_there_are_two_steps(clock):
    lines = shown(Progress(10.0, quiet=False), clock, [(0.0, 0), (1.0, 1), (2.0, 2)])
    assert lines == ["t = 1.00 of 10 s", "t = 2.00 of 10 s, 1 x real time, 8.0 s left"]


def test_a_resumed_run_counts_from_where_it_goes_on(clock):
    lines = shown(Progress(10.0, quiet=False), clock, [(8.0, 800), (8.5, 801), (9.0, 802)])
    assert lines == [
        "t = 8.00 of 10 s",
        "t = 8.50 of 10 s, 0.5 x real time, 3.0 s left",
        "t = 9.00 of 10 s, 0.5 x real time, 2.0 s left",
    ]


def test_no_time_is_left_once_the_last_step_is_taken_but_pictures_may_be(clock):
    """However soon after the line before."""
    progress = Progress(1.0, quiet=False)
    lines = shown(progress, clock, [(0.5, 1), (0.9, 2)])
    assert lines[-1].endswith(" s left")
    progress.observe(at(1.02, 3))
    assert lines[-1] == "t = 1.02 of 1 s, writing and drawing what is left"


def test_a_film_whose_pictures_are_drawn_says_so(clock, monkeypatch):
    drawing, lines = Drawing(quiet=False), []
    monkeypatch.setattr(drawing.bar, "show", lambda done, text: lines.append(text))
    for done in range(5, 11):
        clock.wall += 1.0
        drawing(done, 10)
    shown = [f"drawing picture {done} of 10, {10 - done}.0 s left" for done in (8, 9)]  # once the film is announced
    assert lines == [*shown, "10 pictures drawn, finishing"]


def test_pictures_that_are_drawn_while_a_run_goes_on_are_counted_in_its_line(clock, capsys):
    progress = Progress(10.0, quiet=False)
    progress.draw(7, 0)  # nobody knows yet of how many
    lines = shown(progress, clock, [(0.0, 0), (1.0, 1), (2.0, 2)])
    assert lines[-1] == "t = 2.00 of 10 s, 1 x real time, 8.0 s left, 7 pictures drawn"
    assert "film" not in capsys.readouterr().out


def test_a_film_is_estimated_once_from_its_first_pictures(clock, capsys):
    drawing = Drawing(quiet=False, cure=FILM_CURE)
    for done in range(1, 21):
        drawing(done, 101)
        clock.wall += 2.0
    lines = [line for line in capsys.readouterr().out.splitlines() if "film" in line]
    assert lines == [f"drawing a film of 101 pictures, about 3 min 14 s more{FILM_CURE}"]
    assert 2.0 * (101 - 1 - MIN_TIMED_PICTURES) == 194.0 and "render=null" in FILM_CURE
    assert drawing.film_time == 202.0


@pytest.mark.parametrize("film, drafts", [(True, 10), (False, 0)])
def test_an_estimate_says_what_pictures_take_and_how_to_leave_them_out(film, drafts, tmp_path, monkeypatch):
    monkeypatch.setattr(machine, "cache_directory", lambda: tmp_path)
    config = load(SEA, {"render.film": film})
    wall, alone = picture_time(config), START_SECONDS[3] + drafts * PICTURE_SECONDS[3]["draft"]  # on one core
    assert alone / available_cores() <= wall <= alone
    assert f"pictures {wall:.1f} s, which --set render=null saves" in wall_time(preflight(config), config)


@pytest.mark.parametrize("absent", ["render", "frames"])
def test_an_estimate_without_pictures_says_nothing_of_them(absent):
    config = load(SEA, {absent: None})
    assert "pictures" not in wall_time(preflight(config), config)


@pytest.mark.parametrize(
    "since, span", [(0.0, "200 steps, 4 s simulated in "), (1.0, "200 steps in all, t = 1 s to 4 s simulated in ")]
)
def test_a_run_that_went_on_says_from_when(since, span):
    progress = Progress(4.0, quiet=True, since=since)
    progress.time, progress.steps = 4.0, 200
    more = {"worst_compression": {}, "remarks": [], "events": [], "folder": "run", "files": []}
    assert span in run_verb.run_summary(progress.summary() | more)


def test_an_interrupt_names_what_can_still_be_done(tmp_path):
    progress = Progress(10.0, quiet=True)
    progress.time = 4.0
    assert str(run_verb.stopped_run(progress, tmp_path)) == "stopped at t = 4.000 s; nothing was written"
    (tmp_path / "gauges.csv").touch()
    assert str(run_verb.stopped_run(progress, tmp_path)) == f"stopped at t = 4.000 s; {tmp_path} holds what was written"
    for kept, told in ((3.5, 4.0), (4.01, 4.01)):  # a second Ctrl-C stops at once, the first once the state is kept
        (tmp_path / checkpoint_file.checkpoint_name(kept)).touch()
        sentence = str(run_verb.stopped_run(progress, tmp_path))
        cure = f"`ocean-sim resume {tmp_path}` continues it from t = {kept:.3f} s"
        assert sentence == f"stopped at t = {told:.3f} s; {tmp_path} holds what was written; {cure}"
    progress.time = 10.0
    sentence = str(run_verb.stopped_run(progress, tmp_path))
    later = f"`ocean-sim render {tmp_path}` draws them"
    assert sentence == f"stopped while its pictures were drawn; {tmp_path} holds everything else; {later}"


def test_python_prints_a_line_after_each_tenth_where_it_is_asked_to(tmp_path, monkeypatch, capsys):
    wall = iter(range(100))
    monkeypatch.setattr(result_module, "perf_counter", lambda: float(next(wall)))
    step = {"kind": "fixed", "dt": 0.01}
    scene = SEA | {"duration": 1.0, "render": None, "report": None, "time_step": step, "runtime": {"threads": 1}}
    result_module.run(scene, tmp_path / "quiet")
    assert capsys.readouterr().err == ""
    result_module.run(scene, tmp_path / "shown", progress=True)
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 10 and lines[0] == "t = 0.10 of 1 s"
    assert lines[1] == "t = 0.20 of 1 s, 0.1 x real time, 8 s left" and lines[-1].endswith("0 s left")
    shown = result_module.ProgressLines(1.0)
    for done in range(1, 41):
        shown.draw(done, 40)
    shown.draw(41, 0)
    assert capsys.readouterr().err.splitlines()[::3] == [f"picture {k} of 40" for k in (4, 16, 28, 40)]


def test_the_time_of_a_step_does_not_count_what_compiles_late(clock):
    progress = Progress(10.0, quiet=True)
    for step in range(1, 61):
        clock.wall += 30.0 if step in (1, 9, 30) else 0.02
        progress.observe(at(0.01 * step, step))
    assert progress.step_time == pytest.approx(0.02)
    assert Progress(10.0, quiet=True).step_time is None

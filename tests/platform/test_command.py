"""`ocean-sim platform`: what it writes, answers and refuses."""

import json
from functools import partial

import numpy as np
import pytest

from ocean_sim.files.csv_file import read_columns as read_columns
from ocean_sim.files.input_file import Unreadable
from ocean_sim.platform import PLATFORM_COLUMNS
from ocean_sim.platform.hexapod import Config
from ocean_sim.platform.shared import motion_log
from ocean_sim.verbs.platform import read_motion_log
from ocean_sim.verbs.shared import platform_pictures
from tests.platform.conftest import Listener, columns, ride, write

PICTURES = {"motion.png", "legs.png", "workspace.png"}


@pytest.fixture
def ask(ask, tmp_path, monkeypatch):
    """Answer of `ocean-sim platform` in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return partial(ask, "platform")


@pytest.fixture
def draw_nothing(monkeypatch):
    """Call it before commands whose pictures nobody looks at: they take most of the time."""
    return lambda: monkeypatch.setattr(platform_pictures, "draw_pictures", lambda *about: None)


def test_a_log_becomes_a_ride(ask, draw_nothing, log, tmp_path):
    code, out, err = ask(log, "--json", "--frame", "ned")
    answer = json.loads(out)
    assert (code, err, answer["rows"], answer["stream"]) == (0, "", 1001, None)
    names = {"platform.csv", "metrics.csv", "motion_ned.csv", *PICTURES}
    folder = tmp_path / "runs" / "platform"
    assert {path.name for path in folder.iterdir()} == names == {path.rsplit("/", 1)[-1] for path in answer["files"]}
    draw_nothing()
    ned = read_columns(folder / "platform.csv")
    assert tuple(ned) == PLATFORM_COLUMNS and "# frame: ned\n" in (folder / "platform.csv").read_text()
    assert motion_log.read_log(folder / "motion_ned.csv").frame == "ned"
    code, out, _ = ask(log.parent, "--out", "again")  # a run folder
    assert code == 0 and "motion sickness dose" in out and "1001 rows" in out and "nan" not in out
    flu = read_columns(tmp_path / "again" / "platform.csv")
    np.testing.assert_allclose(ned["z_m"], -flu["z_m"], atol=1e-12)
    np.testing.assert_array_equal(ned["leg1_m"], flu["leg1_m"])
    code, _, _ = ask(folder / "motion_ned.csv", "--out", "third")  # the converted log is the same ride
    third = read_columns(tmp_path / "third" / "platform.csv")
    np.testing.assert_allclose(third["leg3_m"], flu["leg3_m"], atol=1e-6)
    assert {metric["quantity"] for metric in answer["metrics"]} >= {
        "force_z_correlation",
        "stroke_used",
        "rate_x_delay",
    }


def test_a_run_without_a_ship_has_no_motion_to_follow(ask, tmp_path):
    (tmp_path / "tank").mkdir()
    (tmp_path / "tank" / "manifest.json").write_text("{}")
    code, _, err = ask(tmp_path / "tank")
    assert code == 2 and "no motion log: its scene has no ship" in err


@pytest.fixture(scope="module")
def drawn():
    """A ride that is quiet at first, and its machine."""
    machine, t = Config(ramp=0.0).build(0.01), np.arange(2500) * 0.01
    up = np.where(t > 12.0, np.sin(t), 0.0)[:, None] * [0.0, 0.0, 1.0]
    return machine.follow(ride(len(t), 0.01, up)), machine


@pytest.mark.parametrize("one, other", platform_pictures.WORKSPACE_PAIRS)
def test_a_workspace_is_drawn_whole(drawn, one, other):
    """All that two motions reach together lies inside its picture, and each alone reaches the ends that are known."""
    _, machine = drawn
    across, up, usage = platform_pictures.stroke_usage_grid(machine, one, other)
    inside = usage <= 1.0
    assert inside.any() and not (inside[0].any() or inside[-1].any() or inside[:, 0].any() or inside[:, -1].any())
    for values, motion in ((across, one), (up, other)):
        ends = machine.workspace.ends[motion] * (1.0 if motion < 3 else 180.0 / np.pi)
        step = np.ptp(values) / (platform_pictures.WORKSPACE_POINTS - 1)
        assert values[inside].min() <= ends[0] + step and values[inside].max() >= ends[1] - step


def test_a_long_ride_is_drawn_where_it_is_liveliest(drawn, tmp_path, monkeypatch):
    done, machine = drawn
    monkeypatch.setattr(platform_pictures, "MAX_CURVE_SECONDS", 5.0)
    spans, legs = [], platform_pictures.draw_legs
    monkeypatch.setattr(
        platform_pictures, "draw_legs", lambda some, *more: (spans.append(some.time), legs(some, *more))[1]
    )
    platform_pictures.draw_pictures(tmp_path, done, None, Config(), machine, film=False)
    assert len(spans[0]) == 500 and spans[0][0] > 11.0 and {path.name for path in tmp_path.iterdir()} == PICTURES


def test_a_film_is_in_real_time_and_shows_the_liveliest_seconds(drawn, tmp_path):
    from PIL import Image

    done, machine = drawn
    rows = platform_pictures.film_rows(done, machine)
    assert len(rows) == 200 and done.time[rows[0]] > 11.0 and np.all(np.diff(rows) == 5)
    short = done.select(slice(1300, 1360))
    platform_pictures.write_film(tmp_path / "film.gif", short, machine)
    with Image.open(tmp_path / "film.gif") as film:
        assert film.n_frames == len(platform_pictures.film_rows(short, machine)) == 12 and film.info["duration"] == 50


def test_a_ride_of_two_rows_is_one(ask, tmp_path):
    two = {name: column[:2] for name, column in columns(1.0).items()}
    code, out, err = ask(write(tmp_path / "two.csv", two), "--film", "--out", "two")
    assert (code, err) == (0, "") and "2 rows" in out
    assert {path.name for path in (tmp_path / "two").iterdir()} >= PICTURES | {"film.gif", "platform.csv"}


def test_a_ramp_that_outlasts_the_ride_is_told(ask, draw_nothing, log):
    _, out, _ = ask(log, "--ramp", "1e9")
    assert "when it does 0 % of it" in out and "; 0 % of the stroke" in out
    draw_nothing()
    _, out, _ = ask(log, "--ramp", "20")
    assert "over 20 s, and the ride ends after 10 s, when it does 50 % of it" in out
    _, out, _ = ask(log, "--ramp", "10")
    assert "warning" not in out


@pytest.mark.parametrize(
    "heave, begins, advised", [(0.7, 0.0, True), (0.9, 0.0, True), (0.7, 90.0, False), (1.3, 0.0, False)]
)
def test_a_longer_ramp_is_advised_where_it_helps(ask, draw_nothing, tmp_path, heave, begins, advised):
    """Heave in 8 s that begins where she rises fastest, or at her highest. Of 0.9 m legs limit some of the rest, too;
    of 1.3 m half of it, and a longer ramp only lowers the motion for a while."""
    draw_nothing()
    t = np.arange(0.0, 60.0, 0.1)
    motion = {"t": t, "z": heave * np.sin(2.0 * np.pi * t / 8.0 + np.radians(begins))}
    log = write(tmp_path / "heave.csv", motion), "--columns", "time=t,heave=z"
    _, out, _ = ask(*log)
    assert ("--ramp 12 begins gently" in out) == advised
    if advised:
        assert limited_share(ask(*log, "--ramp", "12")[1]) < 0.6 * limited_share(out)


def limited_share(said):
    """Percentage of limited rows that the command states."""
    return float(said.partition(" % of them limited")[0].rpartition(" ")[2])


def test_it_streams_at_the_pace_of_the_log_and_comes_to_rest(ask, draw_nothing, tmp_path):
    draw_nothing()
    short, listener = write(tmp_path / "short.csv", columns(0.5)), Listener(351)
    code, out, _ = ask(short, "--stream", listener.url)
    seen = listener.packets()
    assert code == 0 and f"{listener.url}: 351 packets, every" in out
    assert [packet.seq for packet in seen] == list(range(351))
    assert not np.any(seen[-1].pose) and np.allclose(seen[-1].legs, 2.706)


def test_other_geometries_and_washouts(ask, log, tmp_path):
    assert ask(log, "--geometry", "linuxcnc", "--washout", "srs", "--out", "a")[0] == 0
    (tmp_path / "mine.yaml").write_text("kind: classical\nforce_scale: [1, 1, 1]\n")
    code, _, err = ask(log, "--washout", "mine.yaml", "--out", "b")
    assert code == 2 and "mine.yaml:1:1: washout.rotation_scale: missing key" in err
    (tmp_path / "tall.yaml").write_text("base: [[1, 0, 0]]\nplatform: 3\nshortest: 2\nlongest: 1\n")
    code, _, err = ask(log, "--geometry", "tall.yaml", "--out", "b")
    assert code == 2 and "tall.yaml:" in err
    assert not (tmp_path / "b").exists()


@pytest.mark.parametrize(
    "words, sentence",
    [
        (["--geometry", "hexapd_a"], "--geometry: there is no geometry 'hexapd_a'; did you mean 'hexapod_a'?"),
        (["--washout", "none"], "--washout: there is no washout 'none'"),
        (["--frame", "enu"], "--frame: there is no 'enu'; there are flu, ned, ship"),
        (["--packets", "x"], "--packets: there is no 'x'"),
        (["--stream", "tcp://there"], "--stream: 'tcp://there' is not like udp://127.0.0.1:5005"),
        (["--stream", "udp://nowhere.invalid:5"], "--stream: udp://nowhere.invalid:5: "),
        (["--stream", "udp://255.255.255.255:5"], "--stream: udp://255.255.255.255:5: "),
        (["--columns", "time=t,heave=a,heave=b"], "--columns: heave is given twice"),
        (["--columns", "time=t,roll=a,pitch=a"], "--columns: a is given twice"),
    ],
)
def test_what_makes_no_sense_is_refused(ask, log, tmp_path, words, sentence):
    code, out, err = ask(log, *words, "--out", "there")
    assert code == 2 and out == "" and err.startswith(sentence) and err.count("\n") == 1
    assert not (tmp_path / "there").exists()


def test_a_log_that_is_none_is_refused_and_nothing_is_written(ask, tmp_path):
    broken = columns(2.0)
    broken["heave_m"][50:] += 10.0
    half = {name: column for name, column in columns(2.0).items() if name != "force_buoyancy_y_N"}
    code, _, err = ask(write(tmp_path / "half.csv", half), "--frame", "ned", "--out", "there")
    assert code == 2 and "has no column force_buoyancy_y_N" in err and err.count("\n") == 1
    for path in (tmp_path / "absent.csv", tmp_path, write(tmp_path / "jump.csv", broken)):
        code, out, err = ask(path, "--out", "there")
        assert code == 2 and out == "" and err.count("\n") == 1
        code, out, _ = ask(path, "--out", "there", "--json")
        assert code == 2 and json.loads(out)["error"]
    assert not (tmp_path / "there").exists()


def own_log(path, table, **renamed):
    """Write some columns of a log under a person's own names: angles in degrees, others as they are."""
    own = {renamed[name]: np.degrees(table[name]) if name.endswith("_rad") else table[name] for name in renamed}
    lines = [",".join(own), *(",".join(format(value, ".9g") for value in row) for row in zip(*own.values()))]
    path.write_text("\n".join(lines) + "\n")
    return path


OWN = {"time_s": "t", "heave_m": "Hub", "roll_rad": "Roll", "surge_m": "weg"}
COLUMNS = ["--columns", "time=t,heave=Hub,roll=Roll,surge=weg", "--units", "deg"]


def test_an_own_log_of_three_motions_is_the_ride_of_the_whole_log(ask, draw_nothing, tmp_path):
    draw_nothing()
    table = columns(20.0, dt=0.02)
    code, _, err = ask(write(tmp_path / "whole.csv", table), "--out", "whole")
    assert (code, err) == (0, "")
    code, out, err = ask(own_log(tmp_path / "own.csv", table, **OWN), *COLUMNS, "--out", "own", "--frame", "ned")
    assert (code, err) == (0, "") and "own.csv: taken as 0: sway_m, pitch_rad, yaw_rad" in out
    assert "rates derived from angles" in out and "specific force derived from positions, angles and gravity" in out
    whole, own = (read_columns(tmp_path / name / "platform.csv") for name in ("whole", "own"))
    for k in range(1, 7):
        np.testing.assert_allclose(own[f"leg{k}_m"], whole[f"leg{k}_m"], atol=2e-4)
    turned = read_columns(tmp_path / "own" / "motion_ned.csv")
    np.testing.assert_allclose(turned["heave_m"], -table["heave_m"], atol=1e-8)
    np.testing.assert_allclose(turned["roll_rad"], table["roll_rad"], atol=1e-8)
    np.testing.assert_allclose(turned["specific_force_y_m_s2"], -table["specific_force_x_m_s2"], atol=2e-3)


@pytest.mark.parametrize("form", ["iso", "epoch", "uneven"])
def test_times_are_dates_milliseconds_or_a_little_uneven(form, ask, draw_nothing, tmp_path):
    draw_nothing()
    table = columns(20.0, dt=0.02)
    path = own_log(tmp_path / "own.csv", table, **OWN)
    ask(path, *COLUMNS, "--out", "even")
    off = 0.004 * np.sin(np.pi * 0.137 * np.arange(1001)) if form == "uneven" else np.zeros(1001)  # 0 in the last row
    time = table["time_s"] + off
    moved = {name: np.interp(time, table["time_s"], values) for name, values in table.items()} | {"time_s": time}
    lines = own_log(path, moved, **OWN).read_text().splitlines()
    begin = np.datetime64("2026-11-29T05:40:00.000")
    stamp = {
        "iso": lambda cell: f"{begin + np.timedelta64(round(1e3 * float(cell)), 'ms')}+01:00",
        "epoch": lambda cell: f"{1764394800123 + round(1e3 * float(cell))}",
        "uneven": str,
    }[form]
    rest = [row.partition(",") for row in lines[1:]]
    path.write_text("\n".join([lines[0], *(f"{stamp(cell)},{others}" for cell, _, others in rest)]) + "\n")
    code, out, err = ask(path, *COLUMNS, "--out", form)
    assert (code, err) == (0, "") and ("interpolated to rows every 0.02 s" in out) == (form == "uneven")
    assert f"# start: {stamp('0')}\n" in (tmp_path / form / "platform.csv").read_text()
    even, other = (read_columns(tmp_path / name / "platform.csv") for name in ("even", form))
    np.testing.assert_allclose(other["leg1_m"], even["leg1_m"], atol=2e-3 if form == "uneven" else 1e-6)


def test_rows_four_times_a_second_are_interpolated(ask, draw_nothing, tmp_path):
    draw_nothing()
    table = columns(20.0, dt=0.02)
    ask(own_log(tmp_path / "own.csv", table, **OWN), *COLUMNS, "--out", "fine")
    few = {name: values[::12] for name, values in table.items()}
    code, out, err = ask(own_log(tmp_path / "own.csv", few, **OWN), *COLUMNS, "--out", "few")
    assert (code, err) == (0, "") and "rows come every 0.24 s: interpolated to rows every 0.048 s" in out
    fine, found = (read_columns(tmp_path / name / "platform.csv") for name in ("fine", "few"))
    legs = np.interp(found["time_s"], fine["time_s"], fine["leg1_m"])
    np.testing.assert_allclose(found["leg1_m"], legs, atol=0.02 * np.ptp(legs))
    tenth = {name: values[::5] for name, values in columns(40.0, dt=0.02).items()}  # the fewest taken as they are
    code, out, err = ask(own_log(tmp_path / "own.csv", tenth, **OWN), *COLUMNS, "--out", "tenth")
    assert (code, err) == (0, "") and "interpolated" not in out
    rare = {name: values[::30] for name, values in table.items()}
    assert "it has a row every 0.6 s" in ask(own_log(tmp_path / "own.csv", rare, **OWN), *COLUMNS)[2]


@pytest.mark.parametrize("heading", [90.0, 200.0])
def test_surge_and_sway_are_along_and_across_the_heading(heading, ask, draw_nothing, tmp_path):
    draw_nothing()
    time = np.arange(0.0, 20.0, 0.05)
    found = []
    for yaw in (0.0, heading):
        rows = zip(time, 0.5 * np.sin(time), 0.2 * np.cos(time), 0 * time + yaw)
        lines = ["t,Surge,Sway,Hdg", *(",".join(f"{value:.9g}" for value in row) for row in rows)]
        (tmp_path / "own.csv").write_text("\n".join(lines))
        words = ["--columns", "time=t,surge=Surge,sway=Sway,yaw=Hdg", "--units", "deg", "--axes", "ned"]
        code, out, err = ask(tmp_path / "own.csv", *words, "--out", f"{yaw:g}")
        assert (code, err) == (0, "") and "surge and sway taken along and across her heading" in out
        found.append(read_columns(tmp_path / f"{yaw:g}" / "platform.csv"))
    for k in range(1, 7):
        np.testing.assert_allclose(found[1][f"leg{k}_m"], found[0][f"leg{k}_m"], atol=1e-4)


def test_what_an_own_log_lacks_is_said_at_once(ask, tmp_path):
    path = own_log(tmp_path / "own.csv", columns(1.0), **OWN)
    code, _, err = ask(path)
    assert code == 2 and "has no column time_s, sway_m, heave_m" in err and "--columns" in err and err.count("\n") == 1
    code, _, err = ask(path, "--columns", "time=t,heave=up,roll=phi")
    assert code == 2 and "has no column up and no column phi, but 't, Hub, Roll, weg'" in err
    assert "did you mean 'heave'?" in ask(path, "--columns", "time=t,heav=Hub")[2]
    assert "has no column for any of sway_m" in ask(path, "--columns", "time=t")[2]
    steep = own_log(path, columns(10.0, roll=0.2), **OWN)
    code, _, err = ask(steep, *COLUMNS[:2])
    assert code == 2 and "roll_rad reaches 11.5 rad; is Roll in degrees (--units deg, or in its name)?" in err


UNITS = {  # of the time, the heave and the roll of one log, by their names, and how many one of ours is
    "a": {"Time (ms)": 1e3, "Heave, mean (cm)": 100.0, "Roll (mrad)": 1e3},
    "b": {"Time (min)": 1.0 / 60.0, "Heave [ft]": 1.0 / 0.3048, "Roll/deg": 180.0 / np.pi},
    "c": {"Excel time (days)": 1.0 / 86400.0, "heave_mm": 1e3, "Roll (deg, port up)": 180.0 / np.pi},
    "d": {"t": 1.0, "z": 1.0, "roll_rad": 1.0},
}


@pytest.mark.parametrize("case", UNITS)
def test_units_are_those_in_the_names_of_columns(case, tmp_path):
    table, names = columns(20.0, dt=0.02), UNITS[case]
    own = [table[name] * factor for name, factor in zip(("time_s", "heave_m", "roll_rad"), names.values())]
    rows = [",".join(format(value, ".12g") for value in row) for row in zip(*own)]
    (tmp_path / "own.csv").write_text("\n".join([",".join(f'"{name}"' for name in names), *rows]), encoding="utf-8")
    text = ",".join(f"{key}={name}" for key, name in zip(("time", "heave", "roll"), names))
    ride, _ = read_motion_log(tmp_path / "own.csv", None, text, None, "ship")
    assert ride.every == pytest.approx(0.02, rel=1e-6)
    for name in ("heave_m", "roll_rad"):
        np.testing.assert_allclose(ride.table[name], table[name], atol=1e-8)


@pytest.mark.parametrize(
    "own, units, sentence",
    [
        ("roll=Roll (deg),pitch=Pitch (rad)", "deg", "pitch has the column Pitch (rad), which is in rad"),
        ("roll=Roll (deg)", "rad", "roll has the column Roll (deg), which is in deg"),
        ("heave=Roll (deg)", None, "heave has the column Roll (deg), which is in deg"),
        ("roll=Roll (deg),pitch=Pitch", None, "Pitch states no unit, others do: is it in degrees (--units deg)?"),
    ],
)
def test_a_unit_that_contradicts_a_motion_or_an_option_is_refused(own, units, sentence, tmp_path):
    (tmp_path / "own.csv").write_text("t,Roll (deg),Pitch (rad),Pitch\n0,1,0.1,1\n0.1,1,0.1,1\n")
    with pytest.raises(Unreadable) as caught:
        read_motion_log(tmp_path / "own.csv", None, f"time=t,{own}", units, "ship")
    assert sentence in str(caught.value)


def test_a_unit_after_a_time_that_is_a_date_changes_nothing(tmp_path):
    rows = [f"2026-05-17T09:12:0{k / 10:.1f}Z,0.1" for k in range(20)]
    (tmp_path / "own.csv").write_text("\n".join(["Time (ms),Heave (m)", *rows]))
    ride, _ = read_motion_log(tmp_path / "own.csv", None, "time=Time (ms),heave=Heave (m)", None, "ship")
    assert ride.every == pytest.approx(0.1)


def test_limited_rows_are_counted_by_reason(ask, draw_nothing, tmp_path):
    draw_nothing()
    code, out, _ = ask(write(tmp_path / "steep.csv", columns(20.0, heave=6.0)))
    assert code == 0 and " rows between " in out and " s: scaled back near the end of a stroke" in out

import numpy as np
import pytest

from ocean_sim import conventions
from ocean_sim.files import csv_file
from ocean_sim.observers.motion import Log
from ocean_sim.observers.motion import log_columns as logged
from ocean_sim.platform.shared.motion_log import (
    FORCE_COLUMNS,
    LOG_FRAMES,
    check_convertible,
    convert_rows,
    negate_cell,
    read_log,
    ride_of,
    round_interval,
)
from ocean_sim.ship import PARTS
from ocean_sim.ship.body.track import Attitude
from tests.platform.conftest import G, columns, write


def without(table, keep):
    return {name: column[keep] for name, column in table.items()}


def changed(name, change):
    table = columns()
    return table | {name: change(table[name])}


def with_value(name, row, value):
    table = columns()
    table[name] = table[name].copy()
    table[name][row] = value
    return table


BAD = {
    "rows that are missing": (without(columns(), np.r_[0:300, 340:1001]), "rows are missing or out of order"),
    "rows that are shuffled": (without(columns(), np.r_[0:300, 301, 300, 302:1001]), "times rise from row to row"),
    "rows that are there twice": (without(columns(), np.r_[0:300, 299:1001]), "times rise from row to row"),
    "NaN": (with_value("roll_rad", 500, np.nan), "roll_rad is 'nan' in row 501"),
    "infinity": (with_value("pitch_rate_rad_s", 3, np.inf), "pitch_rate_rad_s is 'inf' in row 4"),
    "a jump": (with_value("heave_m", 700, 10.0), "the ship jumps by .* m between"),
    "no rows": (without(columns(), np.r_[0:0]), "has no rows"),
    "one row": (without(columns(), np.r_[0:1]), "has 1 of at least 2 rows"),
    "a turn at once": (
        changed("roll_rad", lambda roll: roll + 1.5 * (np.arange(len(roll)) >= 700)),
        "turns by 8[56]",
    ),
    "forces in mm/s2": (
        columns() | {name: 1000.0 * columns()[name] for name in FORCE_COLUMNS},
        "is it in another unit?",
    ),
    "forces in g": (columns() | {name: columns()[name] / G for name in FORCE_COLUMNS}, "is it in g?"),
    "rates in degrees": (
        changed("roll_rate_rad_s", np.degrees),
        "roll_rad changes by 0.017.* times what roll_rate_rad_s make of it .* in degrees",
    ),
    "angles in degrees": (changed("roll_rad", np.degrees), "in degrees?"),
    "too few rows a second": (columns(60.0, dt=0.5), "row every 0.5 s; rows are evenly spaced, 10 a second"),
}


@pytest.mark.parametrize("what", BAD)
def test_a_log_that_cannot_be_is_refused_with_a_sentence(tmp_path, what):
    table, sentence = BAD[what]
    with pytest.raises(ValueError, match=sentence) as error:
        read_log(write(tmp_path / "bad.csv", table))
    assert "\n" not in str(error.value) and str(error.value).startswith(str(tmp_path / "bad.csv"))


def test_other_units_and_frames_are_named(tmp_path):
    table = columns()
    in_degrees = {("roll_deg" if name == "roll_rad" else name): column for name, column in table.items()}
    with pytest.raises(ValueError, match="has no column roll_rad, but roll_deg: it has another unit"):
        read_log(write(tmp_path / "a.csv", in_degrees))
    with pytest.raises(ValueError, match=r"frame .enu.; .* one of"):
        read_log(write(tmp_path / "b.csv", table, frame="enu"))
    for frame in ("ned", "flu"):
        with pytest.raises(ValueError, match="gravity does not point down"):
            read_log(write(tmp_path / "c.csv", table, frame=frame))
    path = write(tmp_path / "d.csv", table)
    lines = path.read_text().splitlines()
    path.write_text("\n".join([*lines[:50], lines[50].rpartition(",")[0], *lines[51:]]))
    with pytest.raises(ValueError, match=r"row 48 \(line 51\) has 20 cells under 21 names"):
        read_log(path)
    path.write_text("\n".join([*lines[:50], lines[50].replace(lines[50].split(",")[4], "word", 1), *lines[51:]]))
    with pytest.raises(ValueError, match="surge_m is 'word' in row 48"):
        read_log(path)
    path.write_text("\n".join([*lines[:50], lines[50].replace(lines[50].split(",")[4], "", 1), *lines[51:]]))
    with pytest.raises(ValueError, match="surge_m is empty in row 48"):
        read_log(path)
    path.write_text("\n".join([*lines[:2], lines[2].replace("force_buoyancy_x_N", "roll_rad"), *lines[3:]]))
    with pytest.raises(ValueError, match="has two columns 'roll_rad'"):
        read_log(path)
    path.write_bytes(b"\xff\x00")
    with pytest.raises(ValueError, match="is not UTF-8 text"):
        read_log(path)


def test_a_log_is_the_same_ride_in_every_frame(log, tmp_path):
    whole = read_log(log)
    assert whole.every == pytest.approx(0.01) and whole.frame == "ship" and whole.table.head["seed"] == "7"
    np.testing.assert_allclose(whole.ride.specific_force[0], [0.0, 0.0, G - (2 * np.pi / 6.0) ** 2], atol=1e-7)
    for frame in ("ned", "flu", "ship"):
        names = whole.table.names
        rows = np.array([[float(cell) for cell in row] for row in convert_rows(whole, frame)])
        there = read_log(write(tmp_path / f"{frame}.csv", dict(zip(names, rows.T)), frame))
        for one, other in zip(there.ride, whole.ride):
            np.testing.assert_allclose(one, other, atol=1e-8)
        back = np.array([[float(cell) for cell in row] for row in convert_rows(there, "ship")])
        np.testing.assert_allclose(
            back, [[float(cell) for cell in line.split(",")] for line in whole.table.rows], atol=1e-8
        )


def test_a_log_whose_vectors_are_not_whole_is_not_converted(tmp_path):
    table = columns(1.0)
    check_convertible(read_log(write(tmp_path / "whole.csv", table)))
    alone = {name: column for name, column in table.items() if name != "force_buoyancy_y_N"}
    words = table | {"force_buoyancy_z_N": ["none"] * 101}
    for name, wrong, sentence in (
        ("alone.csv", alone, "has no column force_buoyancy_y_N"),
        ("words.csv", words, "force_buoyancy_z_N is 'none' in row 1"),
    ):
        path = tmp_path / name
        rows = [",".join(str(cell) for cell in row) for row in zip(*wrong.values())]
        path.write_text("\n".join([",".join(wrong), *rows]))
        with pytest.raises(ValueError, match=sentence):
            check_convertible(read_log(path))


def test_axes_of_the_frames(log):
    """NED (1, 2, 3) is ours (-2, -3, 1) and FLU (1, -2, -3); a worked specific force, and the quaternion."""
    ned = np.array([-0.187498, -0.991343, -8.237563])
    flu = ned @ LOG_FRAMES["ned"]
    np.testing.assert_allclose(flu, [-0.187498, 0.991343, 8.237563])
    np.testing.assert_allclose(LOG_FRAMES["ship"] @ flu, [0.991343, 8.237563, -0.187498])
    assert all(np.linalg.det(axes) == pytest.approx(1.0) for axes in LOG_FRAMES.values())
    whole = read_log(log)
    row = dict(zip(whole.table.names, list(convert_rows(whole, "ned"))[150]))
    own = dict(zip(whole.table.names, whole.table.rows[150].split(",")))
    assert float(row["qx"]) == float(own["qz"]) and float(row["heave_m"]) == -float(own["heave_m"])
    assert float(row["roll_rad"]) == float(own["roll_rad"]) and row["surge_m"] == own["surge_m"]
    assert [row[f"force_buoyancy_{axis}_N"] for axis in "xyz"] == ["3", "-1", "-2"]
    assert [negate_cell(cell) for cell in ("1.50", "-2e-3", " +3", "0", "-0.0")] == ["-1.50", "2e-3", "-3", "0", "0.0"]


@pytest.mark.parametrize(
    "frame, felt",
    [
        ("ned", (-0.187498, -0.991343, -8.237563)),
        ("flu", (-0.187498, 0.991343, 8.237563)),
        ("ship", (0.991343, 8.237563, -0.187498)),
    ],
)
def test_a_worked_specific_force_as_the_log_tells_it(frame, felt):
    """In NED: acceleration (0.5, -0.3, 0.8), rate (0.1, 0.2, 0.05) and its change (0.3, -0.2, 0.1), felt at (2, 0.5,
    -1.5), roll 8 and pitch -5 degrees."""
    from scipy.spatial.transform import Rotation

    ours = conventions.FRAMES["ned"].T
    turn = ours @ Rotation.from_euler("ZYX", [0.0, -5.0, 8.0], degrees=True).as_matrix() @ ours.T
    acceleration, rate, change, arm = (
        ours @ vector for vector in ([0.5, -0.3, 0.8], [0.1, 0.2, 0.05], [0.3, -0.2, 0.1], [2.0, 0.5, -1.5])
    )
    observer = Log.__new__(Log)
    observer.frame, observer.arm, observer.gravity = frame, arm, np.array([0.0, -G, 0.0])
    observer.signs = conventions.to_frame(frame, np.eye(3)).sum(axis=1)
    body = Attitude(np.zeros((4, 1)), turn[..., None], (turn @ rate)[:, None])
    rest = np.zeros((1, 2 + 6 * len(PARTS)))  # no orders, no load
    [values] = observer.load_table(body, (turn @ acceleration)[:, None], (turn @ change)[:, None], rest)
    row = dict(zip(logged(PARTS)[-len(values) :], values))
    np.testing.assert_allclose([row[name] for name in FORCE_COLUMNS], felt, rtol=0.0, atol=1e-6)


def test_a_ship_at_rest_feels_gravity_upward(tmp_path):
    ride = read_log(write(tmp_path / "still.csv", columns(1.0, heave=0.0, roll=0.0))).ride
    np.testing.assert_array_equal(ride.specific_force, np.tile([0.0, 0.0, G], (101, 1)))
    assert ride_of(csv_file.Table(tmp_path / "still.csv"), "world").seq[-1] == 100


@pytest.mark.parametrize("every", [0.01, 1.0 / 60.0, 0.0123456789])
def test_the_time_between_rows_is_that_of_the_run(every, tmp_path):
    """To the bit, so the filters of a washout are those of the run; differences of times with nine digits are not."""
    table = columns(60.0, every)
    assert read_log(write(tmp_path / "motion.csv", table)).every == round_interval(every)
    assert round_interval(every) == pytest.approx(every, rel=5e-8)


def moved(seconds=20.0, dt=0.02):
    """A ship that surges, sways, heaves, rolls, pitches and yaws: all columns that say the same twice, FLU axes."""
    from scipy.spatial.transform import Rotation

    t = np.arange(round(seconds / dt) + 1) * dt

    def wave(size, omega, phase, k):
        return size * omega**k * np.cos(omega * t + phase + k * np.pi / 2.0)

    motions = {"surge": (0.4, 0.9, 0.3), "sway": (0.3, 1.1, 1.2), "heave": (0.5, 1.0, 0.1)}
    turns = {"roll": (0.15, 0.8, 0.5), "pitch": (0.06, 1.2, 2.0), "yaw": (0.2, 0.5, 1.0)}
    table = {"time_s": t} | {f"{name}_m": wave(*how, 0) for name, how in motions.items()}
    table |= {f"{name}_velocity_m_s": wave(*how, 1) for name, how in motions.items()}
    table |= {f"{name}_acceleration_m_s2": wave(*how, 2) for name, how in motions.items()}
    angle, change = ([wave(*how, k) for how in turns.values()] for k in (0, 1))
    table |= {f"{name}_rad": value for name, value in zip(turns, angle)}
    (r, p, _), (r_t, p_t, y_t) = angle, change
    rates = (
        r_t - y_t * np.sin(p),
        p_t * np.cos(r) + y_t * np.sin(r) * np.cos(p),
        y_t * np.cos(r) * np.cos(p) - p_t * np.sin(r),
    )
    table |= {f"{name}_rate_rad_s": value for name, value in zip(turns, rates)}
    pose = Rotation.from_euler("ZYX", np.column_stack(angle)[:, ::-1])
    felt = np.column_stack([table[f"{name}_acceleration_m_s2"] for name in motions]) + [0.0, 0.0, G]
    table |= dict(zip(FORCE_COLUMNS, pose.inv().apply(felt).T))
    return table | dict(zip(("qx", "qy", "qz", "qw"), pose.as_quat().T))


def written(path, table, offset=0.0, digits=6):
    rows = [
        ",".join(f"{value:.{digits}f}" for value in row)
        for row in zip(*(table | {"time_s": table["time_s"] + offset}).values())
    ]
    path.write_text("\n".join(["# frame: flu", ",".join(table), *rows]) + "\n")
    return path


def test_what_a_log_says_twice_agrees(tmp_path):
    table, path = moved(), tmp_path / "log.csv"
    assert len(read_log(written(path, table)).ride.time) == 1001
    noisy = {name: v + 0.01 * np.std(v) * np.random.default_rng(1).normal(size=len(v)) for name, v in table.items()}
    read_log(written(path, noisy | {"time_s": table["time_s"]}))
    read_log(
        written(path, table | {"sway_m": 0.0 * table["sway_m"], "sway_velocity_m_s": 0.0 * table["sway_m"]})
    )  # not known
    for name in [name for name in table if name not in ("time_s", "qw")]:
        with pytest.raises(ValueError, match=r"agree|Columns that say the same|gravity") as refused:
            read_log(written(path, table | {name: -table[name]}))
        assert (
            "gravity" in str(refused.value)
            or name.startswith("q")
            or name in str(refused.value)
            or name.split("_")[0] in str(refused.value)
        )
    for name, factor, unit in (
        ("yaw_rad", 180.0 / np.pi, "degrees"),
        ("pitch_rate_rad_s", 180.0 / np.pi, "degrees"),
        ("heave_velocity_m_s", 1.9438, "knots"),
        ("sway_velocity_m_s", 3.6, "km/h"),
        ("surge_acceleration_m_s2", 1.0 / G, "in g"),
    ):
        with pytest.raises(ValueError, match=unit):
            read_log(written(path, table | {name: factor * table[name]}))
    for one, other in (
        ("roll_rad", "pitch_rad"),
        ("roll_rate_rad_s", "yaw_rate_rad_s"),
        (FORCE_COLUMNS[0], FORCE_COLUMNS[1]),
    ):
        with pytest.raises(ValueError, match=r"agree|Columns that say the same"):
            read_log(written(path, table | {one: table[other], other: table[one]}))


@pytest.mark.parametrize("offset", [0.0, 86400.0, 1709294400.0, 2e9])
@pytest.mark.parametrize("digits", [2, 6])
def test_a_gap_is_found_to_the_digits_of_the_times(tmp_path, offset, digits):
    table, path = moved(), tmp_path / "log.csv"
    assert read_log(written(path, table, offset, max(digits, 4))).every == pytest.approx(0.02, abs=1e-8)
    for gap in (1, 2, 50):
        with pytest.raises(ValueError, match=r"rows are missing or out of order between .*, rows 400 and 401"):
            read_log(written(path, without(table, np.r_[0:400, 400 + gap : 1001]), offset, max(digits, 4)))


@pytest.mark.parametrize(
    "name, value, said",
    [
        ("roll_rate_rad_s", 0.0, "roll_rad turns by"),
        ("yaw_rad", 0.0, "yaw_rate_rad_s says"),
        ("qw", 0.0, "unit length"),
    ],
)
def test_a_column_that_was_left_out_is_said(tmp_path, name, value, said):
    table = moved()
    with pytest.raises(ValueError, match=said):
        read_log(written(tmp_path / "log.csv", table | {name: value + 0.0 * table[name]}))


def test_a_log_of_other_software_is_answered_by_the_columns_that_it_has(tmp_path):
    names, row = "Zeit UTC,MRU Heave (m),Roll Rate (deg/s),MRU Roll (deg),MRU Pitch (deg),Hdg", ",0.1,0.2,1.0,0.5,358.0"
    (tmp_path / "my log.csv").write_text(f"{names}\n0.0{row}\n0.1{row}\n")
    yours = "'time=Zeit UTC,heave=MRU Heave (m),roll=MRU Roll (deg),pitch=MRU Pitch (deg),yaw=Hdg'"
    with pytest.raises(ValueError) as caught:
        read_log(tmp_path / "my log.csv")
    said = str(caught.value)
    assert f"'{tmp_path / 'my log.csv'}' --columns {yours} --units deg`, with `--axes ned`" in said
    assert "has no column time_s, sway_m, heave_m and 10 more" in said and "docs/guide/own_log.md" in said


@pytest.mark.parametrize(
    "names, row, said",
    [
        (
            "UTC,Heave,Roll,Hdg",
            "0.1,1.0,358.0",
            "--columns time=UTC,heave=Heave,roll=Roll,yaw=Hdg --units deg`, with",
        ),
        ("t (s),Heave,Roll", "0.1,1.0", "--columns 'time=t (s),heave=Heave,roll=Roll'`, with `--units deg` if"),
        ("t,Heave,Roll (rad)", "0.1,7.0", "--columns 'time=t,heave=Heave,roll=Roll (rad)'`, with `--axes"),
        ("Zeit,Surge (cm),Sway velocity (m/s)", "0.1,1.0", "--columns 'time=Zeit,surge=Surge (cm)'`"),
        ("Time\xa0(s),Heave\xa0(m)", "0.1", "--columns 'time=Time (s),heave=Heave (m)'`"),  # with spaces
        ('Time (s),"Heave, mean (m)"', "0.1", "--columns 'time=Time (s),heave=Heave, mean (m)'`"),
        ("Zeit [s],Stampfwinkel [\xb0],Hub [m]", "1,0.5", "'time=Zeit [s]'`, with `--axes ned` if down is positive"),
        ("Time (s),Ax (g),Gx (deg/s)", "0.1,1.0", "none of its columns is one of surge"),
        ("No,Time,Heave", "05/17/2026 09:12:00,0.1", "its Time begins with '05/17/2026 09:12:00', no number or date"),
        ("No,Time,Heave", "s,m", "write units into the names"),
    ],
)
def test_columns_and_units_are_guessed_from_names_and_values(tmp_path, names, row, said):
    (tmp_path / "log.csv").write_text(f"{names}\n0.0,{row}\n0.1,{row}\n", encoding="utf-8")
    with pytest.raises(ValueError) as caught:
        read_log(tmp_path / "log.csv")
    assert said in str(caught.value)


@pytest.mark.parametrize(
    "first, second, key",
    [
        ("2026-03-04T05:06:07.98Z", "2026-03-04T05:06:08.00Z", "time=when"),
        ("1772600767980", "1772600768000", "time=when"),
        ("0.98", "1.0", "time=when"),
        ("1", "2", "time=..."),  # it counts rows
        ("1.0", "0.98", "time=..."),
    ],
)
def test_times_are_known_by_their_values_and_a_column_left_over_is_named(tmp_path, first, second, key):
    (tmp_path / "log.csv").write_text(f"up_m,when,Roll(deg),heave_rate\n0.1,{first},1.0,0\n0.1,{second},1.1,0\n")
    with pytest.raises(ValueError) as caught:
        read_log(tmp_path / "log.csv")
    left = "up_m" if key == "time=when" else "up_m, when"
    assert f"--columns '{key},roll=Roll(deg)'`, with" in str(caught.value)
    assert f"if down is positive, and {left} as one of surge, sway, heave, pitch, yaw (" in str(caught.value)

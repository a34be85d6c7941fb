"""`ocean-sim platform`: motion platform commands from a motion log, with metrics, pictures and live replay."""

from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, cast

import numpy as np
import typer

from ocean_sim.files.atomic_file import atomic_write
from ocean_sim.files.input_file import Unreadable
from ocean_sim.files.yaml_file import Location, Node, merge_nodes, node_of, read_mapping
from ocean_sim.observers.platform_log import heading
from ocean_sim.observers.shared.csv_rows import CsvFile
from ocean_sim.parts import library, named
from ocean_sim.platform import LEG_NUMBERS, LIMIT_TEXTS, PLATFORM_COLUMNS, Commands, Cue, WashoutConfig
from ocean_sim.platform.hexapod import Config, HexapodPlatform
from ocean_sim.platform.shared import datagrams, motion_log
from ocean_sim.platform.shared import packets as wire
from ocean_sim.platform.shared.metrics import Metric, possible_shares, ride_metrics
from ocean_sim.platform.shared.motion_log import COLUMN_KEYS, FRAME_AXES, MotionLog
from ocean_sim.platform.shared.own_log import read_own_log
from ocean_sim.reading.translation import checked, choice_sentence
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared import platform_pictures as pictures

RIDE_FILES = ("best.csv", "best.png", "film.gif", "legs.csv")  # that not every ride has: those of one before go
MANY_LIMITED = 5.0  # [%] of the rows, above which smaller scales or a longer ramp are advised
START_RAMPS = 4.0  # [ramps] after which a ride is no longer at its start
FELT_COLUMNS = ("force_x", "force_y", "force_z", "rate_x", "rate_y", "rate_z")


def platform(
    log: Path = typer.Argument(help="A motion log, or a run folder that has one."),
    geometry: str = typer.Option("hexapod_a", help="A name in configs/geometry/, or a file."),
    washout: str = typer.Option("ship", help="A name in configs/washout/, or a file."),
    ramp: float | None = typer.Option(
        None, min=0.0, help="Time [s] from neutral into the motion, 3 by default; a stream goes back as slowly."
    ),
    sets: list[str] | None = typer.Option(
        None, "--set", help="key=value over platform, washout and geometry: washout.tilt_rate_deg=2."
    ),
    columns: str | None = typer.Option(
        None, help="Your names of a log's columns, as time=t,heave=z,roll=phi; rates and forces may be missing."
    ),
    units: str = typer.Option("rad", help="rad or deg: of the angles and rates of a log read by --columns."),
    axes: str = typer.Option("ship", help="ship, ned or flu: the axes of a log read by --columns."),
    frame: str | None = typer.Option(
        None, help="ship, ned or flu: the axes written; the motion log is written in them, too."
    ),
    stream: str | None = typer.Option(None, help="Replay in real time to an address such as udp://127.0.0.1:5005."),
    packets: str = typer.Option("ocean_sim", help="ocean_sim, openmotionsim, floats or text."),
    key: Path | None = typer.Option(None, help="A file whose content signs every packet of ocean_sim."),
    best: bool = typer.Option(
        False, "--best", help="Also the best ride that the legs can give, knowing all of it beforehand."
    ),
    film: bool = typer.Option(False, "--film", help="Also film.gif: the 10 s in which the hexapod moves most."),
    out: Path = typer.Option(Path("runs/platform"), help="Where platform.csv, metrics.csv and the pictures go."),
) -> None:
    """Turn a motion log into commands of a motion platform; all is computed before anything is written."""
    with console.claim(out, "platform.csv", ".platform-*"):
        choices = {"frame": (frame or "flu", FRAME_AXES), "axes": (axes, FRAME_AXES), "units": (units, ("rad", "deg"))}
        for what, (name, known) in (choices | {"packets": (packets, wire.FORMAT_NAMES)}).items():
            if name not in known:
                raise console.Refused(f"--{what}: there is no {name!r}{choice_sentence(name, known)[0]}")
        laid = [*(sets or []), *([] if ramp is None else [f"ramp={ramp!r}"])]
        config = platform_config(geometry, washout, laid)
        sender = open_sender(stream, packets, key) if stream is not None else None
        ride, said = read_motion_log(log, frame, parse_columns(columns), units == "deg", axes)
        machine = config.build(ride.every)
        asked = cast(WashoutConfig, config.washout)
        ahead = round((asked.look_ahead or 0.0) / ride.every)
        if asked.look_ahead is not None:
            console.say("planning the ride; this takes about as long as the ride")
        parts = [machine.follow(rows, later) for rows, later in ride.ride.chunks(ahead)]
        cue = Cue(*map(np.concatenate, zip(*(part.cue for part in parts))))
        done = Commands._make([*map(np.concatenate, list(zip(*parts))[:-1]), cue])
        found = ride_metrics(ride.ride, done, machine.hexapod, ride.every)
        if best:
            console.say("finding the best ride; this takes half as long as the ride")
        possible = machine.best(done) if best else None
        if possible is not None:
            found += possible_shares(done, possible, ride.every)
        files = write_commands(out, ride, done, possible, found, config, machine, frame, film)
        seconds = float(done.time[-1] - done.time[0])
        warnings = list(config.cut_short(seconds))
        starting = START_RAMPS * config.ramp  # [s]
        begins, rest = np.split(done.limited, [round(starting / ride.every)])
        if asked.look_ahead is None and len(rest) > len(begins) > 0:
            gentle = config.model_copy(update={"ramp": starting}).build(ride.every)
            gently = gentle.follow(ride.ride.rows(0, len(begins))).limited
            hard, later, left = (100.0 * float((rows > 0).mean()) for rows in (begins, rest, gently))
            if hard - left > max(later, MANY_LIMITED):
                many = f"{hard:.3g} % of rows in the first {starting:g} s are limited, {later:.3g} % of the others"
                warnings.append(f"{many}: --ramp {starting:g} begins gently and limits {left:.3g} % of the first")
        force, turns = (" ".join(map("{:g}".format, scale)) for scale in (asked.force_scale, asked.rotation_scale))
        console.say(f"{geometry}, washout {washout}: asks for {force} of acceleration x y z, {turns} of roll pitch yaw")
        for each in said:
            console.say(f"{log}: {each}")
        if asked.look_ahead is None:
            console.say(f"{log}: from neutral into its motion over {config.ramp:g} s, wherever the log begins")
        print_report(done, found, files)
        for sentence in warnings:
            console.say(f"warning: {sentence}")
        jitter = latency = None
        if sender is not None:
            console.say(f"streaming {seconds:.0f} s to {':'.join(map(str, sender.address[:2]))}")
            jitter, latency = stream_ride(sender, done, machine, frame or "flu"), sender.latency()
            files += write_leg_reports(out, sender)
        answer: dict[str, Any] = {"log": log, "rows": len(done.time), "every_s": ride.every, "files": files}
        answer["metrics"] = [metric._asdict() for metric in found]
        answer |= {"warnings": warnings, "derived": said, "stream": jitter and jitter._asdict()}
        answer["latency"] = latency and latency._asdict()
        console.answer(answer)
        if sender is not None:
            for told in filter(None, (jitter, latency, sender.stop_report())):
                console.say(f"{stream}: {told}")


def platform_config(geometry: str, washout: str, sets: Sequence[str] = ()) -> Config:
    """Config of a platform by geometry and washout (name or file), `sets` (`key=value`); raises SceneError, Refused."""
    nodes = {"geometry": platform_choice("geometry", geometry), "washout": platform_choice("washout", washout)}
    whole = node_of(nodes, Location("--geometry, --washout"))
    for key, value in console.set_values([*sets]).items():
        for part in reversed(key.split(".")):
            value = node_of({part: value}, value.location)
        whole = merge_nodes(whole, value)
    return checked(Config, whole)


def platform_choice(what: str, name: str) -> Node:
    """Keys in the file configs/WHAT/NAME.yaml, or in a user's YAML file `name`; raises SceneError or Refused."""
    if name in named(what):
        return read_mapping(library("configs") / what / f"{name}.yaml")
    if Path(name).suffix in (".yaml", ".yml"):
        return read_mapping(Path(name))
    raise console.Refused(f"--{what}: there is no {what} {name!r}{choice_sentence(name, named(what))[0]}")


def open_sender(stream: str, packets: str, key: Path | None) -> datagrams.Sender:
    """Sender of packets in the format `packets` to the address `stream`, signed by the file `key`; raises Refused."""
    try:
        secret = b"" if key is None else datagrams.read_key(str(key))
        return datagrams.Sender(stream, packets, secret)
    except Unreadable as error:
        raise console.Refused(f"--key {error}") from None
    except ValueError as error:
        raise console.Refused(f"--stream: {error}") from None
    except OSError as error:
        raise console.Refused(f"--stream: {stream}: {error.strerror}") from None


def parse_columns(text: str | None) -> dict[str, str] | None:
    """Column names of a log by this program's keys, from a text `time=t,heave=z` of --columns; raises Refused."""
    if text is None:
        return None
    pairs = [word.partition("=")[::2] for word in text.split(",")]
    for key, own in pairs:
        if key.strip() not in COLUMN_KEYS or not own.strip():
            ends = choice_sentence(key.strip(), COLUMN_KEYS)[0] if own.strip() else ""
            raise console.Refused(f"--columns: {key}={own} is not like heave=NAME, roll=NAME{ends}")
    return {key.strip(): own.strip() for key, own in pairs}


def read_motion_log(
    log: Path, frame: str | None, columns: dict[str, str] | None = None, degrees: bool = False, axes: str = "ship"
) -> tuple[MotionLog, list[str]]:
    """Motion log from a CSV file or run folder, and sentences on columns that were derived. `frame`: axes to which it
    must be convertible. `columns` (by COLUMN_KEYS), `degrees`, `axes`: for a log of other software. Raises Refused."""
    path = log / "motion.csv" if log.is_dir() else log
    if log.is_dir() and (log / "manifest.json").is_file() and not any(log.glob("motion*.csv")):
        raise console.Refused(f"{log}: this run has no motion log: its scene has no ship, or motion: null")
    several = sorted(found.name for found in log.glob("motion_*.csv")) if log.is_dir() and not path.exists() else []
    if several:
        raise console.Refused(f"{log} holds the logs of several ships; name one of {', '.join(several)}")
    ride, said = (motion_log.read_log(path), []) if columns is None else read_own_log(path, columns, degrees, axes)
    if frame is not None:
        motion_log.check_convertible(ride)
    return ride, said


def write_commands(
    out: Path,
    log: MotionLog,
    done: Commands,
    best: Commands | None,
    found: list[Metric],
    config: Config,
    machine: HexapodPlatform,
    frame: str | None,
    film: bool,
) -> list[Path]:
    """Write commands `done`, those of the `best` motion within the limits, if planned, metrics `found` and pictures;
    return their paths. Files are moved into the folder `out` only when all are complete. `frame`: axes of the rows
    (None: FLU; else the `log` is written along them, too); `machine`: the platform; `film`: True to draw one."""
    with TemporaryDirectory(prefix=".platform-", dir=out) as draft:
        folder = Path(draft)
        kept = {key: text for key, text in log.table.head.items() if key in ("start", "seed")}
        axes = frame or "flu"
        for name, ride in (("platform", done), ("best", best)):
            if ride is not None:
                force, rate = ride.felt_force @ FRAME_AXES[axes].T, ride.felt_rate @ FRAME_AXES[axes].T
                turned = ride._replace(pose=wire.turn_to_frame(ride.pose, axes), felt_force=force, felt_rate=rate)
                head = heading(log.every, axes) | kept
                commands_table(folder / f"{name}.csv", head, PLATFORM_COLUMNS, turned.rows())
        commands_table(folder / "metrics.csv", {}, Metric._fields, found)
        if frame is not None:
            changed = log.table.head | {"frame": frame, "axes": motion_log.AXES_IN_WORDS[frame]}
            converted = motion_log.convert_rows(log, frame)
            commands_table(folder / f"motion_{frame}.csv", changed, log.table.names, converted)
        console.draw_if_able(pictures.draw_pictures, folder, done, best, config, machine, film)
        for name in RIDE_FILES:
            (out / name).unlink(missing_ok=True)
        return [path.replace(out / path.name) for path in sorted(folder.iterdir())]


def write_leg_reports(out: Path, sender: datagrams.Sender) -> list[Path]:
    """Write leg lengths that the platform reported, if any, to legs.csv in folder `out`; its path in a list, or []."""
    if not sender.readings:
        return []
    begin = sender.sent[0]
    head = {"time": "since the first packet went out", "leg": "lengths that the platform reports"}
    names = ("time_s", "seq", *(f"leg{k}_actual_m" for k in LEG_NUMBERS), "stopped")
    rows = [[came - begin, found.seq, *found.legs, int(found.stopped)] for came, found in sender.readings]
    commands_table(out / "legs.csv", head, names, rows)
    return [out / "legs.csv"]


def commands_table(path: Path, head: dict[str, Any], columns: Sequence[str], rows: Any) -> None:
    """Write rows under the names `columns` as a CSV file like a run's, atomically; `head`: comment lines, by name."""
    with atomic_write(path) as draft, closing(CsvFile(draft, head, columns)) as csv:
        for row in rows:
            csv.row(row)


def stream_ride(sender: datagrams.Sender, done: Commands, machine: HexapodPlatform, frame: str) -> datagrams.Jitter:
    """Send the rows of `done`, with poses along the axes of `frame`, at their times, then, even after Ctrl-C, a return
    to neutral; returns timing jitter."""
    try:
        for packet in wire.row_packets(done, frame):
            sender.send(packet)
    finally:
        last = max(0, len(sender.sent) - 1)
        past = done.pose[[max(0, last - 1), last]]
        back = machine.return_home(past, float(done.time[last]), int(done.seq[last]))
        for packet in wire.row_packets(back, frame):
            sender.send(packet)
        sender.close()
    return sender.jitter()


def print_report(done: Commands, found: list[Metric], files: list[Path]) -> None:
    value = {metric.quantity: metric.value for metric in found}
    kinds = ("scaled_rms", "felt_rms", "error_rms", "correlation", "delay", "false_cue")
    numbers = [[value[f"{name}_{kind}"] for kind in kinds] for name in FELT_COLUMNS]
    rows = [[name, *("-" if np.isnan(n) else f"{n:.4g}" for n in row)] for name, row in zip(FELT_COLUMNS, numbers)]
    title = "specific force [m/s2], rates [rad/s] (x forward, y to port, z up): scaled, and felt (late by < 0: early)"
    console.table(title, ["", "scaled rms", "felt rms", "error rms", "correlation", "late by [s]", "false cue"], rows)
    sick = (value["motion_sickness_dose_ship"], value["motion_sickness_dose_platform"])
    limited, stroke = 100.0 * value["share_limited"], 100.0 * value["stroke_used"]
    console.say(f"\n{len(done.time)} rows, {limited:.3g} % of them limited; {stroke:.3g} % of the stroke used")
    for bit, why in LIMIT_TEXTS.items():
        if len(held := done.time[done.limited & bit > 0]):
            console.say(f"  {len(held)} rows between {held[0]:.2f} and {held[-1]:.2f} s: {why}")
    if limited > MANY_LIMITED:
        console.say("  --set 'washout.force_scale=[0.3, 0.3, 0.2]', say, or rotation_scale asks less of the legs")
    if "share_of_possible_all" in value:
        share, error, least = (value[k] for k in ("share_of_possible_all", "sensed_error", "sensed_error_best"))
        opening = f"people sense an error of {error:.3g} of what they notice,"
        middle = f"and of {least:.3g} on the best ride of these legs (best.csv, best.png):"
        console.say(f"{opening} {middle} the washout reaches {100.0 * share:.3g} % of the possible")
    console.say(f"motion sickness dose {sick[0]:.3g} m/s1.5 on the ship, {sick[1]:.3g} on the platform (ISO 2631-1)")
    console.say(f"{files[0].parent}: {', '.join(path.name for path in files)}")

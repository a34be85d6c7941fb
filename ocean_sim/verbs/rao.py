"""`ocean-sim rao`: response amplitude operators of a ship, from one run in an irregular or a regular sea."""

from pathlib import Path
from typing import Any

import numpy as np
import typer

from ocean_sim.files import csv_file, run_files
from ocean_sim.files.atomic_file import new_figure, save_figure
from ocean_sim.observers.motion import log_name
from ocean_sim.platform.shared import motion_log
from ocean_sim.reading.scene import SceneConfig, load, scene_path
from ocean_sim.result import simulate, wave_field
from ocean_sim.ship.body.floating import FloatingConfig
from ocean_sim.ship.naval import response
from ocean_sim.ship.naval.response import MOTION_NAMES, TRUSTED_COHERENCE, Response
from ocean_sim.verbs.render import warn_unless_ended
from ocean_sim.verbs.resume import manifest_of, scene_of
from ocean_sim.verbs.run import run_folder
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.options import Profile, Sets
from ocean_sim.verbs.shared.progress import Progress
from ocean_sim.waves import Components

WITHOUT_PICTURES = ("frames=null", "render=null", "report=null")  # settings of a run for responses
MAX_ROWS = 16  # of the table on the console
MAX_SWING = 5.0  # [deg] of her heading, or of the directions of waves: beyond it a response is not that of one course
RESPONSE_UNITS = dict(zip(MOTION_NAMES, 3 * ["m_per_m"] + 3 * ["rad_per_rad"]))
CLOSED_FORM_MOTIONS = ("heave", "pitch")
RAO_COLUMNS = (
    *("omega_rad_s", "period_s", "wave_density_m2_s"),
    *(f"{name}_{what}" for name in MOTION_NAMES for what in (RESPONSE_UNITS[name], "phase_deg", "coherence")),
    *(f"{name}_closed_form_{RESPONSE_UNITS[name]}" for name in CLOSED_FORM_MOTIONS),
)


def rao(
    target: str = typer.Argument(metavar="SCENE|RUN", help="A scene, which is run first, or the folder of a run."),
    profile: Profile = None,
    sets: Sets = None,
    ship: str | None = typer.Option(None, help="Which ship, where a scene has several."),
    begin: float = typer.Option(0.0, min=0.0, help="Ignore what is before this time [s], and before the waves' ramp."),
    out: Path | None = typer.Option(None, help="Where rao.csv and rao.png go; by default the folder of the run."),
) -> None:
    """Write the response of six motions per wave amplitude and slope over the frequency, with phase and coherence."""
    run = Path(target)
    if not run.is_dir():
        asked = load(target, console.set_values([*WITHOUT_PICTURES, *(sets or [])]), profile)
        console.must_compute_with(asked.runtime.library)
        refuse_short(wave_field(asked).sea, asked.duration, begin, None)
        with run_folder(f"{scene_path(target).stem}-rao", None, False, asked.files()) as folder:
            run = simulate(asked, folder, (Progress(asked.duration, False),)).folder
    warn_unless_ended(run)
    config = scene_of(run, manifest_of(run), None)
    name = ship or next(iter(config.ships), "")
    if name not in config.ships or (ship is None and len(config.ships) > 1):
        raise console.Refused(f"{run}: name a ship by --ship; there are {', '.join(config.ships) or 'none'}")
    found, closed, facts = measured_response(run, config, name, begin)
    folder = out or run
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / "rao.csv", folder / "rao.png"]
    triples = np.stack([np.abs(found.ratio), np.degrees(np.angle(found.ratio)), found.coherence], axis=2)
    parts = [found.omega, 2.0 * np.pi / found.omega, found.wave_density, triples.reshape(len(found.omega), -1), closed]
    rows = [[float(f"{value:.6g}") for value in row] for row in np.column_stack(parts)]
    notes = {
        "axes": motion_log.AXES_IN_WORDS["flu"] + ", about the centre of mass, along her mean heading",
        "responses": "translations over wave amplitude, rotations over wave slope (wavenumber times amplitude)",
        "phase": "by which a motion leads the crest where the ship is",
        "frequency": f"of encounter, at {round(facts['speed_m_s'], 3) + 0.0:.4g} m/s "
        f"in waves {facts['wave_direction_deg']:.4g} deg "
        "from her bow, to port (180: a head sea)",
        "closed form": "of a box of her length, waterplane and displacement (Jensen, Mansour & Olsen 2004)",
    }
    csv_file.write_table(files[0], RAO_COLUMNS, rows, **notes)
    if not console.draw_if_able(draw_response, files[1], found, closed):
        files.pop()
    run_files.add_to_manifest(run, files)
    facts |= {"files": files, "rows": [dict(zip(RAO_COLUMNS, row)) for row in rows]}
    console.answer({"run": run, "ship": name} | facts)
    console.say(f"{run}, {name}: {notes['frequency']}; {notes['responses']}, with phases [deg]")
    console.table("", ["omega [rad/s]", "T [s]", *MOTION_NAMES], response_lines(found))
    told = [f"in brackets: coherence below {TRUSTED_COHERENCE:g}", *(f"warning: {each}" for each in facts["warnings"])]
    console.say("\n".join([*told, *map(str, files)]))


def refuse_short(sea: Components, duration: float, begin: float, period: float | None) -> None:
    """Raise Refused if a run of this duration [s] is too short for a random sea, whose highest waves the ship meets
    every `period` [s], by default that of the sea. Time before `begin` [s] and the ramp of the waves does not count."""
    met, settled = period or sea.period, max(begin, sea.ramp)
    if sea.random and duration < (least := settled + response.least_record(met)):
        longer = 50.0 * np.ceil(0.02 * max(least, settled + 4.0 * response.least_record(met)))
        opening = f"cross spectra of waves met every {met:.3g} s need {least:.0f} s or more, after {settled:.3g} s in"
        raise console.Refused(f"{opening} which they grow; four times that is better: --set duration={longer:g}")


def measured_response(
    run: Path, config: SceneConfig, ship: str, begin: float
) -> tuple[Response, np.ndarray, dict[str, Any]]:
    """Response of a ship in a run from `begin` [s] on; response by closed form (m, 2), or NaN; and, by name, direction
    of the waves from her bow [deg], her speed [m/s], warnings. Raises Refused if waves are absent or too few."""
    log = motion_log.read_log(run / log_name(ship))
    sea, time, warnings = wave_field(config).sea, log.ride.time, []
    if not sea.amplitude.any():
        raise console.Refused(f"{run}: no response, as its water is still")
    settled = max(begin, sea.ramp, 0.0 if sea.random else 0.5 * time[-1])  # a regular wave needs but a few periods
    step = max(1, int(sea.period / response.ROWS_PER_PERIOD / log.every))
    rows = slice(int(np.searchsorted(time, settled)), None, step)
    time, position, angles = time[rows], motion_log.log_positions(log)[rows], log.ride.attitude[rows]
    if len(time) < response.ROWS_PER_PERIOD:
        raise console.Refused(f"{run}: {len(time)} rows after {settled:.3g} s, when the waves have grown, are too few")
    motions = response.ship_motions(position, angles)
    place, velocity = response.mean_path(time, position[:, [1, 0]], sea.period)
    waves, heading = response.waves_at(sea, time, place), motions[:, 5].mean()
    way, speed = (sea.heading_deg - np.degrees(heading)) % 360.0, velocity @ [np.sin(heading), np.cos(heading)]
    if (swing := np.degrees(motions[:, 5].std())) > MAX_SWING:
        warnings.append(f"her heading swings by {swing:.2g} deg: hold it by ship.helm or ship.free")
    apart = np.abs((np.degrees(np.arctan2(*sea.wavevector.T)) - sea.heading_deg + 180.0) % 360.0 - 180.0)
    if (spread := np.average(apart, weights=sea.amplitude**2)) > MAX_SWING:
        warnings.append(f"the waves come from directions {spread:.2g} deg apart: a response is their mean")
    met = np.abs(sea.omega - sea.wavevector @ velocity)
    if sea.random:
        period = 2.0 * np.pi / float(met[sea.highest])
        refuse_short(sea, float(log.ride.time[-1]), begin, period)
        found = response.irregular_response(waves, motions, time[1] - time[0], period)
    else:
        found = response.regular_response(waves, motions, time, float(met[0]))
    part, closed = config.ships[ship], np.full((len(found.omega), 2), np.nan)
    if isinstance(part, FloatingConfig):
        hull = part.hydrostatics_of(config.preflight)
        closed = response.box_response(hull, found.omega, float(speed), float(np.cos(np.radians(way))))
    return found, closed, {"wave_direction_deg": float(way), "speed_m_s": float(speed), "warnings": warnings}


def response_lines(found: Response) -> list[list[str]]:
    """Table rows of amplitude ratio and phase over frequency; in brackets if coherence is low, - if nothing moves."""
    lines = []
    for k in range(0, len(found.omega), -(-len(found.omega) // MAX_ROWS)):
        cells = [f"{abs(ratio):.3f} {np.degrees(np.angle(ratio)):+.0f}" for ratio in found.ratio[k]]
        alike = found.coherence[k]
        cells = [text if c >= TRUSTED_COHERENCE else f"({text})" if c else "-" for text, c in zip(cells, alike)]
        lines.append([f"{found.omega[k]:.3f}", f"{2.0 * np.pi / found.omega[k]:.3g}", *cells])
    return lines


def draw_response(path: Path, found: Response, closed: np.ndarray) -> None:
    """Draw the six responses and the coherence over frequency (n,); grey where coherence is below TRUSTED_COHERENCE.
    `closed` (n, 2): heave [m/m] and pitch [rad/rad] in closed form, NaN if unknown."""
    figure = new_figure(11.0, 6.5)
    for k, (name, axes) in enumerate(zip(MOTION_NAMES, figure.subplots(2, 3, sharex=True).flat)):
        size, sure = np.abs(found.ratio[:, k]), found.coherence[:, k] >= TRUSTED_COHERENCE
        axes.plot(found.omega, size, ".-", color="0.75", linewidth=0.8)
        axes.plot(found.omega, np.where(sure, size, np.nan), ".-", label="this ship")
        axes.plot(found.omega, found.coherence[:, k], ":", color="0.5", linewidth=0.9, label="coherence")
        if name in CLOSED_FORM_MOTIONS:
            theory = closed[:, CLOSED_FORM_MOTIONS.index(name)]
            axes.plot(found.omega, theory, "--", linewidth=1.0, label="box, closed form")
        axes.set(title=f"{name} [{'m/m' if k < 3 else 'rad per wave slope'}]", ylim=(0.0, None))
        axes.set_xlabel("frequency of encounter [rad/s]" if k > 2 else "")
        axes.grid(alpha=0.3)
    figure.axes[2].legend(fontsize="small")
    save_figure(figure, path)

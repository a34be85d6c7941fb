"""`ocean-sim render` and `export`: pictures and files made from a finished run."""

from pathlib import Path
from typing import Any

import typer

from ocean_sim.files import run_files
from ocean_sim.files.run_files import MANIFEST_FILE
from ocean_sim.files.yaml_file import Location, Node, node_of
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.bar import Drawing
from ocean_sim.verbs.shared.options import number_list

MAX_FILE_LINES = 8  # that name written files
EXPORT_KINDS = {"particles": ("vtkhdf", "ply"), "surface": ("ply", "vtp", "vtkhdf"), "scene": ("usd", "glb")}


def render(
    run: Path = typer.Argument(help="A run folder."),
    camera: str = typer.Option("third_person", help="third_person, follow, orbit, fixed, first_person, top or side."),
    quality: str = typer.Option("final", help="draft or final."),
    size: str | None = typer.Option(None, help="Width and height in pixels, both even, as 1280x720."),
    stills: str | None = typer.Option(None, help="Times [s] of further pictures: 2,4.5,6."),
    strip: int = typer.Option(0, help="Number of pictures side by side in strip.png."),
    film: bool = typer.Option(True, "--film/--no-film", help="Make film.mp4."),
    fps: float | None = typer.Option(None, help="Pictures a second of the film, which runs in real time."),
    particles: bool = typer.Option(False, "--particles", help="Draw particles instead of the surface."),
    eye: str | None = typer.Option(None, help="X,Y,Z [m] of the fixed camera."),
    target: str | None = typer.Option(None, help="X,Y,Z [m] at which the fixed camera looks."),
    ship: str | None = typer.Option(None, help="The ship that a camera follows, where there are several."),
    caption: bool = typer.Option(True, "--caption/--no-caption", help="Write the time into the pictures."),
    outline: bool = typer.Option(False, "--outline", help="Draw where the basin ends."),
    scale_bar: bool = typer.Option(
        False, "--scale-bar", help="Draw a scale bar; on maps the colours of heights, with --wind an arrow's."
    ),
    wind: bool = typer.Option(False, "--wind", help="Draw where the wind blows, and in which direction."),
    out: Path | None = typer.Option(None, help="Where to write; by default the run folder."),
) -> None:
    """Draw pictures and a film from the frames of a run."""
    from ocean_sim.observers import render as drawing
    from ocean_sim.reading.translation import checked

    lists = {key: number_list(f"--{key}", text) for key, text in (("stills", stills), ("eye", eye), ("target", target))}
    drawn = {"particles": particles, "caption": caption, "outline": outline, "scale_bar": scale_bar, "wind": wind}
    kept = {"quality": quality, "size": picture_size(size), "strip": strip, "film": film}
    asked = {"camera": camera, "ship": ship} | lists | drawn | kept
    if fps is not None and not 0.1 <= fps <= 240.0:
        raise console.Refused(f"--fps {fps:g}: choose 0.1 to 240 pictures a second")
    given = {key: value for key, value in asked.items() if value is not None}
    text = lambda value: ",".join(f"{item:g}" for item in value) if isinstance(value, list) else str(value)
    nodes = {key: node_of(value, Location(f"--{key} {text(value)}")) for key, value in given.items()}
    config = checked(drawing.Config, Node(nodes, Location("--camera"), Location("--camera")))
    require_frames(run)
    sentence = drawing.obstacle_to_pictures(run, config.camera, config.stills, config.ship)
    if sentence is not None:
        raise console.Refused(sentence)
    options = drawing.config_options(config, run) | ({} if fps is None else {"every": 1.0 / fps})
    progress = Drawing()
    before = {*(out or run).glob("*")}
    with console.claim(out or run):
        try:
            files = drawing.render_run(run, **options, out=out, progress=progress)
        finally:
            progress.close()
        if out is None and (run / "report.html").exists():
            from ocean_sim.observers.shared import run_report

            files = [*files, run_report.write_report(run)]  # with the new pictures
        run_files.add_to_manifest(run, files)
    list_files(files)
    replaced = [file.name for file in files if file in before]
    if replaced:
        console.complain(f"replaced in {out or run}: {', '.join(replaced)}")


def picture_size(text: str | None) -> list[int] | None:
    """Width and height [pixels] from a text such as `1280x720`; None if there is no text; raises Refused."""
    if text is None:
        return None
    words = text.lower().split("x")
    if len(words) != 2 or not all(word.isdigit() for word in words):
        raise console.Refused(f"--size {text}: a size is width x height in pixels, as 1280x720")
    return [int(word) for word in words]


def export(
    run: Path = typer.Argument(help="A run folder."),
    particles: str | None = typer.Option(None, help="vtkhdf: all in one file; ply: points, one file a frame."),
    surface: str | None = typer.Option(None, help="ply or vtp: one mesh a frame; vtkhdf: all in one file."),
    scene: str | None = typer.Option(
        None, help="usd: water, ships, obstacles and particles in one file; glb: all but particles. No file has walls."
    ),
    z_up: bool = typer.Option(False, "--z-up", help="Write files in which z, not y, points up."),
    every: int = typer.Option(1, min=1, help="Export every Nth frame."),
    out: Path | None = typer.Option(None, help="Where to write; by default the folder export/ of the run."),
) -> None:
    """Write files for ParaView, Blender and others from the frames of a run."""
    if particles is None and surface is None and scene is None:
        raise console.Refused("name what to export: --particles vtkhdf, --surface vtp, --scene usd, ...")
    asked: dict[str, Any] = {"particles": particles, "surface": surface, "scene": scene, "z_up": z_up, "every": every}
    for option, kinds in EXPORT_KINDS.items():
        if asked[option] not in (None, *kinds):
            raise console.Refused(f"--{option} {asked[option]}: choose {', '.join(kinds[:-1])} or {kinds[-1]}")
    if scene == "glb" and z_up:
        raise console.Refused("--z-up: in glTF y is up; readers turn it")
    require_frames(run)
    from ocean_sim.pictures.export.paraview import export_run

    with console.claim(out or run / "export") as written:
        files = export_run(run, out=written, **asked)
        run_files.add_to_manifest(run, files)
    list_files(files)


def require_frames(folder: Path) -> None:
    """Raise Refused if a folder is no run folder, or its run has no frame files."""
    if not (folder / MANIFEST_FILE).is_file():
        raise console.Refused(f"{folder}: this is not a run folder (there is no {MANIFEST_FILE})")
    if not any((folder / "frames").glob("*")):
        raise console.Refused(f"{folder}: this run kept no frames, so there is nothing to show (frames: null)")
    warn_unless_ended(folder)


def warn_unless_ended(folder: Path) -> None:
    """Print a warning if, by its manifest, a run is still running or was killed."""
    if run_files.read_manifest(folder).get("outcome") == "running":
        console.complain(f"{folder}: this run is still running, or was killed: what it has written so far is used")


def list_files(files: list[Path]) -> None:
    """Print file names, at most MAX_FILE_LINES of them; as JSON, print all."""
    console.answer({"files": files})
    shown = [str(file) for file in files]
    if len(shown) > MAX_FILE_LINES:
        shown = [*shown[: MAX_FILE_LINES - 2], f"... {len(shown) - MAX_FILE_LINES + 1} more ...", shown[-1]]
    for line in shown:
        console.say(line)

"""`ocean-sim render` and `export`: pictures and files made from a finished run."""

from pathlib import Path
from typing import Any

from ocean_sim.files import run_files
from ocean_sim.files.run_files import MANIFEST
from ocean_sim.files.yaml_file import Location, Node, Problem, SceneError, node_of
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.bar import Drawing

SHOWN = 8  # lines, at most, that name what was written
KINDS = {"particles": ("vtkhdf", "ply"), "surface": ("ply", "vtp", "vtkhdf"), "scene": ("usd", "glb")}


def render(folder: Path, asked: dict[str, Any], fps: float | None, out: Path | None, as_json: bool) -> None:
    """Pictures and a film from the frames of a run; `asked` by key of `render:`."""
    from ocean_sim.observers import render
    from ocean_sim.reading.translation import validated

    if fps is not None and not 0.1 <= fps <= 240.0:
        raise console.Refused(f"--fps {fps:g}: choose 0.1 to 240 pictures a second")
    given = {key: value for key, value in asked.items() if value is not None}
    nodes = {key: node_of(value, Location(f"--{key} {shown(value)}")) for key, value in given.items()}
    problems: list[Problem] = []
    config = validated(render.Config, Node(nodes, Location("--camera"), Location("--camera")), (), problems)
    if config is None:
        raise SceneError(problems)
    finished(folder)
    sentence = render.impossible(folder, config.camera, config.stills, config.ship)
    if sentence is not None:
        raise console.Refused(sentence)
    options = render.asked(config, folder) | ({} if fps is None else {"every": 1.0 / fps})
    drawing = Drawing(quiet=as_json)
    before = {*(out or folder).glob("*")}
    with console.claim(out or folder):
        try:
            files = render.render_run(folder, **options, out=out, progress=drawing)
        finally:
            drawing.close()
        if out is None and (folder / "report.html").exists():
            from ocean_sim.observers.shared import run_report

            files = [*files, run_report.write(folder)]  # with the new pictures
        run_files.add(folder, files)
    made(files, as_json)
    replaced = [file.name for file in files if file in before]
    if replaced:
        console.complain(f"replaced in {out or folder}: {', '.join(replaced)}")


def numbers(option: str, text: str | None, apart: str = ",") -> list[float] | None:
    """The numbers of an option such as `1,2.5`; raises Refused."""
    if text is None:
        return None
    try:
        return [float(word) for word in text.split(apart)]
    except ValueError:
        raise console.Refused(f"{option} {text}: these are not numbers with '{apart}' between them") from None


def pixels(text: str | None) -> list[int] | None:
    """A size as `1280x720`; raises Refused."""
    if text is None:
        return None
    words = text.lower().split("x")
    if len(words) != 2 or not all(word.isdigit() for word in words):
        raise console.Refused(f"--size {text}: a size is width x height in pixels, as 1280x720")
    return [int(word) for word in words]


def shown(value: Any) -> str:
    """A value as it was given on the command line."""
    return ",".join(f"{item:g}" for item in value) if isinstance(value, list) else str(value)


def export(
    folder: Path,
    particles: str | None,
    surface: str | None,
    scene: str | None,
    z_up: bool,
    every: int,
    out: Path | None,
    as_json: bool,
) -> None:
    """Files for ParaView, Blender and others from the frames of a run."""
    if particles is None and surface is None and scene is None:
        raise console.Refused("name what to export: --particles vtkhdf, --surface vtp, --scene usd, ...")
    asked: dict[str, Any] = {"particles": particles, "surface": surface, "scene": scene, "z_up": z_up, "every": every}
    for option, kinds in KINDS.items():
        if asked[option] not in (None, *kinds):
            raise console.Refused(f"--{option} {asked[option]}: choose {', '.join(kinds[:-1])} or {kinds[-1]}")
    if scene == "glb" and z_up:
        raise console.Refused("--z-up: in glTF y is up; readers turn it")
    finished(folder)
    from ocean_sim.pictures.export import export_run

    with console.claim(out or folder / "export") as written:
        files = export_run(folder, out=written, **asked)
        run_files.add(folder, files)
    made(files, as_json)


def finished(folder: Path) -> None:
    """Refuses what is not a run folder, or has kept no frames."""
    if not (folder / MANIFEST).is_file():
        raise console.Refused(f"{folder}: this is not a run folder (there is no {MANIFEST})")
    if not any((folder / "frames").glob("*")):
        raise console.Refused(f"{folder}: this run kept no frames, so there is nothing to show (frames: null)")
    say_whether_ended(folder)


def say_whether_ended(folder: Path) -> None:
    """A sentence about a run that is not over."""
    if run_files.read_manifest(folder).get("outcome") == "running":
        console.complain(f"{folder}: this run is still running, or was killed: what it has written so far is used")


def made(files: list[Path], as_json: bool) -> None:
    """Names what was written; of many files the first and the last."""
    if as_json:
        console.answer({"files": files})
        return
    shown = [str(file) for file in files]
    if len(shown) > SHOWN:
        shown = [*shown[: SHOWN - 2], f"... {len(shown) - SHOWN + 1} more ...", shown[-1]]
    for line in shown:
        console.say(line)

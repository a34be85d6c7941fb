"""`ocean-sim render` and `export`: what can still be made of a finished run."""

from pathlib import Path
from typing import Any

from ocean_sim.verbs import console
from ocean_sim.verbs.progress import Drawing
from ocean_sim.yaml_file import Node, Place, Problem, SceneError, node_of

PARTICLES, SURFACES = ("vtkhdf",), ("ply", "vtp", "vtkhdf")


def render(folder: Path, camera: str, quality: str, out: Path | None, as_json: bool) -> None:
    """Pictures and a film from the frames of a run."""
    from ocean_sim.observers.render import Config, render_run
    from ocean_sim.translation import validated

    asked = {
        key: node_of(value, Place(f"--{key} {value}")) for key, value in (("camera", camera), ("quality", quality))
    }
    problems: list[Problem] = []
    config = validated(Config, Node(asked, Place(""), Place("")), (), problems)
    if config is None:
        raise SceneError(problems)
    finished(folder)
    drawing = Drawing(quiet=as_json)
    try:
        files = render_run(folder, camera=config.camera, quality=config.quality, out=out, progress=drawing)
    finally:
        drawing.close()
    made(files, as_json)


def export(
    folder: Path, particles: str | None, surface: str | None, every: int, out: Path | None, as_json: bool
) -> None:
    """Files for ParaView and Blender from the frames of a run."""
    if particles is None and surface is None:
        raise console.Refused("say what to export: --particles vtkhdf, --surface ply or --surface vtp")
    if particles is not None and particles not in PARTICLES:
        raise console.Refused(f"--particles {particles}: choose vtkhdf")
    if surface is not None and surface not in SURFACES:
        raise console.Refused(f"--surface {surface}: choose ply, vtp or vtkhdf")
    finished(folder)
    from ocean_sim.observers._export import export_run

    asked: dict[str, Any] = {"particles": particles, "surface": surface, "every": every}
    made(export_run(folder, out=out or folder / "export", **asked), as_json)


def finished(folder: Path) -> None:
    """Refuses what is no run folder, or one that kept no frames."""
    if not (folder / "manifest.json").is_file():
        raise console.Refused(f"{folder}: this is not a run folder (there is no manifest.json)")
    if not any((folder / "frames").glob("*")):
        raise console.Refused(f"{folder}: this run kept no frames, so there is nothing to show (frames: null)")


def made(files: list[Path], as_json: bool) -> None:
    """Names what was written."""
    if as_json:
        console.answer({"files": files})
    else:
        for file in files:
            console.say(str(file))

"""Options and arguments that several verbs take, with their completion in a shell."""

from pathlib import Path
from typing import Annotated

import typer

from ocean_sim.conventions import Refused


def complete_scene(begun: str) -> list[str]:
    """Packaged scenes, scene files and folders that begin so."""
    from ocean_sim.reading.scene import packaged_scenes

    folder = Path(begun) if begun.endswith("/") else Path(begun).parent
    there = [path for path in folder.glob("*") if path.is_dir() or path.suffix in (".yaml", ".yml")]
    files = [f"{path}/" if path.is_dir() else str(path) for path in there]
    return [name for name in (*packaged_scenes(), *sorted(files)) if name.startswith(begun)]


def complete_profile(begun: str) -> list[str]:
    """Profiles that begin so."""
    from ocean_sim.parts import named

    return [name for name in named("run") if name.startswith(begun)]


Scene = Annotated[
    str,
    typer.Argument(
        help="A scene file, or the name of a packaged scene (ocean-sim list scenes).", autocompletion=complete_scene
    ),
]
Profile = Annotated[
    str | None,
    typer.Option(
        help="A profile, which says what the machine can afford: a name in configs/run/.",
        autocompletion=complete_profile,
    ),
]
Sets = Annotated[
    list[str] | None,
    typer.Option("--set", help="key=value, laid over the scene, as fluid.spacing=0.8; may be given several times."),
]
Out = Annotated[Path | None, typer.Option(help="The run folder; by default runs/<scene>.")]
Json = Annotated[bool, typer.Option("--json", help="Print the answer as JSON.")]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print only the run folder, and errors.")]


def number_list(option: str, text: str | None) -> list[float] | None:
    """The numbers of an option such as `1,2.5`; raises Refused."""
    if text is None:
        return None
    try:
        return [float(word) for word in text.split(",")]
    except ValueError:
        raise Refused(f"{option} {text}: these are not numbers with ',' between them") from None

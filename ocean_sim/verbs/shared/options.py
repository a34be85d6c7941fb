"""Options and arguments that several verbs take, with their completion in a shell."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Annotated

import typer

from ocean_sim.conventions import Refused
from ocean_sim.parts import named


def complete_scene(begun: str) -> list[str]:
    """Packaged scenes, scene files and folders whose names begin with `begun`, for completion in a shell."""
    from ocean_sim.reading.scene import packaged_scenes

    folder = Path(begun) if begun.endswith("/") else Path(begun).parent
    there = [path for path in folder.glob("*") if path.is_dir() or path.suffix in (".yaml", ".yml")]
    files = [f"{path}/" if path.is_dir() else str(path) for path in there]
    return [name for name in (*packaged_scenes(), *sorted(files)) if name.startswith(begun)]


def completion(names: Callable[[], Iterable[str]]) -> Callable[[str], list[str]]:
    """Completion function for a shell that lists the names which begin with a given text."""

    def complete(begun: str) -> list[str]:
        return [name for name in names() if name.startswith(begun)]

    return complete


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
        autocompletion=completion(lambda: named("run")),
    ),
]
Sets = Annotated[
    list[str] | None,
    typer.Option("--set", help="key=value, laid over the scene, as fluid.spacing=0.8; may be given several times."),
]
Out = Annotated[Path | None, typer.Option(help="The run folder; by default runs/<scene>.")]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print only the run folder, and errors.")]

MAX_NUMBER = 1e6  # in an option


def number_list(option: str, text: str | None, like: str = "") -> list[float] | None:
    """Numbers in the text of an option, as many as in the example `like`; None without a text; raises Refused."""
    try:
        found = None if text is None else [float(word) for word in text.split(",")]
    except ValueError:
        raise Refused(f"{option} {text}: these are not numbers with ',' between them") from None
    if not all(abs(value) <= MAX_NUMBER for value in found or ()):
        raise Refused(f"{option}: expected finite numbers of at most {MAX_NUMBER:g}, got {text}")
    if found is not None and like and len(found) != len(like.split(",")):
        raise Refused(f"{option}: {text!r} is not like {like}")
    return found

"""`ocean-sim sea`: the waves of a scene as files that other programs read."""

from pathlib import Path
from typing import Any

import numpy as np
import typer

from ocean_sim import wave_field
from ocean_sim.conventions import Refused
from ocean_sim.files.atomic_file import atomic_write
from ocean_sim.reading.scene import load
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.options import Json, Scene, Sets, number_list
from ocean_sim.waves import exchange


def sea(
    scene: Scene,
    sets: Sets = None,
    swd: Path | None = typer.Option(None, help="A spectral-wave-data file (.swd) to write."),
    openfast: Path | None = typer.Option(None, help="An elevation file of OpenFAST (.Elev, WaveMod 5) to write."),
    at: str = typer.Option("0,0", help="X,Z [m], the point of that elevation."),
    every: float = typer.Option(0.1, min=0.001, help="Time between its rows [s]."),
    until: float | None = typer.Option(None, min=0.001, help="Its end [s]; by default that of the scene."),
    as_json: Json = False,
) -> None:
    """Write the files that are asked for, and describe their content."""
    if swd is None and openfast is None:
        raise Refused("name a file to write: --swd FILE, --openfast FILE")
    point = number_list("--at", at)
    if point is None or len(point) != 2:
        raise Refused("--at is not like 0,0: x and z [m]")
    config = load(scene, console.set_values(sets))
    field = wave_field(config)
    waves, files = field.sea, []
    title = " ".join((config.title or scene).split())  # one line of a file
    if swd is not None:
        swd.parent.mkdir(parents=True, exist_ok=True)
        with atomic_write(swd) as draft:
            draft.write_bytes(exchange.to_swd(waves, title))
        files.append(swd)
    if openfast is not None:
        time = np.arange(0.0, (until or config.duration) + 0.5 * every, every)
        heights = np.concatenate([field.elevation(np.array([point]), t) for t in time.tolist()])
        openfast.parent.mkdir(parents=True, exist_ok=True)
        with atomic_write(openfast) as draft:
            draft.write_text(exchange.to_openfast(time, heights, f"{title}, x = {point[0]:g} m, z = {point[1]:g} m"))
        files.append(openfast)
    answer: dict[str, Any] = {
        "waves": len(waves.amplitude),
        "significant_height_m": waves.significant_height,
        "depth_m": waves.depth,
        "files": files,
    }
    if as_json:
        console.answer(answer)
        return
    console.say(f"{title}: {answer['waves']} plane waves, significant height {waves.significant_height:.3g} m")
    for file in files:
        console.say(str(file))

"""`ocean-sim gallery`: redraw the README's pictures, or list old ones, by a program in a checkout of the project."""

from pathlib import Path

import typer

from ocean_sim.verbs.shared.console import checkout_module


def gallery(
    names: list[str] | None = typer.Argument(None, help="Pictures; by default those that are out of date."),
    check: bool = typer.Option(False, "--check", help="Only list those that are out of date, with their commands."),
    every: bool = typer.Option(False, "--all", help="Make all of them."),
    out: Path | None = typer.Option(None, help="Where to write; by default figures/gallery of this checkout."),
) -> int:
    """Make pictures that are old, or those named; `check`: only list them. The exit code is 1 where some are old."""
    program = checkout_module("figures.gallery.redraw", "gallery: the program that makes the pictures is")
    return program.redraw(names or [], check, every, out)

"""The panel as words, sliders and buttons in a box of a window."""

from textwrap import wrap
from typing import Any

import numpy as np

from ocean_sim.pictures.panel import Panel
from ocean_sim.pictures.subject import Subject

WIDTH, LINES = 38, 12  # letters in a line, and lines, of what went wrong


def controls(box: Any, panel: Panel, simulation: Subject, pace: float | None) -> None:
    """What is moved or pressed is taken at once; `pace` times real time it runs."""
    state = "paused" if panel.paused else "" if pace is None else f"{pace:.2g} x real time"
    box.text(f"t = {simulation.time:.2f} s  {state}")
    particles = simulation.fluid.particles
    box.text(
        "closed form, no particles" if particles is None else f"{particles.n} particles, {simulation.fluid.config.kind}"
    )
    box.text(f"wind: {panel.wind}")
    if panel.winds:
        for action, label in (("wind before", "previous wind (b)"), ("next wind", "next wind (m)")):
            if box.button(label):
                panel.do(action)
        box.text("another wind restarts the run")
    for slider in panel.sliders:
        box.text(slider.label)  # words next to a slider would be cut off
        slider.move(box.slider_float(f"##{slider.label}", slider.value, slider.low, slider.high))
    for action, label in (
        ("content", f"show: {panel.content} (v)"),
        ("camera", f"camera: {panel.camera} (c)"),
        ("camera back", "camera back to its place (z)"),
        ("hide or show", "hide this panel (u)"),
        ("pause", f"{'go on' if panel.paused else 'pause'} (space)"),
        ("step", "one step (n)"),
        ("reset", "reset (r)"),
        ("rewind", "back by some moments (w)"),
        ("record", f"{'stop recording' if panel.recording else 'record'} (o)"),
        ("snapshot", "snapshot (p)"),
    ):
        if box.button(label):
            panel.do(action)
    if panel.ship:
        throttle, rudder = simulation.ships[panel.ship].orders
        if len(panel.ships) > 1 and box.button(f"at the helm of {panel.ship} (h)"):
            panel.do("next ship")
        box.text(f"throttle {throttle:+.2f}  rudder {np.degrees(rudder):+.0f} deg")
        box.text("steered by hand" if panel.person is not None else "steered by the scene")
        box.text("Up, Down: throttle, brake")
        box.text("Left, Right: port, starboard")
        box.text("x: rudder amidships")
    box.text("drag: orbit   q, e: nearer, away")
    if not simulation.scene.wind.still:
        box.text("yellow: where it blows  red: push")
    if panel.message:
        for line in wrap(panel.message, WIDTH)[:LINES]:
            box.text(line, color=(1.0, 0.55, 0.4))

"""Figure 6-9: the architecture of the whole, read from the program: the stages of a step, what each reads, the kinds
that it may be, and the way from the ship's motion to the legs of the platform: CSV and PNG.

python figures/fig6_9.py [--fast] [--out DIR]
"""

import ast
from pathlib import Path
from typing import Any, NamedTuple

from _options import options
from _paper import BLUE, GREEN, GREY, INK, ORANGE, PURPLE, paper, save_figure, save_table

from ocean_sim.parts import PACKAGE, SLOTS, kinds
from ocean_sim.platform.hexapod import WASHOUT_KINDS

BAND = "#f4f6f7"  # of what belongs together
THESIS = {
    "wind": "Algorithm 1",
    "fluid": "(2.27)",
    "surface": "Algorithms 3, 5",
    "ship": "(4.22) to (4.27)",
}
PASSED = {
    ("wind", "fluid"): "force",
    ("fluid", "surface"): "particles",
    ("surface", "ship"): "elevation",
    ("fluid", "ship"): "pressure, velocity",
    ("wind", "ship"): "force",
    ("fluid", "wind"): "where its patch is",
    ("ship", "fluid"): "impulses",
}


class Stage(NamedTuple):
    """One stage of `Simulation.step`, as the source code has it."""

    name: str
    calls: list[str]
    reads: list[str]
    kinds: tuple[str, ...]


def methods(module: str, owner: str) -> dict[str, ast.FunctionDef]:
    """Syntax trees of the methods of a class, by name."""
    tree = ast.parse((PACKAGE / f"{module}.py").read_text(encoding="utf-8"))
    found = next(node for node in tree.body if isinstance(node, ast.ClassDef) and node.name == owner)
    return {node.name: node for node in found.body if isinstance(node, ast.FunctionDef)}


def slots_read(node: ast.AST) -> set[str]:
    """Slots that source code reads from `self`: as `self.<slot>`, `self.<slot>s` or `self.<slot>_on...`."""
    names = {n.attr for n in ast.walk(node) if isinstance(n, ast.Attribute) and ast.unparse(n.value) == "self"}
    return {slot for slot in SLOTS for name in names if name in (slot, f"{slot}s") or name.startswith(f"{slot}_on")}


def stages() -> list[Stage]:
    """Stages of `Simulation.step` in order, each with the slots that it reads when built and when it runs."""
    source = methods("simulation", "Simulation")
    built: dict[str, set[str]] = {}
    for node in ast.walk(source["build"]):
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]).startswith("self."):
            built[ast.unparse(node.targets[0]).removeprefix("self.")] = slots_read(node.value)
    for node in ast.walk(source["build"]):
        for slot in SLOTS:  # what it is handed, it reads
            if isinstance(node, ast.Call) and ast.unparse(node.func).startswith(f"self.{slot}."):
                built[slot] = built[slot].union(*(slots_read(given) for given in node.args))
    found = []
    for node in ast.walk(source["step"]):
        entered = node.items[0].context_expr if isinstance(node, ast.With) else None
        if isinstance(entered, ast.Call) and ast.unparse(entered.func) == "self.stage":
            name = ast.literal_eval(entered.args[0])
            calls = [ast.unparse(n.func).removeprefix("self.") for n in ast.walk(node) if isinstance(n, ast.Call)]
            used = [n.attr for n in ast.walk(node) if isinstance(n, ast.Attribute) and ast.unparse(n.value) == "self"]
            made = [name, *(attribute for attribute in used if attribute not in SLOTS)]
            reads = set().union(slots_read(node), *(built.get(attribute, set()) for attribute in made))
            calls = [call for call in calls if call.split(".")[0] in SLOTS]
            before = [slot for slot in SLOTS if slot in reads and slot != name]
            found.append(Stage(name, calls, before, kinds(name) if name in SLOTS else ()))
    return sorted(found, key=lambda stage: SLOTS.index(stage.name) if stage.name in SLOTS else len(SLOTS))


def box(axes: Any, x: float, y: float, wide: float, high: float, title: str, lines: list[str], colour: str) -> None:
    """Draw a box with a title and lines of text; x, y: its lower left corner."""
    from matplotlib.patches import FancyBboxPatch

    style = "round,pad=0,rounding_size=0.12"
    axes.add_patch(FancyBboxPatch((x, y), wide, high, boxstyle=style, fc=colour, ec=INK, lw=1.2, alpha=0.16))
    axes.add_patch(FancyBboxPatch((x, y), wide, high, boxstyle=style, fc="none", ec=colour, lw=1.6))
    axes.text(x + wide / 2, y + high - 0.16, title, ha="center", va="top", fontsize=11, weight="bold", color=INK)
    axes.text(
        x + wide / 2, y + high - 0.56, "\n".join(lines), ha="center", va="top", fontsize=8.5, color=INK, linespacing=1.3
    )


def arrow(axes: Any, begin: tuple[float, float], end: tuple[float, float], text: str) -> None:
    """Draw an arrow from one point to another, with a text over its middle."""
    shape = {"arrowstyle": "-|>", "color": INK, "lw": 1.3, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", end, begin, arrowprops=shape)
    middle = (begin[0] + end[0]) / 2, (begin[1] + end[1]) / 2 + 0.12
    axes.text(*middle, text, ha="center", va="bottom", fontsize=8.5, color=INK)


def draw_figure(found: list[Stage], path: Path) -> None:
    """Draw three rows as in the thesis, vehicle dynamics, washout and platform, and the observers next to them."""
    figure = paper(13.5, 7.4)
    axes = figure.add_subplot()
    axes.set(xlim=(-0.2, 14.9), ylim=(-0.2, 8.2))
    axes.axis("off")
    for low, high, text in (
        (3.55, 8.1, "vehicle dynamics: one step of Algorithm 8"),
        (-0.1, 3.1, "washout filter and motion platform"),
    ):
        axes.axhspan(low, high, color=BAND, zorder=0)
        axes.text(0.0, high - 0.12, text, fontsize=10, color=GREY, va="top")
    wide, gap, place = 2.35, 1.5, {}
    for k, stage in enumerate(found):
        x = 0.1 + k * (wide + gap)
        place[stage.name] = x
        lines = [*stage.kinds, "", THESIS.get(stage.name, "")]
        box(axes, x, 4.5, wide, 2.25, stage.name, lines, BLUE)
        axes.text(
            x + wide / 2,
            4.36,
            "\n".join(stage.calls),
            ha="center",
            va="top",
            fontsize=7.5,
            color=GREY,
            family="monospace",
            bbox={"facecolor": BAND, "edgecolor": "none", "pad": 1.0},
        )
    order = [stage.name for stage in found]
    for stage in found:
        for other in stage.reads:
            apart, caption = order.index(stage.name) - order.index(other), PASSED.get((other, stage.name), "")
            if apart == 1:
                arrow(axes, (place[other] + wide, 5.6), (place[stage.name], 5.6), caption)
                continue
            level = 6.85 + 0.28 * apart if apart > 0 else 4.05 + 0.2 * apart
            side = 6.75 if apart > 0 else 4.5
            leaves, comes = (0.62, 0.1 + 0.16 * apart) if apart > 0 else (0.2, 0.8)
            begin, end = place[other] + wide * leaves, place[stage.name] + wide * comes
            axes.plot([begin, begin, end], [side, level, level], color=INK, lw=1.3)
            arrow(axes, (end, level), (end, side + 0.01), "")
            axes.text((begin + end) / 2, level + 0.04, caption, ha="center", va="bottom", fontsize=8.5, color=INK)
    ship = place["ship"]
    box(axes, ship, 1.0, wide, 1.55, "motion log", ["pose, rates, specific force", "at a fixed rate"], GREEN)
    arrow(axes, (ship + 0.85 * wide, 4.5), (ship + 0.85 * wide, 2.56), "")
    washouts = [name.removeprefix("_washout_") for name in WASHOUT_KINDS]
    box(axes, place["surface"], 1.0, wide, 1.55, "washout", [*washouts, "forces and rates to poses"], PURPLE)
    box(axes, place["fluid"], 1.0, wide, 1.55, "hexapod", [*kinds("platform"), "limits; poses to legs"], ORANGE)
    box(
        axes,
        place["wind"],
        1.0,
        wide,
        1.55,
        "platform",
        ["six legs, cabin, driver", "platform.csv, UDP stream"],
        ORANGE,
    )
    for over, under, text in (("ship", "surface", "a, ω"), ("surface", "fluid", "pose"), ("fluid", "wind", "legs")):
        arrow(axes, (place[over], 1.75), (place[under] + wide, 1.75), text)
    driver = place["wind"] + wide / 2
    axes.plot([driver, driver, ship + 0.8 * wide], [1.0, 0.45, 0.45], color=INK, lw=1.3)
    axes.plot([ship + 0.8 * wide, ship + wide + 0.35, ship + wide + 0.35], [0.45, 0.45, 5.6], color=INK, lw=1.3)
    arrow(axes, (ship + wide + 0.35, 5.6), (ship + wide, 5.6), "")
    way = "throttle and rudder, by the person on it; or else by rows, a file, an autopilot"
    axes.text(7.4, 0.5, way, ha="center", va="bottom", fontsize=8.5)
    save_figure(figure, path, f"Observers watch from outside: {', '.join(kinds('observers'))}")


def main() -> None:
    out = options(__doc__).out
    found = stages()
    rows = [(stage.name, " ".join(stage.calls), " ".join(stage.reads), " ".join(stage.kinds)) for stage in found]
    rows.append(("platform", "platform.follow", "ship", " ".join(kinds("platform"))))
    rows.append(
        ("washout", "washout.follow", "platform", " ".join(name.removeprefix("_washout_") for name in WASHOUT_KINDS))
    )
    head = ["stages of Simulation.step in their order, then what follows the motion log; read from the source"]
    save_table(out / "fig6_9.csv", head, ["stage", "calls", "reads", "kinds"], rows)
    draw_figure(found, out / "fig6_9.png")


if __name__ == "__main__":
    main()

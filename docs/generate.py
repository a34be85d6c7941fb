"""The pages that are made from the program itself: keys, commands, kinds, results, tutorials, glossary.

They go to docs/generated/ when the docs are built, and are not kept.
"""

import ast
import csv
import re
import shutil
import textwrap
from collections import Counter
from collections.abc import Iterator, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from ocean_sim import conventions
from ocean_sim.files.input_file import Checked
from ocean_sim.parts import PACKAGE, SLOTS, kinds, named
from ocean_sim.reading.keys import Key, scene_keys
from ocean_sim.reading.scene import observer_names, on_unless_null
from ocean_sim.reading.sentences import module_sentence, part_sentence
from ocean_sim.validation.shared.case import COARSE_BASIS

DOCS = Path(__file__).parent
RESULTS = DOCS / "results"
TUTORIALS = (
    *("first_scene", "gust_and_real_wind", "dam_break_on_a_box", "a_wave_on_your_beach"),
    *("yacht_in_waves", "sea_off_cape_canaveral", "platform_and_rig"),
)
SCHEMES = ("mueller", "delta_sph", "dfsph")  # of particles, whose laws have terms
NUMBERS = {
    "3-7": "the transmitted angle ends at 48.59 degrees; asin(1 / 1.333) is 48.61",
    "6-1": "6000 particles; 32 x 6 x 32 = 6144",
    "6-2": "none, but the cloth is said to be the cheaper: of cubes' time it takes a seventh here, "
    "and a tenth [on finer water](../guide/surface.md)",
}
NO_FIGURE = {
    "3-1": "a textbook sketch of a cube of marching cubes",
    "3-4": "a sketch of a cloth laid on particles; figure 6-1 shows it done",
    "3-5": "a textbook sketch of the law of reflection",
    "3-6": "a textbook sketch of refraction; figure 3-7 has its angles",
    "3-8": "a diagram of a graphics pipeline of its time",
    "4-1": "a textbook sketch of two frames of axes",
}

GALLERY = {  # what each picture shows
    "showcase": "Some 6000 particles under the thesis's wide wind, in a basin of 40 m by 40 m, after 9.2 s; the sea "
    "beyond is only drawn.",
    "yacht_in_waves": "A sum of linear waves, 1.5 m high with a peak period of 5.5 s. She makes 4 m/s at first.",
    "from_the_helm": "The same sea, from the camera at her helm.",
    "two_ships": "A spectral sea, without particles. The tug, of 22 m, passes at 3.8 m/s; the yacht lies on three "
    "moorings (not drawn), 22 m from the tug's track.",
    "sail_away": "A spectral sea, without particles: waves 1.2 m high with a peak period of 5.5 s; a tile of 160 m "
    "around her carries her wake.",
    "wind_wide": "The thesis's figure 6-3 (c) after 4 s, with the wind and a scale.",
    "wind_vortex": "The thesis's figure 6-3 (d) after 7.9 s, with the wind and a scale.",
    "dam_break_on_a_box": "The tank of Kleefsman et al. (2005), 3.22 m long, 0.72 s after the water was let go.",
    "box_in_wave_tank": "A wavemaker sends waves of 0.1 m past a box; a zone at the other end absorbs them.",
    "reef": "Waves of 0.1 m turn around a mound in a tank of 6 m by 4 m.",
    "platform": "Poses of a hexapod, forces and rates, in the platform's axes: x forward, y to port, z up. Dashed: her "
    "scaled motion, which the platform leaves where a limit holds (shaded).",
}

GUIDES = {  # of each slot, the page that helps to choose
    "sea": "[A patch of open sea](../guide/patch.md)",
    "wind": "[Which wind](../guide/wind.md)",
    "fluid": "[Which water](../guide/water.md)",
    "surface": "[Which surface](../guide/surface.md)",
    "ship": "[Ships](../guide/ships.md)",
    "platform": "[Platforms](../guide/platforms.md)",
    "time_step": "[Water, by equation](../theory/sph.md)",
}

ELSEWHERE = {
    "slice, two-dimensional": "2-D: a basin without a `width`, a vertical slice",
    "in space, three-dimensional": "3-D: a basin with a `width`",
    "smoothing length h, 2h, kernel radius": "kernel support radius; `support_ratio` is that over the spacing",
    "ghost, mirror or dummy particles": "ghost particles, the images in a flat side; samples, of a solid body",
    "CFL number, CFL limit": "`time_step.courant_number`; the limit `acoustic`",
    "density error": "compression, as keys and columns call it",
    "particle size, resolution dx": "`spacing`",
    "inlet, inflow": "inflow, the key `fluid.emitter`",
    "numerical beach, sponge layer, relaxation zone": "an absorbing side; with a target, one that relaxes the water",
    "wave probe, pressure probe, sensor": "gauge",
    "template, ready-made part": "a preset, a file in `configs/`",
    "plug-in": "a kind, which is a module in the folder of its slot",
    "WCSPH": "`delta_sph`, `mueller`",
    "motion cueing": "`washout`",
    "Stewart platform": "hexapod",
    "draft, beam": "draught, breadth",
}


def pages(folder: Path) -> None:
    """Write all generated pages to a folder, after emptying it."""
    shutil.rmtree(folder, ignore_errors=True)
    made = {
        "scene": scene(),
        "commands": commands(),
        "kinds": all_kinds(),
        "validation": validation(),
        "figures": figures(),
        "errata": errata(),
        "glossary": glossary(),
        "gallery": gallery(),
        "files": checked_files(),
        "terms": terms(),
        "changes": (DOCS.parent / "CHANGELOG.md").read_text(encoding="utf-8"),
    }
    made |= {f"scene_{section}": text for section, text in sections().items()}
    made |= {f"tutorial_{name}": literate(DOCS / "tutorials" / f"{name}.py") for name in TUTORIALS}
    folder.mkdir(parents=True)
    for name, text in made.items():
        (folder / f"{name}.md").write_text(text, encoding="utf-8")


def checked_files() -> str:
    """Page of the rules that input files must obey, in the words of the messages that refuse them."""
    sections = "".join(
        f"\n## {checked.title}\n\n" + "".join(f"- {rule.sentence}.\n" for rule in checked.rules) for checked in checks()
    )
    opening = "A file that breaks one of these rules is refused before anything runs, with what was found, and where."
    return f"# What is checked of your files\n\n{opening}\n{sections}"


def checks() -> list[Checked]:
    """Checked rules of all modules that read files, those of package `files` first."""
    paths = [path.relative_to(PACKAGE) for path in sorted(PACKAGE.rglob("*.py")) if "\nCHECKS = " in path.read_text()]
    first = [Path("files", name) for name in ("input_file.py", "csv_file.py")]
    order = [*first, *(path for path in paths if path not in first)]
    return [
        each for path in order for each in import_module(".".join(("ocean_sim", *path.with_suffix("").parts))).CHECKS
    ]


def terms() -> str:
    """Page with the code of each term of the particle schemes, to which the theory links."""
    found = ["# Terms, and the code that computes them", "[Water, by equation](../theory/sph.md) has their equations."]
    for scheme in SCHEMES:
        found.append(f"## `{scheme}`")
        for name in terms_of(scheme):
            include = f"```{{literalinclude}} ../../ocean_sim/fluid/{scheme}.py\n:pyobject: {name}\n:dedent:\n```"
            found += [f"({scheme}.{name})=", f"### `{name}`", include]
    return "\n\n".join(found) + "\n"


def terms_of(scheme: str) -> list[str]:
    """Names `Class.function` of a scheme's equations of state, of rates at which its pressure decays, and of the
    functions that make its pair terms."""
    found = []
    for law in ast.parse((PACKAGE / "fluid" / f"{scheme}.py").read_text(encoding="utf-8")).body:
        functions = [part for part in getattr(law, "body", ()) if isinstance(part, ast.FunctionDef)]
        adders = [function for function in functions if function.name in ("pair", "sum_of_terms")]
        calls = [node.func for adder in adders for node in ast.walk(adder) if isinstance(node, ast.Call)]
        called = {call.attr for call in calls if isinstance(call, ast.Attribute) and ast.unparse(call.value) == "self"}
        wanted = (called | {"equation_of_state", "leak", "tension_release"}) - {adder.name for adder in adders}
        found += [f"{law.name}.{part.name}" for part in functions if part.name in wanted]  # type: ignore[attr-defined]
    return found


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cell(c) for c in line) + " |" for line in lines) + "\n"


def cell(text: str) -> str:
    return re.sub(r"\s+", " ", str(text), flags=re.ASCII).strip().replace("|", "\\|")  # keeps non-breaking spaces


def code(text: str) -> str:
    return f"`{text}`" if text else ""


# --- the keys of a scene


def top(key: Key) -> str:
    """First name in a key's path."""
    return key.path.partition(".")[0].removesuffix("[]")


def scene() -> str:
    """First page of the scene reference: the slots of a scene, with links to their pages."""
    heads = [key for key in scene_keys() if key.section in ("title", "seed", "duration", "resolution")]
    rows = [[f"[`{slot}`](scene_{slot}.md)", slot_sentence(slot), choices(slot)] for slot in SLOTS]
    observers = [
        [
            f"`{name}`",
            module_sentence(PACKAGE / "observers" / f"{name}.py"),
            "on unless `null`" if on(name) else "when named",
        ]
        for name in observer_names()
    ]
    links = "\n".join(["scene_basin", *(f"scene_{slot}" for slot in SLOTS), "scene_runtime", "scene_observers"])
    return f"""# Scene reference

Made from the models that check a scene, so that it cannot differ from them. `ocean-sim explain KEY` prints the same for
one key, and `ocean-sim schema` gives it to editors. SI units and radians unless a key says otherwise; unknown keys are
errors. A path is that of `--set`, with the kind of a part after its slot; `[]` stands for the entries of a list, `NAME`
for a name that you give.

## What every scene may have

{key_table(heads)}
`basin` and `fluid` are required. An absent `wind` is `still`; any other absent slot is nothing at all.

{table(["slot", "", "kinds and presets"], [["[`basin`](scene_basin.md)", "The tank.", ""], *rows])}
`ships:` holds several ships by name in place of `ship`, with the same keys.

## Observers

A top-level key that is the name of an observer configures it; `null` switches it off.

{table(["key", "", ""], observers)}
```{{toctree}}
:hidden:

{links}
```
"""


def on(name: str) -> bool:
    return name in on_unless_null(SLOTS)


def slot_sentence(slot: str) -> str:
    """Sentence on a slot: the opening of its package's docstring, up to the colon."""
    return module_sentence(PACKAGE / slot / "__init__.py").partition(":")[0].rstrip(".") + "."


def choices(slot: str) -> str:
    return ", ".join(code(name) for name in dict.fromkeys((*kinds(slot), *named(slot))))


def key_table(rows: Sequence[Key], prefix: str = "") -> str:
    """Keys without their common prefix, the values that each takes, and its meaning; fits a page 1280 px wide."""
    cells = [[code(key.path.removeprefix(prefix)), ", ".join(filter(None, values(key))), key.meaning] for key in rows]
    return framed(table(["key", "takes", "meaning"], cells), "keys")


def values(key: Key) -> Iterator[str]:
    """Yield type with unit, range and default of a key, each as text."""
    yield key.takes + (f" [{key.unit}]" if key.unit not in ("", "1") else "")
    yield key.range
    yield "required" if key.default == "required" else f"default `{key.default}`" if key.default else ""


def framed(rows: str, name: str) -> str:
    """Table wrapped in a CSS class of `static/pages.css`."""
    return f":::{{table}}\n:class: {name}\n\n{rows}:::\n"


def sections() -> dict[str, str]:
    """Reference pages by name: basin, runtime, each slot, and observers, with tables of their keys."""
    found = {"basin": page("The basin", "basin", own_keys("basin"))}
    found["runtime"] = page("The machine", "runtime", own_keys("runtime"))
    for slot in SLOTS:
        parts = [[code(name), part_sentence(slot, name)] for name in (*kinds(slot), *named(slot))]
        choose = f"{slot_sentence(slot)} Choose a kind or a preset; {GUIDES[slot]} helps. Signs: [axes](../axes.md).\n"
        text = [f"# {slot}\n", choose, framed(table(["kind or preset", ""], parts), "words")]
        for kind in kinds(slot):
            own = [key for key in scene_keys() if key.section == f"{slot}.{kind}"]
            example = next((key.example for key in own), "")
            begin = f" Its keys begin with `{slot}.{kind}.`:" if own else ""
            text += [f"## {slot}: {kind}\n", f"{part_sentence(slot, kind)}{begin}\n", key_table(own, f"{slot}.{kind}.")]
            text += [f"As `--set` takes it: `{example}`.\n"] if example and "..." not in example else []
        found[slot] = "\n".join(text)
    text = ["# Observers\n", "Who watches a run and writes files.\n"]
    for name in observer_names():
        text += [
            f"## {name}\n",
            module_sentence(PACKAGE / "observers" / f"{name}.py") + "\n",
            key_table(own_keys(name)),
        ]
    found["observers"] = "\n".join(text)
    return found


def own_keys(section: str) -> list[Key]:
    """Keys of one section of the scene; keys that all sides of a basin share are listed once."""
    alike = re.compile(r"basin\.walls\.(z|x_min|x_max|z_min|z_max)\.")
    return [key for key in scene_keys() if top(key) == section and not alike.match(key.path)]


def page(title: str, name: str, rows: Sequence[Key]) -> str:
    return f"# {title}\n\nUnder the key `{name}`.\n\n{key_table(rows)}"


# --- commands


def commands() -> str:
    """Page of all commands with their arguments and options."""
    from ocean_sim.__main__ import HIDDEN_VERBS, VERBS, command_of

    text = [
        "# Commands\n",
        "`./sandbox VERB` in a checkout and `ocean-sim VERB` are the same. Every verb has `--help`, and `--json` where "
        "a program may read the answer.\n",
        "| exit code | means |\n| --- | --- |\n| 0 | done |\n| 1 | the run failed: it diverged, the disk is full |\n"
        "| 2 | the input is wrong |\n| 3 | the machine lacks something |\n",
        "`--debug` on any verb shows the traceback of an error. `ocean-sim --install-completion` teaches your shell to "
        "complete verbs, scenes, profiles and keys; `ocean-sim --version` prints the version.\n",
    ]
    for name in sorted(set(VERBS) - set(HIDDEN_VERBS)):
        verb = command_of(name)
        arguments = [p for p in verb.params if p.param_type_name == "argument"]
        options = [p for p in verb.params if p.param_type_name == "option" and p.name != "help"]
        usage = " ".join(argument(p) for p in arguments)
        rows = [[code(argument(p)), p.help or ""] for p in arguments]
        rows += [[code(", ".join([*p.opts, *p.secondary_opts])), (p.help or "") + default(p)] for p in options]
        text += [f"## {name}\n", f"{verb.help}\n", f"`ocean-sim {name} {usage}`\n", table(["", ""], rows)]
    return "\n".join(text)


def argument(parameter: Any) -> str:
    word = parameter.name.upper() + (" ..." if parameter.nargs == -1 or parameter.multiple else "")
    return word if parameter.required else f"[{word}]"


def default(parameter: Any) -> str:
    value = parameter.default
    if value in (None, False, (), [], "") or callable(value) or parameter.is_flag:
        return ""
    return f" Default: `{value}`."


# --- kinds, as their modules state them


def all_kinds() -> str:
    """Page with the docstrings of all modules of the slots: the physics of each kind."""
    text = [
        "# Each law, as its module states it\n",
        "Taken from the source: what a module computes, after whom, and what it is known to do badly.\n",
    ]
    for slot in SLOTS:
        text.append(f"## {slot}\n")
        for path in [*sorted((PACKAGE / slot).glob("[!_]*.py")), *sorted((PACKAGE / slot).glob("*/[!_]*.py"))]:
            words = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
            name = path.relative_to(PACKAGE / slot).with_suffix("").as_posix()
            text.append(f"### {slot}: {name.replace('/', ', ')}\n\n{prose(words)}\n")
    return "\n".join(text)


def prose(docstring: str) -> str:
    """Convert a docstring to Markdown; code and indented text stay as they are."""
    shown = []
    for paragraph in docstring.split("\n\n"):
        if paragraph.startswith(" "):
            shown.append(f"```{{code-block}} text\n{textwrap.dedent(paragraph)}\n```")
        else:
            pieces = re.split(r"(`[^`]*`)", paragraph)
            shown.append("".join(p if p.startswith("`") else re.sub(r"([*_|$<\[\]#\\])", r"\\\1", p) for p in pieces))
    return "\n\n".join(shown)


# --- results


def rows_of(name: str) -> list[dict[str, str]]:
    path = RESULTS / f"{name}.csv"
    if not path.is_file():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def number(text: str) -> str:
    """A number to four digits; a hyphen before its exponent breaks no line."""
    return f"{float(text):.4g}".replace("e-", "e\u2011") if text else ""


def validation() -> str:
    """Validation page from docs/results: misses, a table with a row for each case, and a section for each."""
    rows = rows_of("validate")
    cases: dict[str, list[dict[str, str]]] = {}
    for row in rows:
        cases.setdefault(row["case"], []).append(row)
    judges, alarms = by_basis(rows)
    missed, worse = ([row for row in part if row["ok"] != "True"] for part in (judges, alarms))
    misses = "".join(f"- {row['case']}, `{row['scheme']}`: {row['quantity']}: {judged(row)}\n" for row in missed)
    beyond = "; ".join(f"[{row['case']}](#{row['case']}), {row['quantity']}, {judged(row)}" for row in worse)
    first = [f"[{case}](#{case}) {count}" for case, count in Counter(row["case"] for row in missed).items()]
    lines = [line_of(case, own) for case, own in cases.items()]
    return "\n".join(
        [
            "# Validation\n",
            "Each case is a problem whose answer is known from theory, an experiment or another program; "
            "`ocean-sim validate` runs it and compares. A row is one quantity: its error, and the tolerance that this "
            "error has to keep, with its source.\n",
            f"{len(cases)} cases, {len(rows)} rows; {kept(judges)} tolerances kept. Missed: {', '.join(first)}. "
            f"{len(alarms)} more rows only detect regressions: their tolerance is an error measured before, plus 25 %; "
            f"beyond it now: {beyond or 'none'}.\n",
            f"<details><summary>Misses: {len(missed)}</summary>\n\n{misses}\n</details>\n",
            framed(table(["case, tolerances kept", "row nearest its tolerance, or furthest beyond"], lines), "cases"),
            (DOCS / "validation.md.in").read_text(encoding="utf-8"),
            *(case_section(case, own) for case, own in cases.items()),
        ]
    )


def verdict(row: dict[str, str]) -> str:
    """Word for what a row shows, as a cell of Markdown."""
    if not row["tolerance"] or row["ok"] != "True":
        return "**missed**" if row["tolerance"] else "reported"
    return "no regression" if COARSE_BASIS in row["source"] else "kept"


def judged(row: dict[str, str]) -> str:
    """Text of a row's error and tolerance, with their unit."""
    unit = "" if row["unit"] == "1" else f"\u00a0{row['unit']}"
    return f"error {number(row['error'])}{unit}, tolerance {number(row['tolerance'])}{unit}"


def share_of_tolerance(row: dict[str, str]) -> float:
    """Absolute error over the tolerance; 0 if the tolerance is zero."""
    allowed = float(row["tolerance"])
    return abs(float(row["error"])) / allowed if allowed else 0.0


def by_basis(rows: Sequence[dict[str, str]]) -> tuple[list[dict[str, str]], list[dict[str, str]]]:
    """Rows with a tolerance, in two lists: those that judge the physics, and those that only detect regressions."""
    judges, alarms = list[dict[str, str]](), list[dict[str, str]]()
    for row in rows:
        if row["tolerance"]:
            (alarms if COARSE_BASIS in row["source"] else judges).append(row)
    return judges, alarms


def kept(rows: Sequence[dict[str, str]]) -> str:
    """Number of rows within their tolerance, of all."""
    return f"{sum(row['ok'] == 'True' for row in rows)} of {len(rows)}"


def line_of(case: str, rows: Sequence[dict[str, str]]) -> list[str]:
    """Table row of a case: name and tolerances kept; the row with the largest error over its tolerance, and the largest
    error of rows that only detect regressions."""
    judges, alarms = by_basis(rows)
    words = []
    if judges:
        nearest = max(judges, key=lambda row: (row["ok"] != "True", share_of_tolerance(row)))
        words.append(f"{nearest['quantity']} (`{nearest['scheme']}`): {judged(nearest)}")
    if alarms:
        largest = max(alarms, key=lambda row: abs(float(row["error"])))
        error = f"{number(largest['error'])}\u00a0{largest['unit']}"
        words.append(f"{len(alarms)} for regressions only, with errors up to {error}: {largest['quantity']}")
    count = kept(judges).replace(" ", "\u00a0") if judges else ""
    return [f"[{case}](#{case}) {count}", "; ".join(words) or "only reported"]


def case_section(case: str, rows: Sequence[dict[str, str]]) -> str:
    """Section of a case: its sentence and picture, and its rows and sources in a folded block."""
    words = ast.get_docstring(ast.parse((PACKAGE / "validation" / f"{case}.py").read_text(encoding="utf-8"))) or ""
    cells = [
        [row["scheme"], row["quantity"], number(row["value"]), number(row["reference"])]
        + [number(row["error"]) + (f" {row['unit']}" if row["unit"] != "1" else ""), number(row["tolerance"])]
        + [verdict(row)]
        for row in rows
    ]
    heads = ["scheme", "quantity", "value", "reference", "error", "tolerance", ""]
    sources = "".join(f"- {source}\n" for source in dict.fromkeys(row["source"] for row in rows))
    return "\n".join(
        [
            f"({case})=\n## {case}\n\n{' '.join(words.split(chr(10) * 2)[0].split())}\n",
            f"![{case}](../results/{case}.png){{.case}}\n" if (RESULTS / f"{case}.png").is_file() else "",
            f"<details><summary>All {len(rows)} rows, and their sources</summary>\n",
            table(heads, cells),
            f"{sources}\n</details>\n",
        ]
    )


def figures() -> str:
    """Page of the thesis's figures: each with ours, its command, the processor time, and remarks."""
    from ocean_sim.verbs.figure import figure_scripts
    from ocean_sim.verbs.figure import figure_sentence as shows

    took = {row["figure"]: [row["full_s"], row["fast_s"]] for row in rows_of("figures")}
    shown = []
    for name, path in figure_scripts().items():
        if name[0].isdigit():
            what = (shows(path).partition(": ")[2] or shows(path)).removesuffix(": CSV and PNG.").rstrip(".")
            full, fast = (f"{float(seconds):.0f} s" if seconds else "" for seconds in took.get(name, ["", ""]))
            thesis = f" In the thesis: {NUMBERS[name]}." if name in NUMBERS else ""
            picture = (
                f"```{{image}} ../results/figures/{name}.jpg\n:alt: Figure {name}\n:target: ../_images/{name}.jpg\n```"
                if (RESULTS / "figures" / f"{name}.jpg").is_file()
                else ""
            )
            time = f" {full} of processor time, {fast} with `--fast`." if full else ""
            said = f"{what[0].upper()}{what[1:]}. `ocean-sim figure {name}`:{time}{thesis}"
            shown.append(f"## Figure {name}\n\n{picture}\n\n{said}\n")
    left = [[name, why] for name, why in NO_FIGURE.items()]
    return "\n".join(
        [
            "# The thesis, figure by figure\n",
            (DOCS / "figures.md.in").read_text(encoding="utf-8"),
            *shown,
            "## Not drawn\n",
            table(["figure", "is"], left),
        ]
    )


def gallery() -> str:
    """Page of the gallery: pictures, each with the commands that make it."""
    from figures.gallery.redraw import gallery_entries, show_entry

    text = ["# Gallery\n", "What the program draws, each picture with the commands that make it.\n"]
    ran = dict[str, str]()  # by each command that runs a scene, the picture that it was first given for
    for entry in gallery_entries():
        name = entry.picture.partition(".")[0]
        shown = f"```{{image}} ../../figures/gallery/{entry.picture}\n:alt: {entry.about}"
        picture = f"{shown}\n:target: ../_images/{entry.picture}\n```\n\n{GALLERY[name]} (`{entry.scene}`)\n"
        simulate, draw = show_entry(entry)
        above = ran.setdefault(simulate, entry.about)
        simulate, draw = map(wrapped_command, (simulate, draw))
        lines = [simulate, draw] if above == entry.about else [f"# of the run of: {above}", draw]
        text += [f"## {entry.about}\n", picture, "```sh", *lines, "```\n"]
    text.append("`./sandbox gallery` makes those again that are older than what they show; `--check` lists them.\n")
    return "\n".join(text)


def wrapped_command(line: str) -> str:
    """Command of a shell over several lines that fit a page 1280 px wide."""
    return " \\\n    ".join(textwrap.wrap(line, 84, break_long_words=False, break_on_hyphens=False))


def errata() -> str:
    """Page of misprints in the thesis and their corrections, as `figure errata` writes them."""
    rows = rows_of("errata")
    names = ["where", "quantity", "unit", "as_printed", "corrected", "difference", "measured", "why"]
    cells = [
        [row[name] if name in ("where", "quantity", "unit", "why") else short(row[name]) for name in names]
        for row in rows
    ]
    heads = ["where", "quantity", "unit", "as printed", "corrected", "difference", "this program", "why"]
    return f"# Errata\n\n{(DOCS / 'errata.md.in').read_text(encoding='utf-8')}\n{table(heads, cells)}"


def short(text: str) -> str:
    try:
        return f"{float(text):.4g}"
    except ValueError:
        return text


# --- words


def glossary() -> str:
    """Glossary page: words of the field, words of other programs, axes, and words of this program."""
    axes = (conventions.__doc__ or "").partition("One word for one thing")[0]
    words = {name: (DOCS / f"{name}_words.md.in").read_text(encoding="utf-8") for name in ("field", "program")}
    elsewhere = list(ELSEWHERE.items())
    return "\n".join(
        [
            "# Glossary\n",
            "## Words of the field\n",
            "[One sketch](../axes.md) shows axes, headings and signs.\n",
            framed(words["field"], "words"),
            "## What others call it\n",
            framed(table(["in papers and other programs", "here"], elsewhere), "words"),
            "## Words of this program\n",
            axes,
            "One word for one thing, in names, messages and docs:\n",
            framed(words["program"], "words"),
        ]
    )


# --- tutorials


def literate(path: Path) -> str:
    """Page of a tutorial script: comments after a line `# %%` become text, the rest code, and its picture is last."""
    picture = RESULTS / "tutorials" / f"{path.stem}.png"
    drawn = [f"## What it draws\n\n![{path.stem}](../results/tutorials/{picture.name})\n"] if picture.is_file() else []
    pages = (f"```python\n{text}\n```\n" if is_code else f"{text}\n" for is_code, text in blocks(path))
    return "\n".join([*pages, *drawn])


def blocks(path: Path) -> Iterator[tuple[bool, str]]:
    """Yield the blocks of a script in order, each as (true if code, its lines as one text)."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    words = ast.get_docstring(tree) or ""
    title, _, rest = words.partition("\n")
    note = f"*This page is the script `docs/tutorials/{path.name}`; the tests run it.*"
    yield False, f"# {title.rstrip('.')}\n\n{rest.strip()}\n\n{note}"
    lines = path.read_text(encoding="utf-8").splitlines()
    body = lines[tree.body[0].end_lineno :] if words else lines
    text: list[str] = []
    statements: list[str] = []
    prose = False
    for line in [*body, "# %%"]:
        if line == "# %%":
            if "\n".join(statements).strip():
                yield True, "\n".join(statements).strip("\n")
            statements, text, prose = [], [], True
        elif prose and line.startswith("#"):
            text.append(line[2:])
        else:
            if prose and text:
                yield False, "\n".join(text)
            prose, text = False, []
            statements.append(line)

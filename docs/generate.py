"""The pages that are made from the program itself: keys, commands, kinds, results, tutorials, glossary.

They go to docs/generated/ when the docs are built, and are not kept.
"""

import ast
import csv
import re
import shutil
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
    "6-2": "none, but the cloth is said to be the cheaper; measured, it is ten times (see which surface)",
}
NO_FIGURE = {
    "3-1": "a textbook sketch of a cube of marching cubes",
    "3-4": "a sketch of a cloth laid on particles; figure 6-1 shows it done",
    "3-5": "a textbook sketch of the law of reflection",
    "3-6": "a textbook sketch of refraction; figure 3-7 has its angles",
    "3-8": "a diagram of a graphics pipeline of its time",
    "4-1": "a textbook sketch of two frames of axes",
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
    """Write all of them."""
    shutil.rmtree(folder, ignore_errors=True)
    made = {
        "scene": scene(),
        "commands": commands(),
        "kinds": all_kinds(),
        "validation": validation(),
        "figures": figures(),
        "errata": errata(),
        "glossary": glossary(),
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
    """The rules of every reader of files, as its refusals say them."""
    sections = "".join(
        f"\n## {checked.title}\n\n" + "".join(f"- {rule.sentence}.\n" for rule in checked.rules) for checked in checks()
    )
    opening = "A file that breaks one of these rules is refused before anything runs, with what was found, and where."
    return f"# What is checked of your files\n\n{opening}\n{sections}"


def checks() -> list[Checked]:
    """Rules of all modules that read files, the general ones of `files` first."""
    paths = [path.relative_to(PACKAGE) for path in sorted(PACKAGE.rglob("*.py")) if "\nCHECKS = " in path.read_text()]
    first = [Path("files", name) for name in ("input_file.py", "csv_file.py")]
    order = [*first, *(path for path in paths if path not in first)]
    return [
        each for path in order for each in import_module(".".join(("ocean_sim", *path.with_suffix("").parts))).CHECKS
    ]


def terms() -> str:
    """The terms of every scheme of particles, each with its code, for the page on theory to link to."""
    found = ["# Terms, and the code that computes them", "[Water, by equation](../theory/sph.md) has their equations."]
    for scheme in SCHEMES:
        found.append(f"## `{scheme}`")
        for name in terms_of(scheme):
            include = f"```{{literalinclude}} ../../ocean_sim/fluid/{scheme}.py\n:pyobject: {name}\n:dedent:\n```"
            found += [f"({scheme}.{name})=", f"### `{name}`", include]
    return "\n\n".join(found) + "\n"


def terms_of(scheme: str) -> list[str]:
    """Equations of state, the leak, and functions that the pair terms of a scheme's laws add up: `Class.function`."""
    found = []
    for law in ast.parse((PACKAGE / "fluid" / f"{scheme}.py").read_text(encoding="utf-8")).body:
        functions = [part for part in getattr(law, "body", ()) if isinstance(part, ast.FunctionDef)]
        adders = [function for function in functions if function.name in ("pair", "sum_of_terms")]
        calls = [node.func for adder in adders for node in ast.walk(adder) if isinstance(node, ast.Call)]
        called = {call.attr for call in calls if isinstance(call, ast.Attribute) and ast.unparse(call.value) == "self"}
        wanted = (called | {"equation_of_state", "leak"}) - {adder.name for adder in adders}
        found += [f"{law.name}.{part.name}" for part in functions if part.name in wanted]  # type: ignore[attr-defined]
    return found


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table of Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cell(c) for c in line) + " |" for line in lines) + "\n"


def cell(text: str) -> str:
    return " ".join(str(text).split()).replace("|", "\\|")


def code(text: str) -> str:
    return f"`{text}`" if text else ""


# --- the keys of a scene


def top(key: Key) -> str:
    """The first word of a key's path."""
    return key.path.partition(".")[0].removesuffix("[]")


def scene() -> str:
    """First page of the reference: the parts of a scene, with links to their pages."""
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
    return module_sentence(PACKAGE / slot / "__init__.py")


def choices(slot: str) -> str:
    return ", ".join(code(name) for name in dict.fromkeys((*kinds(slot), *named(slot))))


def key_table(rows: Sequence[Key]) -> str:
    cells = [
        [
            code(key.path),
            key.takes + (f" [{key.unit}]" if key.unit not in ("", "1") else ""),
            code(key.default),
            key.range,
        ]
        + [key.meaning]
        for key in rows
    ]
    return table(["key", "takes", "default", "range", "meaning"], cells)


def sections() -> dict[str, str]:
    """The tables of keys: a page for the basin, for each slot, for the runtime and for the observers."""
    found = {"basin": page("The basin", "basin", own_keys("basin"))}
    found["runtime"] = page("The machine", "runtime", own_keys("runtime"))
    for slot in SLOTS:
        parts = [[code(name), part_sentence(slot, name)] for name in (*kinds(slot), *named(slot))]
        text = [f"# {slot}\n", slot_sentence(slot) + "\n", table(["kind or preset", ""], parts)]
        for kind in kinds(slot):
            own = [key for key in scene_keys() if key.section == f"{slot}.{kind}"]
            example = next((key.example for key in own), "")
            text += [f"## {slot}: {kind}\n", part_sentence(slot, kind) + "\n", key_table(own)]
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
    """Keys of a section; the keys that all sides of a basin share are listed once."""
    alike = re.compile(r"basin\.walls\.(z|x_min|x_max|z_min|z_max)\.")
    return [key for key in scene_keys() if top(key) == section and not alike.match(key.path)]


def page(title: str, name: str, rows: Sequence[Key]) -> str:
    return f"# {title}\n\nUnder the key `{name}`.\n\n{key_table(rows)}"


# --- commands


def commands() -> str:
    """Every verb with its arguments and options."""
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
    """The physics of each module, in its own words."""
    text = [
        "# Each law, as its module states it\n",
        "Taken from the source: what a module computes, after whom, and what it is known to do badly.\n",
    ]
    for slot in SLOTS:
        modules = [*sorted((PACKAGE / slot).glob("[!_]*.py")), *sorted((PACKAGE / slot).glob("*/[!_]*.py"))]
        text.append(f"## {slot}\n")
        for path in modules:
            words = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))
            name = path.relative_to(PACKAGE).as_posix()
            text.append(f"### {name}\n\n```{{code-block}} text\n{words}\n```\n")
    return "\n".join(text)


# --- results


def rows_of(name: str) -> list[dict[str, str]]:
    path = RESULTS / f"{name}.csv"
    if not path.is_file():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def number(text: str) -> str:
    return f"{float(text):.4g}" if text else ""


def validation() -> str:
    """Every case with its table and its picture, from the results that are kept in docs/results."""
    rows = rows_of("validate")
    cases = dict.fromkeys(row["case"] for row in rows)
    promised = [row for row in rows if row["tolerance"]]
    kept = sum(row["ok"] == "True" for row in promised)
    text = [
        "# Validation\n",
        (DOCS / "validation.md.in").read_text(encoding="utf-8"),
        f"{len(cases)} cases, {len(rows)} rows; {kept} of {len(promised)} tolerances kept.\n",
    ]
    for case in cases:
        words = ast.get_docstring(ast.parse((PACKAGE / "validation" / f"{case}.py").read_text(encoding="utf-8"))) or ""
        text += [f"## {case}\n", words.split("\n\n")[0].replace("\n", " ") + "\n"]
        own = [row for row in rows if row["case"] == case]
        cells = [
            [r["scheme"], r["quantity"], number(r["value"]), number(r["reference"])]
            + [number(r["error"]) + (f" {r['unit']}" if r["unit"] != "1" else ""), number(r["tolerance"])]
            + ["reported" if not r["tolerance"] else "kept" if r["ok"] == "True" else "**missed**", r["source"]]
            for r in own
        ]
        heads = ["scheme", "quantity", "value", "reference", "error", "tolerance", "", "source"]
        text.append(table(heads, cells))
        if (RESULTS / f"{case}.png").is_file():
            text.append(f"![{case}](../results/{case}.png)\n")
    return "\n".join(text)


def figures() -> str:
    """Figures of the thesis: contents, our command and its processor time."""
    from ocean_sim.verbs.figure import figure_scripts
    from ocean_sim.verbs.figure import figure_sentence as shows

    took = {row["figure"]: [row["full_s"], row["fast_s"]] for row in rows_of("figures")}
    heads = ["processor time", "with `--fast`"]
    cells = []
    for name, path in figure_scripts().items():
        if name[0].isdigit():
            what = shows(path).partition(": ")[2] or shows(path)
            times = [f"{float(seconds):.0f} s" if seconds else "" for seconds in took.get(name, ["", ""])]
            cells.append([name, what, f"`ocean-sim figure {name}`", NUMBERS.get(name, "none"), *times])
    left = [[name, why] for name, why in NO_FIGURE.items()]
    return "\n".join(
        [
            "# The thesis, figure by figure\n",
            (DOCS / "figures.md.in").read_text(encoding="utf-8"),
            table(["figure", "ours", "command", "its number, and ours", *heads], cells),
            "## Not drawn\n",
            table(["figure", "is"], left),
        ]
    )


def errata() -> str:
    """Table of misprints in the thesis and their corrections, as `figure errata` writes it."""
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
    """One word for one thing, from `ocean_sim/conventions.py`."""
    whole = conventions.__doc__ or ""
    axes, _, words = whole.partition("One word for one thing, in names, messages and docs:")
    lines = [line for line in words.strip().splitlines() if line.strip()]
    split = [re.split(r" {2,}", line, maxsplit=1) for line in lines]
    cells = [[pair[0], pair[1] if len(pair) > 1 else ""] for pair in split]
    elsewhere = [[theirs, ours] for theirs, ours in ELSEWHERE.items()]
    return "\n".join(
        [
            "# Glossary, units and axes\n",
            axes,
            table(["word", "is"], cells),
            "## What others call it\n",
            table(["in papers and other programs", "here"], elsewhere),
        ]
    )


# --- tutorials


def literate(path: Path) -> str:
    """Page of a script: comments after a line `# %%` become text, the rest code."""
    return "\n".join(f"```python\n{text}\n```\n" if is_code else f"{text}\n" for is_code, text in blocks(path))


def blocks(path: Path) -> Iterator[tuple[bool, str]]:
    """The blocks of text and code of a script, in their order: (whether it is code, its lines)."""
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

"""The command line `ocean-sim`; `verbs.csv` lists its verbs. Exit codes: 0 done, 1 failed, 2 wrong input, 3 a package,
driver or device is missing."""

import sys

try:
    import gc
    import os
    from errno import ENAMETOOLONG
    from importlib import import_module
    from itertools import groupby
    from operator import itemgetter
    from pathlib import Path
    from typing import Any

    import typer
    from typer.core import TyperCommand, TyperGroup

    from ocean_sim.conventions import Failed, Refused, in_words
    from ocean_sim.files.csv_file import read_records
    from ocean_sim.files.input_file import display_path
    from ocean_sim.machine import extra_with, missing_extra, stoppable
    from ocean_sim.verbs.shared import console
except KeyboardInterrupt:  # these take as long as it takes to press Ctrl-C
    sys.exit("stopped")


VERB_ROWS = read_records((Path(__file__).parent / "verbs" / "verbs.csv").read_text(encoding="utf-8"))
VERBS = {row["verb"]: row["line"] for row in VERB_ROWS}
FUNCTIONS = {row["verb"]: row["function"] for row in VERB_ROWS}  # as `module:function`
HIDDEN_VERBS = [row["verb"] for row in VERB_ROWS if not row["section"]]


def common_options(
    as_json: bool = typer.Option(False, "--json", help="Print the answer as JSON.", expose_value=False),
) -> None:
    """Declare the options that all subcommands share, for their `--help`; `run_command_line` evaluates them."""


def command_of(name: str) -> Any:
    """Typer command of a verb (a subcommand such as `run`) with its options; imports the module of the verb."""
    module, _, function = FUNCTIONS[name].partition(":")
    called = getattr(import_module(f"ocean_sim.verbs.{module}"), function)
    alone, common = (typer.Typer(add_completion=False, rich_markup_mode=None) for _ in range(2))
    alone.command(name, help=VERBS[name], hidden=name in HIDDEN_VERBS)(called)
    common.command()(common_options)
    command = typer.main.get_command(alone)
    command.params += typer.main.get_command(common).params
    return command


class Verbs(TyperGroup):
    """Group of all verbs (subcommands of `ocean-sim`); imports the module of a verb once it or its help is called."""

    def __init__(self, **given: Any) -> None:
        """Register every subcommand with its line of help; its options load at its call. `given`: for TyperGroup."""
        super().__init__(**given)
        for name, line in VERBS.items():
            self.add_command(TyperCommand(name, help=line, hidden=name in HIDDEN_VERBS))

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the verbs to the text of `--help` section by section, with aligned lines."""
        for section, rows in groupby((row for row in VERB_ROWS if row["section"]), itemgetter("section")):
            with formatter.section(section):
                formatter.write_dl([(f"{row['verb']:<9}", row["line"]) for row in rows])

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:
        """Name of the verb that is called, its Typer command with all options, and its remaining arguments."""
        name, command, rest = super().resolve_command(ctx, args)
        return name, command if command is None else command_of(str(name)), rest


app = typer.Typer(
    name="ocean-sim",
    cls=Verbs,
    epilog="Exit codes: 0 done, 1 the run failed, 2 the input is wrong, 3 the machine lacks something. "
    "With --debug anywhere, an error shows its traceback.",
    no_args_is_help=True,
    add_completion=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

# what typer raises where the command line is wrong; some of its versions take it from click, some bring their own
WrongUsage: Any = typer.BadParameter.__mro__[2]


def show_version(asked: bool) -> None:
    """Callback of `--version`: print the version of this program and exit, if the option was given."""
    if asked:
        from ocean_sim.machine import installed_version

        console.say(f"ocean-sim {installed_version('ocean-sim')}")
        raise typer.Exit


@app.callback()
def program(
    version: bool = typer.Option(
        False, "--version", help="Print the version and exit.", callback=show_version, is_eager=True
    ),
) -> None:
    """A particle ocean with wind, ships and a motion platform, from a YAML scene to pictures and data."""


def main(arguments: list[str] | None = None) -> None:
    """Run the command line, by default that of this process, and end the process with its exit code."""
    gc.set_threshold(20_000)  # reading kernels makes many small objects: a tenth of the time to the first step
    console.open_streams()
    given = sys.argv[1:] if arguments is None else arguments
    try:
        with stoppable():
            code = run_command_line(given)
    except console.Anew as other:
        other.begin(given)
    console.Outlet.over = True
    sys.exit(code)


def run_command_line(arguments: list[str]) -> int:
    """Run a command line and return its exit code; an error is printed as a sentence, with `--debug` its traceback."""
    console.json_asked = "--json" in arguments
    try:
        try:
            os.getcwd()
        except FileNotFoundError:
            raise Refused("the folder that you are in has been removed; change to another one") from None
        code: Any = app([word for word in arguments if word != "--debug"], "ocean-sim", standalone_mode=False)
        if code == 130:  # what typer makes of an interrupt
            raise KeyboardInterrupt
        return code if isinstance(code, int) else 0
    except (Exception, KeyboardInterrupt) as error:
        if "--debug" in arguments:
            import traceback

            traceback.print_exc()
        return print_error(error)
    finally:
        console.json_asked = False


def print_error(error: BaseException) -> int:
    """Print an error to standard error, or if JSON is asked for to standard output; returns the exit code."""
    code, sentence, problems = describe_error(error)
    if console.json_asked:
        sentence = console.problem_count(problems) if problems else sentence
        try:
            console.answer({"error": sentence, "problems": [problem._asdict() for problem in problems]})
        except OSError:  # which may be what there is to report
            console.complain(sentence)
    elif isinstance(error, WrongUsage):
        error.show()
    else:
        console.complain(sentence)
    return code


def describe_error(error: BaseException) -> tuple[int, str, list[Any]]:
    """Exit code of an error, its sentence for the user, and the problems in a scene, with locations, if any."""
    if isinstance(error, Failed):
        return error.exit_code, error.sentence, [*error.problems]
    if isinstance(error, ImportError | OSError) and "libX11" in str(error):
        return 3, "Taichi needs the system library libX11: as root, apt-get install libx11-6", []
    if isinstance(error, ModuleNotFoundError) and (extra := extra_with((error.name or "").partition(".")[0])):
        return 3, missing_extra(extra) or str(error), []
    if isinstance(error, OSError) and error.errno == ENAMETOOLONG:
        return Refused.exit_code, f"{display_path(error.filename)}: this name is too long", []
    if isinstance(error, WrongUsage):
        return error.exit_code, error.message, []
    if isinstance(error, KeyboardInterrupt | typer.Abort):
        return 1, str(error) or "stopped", []
    return 1, in_words(error), []


if __name__ == "__main__":
    main()

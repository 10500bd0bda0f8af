"""The command `vincula`: its subcommands, loaded when used, and how every run ends."""

from __future__ import annotations

import difflib
import os
import signal
import sys
import traceback
from collections.abc import Callable, Sequence
from importlib import import_module
from types import TracebackType
from typing import Any, Final

import click

from vincula import __version__
from vincula.cli.exits import DONE, FAULT, INTERRUPTED, USAGE, exit_code
from vincula.errors import VinculaError

COMMANDS: Final = {
    "inspect": "inspection",
    "analyze": "analyze",
    "compare": "compare",
    "close": "close",
    "follow": "follow",
    "map": "map",
    "place": "place",
    "design": "design",
    "sweep": "sweep",
    "plot": "plot",
    "convert": "convert",
    "examples": "examples",
    "schema": "examples",
    "warm-up": "warming",
}
"""Module of every command, in the order in which people meet them."""


class CommandLine(click.Group):
    """Subcommands imported one at a time, and one place where errors become messages and exit codes."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names in the order of work, not of the alphabet."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command, imported now."""
        if cmd_name not in COMMANDS:
            return None
        module = import_module(f"vincula.cli.{COMMANDS[cmd_name]}")
        command: click.Command = getattr(module, f"{cmd_name.replace('-', '_')}_command")
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """The command of the first word, with a suggestion when there is none of that name."""
        if args and not args[0].startswith("-") and args[0] not in COMMANDS:
            near = difflib.get_close_matches(args[0], COMMANDS, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"commands: {', '.join(COMMANDS)}"
            ctx.fail(f"no command is named {args[0]!r}; {hint}")
        return super().resolve_command(ctx, args)

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        **extra: Any,
    ) -> Any:
        """Run a command line and leave with its exit code."""
        words = list(sys.argv[1:] if args is None else args)

        def run() -> object:
            return super(CommandLine, self).main(words, prog_name, complete_var, False, **extra)

        return sys.exit(finished(run, debug="--debug" in words)) if standalone_mode else run()


def finished(command: Callable[[], object], *, debug: bool) -> int:
    """Run a command; say on stderr what went wrong, if anything did.

    Args:
        command: Returns an exit code, or anything else for "done".
        debug: Show the traceback of a refusal as well.

    Returns:
        The exit code.
    """
    try:
        result = command()
    except click.ClickException as error:
        error.show()
        return USAGE
    except (click.Abort, KeyboardInterrupt):
        click.echo("interrupted", err=True)
        return INTERRUPTED
    except VinculaError as error:
        if debug:
            traceback.print_exc()
        click.echo(f"error: {error}", err=True)
        return exit_code(error)
    return result if isinstance(result, int) else DONE


HELP: Final = """What can a closed-chain mechanism move, and how hard can it push?

Name a mechanism (a native or robot file, or example:NAME), its motors and the body you care about; get
its mobility, its statics and its manipulability.

\b
  vincula examples                             mechanisms to try
  vincula inspect example:five-bar             what is in it
  vincula analyze example:five-bar             everything at one configuration
  vincula compare example:five-bar --active o1,o5 --active o2,o4 --active all

Exit codes: 0 done, 1 refused (an open loop, say), 2 bad usage, bad file or missing extra, 3 doubtful
under --strict, 4 results cannot be stored, 130 interrupted.
"""


@click.group(
    cls=CommandLine,
    help=HELP,
    context_settings={"help_option_names": ["-h", "--help"]},
)
@click.version_option(__version__, "--version", message="vincula %(version)s")
def cli() -> None:
    """The command `vincula`."""


ONE_THREAD: Final = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
"""Switches of the linear algebra libraries."""


def main() -> None:
    """The console script."""
    for switch in ONE_THREAD:
        # Matrices are small: more threads cost time on a busy machine and could change last digits.
        os.environ.setdefault(switch, "1")
    if hasattr(signal, "SIGPIPE"):
        # `vincula ... | head` ends quietly, like every other tool.
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    for stream in (sys.stdout, sys.stderr):
        # A terminal that cannot show a character shows a question mark.
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")
    if "--debug" not in sys.argv:
        sys.excepthook = _unexpected
    cli(prog_name="vincula")


def _unexpected(kind: type[BaseException], error: BaseException, _: TracebackType | None) -> None:
    """One line instead of a traceback for an error that no code foresaw, and an exit code of its own."""
    click.echo(f"internal error: {kind.__name__}: {error}", err=True)
    click.echo("This is a fault in vincula; run again with --debug to see where.", err=True)
    sys.exit(FAULT)

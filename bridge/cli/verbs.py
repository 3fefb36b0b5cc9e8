"""The application: a group of verbs of which only the one that is asked for is imported and built."""

import importlib
from collections.abc import Iterator, MutableMapping
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from bridge.cli.catalogue import VERBS

HELP = """A digital twin of a hydraulic drive, and a testbed for its controllers.

Start with [bold]hydrotwin run step[/bold]: plant, controller and recorder run as three processes, and leave a
recording, a picture and a summary. [bold]hydrotwin scenarios[/bold] lists what else there is to run.
Exit codes: 0 good, 1 the run or a check failed, 2 usage error.
"""


SIGNED = ("remote",)  # verbs whose arguments may be negative numbers, which look like options


class Commands(MutableMapping[str, Any]):
    """The commands by name, each built when it is looked up."""

    def __init__(self) -> None:
        self._built: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._built:
            self._built[name] = _command(name)
        return self._built[name]

    def __setitem__(self, name: str, command: Any) -> None:
        self._built[name] = command

    def __delitem__(self, name: str) -> None:
        del self._built[name]

    def __contains__(self, name: object) -> bool:
        return name in VERBS

    def __iter__(self) -> Iterator[str]:
        return iter(VERBS)

    def __len__(self) -> int:
        return len(VERBS)


def _command(name: str) -> Any:
    """The command that typer makes of a verb's function. Raises KeyError for an unknown name."""
    panel, place, _ = VERBS[name]
    module, _, function = place.partition(":")
    found = getattr(importlib.import_module(f"bridge.cli.{module}"), function)
    if not isinstance(found, typer.Typer):
        alone = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)
        settings = {"ignore_unknown_options": name in SIGNED}
        alone.command(name, cls=VerbCommand, rich_help_panel=panel, context_settings=settings)(found)
        found = alone
    return typer.main.get_command(found)


def _answered(option: Any) -> Any:
    """The option --help with a plain "no" for its absence: typer would import pydantic to make one of nothing."""
    if option is not None:
        option.default = False
    return option


class VerbCommand(TyperCommand):
    """A verb ready to run."""

    def get_help_option(self, ctx: Any) -> Any:
        """The option --help."""
        return _answered(super().get_help_option(ctx))


class VerbGroup(TyperGroup):
    """Help lists the verbs from their table; a command is built when it is to be run."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes)
        self.commands = Commands()

    def get_help_option(self, ctx: Any) -> Any:
        """The option --help."""
        return _answered(super().get_help_option(ctx))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """What help and completion show of a verb."""
        verb = VERBS.get(cmd_name)
        return verb and TyperCommand(cmd_name, callback=None, help=verb.words, rich_help_panel=verb.panel)

    def list_commands(self, ctx: Any) -> list[str]:
        """Every verb, in the order of the help."""
        return list(VERBS)

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:
        """The verb that the arguments begin with, ready to run."""
        name, found, rest = super().resolve_command(ctx, args)
        return name, self.commands[name] if found and name else found, rest

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Our own options stand before the verb: where there are none, what reads them is not loaded."""
        if not args or args[0].startswith("-"):
            return super().parse_args(ctx, args)
        own, self.params = self.params, []
        try:
            return super().parse_args(ctx, args)
        finally:
            self.params = own


app = typer.Typer(
    cls=VerbGroup, help=HELP, no_args_is_help=True, rich_markup_mode="rich", pretty_exceptions_enable=False
)


def _print_version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        print(f"hydrotwin {version('hydrotwin')}")
        raise typer.Exit


@app.callback()
def _before_the_verb(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    """Nothing is done before the verb, unless the version is asked for."""

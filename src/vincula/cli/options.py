"""Options that several commands share, each written once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import click

Function = TypeVar("Function", bound=Callable[..., Any])
Decorator = Callable[[Function], Function]


def together(*decorators: Callable[[Any], Any]) -> Callable[[Function], Function]:
    """One decorator for several, listed in the order in which help shows them."""

    def decorate(function: Function) -> Function:
        for decorator in reversed(decorators):
            function = decorator(function)
        return function

    return decorate


def once(ctx: click.Context, parameter: click.Parameter, value: tuple[str, ...]) -> str | None:
    """The value of an option that may be given once (click alone would keep the last one silently)."""
    if len(value) > 1:
        raise click.BadParameter("given more than once; write one list with commas", ctx=ctx, param=parameter)
    return value[0] if value else None


def assignments(ctx: click.Context, parameter: click.Parameter, value: tuple[str, ...]) -> dict[str, str]:
    """`name=value` texts as a mapping."""
    result: dict[str, str] = {}
    for text in value:
        name, equals, right = (part.strip() for part in text.partition("="))
        if not (name and equals and right):
            raise click.BadParameter(f"{text!r} is not of the form name=value", ctx=ctx, param=parameter)
        if name in result:
            raise click.BadParameter(f"{name!r} is set twice", ctx=ctx, param=parameter)
        result[name] = right
    return result


file_argument = click.argument("file", metavar="FILE")

set_option = click.option(
    "--set",
    "parameters",
    multiple=True,
    metavar="NAME=VALUE",
    callback=assignments,
    help="Set a declared parameter of the file or example; units are allowed (alpha=1deg). Repeatable.",
)

_side_files_option = click.option(
    "--loops",
    multiple=True,
    metavar="SIDEFILE",
    help="A file beside a URDF file: loops and motors (Gepetto's robot.yaml) or passive joints (SRDF). "
    "Repeatable; without it STEM.yaml, robot.yaml and STEM.srdf beside the file are looked for.",
)

_packages_option = click.option(
    "--package-dir",
    "package_dirs",
    multiple=True,
    metavar="DIR",
    help="A folder of packages, or a package: where package:// and $(find NAME) lead, before "
    "ROS_PACKAGE_PATH and AMENT_PREFIX_PATH. Repeatable.",
)

loops_option = together(_side_files_option, _packages_option)

active_option = click.option(
    "--active",
    multiple=True,
    metavar="A,B|all",
    callback=once,
    help="Motors: joints, joint axes (u1.2) or motor names; replaces the motors of the file. "
    "all: every unlocked joint axis. A name with a comma is quoted.",
)

lock_option = click.option(
    "--lock",
    multiple=True,
    metavar="A,B",
    callback=once,
    help="Joints or axes held still; replaces the locks of the file.",
)

reference_options = together(
    click.option(
        "--reference",
        multiple=True,
        metavar="BODY[@POINT]",
        callback=once,
        help="The body whose motion and forces are asked for; POINT is a site or frame on it, or x,y,z "
        "in the body's axes [m].",
    ),
    click.option(
        "--axes",
        type=click.Choice(["ground", "body"]),
        default=None,
        help="Axes of twist and wrench (default: ground, or what the file says).",
    ),
)

at_option = click.option(
    "--at",
    multiple=True,
    metavar="CONFIG",
    callback=once,
    help="Configuration: name=value,... or a JSON or YAML file, in the units of the model file; "
    "key:NAME is a keyframe. Joints not named keep the value of the file.",
)

ground_option = click.option(
    "--ground",
    multiple=True,
    metavar="BODY",
    callback=once,
    help="See everything from this body, as a foot from the trunk: it is the ground, its axes are the "
    "ground axes.",
)

close_option = click.option(
    "--close",
    "closing",
    is_flag=True,
    help="Close open loops first, near --at; joints named there are held if they can be. What moved is told.",
)

weights_option = click.option(
    "--weights",
    multiple=True,
    metavar="FILE|TEXT|limits",
    callback=once,
    help="A weights file, a text like twist=1,1,1,5,5,5 or limits: 1/limit^2 from the file.",
)

tolerance_option = click.option(
    "--tolerance",
    multiple=True,
    metavar="0.1mm[,0.05deg]",
    callback=once,
    help="Manufacturing tolerance; ranks that it leaves open are reported as doubtful.",
)

convention_option = click.option(
    "--convention",
    type=click.Choice(["invariant", "printed"]),
    default="invariant",
    help="printed: the force numbers as in the paper's tables, for comparing with it only.",
)

viewpoint_option = click.option(
    "--viewpoint",
    type=click.Choice(["efficiency", "accuracy"]),
    default="efficiency",
    help="How to read the numbers: speed and force per motor, or error per motor error.",
)

strict_option = click.option("--strict", is_flag=True, help="Exit with 3 when a rank is not decided.")

json_option = click.option(
    "--json", "as_json", is_flag=True, help="One JSON object on stdout, everything else on stderr."
)

debug_option = click.option("--debug", is_flag=True, expose_value=False, help="Show tracebacks of errors.")

output_options = together(json_option, debug_option)

mechanism_options = together(
    file_argument,
    reference_options,
    at_option,
    lock_option,
    set_option,
    loops_option,
    ground_option,
    tolerance_option,
)

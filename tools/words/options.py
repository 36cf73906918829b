"""The options that several verbs share."""

from typing import Annotated

import typer


def installed_worlds(incomplete: str) -> list[str]:
    """Return the names of worlds that begin with the typed text, for completion in the shell."""
    from skolem.tools.loop import worlds

    return [name for name in worlds.names() if name.startswith(incomplete)]


World = Annotated[
    str,
    typer.Option(
        metavar="NAME",
        autocompletion=installed_worlds,
        help="The kind of world: pybullet, with physics and rendering; symbolic, with the same actions and noise "
        "without them; or one that an installed package brings.",
    ),
]

Raw = Annotated[bool, typer.Option("--raw", help="Show fluents and operations as they are recorded, not in words.")]

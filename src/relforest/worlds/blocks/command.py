"""An action with everything needed to carry it out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from relforest.support.errors import InputError
from relforest.support.options import at_least
from relforest.worlds.blocks.arm import OptionResult
from relforest.worlds.blocks.handling import Handling
from relforest.worlds.blocks.options import done, isolate, move, put, rotate
from relforest.worlds.blocks.simulation import BlocksSimulation


@final
@dataclass(frozen=True, slots=True)
class Command:
    """An option with its arguments."""

    name: str  # {"put", "rotate", "isolate", "move", "done"}
    arguments: tuple[float, ...] = ()  # ids of blocks; x in world units for the second argument of ``"move"``

    def __str__(self) -> str:
        """Return the command as it is written, such as ``put(3, 1)`` or ``move(2, x = -16.7)``."""
        words = [f"{argument:.0f}" for argument in self.arguments]
        if self.name == "move" and len(words) == 2:
            words[1] = f"x = {self.arguments[1]:.1f}".replace("-", "\N{MINUS SIGN}")
        return f"{self.name}({', '.join(words)})" if words else self.name


def run_command(sim: BlocksSimulation, command: Command, handling: Handling) -> OptionResult:
    """Carry out a command from its beginning to its end; ``sim`` is changed in place.

    Raises
    ------
    InputError
        If the option is unknown, the number of arguments is wrong, a block is not on the table, or the target
        is not a finite number. The simulation is then unchanged.
    """
    match command.name, command.arguments:
        case "put", (block, destination):
            return put(sim, _id(block), _id(destination), handling=handling)
        case "rotate", (block,):
            return rotate(sim, _id(block), handling=handling)
        case "isolate", (block,):
            return isolate(sim, _id(block), handling=handling)
        case "move", (block, x):
            return move(sim, _id(block), x, handling=handling)
        case "done", ():
            return done(sim)
    raise InputError(
        "a command is put(block, destination), rotate(block), isolate(block), move(block, x) or done(), "
        f"got {command.name} with arguments {command.arguments}"
    )


def _id(value: object) -> int:
    return at_least("id of a block", value, 0)

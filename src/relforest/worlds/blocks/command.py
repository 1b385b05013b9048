"""An action with everything it needs to be carried out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from relforest.support.errors import InputError
from relforest.support.options import at_least
from relforest.worlds.blocks.options import Noise, OptionResult, done, isolate, move, put, rotate
from relforest.worlds.blocks.overlap import Overlap
from relforest.worlds.blocks.simulation import BlocksSimulation


@final
@dataclass(frozen=True, slots=True)
class Command:
    """An option with its arguments.

    Parameters
    ----------
    name : {"put", "rotate", "isolate", "move", "done"}
    arguments : tuple of float
        Ids of blocks; x in world units for the second argument of ``"move"``.
    """

    name: str
    arguments: tuple[float, ...] = ()


def run_command(sim: BlocksSimulation, command: Command, *, noise: Noise, overlap: Overlap) -> OptionResult:
    """Carry out a command from its beginning to its end.

    Parameters
    ----------
    sim : BlocksSimulation
        Changed in place.
    command : Command
    noise, overlap
        As for the options.

    Raises
    ------
    InputError
        If there is no such option, it takes another number of arguments, a block is not on the table, or the
        target is not a finite number. Nothing happens then.
    """
    match command.name, command.arguments:
        case "put", (block, destination):
            return put(sim, _id(block), _id(destination), noise=noise, overlap=overlap)
        case "rotate", (block,):
            return rotate(sim, _id(block), noise=noise, overlap=overlap)
        case "isolate", (block,):
            return isolate(sim, _id(block), noise=noise, overlap=overlap)
        case "move", (block, x):
            return move(sim, _id(block), x, noise=noise, overlap=overlap)
        case "done", ():
            return done(sim)
    raise InputError(
        "a command is put(block, destination), rotate(block), isolate(block), move(block, x) or done(), "
        f"got {command.name} with the arguments {command.arguments}"
    )


def _id(value: object) -> int:
    return at_least("id of a block", value, 0)

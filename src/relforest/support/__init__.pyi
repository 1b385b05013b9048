from . import (
    errors,
    files,
    front_door,
    jit,
    lettering,
    locks,
    options,
    painting,
    parallel,
    player,
    progress,
    rng,
)

__all__ = [
    "errors",
    "files",
    "front_door",
    "jit",
    "lettering",
    "locks",
    "options",
    "painting",
    "parallel",
    "player",
    "progress",
    "rng",
]

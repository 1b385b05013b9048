from . import (
    errors,
    files,
    front_door,
    jit,
    locks,
    options,
    parallel,
    progress,
    rng,
)

__all__ = [
    "errors",
    "files",
    "front_door",
    "jit",
    "locks",
    "options",
    "parallel",
    "progress",
    "rng",
]

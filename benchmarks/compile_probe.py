"""Learn the corridor twice in one process and print where the CPU time went, as JSON.

The second time everything is compiled, so the difference is what compiling (or loading from the cache) costs.
`bench_compile` starts this script in processes of its own.
"""

from __future__ import annotations

import json
import time


def main() -> None:
    """Import, learn, learn again."""
    start = time.process_time()
    import gymnasium as gym  # noqa: PLC0415 - importing is one of the things that are timed

    from relforest.rl.rpi import SMRFRPI  # noqa: PLC0415

    imported = time.process_time()

    def learn() -> float:
        agent = SMRFRPI(gym.make("relforest/Corridor-v0"), random_state=0).learn(iterations=2, episodes=100)
        if not agent.value_.n_trees:
            raise RuntimeError("no tree was learned, so not all kernels were compiled")
        return time.process_time()

    first = learn()
    second = learn()
    print(json.dumps({"import": imported - start, "first": first - imported, "second": second - first}))


if __name__ == "__main__":
    main()

"""Whether fits in several threads of one process are those of one thread: a check for all estimators.

``python tests/thread_check.py 100`` fits each 100 times in every one of three threads, ``... 100 tree`` only
SMRF trees.
"""

from __future__ import annotations

import itertools
import json
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
from sklearn.svm import LinearSVC
from threadpoolctl import threadpool_info

from relforest import Scenes, SMRFTreeClassifier
from relforest.mil import BagScaler, CovAggClassifier, VolumeCommitteeClassifier, baselines
from relforest.mil.bag_classifier import BagClassifier

N_THREADS = 3
_RNG = np.random.default_rng(0)
_BAGS = [_RNG.normal(size=(_RNG.integers(1, 5), 3)) for _ in range(40)]
_Y = np.arange(40) % 2
for _bag in _BAGS[1::2]:
    _bag[0] = 0.3 * _RNG.normal(size=3) + 1.5
_PLACES = _RNG.uniform(0, 10, size=(40, 3, 2))
_SCENES = Scenes.from_dicts(
    [{"objects": [{"location": place} for place in scene]} for scene in _PLACES.tolist()]
)
_CLOSE = np.linalg.norm(_PLACES[:, 0] - _PLACES[:, 1], axis=1) < 4


def _scores(make: Callable[[int], BagClassifier]) -> Callable[[int], bytes]:
    return lambda seed: make(seed).fit(_BAGS, _Y).decision_function(_BAGS).tobytes()


def _scaled(seed: int) -> bytes:
    return b"".join(bag.tobytes() for bag in BagScaler().fit([bag + seed for bag in _BAGS]).transform(_BAGS))


def _tree(seed: int) -> bytes:
    model = SMRFTreeClassifier(random_state=seed).fit(_SCENES, _CLOSE)
    return json.dumps(model.tree_.to_dict()).encode() + model.predict_proba(_SCENES).tobytes()


# Seed -> the bytes of what was learned.
LEARNERS: dict[str, Callable[[int], bytes]] = {
    "covagg": _scores(lambda seed: CovAggClassifier(random_state=seed)),
    "committee": _scores(
        lambda seed: VolumeCommitteeClassifier(random_state=seed, n_splits=2, n_volumes=4, n_balls=60)
    ),
    "committee in threads": _scores(
        lambda seed: VolumeCommitteeClassifier(random_state=seed, n_splits=2, n_volumes=2, n_jobs=2)
    ),
    "scaler": _scaled,
    "ball": _scores(lambda _: baselines.OptimalBallClassifier()),
    "box": _scores(lambda _: baselines.APRClassifier()),
    "density": _scores(lambda _: baselines.DiverseDensityClassifier(refined=2)),
    "EM": _scores(lambda seed: baselines.EMDDClassifier(random_state=seed, start_bags=1)),
    # Few steps, so that these do not converge and would warn if they were scikit-learn's.
    "MILES": _scores(lambda seed: baselines.MILESClassifier(random_state=seed, max_iter=30)),
    "MI-SVM": _scores(lambda _: baselines.BagMarginSVMClassifier(max_solver_iter=100)),
    "mi-SVM": _scores(lambda _: baselines.InstanceMarginSVMClassifier(max_solver_iter=100)),
    "SI-SVM": _scores(lambda _: baselines.SingleInstanceSVMClassifier(max_solver_iter=100)),
    "tree": _tree,
}


def differences(learn: Callable[[int], bytes], repeats: int) -> list[str]:
    """Return what fits in threads changed: their results, or what belongs to the whole process."""
    expected = [learn(seed) for seed in range(N_THREADS)]
    before = _state_of_process()
    found: list[str] = []

    def repeat(seed: int) -> None:
        for number in range(repeats):
            try:
                if learn(seed) != expected[seed]:
                    found.append(f"seed {seed}, repeat {number}: another result")
            except Exception as error:  # noqa: BLE001  # any error is a difference
                found.append(f"seed {seed}, repeat {number}: {error!r}")

    threads = [threading.Thread(target=repeat, args=(seed,)) for seed in range(N_THREADS)]
    with _neighbour():
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    after = _state_of_process()
    return found + [f"{name} changed" for name, value in before.items() if after[name] != value]


@contextmanager
def _neighbour() -> Iterator[None]:
    """Let scikit-learn's LIBLINEAR, which has one random generator for the process, run in another thread."""
    ended = threading.Event()
    rng = np.random.default_rng(1)
    features = rng.normal(size=(60, 10))
    labels = features[:, 0] > 0.3 * rng.normal(size=60)

    def train() -> None:
        for seed in itertools.takewhile(lambda _: not ended.is_set(), itertools.count()):
            LinearSVC(penalty="l1", dual=False, random_state=seed, max_iter=100_000).fit(features, labels)

    thread = threading.Thread(target=train)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def _state_of_process() -> dict[str, object]:
    pools = [pool for pool in threadpool_info() if pool["user_api"] == "blas"]
    state = np.random.get_state(legacy=False)  # noqa: NPY002  # whether it is left alone
    assert isinstance(state, dict)
    return {
        "number of BLAS threads": [pool["num_threads"] for pool in pools],
        "filters of warnings": list(warnings.filters),
        "NumPy's random state": (state["state"]["key"].tolist(), state["state"]["pos"]),
        "handling of floating point errors": np.geterr(),
    }


if __name__ == "__main__":
    for name in sys.argv[2:] or LEARNERS:
        changed = differences(LEARNERS[name], int(sys.argv[1]))
        sys.stdout.write(f"{name}: {len(changed)} differences {changed[:3]}\n")
        sys.stdout.flush()

"""How the bags of a committee are split."""

from __future__ import annotations

import numpy as np
import pytest
from sklearn.model_selection import StratifiedKFold

from relforest.mil.committee_training import split_bags


@pytest.mark.parametrize(("n_bags", "n_splits"), [(20, 5), (23, 4), (9, 2)])
def test_splits_are_those_of_scikit_learn(n_bags: int, n_splits: int) -> None:
    for seed in range(5):
        positive = np.random.default_rng(seed).permutation(n_bags) < n_bags // 2
        splits = split_bags(positive, n_splits, np.random.default_rng(seed))
        fold_seed = int(np.random.default_rng(seed).integers(2**31))
        expected = StratifiedKFold(n_splits, shuffle=True, random_state=fold_seed).split(positive, positive)

        for (train, test), (train_expected, test_expected) in zip(splits, expected, strict=True):
            assert train.tolist() == train_expected.tolist()
            assert test.tolist() == test_expected.tolist()


def test_a_class_of_one_bag_cannot_be_split() -> None:
    splits = split_bags(np.array([True, False, False]), 5, np.random.default_rng(0))

    assert [[part.tolist() for part in split] for split in splits] == [[[0, 1, 2], [0, 1, 2]]]

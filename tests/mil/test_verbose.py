"""What long fits say while they run."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from sklearn.base import clone

from relforest import Scenes, SMRFTreeClassifier
from relforest.mil import VolumeCommitteeClassifier
from relforest.mil.baselines import (
    BagMarginSVMClassifier,
    DiverseDensityClassifier,
    EMDDClassifier,
    InstanceMarginSVMClassifier,
    MILESClassifier,
    SingleInstanceSVMClassifier,
    tuned,
)
from relforest.support.progress import Stage, listening

RNG = np.random.default_rng(0)
Y = np.arange(12) % 2
BAGS = RNG.normal(size=(12, 2, 2))
BAGS[1::2, 0] += 4
LONG: dict[str, tuple[Any, str]] = {
    "committee": (
        VolumeCommitteeClassifier(random_state=0, n_splits=2, n_volumes=2, n_balls=5),
        "finding volumes of the panel 'parts'",
    ),
    "MILES": (MILESClassifier(random_state=0, max_iter=3), "training a linear machine: passes"),
    "MI-SVM": (BagMarginSVMClassifier(), "training machines: rounds"),
    "mi-SVM": (InstanceMarginSVMClassifier(), "training machines: rounds"),
    "SI-SVM": (SingleInstanceSVMClassifier(), "training a machine"),
    "EM": (EMDDClassifier(random_state=0, max_steps=5), "searching from instances"),
    "density": (DiverseDensityClassifier(refined=1, max_steps=5), "climbing from the best starts"),
}


@pytest.mark.parametrize("name", LONG)
def test_long_fits_report_their_stages(name: str) -> None:
    model, expected = LONG[name]
    heard: list[Stage] = []
    with listening(heard.append):
        clone(model).fit(BAGS, Y)

    assert expected in [stage.name for stage in heard]
    assert all(stage.done is None or stage.total is None or stage.done < stage.total for stage in heard)


@pytest.mark.parametrize("name", LONG)
def test_verbose_fits_print_to_standard_error(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    model = clone(LONG[name][0])
    quiet = model.fit(BAGS, Y).decision_function(BAGS)
    assert capsys.readouterr() == ("", "")

    verbose = model.set_params(verbose=True).fit(BAGS, Y).decision_function(BAGS)
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.endswith("\n")
    assert verbose.tolist() == quiet.tolist()


def test_trees_take_verbose(capsys: pytest.CaptureFixture[str]) -> None:
    scenes = Scenes.from_dicts([{"objects": [{"size": float(size)}]} for size in range(8)])
    model = SMRFTreeClassifier(random_state=0, verbose=True).fit(scenes, [0] * 4 + [1] * 4)

    assert model.get_params()["verbose"] is True
    assert capsys.readouterr().out == ""


def test_a_search_reports_the_settings_done() -> None:
    heard: list[Stage] = []
    search = tuned(SingleInstanceSVMClassifier(), grid="coarse", n_splits=2)
    with listening(heard.append):
        search.fit(BAGS, Y)

    done = [stage for stage in heard if stage.name == "tuning: settings"]
    assert [stage.done for stage in done] == list(range(20))
    assert len(search.cv_results_["params"]) == done[0].total == 20

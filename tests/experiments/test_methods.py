from __future__ import annotations

from dataclasses import fields
from pkgutil import resolve_name
from typing import get_args

from relforest.cli.learn import LearnOptions
from relforest.experiments.methods import METHODS
from relforest.experiments.run_config import RunConfig
from relforest.experiments.tasks import TASKS, MethodName


def test_every_method_has_a_row_and_a_task() -> None:
    assert tuple(METHODS) == get_args(MethodName)
    assert {name for task in TASKS.values() for name in task.pictures} == set(METHODS)


def test_what_a_row_names_exists() -> None:
    for method in METHODS.values():
        assert set(method.options) <= {entry.name for entry in fields(RunConfig)}
        assert method.settings in {None, *(entry.name for entry in fields(LearnOptions))}
        assert all(callable(resolve_name(name)) for name in (method.policy, method.report) if name)

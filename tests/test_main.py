from __future__ import annotations

import builtins
import sys

import pytest

from relforest.__main__ import main


def test_the_command_line_is_run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "argv", ["relforest", "--version"])

    assert main() == 0
    assert capsys.readouterr().out.startswith("relforest ")


def test_an_interrupt_while_it_is_imported_leaves_no_traceback(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as context:
        context.setattr(builtins, "__import__", interrupt)
        code = main()

    assert code == 130

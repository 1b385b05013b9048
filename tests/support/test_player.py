from __future__ import annotations

import json
import re

import pytest

from relforest.support.errors import InputError
from relforest.support.player import player_page

WORLDS = ("relforest.worlds.blocks", "relforest.worlds.keepaway")


def game(title: str = "A game") -> dict[str, object]:
    return {"title": title, "subtitle": "", "episodes": []}


@pytest.mark.parametrize("package", WORLDS)
def test_every_place_is_filled_with_what_is_shared_and_what_is_the_worlds_own(package: str) -> None:
    text = player_page(package, game())

    assert "@@" not in text
    assert "function startPlayer(" in text
    assert re.search(r"^startPlayer\(\{", text, flags=re.MULTILINE)
    assert text.index("--paper") < text.index("</style>")
    assert text.count("<title>A game</title>") == 1


@pytest.mark.parametrize("package", WORLDS)
def test_the_data_are_safe_inside_a_script_and_come_back_whole(package: str) -> None:
    hostile = "</script><!-- @@style@@ \u2028 &amp;"
    text = player_page(package, game(hostile))
    found = re.search(r'<script type="application/json" id="game">(.*?)</script>', text)

    assert found is not None
    assert not set("<>&\u2028") & set(found[1])
    assert json.loads(found[1]) == game(hostile)


def test_numbers_that_are_not_finite_are_refused() -> None:
    with pytest.raises(ValueError, match="Out of range float"):
        player_page(WORLDS[0], {**game(), "score": float("nan")})


def test_an_installation_without_the_page_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pkgutil.get_data", lambda *_: None)

    with pytest.raises(InputError, match=r"episode_player.css is missing from .*: reinstall relforest"):
        player_page(WORLDS[0], game())

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from relforest.models import Model, prediction_table
from relforest.scenes import Scenes
from relforest.sharing import play_page, program_of
from relforest.sharing.page import evaluation_script, scene_document
from relforest.support.errors import InputError
from sharing.shared_models import KINDS, random_cases, random_model, random_scenes

NODE = shutil.which("node")
ANSWER = """
const scenes = JSON.parse(require("fs").readFileSync(0, "utf8"));
const answers = scenes.map(scene => {
  const objects = scene.objects.map(values => values.map(value => value === null ? NaN : value));
  const {trees, scores, shares} = evaluate(objects, scene.arguments);
  const bound = model.says.length > 0 ? trees[0].path[0].found.bound : [];
  const witnesses = bound.filter(place => place >= 0).map(place => scene.ids[place]);
  return {leaf: trees[0].leaf, scores, shares, witnesses};
});
console.log(JSON.stringify(answers));
"""


def run_node(model: Model, scenes: Scenes, folder: Path) -> list[dict[str, Any]]:
    """What the evaluator of the page answers."""
    if NODE is None:
        pytest.skip("Node is not installed, so no JavaScript can be run")
    script = folder / "evaluate.js"
    script.write_text(evaluation_script(program_of(model)) + ANSWER)
    given = json.dumps([scene_document(scene.recoded(model.learned.schema)) for scene in scenes])
    done = subprocess.run([NODE, script], input=given, capture_output=True, text=True, check=True)
    return list(json.loads(done.stdout))


def differences(model: Model, scenes: Scenes, found: list[dict[str, Any]]) -> list[tuple[int, str]]:
    """The scenes whose leaf, witnesses or predictions differ from those of the library, and in what."""
    table = prediction_table(model, scenes)
    shares = model.predictions(scenes).probability
    wrong = [] if len(found) == len(scenes) else [(-1, "number")]
    for scene, answer in enumerate(found):
        row = {name: table[name][scene].as_py() for name in table.column_names}
        numbers = [row["prediction"]] if shares is None else shares[scene].tolist()
        told = answer["scores"] if shares is None else answer["shares"]
        if not np.allclose(told, numbers, rtol=0.0, atol=1e-12):
            wrong.append((scene, "numbers"))
        if "leaf" in row:
            witnesses = [
                str(row[name]) for name in row if name.startswith("witness") and row[name] is not None
            ]
            if row["leaf"] != answer["leaf"]:
                wrong.append((scene, "leaf"))
            if witnesses != answer["witnesses"]:
                wrong.append((scene, "witnesses"))
    return wrong


@pytest.mark.parametrize("kind", KINDS)
def test_the_page_predicts_what_the_library_does_with_the_same_witnesses(kind: str, tmp_path: Path) -> None:
    for model, scenes in random_cases(11, kind):
        assert differences(model, scenes, run_node(model, scenes, tmp_path)) == []


def test_the_page_holds_all_it_needs_and_nothing_that_breaks_out_of_it() -> None:
    rng = np.random.default_rng(0)
    model = random_model(rng, "tree", 1)
    scene = random_scenes(rng, "tree", 1, 5)[3]
    page = play_page(program_of(model), scene, title="</title> & co")

    assert "&lt;/title&gt; &amp; co</title>" in page
    assert page.count("</script>") == 2
    assert not any(word in page for word in ("http://", "https://", "@@", "import(", "fetch("))
    assert (
        json.loads(page.split('id="scene">')[1].split("</script>")[0])["ids"] == scene_document(scene)["ids"]
    )


def test_a_page_is_for_a_single_scene() -> None:
    rng = np.random.default_rng(0)
    model = random_model(rng, "tree", 0)

    with pytest.raises(InputError, match="shows a single scene, got 5"):
        play_page(program_of(model), random_scenes(rng, "tree", 0, 5))

"""Try an installed relforest: import, fit, command line, a run. Prints the versions and a digest of all results."""

from __future__ import annotations

import hashlib
import json
import platform
import subprocess
import sys
from importlib.metadata import requires, version
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import relforest as rf
from relforest.datasets import between_scenes
from relforest.worlds.blocks import drop_on_scenes
from relforest.worlds.keepaway import episode_durations

digest = hashlib.sha256()
scenes, labels = between_scenes(np.random.default_rng(0), 100)
for model in (
    rf.SMRFTreeClassifier(random_state=0),
    rf.SMRFBoostingClassifier(n_trees=10, random_state=0),
):
    fitted = model.fit(scenes, labels)
    assert fitted.score(scenes, labels) > 0.8, "a model must fit its training scenes"
    digest.update(fitted.predict_proba(scenes).tobytes())
dropped, rests = drop_on_scenes(np.random.default_rng(0), 20)
digest.update(dropped.matrix.tobytes() + rests.tobytes())
digest.update(episode_durations("hand", episodes=10, seed=0).tobytes())

relforest = Path(sys.executable).with_name("relforest")
subprocess.run([relforest, "--help"], check=True, capture_output=True)
with TemporaryDirectory() as folder:
    command = f"{relforest} learn corridor --episodes 50 --iterations 1 --test-episodes 20 --out {folder}/run"
    subprocess.run(command.split(), check=True, capture_output=True)
    digest.update(Path(folder, "run", "metrics.jsonl").read_bytes())

names = sorted({entry.split(">")[0] for entry in requires("relforest") or () if "extra" not in entry})
versions = {name: version(name) for name in names}
print(f"Python {platform.python_version()} {digest.hexdigest()[:12]} {json.dumps(versions)}")

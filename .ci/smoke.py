"""Try an installed relforest: import, fit, command line, a run. Prints a digest of results, and versions."""

from __future__ import annotations

import hashlib
import json
import platform
import re
import subprocess
import sys
from importlib.metadata import requires, version
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import relforest as rf
from relforest.datasets import between_scenes
from relforest.worlds.blocks import drop_on_scenes

digest = hashlib.sha256()
scenes, labels = between_scenes(np.random.default_rng(0), 100)
model = rf.SMRFTreeClassifier(random_state=0).fit(scenes, labels)
assert model.score(scenes, labels) > 0.8, "a tree must fit its training scenes"
digest.update(model.predict_proba(scenes).tobytes())
dropped, rests = drop_on_scenes(np.random.default_rng(0), 20)
digest.update(dropped.matrix.tobytes() + rests.tobytes())

relforest = Path(sys.executable).with_name("relforest")
subprocess.run([relforest, "--help"], check=True, capture_output=True)
with TemporaryDirectory() as folder:
    command = f"{relforest} learn corridor --episodes 50 --iterations 1 --test-episodes 20 --out {folder}/run"
    subprocess.run(command.split(), check=True, capture_output=True)
    digest.update(Path(folder, "run", "metrics.jsonl").read_bytes())

names = sorted({re.split(r"[<>]", entry)[0] for entry in requires("relforest") or () if "extra" not in entry})
versions = {name: version(name) for name in names}
print(f"Python {platform.python_version()} {digest.hexdigest()[:12]} {json.dumps(versions)}")

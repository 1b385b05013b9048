"""Settings for the whole suite: the same examples on every run, no deadlines, no windows."""

from __future__ import annotations

import os

from hypothesis import settings

# Set before anything imports Matplotlib, and inherited by the commands that tests start.
os.environ["MPLBACKEND"] = "Agg"
# Set before anything imports SciPy: scikit-learn skips a check of estimators without it.
os.environ["SCIPY_ARRAY_API"] = "1"

# A kernel's first call compiles it, and the coverage run interprets it, so no deadline can be fair.
settings.register_profile("relforest", derandomize=True, deadline=None, max_examples=50)
settings.register_profile("interpreted", settings.get_profile("relforest"), max_examples=15)
settings.load_profile("interpreted" if os.environ.get("NUMBA_DISABLE_JIT") == "1" else "relforest")

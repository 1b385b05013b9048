"""Pages in headless Chromium, driven by a script that is put into them; skipped where it is missing."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from html import unescape
from pathlib import Path
from typing import Any

import pytest

_BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
_OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--no-first-run",
    "--disable-sync",
    "--disable-extensions",
)
_TOLD = re.compile(r'<pre id="told">(.*?)</pre>', re.DOTALL)


def told_by(page: str, script: str, folder: Path) -> Any:
    """Return what a function body says after the scripts of a page; no script may have failed."""
    if _BROWSER is None:
        pytest.skip("Chromium is not installed, so no page can be opened")
    driver = (
        f"<script>{{ const told = (() => {{ {script} }})(); const pre = document.createElement('pre'); "
        "pre.id = 'told'; pre.textContent = JSON.stringify(told); document.body.append(pre); }</script>"
    )
    path = folder / "page.html"
    path.write_text(page.replace("</body>", f"{driver}</body>"), encoding="utf-8")
    own = f"--user-data-dir={folder / 'profile'}"
    command = [
        _BROWSER,
        *_OPTIONS,
        own,
        "--enable-logging=stderr",
        "--virtual-time-budget=2000",
        "--dump-dom",
    ]
    done = subprocess.run([*command, path.as_uri()], capture_output=True, text=True, check=True, timeout=120)
    assert "Uncaught" not in done.stderr
    (told,) = _TOLD.findall(done.stdout)
    return json.loads(unescape(told))

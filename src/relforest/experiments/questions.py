"""The question that each study answers, by its name; importing it loads no study."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

QUESTIONS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "covagg": "Does covariant aggregation reach the published scores?",
        "mil": "How does covariant aggregation compare with other MIL methods?",
        "concepts": "Do SMRF trees recover known concepts, also in larger scenes?",
        "calibration": "How often does each test accept a question about noise?",
        "mil_ablation": "What does each part of a committee of volumes contribute?",
        "corridor": "How fast does SMRF-RPI learn, and what do densities add?",
        "keepaway": "Do games and learning match RoboCup 2-D, and how fast are they?",
        "blocks": "Does our blocks world match the author's, and which policies work?",
        "resume": "Does a run that is killed and restarted end with the same bytes?",
    }
)

"""All studies by name; a new one is added here."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final

from relforest.experiments import (
    blocks,
    calibration,
    concepts,
    corridor,
    covagg,
    keepaway,
    mil,
    mil_ablation,
    resume,
)
from relforest.experiments.questions import QUESTIONS
from relforest.experiments.study import Study

_ALL: Final[tuple[Study[Any], ...]] = (
    Study(
        "covagg",
        QUESTIONS["covagg"],
        covagg.SETTINGS,
        covagg.SMOKE,
        covagg.compute,
        covagg.summarize,
        covagg.figures,
    ),
    Study(
        "mil",
        QUESTIONS["mil"],
        mil.SETTINGS,
        mil.SMOKE,
        mil.compute,
        mil.summarize,
        mil.figures,
        compiles=False,
        choices=mil.CHOICES,
        obstacles=mil.obstacles,
    ),
    Study(
        "concepts",
        QUESTIONS["concepts"],
        concepts.SETTINGS,
        concepts.SMOKE,
        concepts.compute,
        concepts.summarize,
        concepts.figures,
    ),
    Study(
        "calibration",
        QUESTIONS["calibration"],
        calibration.SETTINGS,
        calibration.SMOKE,
        calibration.compute,
        calibration.summarize,
        calibration.figures,
    ),
    Study(
        "mil_ablation",
        QUESTIONS["mil_ablation"],
        mil_ablation.SETTINGS,
        mil_ablation.SMOKE,
        mil_ablation.compute,
        mil_ablation.summarize,
        mil_ablation.figures,
        choices=mil_ablation.CHOICES,
        obstacles=mil_ablation.obstacles,
    ),
    Study(
        "corridor",
        QUESTIONS["corridor"],
        corridor.SETTINGS,
        corridor.SMOKE,
        corridor.compute,
        corridor.summarize,
        corridor.figures,
        learned=corridor.learned,
    ),
    Study(
        "keepaway",
        QUESTIONS["keepaway"],
        keepaway.SETTINGS,
        keepaway.SMOKE,
        keepaway.compute,
        keepaway.summarize,
        keepaway.figures,
    ),
    Study(
        "blocks",
        QUESTIONS["blocks"],
        blocks.SETTINGS,
        blocks.SMOKE,
        blocks.compute,
        blocks.summarize,
        blocks.figures,
        compiles=False,
    ),
    Study(
        "resume",
        QUESTIONS["resume"],
        resume.SETTINGS,
        resume.SMOKE,
        resume.compute,
        resume.summarize,
        resume.figures,
        compiles=False,
        choices=resume.CHOICES,
    ),
)

STUDIES: Final[Mapping[str, Study[Any]]] = MappingProxyType({study.name: study for study in _ALL})
"""Name of a study, as the command line has it -> the study."""

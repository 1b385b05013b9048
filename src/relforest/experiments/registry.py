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
from relforest.experiments.study import Study

_ALL: Final[tuple[Study[Any], ...]] = (
    Study(
        "covagg",
        "Does covariant aggregation reach the source's scores on synthetic bags?",
        covagg.SETTINGS,
        covagg.SMOKE,
        covagg.compute,
        covagg.summarize,
        covagg.figures,
    ),
    Study(
        "mil",
        "Does covariant aggregation stand its ground among other multiple-instance methods, as in chapter 3?",
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
        "Do SMRF trees recover known relational concepts, and carry them over to larger scenes?",
        concepts.SETTINGS,
        concepts.SMOKE,
        concepts.compute,
        concepts.summarize,
        concepts.figures,
    ),
    Study(
        "calibration",
        "How often does each test of an expansion accept a question where there is nothing to learn?",
        calibration.SETTINGS,
        calibration.SMOKE,
        calibration.compute,
        calibration.summarize,
        calibration.figures,
    ),
    Study(
        "mil_ablation",
        "What is each part of a committee of volumes good for, on the data that it was designed with?",
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
        "How fast does SMRF-RPI learn the corridor, and what are densities good for?",
        corridor.SETTINGS,
        corridor.SMOKE,
        corridor.compute,
        corridor.summarize,
        corridor.figures,
    ),
    Study(
        "keepaway",
        "Is our keepaway that of the RoboCup 2-D server, is it learned as there, and how fast is it?",
        keepaway.SETTINGS,
        keepaway.SMOKE,
        keepaway.compute,
        keepaway.summarize,
        keepaway.figures,
    ),
    Study(
        "blocks",
        "Is our blocks world that of the author's simulator, and how good are hand-made policies in it?",
        blocks.SETTINGS,
        blocks.SMOKE,
        blocks.compute,
        blocks.summarize,
        blocks.figures,
        compiles=False,
    ),
    Study(
        "resume",
        "Does a run that was killed at any moment and started again end as if nothing had happened?",
        resume.SETTINGS,
        resume.SMOKE,
        resume.compute,
        resume.summarize,
        resume.figures,
        compiles=False,
    ),
)

STUDIES: Final[Mapping[str, Study[Any]]] = MappingProxyType({study.name: study for study in _ALL})
"""Name of a study, as the command line has it -> the study."""

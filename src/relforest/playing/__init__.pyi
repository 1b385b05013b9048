from .frames import Frame, Shown, Stage, Thing
from .page import page
from .painter import paint, picture_shape
from .recorder import Choice, Recording, record_episodes
from .shapes import Chip, Circle, Line, Polygon, Text

__all__ = [
    "Chip",
    "Choice",
    "Circle",
    "Frame",
    "Line",
    "Polygon",
    "Recording",
    "Shown",
    "Stage",
    "Text",
    "Thing",
    "page",
    "paint",
    "picture_shape",
    "record_episodes",
]

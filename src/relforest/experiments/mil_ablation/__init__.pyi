from .analysis import figures, summarize
from .run import compute, obstacles
from .settings import CHOICES, SETTINGS, SMOKE

__all__ = ["CHOICES", "SETTINGS", "SMOKE", "compute", "figures", "obstacles", "summarize"]

from .analysis import figures, summarize
from .run import compute
from .settings import CHOICES, SETTINGS, SMOKE

__all__ = ["CHOICES", "SETTINGS", "SMOKE", "compute", "figures", "summarize"]

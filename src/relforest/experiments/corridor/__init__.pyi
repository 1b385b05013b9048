from .analysis import figures, summarize
from .run import compute, learned
from .settings import SETTINGS, SMOKE

__all__ = ["SETTINGS", "SMOKE", "compute", "figures", "learned", "summarize"]

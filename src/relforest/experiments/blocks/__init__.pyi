from .analysis import summarize
from .pictures import figures
from .run import compute
from .settings import SETTINGS, SMOKE

__all__ = ["SETTINGS", "SMOKE", "compute", "figures", "summarize"]

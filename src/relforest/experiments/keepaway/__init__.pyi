from .analysis import STUDY

__all__ = ["STUDY"]

from .catalogue import catalogue
from .mapping import Mapping
from .operations import OPERATIONS, Operation

__all__ = ["OPERATIONS", "Mapping", "Operation", "catalogue"]

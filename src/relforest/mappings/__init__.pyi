from .catalogue import catalogue
from .mapping import Mapping
from .operations import OPERATIONS, Operation
from .related import Related

__all__ = ["OPERATIONS", "Mapping", "Operation", "Related", "catalogue"]

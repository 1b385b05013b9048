from .mappings import check_mapping
from .worlds import check_world

__all__ = ["check_mapping", "check_world"]

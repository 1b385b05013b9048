from .arc import Arc
from .covagg import Aggregation, aggregate
from .ellipsoid import Ellipsoid
from .objectives import Objective
from .settings import CovAggSettings
from .slab import Slab
from .volume import Volume, volume_from_dict

__all__ = [
    "Aggregation",
    "Arc",
    "CovAggSettings",
    "Ellipsoid",
    "Objective",
    "Slab",
    "Volume",
    "aggregate",
    "volume_from_dict",
]

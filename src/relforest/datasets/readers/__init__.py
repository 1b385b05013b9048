"""Readers of bags in the formats in which multiple-instance data are passed on.

`read_csv` for tables with a column of bag identifiers, `read_arff` for Weka's relational ARFF, `read_c45` for
the ``.data`` files of the UCI repository. Each returns a `BagSet`; what cannot be read is an `InputError`
that names the file, the place and the remedy. Files may be compressed with gzip.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)

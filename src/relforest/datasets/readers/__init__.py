"""Readers of bags in the usual formats of multiple-instance data.

`read_csv` for tables with a column of bag identifiers, `read_arff` for Weka's relational ARFF, `read_c45` for
the ``.data`` files of the UCI repository. Each takes a path or an open file, possibly compressed, and
returns a `BagSet`; an `InputError` names the file, the place and the remedy.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)

"""Readers of bags in the usual file formats of multiple-instance data.

`read_csv` reads tables with a column of bag identifiers, `read_arff` Weka's relational ARFF, and `read_c45`
the ``.data`` files of the UCI repository. Each returns a `BagSet`; a file that cannot be read is an
`InputError` that names the file, the place and the remedy. Files may be compressed with gzip.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)

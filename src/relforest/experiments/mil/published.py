"""What the source reports: mean scores and times of its methods, as printed in its tables.

Means have half the width of their 95 % interval where there was variance, and are NaN where the runs were
aborted; a mark says that covariant aggregation is significantly more or less than this method. The rows of
East-West are left out, as no copy of that data set is at hand.

References
----------
Palmer (2015), Tables 3.2 to 3.4.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Final

from relforest.experiments.sheets import Estimate

_TABLE_32: Final = """
covagg optimal-ball dd em-dd instance-margin-svm bag-margin-svm miles
color              0.93±0.01   >0.88±0.01  >0.88±0.01  >0.88±0.03  >0.78±0.03  <0.95±0.01  >0.86±0.01
covariant1         0.76±0.02   >0.46±0.02  >0.44±0.02  >0.38±0.04  >0.39±0.03  0.73±0.03   >0.24±0.03
covariant2         0.27±0.02   >0.13±0.02  >0.06±0.02  >0.10±0.02  >0.11±0.02  >0.21±0.02  >0.07±0.01
disjunctive        0.27±0.02   <0.33±0.02  <0.31±0.02  >0.19±0.04  <0.62±0.02  0.24±0.06   <0.47±0.03
musk1              0.61±0.18   0.51±0.22   0.71±0.17   0.71±0.19   0.64±0.15   0.60±0.21   0.63±0.12
musk2              0.56±0.11   0.49±0.14   0.58±0.23   0.69±0.15   0.43±0.18   0.49±0.16   0.59±0.19
mutagenesis-atoms  0.54±0.14   0.47±0.19   0.34±0.21   0.20±0.20   >0.00       >0.17±0.15  >0.09±0.15
mutagenesis-bonds  0.46±0.15   0.45±0.20   0.36±0.15   0.35±0.15   >0.00       >0.00       >0.15±0.11
mutagenesis-chains 0.42±0.14   0.31±0.14   0.50±0.18   0.23±0.23   >0.00       0.28±0.15   0.47±0.17
thioredoxin        0.13±0.14   0.30±0.21   0.34±0.28   0.18±0.22   -           -           0.00
elephant           0.46±0.10   0.58±0.12   <0.60±0.09  0.50±0.07   0.58±0.13   <0.71±0.09  <0.66±0.11
fox                0.15±0.09   >-0.06±0.08 0.29±0.13   0.25±0.17   0.12±0.11   0.10±0.13   0.18±0.11
tiger              0.17±0.14   0.23±0.13   <0.47±0.15  <0.44±0.14  <0.58±0.11  <0.66±0.10  <0.52±0.11
"""

_TABLE_33: Final = """
instance-margin-svm-tuned bag-margin-svm-tuned miles-tuned
color              0.92±0.01   <0.95±0.01  >0.90±0.01
covariant1         0.76±0.02   0.78±0.01   0.73±0.02
covariant2         >0.20±0.02  0.22±0.03   >0.22±0.02
disjunctive        <0.65±0.02  <0.35±0.06  <0.56±0.02
"""

_TABLE_34: Final = """
covagg optimal-ball dd em-dd instance-margin-svm bag-margin-svm miles
color              0.47±0.01   <1.18±0.02  <4.23±0.16  <1.34±0.02  <6.04±1.14  0.49±0.02   >0.19±0.00
covariant1         0.57±0.02   <0.92±0.01  <1.77±0.06  <0.85±0.01  <2.96±0.46  >0.20±0.01  >0.15±0.00
covariant2         0.44±0.01   <1.01±0.01  <2.20±0.09  <0.93±0.02  <1.54±0.33  >0.28±0.03  >0.16±0.00
disjunctive        0.44±0.01   <1.31±0.01  <10.9±0.5   <1.47±0.01  <32.6±5.2   <6.22±0.70  <0.58±0.00
musk1              10.2±0.3    >2.25±0.07  <16.6±4.0   <22.5±5.4   >0.56±0.15  >0.43±0.08  >0.32±0.02
musk2              36.0±5.3    >10.6±0.4   <1358±527   <265±111    <4157±1244  <1557±199   <47.1±3.6
mutagenesis-atoms  0.75±0.04   <2.29±0.05  <7.31±0.73  <1.96±0.07  <9.74±1.77  <5.52±0.72  <1.33±0.05
mutagenesis-bonds  1.26±0.08   <4.25±0.10  <32.1±18.1  <3.68±0.46  <309±56     <15.1±1.3   <5.14±0.06
mutagenesis-chains 2.08±0.14   <6.08±0.12  <125±25     <5.43±0.68  <1775±321   <27.4±5.4   <9.30±0.17
thioredoxin        4.21±0.49   <8.56±0.45  <681±68     <14.4±1.7   -           -           <121±2
elephant           24.3±2.9    >4.58±0.13  <219±32     <155±22     <70.0±28.4  >5.46±0.92  >5.04±0.10
fox                16.8±1.5    >4.27±0.04  <126±17     <92.0±34.3  <86.8±26.8  >7.44±1.95  >3.50±0.02
tiger              19.3±2.3    >4.59±0.16  <72.9±14.5  <70.4±20.2  53.5±26.5   >5.71±0.64  >3.47±0.06
"""

_ABORTED: Final = "-"
_CELL: Final = re.compile(r"([<>]?)(-?\d+(?:\.\d+)?)(?:±(\d+(?:\.\d+)?))?")


def _read(*tables: str) -> Mapping[tuple[str, str], Estimate]:
    cells = {}
    for table in tables:
        header, *lines = table.strip("\n").splitlines()
        for line in lines:
            data_set, *texts = line.split()
            for method, text in zip(header.split(), texts, strict=True):
                cells[data_set, method] = _cell(text)
    return cells


def _cell(text: str) -> Estimate:
    if text == _ABORTED:
        return Estimate(math.nan)
    found = _CELL.fullmatch(text)
    if found is None:
        raise AssertionError(text)
    return Estimate(float(found[2]), float(found[3]) if found[3] else None, found[1])


SCORES: Final = _read(_TABLE_32, _TABLE_33)
"""Data set and method -> mean Peirce skill score (Tables 3.2 and 3.3)."""

TIMES: Final = _read(_TABLE_34)
"""Data set and method -> CPU seconds of training and prediction (Table 3.4)."""

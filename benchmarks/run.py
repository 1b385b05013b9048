"""Run all benchmarks, print their tables and save them under ``benchmarks/results``.

Times are CPU times of one thread on this machine, unless a table says otherwise; every ratio compares with a
peer measured in the same run.
"""

from __future__ import annotations

import platform

import bench_blocks
import bench_compile
import bench_covagg
import bench_explaining
import bench_growth
import bench_keepaway
import bench_rpi
import bench_startup
import bench_stream
import bench_tree
import numba
import numpy as np


def main() -> None:
    """Run one benchmark after the other."""
    print(
        f"Python {platform.python_version()}, NumPy {np.__version__}, Numba {numba.__version__}, "
        f"{platform.machine()}, CPU time, one thread"
    )
    for table in bench_covagg.run():
        table.report()
    for table in bench_tree.run():
        table.report()
    bench_explaining.run().report()
    bench_growth.run().report()
    for table in bench_keepaway.run():
        table.report()
    for table in bench_rpi.run():
        table.report()
    bench_blocks.run().report()
    bench_compile.run().report()
    bench_startup.run().report()
    bench_stream.run().report()


if __name__ == "__main__":
    main()

"""One thread for each numerical library, decided before any of them is loaded.

Sums in another order round differently, so the number of threads is part of a run; and two
threads that wait for each other on two busy cores are several times slower than one.
Importing this module is what does it; a person's own setting wins.
"""

import os

VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

for variable in VARIABLES:
    os.environ.setdefault(variable, "1")

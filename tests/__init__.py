"""Tests, with one thread of linear algebra for each worker: small matrices gain nothing from more."""

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

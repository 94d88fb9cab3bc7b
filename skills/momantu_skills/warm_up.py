"""Compile every kernel once, so that no run waits for them: half a minute on one core.

`python -m momantu_skills.warm_up` is quick where the compiled kernels are there already.
"""

from momantu_skills.manipulation import model
from momantu_skills.navigation import warm_up


def compile_kernels() -> None:
    """Compile those of the arm and those of the base into numba's cache."""
    model.compile_kernels()
    warm_up.compile_kernels()


if __name__ == "__main__":
    compile_kernels()

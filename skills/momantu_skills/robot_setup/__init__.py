"""Setting a robot up: what its URDF contains, and what is wrong with its file."""

from momantu_skills.openmp import ensure_openmp

# Every module below may import Pinocchio, and this comes before all of them.
ensure_openmp()

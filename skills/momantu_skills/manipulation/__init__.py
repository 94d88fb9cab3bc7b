"""Arms and hands: model, collisions, planning, grasps, and the planning scene."""

from momantu_skills.openmp import ensure_openmp

# Every module below may import Pinocchio, and this comes before all of them.
ensure_openmp()

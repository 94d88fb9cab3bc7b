"""Arms and hands: model, collision checks, motion planning, grasps, and the planning scene."""

from momantu_skills.openmp import ensure_openmp

# Every module below may import Pinocchio, and this comes before all of them.
ensure_openmp()

"""Arms and hands: model, collisions, planning, grasps, and the planning scene."""

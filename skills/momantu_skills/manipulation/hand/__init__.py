"""The hand: grasps, the gripper, picking up, placing, and the checks of both."""

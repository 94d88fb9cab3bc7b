"""The hand at work: grasps, the gripper, picking up, setting down, and checks of both."""

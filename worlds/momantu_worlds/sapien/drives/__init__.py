"""Drivers of base, joints and gripper, and what they measure."""

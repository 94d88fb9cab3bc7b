"""Run skills and services: one start of a skill, its robot and its actuators, sensor checks."""

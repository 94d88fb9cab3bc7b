"""What each fault does: around the robot, in the site that it gets, and inside skills."""

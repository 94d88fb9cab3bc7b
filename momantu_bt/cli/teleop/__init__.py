"""`momantu-bt teleop`: a person drives a robot with the keyboard of the terminal."""

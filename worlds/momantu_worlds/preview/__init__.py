"""Pictures of a world before anything is run in it: a plan and a view from above."""

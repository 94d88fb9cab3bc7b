"""The channels of a record, a file each: what is written of a run, and when."""

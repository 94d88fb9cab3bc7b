"""The channels of a record, a file each."""

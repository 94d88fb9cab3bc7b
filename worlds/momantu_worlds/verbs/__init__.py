"""Sub-verbs of `momantu-bt worlds` that this package brings; nothing heavy is imported here."""

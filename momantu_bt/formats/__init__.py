"""Basics for all packages: reading and writing files, file formats, and problems in files.

Nothing here depends on trees, robots or worlds, or imports another folder of the framework.
"""

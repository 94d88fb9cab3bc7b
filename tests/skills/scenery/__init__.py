"""Scripted robots and scenes that the tests of skills act in; fixtures make them."""

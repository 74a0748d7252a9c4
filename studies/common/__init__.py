"""Scenes and rows that several studies share."""

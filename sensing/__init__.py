"""Stages 1 and 2: what a robot senses, and which members and obstacles it makes of it.

Remarks on numbers name their source by a letter: P a primary document (data sheet, publication), C published code, S a
secondary page, D derived, ? a choice.
"""

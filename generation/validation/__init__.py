"""Whether environments elicit a behaviour from a group (Fine 2015, section 6.2), and how much of it is theirs.

Every rate stands beside that of the same starts in the empty world: the workspace without the construct.
"""

"""The text of a user's law up to its first statement. For the tests of commands that take one."""

LAW_HEAD = """
import math
from typing import NamedTuple
from flocking.types import Kind, Motion
NEEDS = frozenset({"positions"})
RULES = ("law",)
class Parameters(NamedTuple):
    pass
def law(own, members, sets, obstacles, parameters, memory, u):
"""

"""Stage 4, motion computation: one law a file.

A law's file holds

- a docstring: source, equation, units, what it does with no neighbours, deviations;
- `Parameters`, a NamedTuple annotated with `flocking.parameters.Parameter`; its values are numbers;
- `NEEDS`: what it reads of each member (any of positions, bearings, headings, velocities, ids), of itself (compass,
  goal, contacts) and of the world (obstacles). What a law needs is never nan when it is called: members of which it is
  not known are left out. Only a goal may be nan: a member that has none;
- optionally `MAY_LACK`, those of its needs that a member may lack: it is then told of such a one, with nan for them;
- `RULES`: the names of its rules; `Motion.rule` is an index into them;
- optionally `SETS`, a dict from the name of each set of neighbours to the selection that makes it
  (`flocking.selection`), in which the law's own parameters may stand for numbers; one set of all members if absent;
- optionally `MEMORY` (how many numbers it keeps from call to call, zeros at first) and `DRAWS` (how many uniform random
  numbers in [0, 1) each call is handed). A mirrored world mirrors each draw u to 1 - u;
- optionally `RELATIONS`, a tuple of what must hold between its parameters for it to make sense, in words: NAME, then
  below, at most, above or at least, then another NAME or a number, as in "core_m at most equilibrium_m". Values that
  break one are refused, whether given, for Creates or drawn for a member;
- optionally `CHIRAL` (a mirrored world does not mirror its motion) and `AXIS` (it moves along the world's x axis only);
- optionally `message(own, members, sets, obstacles, parameters) -> Message` and
  `controlled(told, dt, parameters, memory, u) -> Motion`, the two parts of a law that is an
  image process and a controller (`flocking.message`): the controller can then be a process of its own;
- for the laws of the literature `TAXONOMY`, `VALIDATION`, `FILLED` and `HERD` (`flocking.taxonomy`), and `CREATE`, the
  parameter values with which iRobot Creates run it;
- `law(own, members, sets, obstacles, parameters, memory, u) -> Motion`, pure but for `memory` (MEMORY,) that it
  may write to. `sets` is (S, M) bool: which members each selection kept; `u` is (DRAWS,).

What several laws share stands beside this folder (`flocking.terms`, `geometry`, `steps`, `cohesion`) or, where only the
laws of one family share it, in a file here whose name begins with `_`, which is no law. A parameter's unit, source and
bounds may stand there; its name, its place and its default stand in the law.

`flocking.lawentry.load` compiles a law; the same function drives a robot and a member of a kinematic herd.
"""

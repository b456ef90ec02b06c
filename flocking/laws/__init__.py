"""Stage 4, motion computation: one law a file.

A law's file holds

- a docstring: source, equation, units, what it does with no neighbours, deviations;
- `Parameters`, a NamedTuple annotated with `flocking.parameters.Parameter`; its values are numbers;
- `NEEDS`: what it reads of each member: any of positions, bearings, headings, velocities, ids;
- `RULES`: the names of its rules; `Motion.rule` is an index into them;
- optionally `SETS` (names of the sets it selects from, one if absent), `MEMORY` (how many numbers it keeps
  from call to call, zeros at first) and `DRAWS` (how many uniform random numbers in [0, 1) each call is handed);
- `law(own, members, sets, obstacles, parameters, memory, u) -> Motion`, pure but for `memory` (MEMORY,) that it
  may write to. `sets` is (S, M) bool: which members each selection kept; `u` is (DRAWS,).

`flocking.lawentry.load` compiles it; the same function drives a robot and a member of a kinematic herd.
"""

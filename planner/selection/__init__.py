"""Which part a robot takes next, and where it puts it, when parts ride past on belts.

One pure function, `next_part`, ranks the parts that are known, with a rule that the cell names and with tables of the
times in which the robot goes from places to parts and back without obstacles. The planner then plans the first few and
takes the first one that it can prove.
"""

"""The judge: an independent program that evaluates whether answers keep what they promise, ``make soak``.

Plans are judged as they are planned (`promises`), when what is not known is realised (`simulation`), and as answers to
the problems of the benchmark (`problems`); refusals by what contradicts their proofs (`refusals`). All four share one
set of arms, laws, splines and solids, and nothing with planner, checker and scenes: only `product` imports them, to ask
for answers. The rest is written from `docs/request.md`, `docs/conventions.md`, `docs/kinematics.md` and
`docs/guarantees.md`, and works on the two documents. docs/how-it-is-tested.md says what was tried.
"""

"""An oracle: an independent program that checks whether answers keep what they promise, ``make soak``.

It plans random cells of all families of arms and samples each plan as it is planned, densely, with kinematics, laws
and phases of its own and with the distances of `coal`. It asks for many things that are impossible, and tries to show
that a refusal that claims a proof is wrong. Only `product` imports the planner and the scenes. The rest is written from
`docs/request.md`, `docs/conventions.md`, `docs/kinematics.md` and `docs/guarantees.md`, and works on the two
documents. It extends `benchmarks.soak`, which realises what is not known. docs/how-it-is-tested.md says what was tried.
"""

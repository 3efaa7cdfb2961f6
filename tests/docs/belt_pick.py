"""A part is picked from a running belt and placed on a fixed nest; then the arm moves away."""

import assur
from assur.request import (
    AttachedBody,
    Body,
    Box,
    Clearance,
    Conveyor,
    Cylinder,
    Frame,
    Joints,
    Lift,
    Limits,
    Move,
    Options,
    Pick,
    Place,
    PlaceInCell,
    Request,
    Robot,
    Shape,
    Start,
    Step,
    Target,
    Tool,
    Uncertainty,
    deg,
    mm,
)

cup = AttachedBody(name="cup", shape=Shape(cylinder=Cylinder(radius_m=mm(15), height_m=mm(100))), at_m=mm(0, 0, -50))
bed = Body(name="bed", shape=Shape(box=Box(size_m=mm(1400, 300, 50))), pose=PlaceInCell(at_m=mm(0, 350, 25)))
nest = Body(name="nest", shape=Shape(box=Box(size_m=mm(200, 200, 60))), pose=PlaceInCell(at_m=mm(340, -150, 30)))
part = Body(
    name="part",
    shape=Shape(box=Box(size_m=mm(40, 40, 20))),
    pose=PlaceInCell(frame="belt", at_m=mm(-450, 0, 10)),
    mass_kg=0.12,
    yaw_symmetry=4,
)

request = Request(
    robot=Robot(
        model="mitsubishi-rh-6frh5520",
        tool=Tool(tcp_m=mm(0, 0, -100), mass_kg=0.45, bodies=[cup]),
        limits=Limits(acceleration=0.6, j4_rad=deg(-270, 270)),
    ),
    start=Start(joints=Joints(j1_rad=deg(17), j2_rad=deg(68), j3_m=mm(250), j4_rad=0)),
    frames={
        "belt": Frame(
            conveyor=Conveyor(at_m=mm(0, 350, 50), speed_m_s=mm(250)),
            uncertainty=Uncertainty(speed_m_s=mm(2)),
        ),
    },
    bodies=[bed, nest, part],
    task=[
        Step(
            pick=Pick(
                part="part",
                grasp_m=mm(0, 0, 10),
                window_m=mm(-300, 250),
                approach=Lift(m=mm(30)),
                dwell_s=0.08,
                depart=Lift(m=mm(40)),
            )
        ),
        Step(
            place=Place(
                part="part",
                to=Target(at_m=mm(340, -150, 70), yaw_rad=0),
                approach=Lift(m=mm(20)),
                dwell_s=0.06,
                depart=Lift(m=mm(30)),
                contact_with=["nest"],
            )
        ),
        Step(move=Move(to=Target(at_m=mm(350, 0, 120)))),
    ],
    options=Options(stop="first", budget_s=20, clearance_m=Clearance(travel=mm(8), near=mm(1.5))),
)

answer = assur.plan(request)
if not answer.planned:
    raise SystemExit(answer.sentence)
assert assur.check(request, answer)["ok"]

for arrival in answer.arrivals:
    print(f"{arrival['control_point']} at {arrival['time_s']:.3f} s")
motion = answer.trajectory.sample(0.004)
fastest = abs(motion.velocities).max(axis=0)
print(dict(zip(motion.joint_names, fastest.round(2).tolist(), strict=True)))

//! Applied forces, ground that moves, several surfaces and friction by place, from bytes.

use tumble::real::Vector;
use tumble::{
    AirDrag, Block, ConstantForce, Coulomb, Force, FrictionField, FrictionPatch, Ground,
    GroundMotion, Motion, MovingGround, NoForce, Plane, Real, Region, SpinDrag, SpinLift,
    SpringDamper, Wind, Wrench,
};

use super::input::Input;
use super::parts::{AnyFriction, AnyGround};

/// An applied force behind a pointer.
pub type AnyForce<R> = Box<dyn Force<R>>;

/// A drive: a thrust along an axis of the body.
struct Thrust<R: Real> {
    /// N, body axes.
    thrust: R::Vec3,
}

impl<R: Real> Force<R> for Thrust<R> {
    fn wrench(&self, motion: &Motion<R>) -> Wrench<R> {
        Wrench::of_force(motion.axes.to_world(self.thrust))
    }
    fn is_passive(&self) -> bool {
        false
    }
}

fn drag<R: Real>(input: &mut Input<'_>) -> AirDrag<R> {
    AirDrag {
        linear: input.size(1e-3, 1e2),
        quadratic: input.size(1e-3, 1e2),
    }
}

fn lift<R: Real>(input: &mut Input<'_>) -> SpinLift<R> {
    SpinLift {
        radius: input.size(1e-2, 1.0),
        density: input.size(1e-2, 1e2),
        slope: input.size(0.1, 2.0),
        limit: input.size(0.1, 2.0),
    }
}

/// A force of any kind.
pub fn force<R: Real>(input: &mut Input<'_>) -> AnyForce<R> {
    match input.below(9) {
        0 | 1 => Box::new(drag(input)),
        2 => Box::new(SpinDrag {
            linear: input.size::<R>(1e-4, 1.0),
            quadratic: input.size(1e-4, 1.0),
        }),
        3 => Box::new(lift(input)),
        4 => Box::new(Wind {
            velocity: input.vector::<R>(0.1, 30.0),
            force: (drag(input), lift(input)),
        }),
        5 => Box::new(ConstantForce::<R> {
            force: input.vector::<R>(1e-2, 1e2),
        }),
        6 => Box::new(Thrust::<R> {
            thrust: input.vector::<R>(1e-2, 1e2),
        }),
        7 => {
            let (first, second) = (force::<R>(input), force::<R>(input));
            Box::new((first, second))
        }
        _ => Box::new(NoForce),
    }
}

/// Ground whose material moves by any velocity and angular velocity, or along a level plane.
pub fn moving<R: Real>(ground: AnyGround<R>, input: &mut Input<'_>) -> AnyGround<R> {
    match input.below(3) {
        0 => {
            let velocity = input.vector::<R>(1e-2, 10.0);
            let along = R::Vec3::new(velocity.x(), velocity.y(), R::ZERO);
            Box::new(MovingGround::conveyor(ground, along))
        }
        1 => {
            let centre = input.vector::<R>(1e-2, 1.0);
            let rate = input.signed(1e-2, 1e2);
            Box::new(MovingGround::turntable(ground, centre, rate))
        }
        _ => {
            let motion = GroundMotion {
                velocity: input.vector::<R>(1e-2, 10.0),
                angular_velocity: input.vector::<R>(1e-2, 10.0),
            };
            Box::new(MovingGround { ground, motion })
        }
    }
}

/// Ground with walls and a block beside it.
pub fn beside_walls<R: Real>(ground: AnyGround<R>, input: &mut Input<'_>) -> AnyGround<R> {
    let law = SpringDamper {
        stiffness: input.size::<R>(1e2, 1e6),
        damping: input.size(1e-2, 1e2),
    };
    let walls: Vec<_> = (0..input.below(4))
        .map(|_| Ground {
            law,
            shape: Plane::through(input.vector::<R>(1e-2, 1.0), input.vector::<R>(0.1, 1.0)),
        })
        .collect();
    if input.flag() {
        return Box::new((ground, walls.into_boxed_slice()));
    }
    let shape = Block {
        centre: input.vector::<R>(1e-2, 1.0),
        half: R::Vec3::new(
            input.size(1e-3, 1.0),
            input.size(1e-3, 1.0),
            input.size(1e-3, 1.0),
        ),
    };
    Box::new((ground, walls.into_boxed_slice(), Ground { law, shape }))
}

/// Friction by position: a field of any coefficients, or a patch of another law.
pub fn by_place<R: Real>(outside: AnyFriction<R>, input: &mut Input<'_>) -> AnyFriction<R> {
    let [here, there] = [0; 2].map(|_| input.size::<R>(1e-2, 2.0));
    let slip_speed = input.size::<R>(1e-9, 1e-1);
    let edge = input.signed::<R>(1e-3, 1.0);
    if input.flag() {
        let law_at = move |position: R::Vec3| Coulomb {
            coefficient: if position.x() < edge { here } else { there },
            slip_speed,
        };
        return Box::new(FrictionField::new(law_at));
    }
    Box::new(FrictionPatch {
        outside,
        inside: Coulomb {
            coefficient: here,
            slip_speed,
        },
        region: Region::Ball {
            centre: R::Vec3::new(edge, R::ZERO, R::ZERO),
            radius: there,
        },
    })
}

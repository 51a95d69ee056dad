//! A step in parts, for where Newton's method does not find the whole: friction and dampers for half the step, springs and inertia for the step,
//! friction and dampers for the other half.
//!
//! The first and the last part stand still and only take energy ([`resist`](super::resist)); the middle one is the step's own solver on a scene without friction and dampers, whose
//! equations are those of a gradient.

use super::contacts::Contacts;
use super::newton;
use super::problem::Problem;
use super::resist::{Resisting, resisted};
use crate::body::MassProperties;
use crate::friction::{Frictionless, SlidingFriction};
use crate::ground::{Extent, SpringDamperGround, Surface};
use crate::integrator::Step;
use crate::real::{Real, Vector};
use crate::scene::Dynamics;
use crate::state::State;

/// The step, or `None` where its conservative part is not found either.
pub(super) fn step<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &State<R>,
    seconds: R,
    contacts: &mut Contacts<R>,
    step: &mut Step<R>,
) -> Option<State<R>> {
    let half = seconds * R::HALF;
    let slowed = dissipate(scene, start, half);
    let conservative = Conservative {
        scene,
        ground: Springs(scene.ground()),
        friction: Frictionless,
    };
    let problem = Problem::new(&conservative, &slowed, seconds);
    super::gather(&problem, contacts, true);
    let (trial, _) = newton::solve(&problem, contacts, step)?;
    let moved = problem.end_of(&trial);
    let end = dissipate(scene, &moved, half);
    end.not_finite().is_none().then_some(end)
}

/// Friction and dampers on a body that stands still, for a time: each contact resists by what its law gives at its velocity.
fn dissipate<R: Real, D: Dynamics<R>>(scene: &D, state: &State<R>, seconds: R) -> State<R> {
    let (ground, friction) = (scene.ground(), scene.friction());
    let reach = scene.reach().at_least(R::EPSILON);
    resisted(scene, reach, state, |motion, resist| {
        scene.visit_contacts(motion, |contact| {
            let normal_force = ground.normal_force(contact.depth, contact.closing_speed);
            let damper = normal_force - ground.spring_force(contact.depth);
            resist(&Resisting {
                place: contact.arm,
                normal: contact.normal,
                along: friction.force(normal_force, contact.slip).length() * seconds,
                across: damper.abs() * seconds,
            });
        });
    })
}

/// A scene without what takes energy.
struct Conservative<'a, D, G> {
    scene: &'a D,
    ground: G,
    friction: Frictionless,
}

impl<R: Real, D: Dynamics<R>, G: SpringDamperGround<R>> Dynamics<R> for Conservative<'_, D, G> {
    type Body = D::Body;
    type Ground = G;
    type Friction = Frictionless;

    fn body(&self) -> &D::Body {
        self.scene.body()
    }
    fn ground(&self) -> &G {
        &self.ground
    }
    fn friction(&self) -> &Frictionless {
        &self.friction
    }
    fn gravity(&self) -> R::Vec3 {
        self.scene.gravity()
    }
    fn mass_properties(&self) -> &MassProperties<R> {
        self.scene.mass_properties()
    }
    fn reach(&self) -> R {
        self.scene.reach()
    }
    fn has_radii(&self) -> bool {
        self.scene.has_radii()
    }
}

/// The springs of a ground alone.
struct Springs<'a, G>(&'a G);

impl<R: Real, G: SpringDamperGround<R>> SpringDamperGround<R> for Springs<'_, G> {
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        self.0.surface(point)
    }
    fn spring_force(&self, depth: R) -> R {
        self.0.spring_force(depth)
    }
    fn spring_energy(&self, depth: R) -> R {
        self.0.spring_energy(depth)
    }
    fn normal_force(&self, depth: R, _closing_speed: R) -> R {
        self.0.spring_force(depth)
    }
    fn extent(&self) -> Extent<R> {
        self.0.extent()
    }
}

//! Body, ground, friction and gravity together: which contacts touch, and with what force and
//! torque.

mod checked;
mod level;
mod rims;

pub(crate) use checked::{CheckedScene, Record};
use rims::Touching;
pub(crate) use rims::{Kinks, Velocities, arc_below, kinks};

use crate::body::{ContactPoint, ContactRange, InertiaProperties, RigidPointBody};
use crate::error::{self, SceneError};
use crate::friction::SlidingFriction;
use crate::gravity::Gravity;
use crate::ground::{GroundBounds, SpringDamperGround};
use crate::real::{Real, Vector};
use crate::rotation::Axes;
use crate::state::State;

// On the hints below: a step is compiled as one piece, so that it need not go through memory from
// stage to stage. The loop over contacts as a function of its own took 8 % fewer instructions and
// 1.2 to 1.8 times as long.

/// A body on a ground, as an integrator sees it.
///
/// *To the author of an integrator:* [`motion`](Self::motion) turns a state into what forces depend
/// on, [`load`](Self::load) gives the contacts' force and torque there,
/// [`visit_contacts`](Self::visit_contacts) each contact by itself. Gravity stands apart, because
/// it needs no contact. A method that keeps the contacts of its last look in its workspace finds
/// them sooner by [`contacts_near`](Self::contacts_near), and takes their load by
/// [`load_on`](Self::load_on).
pub trait Dynamics<R: Real = f64> {
    /// The body's type.
    type Body: RigidPointBody<R>;
    /// The ground's type.
    type Ground: SpringDamperGround<R>;
    /// The friction law's type.
    type Friction: SlidingFriction<R>;

    /// The body.
    fn body(&self) -> &Self::Body;
    /// The ground.
    fn ground(&self) -> &Self::Ground;
    /// The friction law.
    fn friction(&self) -> &Self::Friction;
    /// Acceleration of gravity, m/s², world axes.
    fn gravity(&self) -> R::Vec3;
    /// Mass and inertia of the body.
    fn inertia_properties(&self) -> &InertiaProperties<R>;
    /// Distance from the centre of mass to the farthest place of the body's surface, m.
    fn bounding_radius(&self) -> R;

    /// Whether any contact of the body has a radius or wanders over a smooth surface: whether the
    /// force acts elsewhere than at the contact's own position.
    fn has_radii(&self) -> bool {
        let mut contacts = self.body().contacts().iter();
        self.body().is_smooth() || contacts.any(|contact| contact.radius > R::ZERO)
    }

    /// Evaluates laws where the motion does not: a value that breaks a contract there is no error
    /// of the step.
    #[doc(hidden)]
    #[inline(always)]
    fn probe<T>(&self, evaluate: impl FnOnce() -> T) -> T {
        evaluate()
    }

    /// Where everything of the body is and how it moves.
    #[inline(always)]
    fn motion(&self, state: &State<R>) -> Motion<R> {
        self.motion_along(state, state.rotation().axes())
    }

    /// As [`motion`](Self::motion), for an integrator that knows the state's axes.
    #[inline(always)]
    fn motion_along(&self, state: &State<R>, axes: Axes<R>) -> Motion<R> {
        Motion {
            position: state.position,
            axes,
            linear_velocity: state.linear_velocity,
            angular_velocity: self
                .inertia_properties()
                .angular_velocity(&axes, state.angular_momentum),
        }
    }

    /// The contacts that may lie less than `margin` (m) above the ground: none that does is
    /// missing, and in flight none is visited to find out.
    #[inline]
    fn contacts_within(&self, margin: R, position: R::Vec3, axes: &Axes<R>) -> ContactRange {
        low_contacts(self, margin, position, axes, |normal, offset| {
            self.body().contacts_below(normal, offset)
        })
    }

    /// The contacts that may touch, as of [`contacts_within`](Self::contacts_within) with no
    /// margin, found sooner by a caller who knows those of a moment ago. Whatever `near` is, the
    /// answer is the same.
    #[inline(always)]
    fn contacts_near(&self, near: ContactRange, position: R::Vec3, axes: &Axes<R>) -> ContactRange {
        low_contacts(self, R::ZERO, position, axes, |normal, offset| {
            self.body().contacts_below_near(normal, offset, near)
        })
    }

    /// Calls `visit` with each contact that touches, in the order of their run round the body.
    #[inline(always)]
    fn visit_contacts(&self, motion: &Motion<R>, visit: impl FnMut(&Contact<R>)) {
        let run = self.contacts_within(R::ZERO, motion.position, &motion.axes);
        self.visit_run(run, motion, visit);
    }

    /// As [`visit_contacts`](Self::visit_contacts), looking at the contacts of `run` alone.
    #[inline(always)]
    fn visit_run(&self, run: ContactRange, motion: &Motion<R>, mut visit: impl FnMut(&Contact<R>)) {
        visit_points(self, run, motion, &mut visit);
        if !self.body().rims().is_empty() {
            self.visit_rims(motion, visit);
        }
    }

    /// As [`visit_contacts`](Self::visit_contacts), of the places that stand for the rims alone.
    #[inline(always)]
    fn visit_rims(&self, motion: &Motion<R>, mut visit: impl FnMut(&Contact<R>)) {
        for rim in self.body().rims() {
            match Touching::of(self, rim, motion) {
                Touching::Nothing => {}
                Touching::Arc(sweep) => {
                    sweep.visit(|node| visit(&sweep.contact(rim, &motion.axes, node)));
                }
                Touching::Any => rims::visit_any(self, rim, motion, &mut visit),
            }
        }
    }

    /// Force and torque of all contacts; gravity not included.
    ///
    /// The sums are those of [`visit_contacts`](Self::visit_contacts) but for rounding: the torque
    /// of bare points on a level plane comes from other sums, in another fixed order.
    #[inline(always)]
    fn load(&self, motion: &Motion<R>) -> Load<R> {
        let run = self.contacts_within(R::ZERO, motion.position, &motion.axes);
        self.load_on(run, motion)
    }

    /// As [`load`](Self::load), looking at the contacts of `run` alone: for a second look at the
    /// same place with other velocities.
    #[inline(always)]
    fn load_on(&self, run: ContactRange, motion: &Motion<R>) -> Load<R> {
        load_with_arms(self, run, motion, None)
    }
}

#[inline(always)]
fn low_contacts<R: Real, D: Dynamics<R> + ?Sized>(
    scene: &D,
    margin: R,
    position: R::Vec3,
    axes: &Axes<R>,
    below: impl FnOnce(R::Vec3, R) -> ContactRange,
) -> ContactRange {
    match scene.ground().bounds() {
        GroundBounds::Nowhere => ContactRange::NONE,
        GroundBounds::Everywhere => ContactRange::all(scene.body().contacts().len()),
        GroundBounds::Plane(plane) | GroundBounds::Below(plane) => {
            let (gap, normal) = if plane.is_level() {
                (position.z() - plane.height, axes.rise())
            } else {
                (plane.gap(position), axes.to_body(plane.normal))
            };
            // What rounding may hide of a gap; far more than the body's own arithmetic loses.
            let rounding = (gap.abs() + plane.height.abs() + scene.bounding_radius())
                * (R::EPSILON * R::from_f64(8.0));
            let offset = margin + rounding - gap;
            if offset < -scene.bounding_radius() {
                ContactRange::NONE
            } else {
                below(normal, offset)
            }
        }
    }
}

/// As [`Dynamics::visit_run`], of the contacts of the body alone, without those that stand for a
/// rim.
#[inline(always)]
pub(crate) fn visit_points<R: Real, D: Dynamics<R> + ?Sized>(
    scene: &D,
    run: ContactRange,
    motion: &Motion<R>,
    visit: &mut impl FnMut(&Contact<R>),
) {
    let contacts = scene.body().contacts();
    // One loop for both parts of a run that begins again at the first contact, so that `visit` is
    // compiled once.
    let mut ahead = contacts.get(run.first..).unwrap_or_default().iter();
    for _ in 0..run.count.min(contacts.len()) {
        let Some(point) = ahead.next().or_else(|| {
            ahead = contacts.iter();
            ahead.next()
        }) else {
            break;
        };
        if let Some(contact) = Contact::at(scene.body(), scene.ground(), motion, point) {
            visit(&contact);
        }
    }
}

/// The energy in the springs, J, and how many contacts touch.
#[inline]
pub(crate) fn spring_energy<R: Real, D: Dynamics<R> + ?Sized>(
    scene: &D,
    motion: &Motion<R>,
) -> (R, usize) {
    let (mut energy, mut touching) = (R::ZERO, 0);
    let run = scene.contacts_within(R::ZERO, motion.position, &motion.axes);
    visit_points(scene, run, motion, &mut |contact: &Contact<R>| {
        energy += scene.ground().spring_energy(contact.depth);
        touching += 1;
    });
    let (of_rims, places) = rims_energy(scene, motion);
    (energy + of_rims, touching + places)
}

/// The energy in the springs under the rims, J, and how many places stand for what touches of them.
///
/// It is that of a body at rest in the same place: where the quadrature of a rim is cut for its
/// forces depends on its velocities, and an energy of places must not.
#[inline]
pub(crate) fn rims_energy<R: Real, D: Dynamics<R> + ?Sized>(
    scene: &D,
    motion: &Motion<R>,
) -> (R, usize) {
    let (mut energy, mut touching) = (R::ZERO, 0);
    for rim in scene.body().rims() {
        let at_rest = Motion {
            linear_velocity: R::Vec3::ZERO,
            angular_velocity: R::Vec3::ZERO,
            ..*motion
        };
        let (stored, places) = rims::spring_energy(scene, rim, &at_rest);
        energy += stored;
        touching += places;
    }
    (energy, touching)
}

/// As [`Dynamics::load_on`]; with other `arm_axes`, the torque that the same forces have on a body
/// with those.
#[inline(always)]
pub(crate) fn load_with_arms<R: Real, D: Dynamics<R> + ?Sized>(
    scene: &D,
    run: ContactRange,
    motion: &Motion<R>,
    arm_axes: Option<&Axes<R>>,
) -> Load<R> {
    if run.count == 0 && (scene.body().rims().is_empty() || is_aloft(scene, motion)) {
        return Load::default();
    }
    let mut load = load_of_forces(scene, run, motion, arm_axes);
    if let Some(torque) = turning_torque(scene, run, motion) {
        load.torque += torque;
    }
    load
}

/// Whether a body is so high above a plane that none of it touches.
#[inline]
fn is_aloft<R: Real, D: Dynamics<R> + ?Sized>(scene: &D, motion: &Motion<R>) -> bool {
    match scene.ground().bounds() {
        GroundBounds::Nowhere => true,
        GroundBounds::Plane(plane) | GroundBounds::Below(plane) => {
            plane.gap(motion.position) > scene.bounding_radius()
        }
        GroundBounds::Everywhere => false,
    }
}

#[inline(always)]
fn load_of_forces<R: Real, D: Dynamics<R> + ?Sized>(
    scene: &D,
    run: ContactRange,
    motion: &Motion<R>,
    arm_axes: Option<&Axes<R>>,
) -> Load<R> {
    let laws = (scene.ground(), scene.friction());
    let axes = arm_axes.unwrap_or(&motion.axes);
    let mut load = Load::default();
    if let Some(height) = height_under_bare_points(scene) {
        let parts = run.parts(scene.body().contacts());
        load = level::load(laws, height, parts, motion, arm_axes);
        for rim in scene.body().rims() {
            match Touching::of(scene, rim, motion) {
                Touching::Nothing => {}
                Touching::Arc(sweep) => sweep.load(scene, rim, axes, &mut load),
                Touching::Any => rims::visit_any(scene, rim, motion, &mut |contact| {
                    load.add_along(axes, contact, contact.force(laws.0, laws.1));
                }),
            }
        }
        return load;
    }
    scene.visit_run(run, motion, |contact| {
        load.add_along(axes, contact, contact.force(laws.0, laws.1));
    });
    load
}

/// The height of a ground that is a level plane, if all contacts are bare points of the body.
#[inline(always)]
fn height_under_bare_points<R: Real, D: Dynamics<R> + ?Sized>(scene: &D) -> Option<R> {
    match scene.ground().bounds() {
        GroundBounds::Plane(plane) if !scene.has_radii() && plane.is_level() => Some(plane.height),
        _ => None,
    }
}

/// Torque of the contacts of `run` against the body's turning, N m, where the friction law resists
/// it.
#[inline(always)]
pub(crate) fn turning_torque<R: Real, D: Dynamics<R> + ?Sized>(
    scene: &D,
    run: ContactRange,
    motion: &Motion<R>,
) -> Option<R::Vec3> {
    scene.friction().rolling_resistance(R::ZERO)?;
    let mut sum = R::Vec3::ZERO;
    scene.visit_run(run, motion, |contact| {
        sum += contact.turning_torque(scene.ground(), scene.friction(), motion.angular_velocity);
    });
    Some(sum)
}

/// How far the body reaches from its centre of mass, m, for whoever turns an angle into a way: its
/// reach, or the radius of gyration `√(largest moment/mass)` where that is more.
///
/// A body without contacts has no reach of its own. But it has mass at that radius or beyond.
#[inline]
pub(crate) fn size<R: Real, D: Dynamics<R> + ?Sized>(scene: &D) -> R {
    scene
        .bounding_radius()
        .at_least(scene.inertia_properties().radius_of_gyration())
}

/// Where everything of a body is and how it moves, in world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<R: Real = f64> {
    /// Centre of mass, m.
    pub position: R::Vec3,
    /// The body's axes.
    pub axes: Axes<R>,
    /// Velocity of the centre of mass, m/s.
    pub linear_velocity: R::Vec3,
    /// rad/s.
    pub angular_velocity: R::Vec3,
}

impl<R: Real> Motion<R> {
    /// Velocity (m/s) of the body's material at `arm` (m, world axes, from the centre of mass):
    /// `v + ω × r`.
    #[inline]
    #[must_use]
    pub fn velocity_at(&self, arm: R::Vec3) -> R::Vec3 {
        self.linear_velocity + self.angular_velocity.cross(arm)
    }
}

/// A contact that touches: where, how deep, and how it moves. World axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<R: Real = f64> {
    /// The contact as the body has it.
    pub point: ContactPoint<R>,
    /// From the centre of mass to where the force acts, m.
    pub arm: R::Vec3,
    /// Outward normal of the ground, unit vector.
    pub normal: R::Vec3,
    /// m, above 0.
    pub depth: R,
    /// Speed at which the depth grows, m/s.
    pub closing_speed: R,
    /// Velocity along the surface, m/s.
    pub slip: R::Vec3,
    /// How many contacts of the body it stands for: 1, but for a place of a [`Rim`](crate::Rim).
    pub weight: R,
}

impl<R: Real> Contact<R> {
    /// The contact of `point` with the ground, if it touches.
    #[inline]
    fn at<B: RigidPointBody<R>, G: SpringDamperGround<R>>(
        body: &B,
        ground: &G,
        motion: &Motion<R>,
        point: &ContactPoint<R>,
    ) -> Option<Self> {
        let facing;
        let point = if body.is_smooth() {
            facing = facing_ground(body, ground, motion.position, &motion.axes);
            &facing
        } else {
            point
        };
        Self::of(ground, motion, point, R::ONE)
    }

    /// The contact of a fixed `point` with the ground, if it touches.
    #[inline]
    fn of<G: SpringDamperGround<R>>(
        ground: &G,
        motion: &Motion<R>,
        point: &ContactPoint<R>,
        weight: R,
    ) -> Option<Self> {
        let centre_arm = motion.axes.to_world(point.position);
        let surface = ground.surface(motion.position + centre_arm);
        let depth = point.radius - surface.gap;
        (depth > R::ZERO).then(|| {
            let normal = surface.normal;
            let arm = surface_arm(point, centre_arm, normal);
            let velocity = motion.velocity_at(arm);
            let rising = velocity.dot(normal);
            Self {
                point: *point,
                arm,
                normal,
                depth,
                closing_speed: -rising,
                slip: velocity - normal * rising,
                weight,
            }
        })
    }

    /// Where the arm is when the body has other axes.
    #[inline]
    pub(crate) fn arm_along(&self, axes: &Axes<R>) -> R::Vec3 {
        let centre_arm = axes.to_world(self.point.position);
        surface_arm(&self.point, centre_arm, self.normal)
    }

    /// The ground's force on the body here, normal and friction together, N.
    #[inline]
    pub fn force<G, F>(&self, ground: &G, friction: &F) -> R::Vec3
    where
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        let normal_force = ground.normal_force(self.depth, self.closing_speed);
        (self.normal * normal_force + friction.force(normal_force, self.slip)) * self.weight
    }

    /// The ground's torque on a body that turns (rad/s), beyond that of the force, N m: 0 but for a
    /// law that resists turning.
    #[inline]
    pub fn turning_torque<G, F>(
        &self,
        ground: &G,
        friction: &F,
        angular_velocity: R::Vec3,
    ) -> R::Vec3
    where
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        let normal_force = ground.normal_force(self.depth, self.closing_speed);
        match friction.rolling_resistance(normal_force) {
            Some(resistance) => resistance.torque(self.normal, angular_velocity) * self.weight,
            None => R::Vec3::ZERO,
        }
    }
}

/// The place of a smooth body that faces the ground, as a bare contact of the body as it is turned
/// now: for the normal under the contact that stands for it.
#[inline]
pub(crate) fn facing_ground<R: Real, B: RigidPointBody<R>, G: SpringDamperGround<R>>(
    body: &B,
    ground: &G,
    position: R::Vec3,
    axes: &Axes<R>,
) -> ContactPoint<R> {
    let middle = body.contacts().first().copied().unwrap_or_default();
    let surface = ground.surface(position + axes.to_world(middle.position));
    ContactPoint::bare(body.support_point(axes.to_body(-surface.normal)))
}

/// From the centre of mass to the place of a contact's surface that faces the ground, m, world
/// axes.
#[inline]
fn surface_arm<R: Real>(point: &ContactPoint<R>, centre_arm: R::Vec3, normal: R::Vec3) -> R::Vec3 {
    // A bare point, as most are, needs no arithmetic.
    if point.radius == R::ZERO {
        centre_arm
    } else {
        centre_arm - normal * point.radius
    }
}

/// Force and torque of the ground on the body, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load<R: Real = f64> {
    /// N.
    pub force: R::Vec3,
    /// About the centre of mass, N m.
    pub torque: R::Vec3,
    /// Number of contacts that touch.
    pub touching: usize,
}

impl<R: Real> Load<R> {
    /// One more contact that touches, with its force (N), and its arm when the body has other axes.
    #[inline]
    fn add_along(&mut self, axes: &Axes<R>, contact: &Contact<R>, force: R::Vec3) {
        self.force += force;
        self.torque += contact.arm_along(axes).cross(force);
        self.touching += 1;
    }

    /// One more contact that touches, with its force (N).
    #[inline]
    pub(crate) fn add(&mut self, contact: &Contact<R>, force: R::Vec3) {
        self.force += force;
        self.torque += contact.arm.cross(force);
        self.touching += 1;
    }
}

impl<R: Real> Default for Load<R> {
    #[inline]
    fn default() -> Self {
        Self {
            force: R::Vec3::ZERO,
            torque: R::Vec3::ZERO,
            touching: 0,
        }
    }
}

/// How fast a state changes, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates<R: Real = f64> {
    /// Of the centre of mass, by contacts and gravity, m/s².
    pub acceleration: R::Vec3,
    /// Of the contacts about the centre of mass, N m: the rate of the angular momentum.
    pub torque: R::Vec3,
    /// rad/s.
    pub angular_velocity: R::Vec3,
}

impl<R: Real> Rates<R> {
    /// The rates at a motion of a scene under the load of its contacts.
    #[inline]
    #[must_use]
    pub fn under(load: &Load<R>, scene: &impl Dynamics<R>, motion: &Motion<R>) -> Self {
        Self {
            acceleration: load.force * scene.inertia_properties().inverse_mass() + scene.gravity(),
            torque: load.torque,
            angular_velocity: motion.angular_velocity,
        }
    }
}

/// The lowest point of a body's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowestPoint<R: Real = f64> {
    /// Number of its contact; rims are counted on from the last contact.
    pub index: usize,
    /// m, world axes.
    pub position: R::Vec3,
    /// Height above the ground, m; negative in it.
    pub gap: R,
    /// Velocity of the body's material there, along the surface, m/s.
    pub slip: R::Vec3,
}

impl<R: Real> LowestPoint<R> {
    /// The point of the body's surface that lies lowest above the ground, or deepest in it; `None`
    /// for a body without contacts.
    #[must_use]
    pub fn of(scene: &impl Dynamics<R>, state: &State<R>) -> Option<Self> {
        let motion = scene.motion(state);
        let mut lowest: Option<Self> = None;
        let body = scene.body();
        let mut look_at = |index: usize, point: &ContactPoint<R>| {
            let centre = motion.position + motion.axes.to_world(point.position);
            let surface = scene.ground().surface(centre);
            let gap = surface.gap - point.radius;
            if lowest.is_none_or(|known| gap < known.gap) {
                let position = centre - surface.normal * point.radius;
                let velocity = motion.velocity_at(position - motion.position);
                lowest = Some(Self {
                    index,
                    position,
                    gap,
                    slip: velocity - surface.normal * velocity.dot(surface.normal),
                });
            }
        };
        for (index, point) in body.contacts().iter().enumerate() {
            if body.is_smooth() {
                let facing = facing_ground(body, scene.ground(), motion.position, &motion.axes);
                look_at(index, &facing);
            } else {
                look_at(index, point);
            }
        }
        for (number, rim) in body.rims().iter().enumerate() {
            let (_, place) = rims::lowest(rim, scene.ground(), motion.position, &motion.axes);
            look_at(body.contacts().len() + number, &ContactPoint::bare(place));
        }
        lowest
    }
}

/// Body, ground, friction and gravity, checked, with the body's mass properties worked out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene<R: Real, B, G, F, A> {
    body: B,
    ground: G,
    friction: F,
    gravity: A,
    inertia_properties: InertiaProperties<R>,
    bounding_radius: R,
    has_radii: bool,
}

impl<R, B, G, F, A> Scene<R, B, G, F, A>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    A: Gravity<R>,
{
    /// Composes a scene.
    ///
    /// # Errors
    /// Returns [`SceneError`] if body, ground, friction or gravity is invalid, or if the weight,
    /// the reach, or the inverse of the mass or of a moment of inertia overflows. The error names
    /// the quantity, the rule and the value.
    pub fn new(body: B, ground: G, friction: F, gravity: A) -> Result<Self, SceneError> {
        body.check()?;
        ground.check()?;
        friction.check()?;
        gravity.check()?;
        crate::body::check_contacts(body.contacts())?;
        crate::body::check_rims(&body)?;
        let bounding_radius = body.bounding_radius();
        error::finite("reach of the body", bounding_radius, " m")?;
        error::at_least_zero("reach of the body", bounding_radius, " m")?;
        let inertia_properties = InertiaProperties::new(body.mass(), body.inertia())?;
        let weight = inertia_properties.mass() * gravity.acceleration().length();
        error::finite("weight (mass times gravity)", weight, " N")?;
        if let GroundBounds::Plane(plane) | GroundBounds::Below(plane) = ground.bounds() {
            plane.check()?;
        }
        Ok(Self {
            inertia_properties,
            bounding_radius,
            has_radii: body.is_smooth()
                || (body.contacts().iter()).any(|contact| contact.radius > R::ZERO),
            body,
            ground,
            friction,
            gravity,
        })
    }
}

impl<R: Real, B, G, F, A> Scene<R, B, G, F, A> {
    /// The four parts again.
    pub(crate) fn into_parts(self) -> (B, G, F, A) {
        (self.body, self.ground, self.friction, self.gravity)
    }
}

impl<R, B, G, F, A> Scene<R, B, G, F, A>
where
    R: Real,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
{
    /// Whether a step need not check what the laws return.
    #[inline(always)]
    pub(crate) fn is_trusted(&self) -> bool {
        self.ground.is_trusted() && self.friction.is_trusted()
    }
}

impl<R, B, G, F, A> Dynamics<R> for Scene<R, B, G, F, A>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    A: Gravity<R>,
{
    type Body = B;
    type Ground = G;
    type Friction = F;

    #[inline]
    fn body(&self) -> &B {
        &self.body
    }
    #[inline]
    fn ground(&self) -> &G {
        &self.ground
    }
    #[inline]
    fn friction(&self) -> &F {
        &self.friction
    }
    #[inline]
    fn gravity(&self) -> R::Vec3 {
        self.gravity.acceleration()
    }
    #[inline]
    fn inertia_properties(&self) -> &InertiaProperties<R> {
        &self.inertia_properties
    }
    #[inline]
    fn bounding_radius(&self) -> R {
        self.bounding_radius
    }
    #[inline]
    fn has_radii(&self) -> bool {
        self.has_radii
    }
}

//! Body, ground, friction and gravity together: contacts that touch, with their force and torque.

mod diagnosed;
mod level;
mod rims;
mod screened;

pub(crate) use diagnosed::{DiagnosedScene, Record};
use rims::Touching;
pub(crate) use rims::{Kinks, Velocities, arc_below, kinks};
pub(crate) use screened::{Alarm, ScreenedScene};

use crate::body::{ContactPoint, ContactRange, InertiaProperties, RigidPointBody};
use crate::error::{self, SceneError};
use crate::friction::SlidingFriction;
use crate::gravity::Gravity;
use crate::ground::{GroundBounds, SpringDamperGround};
use crate::real::{Real, Vector};
use crate::rotation::Axes;
use crate::state::State;

// The inlining hints below make the compiler treat a step as one piece, without passing data
// between stages through memory. The loop over contacts as a separate function took 8 % fewer
// instructions and 1.2 to 1.8 times as long.

/// Body on a ground, as an integrator uses it.
///
/// *For authors of integrators:* [`motion`](Self::motion) converts a state into the quantities on
/// which forces depend. [`load`](Self::load) returns the force and torque of all contacts there,
/// and [`visit_contacts`](Self::visit_contacts) visits each contact. Gravity is separate, because
/// it needs no contact. A method can keep the contact range of its last evaluation in its
/// workspace. [`contacts_near`](Self::contacts_near) then finds the next range faster, and
/// [`load_on`](Self::load_on) returns its load.
pub trait Dynamics<R: Real = f64> {
    /// Type of the body.
    type Body: RigidPointBody<R>;
    /// Type of the ground.
    type Ground: SpringDamperGround<R>;
    /// Type of the friction law.
    type Friction: SlidingFriction<R>;

    /// Body.
    fn body(&self) -> &Self::Body;
    /// Ground.
    fn ground(&self) -> &Self::Ground;
    /// Friction law.
    fn friction(&self) -> &Self::Friction;
    /// Acceleration of gravity, m/s², world axes.
    fn gravity(&self) -> R::Vec3;
    /// Mass and inertia of the body.
    fn inertia_properties(&self) -> &InertiaProperties<R>;
    /// Distance from the centre of mass to the farthest point of the body's surface, m.
    fn bounding_radius(&self) -> R;

    /// Returns true if a contact of the body has a radius or moves over a smooth surface.
    ///
    /// The force then acts at a point other than the contact's own position.
    fn has_radii(&self) -> bool {
        let mut contacts = self.body().contacts().iter();
        self.body().is_smooth() || contacts.any(|contact| contact.radius > R::ZERO)
    }

    /// Evaluates laws at a point that the motion does not pass. A value that breaks a contract
    /// there is not an error of the step.
    #[doc(hidden)]
    #[inline(always)]
    fn probe<T>(&self, evaluate: impl FnOnce() -> T) -> T {
        evaluate()
    }

    /// Pose and velocities of the body in a state.
    #[inline(always)]
    fn motion(&self, state: &State<R>) -> Motion<R> {
        self.motion_along(state, state.rotation().axes())
    }

    /// Pose and velocities of the body in a state whose `axes` the integrator has already computed.
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

    /// Contact range that includes every contact less than `margin` (m) above the ground.
    ///
    /// In flight no contact is evaluated to compute it.
    #[inline]
    fn contacts_within(&self, margin: R, position: R::Vec3, axes: &Axes<R>) -> ContactRange {
        low_contacts(self, margin, position, axes, |normal, offset| {
            self.body().contacts_below(normal, offset)
        })
    }

    /// Contact range that includes every touching contact, found faster from a previous range
    /// `near`.
    ///
    /// It equals that of [`contacts_within`](Self::contacts_within) with a margin of 0, for every
    /// value of `near`.
    #[inline(always)]
    fn contacts_near(&self, near: ContactRange, position: R::Vec3, axes: &Axes<R>) -> ContactRange {
        low_contacts(self, R::ZERO, position, axes, |normal, offset| {
            self.body().contacts_below_near(normal, offset, near)
        })
    }

    /// Calls `visit` with each contact that touches, in the order of the contact range.
    #[inline(always)]
    fn visit_contacts(&self, motion: &Motion<R>, visit: impl FnMut(&Contact<R>)) {
        let run = self.contacts_within(R::ZERO, motion.position, &motion.axes);
        self.visit_run(run, motion, visit);
    }

    /// Calls `visit` with each contact in `run` that touches, and with the quadrature points of the
    /// rims.
    #[inline(always)]
    fn visit_run(&self, run: ContactRange, motion: &Motion<R>, mut visit: impl FnMut(&Contact<R>)) {
        visit_points(self, run, motion, &mut visit);
        if !self.body().rims().is_empty() {
            self.visit_rims(motion, visit);
        }
    }

    /// Calls `visit` with each quadrature point of the rims that touches.
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

    /// Force and torque of all contacts, without gravity.
    ///
    /// The sums equal those of [`visit_contacts`](Self::visit_contacts) except for rounding. The
    /// torque of bare points on a level plane is summed differently, in another fixed order.
    #[inline(always)]
    fn load(&self, motion: &Motion<R>) -> Load<R> {
        let run = self.contacts_within(R::ZERO, motion.position, &motion.axes);
        self.load_on(run, motion)
    }

    /// Force and torque of the contacts in `run`, without gravity.
    ///
    /// Use it to evaluate the same pose again with other velocities.
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
            // Bound of the rounding of a gap, far larger than the rounding of the body's own
            // arithmetic.
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

/// Calls `visit` with each contact point in `run` that touches, without the quadrature points of a
/// rim.
#[inline(always)]
pub(crate) fn visit_points<R: Real, D: Dynamics<R> + ?Sized>(
    scene: &D,
    run: ContactRange,
    motion: &Motion<R>,
    visit: &mut impl FnMut(&Contact<R>),
) {
    let contacts = scene.body().contacts();
    // One loop for both parts of a range that continues at the first contact, so that `visit` is
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

/// Energy in the springs, J, and the number of contacts that touch.
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

/// Energy in the springs under the rims, J, and the number of quadrature points that touch.
///
/// The energy is evaluated for a body at rest in the same pose. The quadrature of the forces of a
/// rim depends on the velocities, but an energy must depend on the pose only.
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

/// Load of the contacts in `run`. With `arm_axes`, the torque is that of the same forces on a body
/// with these axes.
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

/// Returns true if a body is so high above a plane that no part of it touches.
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

/// Height of a ground that is a level plane, if all contacts are bare points of the body.
#[inline(always)]
fn height_under_bare_points<R: Real, D: Dynamics<R> + ?Sized>(scene: &D) -> Option<R> {
    match scene.ground().bounds() {
        GroundBounds::Plane(plane) if !scene.has_radii() && plane.is_level() => Some(plane.height),
        _ => None,
    }
}

/// Torque of rolling resistance of the contacts in `run`, N m. Returns `None` if the friction law
/// has no rolling resistance.
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

/// Length that converts an angle into a displacement, m: the larger of the bounding radius and the
/// radius of gyration `√(largest moment/mass)`.
///
/// A body without contacts has no bounding radius of its own, but it has mass at the radius of
/// gyration or beyond.
#[inline]
pub(crate) fn size<R: Real, D: Dynamics<R> + ?Sized>(scene: &D) -> R {
    scene
        .bounding_radius()
        .at_least(scene.inertia_properties().radius_of_gyration())
}

/// Pose and velocities of a body, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<R: Real = f64> {
    /// Centre of mass, m.
    pub position: R::Vec3,
    /// Axes of the body.
    pub axes: Axes<R>,
    /// Velocity of the centre of mass, m/s.
    pub linear_velocity: R::Vec3,
    /// Angular velocity, rad/s.
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

/// Contact that touches, with position, penetration depth and velocity, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<R: Real = f64> {
    /// Contact as defined by the body.
    pub point: ContactPoint<R>,
    /// Vector from the centre of mass to the point at which the force acts, m.
    pub arm: R::Vec3,
    /// Outward normal of the ground, unit vector.
    pub normal: R::Vec3,
    /// Penetration depth, m, above 0.
    pub depth: R,
    /// Rate of increase of the penetration depth, m/s.
    pub closing_speed: R,
    /// Velocity along the surface, m/s.
    pub slip: R::Vec3,
    /// Number of contacts of the body that it represents: 1, except for a quadrature point of a
    /// [`Rim`](crate::Rim).
    pub weight: R,
}

impl<R: Real> Contact<R> {
    /// Contact of `point` with the ground, if it touches.
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

    /// Contact of a fixed `point` with the ground, if it touches.
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

    /// Arm of the same contact for a body with other axes.
    #[inline]
    pub(crate) fn arm_along(&self, axes: &Axes<R>) -> R::Vec3 {
        let centre_arm = axes.to_world(self.point.position);
        surface_arm(&self.point, centre_arm, self.normal)
    }

    /// Force of the ground on the body at this contact, normal and friction together, N.
    #[inline]
    pub fn force<G, F>(&self, ground: &G, friction: &F) -> R::Vec3
    where
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        let normal_force = ground.normal_force(self.depth, self.closing_speed);
        (self.normal * normal_force + friction.force(normal_force, self.slip)) * self.weight
    }

    /// Torque of rolling resistance on a rotating body (rad/s), in addition to that of the force, N
    /// m.
    ///
    /// It is 0 unless the friction law has rolling resistance.
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

/// Point of a smooth body that faces the ground, as a bare contact for the current orientation. The
/// normal is that under the contact which represents the body.
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

/// Vector from the centre of mass to the point of a contact's surface that faces the ground, m,
/// world axes.
#[inline]
fn surface_arm<R: Real>(point: &ContactPoint<R>, centre_arm: R::Vec3, normal: R::Vec3) -> R::Vec3 {
    // A bare point, the most frequent case, needs no arithmetic.
    if point.radius == R::ZERO {
        centre_arm
    } else {
        centre_arm - normal * point.radius
    }
}

/// Force and torque of the ground on the body, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load<R: Real = f64> {
    /// Force, N.
    pub force: R::Vec3,
    /// Torque about the centre of mass, N m.
    pub torque: R::Vec3,
    /// Number of contacts that touch.
    pub touching: usize,
}

impl<R: Real> Load<R> {
    /// Adds a touching contact with its force (N), and with its arm for a body with other axes.
    #[inline]
    fn add_along(&mut self, axes: &Axes<R>, contact: &Contact<R>, force: R::Vec3) {
        self.force += force;
        self.torque += contact.arm_along(axes).cross(force);
        self.touching += 1;
    }

    /// Adds a touching contact with its force (N).
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

/// Rates of change of a state, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates<R: Real = f64> {
    /// Acceleration of the centre of mass by contacts and gravity, m/s².
    pub acceleration: R::Vec3,
    /// Torque of the contacts about the centre of mass, N m: the rate of the angular momentum.
    pub torque: R::Vec3,
    /// Angular velocity, rad/s.
    pub angular_velocity: R::Vec3,
}

impl<R: Real> Rates<R> {
    /// Rates for a motion of a scene under the load of its contacts.
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

/// Lowest point of a body's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowestPoint<R: Real = f64> {
    /// Number of its contact. Rims are numbered after the last contact.
    pub index: usize,
    /// Position, m, world axes.
    pub position: R::Vec3,
    /// Height above the ground, m, negative below ground.
    pub gap: R,
    /// Velocity of the body's material at the point, along the surface, m/s.
    pub slip: R::Vec3,
}

impl<R: Real> LowestPoint<R> {
    /// Returns the point of the body's surface that is lowest above the ground, or deepest below
    /// it. Returns `None` for a body without contacts.
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

/// Body, ground, friction and gravity, checked, with the computed mass properties of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene<B, G, F, A, R: Real = f64> {
    body: B,
    ground: G,
    friction: F,
    gravity: A,
    inertia_properties: InertiaProperties<R>,
    bounding_radius: R,
    has_radii: bool,
}

impl<R, B, G, F, A> Scene<B, G, F, A, R>
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
    /// the bounding radius, or the inverse of the mass or of a moment of inertia overflows. The
    /// error names the quantity, the rule and the value.
    pub fn new(body: B, ground: G, friction: F, gravity: A) -> Result<Self, SceneError> {
        body.check()?;
        ground.check()?;
        friction.check()?;
        gravity.check()?;
        crate::body::check_contacts(body.contacts())?;
        crate::body::check_rims(&body)?;
        let bounding_radius = body.bounding_radius();
        error::finite("bounding radius of the body", bounding_radius, " m")?;
        error::at_least_zero("bounding radius of the body", bounding_radius, " m")?;
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

impl<R: Real, B, G, F, A> Scene<B, G, F, A, R> {
    /// Returns the four parts.
    pub(crate) fn into_parts(self) -> (B, G, F, A) {
        (self.body, self.ground, self.friction, self.gravity)
    }
}

impl<R, B, G, F, A> Scene<B, G, F, A, R>
where
    R: Real,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
{
    /// Returns true if a step need not check the values that the laws return.
    #[inline(always)]
    pub(crate) fn is_trusted(&self) -> bool {
        self.ground.is_trusted() && self.friction.is_trusted()
    }
}

impl<R, B, G, F, A> Dynamics<R> for Scene<B, G, F, A, R>
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

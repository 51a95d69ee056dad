//! Bodies, grounds, friction laws and integrators from bytes, with every public constructor.

use core::cell::Cell;

use tumble::real::{Matrix, Vector};
use tumble::{
    AdaptiveEnergyMomentum, AdaptiveNystrom, AnisotropicCoulomb, AnyIntegrator, BogackiShampine32,
    Bowl, Capsule, Carried, Coin, Cone, ContactLaw, ContactPoint, Coulomb, Cuboid, Disc,
    DormandPrince54, Dynamics, Ellipsoid, EnergyMomentum, FlatGround, Flight, Force, ForwardEuler,
    Frictionless, Ground, GroundBounds, GroundMotion, HuntCrossley, Impact, Integrator,
    LimitedDamper, LinearMotion, LoadDependentCoulomb, MassProperties, MeanForce, NoForce,
    NoGround, Nystrom, Plane, PointCloud, PointMass, Radau5, Ramp, Real, RigidPointBody, Rk4, Rod,
    Rotation, SceneError, Shape, SlidingFriction, SmoothCoulomb, Solid, SolidCoin, Sphere,
    SpringDamper, SpringDamperGround, State, Step, StepControl, StepError, Stepper,
    StrangSplitting, Stribeck, Surface, SymplecticEuler, Terrain, ThickDisc, UniformGravity,
    Viscous, Waves, WithResistance,
};

use super::driven::{AnyForce, beside_walls, by_place, force, moving};
use super::input::Input;
use super::once::Once;

/// A body behind a pointer.
pub type AnyBody<R> = Box<dyn RigidPointBody<R>>;
/// A ground behind a pointer.
pub type AnyGround<R> = Box<dyn SpringDamperGround<R>>;
/// A friction law behind a pointer.
pub type AnyFriction<R> = Box<dyn SlidingFriction<R>>;
/// The stepper of all targets, so that each method is compiled once for each precision.
pub type AnyStepper<'a, R> = Stepper<
    &'a dyn RigidPointBody<R>,
    &'a Meter<R>,
    &'a dyn SlidingFriction<R>,
    UniformGravity<R>,
    Method<R>,
    R,
    &'a dyn Force<R>,
>;

// -----------------------------------------------------------------------------------------------
// Bodies
// -----------------------------------------------------------------------------------------------

/// Largest number of contacts of a body: a step of many contacts only takes longer.
const MOST_CONTACTS: u8 = 24;

fn blank<R: Real>(input: &mut Input<'_>) -> Vec<ContactPoint<R>> {
    vec![ContactPoint::default(); usize::from(input.below(MOST_CONTACTS))]
}

fn mass<R: Real>(input: &mut Input<'_>) -> R {
    input.size(1e-3, 1e2)
}

fn length<R: Real>(input: &mut Input<'_>) -> R {
    input.size(1e-2, 1.0)
}

fn points<R: Real>(input: &mut Input<'_>) -> Vec<R::Vec3> {
    let count = input.below(10);
    (0..count).map(|_| input.vector::<R>(1e-2, 1.0)).collect()
}

fn contacts<R: Real>(input: &mut Input<'_>) -> Vec<ContactPoint<R>> {
    let has_radii = input.flag();
    let contact = |position| ContactPoint::bare(position);
    let mut contacts: Vec<_> = points::<R>(input).into_iter().map(contact).collect();
    if has_radii {
        for contact in &mut contacts {
            contact.radius = input.size(1e-3, 0.1);
        }
    }
    contacts
}

/// Mass properties of one shape.
fn simple_masses<R: Real>(input: &mut Input<'_>) -> Result<MassProperties<R>, SceneError> {
    let mass = mass(input);
    Ok(match input.below(13) {
        0 => MassProperties::ball(mass, length(input))?,
        1 => MassProperties::shell(mass, length(input))?,
        2 => MassProperties::cuboid(mass, input.sizes::<R>(1e-2, 1.0))?,
        3 => MassProperties::cylinder(mass, length(input), length(input))?,
        4 => MassProperties::cone(mass, length(input), length(input))?,
        5 => MassProperties::capsule(mass, length(input), length(input))?,
        6 => MassProperties::ellipsoid(mass, input.sizes::<R>(1e-2, 1.0))?,
        7 => MassProperties::rod(mass, length(input))?,
        8 => MassProperties::point(mass),
        9 => {
            let points = points::<R>(input);
            let count = usize::from(input.below(2)) + points.len();
            let masses: Vec<R> = (0..count).map(|_| input.size(1e-3, 1.0)).collect();
            MassProperties::points(&points, &masses)?
        }
        10 => MassProperties::hull(mass, &points::<R>(input))?,
        11 => {
            let points = points::<R>(input);
            let count = usize::from(input.below(12));
            let corner = |input: &mut Input<'_>| usize::from(input.below(12));
            let triangles: Vec<_> = (0..count).map(|_| [0; 3].map(|_| corner(input))).collect();
            MassProperties::mesh(mass, &points, &triangles)?
        }
        _ => MassProperties {
            mass,
            centre_of_mass: input.vector::<R>(1e-2, 1.0),
            inertia: R::Mat3::from_columns([0; 3].map(|_| input.vector::<R>(1e-3, 1.0))),
        },
    })
}

/// Mass properties of up to two shapes, moved and turned.
fn masses<R: Real>(input: &mut Input<'_>) -> Result<MassProperties<R>, SceneError> {
    let mut masses = simple_masses(input)?;
    let changes = input.byte();
    if changes & 1 != 0 {
        masses = masses.rotated(Rotation::from_quat(input.quaternion::<R>()));
    }
    if changes & 2 != 0 {
        masses = masses.at(input.vector::<R>(1e-3, 0.1));
    }
    if changes & 4 != 0 {
        masses = masses.with(&simple_masses(input)?);
    }
    Ok(masses)
}

/// A body of any kind.
///
/// # Errors
/// Returns [`SceneError`] if a constructor does.
pub fn body<R: Real>(input: &mut Input<'_>) -> Result<AnyBody<R>, SceneError> {
    let kind = input.below(21);
    if (13..20).contains(&kind) {
        return composite(input, kind);
    }
    let mass = mass(input);
    Ok(match kind {
        0 => Box::new(Cuboid::solid(mass, input.sizes::<R>(1e-2, 1.0))),
        1 => Box::new(Coin::ring_with_storage(blank(input), mass, length(input))),
        2 => Box::new(Coin::<R>::ring(mass, length(input))),
        3 => {
            let (radius, points) = (length(input), input.short());
            Box::new(Disc::<R>::ring(mass, radius, points.into()))
        }
        4 => Box::new(Disc::<R>::solid(mass, length(input), 120)),
        5 => {
            let points = blank(input);
            let (radius, thickness) = (length(input), length(input));
            Box::new(SolidCoin::new_with_storage(points, mass, radius, thickness))
        }
        6 => Box::new(Sphere::<R>::solid(mass, length(input))),
        7 => Box::new(Sphere::<R>::shell(mass, length(input))),
        8 => Box::new(Ellipsoid::solid(mass, input.sizes::<R>(1e-2, 1.0))),
        9 => Box::new(Capsule::<R>::solid(mass, length(input), length(input))),
        10 => {
            let points = blank(input);
            let (radius, height) = (length(input), length(input));
            Box::new(Cone::solid_with_storage(points, mass, radius, height))
        }
        11 => Box::new(Rod::<R>::new(mass, length(input))),
        12 => Box::new(PointMass::<R>::new(mass)),
        _ => {
            let (radius, thickness, points) = (length(input), length(input), input.short());
            Box::new(ThickDisc::<R>::solid(
                mass,
                radius,
                thickness,
                points.into(),
            ))
        }
    })
}

fn composite<R: Real>(input: &mut Input<'_>, kind: u8) -> Result<AnyBody<R>, SceneError> {
    Ok(match kind {
        13 => Box::new(Sphere::loaded(length(input), masses::<R>(input)?)),
        14 => {
            let edges = input.sizes::<R>(1e-2, 1.0);
            let rounding = input.size(1e-3, 1e-2);
            Box::new(Cuboid::loaded(edges, masses(input)?).rounded(rounding))
        }
        15 => {
            let semi_axes = input.sizes::<R>(1e-2, 1.0);
            Box::new(Ellipsoid::loaded(semi_axes, masses(input)?))
        }
        16 | 17 => {
            let contacts = contacts::<R>(input);
            let count = usize::from(input.byte() == 255) + contacts.len();
            let masses: Vec<R> = (0..count).map(|_| input.size(1e-3, 1.0)).collect();
            Box::new(PointCloud::with_storage(contacts, &masses)?)
        }
        18 => {
            let masses = masses(input)?;
            Box::new(Solid::new(masses, contacts::<R>(input))?)
        }
        _ => {
            let (mass, points) = (mass(input), points::<R>(input));
            let contacts: Vec<_> = points.iter().map(|&at| ContactPoint::bare(at)).collect();
            Box::new(Solid::new(MassProperties::hull(mass, &points)?, contacts)?)
        }
    })
}

// -----------------------------------------------------------------------------------------------
// Grounds
// -----------------------------------------------------------------------------------------------

fn law<R: Real>(input: &mut Input<'_>) -> Result<Box<dyn ContactLaw<R>>, SceneError> {
    let kind = input.below(10);
    let stiffness = input.size(1e2, 1e6);
    let damping = input.size(1e-2, 1e2);
    let carried = |input: &mut Input<'_>| Carried {
        mass: mass(input),
        contacts: u32::from(input.byte()),
    };
    let fraction = |input: &mut Input<'_>| input.size::<R>(1e-2, 1.0);
    let impact = |restitution, speed| Impact { speed, restitution };
    Ok(match kind {
        0 | 1 => Box::new(SpringDamper { stiffness, damping }),
        2 => Box::new(LimitedDamper { stiffness, damping }),
        3 => Box::new(HuntCrossley {
            stiffness,
            exponent: input.size(1.0, 3.0),
            damping: input.size(1e-3, 1.0),
        }),
        4 => Box::new(HuntCrossley::hertz(stiffness, damping)),
        5 => {
            let (carried, low) = (carried(input), fraction(input));
            Box::new(SpringDamper::from_bounce(carried, low, fraction(input))?)
        }
        6 => {
            let (carried, low) = (carried(input), fraction(input));
            let high = fraction(input);
            Box::new(LimitedDamper::from_rest(
                carried,
                low,
                high,
                fraction(input),
            )?)
        }
        7 => {
            let carried = carried(input);
            let [a, b, c, d] = [0; 4].map(|_| fraction(input));
            Box::new(HuntCrossley::from_bounce(carried, a, impact(b, c), d)?)
        }
        8 => {
            let carried = carried(input);
            let [a, b, c, d] = [0; 4].map(|_| fraction(input));
            Box::new(HuntCrossley::from_contact_time(
                carried,
                a,
                impact(b, c),
                d,
            )?)
        }
        _ => {
            let carried = carried(input);
            let [a, b, c, d] = [0; 4].map(|_| fraction(input));
            let exponent = input.size(1.0, 3.0);
            Box::new(HuntCrossley::from_rest(
                carried,
                a,
                impact(b, c),
                d,
                exponent,
            )?)
        }
    })
}

fn plane<R: Real>(input: &mut Input<'_>) -> Plane<R> {
    let height = input.signed(1e-2, 1.0);
    match input.below(4) {
        0 | 1 => Plane::level(height),
        2 => Plane::through(input.vector::<R>(1e-2, 1.0), input.vector::<R>(0.1, 1.0)),
        _ => Plane {
            normal: input.vector::<R>(1.0, 1.0),
            height,
        },
    }
}

fn shape<R: Real>(input: &mut Input<'_>) -> Box<dyn Shape<R>> {
    match input.below(5) {
        0 | 1 => Box::new(plane(input)),
        2 => {
            let curvatures = [0; 2].map(|_| input.signed(1e-2, 1.0));
            let height_field = Bowl { curvatures };
            Box::new(Terrain { height_field })
        }
        3 => {
            let height_field = Ramp {
                slope: input.signed(1e-2, 1.0),
                width: input.size(1e-2, 1.0),
            };
            Box::new(Terrain { height_field })
        }
        _ => {
            let height_field = Waves {
                amplitude: input.signed(1e-3, 0.1),
                length: input.size(0.1, 10.0),
            };
            Box::new(Terrain { height_field })
        }
    }
}

/// A ground of any kind.
///
/// # Errors
/// Returns [`SceneError`] if a constructor does.
pub fn ground<R: Real>(input: &mut Input<'_>) -> Result<AnyGround<R>, SceneError> {
    Ok(match input.below(6) {
        0..=2 => {
            let (stiffness, damping) = (input.size(1e2, 1e6), input.size(1e-2, 1e2));
            let ground = FlatGround::level(stiffness, damping);
            if input.flag() {
                Box::new(ground.on(plane(input)))
            } else {
                Box::new(ground)
            }
        }
        3 | 4 => {
            let law = law(input)?;
            let shape = shape(input);
            Box::new(Ground { law, shape })
        }
        _ => Box::new(NoGround),
    })
}

/// Evaluations of a ground in one step after which it counts as hanging. A step takes at most 10⁴
/// evaluations of the load, of at most 120 contacts, each by several calls of the ground.
const MOST_CALLS: u64 = 1 << 27;

thread_local! {
    /// Evaluations of all grounds since the last step began.
    static CALLS: Cell<u64> = const { Cell::new(0) };
}

/// A ground that counts its evaluations and fails after too many in one step.
pub struct Meter<R: Real> {
    ground: AnyGround<R>,
    is_trusted: bool,
}

impl<R: Real> Meter<R> {
    /// Creates a meter around a ground. It hides that a ground is trusted unless `may_trust`.
    pub fn new(ground: AnyGround<R>, may_trust: bool) -> Self {
        Self {
            is_trusted: may_trust && ground.is_trusted(),
            ground,
        }
    }

    fn count() {
        let calls = CALLS.get() + 1;
        assert!(calls < MOST_CALLS, "the ground is evaluated for ever");
        CALLS.set(calls);
    }
}

impl<R: Real> SpringDamperGround<R> for Meter<R> {
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        Self::count();
        self.ground.surface(point)
    }
    fn spring_force(&self, depth: R) -> R {
        Self::count();
        self.ground.spring_force(depth)
    }
    fn spring_energy(&self, depth: R) -> R {
        Self::count();
        self.ground.spring_energy(depth)
    }
    fn normal_force(&self, depth: R, closing_speed: R) -> R {
        Self::count();
        self.ground.normal_force(depth, closing_speed)
    }
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        Self::count();
        self.ground.mean_force(start, end, seconds)
    }
    fn bounds(&self) -> GroundBounds<R> {
        self.ground.bounds()
    }
    fn surfaces(&self) -> Option<usize> {
        self.ground.surfaces()
    }
    fn with_surface(&self, index: usize, visit: &mut dyn FnMut(&dyn SpringDamperGround<R>)) {
        Self::count();
        self.ground.with_surface(index, visit);
    }
    fn motion(&self) -> Option<GroundMotion<R>> {
        self.ground.motion()
    }
    fn check(&self) -> Result<(), SceneError> {
        self.ground.check()
    }
    fn is_trusted(&self) -> bool {
        self.is_trusted
    }
}

// -----------------------------------------------------------------------------------------------
// Friction and gravity
// -----------------------------------------------------------------------------------------------

/// A friction law of any kind.
pub fn friction<R: Real>(input: &mut Input<'_>) -> AnyFriction<R> {
    let kind = input.below(8);
    let coefficient = input.size(1e-2, 2.0);
    let slip_speed = input.size(1e-9, 1e-1);
    match kind {
        0 => Box::new(Coulomb {
            coefficient,
            slip_speed,
        }),
        1 => Box::new(Frictionless),
        2 => Box::new(SmoothCoulomb {
            coefficient,
            slip_speed,
        }),
        3 => Box::new(Stribeck {
            static_coefficient: input.size(1e-2, 2.0),
            kinetic_coefficient: coefficient,
            stribeck_speed: input.size(1e-3, 1.0),
            viscous: input.size(1e-3, 1e-1),
            slip_speed,
        }),
        4 => Box::new(LoadDependentCoulomb {
            coefficient,
            transition_load: input.size(1e-2, 1e3),
            slip_speed,
        }),
        5 => {
            let coefficients = [coefficient, input.size(1e-2, 2.0)];
            let (normal, along) = (input.vector::<R>(0.1, 1.0), input.vector::<R>(0.1, 1.0));
            Box::new(if input.flag() {
                AnisotropicCoulomb::on(normal, along, coefficients, slip_speed)
            } else {
                AnisotropicCoulomb {
                    along,
                    across: normal,
                    coefficients,
                    slip_speed,
                }
            })
        }
        6 => Box::new(Viscous { coefficient }),
        _ => Box::new(WithResistance {
            friction: Coulomb {
                coefficient,
                slip_speed,
            },
            rolling: input.size(1e-4, 1e-1),
            spinning: input.size(1e-4, 1e-1),
            turn_speed: input.size(1e-6, 1.0),
        }),
    }
}

/// Gravity, mostly downwards.
pub fn gravity<R: Real>(input: &mut Input<'_>) -> UniformGravity<R> {
    if input.byte() < 192 {
        UniformGravity::down(R::from_f64(9.8))
    } else {
        UniformGravity {
            acceleration: input.vector::<R>(1e-2, 1e2),
        }
    }
}

// -----------------------------------------------------------------------------------------------
// Integrators
// -----------------------------------------------------------------------------------------------

/// A built-in integrator, with or without flight in closed form.
#[derive(Clone, Copy, Debug)]
pub struct Method<R> {
    /// The integrator in contact.
    pub method: AnyIntegrator<R>,
    /// True if flight is in closed form.
    pub flies: bool,
}

impl<R: Real> Method<R> {
    /// Returns true if the method promises that the energy never increases.
    #[must_use]
    pub fn keeps_energy(&self) -> bool {
        matches!(
            self.method,
            AnyIntegrator::EnergyMomentum(_) | AnyIntegrator::AdaptiveEnergyMomentum(_)
        )
    }
}

impl<R: Real> Integrator<R> for Method<R> {
    type Workspace = <AnyIntegrator<R> as Integrator<R>>::Workspace;
    const ADAPTIVE: bool = <AnyIntegrator<R> as Integrator<R>>::ADAPTIVE;
    const SPANS_STEPS: bool = <Flight<AnyIntegrator<R>> as Integrator<R>>::SPANS_STEPS;

    // Inlined into each of its callers, it took several times as long to compile.
    #[inline(never)]
    fn step<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &mut State<R>,
        limit: R,
        workspace: &mut Self::Workspace,
    ) -> Result<Step<R>, StepError> {
        CALLS.set(0);
        if self.flies {
            let in_contact = Self {
                flies: false,
                ..*self
            };
            Once(Flight(in_contact)).step(scene, state, limit, workspace)
        } else {
            Once(self.method).step(scene, state, limit, workspace)
        }
    }
    fn order(&self) -> u32 {
        self.method.order()
    }
    fn fixed_step(&self) -> Option<R> {
        self.method.fixed_step()
    }
    fn largest_stable_step(&self, stiffness: R, damping: R) -> Option<R> {
        self.method.largest_stable_step(stiffness, damping)
    }

    fn linear_step(
        &self,
        motion: &LinearMotion,
        start: [[f64; 6]; 2],
        time_step: f64,
    ) -> Option<[[f64; 6]; 2]> {
        self.method.linear_step(motion, start, time_step)
    }
    fn step_control(
        &self,
        workspace: &Self::Workspace,
        state: &State<R>,
    ) -> Option<StepControl<R>> {
        self.method.step_control(workspace, state)
    }
    fn set_step_control(&self, workspace: &mut Self::Workspace, control: StepControl<R>) {
        self.method.set_step_control(workspace, control);
    }
    fn check(&self) -> Result<(), SceneError> {
        self.method.check()
    }
}

/// An integrator of any kind. An adaptive one has a budget of some hundred steps.
pub fn method<R: Real>(input: &mut Input<'_>) -> Method<R> {
    let (kind, flies) = (input.below(11), input.byte() >= 192);
    let time_step = input.size(1e-5, 1e-1);
    let method = match kind {
        0 => ForwardEuler { time_step }.into(),
        1 => SymplecticEuler { time_step }.into(),
        2 => StrangSplitting { time_step }.into(),
        3 => Rk4 { time_step }.into(),
        4 => Nystrom { time_step }.into(),
        5 => BogackiShampine32 {
            tolerance: input.size(1e-9, 1e-2),
            longest_step: time_step,
            budget: u32::from(input.byte()),
        }
        .into(),
        6 => DormandPrince54 {
            tolerance: input.size(1e-9, 1e-2),
            longest_step: time_step,
            budget: u32::from(input.byte()),
        }
        .into(),
        // Each of its attempts takes three steps of up to 10⁴ evaluations.
        7 => AdaptiveEnergyMomentum {
            tolerance: input.size(1e-9, 1e-2),
            longest_step: time_step,
            budget: u32::from(input.byte() / 64),
        }
        .into(),
        8 => AdaptiveNystrom {
            tolerance: input.size(1e-9, 1e-2),
            longest_step: time_step,
            budget: u32::from(input.byte()),
        }
        .into(),
        9 => Radau5 {
            tolerance: input.size(1e-9, 1e-2),
            longest_step: time_step,
            budget: u32::from(input.byte()),
        }
        .into(),
        _ => EnergyMomentum { time_step }.into(),
    };
    Method { method, flies }
}

// -----------------------------------------------------------------------------------------------
// Scenes and states
// -----------------------------------------------------------------------------------------------

/// The parts of a scene, before they are checked.
pub struct Parts<R: Real> {
    /// Body.
    pub body: AnyBody<R>,
    /// Ground, with a count of its evaluations.
    pub ground: Meter<R>,
    /// Friction law.
    pub friction: AnyFriction<R>,
    /// Gravity.
    pub gravity: UniformGravity<R>,
    /// Integrator.
    pub method: Method<R>,
    /// Applied force.
    pub force: AnyForce<R>,
    /// True if the scene may have a force, ground that moves and friction by position.
    pub is_extended: bool,
}

impl<R: Real> Parts<R> {
    /// Reads all parts.
    ///
    /// Those that drive a body, vary over the ground or stand beside it follow the others, if a
    /// byte asks for them. So the stored inputs without that byte keep their meaning.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a constructor does.
    pub fn read(input: &mut Input<'_>) -> Result<Self, SceneError> {
        let method = method(input);
        let trust = input.byte();
        let is_extended = trust >= 224;
        let (mut ground, mut friction) = (ground(input)?, friction(input));
        let (gravity, body) = (gravity(input), body(input)?);
        let mut applied: AnyForce<R> = Box::new(NoForce);
        let roles = if is_extended { input.byte() } else { 0 };
        if roles & 1 != 0 {
            applied = force(input);
        }
        if roles & 16 != 0 {
            ground = beside_walls(ground, input);
        }
        if roles & 2 != 0 {
            ground = moving(ground, input);
        }
        if roles & 4 != 0 {
            friction = by_place(friction, input);
        }
        Ok(Self {
            ground: Meter::new(ground, trust < 192 || roles & 8 != 0),
            friction,
            gravity,
            body,
            method,
            force: applied,
            is_extended,
        })
    }

    /// Composes the scene.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a part is invalid.
    pub fn stepper(&self) -> Result<AnyStepper<'_, R>, SceneError> {
        Stepper::new(&*self.body)?
            .with_ground(&self.ground)?
            .with_friction(&*self.friction)?
            .with_gravity(self.gravity)?
            .with_force(&*self.force)?
            .with_integrator(self.method)
    }
}

/// A state, mostly close to the ground.
pub fn state<R: Real>(input: &mut Input<'_>) -> State<R> {
    State::at(input.vector::<R>(1e-3, 1.0))
        .with_orientation(input.quaternion::<R>())
        .with_linear_velocity(input.vector::<R>(1e-3, 10.0))
        .with_angular_momentum(input.vector::<R>(1e-4, 1.0))
}

/// All numbers of a state.
pub fn numbers<R: Real>(state: &State<R>) -> [u64; 13] {
    use tumble::real::Quaternion;
    let [x, y, z, w] = state.orientation.xyzw();
    let (p, v, l) = (
        state.position,
        state.linear_velocity,
        state.angular_momentum,
    );
    let numbers = [
        p.x(),
        p.y(),
        p.z(),
        x,
        y,
        z,
        w,
        v.x(),
        v.y(),
        v.z(),
        l.x(),
        l.y(),
        l.z(),
    ];
    numbers.map(|number| number.to_f64().to_bits())
}

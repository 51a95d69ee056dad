//! Parts of a user with results of any bits: their checks and their steps return.
//!
//! A part is a built-in one of which one method returns another value where its argument is large
//! enough. So a check comes as far as that method.

use core::cell::Cell;

use tumble::contract::{
    CheckPlan, ForceRange, FrictionRange, GroundRange, check_body, check_energy_never_rises,
    check_force, check_friction, check_ground, check_integrator,
};
use tumble::real::{Matrix, Vector};
use tumble::{
    AnyIntegrator, ContactPoint, ContactRange, Dynamics, Force, ForcePower, FrictionJacobian,
    GroundBounds, GroundMotion, Integrator, MeanForce, Motion, NoForce, Plane, Real,
    RigidPointBody, Rim, RollingResistance, SceneError, SlidingFriction, SpringDamperGround, State,
    Step, StepError, Stepper, Surface, Wrench,
};

use super::driven::{AnyForce, force};
use super::input::Input;
use super::parts::{
    AnyBody, AnyFriction, AnyGround, Meter, body, friction, gravity, ground, method, state,
};

/// Plays an input.
pub fn run(data: &[u8]) {
    let mut input = Input::new(data);
    match input.below(3) {
        0 => play::<f32>(&mut input),
        1 => play::<f64>(&mut input),
        _ => play_integrator(&mut input),
    }
}

fn plan(input: &mut Input<'_>) -> CheckPlan {
    CheckPlan {
        seed: input.long(),
        cases: input.below(6).into(),
    }
}

/// A method of a part that is spoilt, and its values.
struct Fault<R> {
    /// Number of the method; none if it is large.
    method: u8,
    /// The method returns the values if its argument is at least this.
    from: R,
    /// Values, one after the other.
    values: [R; 4],
    next: Cell<usize>,
}

impl<R: Real> Fault<R> {
    fn read(input: &mut Input<'_>) -> Self {
        Self {
            method: input.below(14),
            from: input.signed(1e-9, 1.0),
            values: [0; 4].map(|_| input.signed(1e-9, 1e3)),
            next: Cell::new(0),
        }
    }

    /// The value of a method, or its own where it is spoilt.
    fn of(&self, method: u8, argument: R, value: R) -> R {
        if self.method == method && argument >= self.from {
            self.any()
        } else {
            value
        }
    }

    fn any(&self) -> R {
        let next = self.next.get();
        self.next.set(next + 1);
        self.values[next % self.values.len()]
    }

    fn vector(&self, method: u8, argument: R, value: R::Vec3) -> R::Vec3 {
        if self.method == method && argument >= self.from {
            R::Vec3::new(self.any(), self.any(), self.any())
        } else {
            value
        }
    }

    /// A number of a contact from a value or its bits.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "any number will do"
    )]
    fn index(&self) -> usize {
        let value = self.any().to_f64();
        if value.abs() < 1.0 {
            usize::try_from(value.to_bits()).unwrap_or(usize::MAX)
        } else {
            value.abs() as usize
        }
    }
}

struct SpoiltGround<R: Real>(AnyGround<R>, Fault<R>);

impl<R: Real> SpringDamperGround<R> for SpoiltGround<R> {
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        let Surface { gap, normal } = self.0.surface(point);
        Surface {
            gap: self.1.of(0, gap, gap),
            normal: self.1.vector(1, gap, normal),
        }
    }
    fn spring_force(&self, depth: R) -> R {
        self.1.of(2, depth, self.0.spring_force(depth))
    }
    fn spring_energy(&self, depth: R) -> R {
        self.1.of(3, depth, self.0.spring_energy(depth))
    }
    fn normal_force(&self, depth: R, closing_speed: R) -> R {
        let force = self.0.normal_force(depth, closing_speed);
        self.1.of(4, closing_speed, force)
    }
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        let mean = self.0.mean_force(start, end, seconds);
        MeanForce {
            force: self.1.of(5, end, mean.force),
            slope: self.1.of(6, end, mean.slope),
            stiffness: self.1.of(7, end, mean.stiffness),
            damping: self.1.of(8, end, mean.damping),
        }
    }
    fn bounds(&self) -> GroundBounds<R> {
        if self.1.method != 9 {
            return self.0.bounds();
        }
        let plane = Plane {
            normal: self.1.vector(9, R::MAX, R::Vec3::ZERO),
            height: self.1.any(),
        };
        if self.1.any() > R::ZERO {
            GroundBounds::Plane(plane)
        } else {
            GroundBounds::Below(plane)
        }
    }
    fn motion(&self) -> Option<GroundMotion<R>> {
        if self.1.method == 10 {
            return Some(GroundMotion {
                velocity: self.1.vector(10, self.1.from, R::Vec3::ZERO),
                angular_velocity: self.1.vector(10, self.1.from, R::Vec3::ZERO),
            });
        }
        self.0.motion()
    }
    fn check(&self) -> Result<(), SceneError> {
        self.0.check()
    }
}

struct SpoiltForce<R: Real> {
    force: AnyForce<R>,
    fault: Fault<R>,
    /// The opposite of what the force states about itself.
    is_reversed: bool,
}

impl<R: Real> Force<R> for SpoiltForce<R> {
    fn wrench(&self, motion: &Motion<R>) -> Wrench<R> {
        let Wrench { force, torque } = self.force.wrench(motion);
        let speed = motion.linear_velocity.length();
        Wrench {
            force: self.fault.vector(0, speed, force),
            torque: self.fault.vector(1, speed, torque),
        }
    }
    fn is_passive(&self) -> bool {
        self.is_reversed ^ self.force.is_passive()
    }
    fn constant_force(&self) -> Option<R::Vec3> {
        if self.fault.method == 2 {
            let any = self.fault.vector(2, self.fault.from, R::Vec3::ZERO);
            return Some(any);
        }
        self.force.constant_force()
    }
    fn power(&self, motion: &Motion<R>) -> ForcePower<R> {
        let power = self.force.power(motion);
        let speed = motion.linear_velocity.length();
        ForcePower {
            drag: self.fault.of(3, speed, power.drag),
            drive: self.fault.of(4, speed, power.drive),
        }
    }
    fn wrench_change(
        &self,
        motion: &Motion<R>,
        linear_change: R::Vec3,
        angular_change: R::Vec3,
    ) -> Wrench<R> {
        let change = (self.force).wrench_change(motion, linear_change, angular_change);
        let size = linear_change.length();
        Wrench {
            force: self.fault.vector(5, size, change.force),
            torque: self.fault.vector(6, size, change.torque),
        }
    }
    fn acts(&self) -> bool {
        (self.fault.method == 7) ^ self.force.acts()
    }
    fn check(&self) -> Result<(), SceneError> {
        self.force.check()
    }
}

struct SpoiltFriction<R>(AnyFriction<R>, Fault<R>);

impl<R: Real> SlidingFriction<R> for SpoiltFriction<R> {
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        let force = self.0.force(normal_force, slip);
        self.1.vector(0, slip.x(), force)
    }
    fn jacobian(&self, normal_force: R, slip: R::Vec3) -> FrictionJacobian<R> {
        let mut jacobian = self.0.jacobian(normal_force, slip);
        jacobian.coefficient = self.1.of(1, slip.x(), jacobian.coefficient);
        jacobian.growth = self.1.of(2, slip.x(), jacobian.growth);
        jacobian.per_load = self.1.of(3, slip.x(), jacobian.per_load);
        jacobian.width = self.1.of(4, slip.x(), jacobian.width);
        jacobian
    }
    fn rolling_resistance(&self, normal_force: R) -> Option<RollingResistance<R>> {
        if self.1.method == 5 && normal_force >= self.1.from {
            return Some(RollingResistance {
                rolling: self.1.any(),
                spinning: self.1.any(),
                turn_speed: self.1.any(),
            });
        }
        self.0.rolling_resistance(normal_force)
    }
    fn check(&self) -> Result<(), SceneError> {
        self.0.check()
    }
}

struct SpoiltBody<R: Real> {
    body: AnyBody<R>,
    fault: Fault<R>,
    contacts: Vec<ContactPoint<R>>,
    rims: Vec<Rim<R>>,
}

impl<R: Real> SpoiltBody<R> {
    fn read(input: &mut Input<'_>) -> Result<Self, SceneError> {
        let (body, fault) = (body::<R>(input)?, Fault::<R>::read(input));
        let mut contacts = body.contacts().to_vec();
        if fault.method == 0 {
            for contact in contacts.iter_mut().take(usize::from(input.below(4))) {
                contact.position = input.vector::<R>(1e-3, 1.0);
                contact.radius = input.signed(1e-3, 1.0);
            }
        }
        let mut rims = Vec::new();
        if fault.method == 1 {
            for _ in 0..input.below(3) {
                let (centre, axis) = (input.vector::<R>(1e-3, 0.1), input.vector::<R>(0.1, 1.0));
                let points = usize::from(input.short());
                rims.push(Rim::new(centre, axis, input.size(1e-3, 1.0), points));
            }
        }
        Ok(Self {
            body,
            fault,
            contacts,
            rims,
        })
    }

    fn range(&self, method: u8, argument: R, range: ContactRange) -> ContactRange {
        if self.fault.method == method && argument >= self.fault.from {
            ContactRange {
                first: self.fault.index(),
                count: self.fault.index(),
            }
        } else {
            range
        }
    }
}

impl<R: Real> RigidPointBody<R> for SpoiltBody<R> {
    fn mass(&self) -> R {
        self.fault.of(2, R::MAX, self.body.mass())
    }
    fn inertia(&self) -> R::Mat3 {
        let columns = self.body.inertia().columns();
        R::Mat3::from_columns(columns.map(|column| self.fault.vector(3, R::MAX, column)))
    }
    fn contacts(&self) -> &[ContactPoint<R>] {
        &self.contacts
    }
    fn rims(&self) -> &[Rim<R>] {
        if self.fault.method == 1 {
            &self.rims
        } else {
            self.body.rims()
        }
    }
    fn bounding_radius(&self) -> R {
        self.fault.of(4, R::MAX, self.body.bounding_radius())
    }
    fn contacts_below(&self, normal: R::Vec3, offset: R) -> ContactRange {
        self.range(5, offset, self.body.contacts_below(normal, offset))
    }
    fn contacts_below_near(&self, normal: R::Vec3, offset: R, near: ContactRange) -> ContactRange {
        let range = self.body.contacts_below_near(normal, offset, near);
        self.range(6, offset, range)
    }
    fn support(&self, direction: R::Vec3) -> R {
        let support = self.body.support(direction);
        self.fault.of(7, direction.x(), support)
    }
    fn support_point(&self, towards: R::Vec3) -> R::Vec3 {
        let point = self.body.support_point(towards);
        self.fault.vector(8, towards.x(), point)
    }
    fn is_smooth(&self) -> bool {
        (self.fault.method == 9) ^ self.body.is_smooth()
    }
    fn check(&self) -> Result<(), SceneError> {
        self.body.check()
    }
}

/// Checks and steps of three spoilt parts.
fn play<R: Real>(input: &mut Input<'_>) {
    let plan = plan(input);
    let (method, gravity) = (method(input), gravity(input));
    let Ok(inner) = ground(input) else {
        return;
    };
    let ground = SpoiltGround(inner, Fault::read(input));
    let friction = SpoiltFriction(friction::<R>(input), Fault::read(input));
    let Ok(body) = SpoiltBody::<R>::read(input) else {
        return;
    };
    let range = GroundRange {
        centre: input.vector::<R>(1e-2, 1.0),
        size: input.size(0.1, 1.0),
        depth: input.size(1e-3, 1e-1),
        speed: input.size(0.1, 10.0),
    };
    let slides = FrictionRange {
        centre: range.centre,
        size: range.size,
        normal: input.vector::<R>(0.1, 1.0),
        normal_force: input.size(1.0, 1e3),
        slip: input.size(0.1, 10.0),
    };
    show(check_ground(
        &ground as &dyn SpringDamperGround<R>,
        &range,
        plan,
    ));
    show(check_friction(
        &friction as &dyn SlidingFriction<R>,
        &slides,
        plan,
    ));
    show(check_body(&body as &dyn RigidPointBody<R>, plan));
    let mut state: State<R> = state(input);
    // After all that older inputs have.
    let force = spoilt_force(input, plan);
    let ground = Meter::new(Box::new(ground), false);
    let stepper = Stepper::new(&body as &dyn RigidPointBody<R>)
        .and_then(|stepper| stepper.with_ground(&ground))
        .and_then(|stepper| stepper.with_friction(&friction as &dyn SlidingFriction<R>))
        .and_then(|stepper| stepper.with_gravity(gravity))
        .and_then(|stepper| stepper.with_force(&*force))
        .and_then(|stepper| stepper.with_integrator(method));
    let Ok(stepper) = stepper else {
        return;
    };
    let _ = (stepper.lowest_point(&state), stepper.touching(&state));
    let _ = stepper.largest_stable_step(&state);
    for _ in 0..8 {
        if stepper.step(&mut state).is_err() {
            break;
        }
        assert!(state.not_finite().is_none(), "{state:?}");
    }
}

/// A spoilt force of any kind, or none, and its check.
fn spoilt_force<R: Real>(input: &mut Input<'_>, plan: CheckPlan) -> AnyForce<R> {
    if !input.flag() {
        return Box::new(NoForce);
    }
    let spoilt = SpoiltForce::<R> {
        force: force(input),
        fault: Fault::read(input),
        is_reversed: input.flag(),
    };
    let range = ForceRange {
        centre: input.vector::<R>(1e-2, 1.0),
        size: input.size(0.1, 1.0),
        speed: input.size(0.1, 1e2),
        angular_speed: input.size(0.1, 1e2),
    };
    show(check_force(&spoilt as &dyn Force<R>, &range, plan));
    Box::new(spoilt)
}

/// The text of a violation is not empty.
fn show(outcome: Result<(), tumble::contract::Violation>) {
    if let Err(violation) = outcome {
        assert!(!violation.to_string().is_empty());
    }
}

/// A built-in integrator with results of any bits.
struct SpoiltIntegrator {
    method: AnyIntegrator<f64>,
    fault: Fault<f64>,
}

impl Integrator<f64> for SpoiltIntegrator {
    type Workspace = <AnyIntegrator<f64> as Integrator<f64>>::Workspace;
    const ADAPTIVE: bool = true;

    #[inline(never)]
    fn step<D: Dynamics<f64>>(
        &self,
        scene: &D,
        state: &mut State<f64>,
        limit: f64,
        workspace: &mut Self::Workspace,
    ) -> Result<Step<f64>, StepError> {
        let fault = &self.fault;
        let mut step = self.method.step(scene, state, limit, workspace)?;
        step.elapsed = fault.of(0, limit, step.elapsed);
        state.position = fault.vector(1, limit, state.position);
        state.linear_velocity = fault.vector(2, limit, state.linear_velocity);
        state.angular_momentum = fault.vector(3, limit, state.angular_momentum);
        if fault.method == 4 && limit >= fault.from {
            return Err(StepError::Stalled);
        }
        Ok(step)
    }
    fn order(&self) -> u32 {
        if self.fault.method == 5 {
            u32::try_from(self.fault.index()).unwrap_or(u32::MAX)
        } else {
            self.method.order()
        }
    }
    fn fixed_step(&self) -> Option<f64> {
        let own = self.method.fixed_step();
        if self.fault.method == 6 {
            Some(self.fault.any())
        } else {
            own
        }
    }
    fn check(&self) -> Result<(), SceneError> {
        self.method.check()
    }
}

fn play_integrator(input: &mut Input<'_>) {
    let plan = plan(input);
    let method = method::<f64>(input).method;
    let fault = Fault::read(input);
    let integrator = SpoiltIntegrator { method, fault };
    show(check_integrator::<f64, _>(&integrator, plan));
    show(check_energy_never_rises::<f64, _>(&integrator, plan));
}

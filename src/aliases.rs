//! All names of the crate for one precision, in the modules `f32` and `f64`.

/// Defines the module of names for one precision: aliases of generic types, and re-exports of the
/// other items.
macro_rules! names_for {
    ($real:ident, $summary:literal) => {
        #[doc = $summary]
        ///
        /// Import all of it if the compiler cannot infer the precision. This is the case for a
        /// `State` or a `Ledger` that stands alone, or for a struct of your own. The traits are
        /// those of the crate: for `f32` write `RigidPointBody<f32>`.
        pub mod $real {
            #[doc(no_inline)]
            pub use crate::{
                Apex, CoinFace, ContactCloses, ContactLaw, ContactOpens, CuboidFace, Event,
                EventDirection, Every, Faces, Flight, Force, FrictionField, Frictionless, Gravity,
                HeightField, HullFace, Integrator, Landing, LiftOff, NoForce, NoGravity, NoGround,
                Observer, Outcome, RigidPointBody, SceneError, SceneQuery, Shape, SlidingFriction,
                SpringDamperGround, Start, StateError, StepError, Terrain,
            };

            /// Energy, dissipation and rates of a state.
            pub type EnergyRates = crate::EnergyRates<$real>;
            /// Drag of still air.
            pub type AirDrag = crate::AirDrag<$real>;
            /// Coulomb friction with two coefficients, along and across the grain of the ground.
            pub type AnisotropicCoulomb = crate::AnisotropicCoulomb<$real>;
            /// The default integrator with a tolerance instead of a step size.
            pub type AdaptiveEnergyMomentum = crate::AdaptiveEnergyMomentum<$real>;
            /// The default integrator with memory for `CONTACTS` contacts.
            pub type CompactEnergyMomentum<const CONTACTS: usize> =
                crate::CompactEnergyMomentum<CONTACTS, $real>;
            /// Nyström's method with a tolerance instead of a step size.
            pub type AdaptiveNystrom = crate::AdaptiveNystrom<$real>;
            /// Radau's implicit method of order 5.
            pub type Radau5 = crate::Radau5<$real>;
            /// A built-in integrator chosen at run time.
            pub type AnyIntegrator = crate::AnyIntegrator<$real>;
            /// Torque-free rotation in closed form.
            pub type FreeRotation = crate::FreeRotation<$real>;
            /// Axes of the body in the world.
            pub type Axes = crate::rotation::Axes<$real>;
            /// Height field of a bowl, a trough, a hill or a saddle.
            pub type Bowl = crate::Bowl<$real>;
            /// Surface of a box, from outside.
            pub type Block = crate::Block<$real>;
            /// Mass of a body and number of contacts that support it.
            pub type Carried = crate::Carried<$real>;
            /// Speed at touch-down and restitution of a bounce.
            pub type Impact = crate::Impact<$real>;

            /// A cylinder with hemispherical ends.
            pub type Capsule = crate::Capsule<$real>;
            /// A cone.
            pub type Cone<P = [ContactPoint; 121]> = crate::Cone<$real, P>;
            /// A box with a contact at each corner, sharp or round.
            pub type Cuboid = crate::Cuboid<$real>;
            /// A thin coin with a round rim.
            pub type Disc = crate::Disc<$real>;
            /// A circle that can touch along its whole length.
            pub type Rim = crate::Rim<$real>;
            /// A smooth ellipsoid.
            pub type Ellipsoid = crate::Ellipsoid<$real>;
            /// Mass, centre of mass and inertia of a body or a part.
            pub type MassProperties = crate::MassProperties<$real>;
            /// A point mass.
            pub type PointMass = crate::PointMass<$real>;
            /// A thin straight rod.
            pub type Rod = crate::Rod<$real>;
            /// A body of given mass distribution and contacts.
            pub type Solid<P> = crate::Solid<$real, P>;
            /// A coin of given thickness.
            pub type SolidCoin<P = [ContactPoint; 240]> = crate::SolidCoin<$real, P>;
            /// A coin of given thickness with two round rims.
            pub type ThickDisc = crate::ThickDisc<$real>;
            /// A ball.
            pub type Sphere = crate::Sphere<$real>;
            /// The error-controlled integrator of order 3.
            pub type BogackiShampine32 = crate::BogackiShampine32<$real>;
            /// The coin of the coin report.
            pub type Coin<P = [ContactPoint; 120]> = crate::Coin<$real, P>;
            /// A constant force at the centre of mass.
            pub type ConstantForce = crate::ConstantForce<$real>;
            /// A contact that penetrates the ground.
            pub type Contact = crate::Contact<$real>;
            /// A point of the body that can touch the ground.
            pub type ContactPoint = crate::ContactPoint<$real>;
            /// Coulomb friction in the form of the coin report.
            pub type Coulomb = crate::Coulomb<$real>;
            /// Dissipated power by kind.
            pub type Dissipation = crate::Dissipation<$real>;
            /// The error-controlled integrator of order 5.
            pub type DormandPrince54 = crate::DormandPrince54<$real>;
            /// Local derivatives of a friction law.
            pub type FrictionJacobian = crate::FrictionJacobian<$real>;
            /// Height, gradient and hessian of a terrain at a point.
            pub type Elevation = crate::Elevation<$real>;
            /// Energy by kind.
            pub type Energy = crate::Energy<$real>;
            /// The integrator whose energy never increases.
            pub type EnergyMomentum = crate::EnergyMomentum<$real>;
            /// Bounds of the region that a ground occupies.
            pub type GroundBounds = crate::GroundBounds<$real>;
            /// A plane ground of springs and dampers.
            pub type FlatGround = crate::FlatGround<$real>;
            /// Motion of a ground's material.
            pub type GroundMotion = crate::GroundMotion<$real>;
            /// A ground whose material moves along its surface.
            pub type MovingGround<G> = crate::MovingGround<G, $real>;
            /// The integrator of the coin report.
            pub type ForwardEuler = crate::ForwardEuler<$real>;
            /// Range of motions for the check of an applied force.
            pub type ForceRange = crate::contract::ForceRange<$real>;
            /// Power of an applied force by kind.
            pub type ForcePower = crate::ForcePower<$real>;
            /// One friction law in a region of the ground and another one around it.
            pub type FrictionPatch<O, I> = crate::FrictionPatch<O, I, $real>;
            /// Range of loads and slips for the check of a friction law.
            pub type FrictionRange = crate::contract::FrictionRange<$real>;
            /// A contact law on a shape.
            pub type Ground<L, S = Plane> = crate::Ground<L, S>;
            /// Region, penetration depths and speeds for the check of a ground.
            pub type GroundRange = crate::contract::GroundRange<$real>;
            /// The contact law of Hunt and Crossley.
            pub type HuntCrossley = crate::HuntCrossley<$real>;
            /// Energy audit of a run.
            pub type Ledger = crate::Ledger<$real>;
            /// A spring with a limited damper.
            pub type LimitedDamper = crate::LimitedDamper<$real>;
            /// Force and torque of the ground on the body.
            pub type Load = crate::Load<$real>;
            /// Coulomb friction whose coefficient decreases with the load.
            pub type LoadDependentCoulomb = crate::LoadDependentCoulomb<$real>;
            /// The lowest point of a body.
            pub type LowestPoint = crate::LowestPoint<$real>;
            /// Mass and inertia, computed once for all steps.
            pub type InertiaProperties = crate::InertiaProperties<$real>;
            /// Mean normal force over a step.
            pub type MeanForce = crate::MeanForce<$real>;
            /// Pose and velocities of a body.
            pub type Motion = crate::Motion<$real>;
            /// Nyström's method, corrected for touch-downs.
            pub type Nystrom = crate::Nystrom<$real>;
            /// A plane.
            pub type Plane = crate::Plane<$real>;
            /// A body made of the user's own points.
            pub type PointCloud<P> = crate::PointCloud<$real, P>;
            /// Height field of a level ground that becomes a slope.
            pub type Ramp = crate::Ramp<$real>;
            /// Rates of change of a state.
            pub type Rates = crate::Rates<$real>;
            /// The classical Runge-Kutta integrator.
            pub type Rk4 = crate::Rk4<$real>;
            /// A rotation.
            pub type Rotation = crate::Rotation<$real>;
            /// Sample of a run at one time.
            pub type Sample<'a> = crate::Sample<'a, $real>;
            /// Body, ground, friction, gravity and applied force.
            pub type Scene<B, G = NoGround, F = Frictionless, A = NoGravity, E = NoForce> =
                crate::Scene<B, G, F, A, $real, E>;
            /// Time, number of steps and state at one moment of a session.
            pub type Moment = crate::Moment<$real>;
            /// A session as plain data.
            pub type SavedSession = crate::SavedSession<$real>;
            /// One state that is advanced in time, with the data kept from step to step.
            pub type Session<
                'a,
                B,
                G = NoGround,
                F = Frictionless,
                A = NoGravity,
                I = EnergyMomentum,
                E = NoForce,
            > = crate::Session<'a, B, G, F, A, I, $real, E>;
            /// One step of a session, with the states within it.
            pub type DenseStep<
                'a,
                B,
                G = NoGround,
                F = Frictionless,
                A = NoGravity,
                I = EnergyMomentum,
                E = NoForce,
            > = crate::DenseStep<'a, B, G, F, A, I, $real, E>;
            /// How a run with events has ended.
            pub type EventEnd = crate::EventEnd<$real>;
            /// Event with a chosen direction, count or interval.
            pub type EventWith<E> = crate::EventWith<E, $real>;
            /// One occurrence of an event in a run.
            pub type Occurrence = crate::Occurrence<$real>;
            /// Event that the slip of the lowest point ends.
            pub type SlipEnds = crate::SlipEnds<$real>;
            /// Step size and related data from which an adaptive method continues.
            pub type StepControl = crate::StepControl<$real>;
            /// Coulomb friction with a smooth transition at small slip.
            pub type SmoothCoulomb = crate::SmoothCoulomb<$real>;
            /// The contact law of the coin report.
            pub type SpringDamper = crate::SpringDamper<$real>;
            /// The state of a body.
            pub type State = crate::State<$real>;
            /// Result of a step: time advanced and work.
            pub type Step = crate::Step<$real>;
            /// Advances states in time.
            pub type Stepper<
                B,
                G = NoGround,
                F = Frictionless,
                A = NoGravity,
                I = EnergyMomentum,
                E = NoForce,
            > = crate::Stepper<B, G, F, A, I, $real, E>;
            /// Torque of still air against spin.
            pub type SpinDrag = crate::SpinDrag<$real>;
            /// Lift of a spinning ball.
            pub type SpinLift = crate::SpinLift<$real>;
            /// The splitting integrator of order 2.
            pub type StrangSplitting = crate::StrangSplitting<$real>;
            /// Friction with a static and a kinetic coefficient.
            pub type Stribeck = crate::Stribeck<$real>;
            /// Surface of the ground relative to a point.
            pub type Surface = crate::Surface<$real>;
            /// The semi-implicit Euler integrator.
            pub type SymplecticEuler = crate::SymplecticEuler<$real>;
            /// Passes states at given times to another observer.
            pub type Timed<O> = crate::Timed<O, $real>;
            /// A trial of the coin report.
            pub type Trial = crate::Trial<$real>;
            /// The stepper of a trial.
            pub type TrialStepper<I> = crate::trial::TrialStepper<I, $real>;
            /// Torque of a contact against rolling and spinning.
            pub type RollingResistance = crate::RollingResistance<$real>;
            /// Uniform gravity.
            pub type UniformGravity = crate::UniformGravity<$real>;
            /// A friction law that also resists rolling and spinning.
            pub type WithResistance<F> = crate::WithResistance<F, $real>;
            /// Energy barriers between the faces of a body.
            pub type Barriers<'a, D> = crate::Barriers<'a, D, $real>;
            /// Directions of a body that belong to one face.
            pub type Basin<F> = crate::Basin<F, $real>;
            /// Ends a run when the face is decided.
            pub type UntilDecided<'a, D> = crate::UntilDecided<'a, D, $real>;
            /// Ends a run when the body is at rest.
            pub type UntilRest = crate::UntilRest<$real>;
            /// Height field of waves along x.
            pub type Waves = crate::Waves<$real>;
            /// A force of the air in moving air.
            pub type Wind<E> = crate::Wind<E, $real>;
            /// Force and torque of an applied force.
            pub type Wrench = crate::Wrench<$real>;
            /// Region of the ground with another friction law.
            pub type Region = crate::Region<$real>;
            /// Friction proportional to load and slip.
            pub type Viscous = crate::Viscous<$real>;
        }
    };
}

names_for!(
    f32,
    "Bodies, grounds, laws, integrators and results in single precision."
);
names_for!(
    f64,
    "Bodies, grounds, laws, integrators and results in double precision."
);

#[cfg(test)]
mod tests {
    /// Code as a user writes it: no type annotation beyond the one import, and number methods
    /// called directly.
    macro_rules! a_short_throw {
        ($name:ident, $real:ident, $vector:ident) => {
            #[test]
            fn $name() {
                use crate::$real::*;
                use glam::$vector as Vector;

                let trial = Trial::report(1).unwrap();
                assert!(trial.tilt.abs() > 0.2);
                let mut ledger = Ledger::new();
                assert!(ledger.energy_error().abs() < 1e-30);

                let masses = [0.1; 2];
                let body = PointCloud::new([Vector::X, -Vector::X], masses).unwrap();
                let stepper = Stepper::new(body)
                    .unwrap()
                    .with_ground(FlatGround::level(1000.0, 0.5))
                    .unwrap()
                    .with_friction(Coulomb {
                        coefficient: 0.3,
                        slip_speed: 1e-3,
                    })
                    .unwrap()
                    .with_gravity(UniformGravity::down(9.8))
                    .unwrap();
                let mut state = State::at(Vector::Z);
                assert!(state.position.z.abs() > 0.5);
                stepper.run(&mut state, 0.1, &mut ledger).unwrap();
                let fallen = stepper.energy(&state).translation.sqrt();
                assert!(fallen > 0.1 && fallen < 1.0, "{fallen}");
            }
        };
    }
    a_short_throw!(names_for_double_precision_need_no_annotation, f64, DVec3);
    a_short_throw!(names_for_single_precision_need_no_annotation, f32, Vec3);

    #[test]
    fn the_modules_leave_the_number_types_their_names() {
        use crate::*;
        let (one, half): (f64, f32) = (1.0, 0.5);
        assert!(one > f64::EPSILON && half < f32::MAX);
    }

    #[test]
    fn points_and_positions_tell_the_precision() {
        use crate::{PointCloud, State};
        let cloud = PointCloud::new([glam::DVec3::X, -glam::DVec3::X], [0.1; 2]).unwrap();
        assert!(cloud.centre_of_mass().length() < 1e-30);
        assert!(State::at(glam::Vec3::Z).position.z.abs() > 0.5);
    }
}

//! Every name of the crate for one precision.

/// A module of names for one precision: aliases of what is generic, and what is not as it is.
macro_rules! names_for {
    ($real:ident, $summary:literal) => {
        #[doc = $summary]
        ///
        /// `use` all of it where the compiler cannot see the precision: a state or a ledger that
        /// stands alone, or a struct of the user's. The traits are those of the crate: for `f32`
        /// say `RigidPointBody<f32>`.
        pub mod $real {
            #[doc(no_inline)]
            pub use crate::{
                CoinFace, ContactLaw, CuboidFace, Every, Flight, Frictionless, Gravity,
                HeightField, Integrator, NoGravity, NoGround, Observer, RigidPointBody, SceneError,
                SceneQuery, Shape, SlidingFriction, SpringDamperGround, Start, StepError, Terrain,
            };

            /// Energy, dissipation and rates.
            pub type EnergyRates = crate::EnergyRates<$real>;
            /// Coulomb friction with a grain.
            pub type AnisotropicCoulomb = crate::AnisotropicCoulomb<$real>;
            /// A built-in integrator that is chosen at run time.
            pub type AnyIntegrator = crate::AnyIntegrator<$real>;
            /// The body's axes in the world.
            pub type Axes = crate::rotation::Axes<$real>;
            /// A bowl, a trough, a hill or a saddle.
            pub type Bowl = crate::Bowl<$real>;
            /// What a ground carries.
            pub type Carried = crate::Carried<$real>;

            /// A cylinder with round ends.
            pub type Capsule = crate::Capsule<$real>;
            /// A cone.
            pub type Cone<P = [ContactPoint; 121]> = crate::Cone<$real, P>;
            /// A box, sharp or with round corners.
            pub type Cuboid = crate::Cuboid<$real>;
            /// A coin with a round rim.
            pub type Disc = crate::Disc<$real>;
            /// A circle that can touch all round.
            pub type Rim = crate::Rim<$real>;
            /// A smooth ellipsoid.
            pub type Ellipsoid = crate::Ellipsoid<$real>;
            /// Mass, centre of mass and inertia of a body or a part.
            pub type MassProperties = crate::MassProperties<$real>;
            /// A point with a mass.
            pub type PointMass = crate::PointMass<$real>;
            /// A thin straight rod.
            pub type Rod = crate::Rod<$real>;
            /// A body of any mass distribution and contacts.
            pub type Solid<P> = crate::Solid<$real, P>;
            /// A coin with a thickness.
            pub type SolidCoin<P = [ContactPoint; 240]> = crate::SolidCoin<$real, P>;
            /// A ball.
            pub type Sphere = crate::Sphere<$real>;
            /// The error-controlled integrator of order 3.
            pub type BogackiShampine32 = crate::BogackiShampine32<$real>;
            /// The coin of the report.
            pub type Coin<P = [ContactPoint; 120]> = crate::Coin<$real, P>;
            /// A contact that touches.
            pub type Contact = crate::Contact<$real>;
            /// A place of the body that can touch the ground.
            pub type ContactPoint = crate::ContactPoint<$real>;
            /// Coulomb friction in the report's form.
            pub type Coulomb = crate::Coulomb<$real>;
            /// Power of what takes energy away.
            pub type Dissipation = crate::Dissipation<$real>;
            /// The error-controlled integrator of order 5.
            pub type DormandPrince54 = crate::DormandPrince54<$real>;
            /// The local shape of a friction law.
            pub type FrictionJacobian = crate::FrictionJacobian<$real>;
            /// Height, slope and bend of a terrain.
            pub type Elevation = crate::Elevation<$real>;
            /// Energy by kind.
            pub type Energy = crate::Energy<$real>;
            /// The integrator whose energy never rises.
            pub type EnergyMomentum = crate::EnergyMomentum<$real>;
            /// Where a ground can be.
            pub type GroundBounds = crate::GroundBounds<$real>;
            /// A plane of springs and dampers.
            pub type FlatGround = crate::FlatGround<$real>;
            /// The report's integrator.
            pub type ForwardEuler = crate::ForwardEuler<$real>;
            /// What a friction law is checked with.
            pub type FrictionRange = crate::contract::FrictionRange<$real>;
            /// A law of contact on a shape.
            pub type Ground<L, S = Plane> = crate::Ground<L, S>;
            /// What a ground is checked with.
            pub type GroundRange = crate::contract::GroundRange<$real>;
            /// Hunt and Crossley's law of contact.
            pub type HuntCrossley = crate::HuntCrossley<$real>;
            /// The energy books of a run.
            pub type Ledger = crate::Ledger<$real>;
            /// A spring with a limited damper.
            pub type LimitedDamper = crate::LimitedDamper<$real>;
            /// Force and torque of the ground.
            pub type Load = crate::Load<$real>;
            /// Coulomb friction whose coefficient falls with the load.
            pub type LoadDependentCoulomb = crate::LoadDependentCoulomb<$real>;
            /// The lowest point of a body.
            pub type LowestPoint = crate::LowestPoint<$real>;
            /// Mass and inertia as a step needs them.
            pub type InertiaProperties = crate::InertiaProperties<$real>;
            /// The mean normal force over a step.
            pub type MeanForce = crate::MeanForce<$real>;
            /// Where a body is and how it moves.
            pub type Motion = crate::Motion<$real>;
            /// Nyström's method, with touch-downs set right.
            pub type Nystrom = crate::Nystrom<$real>;
            /// A plane.
            pub type Plane = crate::Plane<$real>;
            /// A body of the user's own points.
            pub type PointCloud<P> = crate::PointCloud<$real, P>;
            /// A level ground that becomes a slope.
            pub type Ramp = crate::Ramp<$real>;
            /// How fast a state changes.
            pub type Rates = crate::Rates<$real>;
            /// The classical Runge-Kutta integrator.
            pub type Rk4 = crate::Rk4<$real>;
            /// A turn.
            pub type Rotation = crate::Rotation<$real>;
            /// A moment of a run.
            pub type Sample<'a> = crate::Sample<'a, $real>;
            /// Body, ground, friction and gravity.
            pub type Scene<B, G = NoGround, F = Frictionless, A = NoGravity> =
                crate::Scene<$real, B, G, F, A>;
            /// A state, a time and a number of steps.
            pub type Moment = crate::Moment<$real>;
            /// A session as plain data.
            pub type SavedSession = crate::SavedSession<$real>;
            /// One state that is moved on with what is remembered from step to step.
            pub type Session<
                'a,
                B,
                G = NoGround,
                F = Frictionless,
                A = NoGravity,
                I = EnergyMomentum,
            > = crate::Session<'a, $real, B, G, F, A, I>;
            /// The choice of the next step by an adaptive method.
            pub type StepControl = crate::StepControl<$real>;
            /// Coulomb friction with all its derivatives.
            pub type SmoothCoulomb = crate::SmoothCoulomb<$real>;
            /// The report's law of contact.
            pub type SpringDamper = crate::SpringDamper<$real>;
            /// The state of a body.
            pub type State = crate::State<$real>;
            /// What a step did.
            pub type Step = crate::Step<$real>;
            /// Moves states on in time.
            pub type Stepper<B, G = NoGround, F = Frictionless, A = NoGravity, I = EnergyMomentum> =
                crate::Stepper<$real, B, G, F, A, I>;
            /// The splitting integrator of order 2.
            pub type StrangSplitting = crate::StrangSplitting<$real>;
            /// Friction with a static and a kinetic coefficient.
            pub type Stribeck = crate::Stribeck<$real>;
            /// The ground's surface as seen from a point.
            pub type Surface = crate::Surface<$real>;
            /// The semi-implicit Euler integrator.
            pub type SymplecticEuler = crate::SymplecticEuler<$real>;
            /// Looks at given times.
            pub type Timed<O> = crate::Timed<O, $real>;
            /// A start of the report.
            pub type Trial = crate::Trial<$real>;
            /// The stepper of a trial.
            pub type TrialStepper<I> = crate::trial::TrialStepper<$real, I>;
            /// Torque against rolling and spinning.
            pub type RollingResistance = crate::RollingResistance<$real>;
            /// Gravity, the same everywhere.
            pub type UniformGravity = crate::UniformGravity<$real>;
            /// A friction law that also resists rolling and spinning.
            pub type WithResistance<F> = crate::WithResistance<F, $real>;
            /// Ends a run when the body lies still.
            pub type UntilRest = crate::UntilRest<$real>;
            /// Waves of the ground.
            pub type Waves = crate::Waves<$real>;
            /// Friction in proportion to the slip.
            pub type Viscous = crate::Viscous<$real>;
        }
    };
}

names_for!(f32, "Every name of the crate in single precision.");
names_for!(f64, "Every name of the crate in double precision.");

#[cfg(test)]
mod tests {
    /// What a user writes: no annotation of a type beyond the one import, and methods of the
    /// numbers right away.
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

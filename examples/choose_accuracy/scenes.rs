//! The scenes of the work-precision measurement: coins that roll, fall over, bounce and rest.

use core::error::Error;

use tumble::glam::DVec3;
use tumble::real::{Quaternion, Vector};
use tumble::work_precision::{Reference, Setting, WorkPrecision, measure_against, reference};
use tumble::{
    Coin, ContactPoint, Coulomb, FlatGround, FrictionJacobian, Frictionless, Real, Scene,
    SceneError, SlidingFriction, SmoothCoulomb, State, Trial, UniformGravity,
};

type CoinScene<R, F> = Scene<Coin<R, Vec<ContactPoint<R>>>, FlatGround<R>, F, UniformGravity<R>, R>;

/// Measures settings on a scene, in single or double precision.
pub(crate) type Measured = Box<dyn Fn(&[Setting], bool) -> WorkPrecision>;

/// A friction law with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Friction {
    Coulomb { coefficient: f64, slip_speed: f64 },
    Smooth { coefficient: f64, slip_speed: f64 },
    None,
}

impl Friction {
    fn law<R: Real>(self) -> Law<R> {
        match self {
            Self::Coulomb {
                coefficient,
                slip_speed,
            } => Law::Coulomb(Coulomb {
                coefficient: R::from_f64(coefficient),
                slip_speed: R::from_f64(slip_speed),
            }),
            Self::Smooth {
                coefficient,
                slip_speed,
            } => Law::Smooth(SmoothCoulomb {
                coefficient: R::from_f64(coefficient),
                slip_speed: R::from_f64(slip_speed),
            }),
            Self::None => Law::None(Frictionless),
        }
    }
}

/// The law of the friction of a scene.
///
/// One type for all of them: every integrator is compiled for each type of scene.
enum Law<R: Real> {
    Coulomb(Coulomb<R>),
    Smooth(SmoothCoulomb<R>),
    None(Frictionless),
}

/// Calls a method of the law.
macro_rules! of_law {
    ($law:expr, $name:ident($($argument:expr),*)) => {
        match $law {
            Law::Coulomb(law) => SlidingFriction::<R>::$name(law, $($argument),*),
            Law::Smooth(law) => SlidingFriction::<R>::$name(law, $($argument),*),
            Law::None(law) => SlidingFriction::<R>::$name(law, $($argument),*),
        }
    };
}

impl<R: Real> SlidingFriction<R> for Law<R> {
    #[inline]
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        of_law!(self, force(normal_force, slip))
    }
    #[inline]
    fn jacobian(&self, normal_force: R, slip: R::Vec3) -> FrictionJacobian<R> {
        of_law!(self, jacobian(normal_force, slip))
    }
    fn check(&self) -> Result<(), SceneError> {
        of_law!(self, check())
    }
    fn is_trusted(&self) -> bool {
        of_law!(self, is_trusted())
    }
}

/// A coin of 1 kg and 0.5 m on level ground, and its start.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Start {
    pub(crate) name: String,
    pub(crate) points: usize,
    /// Stiffness of a point of a coin with 120 points, N/m. With more points each is softer, so
    /// that the sum is the same.
    pub(crate) stiffness: f64,
    /// Damping of a point of a coin with 120 points, N s/m. The sum is the same for any number of
    /// points.
    pub(crate) damping: f64,
    pub(crate) friction: Friction,
    pub(crate) state: State,
    /// Duration, s.
    pub(crate) seconds: f64,
}

const GRAVITY: f64 = 9.8;

impl Start {
    /// A trial of the coin report, for one second.
    pub(crate) fn trial(number: usize) -> Option<Self> {
        let trial = Trial::report(number)?;
        Some(Self {
            name: format!("trial {number}"),
            points: 120,
            stiffness: 1000.0,
            damping: 0.5,
            friction: Friction::Coulomb {
                coefficient: trial.friction().coefficient,
                slip_speed: 1e-3,
            },
            state: trial.state(),
            seconds: 1.0,
        })
    }

    /// Returns the scene of a name: `trial1` to `trial8`, `toss`, `smooth`, `stiff`, `rest`.
    pub(crate) fn named(name: &str) -> Option<Self> {
        let rolls = Self::trial(1)?;
        let start = match name {
            "toss" => Self {
                name: "a toss with bounces".into(),
                state: State::at(DVec3::new(0.0, 0.0, 1.0))
                    .with_linear_velocity(DVec3::new(0.4, -0.2, 3.0))
                    .with_rotation_vector(DVec3::new(0.3, 0.8, -0.2))
                    .with_angular_momentum(DVec3::new(0.4, 1.1, -0.7)),
                seconds: 1.5,
                ..rolls
            },
            "smooth" => Self {
                name: "frictionless rolling".into(),
                damping: 0.0,
                friction: Friction::None,
                state: rolls
                    .state
                    .with_angular_momentum(rolls.state.angular_momentum * 4.0),
                ..rolls
            },
            "stiff" => Self {
                name: "a stiff ground".into(),
                stiffness: 1e9,
                damping: 1e3,
                state: State::at(DVec3::new(0.0, 0.0, 0.4))
                    .with_rotation_vector(DVec3::new(0.3, 0.8, -0.2))
                    .with_angular_momentum(DVec3::new(0.1, 0.3, -0.2)),
                seconds: 0.4,
                ..rolls
            },
            "rest" => Self {
                name: "rest".into(),
                state: State::at(DVec3::new(0.0, 0.0, -GRAVITY / 120_000.0))
                    .with_rotation_vector(DVec3::Y * core::f64::consts::FRAC_PI_2),
                ..rolls
            },
            _ => Self::trial(name.strip_prefix("trial")?.parse().ok()?)?,
        };
        Some(start)
    }

    /// Measures error and cost in double precision, and in single precision against the same
    /// reference.
    pub(crate) fn curve(
        &self,
        settings: &[Setting],
        single: bool,
    ) -> Result<WorkPrecision, Box<dyn Error>> {
        Ok(self.measured()?(settings, single))
    }

    /// Measures error and cost for any settings, with one computation of the reference.
    pub(crate) fn measured(&self) -> Result<Measured, Box<dyn Error>> {
        match self.friction.law() {
            // The law of the report by itself: costs without a choice between laws.
            Law::Coulomb(law) => self.measured_with(law),
            law => self.measured_with(law),
        }
    }

    fn measured_with<F>(&self, friction: F) -> Result<Measured, Box<dyn Error>>
    where
        F: SlidingFriction + 'static,
    {
        let (start, seconds) = (self.state, self.seconds);
        let scene = self.scene(friction)?;
        let scene_32 = self.scene(self.friction.law::<f32>())?;
        let known = reference(&scene, &start, seconds)?;
        let known_32 = Reference {
            end: in_precision(&known.end),
            resolution: known.resolution,
        };
        Ok(Box::new(move |settings, single| {
            if single {
                let start = in_precision(&start);
                measure_against(&scene_32, &start, seconds as f32, settings, &known_32)
            } else {
                measure_against(&scene, &start, seconds, settings, &known)
            }
        }))
    }

    fn scene<R: Real, F: SlidingFriction<R>>(
        &self,
        friction: F,
    ) -> Result<CoinScene<R, F>, SceneError> {
        let share = 120.0 / self.points as f64;
        let points = vec![ContactPoint::default(); self.points];
        Scene::new(
            Coin::ring_with_storage(points, R::ONE, R::HALF),
            FlatGround::level(
                R::from_f64(self.stiffness * share),
                R::from_f64(self.damping * share),
            ),
            friction,
            UniformGravity::down(R::from_f64(GRAVITY)),
        )
    }
}

/// Converts a state to another precision.
fn in_precision<R: Real>(state: &State) -> State<R> {
    let vector = |v: DVec3| {
        let [x, y, z] = v.to_array().map(R::from_f64);
        R::Vec3::new(x, y, z)
    };
    let [x, y, z, w] = state.orientation.to_array().map(R::from_f64);
    State {
        position: vector(state.position),
        linear_velocity: vector(state.linear_velocity),
        orientation: R::Quat::new(x, y, z, w),
        angular_momentum: vector(state.angular_momentum),
    }
}

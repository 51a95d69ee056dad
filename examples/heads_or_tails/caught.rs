//! A coin tossed and caught: the side that was up at the start is up a little more often.
//!
//! In flight the normal n goes round the angular momentum L at the angle ψ. L is at the angle χ
//! from the vertical. So `n_z = cos ψ cos χ + sin ψ sin χ cos φ`, and with every phase φ as likely
//! as any other at the catch, n points up with `1/2 + asin(min(1, cot ψ cot χ))/π`. For χ = ψ it is
//! the formula of Diaconis, Holmes & Montgomery (SIAM Review 49, 2007).

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use indicatif::ProgressBar;
use tumble::ensemble::{Ensemble, SceneHash, Toss};
use tumble::glam::{DQuat, DVec3};
use tumble::{
    CoinFace, Disc, EnergyMomentum, Outcome as Ended, RigidPointBody, State, Stepper,
    UniformGravity,
};

use crate::count::Count;
use common::Outcome;

/// Angles between normal and angular momentum, degrees.
pub(crate) const ANGLES: [f64; 10] = [40.0, 46.0, 50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0, 89.0];
/// Angles between angular momentum and vertical, degrees; `None` where both angles are equal, as
/// for a coin that starts level.
pub(crate) const TILTS: [Option<f64>; 3] = [None, Some(60.0), Some(85.0)];

/// Fraction of tosses that are caught with the first side up.
pub(crate) fn formula(psi: f64, chi: f64) -> f64 {
    let cot = |degrees: f64| 1.0 / degrees.to_radians().tan();
    0.5 + (cot(psi) * cot(chi)).min(1.0).asin() / PI
}

/// Tosses with catches at equally spaced phases of the normal's motion.
pub(crate) fn count(psi: f64, chi: f64, tosses: u64, bar: &ProgressBar) -> Outcome<Count> {
    // A half-dollar: kg, m.
    let stepper = Stepper::builder(Disc::solid(0.0113, 0.0153, 48))
        .gravity(UniformGravity::down(9.81))
        .integrator(EnergyMomentum { time_step: 0.01 })
        .build()?;
    // Normal along x of the body; at the start as near to the vertical as it comes.
    let lean = chi.to_radians() - psi.to_radians();
    let orientation = DQuat::from_rotation_y(-FRAC_PI_2 + lean);
    let axis = DVec3::new(chi.to_radians().sin(), 0.0, chi.to_radians().cos());
    let coin: &Disc = stepper.body();
    let diameter = coin.inertia().y_axis.y;
    // 38 revolutions a second, caught after some 19 of them.
    let rate = 38.0 * TAU;
    let start = State::at(DVec3::Z)
        .with_linear_velocity(DVec3::Z * 2.4)
        .with_orientation(orientation)
        .with_angular_momentum(axis * (diameter * rate));
    let ensemble = Ensemble::new(0, SceneHash::of_bytes(b"caught"));
    let tally = ensemble.run(0..tosses, |toss: &mut Toss<'_>| {
        let mut state = start;
        let phase = TAU * (19.0 + (toss.number() as f64 + 0.5) / tosses as f64);
        stepper.advance(&mut state, phase / rate)?;
        bar.inc(1);
        Ok(Ended::Decided(stepper.body().face_up(&state)))
    })?;
    crate::spun::check(&tally)?;
    let heads = tally.count(&CoinFace::Heads);
    Ok(Count {
        heads,
        tails: tosses - heads,
        ..Count::default()
    })
}

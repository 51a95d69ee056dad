//! The shots, and the launch angle at which each lands at its target.

use std::f64::consts::TAU;

use common::{BLUE, GREEN, ORANGE, Outcome};
use tumble::State;
use tumble::glam::DVec3;

use crate::flight;
use crate::model::{self, Air, Court, Game};

/// Length of the court from the baseline to the net, the service line and the other baseline, m
/// (Rules of Tennis).
pub(crate) const NET: f64 = 11.885;
pub(crate) const SERVICE_LINE: f64 = 18.285;
pub(crate) const BASELINE: f64 = 23.77;
/// Height of the net in its middle, m.
pub(crate) const NET_HEIGHT: f64 = 0.914;

/// Serve or ground stroke.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stroke {
    Serve,
    Ground,
}

impl Stroke {
    /// Height of the ball over the baseline when it is hit, m.
    ///
    /// Serve: Goodwill, Chin and Haake, J. Wind Eng. Ind. Aerodyn. 92, 935 (2004), figure 10.
    /// Ground stroke: Cross, Sports Eng. 23, 9 (2020), figure 6.
    fn height(self) -> f64 {
        match self {
            Self::Serve => 2.7,
            Self::Ground => 1.0,
        }
    }

    /// Distance of the target from the baseline, m. That of ground strokes is Cross's (2020).
    fn target(self) -> f64 {
        match self {
            Self::Serve => SERVICE_LINE - 0.6,
            Self::Ground => BASELINE - 1.0,
        }
    }
}

/// A shot along x, with z up and y to the left of the player.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shot {
    pub(crate) name: &'static str,
    pub(crate) stroke: Stroke,
    pub(crate) colour: &'static str,
    /// Launch speed, m/s.
    pub(crate) speed: f64,
    /// Spin in revolutions a minute, world axes. Topspin is above 0 about y.
    pub(crate) turns: DVec3,
}

impl Shot {
    /// State at a launch angle above the horizontal, degrees.
    pub(crate) fn start(&self, game: &Game, angle: f64) -> State {
        let (sin, cos) = angle.to_radians().sin_cos();
        let state = State::at(DVec3::Z * self.stroke.height())
            .with_linear_velocity(DVec3::new(cos, 0.0, sin) * self.speed);
        game.with_angular_velocity(state, self.turns * (TAU / 60.0))
    }
}

/// The six shots.
///
/// - Serves: 50 m/s and 2000 revolutions a minute are the example of Goodwill, Chin and Haake
///   (2004). The kick has topspin only and the slice sidespin only, which are the extremes of real
///   serves. The flat one is without spin.
/// - Ground strokes: 30 m/s is the example of Cross (2020). 3200 revolutions a minute are the
///   average of one professional's forehand (Thiem), and 1500 at 50 miles an hour that of a
///   classical slice backhand (Yandell, tennisplayer.net, by high-speed video).
pub(crate) fn all() -> [Shot; 6] {
    let serve = |name, colour, turns| Shot {
        name,
        stroke: Stroke::Serve,
        colour,
        speed: 50.0,
        turns,
    };
    let ground = |name, colour, speed, topspin| Shot {
        name,
        stroke: Stroke::Ground,
        colour,
        speed,
        turns: DVec3::Y * topspin,
    };
    [
        ground("topspin stroke", ORANGE, 30.0, 3200.0),
        ground("flat stroke", BLUE, 30.0, 0.0),
        ground("slice stroke", GREEN, 22.4, -1500.0),
        serve("kick serve", ORANGE, DVec3::Y * 2000.0),
        serve("flat serve", BLUE, DVec3::ZERO),
        serve("slice serve", GREEN, DVec3::Z * 2000.0),
    ]
}

/// Range of launch angles, degrees. Within it a higher angle lands farther.
const ANGLES: [f64; 2] = [-20.0, 35.0];

/// Time step of the flights that only search the angle, s. The landing point is then accurate to
/// about a hundredth of a millimetre, `g h²`.
const SEARCH_STEP: f64 = 1e-3;

/// Launch angle at which a shot lands at its target, degrees.
pub(crate) fn aim(shot: &Shot, court: &Court) -> Outcome<f64> {
    let game = model::stepper(court, &Air::of_speed(shot.speed), SEARCH_STEP)?;
    let target = shot.stroke.target();
    let misses = |angle: f64| -> Outcome<f64> {
        Ok(flight::landing(&game, shot.start(&game, angle))?.x - target)
    };
    let [mut low, mut high] = ANGLES;
    if misses(low)? > 0.0 || misses(high)? < 0.0 {
        let name = shot.name;
        return Err(format!("no launch angle of the {name} lands at {target} m").into());
    }
    // To a ten-thousandth of a degree, which is a tenth of a millimetre at the target.
    while high - low > 1e-4 {
        let middle = 0.5 * (low + high);
        if misses(middle)? < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(0.5 * (low + high))
}

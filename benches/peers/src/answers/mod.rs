//! The scenes, one file for each kind of motion, each with its known result.

mod bounces;
pub(crate) mod coins;
pub(crate) mod free;
mod rigid_hoop;
pub(crate) mod rolling_ball;

use crate::scene::Scene;

/// Acceleration of gravity, m/s².
const GRAVITY: f64 = 9.8;

/// All scenes, in the order of the table.
pub(crate) fn all() -> Result<Vec<Scene>, String> {
    Ok(vec![
        rolling_ball::slides_then_rolls(1e6, 1e-4),
        rolling_ball::slides_then_rolls(1e6, 1e-6),
        rolling_ball::slides_then_rolls(1e9, 1e-4),
        bounces::elastic(1e5),
        bounces::elastic(1e9),
        free::coin(),
        free::fast_coin(),
        free::middle_axis(),
        coins::rolling_hoop()?,
        coins::trial(1, 1.0)?,
        coins::trial(3, 1.0)?,
        coins::trial(8, 1.0)?,
        coins::trial(1, 0.002)?,
        coins::trial(1, 2000.0)?,
        coins::spinning(),
    ])
}

//! Which moments a film needs: the rest lies between them.

use crate::recording::Moment;

/// A moment may be left out where the line between its neighbours is this near, m ...
const LENGTH: f64 = 5e-4;
/// ... and so near in each part of the quaternion (half of an angle in radians).
const ORIENTATION: f64 = 1e-3;
/// Longest gap between two frames, in moments.
const LONGEST: usize = 100;

/// The moments that are needed to draw all of them, first and last included.
/// Neighbouring quaternions have the same sign.
pub(crate) fn kept(moments: &[Moment]) -> Vec<Moment> {
    let moments = with_steady_sign(moments);
    let mut kept = vec![moments[0]];
    let mut from = 0;
    while from + 1 < moments.len() {
        from = next(&moments, from);
        kept.push(moments[from]);
    }
    kept
}

/// The farthest moment such that all between it and `from` lie on the line.
fn next(moments: &[Moment], from: usize) -> usize {
    let last = moments.len() - 1;
    let mut to = from + 1;
    while to < last && to - from < LONGEST && on_the_line(&moments[from..=to + 1]) {
        to += 1;
    }
    to
}

fn on_the_line(stretch: &[Moment]) -> bool {
    let (first, last) = (&stretch[0], &stretch[stretch.len() - 1]);
    let span = last.time - first.time;
    stretch.iter().all(|moment| {
        let part = (moment.time - first.time) / span;
        let centre = first.centre.lerp(last.centre, part);
        let orientation = first.orientation * (1.0 - part) + last.orientation * part;
        centre.distance(moment.centre) < LENGTH
            && (orientation - moment.orientation).length() < ORIENTATION
    })
}

/// `q` and `−q` are the same orientation, but the way from one to the other is a whole turn.
fn with_steady_sign(moments: &[Moment]) -> Vec<Moment> {
    let mut before = moments[0].orientation;
    moments
        .iter()
        .map(|moment| {
            let mut moment = *moment;
            if moment.orientation.dot(before) < 0.0 {
                moment.orientation = -moment.orientation;
            }
            before = moment.orientation;
            moment
        })
        .collect()
}

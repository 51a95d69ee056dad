//! Power of a test with a number of random cases.
//!
//! A test that counts among `n` random cases states its null, and an alternative that it rejects
//! with 99 %. A property that held in all of `n` cases bounds the fraction of cases in which it
//! fails.

/// Upper bound, with 95 % confidence, on the fraction of failing cases after `cases` without one:
/// the p of `(1 - p)^cases = 0.05`, some 3/`cases` (the rule of three).
///
/// It is about the distribution that was drawn from, and says nothing beyond it.
pub(crate) fn failing_at_most(cases: u32) -> f64 {
    -f64::exp_m1(f64::ln(0.05) / f64::from(cases))
}

/// A test of a fraction by a count among `cases` independent cases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FractionTest {
    pub(crate) cases: u32,
    /// The fraction that is claimed.
    pub(crate) null: f64,
    /// Counts from the first to the second are accepted.
    pub(crate) accepted: [u32; 2],
}

impl FractionTest {
    /// Accepts the counts of which the null has fewer, or more, with at least `level`/2.
    pub(crate) fn at_level(level: f64, cases: u32, null: f64) -> Self {
        let terms = binomial(cases, null);
        let count_until = |terms: &mut dyn Iterator<Item = &f64>| {
            let mut tail = 0.0;
            let beyond = terms.take_while(|&&term| {
                tail += term;
                tail < 0.5 * level
            });
            u32::try_from(beyond.count()).unwrap()
        };
        let low = count_until(&mut terms.iter());
        let high = cases - count_until(&mut terms.iter().rev());
        Self {
            cases,
            null,
            accepted: [low, high],
        }
    }

    /// Returns true if a count agrees with the null hypothesis.
    pub(crate) fn accepts(&self, count: u32) -> bool {
        (self.accepted[0]..=self.accepted[1]).contains(&count)
    }

    /// Probability that a fraction is rejected.
    pub(crate) fn power(&self, fraction: f64) -> f64 {
        let terms = binomial(self.cases, fraction);
        let [low, high] = self.accepted.map(|count| count as usize);
        1.0 - terms[low..=high].iter().sum::<f64>()
    }

    /// The fractions nearest to the null, below and above it, that are rejected with 99 %. `None`
    /// where no fraction is.
    pub(crate) fn rejected(&self) -> [Option<f64>; 2] {
        [0.0, 1.0].map(|end| {
            let (mut inside, mut outside) = (self.null, end);
            if self.power(outside) < 0.99 {
                return None;
            }
            for _ in 0..40 {
                let middle = 0.5 * (inside + outside);
                if self.power(middle) < 0.99 {
                    inside = middle;
                } else {
                    outside = middle;
                }
            }
            Some(outside)
        })
    }
}

/// Probabilities of 0 to `cases` successes: from the logarithm of the factorials, which is a sum.
fn binomial(cases: u32, fraction: f64) -> Vec<f64> {
    let mut log_factorial = vec![0.0];
    for k in 1..=cases {
        log_factorial.push(log_factorial[k as usize - 1] + f64::from(k).ln());
    }
    // 0 ln 0 = 0
    let times_log = |count: u32, x: f64| match count {
        0 => 0.0,
        _ => f64::from(count) * x.ln(),
    };
    (0..=cases)
        .map(|k| {
            let rest = cases - k;
            let ways = log_factorial[cases as usize]
                - log_factorial[k as usize]
                - log_factorial[rest as usize];
            (ways + times_log(k, fraction) + times_log(rest, 1.0 - fraction)).exp()
        })
        .collect()
}

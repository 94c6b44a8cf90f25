//! Who draws which realizations: every user has numbers of its own, so that nobody is judged by the fibers that it was made of.

/// Numbers of realizations that a user has.
pub const OF_USER: u64 = 1 << 48;
/// Numbers of all users together, for each attempt at laying fibers.
const OF_ATTEMPT: u64 = 1 << 56;

/// What a realization is drawn for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum DrawnFor {
    /// The medium: what a calculator counts, and the straight rays and first hits that belong to it.
    Medium,
    /// The fibers themselves, as `--model explicit` sends light through them.
    Fibers,
    /// The fibers that a finished measurement of a medium is held against.
    Judge,
    /// The pilots of a planner.
    Pilot,
    /// The fibers that charts, budgets and studies hold media against.
    Trial,
}

impl DrawnFor {
    /// All users.
    pub const ALL: [DrawnFor; 5] =
        [DrawnFor::Medium, DrawnFor::Fibers, DrawnFor::Judge, DrawnFor::Pilot, DrawnFor::Trial];

    /// The number of its draw `place`, of which there are [`OF_USER`], in its attempt at laying fibers: no two users and no two
    /// attempts share one.
    pub fn number(self, place: u64, attempt: u64) -> u64 {
        attempt * OF_ATTEMPT + self as u64 * OF_USER + place % OF_USER
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn no_two_users_and_attempts_share_a_number() {
        let places = [0, 1, 7, 1 << 32, OF_USER - 1];
        let mut seen = BTreeSet::new();
        for user in DrawnFor::ALL {
            for attempt in 0..3 {
                // Ranges do not touch: the first and the last number of each stand for all of it.
                assert_eq!(user.number(OF_USER - 1, attempt) - user.number(0, attempt), OF_USER - 1);
                assert!(places.iter().all(|&place| seen.insert(user.number(place, attempt))), "{user:?} {attempt}");
            }
        }
        assert_eq!(seen.len(), places.len() * 3 * DrawnFor::ALL.len());
    }
}

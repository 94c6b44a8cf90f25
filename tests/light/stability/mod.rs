//! Where methods fail: each regime is right against a value that comes from elsewhere, or refused with a clear error, and
//! beside it stands a weaker method that visibly fails there.
//!
//! There are at most 500 comparisons, each with seeds of its own. All of them stay within 4.55 standard errors: of right
//! programs one in 370 fails anywhere (Šidák), as a single comparison at 3 σ would. Weak methods fail at twice that at least.
//! `FIBERWALK_STABILITY=n` makes n times as many walks of each. `docs/stability.md` holds the table that the tests print.

mod brute;
mod cuts;
mod explicit;
mod light;
mod limits;
mod medium;
mod optics;
mod sheets;
mod table;
mod tables;

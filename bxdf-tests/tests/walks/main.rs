//! Random walks as ground truth for energy: what many bounces on a rough surface, or between a coat and its
//! base, add up to.
//!
//! The walks are written in `f64` and share no code with the lobes they judge: they have their own
//! distributions, visible normals, Fresnel terms and closed forms. `walk_facts` holds them to facts known from elsewhere,
//! `lobes`, `coats` and `higher_orders` hold our lobes to them.

#![expect(clippy::unwrap_used, clippy::panic, reason = "assertions for tests")]

mod closed_form;
mod coats;
mod fresnel;
mod higher_orders;
mod layered;
mod lobes;
mod smith;
mod statistics;
mod surface;
mod vector;
mod walk_facts;

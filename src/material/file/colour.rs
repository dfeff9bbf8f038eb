//! Colours as authors write them.

use serde::Serialize;

use crate::rgb::srgb_to_linear;

/// How a colour is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(super) enum ColourSpace {
    /// Linear, primaries of Rec. 709.
    LinRec709,
    /// The same with the transfer function of sRGB, channels in \[0, 1\].
    Srgb,
}

impl ColourSpace {
    pub(super) const ALL: [Self; 2] = [Self::LinRec709, Self::Srgb];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::LinRec709 => "lin_rec709",
            Self::Srgb => "srgb",
        }
    }

    pub(super) fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|space| space.name() == name)
    }

    /// The colour in linear Rec. 709.
    pub(super) fn linear(self, colour: [f64; 3]) -> [f64; 3] {
        match self {
            Self::LinRec709 => colour,
            Self::Srgb => colour.map(srgb_to_linear),
        }
    }
}

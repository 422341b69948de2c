//! Left and right.

use std::fmt;

/// A foot, and the leg above it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Foot {
    /// The left one.
    Left,
    /// The right one.
    Right,
}

impl Foot {
    /// Both, in the order of the joints.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// Its place in [`Foot::BOTH`].
    #[must_use]
    pub fn index(self) -> usize {
        match self {
            Self::Left => 0,
            Self::Right => 1,
        }
    }

    /// The other foot.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// Its side of the line: 1 on the left, -1 on the right.
    #[must_use]
    pub fn side(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

impl fmt::Display for Foot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Left => "left",
            Self::Right => "right",
        })
    }
}

//! The contact law that a flag chooses.
use clap::ValueEnum;
use dem::{
    Chen, ContactLaw, DemError, Material, PairProperties, Potential, Push, RigidBodies, Rolling, Touch,
};

/// The bodies of all these examples.
pub type Granulate = RigidBodies<Rolling<Law>>;

/// What flags call the laws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Ways {
    /// The law of Chen (2012), as in Isoz et al. (2023): for bodies with flat faces.
    Chen,
    /// The law that has a potential and gives back exactly what --restitution says: for round bodies.
    Potential,
}

/// One of two laws, chosen when the program runs.
#[derive(Clone, Copy, Debug)]
pub enum Law {
    /// [`Chen`].
    Chen(Chen),
    /// [`Potential`].
    Potential(Potential),
}

impl From<Ways> for Law {
    fn from(way: Ways) -> Self {
        match way {
            Ways::Chen => Self::Chen(Chen::default()),
            Ways::Potential => Self::Potential(Potential::default()),
        }
    }
}

impl ContactLaw for Law {
    /// What each of them keeps.
    type Memory = (<Chen as ContactLaw>::Memory, <Potential as ContactLaw>::Memory);
    const MOBILITY: bool = true;
    const PIVOTS: bool = true;

    fn properties(&self, a: &Material, b: &Material) -> PairProperties {
        match self {
            Self::Chen(law) => law.properties(a, b),
            Self::Potential(law) => law.properties(a, b),
        }
    }
    #[inline]
    fn push(&self, p: &PairProperties, touch: &Touch<'_>, memory: &mut Self::Memory) -> Push {
        match self {
            Self::Chen(law) => law.push(p, touch, &mut memory.0),
            Self::Potential(law) => law.push(p, touch, &mut memory.1),
        }
    }
    fn check(&self) -> Result<(), DemError> {
        match self {
            Self::Chen(law) => law.check(),
            Self::Potential(law) => law.check(),
        }
    }
}

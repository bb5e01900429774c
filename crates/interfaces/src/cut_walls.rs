//! How walls cut the cells of a staggered grid.
use crate::ThinPart;
use crate::Vector;

/// Walls that cut the control volumes of a staggered grid: what who knows the walls' shape tells who computes the flow.
///
/// Storage indices are those of the component's [`Lattice`](crate::Lattice).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CutWalls {
    /// What holds for each velocity component; empty beyond the space dimensions.
    pub components: [CutComponent; 3],
    /// How many bodies the walls belong to.
    pub n_bodies: usize,
    /// Parts of bodies that are too thin for the grid, so fluid leaks through them: one entry per body that has such parts.
    pub thin: Vec<ThinPart>,
}

/// The walls as one velocity component meets them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CutComponent {
    /// Nodes inside the solid.
    pub solid: Vec<SolidPoint>,
    /// Nodes in the fluid with a wall between them and a neighbour.
    pub links: Vec<CutNode>,
    /// Faces between two cells that are not wholly open.
    pub faces: Vec<CutFace>,
}

/// A velocity node inside the solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidPoint {
    /// Storage index of the node.
    pub index: usize,
    /// The component of the solid's velocity there \[m/s\].
    pub velocity: f64,
    /// Number of the body.
    pub body: usize,
    /// Place from the body's centre of mass \[m\].
    pub arm: Vector,
}

/// A velocity node in the fluid whose links to some neighbours a wall cuts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutNode {
    /// Storage index of the node.
    pub index: usize,
    /// Number of the nearest body.
    pub body: usize,
    /// Place from that body's centre of mass \[m\].
    pub arm: Vector,
    /// Per axis: the link to the neighbour below and above, where it is cut.
    pub links: [[Option<Link>; 2]; 3],
}

/// A link between two nodes that a wall cuts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Distance of the wall from the node in the fluid as a share of the link's length, in (0, 1].
    pub fraction: f64,
    /// The component of the wall's velocity there \[m/s\].
    pub velocity: f64,
}

/// A face between two cells of which a part is closed.
///
/// The mean of the normal velocity over the whole face (the solid's part moves with the solid) is
///
/// ```text
/// constant + Σ_t weight_t u[index_t]
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutFace {
    /// Storage index of the node of the face.
    pub index: usize,
    /// Share of the face that is open, in \[0, 1).
    pub open: f64,
    /// What the wall's velocity gives \[m/s\].
    pub constant: f64,
    /// Storage indices and weights of the velocities that give the rest.
    pub terms: [(usize, f64); 4],
}

impl CutFace {
    /// The mean normal velocity over the whole face, from the stored values of its component \[m/s\].
    #[inline]
    pub fn mean_velocity(&self, u: &[f64]) -> f64 {
        self.constant + self.terms.iter().map(|&(index, weight)| weight * u[index]).sum::<f64>()
    }
}

impl CutWalls {
    /// Are the cuts and the bodies they belong to the same, whatever the walls' velocity is?
    pub fn same_shape(&self, other: &Self) -> bool {
        let same = |a: &CutComponent, b: &CutComponent| {
            let links = |n: &CutNode| {
                (n.index, n.body, n.links.map(|side| side.map(|link| link.map(|l| l.fraction))))
            };
            let solid = |s: &SolidPoint| (s.index, s.body);
            a.solid.iter().map(solid).eq(b.solid.iter().map(solid))
                && a.links.iter().map(links).eq(b.links.iter().map(links))
                && a.faces.iter().map(|f| (f.index, f.open)).eq(b.faces.iter().map(|f| (f.index, f.open)))
        };
        self.n_bodies == other.n_bodies
            && self.components.iter().zip(&other.components).all(|(a, b)| same(a, b))
    }
}

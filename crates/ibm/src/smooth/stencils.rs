//! Where the markers of a body read and spread, and how they do it.
use crate::Kernel;
use interfaces::{Lattice, Nodes, Point, VelocityField};
use pulp::{Arch, Simd, WithSimd};

/// The stencils of a body's markers on the lattices of all velocity components: products of weights along the axes. Axes that
/// components share are worked on once.
#[derive(Clone, Debug, Default)]
pub(super) struct Stencils {
    width: usize,
    /// Which of `axes` is that of a component and axis.
    of: [[usize; 3]; 3],
    axes: Vec<AxisWeights>,
    /// (Share of the weights inside bounded sides)², per component and marker: by this a pass is relaxed further there, since
    /// the weights that are left, scaled up to sum to one, overlap more with themselves.
    pub(super) relax: [Vec<f64>; 3],
}

/// Weights along one axis.
#[derive(Clone, Debug, Default)]
struct AxisWeights {
    /// First node of each marker; those after it wrap around a periodic axis.
    first: Vec<usize>,
    /// As many as the kernel is wide, per marker.
    weights: Vec<f64>,
    /// Their sum before they were scaled to one; zero if the marker is as good as outside, and so are they.
    share: Vec<f64>,
}

/// A marker of whose weights less than this share lies inside the box is outside.
const LEAST_SHARE: f64 = 1e-3;

impl AxisWeights {
    fn set(&mut self, kernel: Kernel, nodes: &Nodes, places: impl Iterator<Item = f64>) {
        let Self { first, weights, share } = self;
        weights.clear();
        share.clear();
        first.clear();
        let (width, n) = (2 * kernel.reach(), nodes.len());
        for x in places {
            let (node, part) = nodes.locate(x);
            let (start, all) = (node - kernel.reach() as isize + 1, kernel.weights(part));
            if nodes.is_periodic() {
                first.push(start.rem_euclid(n as isize) as usize);
                weights.extend_from_slice(&all[..width]);
                share.push(1.0);
                continue;
            }
            // Beyond a bounded side there is nothing; the rest is scaled up to sum to one.
            let inside = start.clamp(0, n.saturating_sub(width) as isize);
            let kept = |i: usize| {
                let from = usize::try_from(inside + i as isize - start).ok().filter(|&from| from < width);
                from.filter(|_| inside as usize + i < n).map_or(0.0, |from| all[from])
            };
            let sum: f64 = (0..width).map(kept).sum();
            let scale = if sum < LEAST_SHARE { 0.0 } else { 1.0 / sum };
            first.push(inside as usize);
            weights.extend((0..width).map(|i| scale * kept(i)));
            share.push(scale * sum * sum);
        }
    }
}

impl Stencils {
    /// Of markers at these places.
    pub(super) fn set(&mut self, kernel: Kernel, velocity: &dyn VelocityField, places: &[Point]) {
        let dim = velocity.dim();
        self.width = 2 * kernel.reach();
        let mut count = 0;
        for a in 0..dim {
            for c in 0..dim {
                let nodes = &velocity.lattice(c).axes[a];
                let same = (0..c).find(|&other| velocity.lattice(other).axes[a] == *nodes);
                self.of[c][a] = same.map_or(count, |other| self.of[other][a]);
                if same.is_none() {
                    self.axes.resize_with(self.axes.len().max(count + 1), AxisWeights::default);
                    self.axes[count].set(kernel, nodes, places.iter().map(|x| x[a]));
                    count += 1;
                }
            }
        }
        for (c, relax) in self.relax.iter_mut().enumerate().take(dim) {
            let shares =
                |m: usize| self.of[c][..dim].iter().map(|&at| self.axes[at].share[m]).product::<f64>();
            relax.clear();
            relax.extend((0..places.len()).map(|m| shares(m).powi(2)));
        }
    }

    /// What the markers read of component `c`.
    pub(super) fn read(&self, c: usize, lattice: &Lattice, u: &[f64], out: &mut Vec<f64>) {
        out.clear();
        out.resize(self.relax[c].len(), 0.0);
        match (self.width, lattice.dim) {
            (4, 2) => Arch::new().dispatch(Read { places: self.places::<4, 2>(c, lattice), u, out }),
            (4, _) => Arch::new().dispatch(Read { places: self.places::<4, 3>(c, lattice), u, out }),
            (_, 2) => Arch::new().dispatch(Read { places: self.places::<6, 2>(c, lattice), u, out }),
            _ => Arch::new().dispatch(Read { places: self.places::<6, 3>(c, lattice), u, out }),
        }
    }

    /// Adds these values to component `c`, each times the weights.
    pub(super) fn spread(&self, c: usize, lattice: &Lattice, values: &[f64], u: &mut [f64]) {
        match (self.width, lattice.dim) {
            (4, 2) => Arch::new().dispatch(Spread { places: self.places::<4, 2>(c, lattice), values, u }),
            (4, _) => Arch::new().dispatch(Spread { places: self.places::<4, 3>(c, lattice), values, u }),
            (_, 2) => Arch::new().dispatch(Spread { places: self.places::<6, 2>(c, lattice), values, u }),
            _ => Arch::new().dispatch(Spread { places: self.places::<6, 3>(c, lattice), values, u }),
        }
    }

    fn places<'a, const W: usize, const D: usize>(
        &'a self,
        c: usize,
        lattice: &'a Lattice,
    ) -> Places<'a, W, D> {
        let axes: [&AxisWeights; D] = std::array::from_fn(|a| &self.axes[self.of[c][a]]);
        Places {
            lattice,
            first: axes.map(|axis| axis.first.as_slice()),
            weights: axes.map(|axis| axis.weights.as_chunks().0),
            len: std::array::from_fn(|a| lattice.axes[a].len()),
        }
    }
}

/// Stencils of `W` nodes along each of `D` axes.
struct Places<'a, const W: usize, const D: usize> {
    lattice: &'a Lattice,
    first: [&'a [usize]; D],
    weights: [&'a [[f64; W]]; D],
    len: [usize; D],
}

impl<const W: usize, const D: usize> Places<'_, W, D> {
    /// Where the nodes of marker `m` along axis `a` are stored.
    #[inline(always)]
    fn offsets(&self, a: usize, m: usize) -> [usize; W] {
        let (first, n) = (self.first[a][m], self.len[a]);
        std::array::from_fn(|i| {
            let mut at = first + i;
            if at >= n {
                // Of a bounded axis with less nodes than the kernel is wide the weight is zero.
                at %= n;
            }
            at * self.lattice.stride[a]
        })
    }

    /// Calls `f` with the place and weight of every row of marker `m`.
    #[inline(always)]
    fn rows(&self, m: usize, mut f: impl FnMut(usize, f64)) {
        let (along_y, y) = (self.offsets(1, m), &self.weights[1][m]);
        if D == 2 {
            for j in 0..W {
                f(self.lattice.base + along_y[j], y[j]);
            }
            return;
        }
        let (along_z, z) = (self.offsets(D - 1, m), &self.weights[D - 1][m]);
        for k in 0..W {
            for j in 0..W {
                f(self.lattice.base + along_z[k] + along_y[j], z[k] * y[j]);
            }
        }
    }

    /// The first node of rows without a gap.
    #[inline(always)]
    fn start(&self, m: usize) -> Option<usize> {
        let first = self.first[0][m];
        (self.lattice.stride[0] == 1 && first + W <= self.len[0]).then_some(first)
    }
}

// Types rather than closures: `pulp` compiles the body of `with_simd` for the processor at hand.
struct Read<'a, const W: usize, const D: usize> {
    places: Places<'a, W, D>,
    u: &'a [f64],
    out: &'a mut [f64],
}

impl<const W: usize, const D: usize> WithSimd for Read<'_, W, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { places, u, out } = self;
        for (m, out) in out.iter_mut().enumerate() {
            let mut sums = [0.0; W];
            if let Some(start) = places.start(m) {
                places.rows(m, |row, w| {
                    let u = &u[row + start..][..W];
                    for i in 0..W {
                        sums[i] += w * u[i];
                    }
                });
            } else {
                let along_x = places.offsets(0, m);
                places.rows(m, |row, w| {
                    for i in 0..W {
                        sums[i] += w * u[row + along_x[i]];
                    }
                });
            }
            *out = sums.iter().zip(&places.weights[0][m]).map(|(sum, w)| sum * w).sum();
        }
    }
}

struct Spread<'a, const W: usize, const D: usize> {
    places: Places<'a, W, D>,
    values: &'a [f64],
    u: &'a mut [f64],
}

impl<const W: usize, const D: usize> WithSimd for Spread<'_, W, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { places, values, u } = self;
        for (m, value) in values.iter().enumerate() {
            let x = places.weights[0][m].map(|w| value * w);
            if let Some(start) = places.start(m) {
                places.rows(m, |row, w| {
                    let u = &mut u[row + start..][..W];
                    for i in 0..W {
                        u[i] += w * x[i];
                    }
                });
            } else {
                let along_x = places.offsets(0, m);
                places.rows(m, |row, w| {
                    for i in 0..W {
                        u[row + along_x[i]] += w * x[i];
                    }
                });
            }
        }
    }
}

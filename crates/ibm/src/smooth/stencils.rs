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

/// Markers whose weights are computed together.
const LANES: usize = 8;

impl AxisWeights {
    fn set(&mut self, kernel: Kernel, nodes: &Nodes, places: &[Point], axis: usize) {
        let width = kernel.width();
        self.first.resize(places.len(), 0);
        self.weights.resize(places.len() * width, 0.0);
        self.share.clear();
        self.share.resize(places.len(), 1.0);
        match width {
            4 => Arch::new().dispatch(Weigh::<4> { axis, kernel, nodes, places, out: self }),
            5 => Arch::new().dispatch(Weigh::<5> { axis, kernel, nodes, places, out: self }),
            _ => Arch::new().dispatch(Weigh::<6> { axis, kernel, nodes, places, out: self }),
        }
    }
}

struct Weigh<'a, const W: usize> {
    axis: usize,
    kernel: Kernel,
    nodes: &'a Nodes,
    places: &'a [Point],
    out: &'a mut AxisWeights,
}

impl<const W: usize> WithSimd for Weigh<'_, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { axis, kernel, nodes, places, out } = self;
        let AxisWeights { first, weights, share } = out;
        let (periodic, n) = (nodes.is_periodic(), nodes.len() as isize);
        let weights = weights.as_chunks_mut::<W>().0;
        let all = places.chunks(LANES).zip(first.chunks_mut(LANES));
        for ((places, first), (weights, share)) in
            all.zip(weights.chunks_mut(LANES).zip(share.chunks_mut(LANES)))
        {
            let (mut start, mut parts) = ([0; LANES], [0.0; LANES]);
            for (p, x) in places.iter().enumerate() {
                let (mut node, mut part) = nodes.locate(x[axis]);
                // A kernel of odd width stands about the nearest node.
                if W % 2 == 1 && part >= 0.5 {
                    (node, part) = (node + 1, part - 1.0);
                }
                (start[p], parts[p]) = (node - (W as isize - 1) / 2, part);
            }
            let found = kernel.weights_of(parts);
            for p in 0..places.len() {
                let all: [f64; W] = std::array::from_fn(|i| found[i][p]);
                if (0..=n - W as isize).contains(&start[p]) {
                    (first[p], weights[p]) = (start[p] as usize, all);
                } else if periodic {
                    (first[p], weights[p]) = (start[p].rem_euclid(n) as usize, all);
                } else {
                    (first[p], weights[p], share[p]) = cut_off(start[p], all, n as usize);
                }
            }
        }
    }
}

/// First node, weights and their share of a stencil that a bounded side cuts off: beyond it there is nothing, and the rest is
/// scaled up to sum to one.
#[cold]
fn cut_off<const W: usize>(start: isize, all: [f64; W], n: usize) -> (usize, [f64; W], f64) {
    let inside = start.clamp(0, n.saturating_sub(W) as isize);
    let kept: [f64; W] = std::array::from_fn(|i| {
        let from = usize::try_from(inside + i as isize - start).ok().filter(|&from| from < W);
        from.filter(|_| inside as usize + i < n).map_or(0.0, |from| all[from])
    });
    let sum: f64 = kept.iter().sum();
    if sum < LEAST_SHARE {
        return (inside as usize, [0.0; W], 0.0);
    }
    (inside as usize, kept.map(|w| w / sum), sum)
}

impl Stencils {
    /// Of markers at these places.
    pub(super) fn set(&mut self, kernel: Kernel, velocity: &dyn VelocityField, places: &[Point]) {
        let dim = velocity.dim();
        self.width = kernel.width();
        let mut count = 0;
        for a in 0..dim {
            for c in 0..dim {
                let nodes = &velocity.lattice(c).axes[a];
                let same = (0..c).find(|&other| velocity.lattice(other).axes[a] == *nodes);
                self.of[c][a] = same.map_or(count, |other| self.of[other][a]);
                if same.is_none() {
                    self.axes.resize_with(self.axes.len().max(count + 1), AxisWeights::default);
                    self.axes[count].set(kernel, nodes, places, a);
                    count += 1;
                }
            }
        }
        self.reset_relaxation(dim);
    }

    /// Sets the relaxation that bounded sides need alone.
    pub(super) fn reset_relaxation(&mut self, dim: usize) {
        for (c, relax) in self.relax.iter_mut().enumerate().take(dim) {
            relax.clear();
            relax.resize(self.axes[self.of[c][0]].share.len(), 1.0);
            for &at in &self.of[c][..dim] {
                relax.iter_mut().zip(&self.axes[at].share).for_each(|(relax, share)| *relax *= share * share);
            }
        }
    }

    /// What the markers read of component `c`.
    pub(super) fn read(&self, c: usize, lattice: &Lattice, u: &[f64], out: &mut Vec<f64>) {
        out.clear();
        out.resize(self.relax[c].len(), 0.0);
        match (self.width, lattice.dim) {
            (4, 2) => Arch::new().dispatch(Read { places: self.places::<4, 2>(c, lattice), u, out }),
            (4, _) => Arch::new().dispatch(Read { places: self.places::<4, 3>(c, lattice), u, out }),
            (5, 2) => Arch::new().dispatch(Read { places: self.places::<5, 2>(c, lattice), u, out }),
            (5, _) => Arch::new().dispatch(Read { places: self.places::<5, 3>(c, lattice), u, out }),
            (_, 2) => Arch::new().dispatch(Read { places: self.places::<6, 2>(c, lattice), u, out }),
            _ => Arch::new().dispatch(Read { places: self.places::<6, 3>(c, lattice), u, out }),
        }
    }

    /// Adds these values to component `c`, each times the weights.
    pub(super) fn spread(&self, c: usize, lattice: &Lattice, values: &[f64], u: &mut [f64]) {
        match (self.width, lattice.dim) {
            (4, 2) => Arch::new().dispatch(Spread { places: self.places::<4, 2>(c, lattice), values, u }),
            (4, _) => Arch::new().dispatch(Spread { places: self.places::<4, 3>(c, lattice), values, u }),
            (5, 2) => Arch::new().dispatch(Spread { places: self.places::<5, 2>(c, lattice), values, u }),
            (5, _) => Arch::new().dispatch(Spread { places: self.places::<5, 3>(c, lattice), values, u }),
            (_, 2) => Arch::new().dispatch(Spread { places: self.places::<6, 2>(c, lattice), values, u }),
            _ => Arch::new().dispatch(Spread { places: self.places::<6, 3>(c, lattice), values, u }),
        }
    }

    /// Divides what passes change at every marker by a number of its own.
    pub(super) fn relax_by(&mut self, overlaps: &[f64]) {
        for relax in &mut self.relax {
            relax.iter_mut().zip(overlaps).for_each(|(relax, overlap)| *relax /= overlap);
        }
    }

    /// Zeroes component `c` of `u` at the nodes of all markers.
    pub(super) fn clear(&self, c: usize, lattice: &Lattice, u: &mut [f64]) {
        match (self.width, lattice.dim) {
            (4, 2) => self.places::<4, 2>(c, lattice).clear(u),
            (4, _) => self.places::<4, 3>(c, lattice).clear(u),
            (5, 2) => self.places::<5, 2>(c, lattice).clear(u),
            (5, _) => self.places::<5, 3>(c, lattice).clear(u),
            (_, 2) => self.places::<6, 2>(c, lattice).clear(u),
            _ => self.places::<6, 3>(c, lattice).clear(u),
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
        // Of a bounded axis with less nodes than the kernel is wide the weights past the end are zero.
        std::array::from_fn(|i| (first + i) % n * self.lattice.stride[a])
    }

    /// Calls `f` with the places and weight of every row of marker `m`, wherever its nodes are.
    #[cold]
    fn rows(&self, m: usize, mut f: impl FnMut([usize; W], f64)) {
        // A component between walls one cell apart has no nodes.
        if self.len.contains(&0) {
            return;
        }
        let (x, y) = (self.offsets(0, m), self.offsets(1, m));
        let layer =
            |k: usize| if D == 2 { (0, 1.0) } else { (self.offsets(D - 1, m)[k], self.weights[D - 1][m][k]) };
        for (along_z, z) in (0..if D == 2 { 1 } else { W }).map(layer) {
            for (along_y, y) in y.iter().zip(&self.weights[1][m]) {
                f(x.map(|along_x| self.lattice.base + along_x + along_y + along_z), y * z);
            }
        }
    }

    /// Zeroes the nodes of all markers.
    fn clear(&self, u: &mut [f64]) {
        for m in 0..self.first[0].len() {
            self.rows(m, |row, _| row.into_iter().for_each(|node| u[node] = 0.0));
        }
    }

    /// Where the first node of marker `m` is stored, if the others follow without a gap.
    #[inline(always)]
    fn corner(&self, m: usize) -> Option<usize> {
        let stride = &self.lattice.stride;
        let (mut corner, mut whole) = (self.lattice.base, stride[0] == 1);
        for a in 0..D {
            corner += self.first[a][m] * stride[a];
            whole &= self.first[a][m] + W <= self.len[a];
        }
        whole.then_some(corner)
    }

    /// Distances of rows along y and of layers, and how many there are of these.
    #[inline(always)]
    fn layers(&self) -> [usize; 3] {
        let [_, y, z] = self.lattice.stride;
        [y, z, if D == 2 { 1 } else { W }]
    }
}

// Types rather than closures: `pulp` compiles the body of `with_simd` for the processor at hand. Left to itself the compiler takes
// numbers one by one.
struct Read<'a, const W: usize, const D: usize> {
    places: Places<'a, W, D>,
    u: &'a [f64],
    out: &'a mut [f64],
}

impl<const W: usize, const D: usize> WithSimd for Read<'_, W, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match W / S::F64_LANES {
            1 => self.run::<S, 1>(simd),
            2 => self.run::<S, 2>(simd),
            3 => self.run::<S, 3>(simd),
            _ => self.run::<S, 0>(simd),
        }
    }
}

impl<const W: usize, const D: usize> Read<'_, W, D> {
    /// With `N` vectors per row; the rest of it number by number.
    #[inline(always)]
    fn run<S: Simd, const N: usize>(self, simd: S) {
        let Self { places, u, out } = self;
        let [along_y, along_z, layers] = places.layers();
        let head = N * S::F64_LANES;
        for (m, out) in out.iter_mut().enumerate() {
            let x = &places.weights[0][m];
            let Some(corner) = places.corner(m) else {
                *out = 0.0;
                places.rows(m, |row, w| *out += w * (0..W).map(|i| x[i] * u[row[i]]).sum::<f64>());
                continue;
            };
            let (mut sums, mut rest) = ([simd.splat_f64s(0.0); N], [0.0; W]);
            for k in 0..layers {
                let (mut layer, mut layer_rest) = ([simd.splat_f64s(0.0); N], [0.0; W]);
                for (j, y) in places.weights[1][m].iter().enumerate() {
                    let row = &u[corner + k * along_z + j * along_y..][..W];
                    let (vectors, weight) = (S::as_simd_f64s(&row[..head]).0, simd.splat_f64s(*y));
                    for n in 0..N {
                        layer[n] = simd.mul_add_e_f64s(weight, vectors[n], layer[n]);
                    }
                    for i in head..W {
                        layer_rest[i] += y * row[i];
                    }
                }
                let z = if D == 2 { 1.0 } else { places.weights[D - 1][m][k] };
                let weight = simd.splat_f64s(z);
                for n in 0..N {
                    sums[n] = simd.mul_add_e_f64s(weight, layer[n], sums[n]);
                }
                for i in head..W {
                    rest[i] += z * layer_rest[i];
                }
            }
            let (vectors, mut sum) = (S::as_simd_f64s(&x[..head]).0, simd.splat_f64s(0.0));
            for n in 0..N {
                sum = simd.mul_add_e_f64s(vectors[n], sums[n], sum);
            }
            *out = simd.reduce_sum_f64s(sum) + (head..W).map(|i| x[i] * rest[i]).sum::<f64>();
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
    fn with_simd<S: Simd>(self, simd: S) {
        match W / S::F64_LANES {
            1 => self.run::<S, 1>(simd),
            2 => self.run::<S, 2>(simd),
            3 => self.run::<S, 3>(simd),
            _ => self.run::<S, 0>(simd),
        }
    }
}

impl<const W: usize, const D: usize> Spread<'_, W, D> {
    /// As in [`Read::run`].
    #[inline(always)]
    fn run<S: Simd, const N: usize>(self, simd: S) {
        let Self { places, values, u } = self;
        let [along_y, along_z, layers] = places.layers();
        let head = N * S::F64_LANES;
        for (m, value) in values.iter().enumerate() {
            let x = places.weights[0][m].map(|w| value * w);
            let Some(corner) = places.corner(m) else {
                places.rows(m, |row, w| (0..W).for_each(|i| u[row[i]] += w * x[i]));
                continue;
            };
            let vectors: [S::f64s; N] = std::array::from_fn(|n| S::as_simd_f64s(&x[..head]).0[n]);
            for k in 0..layers {
                let z = if D == 2 { 1.0 } else { places.weights[D - 1][m][k] };
                for (j, y) in places.weights[1][m].iter().enumerate() {
                    let w = y * z;
                    let row = &mut u[corner + k * along_z + j * along_y..][..W];
                    for i in head..W {
                        row[i] += w * x[i];
                    }
                    let (row, weight) = (S::as_mut_simd_f64s(&mut row[..head]).0, simd.splat_f64s(w));
                    for n in 0..N {
                        row[n] = simd.mul_add_e_f64s(weight, vectors[n], row[n]);
                    }
                }
            }
        }
    }
}

//! Coefficients and right-hand side, row by row.
use crate::field::row_start;
use crate::grid::GHOSTS;
use crate::kernels::row_place;
use crate::linear::StencilMatrix;
use crate::metrics::{Metrics, NodeMetrics};
use crate::parts::worth_threads;
use crate::spans::Spans;
use crate::{CartesianGrid, Field};
use pulp::{Arch, Simd, WithSimd};

/// Rows that one task works on.
const ROWS: usize = 16;

/// Convection in the matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Implicit {
    /// First order.
    Upwind,
    /// Second order; the rows need not be diagonally dominant.
    Central,
    /// Central as far as no coefficient changes its sign, else upwind without viscous terms (Spalding 1972).
    Hybrid,
}

const UPWIND: u8 = 0;
const CENTRAL: u8 = 1;
const HYBRID: u8 = 2;

/// What the equation of one velocity component is made of. With the velocity u at hand it reads
///
/// ```text
/// A δ = H(u) − ∂p/∂x_c /ρ + f − (w₀ u + w₁ u₁ + w₂ u₂)
/// ```
///
/// for the change δ of the component. The diagonal of A gains (1/α − 1)(Σ |u_n| A/2 + s ν Σ A/d)/V over the faces of the control
/// volume, α the relaxation factor and s the viscous share. A holds w₀, viscosity and convection as `implicit` says. Whatever A leaves out is in
/// H, so that the flow for which δ vanishes has the order of H.
#[derive(Clone, Copy)]
pub(crate) struct Terms<'a, const D: usize> {
    pub(crate) velocity: &'a [Field<D>; D],
    /// H.
    pub(crate) tendency: &'a Field<D>,
    pub(crate) pressure: &'a Field<D>,
    /// u₁ and u₂.
    pub(crate) history: [&'a Field<D>; 2],
    /// w₀, w₁ and w₂ \[1/s\].
    pub(crate) weights: [f64; 3],
    /// 1/ρ \[m³/kg\].
    pub(crate) specific_volume: f64,
    /// Body force per mass \[m/s²\].
    pub(crate) force: f64,
    /// 1/(relaxation factor).
    pub(crate) relaxation: f64,
    /// Part of the viscous terms that relaxation counts.
    pub(crate) viscous_share: f64,
    /// Kinematic viscosity \[m²/s\].
    pub(crate) viscosity: f64,
    /// Kinematic eddy viscosity at the cell centres \[m²/s\].
    pub(crate) eddy: Option<&'a Field<D>>,
    pub(crate) implicit: Implicit,
}

/// Fills the matrix and right-hand side of component `c`. `sums` (two per row) receive Σ (|H| + |∂p/∂x_c|/ρ + |f|) V and
/// Σ A_PP |u| V. Nodes on bounded sides get δ = 0; coefficients that reach beyond them are left for
/// [`fold_ends`](super::fold_ends).
pub(crate) fn assemble<const D: usize>(
    (grid, metrics, spans): (&CartesianGrid<D>, &Metrics<D>, &Spans),
    c: usize,
    terms: Terms<D>,
    matrix: &mut StencilMatrix<D>,
    rhs: &mut [f64],
    sums: &mut [[f64; 2]],
) {
    let (centre, lower, upper) = matrix.parts_mut();
    let part = Part { first: 0, centre, lower, upper, rhs, sums };
    let job = Job { grid, metrics, spans, terms };
    match (terms.implicit, terms.eddy.is_some()) {
        (Implicit::Upwind, false) => of_component::<D, UPWIND, false>(c, job, part),
        (Implicit::Upwind, true) => of_component::<D, UPWIND, true>(c, job, part),
        (Implicit::Central, false) => of_component::<D, CENTRAL, false>(c, job, part),
        (Implicit::Central, true) => of_component::<D, CENTRAL, true>(c, job, part),
        (Implicit::Hybrid, false) => of_component::<D, HYBRID, false>(c, job, part),
        (Implicit::Hybrid, true) => of_component::<D, HYBRID, true>(c, job, part),
    }
}

fn of_component<const D: usize, const KIND: u8, const EDDY: bool>(c: usize, job: Job<D>, part: Part<D>) {
    match c {
        0 => divide(job, part, run::<D, 0, KIND, EDDY>),
        1 => divide(job, part, run::<D, 1, KIND, EDDY>),
        _ => divide(job, part, run::<D, 2, KIND, EDDY>),
    }
}

#[derive(Clone, Copy)]
struct Job<'a, const D: usize> {
    grid: &'a CartesianGrid<D>,
    metrics: &'a Metrics<D>,
    spans: &'a Spans,
    terms: Terms<'a, D>,
}

/// Some rows of the equations.
struct Part<'a, const D: usize> {
    /// Number of the first one.
    first: usize,
    centre: &'a mut [f64],
    lower: [&'a mut [f64]; D],
    upper: [&'a mut [f64]; D],
    rhs: &'a mut [f64],
    sums: &'a mut [[f64; 2]],
}

/// The parts of each list before and from entry `at`.
fn halves<const D: usize>(lists: [&mut [f64]; D], at: usize) -> [[&mut [f64]; D]; 2] {
    let mut high: [&mut [f64]; D] = std::array::from_fn(|_| Default::default());
    let mut ends = high.iter_mut();
    let low = lists.map(|list| {
        let (low, end) = list.split_at_mut(at);
        if let Some(slot) = ends.next() {
            *slot = end;
        }
        low
    });
    [low, high]
}

impl<'a, const D: usize> Part<'a, D> {
    fn split(self, rows: usize, n: usize) -> (Self, Self) {
        let (centre, c) = self.centre.split_at_mut(rows * n);
        let (rhs, r) = self.rhs.split_at_mut(rows * n);
        let (sums, s) = self.sums.split_at_mut(rows);
        let [lower, l] = halves(self.lower, rows * n);
        let [upper, u] = halves(self.upper, rows * n);
        let rest = Part { first: self.first + rows, centre: c, lower: l, upper: u, rhs: r, sums: s };
        (Part { first: self.first, centre, lower, upper, rhs, sums }, rest)
    }
}

/// Calls `run` for parts of at most [`ROWS`] rows, or for all where threads are not worth it.
fn divide<const D: usize>(job: Job<D>, part: Part<D>, run: fn(Job<D>, Part<D>)) {
    if worth_threads(part.rhs.len()) { split(job, part, run) } else { run(job, part) }
}

/// Calls `run` for parts of at most [`ROWS`] rows.
fn split<const D: usize>(job: Job<D>, part: Part<D>, run: fn(Job<D>, Part<D>)) {
    let rows = part.sums.len();
    if rows <= ROWS {
        return run(job, part);
    }
    let (low, high) = part.split(rows / 2, job.grid.cells()[0]);
    rayon::join(|| split(job, low, run), || split(job, high, run));
}

fn run<const D: usize, const C: usize, const KIND: u8, const EDDY: bool>(job: Job<D>, part: Part<D>) {
    Arch::new().dispatch(Rows::<D, C, KIND, EDDY> { job, part });
}

struct Rows<'a, const D: usize, const C: usize, const KIND: u8, const EDDY: bool> {
    job: Job<'a, D>,
    part: Part<'a, D>,
}

impl<const D: usize, const C: usize, const KIND: u8, const EDDY: bool> WithSimd
    for Rows<'_, D, C, KIND, EDDY>
{
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { job, mut part } = self;
        let n = job.grid.cells()[0];
        for k in 0..part.sums.len() {
            let span = job.spans.of(part.first + k, n);
            let here = k * n + span.start..k * n + span.end;
            let row = Row {
                centre: &mut part.centre[here.clone()],
                lower: part.lower.each_mut().map(|l| &mut l[here.clone()]),
                upper: part.upper.each_mut().map(|u| &mut u[here.clone()]),
                rhs: &mut part.rhs[here.clone()],
            };
            part.sums[k] =
                assemble_row::<D, C, KIND, EDDY>(&job, part.first + k, [span.start, span.len()], row);
        }
    }
}

struct Row<'a, const D: usize> {
    centre: &'a mut [f64],
    lower: [&'a mut [f64]; D],
    upper: [&'a mut [f64]; D],
    rhs: &'a mut [f64],
}

// Unlike f64::max these are one instruction: no NaN gets here.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
#[inline(always)]
fn positive(a: f64) -> f64 {
    larger(a, 0.0)
}

/// A list of numbers along x, or the one number that holds for the whole row.
macro_rules! along {
    ($b:expr, $i:expr, $list:expr, $value:expr) => {
        if $b == 0 { $list[$i] } else { $value }
    };
}

#[inline(always)]
fn assemble_row<const D: usize, const C: usize, const KIND: u8, const EDDY: bool>(
    job: &Job<D>,
    r: usize,
    [from, n]: [usize; 2],
    row: Row<D>,
) -> [f64; 2] {
    let Job { grid, metrics, terms, .. } = job;
    if n == 0 {
        return [0.0; 2];
    }
    let Row { centre, mut lower, mut upper, rhs } = row;
    let (o, mut at, s) = (row_start(grid, r) + from, row_place(grid, r), grid.stride());
    at[0] = from;
    let (centre, rhs) = (&mut centre[..n], &mut rhs[..n]);
    let bounded = !metrics.periodic[C];
    if C > 0 && bounded && at[C] == 0 {
        centre.fill(1.0);
        rhs.fill(0.0);
        lower.iter_mut().chain(upper.iter_mut()).for_each(|list| list.fill(0.0));
        return [0.0; 2];
    }
    let nodes: [&NodeMetrics; D] = std::array::from_fn(|b| metrics.of(Some(C), b));
    let first: [usize; D] = std::array::from_fn(|b| GHOSTS + at[b]);
    // Along x from the first cell on.
    let along_x = GHOSTS + from;
    let share = if C == 0 {
        [&metrics.axes[C].share[0][along_x..], &metrics.axes[C].share[1][along_x..]]
    } else {
        [&[][..]; 2]
    };
    let share_c = [metrics.axes[C].share[0][first[C]], metrics.axes[C].share[1][first[C]]];
    let here = &terms.velocity[C].data()[o..][..n];

    centre.fill(0.0);
    // Rates at which the flow passes by; the right-hand side comes later.
    let rates = &mut rhs[..n];
    rates.fill(0.0);
    let viscous_share = terms.viscous_share;
    for b in 0..D {
        let (low, up) = (&mut lower[b][..n], &mut upper[b][..n]);
        let u = terms.velocity[b].data();
        // The speeds on the lower and upper edge are sums of two, weighted by their shares.
        let below = [&u[o - s[C]..][..n], &u[o..][..n]];
        let above = if b == C {
            [&u[o..][..n], &u[o + s[b]..][..n]]
        } else {
            [&u[o + s[b] - s[C]..][..n], &u[o + s[b]..][..n]]
        };
        let x = if b == 0 { along_x } else { GHOSTS };
        let inv = &nodes[b].inv_volume[x..];
        let (d_up, d_down) = (&nodes[b].up[x..], &nodes[b].down[x..]);
        let (inv_b, up_b, down_b) =
            (nodes[b].inv_volume[first[b]], nodes[b].up[first[b]], nodes[b].down[first[b]]);
        let eddy: [&[f64]; 6] = match terms.eddy.filter(|_| EDDY).map(Field::data) {
            Some(t) if b == C => [&t[o..][..n], &t[o - s[C]..][..n], &[], &[], &[], &[]],
            Some(t) => [
                &t[o..][..n],
                &t[o - s[C]..][..n],
                &t[o + s[b]..][..n],
                &t[o + s[b] - s[C]..][..n],
                &t[o - s[b]..][..n],
                &t[o - s[b] - s[C]..][..n],
            ],
            None => [&[]; 6],
        };
        let nu = terms.viscosity;
        let inv_0 = if b == 0 { &inv[..n] } else { &[] };
        let (up_0, down_0) = if b == 0 { (&d_up[..n], &d_down[..n]) } else { (&[][..], &[][..]) };
        let (share_0, share_1) = if C == 0 { (&share[0][..n], &share[1][..n]) } else { (&[][..], &[][..]) };
        for i in 0..n {
            let (w0, w1) = if b == C {
                (0.5, 0.5)
            } else {
                (along!(C, i, share_0, share_c[0]), along!(C, i, share_1, share_c[1]))
            };
            let inv = along!(b, i, inv_0, inv_b);
            let (carry_up, carry_down) =
                (inv * (w0 * above[0][i] + w1 * above[1][i]), inv * (w0 * below[0][i] + w1 * below[1][i]));
            let (nu_up, nu_down) = if !EDDY {
                (nu, nu)
            } else if b == C {
                (nu + 2.0 * eddy[0][i], nu + 2.0 * eddy[1][i])
            } else {
                let mid = eddy[0][i] + eddy[1][i];
                (nu + 0.25 * (mid + eddy[2][i] + eddy[3][i]), nu + 0.25 * (mid + eddy[4][i] + eddy[5][i]))
            };
            let (to_low, to_up) = (nu_down * along!(b, i, down_0, down_b), nu_up * along!(b, i, up_0, up_b));
            let (l, u) = match KIND {
                UPWIND => (to_low + positive(carry_down), to_up + positive(-carry_up)),
                CENTRAL => (to_low + 0.5 * carry_down, to_up - 0.5 * carry_up),
                _ => (
                    larger(to_low + 0.5 * carry_down, positive(carry_down)),
                    larger(to_up - 0.5 * carry_up, positive(-carry_up)),
                ),
            };
            low[i] = -l;
            up[i] = -u;
            centre[i] += l + u;
            rates[i] += viscous_share * (to_low + to_up) + 0.5 * (carry_down.abs() + carry_up.abs());
        }
    }

    let p = terms.pressure.data();
    let (p_up, p_down) = (&p[o..][..n], &p[o - s[C]..][..n]);
    let h = &terms.tendency.data()[o..][..n];
    let [u1, u2] = terms.history.map(|u| &u.data()[o..][..n]);
    let gap = if C == 0 { &nodes[0].inv_volume[along_x..][..n] } else { &[][..] };
    let gap_c = nodes[C].inv_volume[first[C]];
    let volume = &nodes[0].volume[along_x..][..n];
    let ([w0, w1, w2], relaxation) = (terms.weights, terms.relaxation);
    let (force, size) = (terms.force, terms.force.abs());
    let mut sums = [[0.0; 4]; 2];
    for i in 0..n {
        let slope = terms.specific_volume * along!(C, i, gap, gap_c) * (p_up[i] - p_down[i]);
        let rate = rhs[i];
        rhs[i] = h[i] - slope + force - (w0 * here[i] + w1 * u1[i] + w2 * u2[i]);
        let diagonal = centre[i] + w0 + (relaxation - 1.0) * rate;
        centre[i] = diagonal;
        // Four sums side by side run faster.
        sums[0][i % 4] += volume[i] * (h[i].abs() + slope.abs() + size);
        sums[1][i % 4] += volume[i] * diagonal * here[i].abs();
    }
    if C == 0 && bounded && from == 0 {
        (centre[0], rhs[0]) = (1.0, 0.0);
        lower.iter_mut().chain(upper.iter_mut()).for_each(|list| list[0] = 0.0);
    }
    let across: f64 = (1..D).map(|b| nodes[b].volume[first[b]]).product();
    sums.map(|parts| across * ((parts[0] + parts[1]) + (parts[2] + parts[3])))
}

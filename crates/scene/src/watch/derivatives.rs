//! Derivatives of the velocity at the cells' centres.
use crate::view::View;
use fv_mesh::Axis;

/// Derivative along `axis` in cell `i` of `n` values at the centres: central differences, one-sided
/// at bounded sides.
pub(super) fn slope(axis: &Axis, i: usize, n: usize, periodic: bool, at: &dyn Fn(usize) -> f64) -> f64 {
    if periodic && n > 2 && axis.is_uniform() {
        let (before, after) = ((i + n - 1) % n, (i + 1) % n);
        return (at(after) - at(before)) / (2.0 * axis.mean_width());
    }
    let (before, after) = (i.saturating_sub(1), (i + 1).min(n - 1));
    let room = axis.centre(after) - axis.centre(before);
    if room > 0.0 { (at(after) - at(before)) / room } else { 0.0 }
}

/// Vorticity ∇×u \[1/s\], in the plane its component along z alone, and Q = (|Ω|² − |S|²)/2
/// \[1/s²\] (Hunt, Wray & Moin 1988) in every cell.
#[derive(Default)]
pub(super) struct VortexFields {
    velocity: [Vec<f64>; 3],
    pub(super) vorticity: Vec<Vec<f64>>,
    pub(super) q: Vec<f64>,
}

impl VortexFields {
    pub(super) fn update(&mut self, view: &dyn View) {
        let dim = view.dim();
        view.centred(&mut self.velocity[..dim]);
        let n: [usize; 3] = std::array::from_fn(|a| if a < dim { view.axis(a).cells() } else { 1 });
        let stride = [1, n[0], n[0] * n[1]];
        self.vorticity.resize(if dim == 2 { 1 } else { 3 }, Vec::new());
        self.vorticity.iter_mut().for_each(Vec::clear);
        self.q.clear();
        for cell in 0..n.iter().product() {
            let index: [usize; 3] = std::array::from_fn(|a| cell / stride[a] % n[a]);
            // g[c][a] = ∂u_c/∂x_a.
            let mut g = [[0.0; 3]; 3];
            for (c, row) in g.iter_mut().enumerate().take(dim) {
                for (a, g) in row.iter_mut().enumerate().take(dim) {
                    let first = cell - index[a] * stride[a];
                    let at = |i: usize| self.velocity[c][first + i * stride[a]];
                    *g = slope(view.axis(a), index[a], n[a], view.periodic(a), &at);
                }
            }
            let curl = [g[2][1] - g[1][2], g[0][2] - g[2][0], g[1][0] - g[0][1]];
            let shown = if dim == 2 { &curl[2..] } else { &curl[..] };
            self.vorticity.iter_mut().zip(shown).for_each(|(field, w)| field.push(*w));
            // |Ω|² − |S|² = −g_ca g_ac.
            let product = |c: usize| (0..3).map(|a| g[c][a] * g[a][c]).sum::<f64>();
            self.q.push(-0.5 * (0..3).map(product).sum::<f64>());
        }
    }
}

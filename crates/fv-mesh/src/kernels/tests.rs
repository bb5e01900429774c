//! Orders of the single terms of the momentum equation against manufactured fields.
//!
//! Every term is taken from its kernel with exact values in the ghosts, so that nothing but its own truncation error
//! counts; norms are weighted with a smooth function that vanishes beside the sides. The velocity is monotone along every
//! axis, so the limited scheme is measured away from extrema; it is carried upwards along x and downwards along the other
//! axes, in the plane the other way round too.
use super::*;
use crate::boundary::Boundaries;
use crate::implicit::ImplicitDiffusion;
use crate::metrics::Metrics;
use crate::operators::tests::{Family, Norms, assert_order, exact};
use crate::spans::Spans;
use crate::{Convection, Side, Sides};
use std::f64::consts::PI;

const FAMILIES: [Family; 3] = [Family::Uniform, Family::Tanh, Family::Geometric];

/// s_c(x) = Σ_a w_a x_a + 0.1, of which every field is a function.
fn wave_number(c: usize, a: usize) -> f64 {
    [[0.5, 0.4, 0.3], [0.4, 0.5, 0.3], [0.3, 0.4, 0.5]][c][a]
}
fn phase<const D: usize>(c: usize, x: [f64; D]) -> f64 {
    0.1 + (0..D).map(|a| wave_number(c, a) * x[a]).sum::<f64>()
}

/// u_c = ±(1.5 + sin s_c): no component changes its sign or has an extremum in the unit box.
#[derive(Clone, Copy)]
struct Flow {
    sign: f64,
}

impl Flow {
    fn sign(self, c: usize) -> f64 {
        if c == 0 { self.sign } else { -self.sign }
    }
    fn u<const D: usize>(self, c: usize, x: [f64; D]) -> f64 {
        self.sign(c) * (1.5 + phase(c, x).sin())
    }
    /// ∂u_c/∂x_b.
    fn slope<const D: usize>(self, c: usize, b: usize, x: [f64; D]) -> f64 {
        self.sign(c) * wave_number(c, b) * phase(c, x).cos()
    }
    /// ∂²u_c/∂x_a∂x_b.
    fn second<const D: usize>(self, c: usize, [a, b]: [usize; 2], x: [f64; D]) -> f64 {
        -self.sign(c) * wave_number(c, a) * wave_number(c, b) * phase(c, x).sin()
    }
    /// −Σ_b ∂(u_b u_c)/∂x_b.
    fn convection<const D: usize>(self, c: usize, x: [f64; D]) -> f64 {
        let along = |b| self.u(b, x) * self.slope(c, b, x) + self.u(c, x) * self.slope(b, b, x);
        -(0..D).map(along).sum::<f64>()
    }
    /// Σ_b ν_b ∂²u_c/∂x_b².
    fn diffusion<const D: usize>(self, c: usize, nu: [f64; D], x: [f64; D]) -> f64 {
        (0..D).map(|b| nu[b] * self.second(c, [b, b], x)).sum()
    }
    /// Σ_b ∂/∂x_b [ν_t (∂u_c/∂x_b + ∂u_b/∂x_c)], ν_t = [`eddy`].
    fn eddy_stress<const D: usize>(self, c: usize, x: [f64; D]) -> f64 {
        let along = |b| {
            eddy_slope(b, x) * (self.slope(c, b, x) + self.slope(b, c, x))
                + eddy(x) * (self.second(c, [b, b], x) + self.second(b, [b, c], x))
        };
        (0..D).map(along).sum()
    }
}

/// ν_t.
fn eddy<const D: usize>(x: [f64; D]) -> f64 {
    1.3 + (0..D).map(|a| (0.8 * x[a] + 0.2 * a as f64).sin()).sum::<f64>()
}
fn eddy_slope<const D: usize>(b: usize, x: [f64; D]) -> f64 {
    0.8 * (0.8 * x[b] + 0.2 * b as f64).cos()
}

/// What one grid gives: the term, its order in theory, the errors in the 2-norm and the maximum norm.
type Errors = Vec<(String, f64, [f64; 2])>;

/// A box whose sides are bounded, and how errors in it are measured.
struct Setting<const D: usize> {
    grid: CartesianGrid<D>,
    metrics: Metrics<D>,
    norms: Norms,
}

impl<const D: usize> Setting<D> {
    fn new(family: Family, n: usize) -> Self {
        let grid = family.grid(n);
        let inside = |x: [f64; D]| x.iter().map(|x| (PI * ((x - 0.1) / 0.8).clamp(0.0, 1.0)).sin()).product();
        Self { metrics: Metrics::new(&grid, [false; D]), norms: Norms::new(&grid, inside), grid }
    }
    fn field(&self, node: Option<usize>, f: impl Fn([f64; D]) -> f64) -> Field<D> {
        exact(&self.grid, &self.metrics, node, f)
    }

    /// Hⁿ and (u* − uⁿ)/dt of component `c` as the predictor's sweep gives them, without an earlier tendency.
    fn sweep(
        &self,
        c: usize,
        scheme: Convection,
        k: Advance<D>,
        u: &[Field<D>; D],
        p: &Field<D>,
    ) -> [Field<D>; 2] {
        let (mut next, mut tendency) = (Field::zeros(&self.grid), Field::zeros(&self.grid));
        Momentum::new(&self.grid, &self.metrics, scheme).advance(
            c,
            k,
            u,
            p,
            &mut next,
            (&mut tendency, None),
        );
        change(&self.grid, -1.0, &u[c], &mut next);
        [tendency, next]
    }

    /// Errors of all terms of component `c`.
    fn terms(&self, c: usize, flow: Flow) -> Errors {
        let u: [Field<D>; D] = std::array::from_fn(|c| self.field(Some(c), |x| flow.u(c, x)));
        let p = self.field(None, |x| phase(c, x).sin());
        let dp = |x: [f64; D]| wave_number(c, c) * phase(c, x).cos();
        let nothing = Advance {
            dt: 1.0,
            weights: [0.0; 2],
            explicit: [0.0; D],
            implicit: [0.0; D],
            specific_volume: 0.0,
            force: 0.0,
        };
        let nu = std::array::from_fn(|b| 0.7 + 0.2 * b as f64);
        let mut list = Errors::new();
        let mut tell = |term: String, order: f64, found: &Field<D>, wanted: &Field<D>| {
            list.push((term, order, self.norms.of(found, wanted)));
        };

        let wanted = self.field(Some(c), |x| flow.convection(c, x));
        for scheme in Convection::ALL {
            let [found, _] = self.sweep(c, scheme, nothing, &u, &p);
            let order = if scheme == Convection::Upwind { 1.0 } else { 2.0 };
            tell(format!("{scheme:?} convection"), order, &found, &wanted);
        }

        let wanted = self.field(Some(c), |x| flow.diffusion(c, nu, x));
        let [mut found, _] = self.sweep(c, Convection::Central, Advance { explicit: nu, ..nothing }, &u, &p);
        let [convection, _] = self.sweep(c, Convection::Central, nothing, &u, &p);
        change(&self.grid, -1.0, &convection, &mut found);
        tell("explicit viscous term".into(), 2.0, &found, &wanted);
        let [_, found] = self.sweep(c, Convection::Central, Advance { implicit: nu, ..nothing }, &u, &p);
        tell("implicit viscous term, old part".into(), 2.0, &found, &wanted);

        let wanted = self.field(Some(c), |x| -0.8 * dp(x));
        let [_, found] =
            self.sweep(c, Convection::Central, Advance { specific_volume: 0.8, ..nothing }, &u, &p);
        tell("pressure gradient".into(), 2.0, &found, &wanted);
        let mut found = Field::zeros(&self.grid);
        let dense: Vec<f64> = p.values().collect();
        correct_component(&self.grid, &self.metrics, c, Conductance::Same(0.8), &dense, &mut found);
        tell("gradient of the correction".into(), 2.0, &found, &wanted);

        let (nu_t, mut found) = (self.field(None, eddy), Field::zeros(&self.grid));
        add_eddy_stress((&self.grid, &self.metrics, &Spans::default()), c, &u, &nu_t, &mut found);
        tell("eddy stress".into(), 2.0, &found, &self.field(Some(c), |x| flow.eddy_stress(c, x)));
        list
    }
}

/// On n and 2n cells per axis; `signs` are those of the velocity along x.
fn orders<const D: usize>(families: &[Family], n: usize, signs: &[f64]) {
    for (&family, c) in families.iter().flat_map(|family| (0..D).map(move |c| (family, c))) {
        let [coarse, fine] = [n, 2 * n].map(|n| Setting::<D>::new(family, n));
        for &sign in signs {
            let flow = Flow { sign };
            let errors = coarse.terms(c, flow).into_iter().zip(fine.terms(c, flow));
            for ((term, order, coarse), (.., fine)) in errors {
                let found = [0, 1].map(|k| (coarse[k] / fine[k]).log2());
                let what = format!("{D}-D {family:?} component {c}, sign {sign}: {term}");
                println!("{what} {found:.3?}");
                assert_order(&what, coarse, fine, order);
            }
        }
    }
}

#[test]
fn orders_of_the_terms_in_the_plane() {
    orders::<2>(&FAMILIES, 128, &[1.0, -1.0]);
}

#[test]
fn orders_of_the_terms_in_space_on_uniform_cells() {
    orders::<3>(&[Family::Uniform], 32, &[1.0]);
}

#[test]
fn orders_of_the_terms_in_space_on_tanh_cells() {
    orders::<3>(&[Family::Tanh], 32, &[1.0]);
}

#[test]
fn orders_of_the_terms_in_space_on_geometric_cells() {
    orders::<3>(&[Family::Geometric], 32, &[1.0]);
}

/// (1 − κ_x L_x)(1 − κ_y L_y)… δ = r between walls, where δ = Π sin πx_a is a multiple of r: all nodes count.
fn implicit_orders<const D: usize>(n: usize) {
    let kappa: [f64; D] = std::array::from_fn(|a| 0.05 + 0.02 * a as f64);
    let error = |family: Family, n: usize, c: usize| {
        let grid: CartesianGrid<D> = family.grid(n);
        let metrics = Metrics::new(&grid, [false; D]);
        let sides = Sides::new(Side::WALL.everywhere()).unwrap();
        let boundaries = Boundaries::new(&grid, sides, &metrics).unwrap();
        let mode = |x: [f64; D]| x.iter().map(|x| (PI * x).sin()).product::<f64>();
        let factor: f64 = kappa.iter().map(|kappa| 1.0 + kappa * PI * PI).product();
        let mut found = exact(&grid, &metrics, Some(c), |x| factor * mode(x));
        let mut implicit = ImplicitDiffusion::new(&grid);
        implicit.set(&metrics, kappa);
        implicit.solve(c, &metrics, &boundaries, &mut found);
        Norms::new(&grid, |_| 1.0).of(&found, &exact(&grid, &metrics, Some(c), mode))
    };
    for (family, c) in FAMILIES.into_iter().flat_map(|family| (0..D).map(move |c| (family, c))) {
        let [coarse, fine] = [n, 2 * n].map(|n| error(family, n, c));
        assert_order(&format!("{family:?} {D}-D component {c}: implicit solution"), coarse, fine, 2.0);
    }
}

#[test]
fn orders_of_the_implicit_viscous_solution() {
    implicit_orders::<2>(32);
    implicit_orders::<3>(24);
}

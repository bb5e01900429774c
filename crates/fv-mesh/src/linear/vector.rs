//! Sweeps over vectors that compute sums on the way. A sum is formed in eight lanes per chunk of fixed length, and
//! the chunks are added up in a fixed tree: results do not depend on the number of threads.
use crate::parts::join;
use pulp::{Arch, Simd, WithSimd};

/// Entries that one task works on.
pub(super) const CHUNK: usize = 8192;
const LANES: usize = 8;

/// What is done with entry i of `I` vectors read and `O` vectors changed; gives the terms of `R` sums.
pub(super) trait Kernel<const I: usize, const O: usize, const R: usize>: Copy + Send + Sync {
    fn at(self, input: [f64; I], output: [&mut f64; O]) -> [f64; R];
}

/// Runs the kernel over vectors of one length. No allocation.
pub(super) fn sweep<const I: usize, const O: usize, const R: usize>(
    kernel: impl Kernel<I, O, R>,
    n: usize,
    input: [&[f64]; I],
    output: [&mut [f64]; O],
) -> [f64; R] {
    if n <= CHUNK {
        return Arch::new().dispatch(Chunk { kernel, n, input, output, sums: [[0.0; LANES]; R] });
    }
    let half = n.div_ceil(2 * CHUNK) * CHUNK;
    let input = input.map(|v| v.split_at(half));
    let mut parts = output.map(|v| v.split_at_mut(half));
    let low = parts.each_mut().map(|p| std::mem::take(&mut p.0));
    let high = parts.map(|p| p.1);
    let (a, b) = join(
        n,
        || sweep(kernel, half, input.map(|p| p.0), low),
        || sweep(kernel, n - half, input.map(|p| p.1), high),
    );
    std::array::from_fn(|k| a[k] + b[k])
}

struct Chunk<'a, K, const I: usize, const O: usize, const R: usize> {
    kernel: K,
    n: usize,
    input: [&'a [f64]; I],
    output: [&'a mut [f64]; O],
    sums: [[f64; LANES]; R],
}

impl<K: Kernel<I, O, R>, const I: usize, const O: usize, const R: usize> Chunk<'_, K, I, O, R> {
    #[inline(always)]
    fn run(self) -> [f64; R] {
        let Self { kernel, n, input, output, mut sums } = self;
        let blocks = n / LANES;
        let whole = blocks * LANES;
        let input_blocks = input.map(|v| &v[..whole].as_chunks::<LANES>().0[..blocks]);
        let mut output = output.map(|v| v[..n].split_at_mut(whole));
        for block in 0..blocks {
            let read: [[f64; LANES]; I] = std::array::from_fn(|k| input_blocks[k][block]);
            let mut written = output.each_mut().map(|v| &mut v.0.as_chunks_mut::<LANES>().0[block]);
            for lane in 0..LANES {
                let terms = kernel.at(read.map(|v| v[lane]), written.each_mut().map(|v| &mut v[lane]));
                for (sum, term) in sums.iter_mut().zip(terms) {
                    sum[lane] += term;
                }
            }
        }
        for i in whole..n {
            let terms = kernel.at(input.map(|v| v[i]), output.each_mut().map(|v| &mut v.1[i - whole]));
            for (sum, term) in sums.iter_mut().zip(terms) {
                sum[i - whole] += term;
            }
        }
        sums.map(|s| ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7])))
    }
}

impl<K: Kernel<I, O, R>, const I: usize, const O: usize, const R: usize> WithSimd for Chunk<'_, K, I, O, R> {
    type Output = [f64; R];
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> [f64; R] {
        self.run()
    }
}

#[derive(Clone, Copy)]
struct Dot;
impl Kernel<2, 0, 1> for Dot {
    #[inline(always)]
    fn at(self, [a, b]: [f64; 2], _: [&mut f64; 0]) -> [f64; 1] {
        [a * b]
    }
}

/// a · b.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    sweep(Dot, a.len(), [a, b], [])[0]
}

/// ‖a‖₂.
pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

#[derive(Clone, Copy)]
struct DotTwo;
impl Kernel<3, 0, 2> for DotTwo {
    #[inline(always)]
    fn at(self, [a, b, c]: [f64; 3], _: [&mut f64; 0]) -> [f64; 2] {
        [a * b, a * c]
    }
}

/// a · b and a · c.
pub(super) fn dot_two(a: &[f64], b: &[f64], c: &[f64]) -> [f64; 2] {
    sweep(DotTwo, a.len(), [a, b, c], [])
}

#[derive(Clone, Copy)]
struct SubtractFrom;
impl Kernel<1, 1, 0> for SubtractFrom {
    #[inline(always)]
    fn at(self, [b]: [f64; 1], [r]: [&mut f64; 1]) -> [f64; 0] {
        *r = b - *r;
        []
    }
}

/// r = b − r.
pub(super) fn subtract_from(b: &[f64], r: &mut [f64]) {
    sweep(SubtractFrom, b.len(), [b], [r]);
}

#[derive(Clone, Copy)]
struct AddScaled(f64);
impl Kernel<1, 1, 1> for AddScaled {
    #[inline(always)]
    fn at(self, [a]: [f64; 1], [y]: [&mut f64; 1]) -> [f64; 1] {
        *y += self.0 * a;
        [*y * *y]
    }
}

/// y += f a; gives y · y.
pub(super) fn add_scaled(f: f64, a: &[f64], y: &mut [f64]) -> f64 {
    sweep(AddScaled(f), a.len(), [a], [y])[0]
}

#[derive(Clone, Copy)]
struct ScaleAdd(f64);
impl Kernel<1, 1, 0> for ScaleAdd {
    #[inline(always)]
    fn at(self, [a]: [f64; 1], [y]: [&mut f64; 1]) -> [f64; 0] {
        *y = a + self.0 * *y;
        []
    }
}

/// y = a + f y.
pub(super) fn scale_add(a: &[f64], f: f64, y: &mut [f64]) {
    sweep(ScaleAdd(f), a.len(), [a], [y]);
}

#[derive(Clone, Copy)]
struct Step(f64);
impl Kernel<2, 2, 1> for Step {
    #[inline(always)]
    fn at(self, [p, q]: [f64; 2], [x, r]: [&mut f64; 2]) -> [f64; 1] {
        *x += self.0 * p;
        *r -= self.0 * q;
        [*r * *r]
    }
}

/// x += α p, r −= α q; gives r · r.
pub(super) fn step(alpha: f64, p: &[f64], q: &[f64], x: &mut [f64], r: &mut [f64]) -> f64 {
    sweep(Step(alpha), p.len(), [p, q], [x, r])[0]
}

#[derive(Clone, Copy)]
struct Direction {
    beta: f64,
    omega: f64,
}
impl Kernel<2, 1, 0> for Direction {
    #[inline(always)]
    fn at(self, [r, v]: [f64; 2], [p]: [&mut f64; 1]) -> [f64; 0] {
        *p = r + self.beta * (*p - self.omega * v);
        []
    }
}

/// p = r + β (p − ω v).
pub(super) fn direction(r: &[f64], beta: f64, omega: f64, v: &[f64], p: &mut [f64]) {
    sweep(Direction { beta, omega }, r.len(), [r, v], [p]);
}

#[derive(Clone, Copy)]
struct Stabilise {
    alpha: f64,
    omega: f64,
}
impl Kernel<4, 2, 2> for Stabilise {
    #[inline(always)]
    fn at(self, [y, z, t, shadow]: [f64; 4], [x, r]: [&mut f64; 2]) -> [f64; 2] {
        *x += self.alpha * y + self.omega * z;
        *r -= self.omega * t;
        [*r * *r, *r * shadow]
    }
}

/// x += α y + ω z, r −= ω t; gives r · r and r · r̂.
pub(super) fn stabilise(
    [alpha, omega]: [f64; 2],
    [y, z, t, shadow]: [&[f64]; 4],
    x: &mut [f64],
    r: &mut [f64],
) -> [f64; 2] {
    sweep(Stabilise { alpha, omega }, y.len(), [y, z, t, shadow], [x, r])
}

#[derive(Clone, Copy)]
struct Multiply;
impl Kernel<2, 1, 0> for Multiply {
    #[inline(always)]
    fn at(self, [a, b]: [f64; 2], [y]: [&mut f64; 1]) -> [f64; 0] {
        *y = a * b;
        []
    }
}

/// y_i = a_i b_i.
pub(super) fn multiply(a: &[f64], b: &[f64], y: &mut [f64]) {
    sweep(Multiply, a.len(), [a, b], [y]);
}

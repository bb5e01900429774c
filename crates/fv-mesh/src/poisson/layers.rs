//! From rows of the right-hand side to transformed layers and back.
use super::Rows;
use super::modes::Modes;
use super::transform::AxisTransform;
use pulp::{Simd, WithSimd};
use rustfft::num_complex::Complex;

/// Columns that are transformed along y at once.
const GROUP: usize = 8;

/// What the transforms of a layer need to know.
pub(super) struct Layout {
    pub(super) x: AxisTransform,
    /// In three dimensions.
    pub(super) y: Option<AxisTransform>,
    pub(super) modes: Modes,
    pub(super) nx: usize,
    /// Rows of a layer.
    pub(super) rows: usize,
    /// Layers of the box.
    pub(super) layers: usize,
    /// Complex layers per chunk.
    pub(super) chunk: usize,
}

/// Work space of a chunk.
pub(super) struct Scratch {
    /// Two real rows.
    rows: Vec<f64>,
    fft: Vec<Complex<f64>>,
    /// Columns along y.
    columns: Vec<Complex<f64>>,
}

impl Scratch {
    pub(super) fn new(x: &AxisTransform, y: Option<&AxisTransform>) -> Self {
        let zero = Complex::default();
        let fft = x.scratch_len().max(y.map_or(0, AxisTransform::scratch_len));
        Self {
            rows: vec![0.0; 2 * x.len()],
            fft: vec![zero; fft],
            columns: vec![zero; GROUP * y.map_or(0, AxisTransform::len)],
        }
    }
}

/// Transforms a chunk of complex layers.
pub(super) struct Forward<'a> {
    pub(super) layout: &'a Layout,
    /// First complex layer.
    pub(super) first: usize,
    pub(super) fill: Rows<'a>,
    pub(super) spectra: &'a mut [Complex<f64>],
    pub(super) scratch: &'a mut Scratch,
}

// A type rather than a closure: `pulp` compiles the body of `with_simd` for the processor at hand, while
// a closure that could be called twice is called through a shim that is not.
impl WithSimd for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { layout, first, fill, spectra, scratch } = self;
        for (i, layer) in spectra.chunks_exact_mut(layout.modes.layer_stride).enumerate() {
            layout.transform_layer(first + i, layer, scratch, fill);
        }
    }
}

/// Transforms a chunk of complex layers back.
pub(super) struct Backward<'a> {
    pub(super) layout: &'a Layout,
    /// First complex layer.
    pub(super) first: usize,
    pub(super) solutions: &'a [f64],
    /// Solution of the constant mode if it is not among the others.
    pub(super) column: Option<&'a [f64]>,
    pub(super) spectra: &'a mut [Complex<f64>],
    pub(super) scratch: &'a mut Scratch,
    /// Layers of φ from the low end, ascending.
    pub(super) front: &'a mut [f64],
    /// Their mirrors, which descend from the high end.
    pub(super) back: &'a mut [f64],
}

impl WithSimd for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { layout, first, solutions, column, spectra, scratch, front, back } = self;
        let cells = layout.nx * layout.rows;
        let mut back = back.rchunks_exact_mut(cells);
        let layers = spectra.chunks_exact_mut(layout.modes.layer_stride).zip(front.chunks_exact_mut(cells));
        for (i, (layer, front)) in layers.enumerate() {
            let s = first + i;
            layout.modes.gather(s, solutions, layer);
            if let Some(column) = column {
                let (re, im) = (column[s], column[layout.layers - 1 - s]);
                layer[layout.modes.front] = Complex { re, im };
            }
            layout.transform_layer_back(layer, scratch, front, back.next().unwrap_or_default());
        }
    }
}

impl Layout {
    /// Fills and transforms complex layer `s`, which carries layer s as real and its mirror across
    /// the centre of the last axis as imaginary part.
    #[inline(always)]
    fn transform_layer(&self, s: usize, layer: &mut [Complex<f64>], scratch: &mut Scratch, fill: Rows<'_>) {
        let mirror = self.layers - 1 - s;
        let (a, b) = scratch.rows.split_at_mut(self.nx);
        for j in 0..self.rows {
            fill(s * self.rows + j, a);
            if mirror == s {
                b.copy_from_slice(a);
            } else {
                fill(mirror * self.rows + j, b);
            }
            let row = self.row(j, layer);
            self.x.pack(a, b, row);
            self.x.forward(row, &mut scratch.fft);
        }
        if let Some(y) = &self.y {
            self.along_y(y, layer, scratch, true);
        }
        if self.x.periodic() {
            for row in layer.chunks_exact_mut(self.modes.row_stride).take(self.rows) {
                row[self.modes.front + self.nx] = row[self.modes.front];
            }
        }
    }

    /// Transforms a complex layer back and writes its real layers.
    #[inline(always)]
    fn transform_layer_back(
        &self,
        layer: &mut [Complex<f64>],
        scratch: &mut Scratch,
        a: &mut [f64],
        b: &mut [f64],
    ) {
        if let Some(y) = &self.y {
            self.along_y(y, layer, scratch, false);
        }
        for j in 0..self.rows {
            let row = self.row(j, layer);
            self.x.inverse(row, &mut scratch.fft);
            let cells = j * self.nx..(j + 1) * self.nx;
            self.x.unpack(row, &mut a[cells.clone()], b.get_mut(cells).unwrap_or_default());
        }
    }

    #[inline(always)]
    fn row<'a>(&self, j: usize, layer: &'a mut [Complex<f64>]) -> &'a mut [Complex<f64>] {
        let start = j * self.modes.row_stride + self.modes.front;
        &mut layer[start..start + self.nx]
    }

    /// Transforms the columns of a layer, several at a time in contiguous memory.
    #[inline(always)]
    fn along_y(&self, y: &AxisTransform, layer: &mut [Complex<f64>], scratch: &mut Scratch, forward: bool) {
        let n = self.rows;
        for start in (0..self.nx).step_by(GROUP) {
            let width = GROUP.min(self.nx - start);
            let columns = &mut scratch.columns[..width * n];
            for j in 0..n {
                let (slot, sign) = if forward { y.slot(j) } else { (j, 1.0) };
                for (c, z) in self.row(j, layer)[start..start + width].iter().enumerate() {
                    columns[c * n + slot] = z.scale(sign);
                }
            }
            if forward {
                y.forward(columns, &mut scratch.fft);
            } else {
                y.inverse(columns, &mut scratch.fft);
            }
            for j in 0..n {
                let (slot, sign) = if forward { (j, 1.0) } else { y.slot(j) };
                for (c, z) in self.row(j, layer)[start..start + width].iter_mut().enumerate() {
                    *z = columns[c * n + slot].scale(sign);
                }
            }
        }
    }
}

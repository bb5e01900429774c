//! Trigonometric polynomials of several phases.

/// Products of cos kθ_a and sin kθ_a over phases θ_a with 1 ≤ Σ|k| ≤ q, as functions of the pairs cos θ_a, sin θ_a.
#[derive(Clone, Debug)]
pub(super) struct Waves {
    phases: usize,
    /// q.
    harmonics: usize,
    /// For every phase the harmonic k, and whether it is sin kθ.
    waves: Vec<Vec<(usize, bool)>>,
}

impl Waves {
    /// Highest harmonic that a record may have.
    pub(super) const MOST: usize = 64;

    pub(super) fn new(phases: usize, harmonics: usize) -> Self {
        let waves = multi_indices(phases, harmonics).into_iter().skip(1).flat_map(|k| {
            let each = |done: Vec<Vec<(usize, bool)>>, k: usize| -> Vec<Vec<(usize, bool)>> {
                let kinds: &[bool] = if k == 0 { &[false] } else { &[false, true] };
                let with = |wave: &Vec<(usize, bool)>, sine: bool| [wave.as_slice(), &[(k, sine)]].concat();
                done.iter().flat_map(|wave| kinds.iter().map(move |&sine| with(wave, sine))).collect()
            };
            k.into_iter().fold(vec![vec![]], each)
        });
        Self { phases, harmonics, waves: waves.collect() }
    }
    pub(super) fn harmonics(&self) -> usize {
        self.harmonics
    }
    pub(super) fn phases(&self) -> usize {
        self.phases
    }
    pub(super) fn len(&self) -> usize {
        self.waves.len()
    }
    /// Every one at pairs z, or its derivative by entry `along` of z.
    pub(super) fn at(&self, z: &[f64], along: Option<usize>) -> Vec<f64> {
        let of = |a: usize| {
            powers([z[2 * a], z[2 * a + 1]], self.harmonics, along.and_then(|i| i.checked_sub(2 * a)))
        };
        let powers: Vec<Vec<[f64; 2]>> = (0..self.phases).map(of).collect();
        let factor = |(a, &(k, sine)): (usize, &(usize, bool))| powers[a][k][usize::from(sine)];
        self.waves.iter().map(|wave| wave.iter().enumerate().map(factor).product()).collect()
    }
}

/// All vectors of whole numbers with a sum up to `degree`, that of zeros first.
pub(super) fn multi_indices(variables: usize, degree: usize) -> Vec<Vec<usize>> {
    (0..variables).fold(vec![vec![]], |done: Vec<Vec<usize>>, _| {
        let rest = |index: &Vec<usize>| degree - index.iter().sum::<usize>();
        done.iter()
            .flat_map(|index| (0..=rest(index)).map(move |n| [index.as_slice(), &[n]].concat()))
            .collect()
    })
}

/// cos kθ and sin kθ for k = 0 … `most` as polynomials of c = cos θ and s = sin θ, or their derivatives by c (`along` 0) or s (1).
fn powers([c, s]: [f64; 2], most: usize, along: Option<usize>) -> Vec<[f64; 2]> {
    let mut z = vec![[1.0, 0.0]];
    for k in 0..most {
        let [re, im] = z[k];
        z.push([re * c - im * s, re * s + im * c]);
    }
    // d zᵏ/dc = k zᵏ⁻¹, d zᵏ/ds = i k zᵏ⁻¹.
    let slope = |k: usize, turned: bool| match k.checked_sub(1) {
        None => [0.0; 2],
        Some(lower) => {
            let [re, im] = z[lower].map(|v| k as f64 * v);
            if turned { [-im, re] } else { [re, im] }
        }
    };
    match along {
        Some(0) => (0..=most).map(|k| slope(k, false)).collect(),
        Some(1) => (0..=most).map(|k| slope(k, true)).collect(),
        _ => z,
    }
}

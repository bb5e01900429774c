//! Triangles of plane polygons in space.
use earcut::Earcut;
use interfaces::Vector;

/// Polygons of more corners make fans: `earcut` numbers its nodes by 32 bits.
const MOST_CORNERS: usize = 1 << 24;

/// Workspace for the triangulation of polygons.
pub(crate) struct Triangulation {
    ears: Earcut<f64>,
    ring: Vec<u32>,
    plane: Vec<[f64; 2]>,
    triangles: Vec<u32>,
}

impl Default for Triangulation {
    fn default() -> Self {
        Self { ears: Earcut::new(), ring: Vec::new(), plane: Vec::new(), triangles: Vec::new() }
    }
}

impl Triangulation {
    /// Appends the n − 2 triangles of a polygon with these `corners`, turned as it is. They make a fan
    /// around the first corner if all of them have an area then, as seen along Newell's normal
    /// N = ½ Σ vᵢ × vᵢ₊₁; otherwise ears are clipped in its plane. A corner that repeats the one before
    /// it is left out. Corners that are on a line, or do not exist, or are those of a polygon that
    /// crosses itself, make a fan, too, which the admission of meshes judges.
    pub(crate) fn append(&mut self, corners: &[u32], vertices: &[[f64; 3]], faces: &mut Vec<[u32; 3]>) {
        self.ring.clear();
        self.ring.extend_from_slice(corners);
        self.ring.dedup();
        while self.ring.len() > 1 && self.ring.first() == self.ring.last() {
            self.ring.pop();
        }
        if self.ring.len() < 3 {
            // A point or a line: a face without area, to be named.
            faces.push([corners[0], corners[1], corners[2]]);
            return;
        }
        if (4..=MOST_CORNERS).contains(&self.ring.len()) && self.clip(vertices) {
            faces.extend(self.triangles.as_chunks::<3>().0.iter().map(|t| t.map(|i| self.ring[i as usize])));
            return;
        }
        faces.extend(self.ring.windows(2).skip(1).map(|pair| [self.ring[0], pair[0], pair[1]]));
    }

    /// Clips the ears of the ring; false if a fan fills it, or nothing does.
    fn clip(&mut self, vertices: &[[f64; 3]]) -> bool {
        let place = |v: &u32| vertices.get(*v as usize).map(|v| Vector::from(*v));
        let Some(places) = self.ring.iter().map(place).collect::<Option<Vec<Vector>>>() else {
            return false;
        };
        let relative = |i: usize| places[i % places.len()] - places[0];
        let normal: Vector = (1..places.len()).map(|i| relative(i).cross(&relative(i + 1))).sum();
        if normal == Vector::zeros() || !normal.iter().all(|n| n.is_finite()) {
            return false;
        }
        // Along the largest component, which keeps most of the area.
        let along = normal.iamax();
        let (x, y) = ((along + 1) % 3, (along + 2) % 3);
        self.plane.clear();
        self.plane.extend((0..places.len()).map(|i| [relative(i)[x], relative(i)[y]]));
        let area = |t: [usize; 3]| {
            let [a, b, c] = t.map(|i| self.plane[i]);
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        };
        let turned = |area: f64| (area > 0.0) == (normal[along] > 0.0) && area != 0.0;
        if (2..places.len()).all(|i| turned(area([0, i - 1, i]))) {
            return false;
        }
        self.ears.earcut_slice(&self.plane, &[], &mut self.triangles);
        // All of them are turned alike.
        let triangles = self.triangles.as_chunks_mut::<3>().0;
        if !turned(triangles.iter().map(|t| area(t.map(|i| i as usize))).sum()) {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        self.triangles.len() == 3 * (places.len() - 2)
    }
}

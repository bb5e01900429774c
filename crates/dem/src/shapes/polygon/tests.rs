use super::*;
use proptest::prelude::*;

/// A star: corners at these radii, at equal angles.
fn star(radii: &[f64]) -> Vec<[f64; 2]> {
    let corner = |(i, r): (usize, &f64)| {
        let (sin, cos) = (TAU * i as f64 / radii.len() as f64).sin_cos();
        [3.0 + r * cos, r * sin - 2.0]
    };
    radii.iter().enumerate().map(corner).collect()
}

fn polygon(corners: &[[f64; 2]]) -> Polygon {
    Polygon::new(corners).unwrap()
}

#[test]
fn a_rectangle_weighs_what_it_should() {
    let Inertia { mass, volume, tensor } = Polygon::rectangle([2.0, 1.0]).unwrap().inertia(3.0);
    assert!((volume - 2.0).abs() < 1e-15 && (mass - 6.0).abs() < 1e-15);
    let expected = Matrix3::from_diagonal(&Vector::new(0.5, 2.0, 2.5));
    assert!((tensor - expected).norm() < 1e-14, "{tensor}");
    // An angle: two rectangles of 2 × 1 and 1 × 1.
    let angle = polygon(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]);
    let [c, d] = [5.0 / 6.0, 5.0_f64 / 6.0];
    let own = 2.0 * (4.0 + 1.0) / 12.0 + 2.0 * ((1.0 - c).powi(2) + (0.5 - d).powi(2));
    let other = 2.0 / 12.0 + (0.5 - c).powi(2) + (1.5 - d).powi(2);
    assert!((angle.inertia(1.0).tensor[(2, 2)] - own - other).abs() < 1e-14);
    assert!((2..=3).contains(&angle.pieces().len()));
    let ellipse = Polygon::ellipse([2.0, 1.0], 64).unwrap();
    assert!((ellipse.area() - TAU).abs() < 1e-13 && ellipse.pieces().len() == 1);
    assert!((ellipse.inertia(1.0).tensor[(2, 2)] / (TAU * 5.0 / 4.0) - 1.0).abs() < 2e-3);
}

#[test]
fn senseless_polygons_are_refused() {
    let told = |corners: &[[f64; 2]]| Polygon::new(corners).unwrap_err().to_string();
    assert!(told(&[[0.0, 0.0], [1.0, 0.0]]).contains("three corners"));
    assert!(
        told(&[[0.0, 0.0], [1.0, f64::NAN], [0.0, 1.0]]).contains("corner 1 of the polygon is not finite")
    );
    let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    assert!(told(&bow).contains("crosses or touches"));
    assert!(told(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]).contains("crosses"));
    assert!(told(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]]).contains("crosses"));
    // A corner on another edge.
    assert!(told(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]]).contains("crosses"));
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(Polygon::rectangle([1.0, bad]), Err(DemError::Length { .. })), "{bad}");
        assert!(matches!(Polygon::ellipse([bad, 1.0], 8), Err(DemError::Length { .. })), "{bad}");
    }
    assert!(Polygon::ellipse([1.0, 2.0], 2).is_err() && Polygon::ellipse([1.0, 2.0], 0).is_err());
}

#[test]
fn straight_corners_stay_on_the_border() {
    let corners =
        [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0], [0.0, 1.0]];
    let square = polygon(&corners);
    let border: usize = square.pieces().iter().map(|p| p.beyond.iter().filter(|b| b.is_none()).count()).sum();
    assert_eq!((square.pieces().len(), border), (1, 8));
}

proptest! {
    /// Pieces are convex, fill the polygon, and know their neighbours; the direction of the corners does not matter.
    #[test]
    fn pieces_fill_the_polygon(radii in proptest::collection::vec(0.2..2.0_f64, 3..24), shift in 0_usize..24) {
        let mut corners = star(&radii);
        let n = corners.len();
        corners.rotate_left(shift % n);
        let shape = polygon(&corners);
        let twice = |c: &[Vector2<f64>]| -> f64 { (0..c.len()).map(|i| c[i].perp(&c[(i + 1) % c.len()])).sum() };
        let mut area = 0.0;
        for (k, piece) in shape.pieces().iter().enumerate() {
            let c = &piece.corners;
            area += 0.5 * twice(c);
            for i in 0..c.len() {
                let [p, q, r] = [i, i + 1, i + 2].map(|i| c[i % c.len()]);
                prop_assert!((q - p).perp(&(r - q)) >= -1e-14);
                prop_assert!((p - piece.middle).norm() <= piece.radius * (1.0 + 1e-14));
                if let Some(other) = piece.beyond[i] {
                    let other = &shape.pieces()[other as usize];
                    let back = (0..other.corners.len()).find(|&j| other.corners[j] == q && other.beyond[j] == Some(k as u32));
                    prop_assert!(back.is_some_and(|j| other.corners[(j + 1) % other.corners.len()] == p));
                }
            }
        }
        prop_assert!((area / shape.area() - 1.0).abs() < 1e-13);
        let border: usize = shape.pieces().iter().map(|p| p.beyond.iter().filter(|b| b.is_none()).count()).sum();
        prop_assert_eq!(border, n);
        corners.reverse();
        let other = polygon(&corners);
        prop_assert!((other.area() - shape.area()).abs() < 1e-13 && (other.origin() - shape.origin()).norm() < 1e-13);
    }

    /// Distances are those of a fine sampling of the border, inside is where a piece is; normals are their gradients.
    #[test]
    fn distances_are_those_to_the_border(radii in proptest::collection::vec(0.2..2.0_f64, 3..12), x in -3.0..3.0_f64, y in -3.0..3.0_f64) {
        let shape = polygon(&star(&radii));
        let at = Point::new(x, y, 0.0);
        let sampled = shape.edges().flat_map(|[p, q]| (0..=400).map(move |i| p + (q - p) * (f64::from(i) / 400.0)));
        let least = sampled.map(|s| (s - at.coords.xy()).norm()).fold(f64::INFINITY, f64::min);
        let distance = shape.signed_distance(at, 10.0);
        prop_assert!(distance.abs() <= least + 1e-12 && least - distance.abs() < 0.01);
        let holds = |piece: &Piece| {
            let c = &piece.corners;
            (0..c.len()).all(|i| (c[(i + 1) % c.len()] - c[i]).perp(&(at.coords.xy() - c[i])) >= 0.0)
        };
        if distance.abs() > 1e-9 {
            prop_assert_eq!(distance < 0.0, shape.pieces().iter().any(holds));
            let (h, n) = (1e-7, shape.normal(at, 10.0));
            let rise = shape.signed_distance(at + h * n, 10.0) - distance;
            prop_assert!((rise / h - 1.0).abs() < 1e-3 || distance.abs() < 2.0 * h, "{}", rise / h);
        }
    }
}

/// Places on the surface, up to round-off, have the normal of their edge.
#[test]
fn normals_on_the_surface_are_those_of_edges() {
    let (turn, half) = (0.3_f64, [0.315, 0.105]);
    let at = |x: f64, y: f64| [x * turn.cos() - y * turn.sin(), x * turn.sin() + y * turn.cos()];
    let [a, b] = half;
    let shape = Polygon::new(&[at(-a, -b), at(a, -b), at(a, b), at(-a, b)]).unwrap();
    for k in -9..=9 {
        let share = 0.1 * f64::from(k);
        for (place, normal) in [
            (at(share * a, b), at(0.0, 1.0)),
            (at(share * a, -b), at(0.0, -1.0)),
            (at(a, share * b), at(1.0, 0.0)),
            (at(-a, share * b), at(-1.0, 0.0)),
        ] {
            let found = Solid::normal(&shape, Point::new(place[0], place[1], 0.0), a);
            let off = found - Vector::new(normal[0], normal[1], 0.0);
            assert!(off.norm() < 1e-9, "{place:?}: {found:?} for {normal:?}");
        }
    }
}

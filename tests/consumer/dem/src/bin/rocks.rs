//! A hundred rocks from an STL file fall on a plane.
#[cfg(feature = "default")]
mod rocks {
    use dem::placing::{RandomAddition, Region};
    use dem::{Aabb, Bodies, Dynamics, Freedom, HalfSpace, Kinematics, Material, Periods, Point};
    use dem::{RigidBodies, Shape, TriangleMesh, Twist, Vector};
    use std::sync::Arc;

    /// A rock of ten faces, 2 cm large, in millimetres.
    fn stl() -> String {
        let ring: [[f64; 3]; 5] = [[10, 0, 1], [4, 9, -1], [-7, 6, 1], [-9, -5, 0], [3, -8, -2]]
            .map(|corner| corner.map(f64::from));
        let mut text = String::from("solid rock\n");
        for (i, a) in ring.iter().enumerate() {
            let b = ring[(i + 1) % 5];
            for corners in [[*a, b, [1.0, -1.0, 8.0]], [b, *a, [0.0, 1.0, -6.0]]] {
                text += "facet normal 0 0 0\nouter loop\n";
                for [x, y, z] in corners {
                    text += &format!("vertex {x} {y} {z}\n");
                }
                text += "endloop\nendfacet\n";
            }
        }
        text + "endsolid rock\n"
    }

    pub fn run() -> Result<(), Box<dyn std::error::Error>> {
        let path = std::env::temp_dir().join(format!("consumer-rock-{}.stl", std::process::id()));
        std::fs::write(&path, stl())?;
        let rock: Arc<dyn Shape> = Arc::new(TriangleMesh::from_stl(&path, 1e-3)?);
        std::fs::remove_file(path)?;

        let granite = Material { density: 2700.0, youngs_modulus: 1e6, damping: 1.0, ..Material::default() };
        let mut bodies = RigidBodies::new(Periods::default());
        bodies.set_gravity(Vector::new(0.0, 0.0, -9.81));
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z())?, granite)?;
        let above = Aabb { min: [0.0, 0.0, 0.0].into(), max: [0.2, 0.2, 0.15].into() };
        let region = Region::cuboid(above, [false; 3])?;
        for pose in RandomAddition::new(region).place(&[rock.as_ref(); 100], 1)? {
            bodies.add(rock.clone(), granite, pose, Twist::default(), Freedom::FREE)?;
        }
        bodies.check_overlaps()?;
        for _ in 0..150 {
            bodies.advance(1e-3)?;
        }
        let lowest = bodies.ids().map(|b| bodies.pose(b).position.z).fold(f64::INFINITY, f64::min);
        let mass: f64 = bodies.ids().map(|b| bodies.inertia(b).mass).sum();
        println!("dem: {mass:.2} kg of rocks, {} contacts", bodies.n_contacts());
        assert!(bodies.n_contacts() > 10 && lowest > 0.0);
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Meshes are of a feature.
    #[cfg(feature = "default")]
    rocks::run()?;
    Ok(())
}

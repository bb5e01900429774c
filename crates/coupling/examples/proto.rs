use coupling::*;
use fv_mesh::*;
use ibm::*;
use interfaces::*;
struct Disc(f64);
impl Solid for Disc {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        x.x.hypot(x.y) - self.0
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(self.0, self.0, 0.0))
    }
    fn normal(&self, x: Point, _: f64) -> Vector {
        Vector::new(x.x, x.y, 0.0).try_normalize(1e-300).unwrap_or_default()
    }
    fn curvature(&self, x: Point, _: f64) -> f64 {
        1.0 / x.x.hypot(x.y)
    }
    fn surface(&self, s: f64, o: f64) -> Option<Vec<SurfaceElement>> {
        let r = self.0 + o;
        let n = (std::f64::consts::TAU * r / s).round() as usize;
        Some(
            (0..n)
                .map(|i| {
                    let t = std::f64::consts::TAU * i as f64 / n as f64;
                    let e = Vector::new(t.cos(), t.sin(), 0.0);
                    SurfaceElement {
                        point: Point::from(e * r),
                        normal: e,
                        area: std::f64::consts::TAU * r / n as f64,
                    }
                })
                .collect(),
        )
    }
}
struct Discs {
    disc: Disc,
    rho: Vec<f64>,
    pose: Vec<Pose>,
    twist: Vec<Twist>,
    load: Vec<Load>,
    moves: u64,
}
impl Kinematics for Discs {
    fn n_bodies(&self) -> usize {
        self.rho.len()
    }
    fn pose(&self, b: BodyId) -> Pose {
        self.pose[b.0]
    }
    fn twist(&self, b: BodyId) -> Twist {
        self.twist[b.0]
    }
}
impl Bodies for Discs {
    fn solid(&self, _: BodyId) -> &dyn Solid {
        &self.disc
    }
    fn inertia(&self, b: BodyId) -> Inertia {
        let v = std::f64::consts::PI * self.disc.0.powi(2);
        let m = v * self.rho[b.0];
        Inertia {
            mass: m,
            volume: v,
            tensor: nalgebra::Matrix3::from_diagonal_element(0.5 * m * self.disc.0.powi(2)),
        }
    }
    fn freedom(&self, _: BodyId) -> Freedom {
        Freedom::PLANAR
    }
    fn moves(&self, _: BodyId) -> u64 {
        self.moves
    }
}
impl Checkpoint for Discs {
    fn save(&self, _: &mut dyn FnMut(&str, &[f64])) {}
    fn restore<'a>(&mut self, _: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        Ok(())
    }
}
impl Dynamics for Discs {
    type Error = std::fmt::Error;
    fn apply(&mut self, b: BodyId, l: Load) {
        self.load[b.0] = l;
    }
    fn advance(&mut self, dt: f64) -> Result<(), std::fmt::Error> {
        for b in 0..self.rho.len() {
            let i = self.inertia(BodyId(b));
            let l = self.load[b];
            let a = l.wrench.force / (i.mass + l.added_mass);
            let aa = l.wrench.torque / (i.tensor[(2, 2)] + l.added_moment);
            self.pose[b].position += self.twist[b].linear * dt + 0.5 * a * dt * dt;
            self.pose[b].orientation =
                Rotation::from_scaled_axis(self.twist[b].angular * dt) * self.pose[b].orientation;
            self.twist[b].linear += a * dt;
            self.twist[b].angular += aa * dt;
        }
        self.moves += 1;
        Ok(())
    }
    fn contact_impulse(&self, _: BodyId) -> Wrench {
        Wrench::default()
    }
    fn set_twist(&mut self, b: BodyId, t: Twist) {
        self.twist[b.0] = t;
    }
    fn stable_dt(&self) -> f64 {
        f64::INFINITY
    }
}
struct Log(f64);
impl<F: Forcing> Observer<Simulation<2, Particles<F, Discs>>> for Log {
    fn snapshot(
        &mut self,
        s: &mut Simulation<2, Particles<F, Discs>>,
        _: usize,
        i: &StepInfo,
    ) -> Result<(), CouplingError> {
        let p = &s.particles;
        if self.0 > 0.0
            && (i.time / self.0).fract().abs() > 1e-6
            && (1.0 - (i.time / self.0).fract()).abs() > 1e-6
        {
            return Ok(());
        }
        let v: Vec<String> = (0..p.bodies.n_bodies())
            .map(|b| format!("{:.5e}", -p.bodies.twist(BodyId(b)).linear.y))
            .collect();
        let tr: Vec<String> = (0..p.bodies.n_bodies())
            .map(|b| format!("{:.1e}", p.momentum_in_transit(BodyId(b)).force.y))
            .collect();
        println!(
            "t {:.4} step {} dt {:.2e} C {:.3} v {v:?} slip {:.2e} transit {tr:?}",
            i.time,
            i.step,
            i.dt,
            i.courant,
            p.forcing.slip(s.flow.velocity(), &p.bodies)
        );
        Ok(())
    }
}
fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(|| go().unwrap())
}
fn go() -> Result<(), Box<dyn std::error::Error>> {
    let a: Vec<String> = std::env::args().collect();
    let get = |k: &str, d: f64| a.iter().position(|x| x == k).map_or(d, |i| a[i + 1].parse().unwrap());
    let n = get("n", 15.0) as usize;
    let d = 1e-3;
    let (l, hh) = (10.0 * d, 20.0 * d);
    let grid = CartesianGrid::new([10 * n, 20 * n], [l, hh])?;
    let flow = Projection::new(grid, [[Side::Periodic; 2]; 2], Fluid { density: 1000.0, viscosity: 1e-6 })?;
    let nb = get("bodies", 2.0) as usize;
    let rho = [1060.0, 1030.0][..nb].to_vec();
    let off = get("off", 0.0) * d / n as f64;
    let pos = [[5.0 * d + off, 16.0 * d + 0.7 * off, 0.0], [5.05 * d + off, 13.5 * d + 0.7 * off, 0.0]];
    let bodies = Discs {
        disc: Disc(d / 2.0),
        pose: (0..nb).map(|i| Pose::at(pos[i])).collect(),
        twist: vec![Twist::default(); nb],
        load: vec![Load::default(); nb],
        rho,
        moves: 0,
    };
    let end = get("end", 0.03);
    let dt = get("dt", 0.0);
    let s = Schedule {
        end,
        intervals: (end / get("every", 0.005)).round() as usize,
        dt: (dt > 0.0).then_some(dt),
        courant: get("cfl", 0.3),
        ramp: [get("r0", 0.05), get("r1", 1.15)],
    };
    let stop = Default::default();
    let g = Vector::new(0.0, -9.81, 0.0);
    let t = std::time::Instant::now();
    if get("hfdib", 0.0) > 0.0 {
        let p = Particles::new(bodies, Hfdib::new(1000.0).with_rounds(get("hfdib", 3.0) as usize), 1000.0, g)
            .with_virtual_mass(get("vm", 0.0));
        let mut sim = Simulation::new(flow, p, WeightBalance::NetWeight)?;
        let mut ledger = Ledger::new();
        println!("{:?}", run(&mut sim, &s, &mut (&mut ledger, Log(get("log", 0.0))), &stop)?);
        println!("{:?}", ledger.report());
    } else {
        let k = if get("quintic", 0.0) > 0.0 { Kernel::QuinticSpline } else { Kernel::Yang };
        let p = Particles::new(
            bodies,
            SmoothForcing::new(1000.0).with_kernel(k).with_passes(get("passes", 3.0) as usize),
            1000.0,
            g,
        )
        .with_virtual_mass(get("vm", 0.0));
        let mut sim = Simulation::new(flow, p, WeightBalance::NetWeight)?;
        let mut ledger = Ledger::new();
        println!("{:?}", run(&mut sim, &s, &mut (&mut ledger, Log(get("log", 0.0))), &stop)?);
        println!("{:?}", ledger.report());
        println!("{:?}", sim.timings());
    }
    println!("{:?}", t.elapsed());
    Ok(())
}

//! What two that overlap do to one another.
use super::body::{Body, Constants};
use super::contacts::{Patch, Record, View};
use super::meeting::{Meeting, Other};
use super::pair_index;
use crate::contact::{ContactLaw, Pivot, Push, Touch};
use crate::overlap::closed::Lens;
use crate::{DemError, Overlap, OverlapSolver};
use interfaces::{Vector, Wrench};

/// Contacts count as no nearer to a body's centre than this part of its inner radius, or L_c would vanish there.
const SHORTEST_ARM: f64 = 0.05;

/// The larger one of two numbers, the second one if the first is none: one instruction, where `f64::max` takes five.
#[inline(always)]
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

impl<L: ContactLaw> View<'_, L> {
    /// Forces of a ball and a ball or wall; answers their stiffness over mass, and what both feel.
    ///
    /// All lies along the normal n: the velocity at the contact is U_a − U_b + n × (l_a Ω_a + l_b Ω_b), the torques are −l n × F.
    #[inline(always)]
    pub(super) fn push_balls(
        &self,
        meeting: &Meeting<'_>,
        lens: &Lens,
        record: &mut Record<'_, L::Memory>,
        dt: f64,
    ) -> Result<(f64, [Wrench; 2]), DemError> {
        let before = record.before.first().filter(|p| p.near == record.near);
        if meeting.is_through(&lens.overlap, before) {
            return Err(self.passed_through(meeting.pair, lens.overlap.volume));
        }
        let Lens { overlap, area, arms } = lens;
        let (a, area, normal) = (meeting.a, *area, overlap.normal);
        let turning = a.twist.angular * arms[0];
        let (velocity, spin, radius_b, inverse_b, material_b) = match meeting.other {
            Other::Body(b, _) => {
                let velocity =
                    a.twist.linear - b.twist.linear + normal.cross(&(turning + b.twist.angular * arms[1]));
                (velocity, a.twist.angular - b.twist.angular, b.radius, b.inverse_mass, b.material)
            }
            Other::Wall(w) => {
                let velocity = a.twist.linear + normal.cross(&turning);
                (velocity, a.twist.angular, f64::INFINITY, 0.0, w.material)
            }
        };
        let inverse = a.inverse_mass + inverse_b;
        let velocity = match self.surfaces {
            Some(surfaces) => velocity + surfaces.slip(meeting, overlap.centroid, normal, self.time),
            None => velocity,
        };
        let touch = Touch {
            overlap,
            area,
            volume: overlap.volume,
            rate: -area * normal.dot(&velocity),
            velocity,
            spin,
            inverse_masses: meeting.inverse_masses(inverse_b),
            arms: [larger(arms[0], SHORTEST_ARM * a.radius), larger(arms[1], SHORTEST_ARM * radius_b)],
            sizes: [a.radius, radius_b],
            mobility: if L::MOBILITY { area * area * inverse } else { f64::NAN },
            pivot: None,
            face: 0.0,
            plane: false,
            dt,
            since: 0.5 * (self.last_step + dt),
        };
        let (push, memory) = self.answer(&touch, [a.material, material_b], before);
        let torque = normal.cross(&push.force);
        let on_a = Wrench { force: push.force, torque: push.couple - torque * arms[0] };
        let on_b = match meeting.other {
            Other::Body(..) => Wrench { force: -push.force, torque: -push.couple - torque * arms[1] },
            Other::Wall(_) => Wrench::default(),
        };
        record.add(overlap, area, &push, memory);
        Ok((push.stiffness, [on_a, on_b]))
    }

    /// Forces of any two, by patches; answers their largest stiffness over mass.
    #[inline(never)]
    pub(super) fn push(
        &self,
        meeting: &Meeting<'_>,
        record: &mut Record<'_, L::Memory>,
        solver: &mut OverlapSolver,
        dt: f64,
    ) -> Result<f64, DemError> {
        let same = record.before.iter().take_while(|p| p.near == record.near).count();
        let before = &record.before[..same];
        if meeting.is_round() {
            let Some(overlap) = meeting.lens() else { return Ok(0.0) };
            // One patch, then as now.
            return self.push_one(meeting, &overlap, overlap.volume, before.first(), record, dt);
        }
        solver.set_pivots(L::PIVOTS);
        let shared = meeting.solve(solver)?;
        let volume = shared.iter().map(|o| o.volume).sum();
        let mut stiffest = 0.0;
        for overlap in shared {
            let before = remembered(before, shared, overlap);
            stiffest = larger(self.push_one(meeting, overlap, volume, before, record, dt)?, stiffest);
        }
        Ok(stiffest)
    }

    /// Forces of one patch; returns its stiffness over mass.
    #[inline(always)]
    fn push_one(
        &self,
        meeting: &Meeting<'_>,
        overlap: &Overlap,
        volume: f64,
        before: Option<&Patch<L::Memory>>,
        record: &mut Record<'_, L::Memory>,
        dt: f64,
    ) -> Result<f64, DemError> {
        if meeting.is_through(overlap, before) {
            return Err(self.passed_through(meeting.pair, overlap.volume));
        }
        let area = overlap.area();
        let (push, memory) = self.push_patch(meeting, overlap, [area, volume], before, dt);
        record.add(overlap, area, &push, memory);
        Ok(push.stiffness)
    }

    /// What a patch does to the first of a pair (its stiffness over mass \[1/s²\]), and what the law keeps of it.
    #[inline(always)]
    fn push_patch(
        &self,
        meeting: &Meeting<'_>,
        overlap: &Overlap,
        [area, volume]: [f64; 2],
        before: Option<&Patch<L::Memory>>,
        dt: f64,
    ) -> (Push, L::Memory) {
        let (a, first) = (meeting.a, meeting.constants());
        let arm_a = overlap.centroid - a.pose.position;
        let length = |arm: &Vector, constants: &Constants| arm.norm().max(SHORTEST_ARM * constants.inner);
        let mobility = |body: &Body, constants: &Constants, arm: &Vector| {
            let j = arm.cross(&overlap.gradient) + overlap.moment;
            constants.turning.mobility(&body.pose.orientation, &j)
        };
        let mut touch = Touch {
            overlap,
            area,
            volume,
            rate: 0.0,
            velocity: a.twist.at(arm_a),
            spin: a.twist.angular,
            inverse_masses: [0.0; 2],
            arms: [length(&arm_a, first), f64::INFINITY],
            sizes: [first.size, f64::INFINITY],
            mobility: f64::NAN,
            pivot: None,
            face: first.face,
            plane: a.is_plane(),
            dt,
            since: 0.5 * (self.last_step + dt),
        };
        let (mut inverse_b, mut turns) = (0.0, if L::MOBILITY { mobility(a, first, &arm_a) } else { 0.0 });
        let material = match meeting.other {
            Other::Body(b, at_b) => {
                let (second, arm) = (meeting.others(), overlap.centroid - at_b);
                touch.velocity -= b.twist.at(arm);
                touch.spin -= b.twist.angular;
                touch.arms[1] = length(&arm, second);
                touch.sizes[1] = second.size;
                touch.face = first.face.min(second.face);
                inverse_b = b.inverse_mass;
                if L::MOBILITY {
                    turns += mobility(b, second, &arm);
                }
                b.material
            }
            Other::Wall(w) => w.material,
        };
        touch.rate = overlap.rate(touch.velocity, touch.spin);
        if let Some(surfaces) = self.surfaces {
            let (point, normal) = (overlap.centroid, overlap.normal);
            touch.velocity += surfaces.slip(meeting, point, normal, self.time);
            let radius = if L::PIVOTS { (overlap.pivot.trace() / area).sqrt() } else { 0.0 };
            if radius > 0.0 {
                touch.spin += surfaces.spin(meeting, (point, normal, radius), self.time);
            }
        }
        touch.inverse_masses = meeting.inverse_masses(inverse_b);
        if L::MOBILITY {
            touch.mobility = area * area * (a.inverse_mass + inverse_b) + turns;
        }
        if L::PIVOTS && !meeting.is_round() {
            touch.pivot = Some(pivot(meeting, overlap, touch.spin));
        }
        self.answer(&touch, [a.material, material], before)
    }

    /// What the law answers.
    #[inline(always)]
    fn answer(
        &self,
        touch: &Touch<'_>,
        materials: [u32; 2],
        before: Option<&Patch<L::Memory>>,
    ) -> (Push, L::Memory) {
        let mut memory = before.map_or_else(L::Memory::default, |p| p.memory);
        let [a, b] = materials;
        let mut push = self.law.push(&self.properties[pair_index(a, b)], touch, &mut memory);
        push.stiffness *= if L::MOBILITY && touch.area > 0.0 {
            touch.mobility / (touch.area * touch.area)
        } else {
            touch.inverse_masses[0] + touch.inverse_masses[1]
        };
        (push, memory)
    }
}

/// Spin of a pair about a patch.
fn pivot(meeting: &Meeting<'_>, overlap: &Overlap, spin: Vector) -> Pivot {
    let moment = overlap.pivot * spin;
    let square = spin.dot(&moment);
    if square <= 0.0 || square.is_nan() {
        return Pivot::default();
    }
    let turns =
        |body: &Body, constants: &Constants| constants.turning.mobility(&body.pose.orientation, &moment);
    let mut mobility = turns(meeting.a, meeting.constants());
    if let Other::Body(b, _) = meeting.other {
        mobility += turns(b, meeting.others());
    }
    Pivot { moment, square, mobility: mobility / square }
}

/// The patch before that a patch goes on from: the pair's nearest one, unless another patch is nearer to it.
#[inline]
fn remembered<'a, M>(before: &'a [Patch<M>], now: &[Overlap], patch: &Overlap) -> Option<&'a Patch<M>> {
    match (before, now) {
        ([], _) => None,
        ([only], [_]) => Some(only),
        _ => {
            let away = |p: &Patch<M>, o: &Overlap| (p.point - o.centroid).norm_squared();
            before
                .iter()
                .min_by(|p, q| away(p, patch).total_cmp(&away(q, patch)))
                .filter(|p| now.iter().all(|o| std::ptr::eq(o, patch) || away(p, o) > away(p, patch)))
        }
    }
}

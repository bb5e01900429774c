//! A tree of oriented boxes.
use super::oriented_box::OrientedBox;
use interfaces::Vector;
use std::ops::Range;

/// Binary tree of oriented boxes around items that are given by their corners. Boxes of long and
/// narrow items stay narrow, however the items are turned.
#[derive(Clone, Debug)]
pub(crate) struct BoxTree {
    /// The root is the last one.
    nodes: Vec<Node>,
}

#[derive(Clone, Debug)]
struct Node {
    around: OrientedBox,
    below: Below,
    /// Whether all items below are of one group.
    is_group: bool,
}

#[derive(Clone, Copy, Debug)]
enum Below {
    Item(u32),
    Halves([u32; 2]),
}

/// Items of one group, by their positions in a list sorted by groups.
struct Group {
    items: Range<usize>,
    centre: Vector,
}

impl BoxTree {
    /// Items with these corners; those of one group are below a node of their own.
    pub(crate) fn new<const K: usize>(corners: &[[Vector; K]], group: impl Fn(u32) -> u32) -> Self {
        let mut items: Vec<u32> = (0..corners.len() as u32).collect();
        items.sort_by_key(|i| group(*i));
        let centre = |i: &u32| corners[*i as usize].iter().sum::<Vector>() / K as f64;
        let mut groups = Vec::new();
        let mut first = 0;
        for own in items.chunk_by(|i, j| group(*i) == group(*j)) {
            let centre = own.iter().map(centre).sum::<Vector>() / own.len() as f64;
            groups.push(Group { items: first..first + own.len(), centre });
            first += own.len();
        }
        let mut builder = Builder { corners, nodes: Vec::with_capacity(2 * items.len()) };
        if !groups.is_empty() {
            builder.add_groups(&mut groups, &mut items);
        }
        Self { nodes: builder.nodes }
    }

    /// Calls `visit` with every pair of items of different groups whose boxes meet, until it
    /// returns false.
    pub(crate) fn visit_pairs(&self, visit: &mut impl FnMut(u32, u32) -> bool) {
        if let Some(root) = self.nodes.last() {
            self.visit_within(root, visit);
        }
    }
    fn visit_within(&self, node: &Node, visit: &mut impl FnMut(u32, u32) -> bool) -> bool {
        match node.below {
            Below::Halves(halves) if !node.is_group => {
                let [left, right] = halves.map(|n| &self.nodes[n as usize]);
                self.visit_within(left, visit)
                    && self.visit_within(right, visit)
                    && self.visit_between([left, right], visit)
            }
            _ => true,
        }
    }
    fn visit_between(&self, [left, right]: [&Node; 2], visit: &mut impl FnMut(u32, u32) -> bool) -> bool {
        if left.around.is_apart(&right.around) {
            return true;
        }
        // The larger one is opened.
        let opens_left = left.around.size() >= right.around.size();
        match (left.below, right.below) {
            (Below::Item(i), Below::Item(j)) => visit(i, j),
            (Below::Halves(halves), other) if opens_left || matches!(other, Below::Item(_)) => {
                halves.iter().all(|n| self.visit_between([&self.nodes[*n as usize], right], visit))
            }
            (_, Below::Halves(halves)) => {
                halves.iter().all(|n| self.visit_between([left, &self.nodes[*n as usize]], visit))
            }
            _ => true,
        }
    }

    /// Calls `visit` with every item whose box a ray along a unit vector meets.
    pub(crate) fn visit_ahead(&self, from: Vector, along: Vector, mut visit: impl FnMut(u32)) {
        let none = |item| {
            visit(item);
            None
        };
        self.first_ahead(from, along, f64::INFINITY, |_| true, none);
    }

    /// For every node the sum, by `join`, of what its items have.
    pub(crate) fn sums<T: Copy>(&self, own: impl Fn(u32) -> T, join: impl Fn(T, T) -> T) -> Vec<T> {
        let mut sums: Vec<T> = Vec::with_capacity(self.nodes.len());
        // Halves come before the whole.
        for node in &self.nodes {
            sums.push(match node.below {
                Below::Item(item) => own(item),
                Below::Halves([left, right]) => join(sums[left as usize], sums[right as usize]),
            });
        }
        sums
    }

    /// The item of the least `value` below `most` among those whose boxes a ray along a unit vector
    /// meets. Boxes that begin farther along the ray than the least value so far, and nodes that
    /// `may_hold` denies, are left out.
    pub(crate) fn first_ahead(
        &self,
        from: Vector,
        along: Vector,
        most: f64,
        may_hold: impl Fn(usize) -> bool,
        mut value: impl FnMut(u32) -> Option<f64>,
    ) -> Option<(u32, f64)> {
        let ahead = |n: u32| {
            let around = may_hold(n as usize).then(|| &self.nodes[n as usize].around)?;
            Some((n, around.ahead(from, along)?))
        };
        let (mut most, mut best) = (most, None);
        let mut waiting: Vec<(u32, f64)> =
            self.nodes.len().checked_sub(1).and_then(|root| ahead(root as u32)).into_iter().collect();
        while let Some((n, least)) = waiting.pop() {
            if least >= most {
                continue;
            }
            match self.nodes[n as usize].below {
                Below::Item(item) => {
                    if let Some(value) = value(item).filter(|value| *value < most) {
                        (most, best) = (value, Some((item, value)));
                    }
                }
                Below::Halves(halves) => {
                    let mut halves = halves.map(ahead);
                    // The nearer one is next.
                    if let [Some((_, first)), Some((_, second))] = halves
                        && first < second
                    {
                        halves.swap(0, 1);
                    }
                    waiting.extend(halves.into_iter().flatten());
                }
            }
        }
        best
    }
}

struct Builder<'a, const K: usize> {
    corners: &'a [[Vector; K]],
    nodes: Vec<Node>,
}

impl<const K: usize> Builder<'_, K> {
    fn add(&mut self, items: impl Iterator<Item = u32> + Clone, below: Below, is_group: bool) -> u32 {
        let around = OrientedBox::around(items.flat_map(|i| self.corners[i as usize]));
        self.nodes.push(Node { around, below, is_group });
        self.nodes.len() as u32 - 1
    }

    /// Adds a node around these groups, and all below it.
    fn add_groups(&mut self, groups: &mut [Group], items: &mut [u32]) -> u32 {
        if let [only] = groups {
            let node = self.add_items(&mut items[only.items.clone()]);
            self.nodes[node as usize].is_group = true;
            return node;
        }
        let [left, right] = halved(groups, |g| g.centre);
        let halves = [self.add_groups(left, items), self.add_groups(right, items)];
        let own = groups.iter().flat_map(|g| items[g.items.clone()].iter().copied());
        self.add(own, Below::Halves(halves), false)
    }

    /// Adds a node around items of one group, and all below it.
    fn add_items(&mut self, items: &mut [u32]) -> u32 {
        if let [only] = items {
            return self.add(std::iter::once(*only), Below::Item(*only), false);
        }
        let corners = self.corners;
        let [left, right] = halved(items, |i| corners[*i as usize].iter().sum());
        let halves = [self.add_items(left), self.add_items(right)];
        self.add(items.iter().copied(), Below::Halves(halves), false)
    }
}

/// Parts a list in the middle of that axis on which its places are spread most.
fn halved<T>(all: &mut [T], place: impl Fn(&T) -> Vector) -> [&mut [T]; 2] {
    let start = (Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY));
    let (low, high) = all.iter().map(&place).fold(start, |(low, high), c| (low.inf(&c), high.sup(&c)));
    let axis = (high - low).imax();
    let middle = all.len() / 2;
    all.select_nth_unstable_by(middle, |a, b| place(a)[axis].total_cmp(&place(b)[axis]));
    let (left, right) = all.split_at_mut(middle);
    [left, right]
}

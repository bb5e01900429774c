//! Surfaces with faults, parts of all kinds, units and distances.
use super::{Case, unit};
use crate::solids::*;
use crate::writers::binary;

pub(super) fn all() -> Vec<Case> {
    [surfaces(), flat(), parts(), lengths()].into_iter().flatten().collect()
}

fn surfaces() -> Vec<Case> {
    let mut flipped = unit();
    flipped[7].swap(0, 1);
    let mut half = can(32);
    half.iter_mut().step_by(3).for_each(|f| f.swap(0, 1));
    let twice = joined([unit(), unit()]);
    let both = joined([unit(), inverted(unit())]);
    let with_copy = |turned: bool| {
        let copy = unit()[3];
        joined([unit(), if turned { inverted(vec![copy]) } else { vec![copy] }])
    };
    let without = |n: usize| unit()[n..].to_vec();
    // A wall of one sheet through a box whose sides have vertices where it ends.
    let halves = [block([0.0; 3], [0.5, 1.0, 1.0]), block([0.5, 0.0, 0.0], [1.0; 3])];
    let walled = joined([
        halves[0].clone(),
        halves[1].iter().filter(|f| f.iter().any(|c| c[0] != 0.5)).copied().collect(),
    ]);
    let fin = joined([unit(), vec![[[0.0; 3], [1.0, 0.0, 0.0], [0.5, -1.0, 0.0]]]]);
    vec![
        Case::facets("can of 64 sides, ends as fans", can(64)).of(area(&ring(64, 1.0))),
        Case::facets("can of 200 sides", can(200)).of(area(&ring(200, 1.0))),
        Case::facets("all facets inward", inverted(unit())).flipped(1.0, "1 shells"),
        Case::facets("one facet turned", flipped).mended("not consistently oriented", 1.0, "1 turned"),
        Case::facets("every third facet turned", half).mended(
            "not consistently oriented",
            area(&ring(32, 1.0)),
            "43 turned",
        ),
        Case::facets("one facet twice", with_copy(false)).mended("more than two faces", 1.0, "1 copies"),
        Case::facets("one facet twice, one of them turned", with_copy(true)).mended(
            "more than two faces",
            1.0,
            "1 copies",
        ),
        Case::facets("all facets twice", twice).mended("more than two faces", 1.0, "12 copies"),
        Case::facets("all facets from both sides", both).mended("more than two faces", 1.0, "12 copies"),
        Case::facets("two boxes with a wall between them", joined(halves)).mended(
            "more than two faces",
            1.0,
            "4 copies",
        ),
        Case::facets("box with a wall of one sheet", walled)
            .refused("more than two faces", "more than two faces"),
        Case::facets("a facet on an edge", fin).refused("more than two faces", "more than two faces"),
        Case::facets("a facet missing", without(1)).refused("not closed: 3 edges", "not closed: 3 edges"),
        Case::facets("a side missing", without(2)).refused("not closed: 4 edges", "not closed: 4 edges"),
        Case::facets("one facet", unit()[..1].to_vec()).refused("not closed", "not closed"),
        Case::facets(
            "a sheet from both sides",
            joined([unit()[..2].to_vec(), inverted(unit()[..2].to_vec())]),
        )
        .refused("more than two faces", "no faces"),
        Case::facets("Möbius strip", band(40, 1)).refused("not closed", "not closed"),
        Case::facets("ring of a strip", band(40, 0)).refused("not closed", "not closed"),
    ]
}

fn flat() -> Vec<Case> {
    let [o, a, b, c] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let on = |x: f64| [x, 0.0, 0.0];
    // Face oba keeps its edge oa, face oac is divided at the vertices on it.
    let divided = |at: &[f64]| {
        let mut facets = vec![[o, b, a], [o, c, b], [a, b, c]];
        let ends: Vec<[f64; 3]> = [&[0.0], at, &[1.0]].concat().into_iter().map(on).collect();
        facets.extend(ends.windows(2).map(|pair| [pair[0], pair[1], c]));
        facets
    };
    let filled = |at: &[f64]| {
        let mut facets = divided(at);
        let ends: Vec<[f64; 3]> = [at, &[1.0]].concat().into_iter().map(on).collect();
        // Between o and each vertex on the edge and the next.
        facets.extend(ends.windows(2).map(|pair| [o, pair[1], pair[0]]));
        facets
    };
    let other_way = |at: &[f64]| {
        let mut facets = divided(at);
        let ends: Vec<[f64; 3]> = [&[0.0], at].concat().into_iter().map(on).collect();
        facets.extend(ends.windows(2).map(|pair| [a, pair[1], pair[0]]));
        facets
    };
    let tent = 1.0 / 6.0;
    let eighths: Vec<f64> = (1..8).map(|i| f64::from(i) / 8.0).collect();
    // A vertex next to another: facets without width, but none without length.
    let next = [f64::EPSILON, 0.0, 0.0];
    let needle = vec![[o, b, a], [next, a, c], [o, c, b], [a, b, c], [o, next, c], [o, a, next]];
    let loose = joined([tetrahedron(), vec![[o, on(0.5), a]]]);
    vec![
        Case::facets("facet without area on an edge", filled(&[0.5])).flipped(tent, "1 flat"),
        Case::facets("7 facets without area on an edge", filled(&eighths)).flipped(tent, "7 flat"),
        Case::facets("7 facets without area, from the other end", other_way(&eighths))
            .flipped(tent, "7 flat"),
        Case::facets("facet without area, all inward", inverted(filled(&[0.25])))
            .flipped(tent, "1 flat, 1 shells"),
        Case::facets("vertex in the middle of an edge", divided(&[0.5])).mended(
            "not closed: 3 edges",
            tent,
            "1 stitched",
        ),
        Case::facets("7 vertices on an edge", divided(&eighths)).mended(
            "not closed: 9 edges",
            tent,
            "7 stitched",
        ),
        Case::facets("facets of no width at a double vertex", needle).mended(
            "no area",
            tent,
            "1 joined, 2 collapsed",
        ),
        Case::facets("loose facet without area", loose).mended("no area", tent, "1 flat"),
    ]
}

fn parts() -> Vec<Case> {
    let within = |low: f64| cube([low; 3], 1.0 - 2.0 * low);
    let (cavity, island) = (0.5_f64.powi(3), 0.25_f64.powi(3));
    let rod = |axis: usize, width: f64| {
        block(
            [0, 1, 2].map(|a| if a == axis { -2.0 } else { -width }),
            [0, 1, 2].map(|a| if a == axis { 2.0 } else { width }),
        )
    };
    let turned = |facets: Vec<Facet>| {
        let (s, c) = 0.5_f64.sin_cos();
        moved(facets, |[x, y, z]| [c * x - s * y, s * x + c * y, z])
    };
    // A prism over two lobes, one of which is inside out.
    let bow = prism(&[[0.0, 0.0], [3.0, 1.0], [3.0, 0.0], [0.0, 3.0]], &[[0, 1, 2], [0, 2, 3]]);
    vec![
        Case::facets("two boxes apart", joined([unit(), cube([2.0; 3], 1.0)])).of(2.0),
        Case::facets("box with a cavity", joined([unit(), inverted(within(0.25))])).of(1.0 - cavity),
        Case::facets("box with a cavity turned outward", joined([unit(), within(0.25)])).mended(
            "look the wrong way",
            1.0 - cavity,
            "1 shells",
        ),
        Case::facets("box in a cavity in a box, all outward", joined([unit(), within(0.25), within(0.375)]))
            .mended("look the wrong way", 1.0 - cavity + island, "1 shells"),
        Case::facets("two boxes apart, one inward", joined([unit(), inverted(cube([2.0; 3], 1.0))]))
            .mended("enclose", 2.0, "1 shells"),
        Case::facets("two boxes that cross", joined([unit(), cube([0.5; 3], 1.0)])).mended(
            "cross",
            2.0 - cavity,
            "18 united",
        ),
        Case::facets("two boxes that cross, one inward", joined([unit(), inverted(cube([0.5; 3], 1.0))]))
            .mended("enclose", 2.0 - cavity, "1 shells, 18 united"),
        Case::facets(
            "two boxes that cross, sides in one plane",
            joined([unit(), cube([0.5, 0.0, 0.0], 1.0)]),
        )
        .mended("cross", 1.5, "united"),
        Case::facets(
            "two boxes with an edge in common that overlap",
            joined([unit(), block([0.0; 3], [2.0, 1.0, 0.5])]),
        )
        .mended("more than two faces", 1.5, "united"),
        Case::facets(
            "box in a box, sides in one plane",
            joined([unit(), block([0.25, 0.25, 0.0], [0.75; 3])]),
        )
        .mended("cross", 1.0, "united"),
        Case::facets(
            "two boxes, one on the other, divided differently",
            joined([unit(), other_diagonals([0.0, 0.0, 1.0], [1.0, 1.0, 2.0])]),
        )
        .mended("more than two faces", 2.0, "united"),
        Case::facets(
            "small box on a large one",
            joined([unit(), block([0.25, 0.25, 1.0], [0.75, 0.75, 1.5])]),
        )
        .mended("touch", 1.125, "united"),
        Case::facets("three rods that cross", joined([rod(0, 0.5), rod(1, 0.5), rod(2, 0.5)]))
            .mended("cross", 10.0, "united"),
        Case::facets(
            "three rods that cross, turned",
            turned(joined([rod(0, 0.5), rod(1, 0.375), rod(2, 0.25)])),
        )
        .mended("cross", 6.4375, "united"),
        Case::facets("facets that cross within one part", bow).mended("cross", 3.375, "united"),
        Case::facets("two boxes that touch in a vertex", joined([unit(), cube([1.0; 3], 1.0)]))
            .refused("touches itself", "near (1.000000e0, 1.000000e0, 1.000000e0) m"),
        Case::facets("two boxes that touch along an edge", joined([unit(), cube([1.0, 1.0, 0.0], 1.0)]))
            .refused("more than two faces", "near (1.000000e0, 1.000000e0, "),
        Case::facets(
            "vertex of a box on a side of another",
            joined([unit(), moved(tetrahedron(), |[x, y, z]| [0.5 - x, 0.5 - y, 1.0 + x + y + z])]),
        )
        .refused("touch", "touch"),
    ]
}

fn lengths() -> Vec<Case> {
    let far = |d: f64| moved(can(24), |[x, y, z]| [x + d, y - d, z + 2.0 * d]);
    let loose = |by: f64| {
        let noise = |i: usize| by * (i as f64 * 12.9898).sin();
        let mut facets = can(24);
        facets.as_flattened_mut().as_flattened_mut().iter_mut().enumerate().for_each(|(i, x)| *x += noise(i));
        facets
    };
    let volume = area(&ring(24, 1.0));
    vec![
        Case::stl("millimetres", binary(&moved(unit(), |p| p.map(|x| 20.0 * x)), "mm"))
            .in_units_of(1e-3)
            .of(8e-6),
        Case::stl("inches", binary(&unit(), "in")).in_units_of(0.0254).of(0.0254_f64.powi(3)),
        Case::stl("unit of no length", binary(&unit(), ""))
            .in_units_of(0.0)
            .unread("the unit of length is 0 m"),
        Case::stl("single precision, far from the origin", binary(&far(1000.0), "")).of(volume).within(1e-4),
        Case::facets("corners apart by round-off of single precision", loose(3e-8)).within(1e-7).mended(
            "not closed",
            volume,
            "238 joined",
        ),
        Case::facets("corners apart by 1e-5", loose(1e-5)).refused("not closed", "not closed"),
        Case::facets("corners apart by 1e-5, welded", loose(1e-5)).within(1e-4).welded(1e-4).mended(
            "not closed",
            volume,
            "238 joined",
        ),
        Case::facets("welded by more than the body", unit()).welded(5.0).refused_repaired("no faces"),
        Case::facets("welded by a negative length", unit())
            .welded(-1.0)
            .refused_repaired("the welding tolerance is -1 m"),
        Case::facets("plate of 1e-6", block([0.0; 3], [1.0, 1.0, 1e-6])).of(1e-6),
        Case::facets("body of 1e-9", cube([0.0; 3], 1e-9)).of(1e-27),
    ]
}

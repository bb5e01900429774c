//! Text, bytes and polygons as programs write them.
use super::{Case, unit};
use crate::solids::*;
use crate::writers::{binary, obj, prism_sides, text, utf16};

pub(super) fn all() -> Vec<Case> {
    [stl_texts(), stl_bytes(), obj_texts(), polygons()].into_iter().flatten().collect()
}

fn obj_prism(corners: &[[f64; 2]]) -> Vec<u8> {
    obj(&prism_sides(corners))
}

fn stl_texts() -> Vec<Case> {
    let plain = text(&unit(), " normal 0 0 1");
    let two = text(&unit()[..5], " normal 0 0 1") + &text(&unit()[5..], " normal 0 0 1");
    let replaced = |from: &str, to: &str| plain.replace(from, to);
    let at_vertex = |number: &str| plain.replacen("vertex 0e0", &format!("vertex {number}"), 1);
    vec![
        Case::stl("STL, text", plain.clone()),
        Case::stl("STL, byte-order mark of UTF-8", format!("\u{feff}{plain}")),
        Case::stl("STL, UTF-16, low byte first", utf16(&plain, u16::to_le_bytes)),
        Case::stl("STL, UTF-16, high byte first", utf16(&plain, u16::to_be_bytes)),
        Case::stl("STL, lines end with CR", replaced("\n", "\r")),
        Case::stl("STL, lines end with CR LF", replaced("\n", "\r\n")),
        Case::stl("STL, capitals", plain.to_uppercase()),
        Case::stl("STL, no name", replaced(" part", "")),
        Case::stl("STL, name of several words, not ASCII", replaced(" part", " facet naïve № 3")),
        Case::stl("STL, several solids", two),
        Case::stl("STL, no end of line at the end", plain.trim_end()),
        Case::stl("STL, tabs and empty lines", replaced(" ", " \t").replace('\n', "\n\n")),
        Case::stl("STL, lines of comments", format!("# by hand\n{}", replaced("  facet", "# one\n  facet"))),
        Case::stl(
            "STL, normals `-nan(ind)`",
            replaced("normal 0 0 1", "normal -nan(ind) -nan(ind) -nan(ind)"),
        ),
        Case::stl("STL, normals `1.#QNAN`", replaced("normal 0 0 1", "normal 1.#QNAN -1.#IND 1.#QNAN")),
        Case::stl("STL, normals `1.#INF`", replaced("normal 0 0 1", "normal 1.#INF 0 0")),
        Case::stl("STL, `normal` without numbers", replaced(" 0 0 1", "")),
        Case::stl("STL, `facet` alone", replaced(" normal 0 0 1", "")),
        Case::stl("STL, corner `-nan(ind)`", at_vertex("-nan(ind)")).unread("\"-nan(ind)\" is no number"),
        Case::stl("STL, corner `nan`", at_vertex("nan")).unread("give finite coordinates"),
        Case::stl("STL, corner at 1e60", at_vertex("1e60")).unread("give finite coordinates"),
        Case::stl("STL, decimal commas", replaced("0e0", "0,0"))
            .unread("line 4 of the STL file: \"0,0\" is no number"),
        Case::stl("STL, cut off within a facet", &plain.as_bytes()[..700]).unread("the file ends before"),
        Case::stl("STL, empty", "").unread("no faces"),
        Case::stl("STL, no facets", "solid void\nendsolid void\n").unread("no faces"),
        Case::stl("OBJ named .stl", obj(&sides([0.0; 3], [1.0; 3]))).unread("instead of \"solid\""),
    ]
}

fn stl_bytes() -> Vec<Case> {
    let behind = |header: &str| [binary(&unit(), header), vec![7; 33]].concat();
    let mut coloured = binary(&unit(), "COLOR=\u{1}\u{2}\u{3}\u{4}");
    coloured[84..].chunks_exact_mut(50).for_each(|record| record[48..].fill(0xff));
    let mut counted = binary(&unit(), "part");
    counted[80..84].fill(0xff);
    let spaces = format!("solid{}", " ".repeat(75));
    vec![
        Case::stl("STL, binary", binary(&unit(), "part")),
        Case::stl("STL, binary, header `solid`", binary(&unit(), "solid part")),
        Case::stl("STL, binary, bytes behind", behind("part")),
        Case::stl("STL, binary, header `solid`, bytes behind", behind("solid part")),
        Case::stl("STL, binary, header `solid` and spaces, bytes behind", behind(&spaces)),
        Case::stl("STL, binary, colours", coloured),
        Case::stl("STL, binary, cut off", &binary(&unit(), "part")[..600])
            .unread("should have 12 triangles, that is 684 bytes, but has 600 bytes"),
        Case::stl("STL, binary, header `solid`, cut off", &binary(&unit(), "solid part")[..600])
            .unread("should have 12 triangles"),
        Case::stl("STL, binary, 4294967295 triangles promised", counted)
            .unread("should have 4294967295 triangles"),
    ]
}

fn obj_texts() -> Vec<Case> {
    let quads = obj(&sides([0.0; 3], [1.0; 3]));
    let plain = String::from_utf8(quads.clone()).unwrap();
    let lines = |change: &dyn Fn(&str) -> String| plain.lines().map(change).collect::<Vec<_>>().join("\n");
    let behind = |key: &'static str, words: &'static str| {
        lines(&move |line| if line.starts_with(key) { format!("{line}{words}") } else { line.into() })
    };
    let backward = lines(&|line| {
        let number = |word: &str| word.parse::<i32>().map_or(word.into(), |v| format!("{}", v - 9));
        if line.starts_with('f') {
            line.split(' ').map(number).collect::<Vec<_>>().join(" ")
        } else {
            line.into()
        }
    });
    let with_all = lines(&|line| {
        let number = |word: &str| word.parse::<u32>().map_or(word.into(), |v| format!("{v}/1/{v}"));
        if line.starts_with('f') {
            line.split(' ').map(number).collect::<Vec<_>>().join(" ")
        } else {
            line.into()
        }
    });
    let (vertices, faces): (Vec<&str>, Vec<&str>) = plain.lines().partition(|line| line.starts_with('v'));
    let with_face = |face: &str| format!("{plain}f {face}\n");
    vec![
        Case::obj("OBJ, quads", quads.clone()),
        Case::obj("OBJ, byte-order mark of UTF-8", format!("\u{feff}{plain}")),
        Case::obj("OBJ, UTF-16", utf16(&plain, u16::to_le_bytes)),
        Case::obj("OBJ, lines end with CR", plain.replace('\n', "\r")),
        Case::obj("OBJ, lines end with CR LF", plain.replace('\n', "\r\n")),
        Case::obj("OBJ, comments at line ends", behind("", " # of 6 sides \\")),
        Case::obj("OBJ, comments without a space", behind("", "#1")),
        Case::obj("OBJ, continued lines", plain.replace(' ', " \\\n ")),
        Case::obj("OBJ, continued lines, CR LF", plain.replace(' ', "\\\r\n")),
        Case::obj("OBJ, colours behind vertices", behind("v", " 0.5 0.5 1")),
        Case::obj("OBJ, weights behind vertices", behind("v", " 1.0")),
        Case::obj("OBJ, texture and normals", format!("vt 0 0\nvn 0 0 1\n{with_all}")),
        Case::obj(
            "OBJ, groups, materials, lines",
            format!("mtllib a.mtl\no part\ng all\nusemtl b\ns off\n{plain}l 1 2\n"),
        ),
        Case::obj("OBJ, vertices counted backward", backward),
        Case::obj("OBJ, faces before vertices", [faces, vertices].concat().join("\n")),
        Case::obj("OBJ, vertices of no face", format!("{plain}v 9 9 9\nv 8 9 9\n")),
        Case::obj("OBJ, vertex 0", with_face("0 1 2")).unread("there is no vertex 0"),
        Case::obj("OBJ, vertex 99 of 8", with_face("1 2 99")).unread("vertex 98, but there are 8"),
        Case::obj("OBJ, face of two vertices", with_face("1 2")).unread("a face of 2 vertices"),
        Case::obj("OBJ, vertex of two coordinates", format!("v 1 2\n{plain}")).unread("a number is missing"),
    ]
}

fn polygons() -> Vec<Case> {
    let ell = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    let from_entrant = [ell[4], ell[5], ell[0], ell[1], ell[2], ell[3]];
    let with_middles = [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 1.0], [0.5, 1.0], [0.0, 1.0], [0.0, 0.5]];
    let comb: Vec<[f64; 2]> = (0..20)
        .flat_map(|i| {
            [
                [f64::from(2 * i), 1.0],
                [f64::from(2 * i), 3.0],
                [f64::from(2 * i + 1), 3.0],
                [f64::from(2 * i + 1), 1.0],
            ]
        })
        .chain([[39.0, 0.0], [0.0, 0.0]])
        .rev()
        .collect();
    let star = ring(10, 0.35);
    // A square hole, joined to the outer square by an edge that is gone twice.
    let keyhole = [
        [0.0, 0.0],
        [3.0, 0.0],
        [3.0, 3.0],
        [0.0, 3.0],
        [0.0, 0.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [2.0, 2.0],
        [2.0, 1.0],
        [1.0, 1.0],
    ];
    let mut with_hole = prism_sides(&keyhole);
    // No sides along that edge.
    with_hole.drain(9..10);
    with_hole.drain(4..5);
    let repeated: Vec<Vec<[f64; 3]>> =
        tetrahedron().iter().map(|[a, b, c]| vec![*a, *b, *b, *c, *a]).collect();
    // Two triangles of areas 3.375 and −0.375.
    let bow = [[0.0, 0.0], [3.0, 1.0], [3.0, 0.0], [0.0, 3.0]];
    let mut tilted = sides([0.0; 3], [1.0; 3]);
    let skew = |[x, y, z]: [f64; 3]| [x, y, if [x, y, z] == [1.0; 3] { 1.5 } else { z }];
    tilted.iter_mut().flatten().for_each(|corner| *corner = skew(*corner));
    vec![
        Case::obj("OBJ, L-shaped sides", obj_prism(&ell)).of(3.0),
        Case::obj("OBJ, L-shaped sides, from another corner", obj_prism(&from_entrant)).of(3.0),
        Case::obj("OBJ, corners on straight edges", obj_prism(&with_middles)).of(1.0),
        Case::obj("OBJ, star-shaped sides", obj_prism(&star)).of(area(&star)),
        Case::obj("OBJ, comb of 20 teeth", obj_prism(&comb)).of(area(&comb)),
        Case::obj("OBJ, polygon of 200 corners", obj_prism(&ring(200, 1.0))).of(area(&ring(200, 1.0))),
        Case::obj("OBJ, quads with repeated corners", obj(&repeated)).of(1.0 / 6.0),
        // Each side is divided in one of two ways.
        Case::obj("OBJ, sides that are not plane", obj(&tilted)).of(1.0 + 0.5 / 3.0),
        Case::obj("OBJ, polygons with a hole, by an edge to it and back", obj(&with_hole)).of(8.0),
        Case::obj("OBJ, polygon that crosses itself", obj_prism(&bow)).mended("cross", 3.375, "united"),
    ]
}

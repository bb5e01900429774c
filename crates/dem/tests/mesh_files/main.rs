//! Files of bodies as programs write them: read, admitted, repaired or refused with the reason.
mod cases;
mod damaged;
mod limits;
mod solids;
mod unions;
mod writers;

use cases::{Case, Format};
use dem::{MeshError, RepairReport, TriangleMesh, TriangleSoup};

fn read(case: &Case) -> Result<TriangleSoup, MeshError> {
    match case.format {
        Format::Stl => TriangleSoup::from_stl_bytes(&case.bytes, case.unit),
        Format::Obj => TriangleSoup::from_obj_bytes(&case.bytes, case.unit),
    }
}

fn body(soup: TriangleSoup) -> Result<f64, MeshError> {
    TriangleMesh::try_from(soup).map(|mesh| mesh.volume())
}

/// Counts of a report, in words of the table.
fn changes(report: &RepairReport) -> String {
    let all = [
        (&report.welded, "joined"),
        (&report.collapsed, "collapsed"),
        (&report.duplicates, "copies"),
        (&report.stitched, "stitched"),
        (&report.turned, "turned"),
        (&report.flat, "flat"),
        (&report.turned_shells, "shells"),
        (&report.united, "united"),
    ];
    let done = all.into_iter().filter(|(changes, _)| changes.count > 0);
    done.map(|(changes, word)| format!("{} {word}", changes.count)).collect::<Vec<_>>().join(", ")
}

/// Each file becomes what the table says: a body of the volume that is known from its making, or an
/// error that names the reason.
#[test]
fn files_become_what_they_should() {
    let cases = cases::all();
    assert!(cases.len() >= 60);
    let mut wrong = Vec::new();
    for case in &cases {
        let same = |volume: f64, expected: f64| (volume / expected - 1.0).abs() < case.tolerance;
        let given = read(case).and_then(body);
        let repaired = read(case).and_then(|soup| soup.repaired(case.weld)).and_then(|(soup, report)| {
            assert_eq!(report.is_empty(), changes(&report).is_empty());
            Ok((body(soup)?, changes(&report)))
        });
        let as_given = match (&given, &case.given) {
            (Ok(volume), Ok(expected)) => same(*volume, *expected),
            (Err(error), Err(part)) => error.to_string().contains(part),
            _ => false,
        };
        let as_repaired = match (&repaired, &case.repaired) {
            (Ok((volume, did)), Ok((expected, part))) => {
                same(*volume, *expected) && did.contains(part) && did.is_empty() == part.is_empty()
            }
            (Err(error), Err(part)) => error.to_string().contains(part),
            _ => false,
        };
        if !as_given {
            wrong.push(format!("{}: {given:?} instead of {:?}", case.name, case.given));
        }
        if !as_repaired {
            wrong.push(format!("{}, repaired: {repaired:?} instead of {:?}", case.name, case.repaired));
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), cases.len(), wrong.join("\n"));
}

/// The rows of the table in docs/mesh_files.md.
fn table(cases: &[Case]) -> String {
    let volume = |v: f64| format!("{v:.4e} m³");
    // Pipes end a cell.
    let error = |part: &str| part.replace('|', "\\|");
    let row = |case: &Case| {
        let given = case.given.map_or_else(error, volume);
        let repaired = match case.repaired {
            Ok((v, "")) => volume(v),
            Ok((v, changes)) => format!("{}: {changes}", volume(v)),
            Err(part) => error(part),
        };
        let weld = case.weld.map(|t| format!(", weld = {t}")).unwrap_or_default();
        format!("| {}{weld} | {given} | {repaired} |\n", case.name)
    };
    cases.iter().map(row).collect()
}

/// The page of mesh files has this table, which `files_become_what_they_should` checks.
#[test]
fn the_table_of_files_is_that_of_the_page() {
    let page = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/mesh_files.md");
    let table = table(&cases::all());
    let text = std::fs::read_to_string(page).unwrap();
    assert!(text.contains(&table), "docs/mesh_files.md should have these rows:\n{table}");
}

//! Files: whole, cut off, changed.
use super::*;

fn example() -> Record {
    let inner = Record::new("inner").with("numbers", [1.0]);
    Record::new("example")
        .with("numbers", [0.1, -0.0, f64::MIN_POSITIVE])
        .with_word("word", "ω")
        .with_record("of", &inner)
}

#[test]
fn what_is_read_is_what_was_written() {
    let record = example();
    let back = Record::from_bytes(&record.to_bytes()).unwrap();
    assert_eq!(back, record);
    assert_eq!(back.kind(), "example");
    assert_eq!(back.word("word").unwrap(), "ω");
    assert_eq!(back.numbers("numbers").unwrap()[1].to_bits(), (-0.0_f64).to_bits());
    let inner = back.record("of").unwrap();
    assert!(inner.expect("inner").is_ok() && inner.number("numbers").unwrap() == 1.0);
    assert!(matches!(inner.expect("outer"), Err(RecordError::Kind { .. })));
    assert!(matches!(back.number("numbers"), Err(RecordError::Entry { .. })));
    assert!(matches!(back.counts("numbers"), Err(RecordError::Entry { .. })));
    assert!(matches!(back.numbers("none"), Err(RecordError::Missing { .. })));
    assert!(matches!(back.record("none"), Err(RecordError::Missing { .. })));
    assert!(matches!(back.numbers("word"), Err(RecordError::Entry { .. })));
}

#[test]
fn every_changed_or_missing_byte_is_noticed() {
    let bytes = example().to_bytes();
    for i in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[i] ^= 16;
        assert!(matches!(Record::from_bytes(&changed), Err(RecordError::Corrupt { .. })), "byte {i}");
        assert!(matches!(Record::from_bytes(&bytes[..i]), Err(RecordError::Corrupt { .. })), "the first {i}");
    }
    // A whole file of another version, or of nonsense with a checksum.
    for (at, with) in [(15, b'2'), (16, 0xff)] {
        let mut other = bytes[..bytes.len() - 8].to_vec();
        other[at] = with;
        other.extend(checksum(&other).to_le_bytes());
        assert!(matches!(Record::from_bytes(&other), Err(RecordError::Corrupt { .. })), "at {at}");
    }
}

#[test]
fn files_are_whole_or_an_error_with_their_name() {
    let folder = std::env::temp_dir().join(format!("record-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("model");
    example().save(&path).unwrap();
    assert_eq!(Record::load(&path).unwrap(), example());
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
    let error = Record::load(&folder.join("none")).unwrap_err();
    assert!(matches!(error, RecordError::Io { .. }) && error.to_string().contains("none"));
    std::fs::remove_dir_all(&folder).unwrap();
}

//! What a checkpoint saves, to be compared to the bit.
use siltflow::interfaces::Checkpoint;
use std::collections::HashMap;

pub(crate) type State = HashMap<String, Vec<f64>>;

pub(crate) fn saved(of: &impl Checkpoint) -> State {
    let mut state = State::new();
    of.save(&mut |name, values| drop(state.insert(name.into(), values.to_vec())));
    state
}

/// To the bit.
pub(crate) fn assert_same(a: &State, b: &State) {
    assert_eq!(a.len(), b.len());
    for (name, a) in a {
        let bits = |v: &[f64]| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert!(bits(a) == bits(&b[name]), "{name} differs");
    }
}

//! State in memory, from which a step is repeated.
use interfaces::{Checkpoint, RestartError};

/// The arrays of a [`Checkpoint`] in memory, which is used again for the next copy.
#[derive(Clone, Debug, Default)]
pub(crate) struct StateCopy {
    arrays: Vec<(String, Vec<f64>)>,
    /// Arrays of the last copy.
    len: usize,
}

impl StateCopy {
    /// Copies what `from` needs to take back its next step.
    pub(crate) fn take(&mut self, from: &mut (impl Checkpoint + ?Sized)) {
        self.len = 0;
        let Self { arrays, len } = self;
        from.save_start(&mut |name, values| {
            if arrays.len() == *len {
                arrays.push(Default::default());
            }
            let (kept, copy) = &mut arrays[*len];
            if kept != name {
                name.clone_into(kept);
            }
            copy.clear();
            copy.extend_from_slice(values);
            *len += 1;
        });
    }

    /// Takes `into` back to the state of the copy.
    ///
    /// # Errors
    /// [`RestartError`] if it is that of something else.
    pub(crate) fn give_back(&self, into: &mut (impl Checkpoint + ?Sized)) -> Result<(), RestartError> {
        let arrays = &self.arrays[..self.len];
        into.take_back(&|name| arrays.iter().find(|a| a.0 == name).map(|a| a.1.as_slice()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Lists(Vec<(&'static str, Vec<f64>)>);

    impl Checkpoint for Lists {
        fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
            self.0.iter().for_each(|(name, values)| sink(name, values));
        }
        fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
            for (name, values) in &mut self.0 {
                *values = source(name).ok_or_else(|| RestartError::Missing((*name).into()))?.to_vec();
            }
            Ok(())
        }
    }

    /// Lists may come and go and change their lengths from copy to copy.
    #[test]
    fn the_last_copy_is_given_back() {
        let mut copy = StateCopy::default();
        copy.take(&mut Lists(vec![("a", vec![1.0; 3]), ("b", vec![2.0]), ("c", vec![3.0; 2])]));
        copy.take(&mut Lists(vec![("b", vec![5.0; 4]), ("c", vec![])]));
        let mut lists = Lists(vec![("c", vec![9.0]), ("b", vec![])]);
        copy.give_back(&mut lists).unwrap();
        assert_eq!(lists.0, [("c", vec![]), ("b", vec![5.0; 4])]);
        let other = copy.give_back(&mut Lists(vec![("a", vec![])]));
        assert_eq!(other, Err(RestartError::Missing("a".into())));
    }
}

//! What a restart needs.

/// State that a later run needs to go on as if it had never stopped, as named arrays.
///
/// `restore(save(x))` continues bit for bit. Names are unique within one `Checkpoint`; who holds
/// several puts a prefix before each.
pub trait Checkpoint {
    /// Hands every array to `sink`.
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64]));
    /// Takes every array from `source`.
    ///
    /// # Errors
    /// When an array is missing or has another length than this object needs; the object is then
    /// in an unspecified but valid state.
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError>;

    /// Passes to `sink` what [`take_back`](Self::take_back) needs to take back the step that follows:
    /// everything, unless an implementation keeps fields from before the step itself.
    fn save_start(&mut self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.save(sink);
    }
    /// Takes back the one step since [`save_start`](Self::save_start), whole or broken off. The state
    /// is then, to the bit, that before the step.
    ///
    /// # Errors
    /// As [`restore`](Self::restore).
    fn take_back<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.restore(source)
    }
}

impl Checkpoint for () {
    fn save(&self, _: &mut dyn FnMut(&str, &[f64])) {}
    fn restore<'a>(&mut self, _: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        Ok(())
    }
}

impl<T: Checkpoint + ?Sized> Checkpoint for Box<T> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        (**self).save(sink);
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        (**self).restore(source)
    }
    fn save_start(&mut self, sink: &mut dyn FnMut(&str, &[f64])) {
        (**self).save_start(sink);
    }
    fn take_back<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        (**self).take_back(source)
    }
}

/// What there is of it.
impl<T: Checkpoint> Checkpoint for Option<T> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.iter().for_each(|it| it.save(sink));
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.as_mut().map_or(Ok(()), |it| it.restore(source))
    }
    fn save_start(&mut self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.iter_mut().for_each(|it| it.save_start(sink));
    }
    fn take_back<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.as_mut().map_or(Ok(()), |it| it.take_back(source))
    }
}

/// The names of element i begin with "i.".
impl<T: Checkpoint> Checkpoint for Vec<T> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        for (i, element) in self.iter().enumerate() {
            element.save(&mut |name, values| sink(&format!("{i}.{name}"), values));
        }
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        for (i, element) in self.iter_mut().enumerate() {
            element.restore(&|name| source(&format!("{i}.{name}")))?;
        }
        Ok(())
    }
    fn save_start(&mut self, sink: &mut dyn FnMut(&str, &[f64])) {
        for (i, element) in self.iter_mut().enumerate() {
            element.save_start(&mut |name, values| sink(&format!("{i}.{name}"), values));
        }
    }
    fn take_back<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        for (i, element) in self.iter_mut().enumerate() {
            element.take_back(&|name| source(&format!("{i}.{name}")))?;
        }
        Ok(())
    }
}

/// Why saved state does not fit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RestartError {
    /// The saved state has no array of this name.
    Missing(String),
    /// The state was saved with other values of these.
    Differs(String),
    /// The saved array has another length.
    Length {
        /// Its name.
        name: String,
        /// The length this run needs.
        expected: usize,
        /// The length that was saved.
        found: usize,
    },
}

impl RestartError {
    /// The array `name` of `source`, when it is there and has `expected` entries.
    ///
    /// # Errors
    /// [`RestartError::Missing`] or [`RestartError::Length`].
    pub fn take<'a>(
        source: &dyn Fn(&str) -> Option<&'a [f64]>,
        name: &str,
        expected: usize,
    ) -> Result<&'a [f64], Self> {
        let found = source(name).ok_or_else(|| Self::Missing(name.into()))?;
        if found.len() == expected {
            Ok(found)
        } else {
            Err(Self::Length { name: name.into(), expected, found: found.len() })
        }
    }

    /// Fills `list` from the array `name` of `source`.
    ///
    /// # Errors
    /// As [`take`](Self::take) has them; `list` is then as it was.
    pub fn fill<'a>(
        source: &dyn Fn(&str) -> Option<&'a [f64]>,
        name: &str,
        list: &mut [f64],
    ) -> Result<(), Self> {
        list.copy_from_slice(Self::take(source, name, list.len())?);
        Ok(())
    }
}

impl std::fmt::Display for RestartError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Missing(name) => {
                write!(f, "the saved state has no `{name}`; it was written by another set-up")
            }
            Self::Differs(what) => {
                write!(f, "the state was saved by another set-up ({what}); give the same ones")
            }
            Self::Length { name, expected, found } => {
                write!(
                    f,
                    "the saved `{name}` has {found} entries where this run needs {expected}; use the grid and bodies it was saved with"
                )
            }
        }
    }
}
impl std::error::Error for RestartError {}

//! Exit codes, errors and output.
use scene::RunError;
use std::error::Error;
use std::io::{ErrorKind, Write};

/// Exit codes for the help.
pub(crate) const EXIT_CODES: &str = "\
Exit codes: 0 done; 1 an error of a run, or a missed tolerance of `table`; 2 an error of a scene or of the command line;
3 a steady flow has not converged; 130 stopped by Ctrl-C, with a saved state.";

/// Error with its exit code.
pub(crate) struct Failure {
    code: u8,
    error: Box<dyn Error>,
}

impl Failure {
    /// Error of a scene or of the command line.
    pub(crate) fn of_input(error: impl Into<Box<dyn Error>>) -> Self {
        Self { code: 2, error: error.into() }
    }

    /// Error of a run; one that a check finds has the code of a check.
    pub(crate) fn of_run(error: RunError) -> Self {
        let code = if matches!(error, RunError::Build(_)) { 2 } else { 1 };
        Self { code, error: error.into() }
    }

    /// Error of a file or the terminal.
    pub(crate) fn of_output(error: impl Into<Box<dyn Error>>) -> Self {
        Self { code: 1, error: error.into() }
    }

    /// Stop by Ctrl-C.
    pub(crate) fn of_stop(message: String) -> Self {
        Self { code: 130, error: message.into() }
    }

    /// Message without the exit code.
    pub(crate) fn message(&self) -> String {
        self.error.to_string()
    }

    /// Prints the error; returns its exit code.
    pub(crate) fn report(self) -> u8 {
        let _ = writeln!(std::io::stderr(), "error: {}", self.error);
        self.code
    }
}

/// Prints text. A reader that has gone away is no error; a full disk is one.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::of_output(format!("what was to be printed could not be: {error}")))
        }
        _ => Ok(()),
    }
}

//! One run per folder.
use crate::run::RunError;
use crate::watch::output;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::time::{Duration, Instant};

/// Name of the locked file in the folder. It stays there, empty, when no run has the folder.
const LOCK: &str = "run.lock";

/// Time that a run waits for a lock: a process that was killed just now still has its own.
const PATIENCE: Duration = Duration::from_secs(1);
/// Interval between attempts.
const INTERVAL: Duration = Duration::from_millis(20);

/// The lock of a folder while a run writes to it. The system frees it when the process ends,
/// however it ends.
#[derive(Debug)]
pub(crate) struct FolderLock {
    file: File,
}

impl FolderLock {
    /// Locks `folder` and writes the number of this process to the locked file.
    ///
    /// # Errors
    /// [`RunError::InUse`] if another run has it.
    pub(crate) fn take(folder: &Path) -> Result<Self, RunError> {
        let path = folder.join(LOCK);
        // The number in it is that of the run that has the lock: it is not truncated.
        let file = OpenOptions::new().create(true).write(true).truncate(false).open(&path);
        let mut file = file.map_err(output("making", &path))?;
        let start = Instant::now();
        let mut locked = file.try_lock();
        while matches!(locked, Err(TryLockError::WouldBlock)) && start.elapsed() < PATIENCE {
            std::thread::sleep(INTERVAL);
            locked = file.try_lock();
        }
        match locked {
            Ok(()) => {}
            // File systems without locks.
            Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {}
            Err(TryLockError::Error(error)) => return Err(output("locking", &path)(error).into()),
            Err(TryLockError::WouldBlock) => {
                let process = std::fs::read_to_string(&path).unwrap_or_default().trim().to_owned();
                return Err(RunError::InUse { folder: folder.into(), process });
            }
        }
        file.set_len(0)
            .and_then(|()| writeln!(file, "{}", std::process::id()))
            .map_err(output("writing", &path))?;
        Ok(Self { file })
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        let _ = self.file.set_len(0);
    }
}

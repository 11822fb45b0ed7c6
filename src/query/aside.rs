//! Reading, which does not look at a watch, on a thread of its own.

use std::{
    panic::resume_unwind,
    path::Path,
    sync::{Arc, Mutex, PoisonError, mpsc},
    thread,
    time::Duration,
};

use crate::watch::{Stopped, Watch};

/// Files of fewer bytes are read in a few milliseconds, and on the calling thread.
const SMALL: u64 = 1 << 20;

/// How often the watch is asked.
const TICK: Duration = Duration::from_millis(2);

/// Does what has to be done with the file at `path`. Where that takes long it is done on another thread, which is left
/// alone when the watch cancels: it comes to its end by itself, and its result is dropped.
///
/// # Errors
/// When the watch cancels.
pub(super) fn aside<T: Send + 'static>(
    path: &Path,
    watch: &dyn Watch,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, Stopped> {
    if std::fs::metadata(path).map_or(0, |data| data.len()) < SMALL {
        return Ok(work());
    }
    // Kept where it can be had back when the system has no thread to give.
    let work = Arc::new(Mutex::new(Some(work)));
    let take = {
        let work = Arc::clone(&work);
        move || work.lock().unwrap_or_else(PoisonError::into_inner).take()
    };
    let (sender, receiver) = mpsc::sync_channel(1);
    let body = move || {
        if let Some(work) = take() {
            let _ = sender.send(work());
        }
    };
    let Ok(reader) = thread::Builder::new().name("reader".into()).spawn(body) else {
        let work = work.lock().unwrap_or_else(PoisonError::into_inner).take();
        return work.map(|work| work()).ok_or(Stopped);
    };
    loop {
        match receiver.recv_timeout(TICK) {
            Ok(found) => return Ok(found),
            Err(mpsc::RecvTimeoutError::Timeout) if watch.cancelled() => return Err(Stopped),
            Err(mpsc::RecvTimeoutError::Timeout) => {}
            Err(mpsc::RecvTimeoutError::Disconnected) => match reader.join() {
                Err(panic) => resume_unwind(panic),
                Ok(()) => return Err(Stopped),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::watch::{Unwanted, Unwatched};

    #[test]
    fn a_large_file_is_left_alone_when_the_watch_cancels() {
        let folder = tempfile::tempdir().unwrap();
        let (large, small) = (folder.path().join("large"), folder.path().join("small"));
        std::fs::write(&large, vec![0; SMALL as usize]).unwrap();
        std::fs::write(&small, [0; 9]).unwrap();
        let slow = || thread::sleep(Duration::from_secs(20));
        let start = Instant::now();
        assert_eq!(aside(&large, &Unwanted, slow), Err(Stopped));
        assert!(start.elapsed() < Duration::from_secs(10));
        assert_eq!(aside(&small, &Unwanted, || 3), Ok(3));
        assert_eq!(aside(&large, &Unwatched, || 4), Ok(4));
    }

    #[test]
    fn a_panic_is_passed_on() {
        let folder = tempfile::tempdir().unwrap();
        let large = folder.path().join("large");
        std::fs::write(&large, vec![0; SMALL as usize]).unwrap();
        let panic = std::panic::catch_unwind(|| aside(&large, &Unwatched, || panic!("a defect"))).unwrap_err();
        assert_eq!(panic.downcast_ref(), Some(&"a defect"));
    }
}

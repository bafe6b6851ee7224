//! The threads of a page: workers that it starts, each with its own instance of the module on the one memory.
//!
//! One worker holds the session and calls [`start`], which waits until as many others as it wants have called [`serve`].

use std::{
    collections::VecDeque,
    sync::{Condvar, Mutex, PoisonError},
};

use rayon_core::{ThreadBuilder, ThreadPoolBuilder};

use crate::session::Outcome;

/// Threads that no worker has taken.
static WANTED: Mutex<VecDeque<ThreadBuilder>> = Mutex::new(VecDeque::new());
static CHANGED: Condvar = Condvar::new();

/// Makes the threads on which the library works.
pub(crate) fn start(count: usize) -> Outcome<()> {
    let want = |thread| {
        WANTED.lock().unwrap_or_else(PoisonError::into_inner).push_back(thread);
        CHANGED.notify_one();
        Ok(())
    };
    Ok(ThreadPoolBuilder::new().num_threads(count).spawn_handler(want).build_global()?)
}

/// Works as one of the threads, as long as the page lives.
pub(crate) fn serve() {
    let wanted = WANTED.lock().unwrap_or_else(PoisonError::into_inner);
    let mut wanted = CHANGED.wait_while(wanted, |wanted| wanted.is_empty()).unwrap_or_else(PoisonError::into_inner);
    let thread = wanted.pop_front();
    drop(wanted);
    thread.map(ThreadBuilder::run);
}

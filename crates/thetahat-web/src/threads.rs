//! The threads of a page: workers that it starts, each with its own instance of the module on the one memory.
//!
//! One worker holds the session and calls [`start`], which waits until the requested number of others have called [`serve`].

use std::{
    collections::VecDeque,
    sync::{Condvar, Mutex, PoisonError},
};

use rayon_core::{ThreadBuilder, ThreadPoolBuilder};

use crate::session::Outcome;

/// Threads without a worker.
static WAITING: Mutex<VecDeque<ThreadBuilder>> = Mutex::new(VecDeque::new());
static CHANGED: Condvar = Condvar::new();

/// Creates the threads of the library.
pub(crate) fn start(count: usize) -> Outcome<()> {
    let enqueue = |thread| {
        WAITING.lock().unwrap_or_else(PoisonError::into_inner).push_back(thread);
        CHANGED.notify_one();
        Ok(())
    };
    Ok(ThreadPoolBuilder::new().num_threads(count).spawn_handler(enqueue).build_global()?)
}

/// Works as one of the threads for the lifetime of the page.
pub(crate) fn serve() {
    let waiting = WAITING.lock().unwrap_or_else(PoisonError::into_inner);
    let mut waiting = CHANGED.wait_while(waiting, |waiting| waiting.is_empty()).unwrap_or_else(PoisonError::into_inner);
    let thread = waiting.pop_front();
    drop(waiting);
    thread.map(ThreadBuilder::run);
}

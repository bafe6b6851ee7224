//! How far a design is, and whether it is to stop.

use std::{
    ops::ControlFlow,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
};

/// How far a design is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DesignProgress {
    /// What is being done.
    pub stage: &'static str,
    /// Descents that have ended, and all of them; none in a stage that is not counted.
    pub descents: Option<[usize; 2]>,
    /// Criterion of the best motion so far, nats: lower is better.
    pub best: Option<f64>,
}

/// Shows progress, and asks whether to go on: a search that is to stop ends with its best motion so far.
pub(in crate::design) type Show<'a> = &'a (dyn Fn(&DesignProgress) -> ControlFlow<()> + Sync);

/// The progress of one design.
pub(in crate::design) struct Watch<'a> {
    show: Show<'a>,
    is_stopped: AtomicBool,
}

impl<'a> Watch<'a> {
    pub(in crate::design) fn new(show: Show<'a>) -> Self {
        Self { show, is_stopped: AtomicBool::new(false) }
    }

    /// Begins a stage that is not counted.
    pub(in crate::design) fn stage(&self, stage: &'static str) {
        self.say(&DesignProgress { stage, descents: None, best: None });
    }

    pub(in crate::design) fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    fn say(&self, progress: &DesignProgress) {
        if (self.show)(progress).is_break() {
            self.is_stopped.store(true, Ordering::Relaxed);
        }
    }
}

/// The descents of a search, counted.
pub(in crate::design) struct Descents<'a> {
    watch: &'a Watch<'a>,
    stage: &'static str,
    of: usize,
    so_far: Mutex<SoFar>,
}

#[derive(Clone, Copy, Default)]
struct SoFar {
    ended: usize,
    best: Option<f64>,
}

impl<'a> Descents<'a> {
    pub(in crate::design) fn new(watch: &'a Watch<'a>, stage: &'static str, of: usize) -> Self {
        let descents = Self { watch, stage, of, so_far: Mutex::default() };
        descents.say(SoFar::default());
        descents
    }

    /// One more has ended, with the criterion of its motion if it found one.
    pub(in crate::design) fn ended(&self, found: Option<f64>) {
        let mut so_far = self.so_far.lock().unwrap_or_else(PoisonError::into_inner);
        so_far.ended += 1;
        so_far.best = so_far.best.into_iter().chain(found).reduce(f64::min);
        self.say(*so_far);
    }

    pub(in crate::design) fn is_stopped(&self) -> bool {
        self.watch.is_stopped()
    }

    /// Descents that have ended, and all of them, where the search was stopped.
    pub(in crate::design) fn stopped_after(&self) -> Option<[usize; 2]> {
        let ended = self.so_far.lock().unwrap_or_else(PoisonError::into_inner).ended;
        self.is_stopped().then_some([ended, self.of])
    }

    fn say(&self, SoFar { ended, best }: SoFar) {
        self.watch.say(&DesignProgress { stage: self.stage, descents: Some([ended, self.of]), best });
    }
}

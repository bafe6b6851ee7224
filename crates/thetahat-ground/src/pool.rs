//! An ordered parallel map: pieces of a recording, cases, runs of a campaign.
//!
//! Results do not depend on the number of threads if `work` depends on its number alone. With one thread the caller does the work. If the
//! system starts no threads, the caller does all of it. In wasm, the page's workers (`rayon_core`) are used, and work that is begun on one
//! of them stays on it. A panic of the work is passed on to the caller.

use std::{
    any::Any,
    collections::BTreeMap,
    panic::{AssertUnwindSafe, catch_unwind, resume_unwind},
    sync::{
        Mutex,
        atomic::{AtomicBool, Ordering},
        mpsc,
    },
    thread,
};

/// Numbers begun or queued ahead, per thread.
const AHEAD: usize = 3;

/// The number of threads that the machine runs at a time.
pub fn available_threads() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

/// Maps the numbers below `count` by `work`, in order.
pub fn in_parallel<T: Send>(count: usize, threads: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let mut results = BTreeMap::new();
    let keep = |number, result| {
        results.insert(number, result);
        Ok::<(), std::convert::Infallible>(())
    };
    let Ok(()) = as_finished(count, threads, work, keep);
    results.into_values().collect()
}

/// Works on the numbers below `count` and passes each result to `take` in the calling thread as soon as it is finished.
///
/// If `take` returns an error, no further work is begun and the error is returned.
pub fn as_finished<T: Send, E>(
    count: usize,
    threads: usize,
    work: impl Fn(usize) -> T + Sync,
    mut take: impl FnMut(usize, T) -> Result<(), E>,
) -> Result<(), E> {
    run(count, threads, work, |number, result| take(number, result).map(|()| 1))
}

/// As [`as_finished`], but in the order of the numbers: no more than `AHEAD` results per thread exist at a time.
pub fn in_order<T: Send, E>(
    count: usize,
    threads: usize,
    work: impl Fn(usize) -> T + Sync,
    mut take: impl FnMut(usize, T) -> Result<(), E>,
) -> Result<(), E> {
    let (mut waiting, mut next) = (BTreeMap::new(), 0);
    run(count, threads, work, |number, result| {
        waiting.insert(number, result);
        let before = next;
        while let Some(result) = waiting.remove(&next) {
            take(next, result)?;
            next += 1;
        }
        Ok(next - before)
    })
}

/// Works on the numbers below `count`; `take` returns how many further numbers may be begun after a result.
fn run<T: Send, E>(
    count: usize,
    threads: usize,
    work: impl Fn(usize) -> T + Sync,
    mut take: impl FnMut(usize, T) -> Result<usize, E>,
) -> Result<(), E> {
    let threads = threads.min(count);
    if threads <= 1 {
        return in_caller(count, work, take);
    }
    let (to_do, numbers) = mpsc::channel();
    let (queue, work) = (&Queue { numbers: Mutex::new(numbers), stopped: AtomicBool::new(false) }, &work);
    let (done, results) = mpsc::channel();
    let serve = || queue.serve(work, &done);
    // When this closure returns, `to_do` is dropped, and the threads end.
    with_workers(threads, &serve, move |threads| {
        if threads == 0 {
            return in_caller(count, work, take);
        }
        let mut left = 0..count;
        let mut begin = |more: usize| left.by_ref().take(more).try_for_each(|number| to_do.send(number));
        // While this runs, there are threads to receive a number.
        let _ = begin(AHEAD.saturating_mul(threads));
        for (number, result) in results.iter().take(count) {
            let taken = take(number, result.unwrap_or_else(|panic| resume_unwind(panic)));
            let _ = begin(taken.inspect_err(|_| queue.stop())?);
        }
        Ok(())
    })
}

/// Runs `body` in the calling thread while up to `threads` worker threads run `serve`.
#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
fn with_workers<R>(threads: usize, serve: &(impl Fn() + Sync), body: impl FnOnce(usize) -> R) -> R {
    thread::scope(|scope| {
        let start = |_: &usize| thread::Builder::new().spawn_scoped(scope, serve).is_ok();
        body((0..threads).take_while(start).count())
    })
}

#[cfg(all(target_family = "wasm", target_os = "unknown"))]
fn with_workers<R>(threads: usize, serve: &(impl Fn() + Sync), body: impl FnOnce(usize) -> R) -> R {
    // A pool thread that waited for other pool threads could wait forever.
    let is_of_pool = rayon_core::current_thread_index().is_some();
    let threads = if is_of_pool { 0 } else { threads.min(rayon_core::current_num_threads()) };
    rayon_core::in_place_scope(|scope| {
        (0..threads).for_each(|_| scope.spawn(|_| serve()));
        body(threads)
    })
}

fn in_caller<T, E>(
    count: usize,
    work: impl Fn(usize) -> T,
    mut take: impl FnMut(usize, T) -> Result<usize, E>,
) -> Result<(), E> {
    (0..count).try_for_each(|number| take(number, work(number)).map(|_| ()))
}

type Finished<T> = (usize, Result<T, Box<dyn Any + Send>>);

/// Numbers that may be begun.
struct Queue {
    numbers: Mutex<mpsc::Receiver<usize>>,
    stopped: AtomicBool,
}

impl Queue {
    fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }

    fn next(&self) -> Option<usize> {
        let number = self.numbers.lock().ok()?.recv().ok()?;
        (!self.stopped.load(Ordering::Relaxed)).then_some(number)
    }

    /// Loop of one thread: it works until no number is left or the receiver is gone.
    fn serve<T>(&self, work: impl Fn(usize) -> T, done: &mpsc::Sender<Finished<T>>) {
        while let Some(number) = self.next() {
            let result = catch_unwind(AssertUnwindSafe(|| work(number)));
            if result.is_err() {
                self.stop();
            }
            if done.send((number, result)).is_err() {
                break;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::{
        collections::BTreeSet,
        panic,
        sync::atomic::{AtomicUsize, Ordering},
        time::Duration,
    };

    use super::*;

    /// Work of uneven length.
    fn uneven(number: usize) -> usize {
        thread::sleep(Duration::from_micros(((number * 7919) % 13) as u64 * 50));
        number * number
    }

    #[test]
    fn results_stand_in_the_order_of_the_work() {
        for threads in [0, 1, 3, 50] {
            assert_eq!(in_parallel(20, threads, |k| k * k), (0..20).map(|k| k * k).collect::<Vec<_>>());
        }
        assert!(in_parallel(0, 2, |k| k).is_empty());
    }

    #[test]
    fn results_come_in_order_whatever_the_threads() {
        for threads in [1, 2, 7] {
            let mut taken = Vec::new();
            let all: Result<(), ()> = in_order(100, threads, uneven, |number, result| {
                assert_eq!(result, number * number);
                taken.push(number);
                Ok(())
            });
            assert_eq!((all, taken), (Ok(()), (0..100).collect()));
        }
    }

    #[test]
    fn finished_results_are_each_taken_once() {
        for threads in [1, 2, 7] {
            let mut taken = BTreeSet::new();
            let all: Result<(), ()> = as_finished(100, threads, uneven, |number, result| {
                assert_eq!(result, number * number);
                assert!(taken.insert(number));
                Ok(())
            });
            assert_eq!((all, taken), (Ok(()), (0..100).collect()));
        }
    }

    #[test]
    fn no_more_results_exist_than_are_allowed() {
        let (threads, alive, most) = (4, AtomicUsize::new(0), AtomicUsize::new(0));
        let work = |number: usize| {
            most.fetch_max(alive.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
            uneven(number)
        };
        let all: Result<(), ()> = in_order(200, threads, work, |_, _| {
            alive.fetch_sub(1, Ordering::SeqCst);
            Ok(())
        });
        assert!(all.is_ok() && most.load(Ordering::SeqCst) <= AHEAD * threads);
    }

    #[test]
    fn what_is_refused_ends_the_work() {
        for threads in [1, 3] {
            let begun = AtomicUsize::new(0);
            let work = |number: usize| {
                begun.fetch_add(1, Ordering::SeqCst);
                number
            };
            let refuse = |number, _| if number == 5 { Err(number) } else { Ok(()) };
            assert_eq!(in_order(1000, threads, work, refuse), Err(5));
            assert_eq!(as_finished(1000, threads, work, refuse), Err(5));
            assert!(begun.load(Ordering::SeqCst) < 100);
        }
    }

    #[test]
    fn a_panic_of_the_work_is_passed_on() {
        for threads in [1, 3] {
            let work = |number: usize| if number == 7 { panic::panic_any("number 7") } else { number };
            let all = panic::catch_unwind(|| in_parallel(1000, threads, work));
            assert_eq!(all.unwrap_err().downcast_ref::<&str>(), Some(&"number 7"));
        }
    }

    #[test]
    fn one_thread_is_the_calling_one() {
        let own = thread::current().id();
        assert!(in_parallel(3, 1, |_| thread::current().id() == own).into_iter().all(|same| same));
        assert!(in_parallel(1, 8, |_| thread::current().id() == own).into_iter().all(|same| same));
        assert!(in_parallel(3, 2, |_| thread::current().id() == own).into_iter().all(|same| !same));
    }
}

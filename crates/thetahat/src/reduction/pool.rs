//! Work on numbered pieces by several threads, taken in order.

use std::{
    collections::BTreeMap,
    sync::{Mutex, mpsc},
    thread,
};

/// Pieces that are worked on or wait for their turn, for each thread.
const AHEAD: usize = 3;

/// Works on pieces `0..count`, so many at a time, and takes the results in order. No more than a few pieces per thread are
/// held at a time. Ends early with what `take` refuses.
pub(super) fn in_order<T: Send, E>(
    count: usize,
    threads: usize,
    work: impl Fn(usize) -> T + Sync,
    mut take: impl FnMut(usize, T) -> Result<(), E>,
) -> Result<(), E> {
    if threads <= 1 {
        return (0..count).try_for_each(|piece| take(piece, work(piece)));
    }
    let (to_do, jobs) = mpsc::channel::<usize>();
    let (done, results) = mpsc::channel::<(usize, Option<T>)>();
    let jobs = Mutex::new(jobs);
    thread::scope(|scope| {
        for _ in 0..threads {
            let (done, jobs, work) = (done.clone(), &jobs, &work);
            scope.spawn(move || {
                while let Some(piece) = next(jobs) {
                    let mut promise = Promise { piece, done: &done, kept: false };
                    let result = work(piece);
                    promise.kept = true;
                    if done.send((piece, Some(result))).is_err() {
                        break;
                    }
                }
            });
        }
        let ask = |piece: usize| {
            if piece < count {
                // There are threads to take it as long as this one runs.
                let _ = to_do.send(piece);
            }
        };
        let ahead = AHEAD * threads;
        (0..ahead).for_each(ask);
        let mut waiting = BTreeMap::new();
        let taken = (0..count).try_for_each(|piece| {
            while !waiting.contains_key(&piece) {
                match results.recv() {
                    Ok((number, Some(result))) => waiting.insert(number, result),
                    // A thread has panicked; the scope passes it on.
                    Ok((_, None)) | Err(_) => return Ok(()),
                };
            }
            let result = waiting.remove(&piece);
            ask(piece + ahead);
            result.map_or(Ok(()), |result| take(piece, result))
        });
        drop(to_do);
        drop(results);
        taken
    })
}

fn next(jobs: &Mutex<mpsc::Receiver<usize>>) -> Option<usize> {
    jobs.lock().ok()?.recv().ok()
}

/// Tells who waits for a piece that it will not come.
struct Promise<'a, T> {
    piece: usize,
    done: &'a mpsc::Sender<(usize, Option<T>)>,
    kept: bool,
}

impl<T> Drop for Promise<'_, T> {
    fn drop(&mut self) {
        if !self.kept {
            let _ = self.done.send((self.piece, None));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_whatever_the_threads() {
        for threads in [1, 2, 7] {
            let mut taken = Vec::new();
            let work = |piece: usize| {
                thread::sleep(std::time::Duration::from_micros(((piece * 7919) % 13) as u64 * 50));
                piece * piece
            };
            let all: Result<(), ()> = in_order(100, threads, work, |piece, result| {
                assert_eq!(result, piece * piece);
                taken.push(piece);
                Ok(())
            });
            assert_eq!((all, taken), (Ok(()), (0..100).collect()));
        }
    }

    #[test]
    fn what_is_refused_ends_the_work() {
        for threads in [1, 3] {
            let result = in_order(1000, threads, |p| p, |p, _| if p == 5 { Err(p) } else { Ok(()) });
            assert_eq!(result, Err(5));
        }
    }
}

//! Work on every core, the outcomes in the order of what was to be done.

use std::sync::Mutex;

/// Does `work` for each item, with something a worker keeps between items. The last items come first: in a list that grows more
/// laborious no core then waits for one of them alone.
///
/// # Errors
/// When a worker has panicked.
pub(crate) fn on_all_cores<T: Sync, K, R: Send>(
    items: &[T],
    keep: impl Fn() -> K + Sync,
    work: impl Fn(&mut K, &T) -> R + Sync,
) -> Result<Vec<R>, String> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from).min(items.len());
    let next = Mutex::new(items.iter().enumerate().rev());
    let worker = || {
        let mut kept = keep();
        let mut done = Vec::new();
        loop {
            let Some((at, item)) = next.lock().ok().and_then(|mut next| next.next()) else { return done };
            done.push((at, work(&mut kept, item)));
        }
    };
    let mut done: Vec<(usize, R)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap_or_default()).collect()
    });
    done.sort_by_key(|(at, _)| *at);
    if done.len() != items.len() {
        return Err("a search has failed".to_owned());
    }
    Ok(done.into_iter().map(|(_, outcome)| outcome).collect())
}

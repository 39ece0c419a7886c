//! Counting words by their ones: every sum of given rows, one exclusive or a word, many lengths at once.

use crate::code::{Code, Unsuitable};
use crate::weights::{Weights, macwilliams};
use num_bigint::BigUint;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

/// Words of a job of one thread, as a power of two; progress is told after each.
const JOB: u32 = 22;

/// Told after each piece of work: words counted and words in all.
pub type Progress<'p> = &'p (dyn Fn(u64, u64) + Sync);

/// The weight distributions of words of these lengths in octets, signature included, in the order asked for.
///
/// Of code and dual code the smaller is enumerated. The dual code of a length is the beginning of that of every longer one, so one
/// pass over its 2^width words, half of them when x + 1 divides the generator, serves all lengths; with 32 bits that takes seconds on
/// each core, with 16 none.
///
/// # Errors
/// [`Unsuitable::Length`], before anything is counted.
pub fn distributions(code: Code, lengths: &[usize], progress: Progress<'_>) -> Result<Vec<Weights>, Unsuitable> {
    lengths.iter().try_for_each(|octets| code.check(*octets))?;
    let (short, long): (Vec<usize>, Vec<usize>) =
        lengths.iter().partition(|octets| 8 * **octets - (code.width() as usize) < code.width() as usize);
    let dual = dual_counts(code, &long, progress);
    let mut found: Vec<Weights> =
        long.iter().zip(dual).filter_map(|(&octets, dual)| Weights::from_dual(code, octets, dual)).collect();
    found.extend(short.iter().map(|&octets| {
        let bits = 8 * octets as u32;
        let words: Vec<BigUint> = code_counts(code, octets).into_iter().map(BigUint::from).collect();
        let dual = macwilliams(&words, bits - code.width());
        Weights::new(code, octets, words, dual)
    }));
    Ok(lengths.iter().filter_map(|octets| found.iter().find(|weights| weights.octets() == *octets).cloned()).collect())
}

/// How many words of the dual code have 0, 1, .. 8 x `octets` ones, by counting all 2^width of them.
///
/// # Errors
/// [`Unsuitable::Length`].
pub fn dual_weights(code: Code, octets: usize) -> Result<Vec<u64>, Unsuitable> {
    code.check(octets)?;
    Ok(dual_counts(code, &[octets], &|_, _| ()).swap_remove(0))
}

/// The dual code of each length: bit j of the word of `a` is the product of `a` and x^j mod g, so row i holds bit i of all of those.
fn dual_counts(code: Code, lengths: &[usize], progress: Progress<'_>) -> Vec<Vec<u64>> {
    let Some(longest) = lengths.iter().max() else { return Vec::new() };
    let mut rows = vec![vec![0; longest.div_ceil(8)]; code.width() as usize];
    for (at, syndrome) in code.syndromes().take(8 * longest).enumerate() {
        rows.iter_mut().enumerate().for_each(|(i, row)| set(row, at, syndrome >> i & 1 == 1));
    }
    if !code.is_even() {
        return count(&rows, lengths, progress);
    }
    // The sum of all rows is all ones: the words with the last row are the complements of those without.
    rows.pop();
    let half = count(&rows, lengths, progress);
    half.into_iter()
        .map(|counts| counts.iter().zip(counts.iter().rev()).map(|(one, other)| one + other).collect())
        .collect()
}

/// The code itself: a row for each data bit, with the signature that belongs to it.
fn code_counts(code: Code, octets: usize) -> Vec<u64> {
    let width = code.width() as usize;
    let row = |(at, signature): (usize, u32)| {
        let mut row = vec![0; octets.div_ceil(8)];
        (0..width).for_each(|bit| set(&mut row, bit, signature >> bit & 1 == 1));
        set(&mut row, at, true);
        row
    };
    let rows: Vec<_> = code.syndromes().enumerate().take(8 * octets).skip(width).map(row).collect();
    count(&rows, &[octets], &|_, _| ()).swap_remove(0)
}

fn set(row: &mut [u64], at: usize, value: bool) {
    if let Some(word) = row.get_mut(at / 64) {
        *word |= u64::from(value) << (at % 64);
    }
}

/// All sums of the rows by their ones among the first 8 x octets bits, for each length.
fn count(rows: &[Vec<u64>], lengths: &[usize], progress: Progress<'_>) -> Vec<Vec<u64>> {
    // Words are copied as a whole, so their size has to be known; what is above the row stays 0.
    match rows.first().map_or(0, Vec::len) {
        0..=1 => Sums::<1>::new(rows, lengths).count(progress),
        2 => Sums::<2>::new(rows, lengths).count(progress),
        3 => Sums::<3>::new(rows, lengths).count(progress),
        4 => Sums::<4>::new(rows, lengths).count(progress),
        5..=8 => Sums::<8>::new(rows, lengths).count(progress),
        9..=12 => Sums::<12>::new(rows, lengths).count(progress),
        _ => Sums::<16>::new(rows, lengths).count(progress),
    }
}

/// The sums of some rows of up to 64 x `WORDS` bits.
struct Sums<'l, const WORDS: usize> {
    rows: Vec<[u64; WORDS]>,
    lengths: &'l [usize],
    /// Of each word: its octets at which a length ends, the first and the one behind the last. What lies between is counted as well.
    ends: [(usize, usize); WORDS],
}

impl<'l, const WORDS: usize> Sums<'l, WORDS> {
    /// Counters of a length, by ones.
    const WEIGHTS: usize = 64 * WORDS + 1;

    fn new(rows: &[Vec<u64>], lengths: &'l [usize]) -> Self {
        let whole = |row: &Vec<u64>| std::array::from_fn(|at| row.get(at).copied().unwrap_or(0));
        let ends = std::array::from_fn(|word| {
            let here = lengths.iter().map(|octets| octets - 1).filter(|last| last / 8 == word);
            here.fold((8, 0), |(from, to), last| (from.min(last % 8), to.max(last % 8 + 1)))
        });
        Sums { rows: rows.iter().map(whole).collect(), lengths, ends }
    }

    fn count(&self, progress: Progress<'_>) -> Vec<Vec<u64>> {
        let size = JOB.min(self.rows.len() as u32);
        let jobs = 1u64 << (self.rows.len() as u32 - size);
        let (next, done) = (AtomicU64::new(0), AtomicU64::new(0));
        let counters = 8 * WORDS * Self::WEIGHTS;
        let work = || {
            let mut sums = vec![0u64; counters];
            while let Some(job) = Some(next.fetch_add(1, Ordering::Relaxed)).filter(|job| *job < jobs) {
                // Half the size, so that they stay near the core; a job cannot overflow them.
                let mut counts = vec![0u32; counters];
                self.job(job << size, size, &mut counts);
                sums.iter_mut().zip(counts).for_each(|(sum, count)| *sum += u64::from(count));
                progress((done.fetch_add(1, Ordering::Relaxed) + 1) << size, jobs << size);
            }
            sums
        };
        let threads = thread::available_parallelism().map_or(1, |cores| cores.get() as u64).min(jobs);
        let counts = thread::scope(|scope| {
            let others: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
            let mut sums = work();
            for other in others {
                match other.join() {
                    Ok(counts) => sums.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count),
                    Err(panic) => std::panic::resume_unwind(panic),
                }
            }
            sums
        });
        let of_length = |octets: &usize| counts.chunks(Self::WEIGHTS).nth(octets - 1).unwrap_or_default();
        self.lengths.iter().map(|octets| of_length(octets).iter().take(8 * octets + 1).copied().collect()).collect()
    }

    /// 2^`size` sums in the order of the Gray code, so that each is its neighbour and one row.
    fn job(&self, first: u64, size: u32, counts: &mut [u32]) {
        let mut sum = [0u64; WORDS];
        for (bit, row) in self.rows.iter().enumerate() {
            if (first ^ first >> 1) >> bit & 1 == 1 {
                add(&mut sum, row);
            }
        }
        self.weigh(&sum, counts);
        for step in 1u64..1 << size {
            if let Some(row) = self.rows.get(step.trailing_zeros() as usize) {
                add(&mut sum, row);
            }
            self.weigh(&sum, counts);
        }
    }

    #[inline(always)]
    fn weigh(&self, sum: &[u64; WORDS], counts: &mut [u32]) {
        let mut before = 0;
        let each = sum.iter().zip(&self.ends).zip(counts.chunks_exact_mut(8 * Self::WEIGHTS));
        for ((word, (from, to)), counts) in each {
            let ones = ones_up_to(*word);
            let mut add = |octet: usize| {
                if let Some(count) =
                    counts.get_mut(octet * Self::WEIGHTS + before + (ones >> (8 * octet) & 0xFF) as usize)
                {
                    *count += 1;
                }
            };
            match (from, to) {
                // The usual one, so that it can be unrolled.
                (0, 8) => (0..8).for_each(add),
                _ => (*from..*to).for_each(&mut add),
            }
            before += (ones >> 56) as usize;
        }
    }
}

#[inline(always)]
fn add<const WORDS: usize>(sum: &mut [u64; WORDS], row: &[u64; WORDS]) {
    sum.iter_mut().zip(row).for_each(|(sum, row)| *sum ^= row);
}

/// Octet k of the result: ones in the octets 0 to k of the word.
#[inline(always)]
const fn ones_up_to(word: u64) -> u64 {
    let pairs = word - (word >> 1 & 0x5555_5555_5555_5555);
    let fours = (pairs & 0x3333_3333_3333_3333) + (pairs >> 2 & 0x3333_3333_3333_3333);
    let octets = (fours + (fours >> 4)) & 0x0F0F_0F0F_0F0F_0F0F;
    octets.wrapping_mul(0x0101_0101_0101_0101)
}

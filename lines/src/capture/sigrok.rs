//! Sessions of sigrok: a zip archive of `metadata` and of samples in chunks `logic-1-1`, `logic-1-2` and so on.

use super::bounded::Allowance;
use super::channels::Channel;
use super::{About, Format, Options, Resolution, SampleRate, Source, Step, bad};
use crate::{Levels, RecordingError, WakeUps};
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;
use zip::ZipArchive;
use zip::result::ZipError;

/// Octets of the directory of the archive, and of what is looked through to find it.
const DIRECTORY: u64 = 1 << 24;
/// Octets at the end of an archive in which its directory is announced: a comment and little more.
const TAIL: u64 = (1 << 16) + 128;
/// Octets of `metadata`.
const METADATA: u64 = 1 << 16;
/// Octets of samples that are handed over at a time.
const BLOCK: usize = 1 << 16;
/// How many blocks wait to be taken.
const WAITING: usize = 2;
/// Octets of a sample: 512 channels.
const WIDEST: usize = 64;

/// Reads `metadata` and begins to unpack the samples.
pub(super) fn open<S: Read + Seek + Send + 'static>(
    mut source: S,
    options: &Options,
) -> Result<(About, Reader), RecordingError> {
    let length = source.seek(SeekFrom::End(0)).map_err(|error| bad(error.to_string()))?;
    bound_directory(&mut source, length)?;
    let mut archive = ZipArchive::new(BufReader::new(source)).map_err(|error| damaged(&error))?;
    let metadata = Metadata::read(&mut archive, length)?;
    let rate = Resolution::agreed(metadata.rate, options.sample_rate)?;
    let Some((hertz, _)) = rate else {
        return Err(bad("its metadata state no sample rate: give it, such as 24 MHz"));
    };
    let channels: Vec<Channel> = metadata.probes.iter().map(|(_, name)| Channel::plain(name)).collect();
    let places = options.channels.find(&channels)?;
    let unit = metadata.unit;
    let bits = places.map(|place| place.map(|place| metadata.probes[place].0));

    // An entry of the archive borrows it while it is unpacked, so the archive lives on a thread of its own. The thread ends
    // when the samples do, or when nobody takes them any more.
    let (to, blocks) = sync_channel(WAITING);
    thread::spawn(move || {
        if let Err(error) = unpack(&mut archive, &metadata.prefix, unit, &to) {
            // The reader may be gone.
            let _ = to.send(Err(error));
        }
    });
    let mut mask = vec![0; unit];
    for bit in bits.into_iter().flatten() {
        mask[bit / 8] |= 1 << (bit % 8);
    }
    let reader = Reader {
        blocks,
        block: Vec::new(),
        at: 0,
        mask,
        bits,
        rate: hertz,
        taken: 0,
        latest: Vec::new(),
        ended: false,
    };
    let about = About {
        format: Format::Sigrok,
        resolution: Resolution { step_fs: None, rate, stated_ns: None },
        channels: places.map(|place| place.map(|place| channels[place].name.clone())),
        origin_fs: 0,
        wake_ups: WakeUps::Pulses,
    };
    Ok((about, reader))
}

/// Refuses an archive whose directory would take memory: one that announces more entries than the plain format counts, or
/// whose directory is long. `zip` makes room for as many as are announced.
fn bound_directory<S: Read + Seek>(source: &mut S, length: u64) -> Result<(), RecordingError> {
    let mut tail = Vec::new();
    source.seek(SeekFrom::Start(length.saturating_sub(TAIL))).map_err(|error| bad(error.to_string()))?;
    source.take(TAIL).read_to_end(&mut tail).map_err(|error| bad(error.to_string()))?;
    if tail.windows(4).any(|octets| octets == b"PK\x06\x07") {
        return Err(bad("the zip archive is in the format for more than 65535 entries or 4 GB, which is not read"));
    }
    let mut archive = Allowance::new(BufReader::new(source));
    archive.allow(DIRECTORY);
    match ZipArchive::new(archive) {
        Ok(_) => Ok(()),
        Err(error) => Err(damaged(&error)),
    }
}

/// What `metadata` states of the one device with samples.
#[derive(Default)]
struct Metadata {
    /// What the names of the chunks begin with.
    prefix: String,
    rate: Option<SampleRate>,
    /// Octets of a sample.
    unit: usize,
    /// Bits of a sample and names.
    probes: Vec<(usize, String)>,
}

impl Metadata {
    fn read<R: Read + Seek>(archive: &mut ZipArchive<R>, length: u64) -> Result<Metadata, RecordingError> {
        let mut packed: u64 = 0;
        for place in 0..archive.len() {
            let entry = archive.by_index_data(place).map_err(|error| damaged(&error))?;
            packed = packed.saturating_add(entry.compressed_size());
        }
        // So that a small file cannot stand for endless samples.
        if packed > length {
            return Err(bad("the entries of the zip archive overlap"));
        }
        let file = match archive.by_name("metadata") {
            Ok(file) => file,
            Err(ZipError::FileNotFound) => {
                let what = "this is a zip archive without `metadata`, so no sigrok session";
                return Err(bad(format!("{what}; from Saleae Logic export CSV")));
            }
            Err(error) => return Err(damaged(&error)),
        };
        let mut text = Vec::new();
        file.take(METADATA + 1).read_to_end(&mut text).map_err(|error| bad(format!("its metadata: {error}")))?;
        if text.len() as u64 > METADATA {
            return Err(bad(format!("its metadata are longer than {METADATA} octets")));
        }
        Metadata::parse(&String::from_utf8_lossy(&text))
    }

    fn parse(text: &str) -> Result<Metadata, RecordingError> {
        let mut metadata = Metadata::default();
        for line in text.lines() {
            let Some((key, value)) = line.split_once('=') else { continue };
            let value = value.trim();
            match key.trim() {
                "capturefile" if metadata.prefix.is_empty() => metadata.prefix = value.to_owned(),
                "capturefile" => return Err(bad("it holds the samples of more than one device")),
                "samplerate" => metadata.rate = Some(value.parse()?),
                "unitsize" => metadata.unit = value.parse().unwrap_or(0),
                key => {
                    let number = key.strip_prefix("probe").and_then(|number| number.parse::<usize>().ok());
                    if let Some(bit) = number.and_then(|number| number.checked_sub(1)) {
                        metadata.probes.push((bit, value.to_owned()));
                    }
                }
            }
        }
        if metadata.prefix.is_empty() {
            return Err(bad("its metadata name no capturefile: it holds no samples of logic channels"));
        }
        let unit = metadata.unit;
        if unit == 0 || unit > WIDEST {
            return Err(bad(format!("its metadata state no unitsize from 1 to {WIDEST}")));
        }
        if let Some((bit, _)) = metadata.probes.iter().find(|(bit, _)| *bit >= 8 * unit) {
            return Err(bad(format!("its metadata name a probe{} that does not fit into {unit} octets", bit + 1)));
        }
        Ok(metadata)
    }
}

/// Hands over the samples of all chunks in blocks of whole samples.
fn unpack<R: Read + Seek>(
    archive: &mut ZipArchive<R>,
    prefix: &str,
    unit: usize,
    to: &SyncSender<Result<Vec<u8>, RecordingError>>,
) -> Result<(), RecordingError> {
    let size = BLOCK / unit * unit;
    let mut block = Vec::with_capacity(size);
    let mut before = 0;
    for place in 0..archive.len() {
        let entry = archive.by_index_data(place).map_err(|error| damaged(&error))?;
        let Some(number) = chunk(entry.name_raw(), prefix) else { continue };
        if number != before + 1 {
            return Err(bad(format!("chunk {number} of its samples comes after chunk {before}: one is missing")));
        }
        before = number;
        let mut file = archive.by_index(place).map_err(|error| damaged(&error))?;
        loop {
            let room = (size - block.len()) as u64;
            let read = (&mut file).take(room).read_to_end(&mut block);
            let count = read.map_err(|error| bad(format!("chunk {number} of its samples: {error}")))?;
            if block.len() == size && to.send(Ok(std::mem::replace(&mut block, Vec::with_capacity(size)))).is_err() {
                return Ok(());
            }
            if count == 0 {
                break;
            }
        }
    }
    let whole = block.len() / unit * unit;
    let cut = whole != block.len();
    block.truncate(whole);
    if !block.is_empty() && to.send(Ok(block)).is_err() {
        return Ok(());
    }
    if cut { Err(bad("its samples end in the middle of one: they are cut off")) } else { Ok(()) }
}

/// The number of a chunk; sessions of the first format have all samples in one file without a number.
fn chunk(name: &[u8], prefix: &str) -> Option<u64> {
    match name.strip_prefix(prefix.as_bytes())? {
        b"" => Some(1),
        rest => std::str::from_utf8(rest).ok()?.strip_prefix('-')?.parse().ok(),
    }
}

fn damaged(error: &ZipError) -> RecordingError {
    bad(format!("the zip archive is damaged or cut off: {error}"))
}

/// The samples of a session.
pub(super) struct Reader {
    blocks: Receiver<Result<Vec<u8>, RecordingError>>,
    block: Vec<u8>,
    /// What of the block is read.
    at: usize,
    /// The bits of the lines in a sample.
    mask: Vec<u8>,
    bits: [Option<usize>; 3],
    rate: SampleRate,
    /// How many samples are read.
    taken: u64,
    /// The latest sample but for channels that are no lines; empty before the first.
    latest: Vec<u8>,
    ended: bool,
}

impl Reader {
    /// Takes samples from the block up to and with the first that differs from the latest.
    fn change(&mut self) -> bool {
        let unit = self.mask.len();
        let rest = &self.block[self.at..];
        let differs = |sample: &[u8]| {
            self.latest.is_empty()
                || sample
                    .iter()
                    .zip(&self.mask)
                    .zip(&self.latest)
                    .any(|((octet, mask), latest)| octet & mask != *latest)
        };
        let place = match (self.mask.as_slice(), self.latest.as_slice()) {
            // The usual case, in a loop that compilers unroll.
            ([mask], [latest]) => rest.iter().position(|octet| octet & mask != *latest),
            _ => rest.chunks_exact(unit).position(differs),
        };
        let read = place.map_or(rest.len() / unit, |place| place + 1);
        if let Some(place) = place {
            let sample = &rest[place * unit..][..unit];
            self.latest = sample.iter().zip(&self.mask).map(|(octet, mask)| octet & mask).collect();
        }
        self.at += read * unit;
        self.taken += read as u64;
        place.is_some()
    }

    /// The lines in the latest sample.
    fn now(&self) -> Result<Step, RecordingError> {
        let sample = self.taken - 1;
        let at = self
            .rate
            .time_of(sample)
            .ok_or_else(|| bad(format!("sample {sample} is too late to be counted in nanoseconds")))?;
        let [power, cq, iq] = self.bits.map(|bit| bit.map(|bit| self.latest[bit / 8] >> (bit % 8) & 1 == 1));
        Ok(Step { at, levels: Levels { power, cq, iq }, wake_up: false })
    }
}

impl Source for Reader {
    fn step(&mut self) -> Result<Option<Step>, RecordingError> {
        while !self.ended {
            if self.change() {
                return self.now().map(Some);
            }
            match self.blocks.recv() {
                Ok(block) => (self.block, self.at) = (block?, 0),
                Err(_) => {
                    self.ended = true;
                    // Until when the lines are as they are.
                    return if self.taken == 0 { Ok(None) } else { self.now().map(Some) };
                }
            }
        }
        Ok(None)
    }
}

//! A machine that `fsct learn` has found, in place of a side of the tables.

use crate::learn::document;
use fsct_observed::{Mealy, Seen, Side};
use fsct_proof::can_stand_in;
use fsct_reports::learned::Learned;
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Octets of a file at the most.
const MOST: u64 = 16 << 20;

/// Products in place of machines of the tables.
#[derive(clap::Args, Clone, Debug, Default)]
pub struct Products {
    /// The learned.json of an FS-Device (fsct learn): it with an FS-Master of the tables
    #[arg(long, value_name = "FILE")]
    device: Option<PathBuf>,
    /// The learned.json of an FS-Master: it with an FS-Device of the tables, or with that of --device
    #[arg(long, value_name = "FILE")]
    master: Option<PathBuf>,
}

/// A product: what it says of itself, and its machine.
#[derive(Clone, Debug)]
pub struct Product {
    /// In its own words, as they came from the DUT.
    pub name: String,
    /// The machine.
    pub machine: Arc<Mealy<Seen>>,
}

impl Products {
    /// Reads the files that are named: the FS-Device, and the FS-Master.
    ///
    /// # Errors
    /// One sentence for the user.
    pub fn read(&self) -> Result<(Option<Product>, Option<Product>), String> {
        let read = |path: &Option<PathBuf>, side| path.as_deref().map(|path| read(path, side)).transpose();
        Ok((read(&self.device, Side::Device)?, read(&self.master, Side::Master)?))
    }
}

fn read(path: &Path, wanted: Side) -> Result<Product, String> {
    let about = |why: String| format!("{}: {why}", path.display());
    let mut text = String::new();
    let file = File::open(path).map_err(|error| about(format!("it cannot be read: {error}")))?;
    file.take(MOST + 1).read_to_string(&mut text).map_err(|error| about(format!("it cannot be read: {error}")))?;
    if text.len() as u64 > MOST {
        return Err(about(format!("it has more than {MOST} octets; `fsct learn` writes none as long")));
    }
    let file: Learned = serde_json::from_str(&text)
        .map_err(|error| about(format!("it is no learned.json as `fsct learn` writes it: {error}")))?;
    let (side, machine) = document::read(&file).map_err(about)?;
    if side != wanted {
        let (option, role) = if wanted == Side::Device { ("--device", "FS-Device") } else { ("--master", "FS-Master") };
        return Err(about(format!("it is not the machine of an {role}, as {option} wants")));
    }
    if let Some(bound) = &file.bound {
        return Err(about(format!("it was not learnt to the end ({bound}), so nothing can be proven of it")));
    }
    can_stand_in(side, &machine).map_err(about)?;
    let words = [&file.dut.vendor, &file.dut.product, &file.dut.version].map(String::as_str);
    let name = words.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" ");
    Ok(Product { name, machine: Arc::new(machine) })
}

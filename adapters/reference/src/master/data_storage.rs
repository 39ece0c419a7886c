//! Data Storage of a safety port: what is kept of the FS-Device, and the way it goes in DS_ParamManager_2, between PREOPERATE and
//! the verify record (clause 8, 9.4). The requests are those of the base standard on Index 0x0003.
//!
//! Backup goes from the Device to the FS-Master while there is no set, or the Device asks for it; restore goes back when the
//! Device has another checksum than the set. A Device in use refuses that (0x8022), and the start goes on, as Figure G.3 has it.

use super::MasterMutant;
use super::blocks::PortConfig;
use fsct_adapters::Response;

/// Index of Data Storage (base standard).
const INDEX_DATA_STORAGE: u16 = 0x0003;
/// Its Subindices.
mod subindex {
    pub(super) const COMMAND: u8 = 1;
    pub(super) const STATE: u8 = 2;
    pub(super) const CHECKSUM: u8 = 4;
    pub(super) const LIST: u8 = 5;
}
/// DS_Command.
mod command {
    pub(super) const UPLOAD_START: u8 = 1;
    pub(super) const UPLOAD_END: u8 = 2;
    pub(super) const DOWNLOAD_START: u8 = 3;
    pub(super) const DOWNLOAD_END: u8 = 4;
}
/// State_Property: the Device asks for an upload.
const UPLOAD_FLAG: u8 = 0x80;
/// Validation&Backup with backup and restore, and with restore alone (10.3.4).
const BACKUP_RESTORE: u8 = 3;
const RESTORE: u8 = 4;
/// ErrorType of a Device that does not take the set (iec2022 Table 13 T8).
const NOT_BACK_TO_BOX: u16 = 0x8022;

/// A request to the Device: Index, Subindex, value to write.
pub type Request = (u16, u8, Option<Vec<u8>>);

/// What comes next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Next {
    /// This request, whose answer is waited for.
    Ask(Request),
    /// DS_Ready.
    Ready,
    /// DS_Fault.
    Fault,
}

/// What is kept of a Device.
#[derive(Clone, Debug)]
struct Set {
    ids: (u16, u32),
    checksum: Vec<u8>,
    records: Vec<(u16, u8, Vec<u8>)>,
}

/// The request whose answer is waited for.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Asked {
    Nothing,
    State,
    Checksum,
    UploadStart,
    List,
    Record(usize),
    NewChecksum,
    UploadEnd,
    DownloadStart,
    Write(usize),
    DownloadEnd,
}

/// Data Storage of one port.
#[derive(Clone, Debug)]
pub struct DataStorage {
    set: Option<Set>,
    /// What an upload has brought so far.
    coming: Set,
    /// Entries of the Index_List that the upload is about.
    list: Vec<(u16, u8)>,
    asked: Asked,
    level: u8,
    mutant: Option<MasterMutant>,
}

impl DataStorage {
    /// Data Storage without a set.
    pub const fn new(mutant: Option<MasterMutant>) -> DataStorage {
        let coming = Set { ids: (0, 0), checksum: Vec::new(), records: Vec::new() };
        DataStorage { set: None, coming, list: Vec::new(), asked: Asked::Nothing, level: 0, mutant }
    }

    /// The level of a configuration; 0 where nothing is copied: without backup, and while FSP_TechParCRC is 0.
    fn level(&self, config: &PortConfig) -> u8 {
        let commissioning =
            config.protocol.tech_par_crc == 0 && self.mutant != Some(MasterMutant::DataStorageInCommissioning);
        match config.validation {
            _ if !config.is_safety() || commissioning => 0,
            level @ (BACKUP_RESTORE | RESTORE) => level,
            _ if self.mutant == Some(MasterMutant::DataStorageWithoutBackup) => BACKUP_RESTORE,
            _ => 0,
        }
    }

    /// The port is configured: a set without backup, for commissioning or of another Device is kept no more.
    pub fn configure(&mut self, config: &PortConfig) {
        let ids = (config.vendor_id, config.device_id);
        let other = |set: &Set| set.ids != ids && self.mutant != Some(MasterMutant::SetKeptForOtherDevice);
        if self.level(config) == 0 || self.set.as_ref().is_some_and(other) {
            self.set = None;
        }
    }

    /// The Device is in PREOPERATE.
    pub fn start(&mut self, config: &PortConfig) -> Next {
        self.level = self.level(config);
        self.coming = Set { ids: (config.vendor_id, config.device_id), checksum: Vec::new(), records: Vec::new() };
        match (self.level, &self.set) {
            (BACKUP_RESTORE, None) => self.command(command::UPLOAD_START, Asked::UploadStart),
            (BACKUP_RESTORE | RESTORE, Some(_)) => self.read(subindex::STATE, Asked::State),
            _ => Next::Ready,
        }
    }

    fn read(&mut self, subindex: u8, asked: Asked) -> Next {
        self.asked = asked;
        Next::Ask((INDEX_DATA_STORAGE, subindex, None))
    }

    fn command(&mut self, command: u8, asked: Asked) -> Next {
        if asked == Asked::UploadStart && self.mutant == Some(MasterMutant::NothingUploaded) {
            return Next::Ready;
        }
        self.asked = asked;
        Next::Ask((INDEX_DATA_STORAGE, subindex::COMMAND, Some(vec![command])))
    }

    /// The record of the list to be read next, or the checksum behind the last one.
    fn record(&mut self, number: usize) -> Next {
        match self.list.get(number) {
            Some((index, subindex)) => {
                self.asked = Asked::Record(number);
                Next::Ask((*index, *subindex, None))
            }
            None => self.read(subindex::CHECKSUM, Asked::NewChecksum),
        }
    }

    /// The record of the set to be written next, or the end of the download behind the last one.
    fn write(&mut self, number: usize) -> Next {
        match self.set.as_ref().and_then(|set| set.records.get(number)) {
            Some((index, subindex, data)) => {
                self.asked = Asked::Write(number);
                Next::Ask((*index, *subindex, Some(data.clone())))
            }
            None => self.command(command::DOWNLOAD_END, Asked::DownloadEnd),
        }
    }

    /// The Device has answered.
    pub fn answered(&mut self, response: &Response) -> Next {
        let asked = std::mem::replace(&mut self.asked, Asked::Nothing);
        let upload_at = if self.mutant == Some(MasterMutant::UploadAtRestore) { RESTORE } else { BACKUP_RESTORE };
        match (asked, response) {
            (Asked::DownloadStart, Response::Refused(NOT_BACK_TO_BOX)) => Next::Ready,
            (_, Response::Refused(_)) if self.mutant == Some(MasterMutant::DataStorageFaultIgnored) => Next::Ready,
            (_, Response::Refused(_)) => Next::Fault,
            (Asked::State, Response::Value(state)) => {
                let flag = state.first().is_some_and(|state| state & UPLOAD_FLAG != 0);
                if flag && self.level <= upload_at {
                    self.command(command::UPLOAD_START, Asked::UploadStart)
                } else {
                    self.read(subindex::CHECKSUM, Asked::Checksum)
                }
            }
            (Asked::Checksum, Response::Value(checksum)) => {
                let same = self.set.as_ref().is_some_and(|set| set.checksum == *checksum);
                if same || self.mutant == Some(MasterMutant::NothingDownloaded) {
                    Next::Ready
                } else {
                    self.command(command::DOWNLOAD_START, Asked::DownloadStart)
                }
            }
            (Asked::UploadStart, Response::Written) => self.read(subindex::LIST, Asked::List),
            (Asked::List, Response::Value(list)) => {
                self.list = entries(list);
                self.record(0)
            }
            (Asked::Record(number), Response::Value(data)) => {
                if let Some((index, subindex)) = self.list.get(number) {
                    self.coming.records.push((*index, *subindex, data.clone()));
                }
                self.record(number + 1)
            }
            (Asked::NewChecksum, Response::Value(checksum)) => {
                self.coming.checksum = checksum.clone();
                self.command(command::UPLOAD_END, Asked::UploadEnd)
            }
            (Asked::UploadEnd, Response::Written) => {
                self.set = Some(self.coming.clone());
                Next::Ready
            }
            (Asked::DownloadStart, Response::Written) => self.write(0),
            (Asked::Write(number), Response::Written) => self.write(number + 1),
            (Asked::DownloadEnd, Response::Written) => Next::Ready,
            _ => Next::Fault,
        }
    }
}

/// The entries of an Index_List: Index and Subindex, up to Index 0 or one that leads to another list.
fn entries(list: &[u8]) -> Vec<(u16, u8)> {
    let entry = |octets: &[u8]| match octets {
        [high, low, subindex] => Some((u16::from_be_bytes([*high, *low]), *subindex)),
        _ => None,
    };
    let real = |(index, _): &(u16, u8)| *index != 0 && *index != 0xFFFF;
    list.chunks(3).map_while(entry).take_while(real).collect()
}

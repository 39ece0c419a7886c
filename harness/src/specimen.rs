//! What the virtual FS-Device on a port remembers: its FSP records, one technology parameter, and Data Storage over them
//! (Index 0x0003 of the base standard).

use crate::case::model::{Specimen, Transfer};
use crate::link::Open;
use crate::oracle::Setup;
use crate::portconfig::verify_record;
use crate::profile::Profile;
use fsct_adapters::Response;
use fsct_protocol::Edition;
use fsct_protocol::fsp::{Authenticity, INDEX_AUTHENTICITY, INDEX_PROTOCOL, INDEX_VERIFY, Protocol};

/// Index of Data Storage.
pub const INDEX_DATA_STORAGE: u16 = 0x0003;
/// DS_Command: start and end of an upload.
pub const UPLOAD: [u8; 2] = [1, 2];
/// DS_Command: start and end of a download.
pub const DOWNLOAD: [u8; 2] = [3, 4];
/// DS_Command: what is under way ends without effect.
pub const BREAK: u8 = 5;
/// Index of the technology parameter: the first one free for the maker.
const INDEX_TECHNOLOGY: u16 = 0x0040;
/// What Data Storage is about, in the order of the Index_List.
const LIST: [u16; 3] = [INDEX_AUTHENTICITY, INDEX_PROTOCOL, INDEX_TECHNOLOGY];
/// Refusal of the set in an FS-Device that is in use (iec2022 Table 13 T8).
const TEMPORARILY_NOT_AVAILABLE: u16 = 0x8022;
/// ErrorTypes of the base standard.
const APPLICATION_ERROR: u16 = 0x8000;
const SUBINDEX_NOT_AVAILABLE: u16 = 0x8012;
const LENGTH_INVALID: u16 = 0x8033;
/// Requests remembered of one step.
const MOST: usize = 1_000;

/// A request of the FS-Master, as far as the order matters.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Asked {
    UploadStart,
    UploadEnd,
    /// Whether the set was let in.
    DownloadStart(bool),
    DownloadEnd,
    Read(u16),
    Written(u16),
    Record,
}

/// The state of Data Storage in State_Property.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum State {
    Inactive,
    Upload,
    Download,
}

/// The memory of one specimen.
#[derive(Clone, Debug)]
pub struct Memory {
    edition: Edition,
    specimen: Specimen,
    /// Values of [`LIST`].
    values: [Vec<u8>; 3],
    /// The same when it was connected.
    before: [Vec<u8>; 3],
    state: State,
    flag: bool,
    asked: Vec<Asked>,
}

impl Memory {
    /// A specimen for a port with this FSPortConfigList.
    pub fn new(specimen: Specimen, setup: &Setup, profile: &Profile, configured: &[u8]) -> Memory {
        let record = verify_record(setup.edition, configured);
        let (own, protocol) = record.split_at_checked(Authenticity::OCTETS).unwrap_or_default();
        let mut authenticity = Authenticity::fields(own).unwrap_or_default();
        let mut protocol = Protocol::fields(protocol).unwrap_or_default();
        let mut technology = vec![0x12, 0x34];
        match specimen {
            Specimen::Own | Specimen::Broken => {}
            Specimen::Marked => technology = vec![0x56, 0x78],
            Specimen::Factory => {
                authenticity = Authenticity::default();
                protocol.tech_par_crc = profile.tech_par_crc.max(1);
                technology = vec![0, 0];
            }
            Specimen::Used => authenticity.authenticity_1 ^= 1,
            Specimen::Moved => authenticity.port = if authenticity.port == 1 { 2 } else { 1 },
        }
        let values = [authenticity.to_octets().to_vec(), protocol.to_octets().to_vec(), technology];
        let before = values.clone();
        let flag = specimen == Specimen::Marked;
        Memory { edition: setup.edition, specimen, values, before, state: State::Inactive, flag, asked: Vec::new() }
    }

    /// A step begins.
    pub fn begin(&mut self) {
        self.asked.clear();
    }

    fn remember(&mut self, asked: Asked) {
        if self.asked.len() < MOST {
            self.asked.push(asked);
        }
    }

    /// Authenticity and port as they come from the factory: only then a set is let in (11.7.6, Annex G).
    fn is_back_to_box(&self) -> bool {
        Authenticity::fields(&self.values[0]).is_ok_and(|own| own == Authenticity::default())
    }

    /// The answer to a request.
    pub fn answer(&mut self, open: &Open) -> Response {
        let place = LIST.iter().position(|index| *index == open.index && open.subindex == 0);
        match (open.index, &open.data, place) {
            (INDEX_DATA_STORAGE, Some(data), _) if open.subindex == 1 => self.command(data),
            (INDEX_DATA_STORAGE, None, _) => self.property(open.subindex),
            (INDEX_VERIFY, Some(_), _) => {
                self.remember(Asked::Record);
                Response::Written
            }
            (index, None, Some(place)) => {
                self.remember(Asked::Read(index));
                Response::Value(self.values[place].clone())
            }
            (index, Some(data), Some(place)) => {
                if data.len() != self.values[place].len() {
                    return Response::Refused(LENGTH_INVALID);
                }
                self.remember(Asked::Written(index));
                // In v1.1 a set that does not fit is ignored without a word.
                if self.state != State::Download || self.is_let_in() {
                    self.values[place].clone_from(data);
                }
                Response::Written
            }
            (_, Some(_), None) => Response::Written,
            (_, None, None) => Response::Value(vec![0; 2]),
        }
    }

    /// Whether the download that goes on began back to box; its own authenticity record ends that.
    fn is_let_in(&self) -> bool {
        self.asked.iter().rev().find_map(|asked| match asked {
            Asked::DownloadStart(let_in) => Some(*let_in),
            _ => None,
        }) == Some(true)
    }

    fn command(&mut self, data: &[u8]) -> Response {
        if self.specimen == Specimen::Broken {
            return Response::Refused(APPLICATION_ERROR);
        }
        match data {
            [code] if *code == UPLOAD[0] => {
                self.state = State::Upload;
                self.remember(Asked::UploadStart);
            }
            [code] if *code == UPLOAD[1] => {
                (self.state, self.flag) = (State::Inactive, false);
                self.remember(Asked::UploadEnd);
            }
            [code] if *code == DOWNLOAD[0] => {
                let let_in = self.is_back_to_box();
                self.remember(Asked::DownloadStart(let_in));
                if !let_in && self.edition == Edition::Iec2022 {
                    return Response::Refused(TEMPORARILY_NOT_AVAILABLE);
                }
                self.state = State::Download;
            }
            [code] if *code == DOWNLOAD[1] => {
                (self.state, self.flag) = (State::Inactive, false);
                self.remember(Asked::DownloadEnd);
            }
            [BREAK] => self.state = State::Inactive,
            _ => return Response::Refused(APPLICATION_ERROR),
        }
        Response::Written
    }

    fn property(&self, subindex: u8) -> Response {
        let octets: usize = self.values.iter().map(Vec::len).sum();
        match subindex {
            2 => Response::Value(vec![(self.state as u8) << 1 | u8::from(self.flag) << 7]),
            3 => Response::Value((octets as u32).to_be_bytes().to_vec()),
            4 => {
                let mix = |sum: u32, octet: &u8| (sum ^ u32::from(*octet)).wrapping_mul(0x0100_0193);
                Response::Value(self.values.iter().flatten().fold(0x811C_9DC5, mix).to_be_bytes().to_vec())
            }
            5 => {
                let entries = LIST.iter().flat_map(|index| [index.to_be_bytes()[0], index.to_be_bytes()[1], 0]);
                Response::Value(entries.chain([0, 0]).collect())
            }
            _ => Response::Refused(SUBINDEX_NOT_AVAILABLE),
        }
    }

    /// What Data Storage has come to in this step; `None`: neither end of it nor what the order says.
    pub fn transfer(&self) -> Option<Transfer> {
        let start = |asked: &&Asked| matches!(asked, Asked::UploadStart | Asked::DownloadStart(_));
        let Some(from) = self.asked.iter().rposition(|asked| start(&asked)) else { return Some(Transfer::None) };
        let (before, after) = self.asked.split_at(from);
        let end = match after.first() {
            Some(Asked::UploadStart) => Asked::UploadEnd,
            Some(Asked::DownloadStart(false)) if self.edition == Edition::Iec2022 => Asked::DownloadStart(false),
            _ => Asked::DownloadEnd,
        };
        let upto = after.iter().position(|asked| *asked == end)?;
        let within = after.get(..upto).unwrap_or_default();
        let all = |kind: fn(u16) -> Asked| LIST.iter().all(|index| within.contains(&kind(*index)));
        if before.contains(&Asked::Record) || within.contains(&Asked::Record) {
            return None;
        }
        match after.first() {
            Some(Asked::UploadStart) => all(Asked::Read).then_some(Transfer::Upload),
            Some(Asked::DownloadStart(false)) => Some(Transfer::Refused),
            _ => all(Asked::Written).then_some(Transfer::Download),
        }
    }

    /// The requests behind [`Memory::transfer`], in words.
    pub fn told(&self) -> String {
        let word = |asked: &Asked| match asked {
            Asked::UploadStart => "DS_UploadStart".to_owned(),
            Asked::UploadEnd => "DS_UploadEnd".to_owned(),
            Asked::DownloadStart(true) => "DS_DownloadStart".to_owned(),
            Asked::DownloadStart(false) => "DS_DownloadStart (not let in)".to_owned(),
            Asked::DownloadEnd => "DS_DownloadEnd".to_owned(),
            Asked::Read(index) => format!("read 0x{index:04X}"),
            Asked::Written(index) => format!("write 0x{index:04X}"),
            Asked::Record => "verify record".to_owned(),
        };
        match self.asked.as_slice() {
            [] | [Asked::Record] => "no request of Data Storage".to_owned(),
            asked => asked.iter().map(word).collect::<Vec<_>>().join(", "),
        }
    }

    /// Authenticity and protocol record it holds.
    pub fn records(&self) -> Vec<u8> {
        [self.values[0].as_slice(), &self.values[1]].concat()
    }

    /// The same when it was connected.
    pub fn records_before(&self) -> Vec<u8> {
        [self.before[0].as_slice(), &self.before[1]].concat()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rstest::rstest;

    fn memory(edition: Edition, authenticity_1: u32) -> Memory {
        let port = u8::from(authenticity_1 != 0);
        let authenticity = Authenticity { authenticity_1, authenticity_2: 0, port };
        let values = [authenticity.to_octets().to_vec(), vec![0; Protocol::OCTETS], vec![0, 0]];
        Memory {
            edition,
            specimen: Specimen::Own,
            before: values.clone(),
            values,
            state: State::Inactive,
            flag: true,
            asked: Vec::new(),
        }
    }

    fn ask(memory: &mut Memory, index: u16, subindex: u8, data: Option<&[u8]>) -> Response {
        memory.answer(&Open { index, subindex, data: data.map(<[u8]>::to_vec) })
    }

    fn download(memory: &mut Memory) -> Response {
        let start = ask(memory, 0x0003, 1, Some(&[3]));
        if start == Response::Written {
            let own = Authenticity { authenticity_1: 7, authenticity_2: 0, port: 1 };
            ask(memory, 0x4200, 0, Some(&own.to_octets()));
            ask(memory, 0x4201, 0, Some(&[1; Protocol::OCTETS]));
            ask(memory, 0x0040, 0, Some(&[2, 2]));
            ask(memory, 0x0003, 1, Some(&[4]));
        }
        start
    }

    #[rstest]
    #[case::v1_1(Edition::V1_1)]
    #[case::iec2022(Edition::Iec2022)]
    fn one_from_the_factory_adopts_the_whole_set(#[case] edition: Edition) {
        let mut memory = memory(edition, 0);
        assert_eq!(download(&mut memory), Response::Written);
        assert_eq!(memory.transfer(), Some(Transfer::Download));
        assert_eq!((&memory.values[1], &memory.values[2]), (&vec![1; Protocol::OCTETS], &vec![2, 2]));
        assert_ne!(memory.records(), memory.records_before());
    }

    #[rstest]
    #[case::v1_1_ignores_it(Edition::V1_1, Response::Written)]
    #[case::iec2022_refuses_it(Edition::Iec2022, Response::Refused(0x8022))]
    fn one_in_use_keeps_its_values(#[case] edition: Edition, #[case] answer: Response) {
        let mut memory = memory(edition, 9);
        assert_eq!(download(&mut memory), answer);
        assert_eq!(memory.transfer(), Some(Transfer::Refused));
        assert_eq!(memory.records(), memory.records_before());
    }

    #[test]
    fn an_upload_has_all_records_and_its_end_before_the_verify_record() {
        let mut memory = memory(Edition::Iec2022, 9);
        assert_eq!(memory.transfer(), Some(Transfer::None));
        ask(&mut memory, 0x0003, 1, Some(&[1]));
        assert_eq!(ask(&mut memory, 0x0003, 2, None), Response::Value(vec![0x82]));
        ask(&mut memory, 0x4200, 0, None);
        ask(&mut memory, 0x4201, 0, None);
        ask(&mut memory, 0x0003, 1, Some(&[2]));
        assert_eq!(memory.transfer(), None, "a record is missing: {}", memory.told());
        memory.begin();
        ask(&mut memory, 0x0003, 1, Some(&[1]));
        LIST.iter().for_each(|index| drop(ask(&mut memory, *index, 0, None)));
        assert_eq!(memory.transfer(), None, "it has no end: {}", memory.told());
        ask(&mut memory, 0x0003, 1, Some(&[2]));
        assert_eq!((memory.transfer(), memory.flag), (Some(Transfer::Upload), false));
        memory.asked.insert(0, Asked::Record);
        assert_eq!(memory.transfer(), None, "the verify record came first: {}", memory.told());
    }
}

//! Data Storage of an FS-Device as an FS-Master does it, Index 0x0003 of the base standard, and its technology parameter.

use super::Engine;
use crate::case::model::{Parameterize, Sent, Way};
use crate::parameterize;
use crate::session::{Reply, Stop};
use crate::specimen::{BREAK, DOWNLOAD, INDEX_DATA_STORAGE as INDEX, UPLOAD};
use fsct_adapters::Stimulus;

/// Subindices of DS_Command and Index_List.
const COMMAND: u8 = 1;
const LIST: u8 = 5;
/// Records of a set at the most.
const MOST: usize = 200;

impl Engine<'_, '_> {
    /// Copies the set from the FS-Device, or the set that is kept into it. The answer that ended it stands in the reply: the
    /// first refusal, or what came to DS_UploadEnd and DS_DownloadEnd.
    pub(super) fn copy(&mut self, way: Way) -> Result<(), Stop> {
        let [start, end] = match way {
            Way::Upload => UPLOAD,
            Way::Download => DOWNLOAD,
        };
        let set = match way {
            Way::Upload => Vec::new(),
            Way::Download => self.kept()?,
        };
        if !self.commanded(start)? {
            return Ok(());
        }
        let whole = match way {
            Way::Upload => self.fetched()?,
            Way::Download => self.put(set)?,
        };
        if whole {
            return self.commanded(end).map(drop);
        }
        // As an FS-Master does: what is under way must not stand in the way of the next step.
        let refusal = self.session.reply.clone();
        self.commanded(BREAK)?;
        self.session.reply = refusal;
        Ok(())
    }

    /// Whether every record of the Index_List could be read; they are kept.
    fn fetched(&mut self) -> Result<bool, Stop> {
        let Some(list) = self.told(INDEX, LIST)? else { return Ok(false) };
        let mut set = Vec::new();
        for (index, subindex) in entries(&list).take(MOST) {
            let Some(value) = self.told(index, subindex)? else { return Ok(false) };
            set.push((index, subindex, value));
        }
        self.set = set;
        Ok(true)
    }

    /// Whether every record of the set was taken.
    fn put(&mut self, set: Vec<(u16, u8, Vec<u8>)>) -> Result<bool, Stop> {
        for (index, subindex, data) in set {
            self.acyclic(Stimulus::Write { index, subindex, data })?;
            if self.session.reply != Some(Reply::Written) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The set that was copied last; where none was, which an FS-Device in use may refuse, the armed records of the profile.
    fn kept(&mut self) -> Result<Vec<(u16, u8, Vec<u8>)>, Stop> {
        if !self.set.is_empty() {
            return Ok(self.set.clone());
        }
        let io_struct_crc = self.io_struct_crc()?;
        let asked = Parameterize { record: Sent::None, armed: true, ..Parameterize::default() };
        let records = parameterize::records(self.session.profile, &asked, self.session.setup().mode, io_struct_crc);
        Ok(records.into_iter().map(|(index, data)| (index, 0, data)).collect())
    }

    /// Writes the technology parameter of the profile and reads it back: the reply. A product that does not take it is not the one
    /// of its profile.
    pub(super) fn technology(&mut self, other: bool) -> Result<(), Stop> {
        let Some(technology) = &self.session.profile.technology else {
            return Err(Stop::Unserved("a technology parameter: the profile tells none".to_owned()));
        };
        let data = if other { technology.other.clone() } else { technology.value.clone() };
        let index = technology.index;
        self.acyclic(Stimulus::Write { index, subindex: 0, data })?;
        if self.session.reply != Some(Reply::Written) {
            let replied = self.session.replied();
            return Err(Stop::Unserved(format!("the technology parameter 0x{index:04X} was not taken: {replied}")));
        }
        self.acyclic(Stimulus::Read { index, subindex: 0 })
    }

    fn commanded(&mut self, command: u8) -> Result<bool, Stop> {
        self.acyclic(Stimulus::Write { index: INDEX, subindex: COMMAND, data: vec![command] })?;
        Ok(self.session.reply == Some(Reply::Written))
    }

    fn told(&mut self, index: u16, subindex: u8) -> Result<Option<Vec<u8>>, Stop> {
        self.acyclic(Stimulus::Read { index, subindex })?;
        Ok(match &self.session.reply {
            Some(Reply::Value(value)) => Some(value.clone()),
            _ => None,
        })
    }
}

/// Index and Subindex of each record in an Index_List, up to Index 0 or one that leads to another list.
fn entries(list: &[u8]) -> impl Iterator<Item = (u16, u8)> {
    let entry = |octets: &[u8]| match octets {
        [high, low, subindex] => Some((u16::from_be_bytes([*high, *low]), *subindex)),
        _ => None,
    };
    list.chunks(3).map_while(entry).take_while(|(index, _)| !matches!(index, 0 | 0xFFFF))
}

#[cfg(test)]
mod tests {
    use super::entries;

    #[test]
    fn a_list_ends_at_index_0_or_where_it_leads_on() {
        let of = |list: &[u8]| entries(list).collect::<Vec<_>>();
        assert_eq!(of(&[0x42, 0x00, 0, 0x42, 0x01, 1, 0, 0]), [(0x4200, 0), (0x4201, 1)]);
        assert_eq!(of(&[0x42, 0x00, 0, 0xFF, 0xFF, 0, 0x42, 0x01, 0]), [(0x4200, 0)]);
        assert_eq!(of(&[0x42]), []);
    }
}

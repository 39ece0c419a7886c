//! What an engine does on a port of an FS-Master: configuration, start of a virtual FS-Device, lines and SMI.

use super::Engine;
use crate::case::model::*;
use crate::link::Open;
use crate::portconfig;
use crate::session::Stop;
use crate::specimen::Memory;
use fsct_adapters::{Identity, Line, Mode, Octets, Pco, Response, Service, SmiRequest, SmiService, Stimulus};
use fsct_protocol::Edition;
use fsct_protocol::fsp::{Authenticity, INDEX_AUTHENTICITY, INDEX_PROTOCOL, INDEX_VERIFY};
use fsct_protocol::smi::{FS_MASTER_ACCESS, FS_PORT_CONFIG_LIST, OSSDE};
use fsct_reports::record::{Check, Verdict};

/// Widths of a Ready pulse (Table 7), in nanoseconds.
const READY_PULSE_NS: std::ops::RangeInclusive<u64> = 500_000..=1_000_000;
/// Steps in which a start is looked at, in nanoseconds: coarse while nothing is due, fine around pulses.
const COARSE_NS: u64 = 10_000_000;
const FINE_NS: u64 = 1_000_000;
/// An ErrorType of Data Storage and of a Device that cannot serve now (iec2022 Table 13).
const TEMPORARILY_NOT_AVAILABLE: u16 = 0x8022;
/// How late an OFF of an OSSDe port may show.
const OSSDE_RESPONSE_NS: u64 = 20_000_000;

impl Engine<'_, '_> {
    /// SMI_PortConfiguration. A refusal is for the case to judge; without it the configuration is in force.
    pub(super) fn configure(&mut self, configure: &Configure) -> Result<(), Stop> {
        let setup = self.session.setup();
        let edition = setup.edition;
        let list = portconfig::list(setup, self.session.profile, configure);
        self.nsr = configure.nsr;
        if !self.session.serves(Pco::Acyclic) {
            self.session.link_mut().configure(list, configure.starts);
            return Ok(());
        }
        let request = self.smi_request(SmiService::PortConfiguration, list.clone());
        // What the FS-Master does with it happens inside the request: the link has to know it before.
        let before = (self.session.link().configured.clone(), self.session.link().starts);
        self.session.link_mut().configure(list.clone(), configure.starts);
        self.session.request(request)?;
        let accepted = matches!(&self.session.smi, Some((_, Some(result))) if result.positive);
        let is_ossde = portconfig::field(edition, &list, "PortMode") == u32::from(OSSDE);
        let levels = self.session.link().levels;
        let now = self.session.now;
        let link = self.session.link_mut();
        if !accepted {
            (link.configured, link.starts) = before;
        } else if is_ossde {
            link.enter_ossde(edition, OSSDE_RESPONSE_NS, now, levels);
        } else {
            link.leave_ossde();
        }
        Ok(())
    }

    fn smi_request(&mut self, service: SmiService, octets: Vec<u8>) -> SmiRequest {
        let edition = self.session.setup().edition;
        self.client = self.client.wrapping_add(1);
        let expected = match (edition, blocks(service).1) {
            (Edition::Iec2022, Some(block)) => block.id(edition).unwrap_or(0),
            _ => 0,
        };
        SmiRequest { service, port: self.session.link().port, client_id: self.client, expected, octets }
    }

    /// A request as the case asks for it.
    pub(super) fn smi(&mut self, smi: &Smi) -> Result<(), Stop> {
        let edition = self.session.setup().edition;
        let block = blocks(smi.service).0;
        // In v1.1 a read has no ArgBlock, and SMI_FSMasterAccess bare arguments.
        let arguments = edition == Edition::V1_1 && smi.service == SmiService::FsMasterAccess;
        let id = smi.id.or(block.and_then(|block| block.id(edition))).filter(|_| !arguments);
        let mut octets = id.map_or_else(Vec::new, |id| id.to_be_bytes().to_vec());
        match (&smi.octets, block) {
            _ if smi.record.is_some() => octets.extend(smi.record.into_iter().flat_map(|record| self.assigned(record))),
            (Some(own), _) => octets.extend(own),
            (None, _) if arguments => octets = vec![0; 5],
            (None, Some(_)) if smi.service == SmiService::PortConfiguration => {
                let configure = Configure { nsr: self.nsr, ..Configure::default() };
                octets = portconfig::list(self.session.setup(), self.session.profile, &configure);
            }
            (None, Some(block)) => octets.resize(block.length(edition).max(octets.len()), 0),
            (None, None) => {}
        }
        for (name, value) in &smi.set {
            let fields = if smi.service == SmiService::FsMasterAccess { Some(&FS_MASTER_ACCESS) } else { block };
            let Some(field) = fields.and_then(|block| block.field(name)) else { continue };
            let profile = self.session.profile;
            let right = match *name == *"FSMasterPassword" {
                true => profile.password,
                false if *name == *"FSResetMasterPW" => profile.reset_password,
                false => field.value(edition, &octets).unwrap_or(0),
            };
            let value = match value {
                Value::Number(number) => *number,
                Value::Wrong => right ^ 1,
                Value::Profile => right,
            };
            let end = field.offset(edition).map_or(0, |offset| offset + usize::from(field.octets));
            if octets.len() < end {
                octets.resize(end, 0);
            }
            field.put(edition, &mut octets, value);
        }
        if let Some(id) = smi.id
            && let Some(place) = octets.first_chunk_mut::<2>()
        {
            *place = id.to_be_bytes();
        }
        let length = octets.len().saturating_add_signed(smi.longer as isize);
        octets.resize(length, 0);
        let mut request = self.smi_request(smi.service, octets);
        request.port = smi.port.unwrap_or(request.port);
        request.expected = smi.expected.unwrap_or(request.expected);
        self.session.request(request)?;
        // A virtual FS-Device that a case has chosen answers what the service asks it.
        let link = self.session.link();
        match (link.chosen, link.open.clone()) {
            (true, Some(open)) => self.answer(link.port, &open, Answered::Written),
            _ => Ok(()),
        }
    }

    /// Index, Subindex 0 and octets of a record of the profile.
    fn assigned(&self, record: Assigned) -> Vec<u8> {
        let setup = self.session.setup();
        let test = FS_PORT_CONFIG_LIST.field("FSP_TechParCRC").filter(|_| record == Assigned::ProtocolTest);
        let set = test.map(|field| (field, Value::Number(0))).into_iter().collect();
        let list = portconfig::list(setup, self.session.profile, &Configure { set, ..Configure::default() });
        let (authenticity, protocol) =
            portconfig::verify_record(setup.edition, &list).split_at_checked(Authenticity::OCTETS).unwrap_or_default();
        let (index, octets) = match record {
            Assigned::Authenticity => (INDEX_AUTHENTICITY, authenticity),
            Assigned::Protocol | Assigned::ProtocolTest => (INDEX_PROTOCOL, protocol),
        };
        [index.to_be_bytes().as_slice(), &[0], octets].concat()
    }

    /// A virtual FS-Device starts on the port. What was not reached in time fails as an expectation.
    pub(super) fn connect(&mut self, connect: &Connect) -> Result<(), Stop> {
        let deadline = self.session.now + self.nanoseconds(connect.within).unsigned_abs();
        let port = self.session.link().port;
        self.choose(connect.device);
        let mut identity = portconfig::identity(self.session.setup(), self.session.profile, self.nsr);
        identity.vendor_id = connect.vendor_id.unwrap_or(identity.vendor_id);
        identity.device_id = connect.device_id.unwrap_or(identity.device_id);
        self.tester_mut().restart();
        self.plug(port, Some(identity))?;
        let mut pulse_at = None;
        while self.session.now < deadline && !self.reached(connect.until) {
            let link = self.session.link();
            if link.port_power && pulse_at.is_none() && self.session.serves(Pco::Line) {
                pulse_at = Some(self.session.now + self.nanoseconds(connect.after).unsigned_abs());
            }
            if let Some(open) = self.session.link().open.clone() {
                self.answer(port, &open, connect.record)?;
                continue;
            }
            let now = self.session.now;
            match (pulse_at, connect.pulse_us) {
                (Some(at), Some(width))
                    if at != u64::MAX && now >= at && self.session.link().mode == Mode::Inactive =>
                {
                    self.pulse(port, width * 1_000)?;
                    pulse_at = Some(u64::MAX);
                }
                (Some(at), Some(_)) if at != u64::MAX && now < at => self.session.pass((at - now).min(COARSE_NS))?,
                _ => self.session.pass(FINE_NS.min(deadline - now))?,
            }
            // A new supply cycle wants a new pulse.
            if !self.session.link().port_power && pulse_at == Some(u64::MAX) {
                pulse_at = None;
            }
        }
        // A wait before any answer counts from here.
        self.tester_mut().first_copy = self.session.now;
        if connect.until != Until::Time {
            let met = self.reached(connect.until);
            self.checks += 1;
            let expected = match connect.until {
                Until::Power => "L+ on",
                Until::WakeUp => "wake-up",
                Until::Preoperate => "PREOPERATE",
                Until::Record => "the verify record",
                Until::Operate | Until::Time => "OPERATE",
            };
            let link = self.session.link();
            let observed = format!(
                "{} with L+ {}, {} wake-ups, {} verify records",
                link.mode,
                if link.port_power { "on" } else { "off" },
                link.wake_ups,
                link.records.len()
            );
            let clause = "7.2 Table 10, 8 Table 12, 10.4.3.1";
            if !met {
                let verdict = if self.session.slipped { Verdict::Inconclusive } else { Verdict::Fail };
                self.reason(verdict, "start/port", clause, &format!("{expected} in time"), &observed);
            }
            if let Some(record) = self.outcome.steps.last_mut() {
                record.checks.push(Check { key: "port".to_owned(), expected: expected.to_owned(), observed, met });
            }
        }
        if !self.session.serves(Pco::Acyclic) && self.session.link().mode == Mode::Inactive {
            // A bench that shows nothing of the start: the SCL may run from here on.
            let now = self.session.now;
            self.session.link_mut().oracle.parameterized(now);
        }
        Ok(())
    }

    fn reached(&self, until: Until) -> bool {
        let link = self.session.link();
        match until {
            Until::Power => link.port_power,
            Until::WakeUp => link.wake_ups > 0,
            Until::Preoperate => matches!(link.mode, Mode::Preoperate | Mode::Operate),
            Until::Record => !link.records.is_empty(),
            Until::Operate => link.mode == Mode::Operate,
            Until::Time => false,
        }
    }

    fn pulse(&mut self, port: u8, width_ns: u64) -> Result<(), Stop> {
        self.session.act(Stimulus::Drive { port, line: Line::Cq, level: true })?;
        self.session.pass(width_ns)?;
        self.session.act(Stimulus::Drive { port, line: Line::Cq, level: false })?;
        // On a real clock the tester may hold the line longer than it means to: a pulse that may be none is nobody's fault.
        let off = 2 * self.session.description.clock.uncertainty_ns;
        let sure =
            |width: u64| READY_PULSE_NS.contains(&width.saturating_sub(off)) && READY_PULSE_NS.contains(&(width + off));
        let given = self.session.link().lines.pulse();
        self.session.slipped |= READY_PULSE_NS.contains(&width_ns) && given.is_some_and(|width| !sure(width));
        self.session.pass(FINE_NS)
    }

    /// The virtual FS-Device that a case asks for, or else one as the port is configured.
    fn choose(&mut self, device: Option<Specimen>) {
        if device.is_none() && self.session.link().chosen {
            return;
        }
        let link = self.session.link();
        let specimen = device.unwrap_or(Specimen::Own);
        let memory = Memory::new(specimen, self.session.setup(), self.session.profile, &link.configured);
        let link = self.session.link_mut();
        (link.memory, link.chosen) = (Some(memory), device.is_some());
    }

    fn answer(&mut self, port: u8, open: &Open, record: Answered) -> Result<(), Stop> {
        self.session.link_mut().open = None;
        let known = self.session.link_mut().memory.as_mut().map(|memory| memory.answer(open));
        let response = match (record, known) {
            (Answered::Silent, _) if open.index == INDEX_VERIFY => return self.session.pass(FINE_NS),
            (Answered::Refused, _) if open.index == INDEX_VERIFY => Response::Refused(TEMPORARILY_NOT_AVAILABLE),
            (_, Some(response)) => response,
            (_, None) => Response::Refused(TEMPORARILY_NOT_AVAILABLE),
        };
        self.session.act(Stimulus::Respond { port, response })
    }

    /// The Device is gone.
    pub(super) fn unplug(&mut self) -> Result<(), Stop> {
        let port = self.session.link().port;
        self.plug(port, None)
    }

    fn plug(&mut self, port: u8, device: Option<Identity>) -> Result<(), Stop> {
        let link = self.session.link_mut();
        if link.plugged.replace(device) == Some(device) {
            return Ok(());
        }
        self.session.act(Stimulus::Plug { port, device })
    }

    /// Levels on the lines.
    pub(super) fn drive(&mut self, levels: &[(Line, bool)]) -> Result<(), Stop> {
        let port = self.session.link().port;
        let now = self.session.now;
        let link = self.session.link_mut();
        for (line, level) in levels {
            match line {
                Line::Iq => link.levels.1 = *level,
                _ => link.levels.0 = *level,
            }
        }
        let (cq, iq) = link.levels;
        if let Some(ossde) = &mut link.ossde {
            ossde.lines(now, cq, iq);
        }
        for (line, level) in levels {
            self.session.act(Stimulus::Drive { port, line: *line, level: *level })?;
        }
        Ok(())
    }

    /// The authenticity of the profile.
    pub(super) fn own_authenticity(&self) -> Octets {
        let profile = self.session.profile;
        let own = [profile.authenticity_1.to_be_bytes(), profile.authenticity_2.to_be_bytes()].concat();
        fscp_authenticity(&own)
    }

    /// The start of a port of an FS-Master as its profile says: configuration and start of a virtual FS-Device.
    pub(super) fn bring_up(&mut self) -> Result<(), Stop> {
        if self.session.serves(Pco::App) {
            let own = self.own_authenticity();
            self.session.set(Service::FscpAuthenticity, own)?;
        }
        self.configure(&Configure { starts: Some(true), ..Configure::default() })?;
        let ms = |ms| Duration { ms, ..Duration::default() };
        self.connect(&Connect {
            pulse_us: Some(750),
            after: ms(10),
            record: Answered::Written,
            device: Some(Specimen::Own),
            vendor_id: None,
            device_id: None,
            until: Until::Operate,
            within: ms(25_000),
        })
    }

    /// Turns to a port; the one that is left goes on with a conformant FS-Device if its SCL runs.
    pub(super) fn turn_to(&mut self, port: u8) -> Result<(), Stop> {
        if self.session.link().port == port {
            return Ok(());
        }
        let answered = self.tester().answered;
        let (now, count) = (self.session.now, self.session.links.len());
        let link = self.session.link_mut();
        if let (Some(answered), Mode::Operate) = (answered, link.mode) {
            let setup = link.oracle.setup();
            let pattern: Vec<u8> = (1..).take(setup.pd_in).collect();
            let pdin = fsct_protocol::spdu::Pd::new(&pattern).unwrap_or(fsct_protocol::spdu::Pd::safe(setup.pd_in));
            link.keeper = Some(crate::keeper::Keeper::regular(link.oracle.setup(), pdin, answered, now));
        }
        if !self.session.turn_to(port) {
            return Err(Stop::Unserved(format!("port {port}: it has {count}")));
        }
        if let Some(keeper) = self.session.link_mut().keeper.take() {
            self.tester_mut().follow(&keeper, now);
        }
        Ok(())
    }
}

/// The whole DUT is told the authenticity of the upper-level system: two parts of four octets.
pub(super) fn fscp_authenticity(octets: &[u8]) -> Octets {
    let mut value = [0; 8];
    value.iter_mut().zip(octets).for_each(|(octet, given)| *octet = *given);
    Octets::new(&value).unwrap_or_default()
}

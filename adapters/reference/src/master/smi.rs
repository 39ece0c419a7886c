//! The SMI services of the reference FS-Master: requests checked in the stated order, results with their ArgBlocks (10.2).

use super::blocks::{self, PortConfig, id};
use super::{FsMaster, MasterMutant};
use crate::device::Sink;
use fsct_adapters::smi::{error_info, job_error};
use fsct_adapters::{Mode, Seen, SmiRequest, SmiResult, SmiService};
use fsct_protocol::Edition;

/// What a service comes to: the ArgBlock of a Result(+), or the reason of a Result(-).
type Outcome = Result<Vec<u8>, Refusal>;

/// Why a service is refused, in the order in which causes count.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Refusal {
    PortNumInvalid,
    ArgBlockNotSupported,
    ArgBlockLengthInvalid,
    ArgBlockInconsistent,
    DeviceNotInOperate,
    DeviceNotAccessible,
    ServiceNotSupported,
    ServiceTempUnavailable,
    /// The result would have to wait for the Device, which the contract does not provide for.
    WaitsForDevice,
}

impl Refusal {
    fn number(self, edition: Edition) -> u16 {
        match (edition, self) {
            (Edition::V1_1, Refusal::DeviceNotInOperate | Refusal::DeviceNotAccessible) => error_info::NO_COM,
            (
                Edition::V1_1,
                Refusal::ServiceNotSupported | Refusal::ServiceTempUnavailable | Refusal::WaitsForDevice,
            ) => error_info::STATE_CONFLICT,
            (Edition::V1_1, _) => error_info::OUT_OF_RANGE,
            (_, Refusal::PortNumInvalid) => job_error::PORT_NUM_INVALID,
            (_, Refusal::ArgBlockNotSupported) => job_error::ARGBLOCK_NOT_SUPPORTED,
            (_, Refusal::ArgBlockLengthInvalid) => job_error::ARGBLOCK_LENGTH_INVALID,
            (_, Refusal::ArgBlockInconsistent) => job_error::ARGBLOCK_INCONSISTENT,
            (_, Refusal::DeviceNotInOperate) => job_error::DEVICE_NOT_IN_OPERATE,
            (_, Refusal::DeviceNotAccessible) => job_error::DEVICE_NOT_ACCESSIBLE,
            (_, Refusal::ServiceNotSupported) => job_error::SERVICE_NOT_SUPPORTED,
            (_, Refusal::ServiceTempUnavailable | Refusal::WaitsForDevice) => job_error::SERVICE_TEMP_UNAVAILABLE,
        }
    }
}

/// The blocks of a service: the request's, the result's, and the octets of the request (least and most).
struct Shape {
    request: u16,
    result: u16,
    octets: (usize, usize),
}

fn shape(edition: Edition, service: SmiService) -> Shape {
    let of = |v1_1, iec2022| id::of(edition, v1_1, iec2022);
    let (request, result, octets) = match service {
        SmiService::MasterIdentification => (id::VOID, of(0x0000, 0x0001), (2, 2)),
        SmiService::FsMasterAccess => (of(id::VOID, 0x0100), of(0x0001, id::FSCP_AUTHENTICITY), (11, 11)),
        SmiService::PortConfiguration => {
            let octets = blocks::config_octets(edition);
            (of(0x8001, 0x8100), id::VOID, (octets, octets))
        }
        SmiService::ReadbackPortConfiguration => (id::VOID, of(0x8001, 0x8100), (2, 2)),
        SmiService::PortStatus => (id::VOID, of(0x9001, 0x9100), (2, 2)),
        SmiService::DsToParServ => (id::VOID, 0x7000, (2, 2)),
        SmiService::ParServToDs => (0x7000, id::VOID, (2, 1 << 11)),
        SmiService::DeviceWrite => (0x3000, id::VOID, (6, 237)),
        SmiService::DeviceRead => (0x3001, 0x3000, (5, 5)),
        SmiService::PortPowerOffOn => (of(0x7002, 0x7003), id::VOID, (5, 5)),
        SmiService::PdIn => (id::VOID, 0x1001, (2, 2)),
        SmiService::PdOut => (0x1002, id::VOID, (2, 34)),
        SmiService::PdInOut => (id::VOID, 0x1003, (2, 2)),
        SmiService::SpduIn => (id::VOID, of(0x1004, 0x1101), (2, 2)),
        SmiService::SpduOut => (of(0x1005, 0x1102), id::VOID, (2, 34)),
        SmiService::FsPdInOut => (id::VOID, id::FS_PD_IN_OUT, (2, 2)),
        SmiService::PdInIq => (id::VOID, 0x1FFE, (2, 2)),
        SmiService::PdOutIq => (0x1FFF, id::VOID, (3, 3)),
    };
    Shape { request, result, octets }
}

impl FsMaster {
    /// Carries out a service and reports its result.
    pub(super) fn smi(&mut self, request: &SmiRequest, seen: &mut Sink<'_>) {
        let edition = self.variant.edition;
        let shape = self.shape(request.service);
        let outcome = self.checked(request, &shape).and_then(|()| self.serve(request, &shape, seen));
        if outcome == Err(Refusal::WaitsForDevice) {
            return seen.push(Seen::Unsupported);
        }
        let positive = outcome.is_ok();
        let octets = match (outcome, edition) {
            (Ok(block), _) => block,
            (Err(refusal), Edition::V1_1) => self.number(refusal).to_be_bytes().to_vec(),
            (Err(refusal), Edition::Iec2022) => {
                [id::JOB_ERROR, request.expected, self.number(refusal)].map(u16::to_be_bytes).concat()
            }
        };
        let named = request.octets.first_chunk().map_or(shape.request, |id| u16::from_be_bytes(*id));
        let (mut reference, mut length) = match edition {
            Edition::V1_1 => (0, if positive { octets.len() as u16 } else { 0 }),
            Edition::Iec2022 => (named, octets.len() as u16),
        };
        let (mut port, mut client_id) = (request.port, request.client_id);
        match self.options.mutant {
            Some(MasterMutant::RefArgBlockIdMissing) => reference = 0,
            Some(MasterMutant::ArgBlockLengthWithoutId) => length = length.saturating_sub(2),
            Some(MasterMutant::ResultOfPort1) => port = 1,
            Some(MasterMutant::ClientIdNotReturned) => client_id = 0,
            _ => {}
        }
        seen.push(Seen::Smi(Box::new(SmiResult { port, client_id, positive, reference, length, octets })));
    }

    fn shape(&self, service: SmiService) -> Shape {
        let right = shape(self.variant.edition, service);
        let other = || match self.variant.edition {
            Edition::V1_1 => shape(Edition::Iec2022, service),
            Edition::Iec2022 => shape(Edition::V1_1, service),
        };
        match (self.options.mutant, service) {
            (Some(MasterMutant::PowerOffOnOfOtherEdition), SmiService::PortPowerOffOn) => other(),
            (Some(MasterMutant::ConfigLengthOfOtherEdition), SmiService::PortConfiguration) => {
                Shape { octets: other().octets, ..right }
            }
            _ => right,
        }
    }

    fn is(&self, mutant: MasterMutant) -> bool {
        self.options.mutant == Some(mutant)
    }

    /// ErrorInfo or JobError.
    fn number(&self, refusal: Refusal) -> u16 {
        match (self.variant.edition, refusal) {
            (Edition::Iec2022, Refusal::PortNumInvalid) if self.is(MasterMutant::WrongPortToldOtherwise) => {
                job_error::ARGBLOCK_INCONSISTENT
            }
            (Edition::V1_1, Refusal::DeviceNotInOperate) if self.is(MasterMutant::NoComToldOtherwise) => {
                error_info::OUT_OF_RANGE
            }
            (Edition::V1_1, refusal) if self.is(MasterMutant::ErrorInfoOfIec2022) => refusal.number(Edition::Iec2022),
            (edition, refusal) => refusal.number(edition),
        }
    }

    /// Port, ArgBlockID, length and ExpArgBlockID, in this order.
    fn checked(&self, request: &SmiRequest, shape: &Shape) -> Result<(), Refusal> {
        let edition = self.variant.edition;
        let whole = matches!(request.service, SmiService::MasterIdentification | SmiService::FsMasterAccess);
        let exists = match request.port {
            0 => whole,
            number => usize::from(number) <= self.ports.len(),
        };
        if !exists {
            return Err(Refusal::PortNumInvalid);
        }
        let octets = &request.octets;
        if edition == Edition::V1_1 {
            // Reads have no block; SMI_FSMasterAccess has UserRole and FSMasterPassword.
            return match (request.service, shape.request) {
                (SmiService::FsMasterAccess, _) if octets.len() == 5 => Ok(()),
                (SmiService::FsMasterAccess, _) => Err(Refusal::ArgBlockLengthInvalid),
                (_, id::VOID) => Ok(()),
                (_, wanted) if octets.first_chunk() != Some(&wanted.to_be_bytes()) => {
                    Err(Refusal::ArgBlockNotSupported)
                }
                _ if !(shape.octets.0..=shape.octets.1).contains(&octets.len()) => Err(Refusal::ArgBlockLengthInvalid),
                _ => Ok(()),
            };
        }
        let named = octets.first_chunk() == Some(&shape.request.to_be_bytes());
        let fits = (shape.octets.0..=shape.octets.1).contains(&octets.len());
        if !fits && self.is(MasterMutant::LengthBeforeArgBlockId) {
            return Err(Refusal::ArgBlockLengthInvalid);
        }
        if !named && !self.is(MasterMutant::ArgBlockIdUnchecked) {
            return Err(Refusal::ArgBlockNotSupported);
        }
        if !fits && !self.is(MasterMutant::ArgBlockLengthUnchecked) {
            return Err(Refusal::ArgBlockLengthInvalid);
        }
        if request.expected != shape.result && !self.is(MasterMutant::ExpectedBlockUnchecked) {
            return Err(Refusal::ArgBlockInconsistent);
        }
        Ok(())
    }

    fn serve(&mut self, request: &SmiRequest, shape: &Shape, seen: &mut Sink<'_>) -> Outcome {
        let edition = self.variant.edition;
        let nothing = || if edition == Edition::V1_1 { Vec::new() } else { id::VOID.to_be_bytes().to_vec() };
        let block = |content: &[u8]| [shape.result.to_be_bytes().as_slice(), content].concat();
        let octets = &request.octets;
        match request.service {
            SmiService::MasterIdentification => {
                return Ok(blocks::master_ident(edition, self.ports.len() as u8, self.options.mutant));
            }
            SmiService::FsMasterAccess => return self.access(octets, seen),
            _ => {}
        }
        let now = self.now;
        let index = usize::from(request.port) - 1;
        let mutant = self.options.mutant;
        let is = |fault: MasterMutant| mutant == Some(fault);
        if request.service == SmiService::PortStatus && is(MasterMutant::PortStatusOfPort1) {
            return Ok(self.ports.first().map(|port| port.status().to_octets(edition)).unwrap_or_default());
        }
        let Some(port) = self.ports.get_mut(index) else { return Err(Refusal::PortNumInvalid) };
        let safety = port.config.as_ref().is_some_and(PortConfig::is_safety);
        match request.service {
            SmiService::PortConfiguration => {
                let config = PortConfig::read(edition, octets, mutant).ok_or(Refusal::ArgBlockInconsistent)?;
                port.configure(now, config, seen);
                Ok(nothing())
            }
            SmiService::ReadbackPortConfiguration => Ok(match &port.config {
                Some(config) if !is(MasterMutant::ReadbackOfFactory) => config.octets.clone(),
                _ => {
                    let mut empty = block(&[]);
                    empty.resize(blocks::config_octets(edition), 0);
                    empty
                }
            }),
            SmiService::PortStatus => Ok(port.status().to_octets(edition)),
            SmiService::PortPowerOffOn => {
                let (mode, time) = match octets.as_slice() {
                    [_, _, mode, high, low] => (*mode, u64::from(*high) << 8 | u64::from(*low)),
                    _ => return Err(Refusal::ArgBlockLengthInvalid),
                };
                match (mode, time) {
                    (0, 0x8000..) if is(MasterMutant::PowerOffTimeSigned) => {
                        return Err(Refusal::ArgBlockInconsistent);
                    }
                    (0, 1..) => port.switch(now, false, Some(time), seen),
                    (1, _) => port.switch(now, false, None, seen),
                    (2, _) => port.switch(now, true, None, seen),
                    _ => return Err(Refusal::ArgBlockInconsistent),
                }
                Ok(nothing())
            }
            SmiService::DeviceWrite | SmiService::DeviceRead => {
                if !matches!(port.mode(), Mode::Preoperate | Mode::Operate) {
                    return Err(Refusal::DeviceNotAccessible);
                }
                if port.is_asking(now) {
                    return Err(Refusal::ServiceTempUnavailable);
                }
                let [_, _, high, low, subindex, data @ ..] = octets.as_slice() else {
                    return Err(Refusal::ArgBlockLengthInvalid);
                };
                let index = u16::from_be_bytes([*high, *low]);
                let write = request.service == SmiService::DeviceWrite;
                port.ask(now, index, *subindex, write.then(|| data.to_vec()), seen);
                // A write is accepted whatever the Device will say; a value can only come from the Device.
                if write { Ok(nothing()) } else { Err(Refusal::WaitsForDevice) }
            }
            SmiService::PdIn | SmiService::PdInOut if port.mode() != Mode::Operate => Err(Refusal::DeviceNotInOperate),
            SmiService::PdIn => Ok(block(&port.nsr_in)),
            SmiService::PdInOut => {
                let content =
                    [&[port.nsr_in.len() as u8], port.nsr_in.as_slice(), &[port.nsr_out.len() as u8], &port.nsr_out];
                Ok(block(&content.concat()))
            }
            SmiService::PdOut => {
                let data = octets.get(2..).unwrap_or_default();
                if port.mode() != Mode::Operate {
                    return Err(Refusal::DeviceNotInOperate);
                }
                if data.len() != port.nsr_out.len() {
                    return Err(Refusal::ArgBlockLengthInvalid);
                }
                port.nsr_out = data.to_vec();
                Ok(nothing())
            }
            SmiService::SpduIn | SmiService::SpduOut if edition == Edition::Iec2022 => {
                Err(Refusal::ServiceNotSupported)
            }
            SmiService::SpduIn => match (port.ossde_image(), port.mode()) {
                (Some(image), _) => Ok(block(&[image])),
                _ if !safety => Err(Refusal::ServiceNotSupported),
                (None, Mode::Operate) => Ok(block(&port.fs_in)),
                _ => Err(Refusal::DeviceNotInOperate),
            },
            // FSOutBuffer belongs to the SCL, or is all zeros until it starts.
            SmiService::SpduOut if port.has_scl() || !safety || port.mode() == Mode::Operate => {
                Err(Refusal::ServiceNotSupported)
            }
            SmiService::SpduOut => Err(Refusal::DeviceNotInOperate),
            SmiService::FsPdInOut if edition == Edition::V1_1 => Err(Refusal::ServiceNotSupported),
            SmiService::FsPdInOut => {
                let input = match (port.ossde_image(), port.mode()) {
                    (Some(image), _) => vec![image],
                    (None, Mode::Operate) => [port.fs_in.as_slice(), &port.nsr_in].concat(),
                    _ => return Err(Refusal::DeviceNotInOperate),
                };
                let output = [port.fs_out().as_slice(), &port.nsr_out].concat();
                let (input, output) =
                    if is(MasterMutant::FsPdInOutSwapped) { (output, input) } else { (input, output) };
                let lengths = (input.len() as u8, output.len() as u8);
                Ok(block(&[&[0, 1, lengths.0], input.as_slice(), &[lengths.1], &output].concat()))
            }
            SmiService::DsToParServ => Ok(block(&[])),
            SmiService::ParServToDs => Ok(nothing()),
            SmiService::PdInIq | SmiService::PdOutIq => Err(Refusal::ServiceNotSupported),
            SmiService::MasterIdentification | SmiService::FsMasterAccess => Err(Refusal::ServiceNotSupported),
        }
    }

    /// SMI_FSMasterAccess: the password where there is one, the reset password for the whole project.
    fn access(&mut self, octets: &[u8], seen: &mut Sink<'_>) -> Outcome {
        let edition = self.variant.edition;
        let number = |from: usize| {
            let octets = octets.get(from..from + 4).and_then(|octets| octets.first_chunk());
            octets.map_or(0, |octets| u32::from_be_bytes(*octets))
        };
        if edition == Edition::Iec2022 {
            let (password, reset) = (number(2), number(6));
            if reset != 0 && reset == self.options.reset_password {
                self.password = 0;
                let pd_in = self.variant.pd_in;
                self.ports.iter_mut().for_each(|port| port.forget(pd_in, seen));
            } else if password != self.password {
                return Err(Refusal::ArgBlockInconsistent);
            }
        }
        let mut fscp = self.fscp.unwrap_or_default();
        if self.is(MasterMutant::AuthenticitySwapped) {
            fscp.rotate_left(4);
        }
        Ok(blocks::authenticity(edition, fscp))
    }
}

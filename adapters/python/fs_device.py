# SPDX-License-Identifier: MIT OR Apache-2.0
"""A small FS-Device: its safety communication layer, its FSP parameters, and what fsct sees of them.

Clauses without an edition are equal in IO-Link Safety V1.1 and IEC 61139-2:2022. Where these leave a question open, the
comment says what is done here.

    python3 fs_device.py                        # serves standard input and output
    python3 fs_device.py tcp://127.0.0.1:7000   # serves a socket; port 0 chooses one
"""

from __future__ import annotations

import struct
import sys
from collections.abc import Callable
from typing import NamedTuple

from fsct_client import MAX_TIME, Description, Dut, Edition, Mode, Offer, Pco, Refused, Service, Unsupported, serve

NS_PER_MS = 1_000_000
PORT = 1

# ErrorTypes of the base standard
INDEX_NOT_AVAILABLE = 0x8011
SUBINDEX_NOT_AVAILABLE = 0x8012
DEVICE_CONTROL = 0x8022
ACCESS_DENIED = 0x8023
OUT_OF_RANGE = 0x8030
LENGTH_OVERRUN = 0x8033
LENGTH_UNDERRUN = 0x8034
FUNCTION_NOT_AVAILABLE = 0x8035
TEMPORARILY_UNAVAILABLE = 0x8036
INCONSISTENT = 0x8041

EVENT_APPEARS, EVENT_DISAPPEARS = 0xF4, 0xB4  # EventQualifier: Error of the Device application
NO_VERIFY_RECORD = 0xB00A

MOST_PD = {Mode.CRC16: 3, Mode.CRC32: 25}  # octets of FS process data (Table A.3)
DEFAULT_WATCHDOG = 100  # ms
TIMING = {  # of IEC 61139-2
    0x4210: (50).to_bytes(2, "big"),  # FSP_TimeToReady, 10 ms
    0x4211: (100).to_bytes(2, "big"),  # FSP_MinShutDownTime, 10 ms
    0x4213: (5).to_bytes(2, "big"),  # FSP_WCDT, ms
    0x4214: (6).to_bytes(2, "big"),  # FSP_OFDT, ms
}


class Crc:
    """A signature of Annex D: most significant bit first, no inversion, no appended zeros."""

    def __init__(self, octets: int, polynomial: int) -> None:
        self.octets = octets
        self._width = 8 * octets
        self._mask = (1 << self._width) - 1
        self._table = [self._entry(index, polynomial) for index in range(256)]

    def _entry(self, index: int, polynomial: int) -> int:
        register = index << (self._width - 8)
        for _ in range(8):
            carry = register >> (self._width - 1)
            register = (register << 1 & self._mask) ^ (polynomial if carry else 0)
        return register

    def of(self, octets: bytes, start: int = 0) -> int:
        """The signature; parameters start with 0."""
        table, mask, shift, register = self._table, self._mask, self._width - 8, start
        for octet in octets:
            register = (register << 8 & mask) ^ table[register >> shift ^ octet]
        return register

    def of_spdu(self, octets: bytes) -> bytes:
        """The signature of an SPDU: starts with 1, 0 becomes 1 (11.4.7)."""
        return (self.of(octets, 1) or 1).to_bytes(self.octets, "big")


CRC16 = Crc(2, 0x4EAB)
CRC32 = Crc(4, 0xF4ACFB13)


class Variant(NamedTuple):
    """What the FS-Device is; octets of FS process data."""

    edition: Edition
    mode: Mode
    pd_out: int
    pd_in: int

    @property
    def crc(self) -> Crc:
        return CRC16 if self.mode is Mode.CRC16 else CRC32

    @property
    def spdu_out(self) -> int:
        """Octets of the FS-Master's SPDU: FS-PDout, PortNum, Control&MCnt, signature."""
        return self.pd_out + 2 + self.crc.octets

    @property
    def spdu_in(self) -> int:
        return self.pd_in + 2 + self.crc.octets

    @property
    def io_structure_crc(self) -> int:
        """FSP_IO_StructCRC (A.2.7) of process data that are Boolean throughout."""
        inputs = [self.spdu_in, 8 * self.pd_in, self.pd_in, 0, 0]
        outputs = [self.spdu_out, 8 * self.pd_out, self.pd_out, 0, 0]
        return CRC16.of(bytes([1, *inputs, *outputs]))

    @property
    def description_crc(self) -> bytes:
        """FSP_ParamDescCRC: the serialization of Figure E.1 with the defaults and allowed values of this product."""
        # Index, bits; then of each item Subindex, bit offset, data type, default, allowed values
        stream = struct.pack(">HH BHBI BHBI", 0x4200, 88, 1, 56, 3, 0, 2, 24, 3, 0)
        stream += struct.pack(">BHBB BHBH", 3, 16, 1, 0, 4, 0, 2, 0)
        stream += struct.pack(">HH BHBBB BHBBB", 0x4201, 96, 1, 88, 1, 1, 1, 2, 80, 1, self.mode, self.mode)
        stream += struct.pack(">BHBHHH", 3, 64, 2, DEFAULT_WATCHDOG, 1, 0xFFFF)
        stream += struct.pack(">BHBH BHBI BHBH", 4, 48, 2, self.io_structure_crc, 5, 16, 3, 0, 6, 0, 2, 0)
        crc = CRC16 if self.edition is Edition.V1_1 else CRC32
        return crc.of(stream).to_bytes(crc.octets, "big")


def inv3(counter: int) -> int:
    """The counterpart of a counter (Table 33)."""
    return 7 - counter


def succ(counter: int) -> int:
    """0 is never reached by counting."""
    return counter % 7 + 1


class Scl:
    """The SCL of the FS-Device (11.5.3, Table 40). Between two calls it rests in state 21, 24 or 26; times in ns."""

    def __init__(self, variant: Variant, port: int, watchdog: int) -> None:
        self.variant = variant
        self.port = port
        self.watchdog = watchdog
        self.state = 21  # T20
        self.expiry: int | None = None  # of DTimer; runs in 24 and 26 only
        self.answer = bytes(variant.spdu_in)  # zeros until the first SPDU has come
        self.MCount = 0  # of the SPDU processed last; the first SPDU is never old
        self.SDcycles = 3
        self.SDset = 0
        self.DCommErr = 0
        self.DTimeout = 1
        self.CommErrCount = 0
        self.TimeoutCount = 0
        # Inputs and outputs of the technology
        self.PDin_D = bytes(variant.pd_in)
        self.SDset_DS = 0
        self.PDout_D = self.SDout = bytes(variant.pd_out)
        self.setSD_DC = 0
        self.ChFAckReq_DC = 0

    def receive(self, spdu: bytes, now: int) -> None:
        """T21, T24, T27: takes a new SPDU; one of all zeros (11.5.3) or an old one is left alone, bad or not."""
        if not any(spdu):
            return
        pd_out = self.variant.pd_out
        control = spdu[pd_out + 1]
        MCount, setSD = control >> 5, control >> 1 & 1
        if self.state != 21 and MCount == self.MCount:
            return
        comm_err = self.check(spdu, MCount)
        self.MCount = MCount
        self.ChFAckReq_DC = control & 1
        self.expiry = now + self.watchdog
        if self.state == 26:
            self.check_after_fault(comm_err)
        else:
            self.check_regular(comm_err, setSD, spdu[:pd_out])

    def check(self, spdu: bytes, MCount: int) -> bool:
        """CommErr: signature, port number or counter is wrong. The first SPDU has to carry 0, also in V1.1."""
        end = self.variant.pd_out + 2
        allowed = (0,) if self.state == 21 else (0, succ(self.MCount))
        right = self.variant.crc.of_spdu(spdu[:end]) == spdu[end:] and spdu[end - 2] == self.port
        return not right or MCount not in allowed

    def check_regular(self, comm_err: bool, setSD: int, PDout: bytes) -> None:
        """State 22."""
        if comm_err:  # T25
            self.safe_state()
            self.DCommErr = self.CommErrCount = 1
            self.SDcycles = 3
            self.respond(26)
            return
        self.DCommErr = self.DTimeout = 0  # T22
        self.SDset = self.setSD_DC = int(self.SDcycles > 0)
        self.SDcycles = max(self.SDcycles - 1, 0)
        self.setSD_DC |= setSD
        self.PDout_D = self.SDout if self.setSD_DC else PDout
        self.respond(24)

    def check_after_fault(self, comm_err: bool) -> None:
        """State 27."""
        if not comm_err and self.SDcycles == 0:  # T28
            self.PDout_D = self.SDout
            self.setSD_DC = self.SDset = self.DCommErr = self.DTimeout = 0
            self.respond(24)
            return
        self.safe_state()  # T29, nested: the counts are worked off in good cycles only
        if comm_err:
            self.DCommErr = self.CommErrCount = 1
            self.SDcycles = 3
        else:
            self.SDcycles -= 1
            self.DCommErr, self.CommErrCount = self.CommErrCount, 0
            self.DTimeout, self.TimeoutCount = self.TimeoutCount, 0
        self.respond(26)

    def expire(self, now: int) -> None:
        """T31 from 24, T30 from 26: DTimer has expired; DCount_i stays that of the SPDU processed last."""
        self.safe_state()
        self.DTimeout = self.TimeoutCount = 1
        self.SDcycles = 3
        self.expiry = now + self.watchdog
        self.respond(26)

    def repeat_expiry(self, end: int) -> None:
        """T30 again and again up to this time: only DTimer changes."""
        if self.expiry is not None and self.expiry <= end:
            self.expiry += ((end - self.expiry) // self.watchdog + 1) * self.watchdog

    def safe_state(self) -> None:
        self.PDout_D = self.SDout
        self.setSD_DC = self.SDset = 1

    def respond(self, state: int) -> None:
        """T23 to 24, T26 to 26: the answer is built and stands until the next one."""
        if state == 24 and self.SDset_DS:
            self.SDset = 1
        status = inv3(self.MCount) << 5 | self.SDset << 2 | self.DCommErr << 1 | self.DTimeout
        secured = self.PDin_D + bytes([self.port ^ 0xFF, status])
        self.answer = secured + self.variant.crc.of_spdu(secured)
        self.state = state


class Authenticity(NamedTuple):
    """Record 0x4200 (A.2.1 to A.2.3)."""

    authenticity_1: int
    authenticity_2: int
    port: int
    crc: int


class Protocol(NamedTuple):
    """Record 0x4201 (A.2.4 to A.2.9); watchdog in ms."""

    version: int
    mode: int
    watchdog: int
    io_structure_crc: int
    technology_crc: int
    crc: int


UPLOAD_START, UPLOAD_END, DOWNLOAD_START, DOWNLOAD_END, DS_BREAK = range(1, 6)  # DS_Command of the base standard

AUTHENTICITY = struct.Struct(">IIBH")
PROTOCOL = struct.Struct(">BBHHIH")


def block_right(record: bytes) -> bool:
    """The CRC at the end of a record is that of the octets in front of it."""
    return CRC16.of(record[:-2]) == int.from_bytes(record[-2:], "big")


def with_crc(octets: bytes) -> bytes:
    return octets + CRC16.of(octets).to_bytes(2, "big")


def items_of(layout: struct.Struct, record: bytes) -> list[bytes]:
    """The items of a record, by Subindex from 1."""
    sizes = [struct.calcsize(">" + item) for item in layout.format.lstrip(">")]
    ends = [sum(sizes[: number + 1]) for number in range(len(sizes))]
    return [record[end - size : end] for size, end in zip(sizes, ends)]


class Parameters:
    """The FSP parameters an FS-Device keeps, as records on the wire."""

    def __init__(self, variant: Variant) -> None:
        """Factory setting (Table G.1): no authenticity and no port, but armed; FSP_TechParCRC of no parameter is 1."""
        self.variant = variant
        self.authenticity = with_crc(struct.pack(">IIB", 0, 0, 0))
        self.protocol = with_crc(struct.pack(">BBHHI", 1, variant.mode, DEFAULT_WATCHDOG, variant.io_structure_crc, 1))
        self.transfer = UPLOAD_END  # the DS_Command in effect
        self.taken: dict[int, bytes] = {}  # blocks of a download, adopted at its end

    @property
    def armed(self) -> bool:
        """FSP_TechParCRC 0 means commissioning."""
        return Protocol(*PROTOCOL.unpack(self.protocol)).technology_crc != 0

    @property
    def in_use(self) -> bool:
        """Assigned to a port: not as it came out of the box."""
        return any(self.authenticity[:9])

    def storage_command(self, octets: bytes) -> None:
        """DS_Command: a device in use takes no download (11.7.6); it refuses with 0x8022 or, V1.1, ignores what comes."""
        sized(octets, 1)
        command = octets[0]
        if not DS_BREAK >= command >= UPLOAD_START:
            raise Refused(OUT_OF_RANGE)
        if command == DOWNLOAD_START and self.in_use and self.variant.edition is Edition.IEC2022:
            raise Refused(DEVICE_CONTROL)
        if command == DOWNLOAD_END and self.transfer == DOWNLOAD_START and not self.in_use:
            self.authenticity = self.taken.get(0x4200, self.authenticity)
            self.protocol = self.taken.get(0x4201, self.protocol)
        self.taken = {}
        self.transfer = command

    def storage(self) -> list[bytes]:
        """State_Property, Data_Storage_Size, Parameter_Checksum and Index_List, which are Subindices 2 to 5."""
        state = {UPLOAD_START: 0x02, DOWNLOAD_START: 0x04}.get(self.transfer, 0)
        kept = self.authenticity + self.protocol
        checksum = CRC32.of(kept).to_bytes(4, "big")
        return [bytes([state]), (len(kept) + 8).to_bytes(4, "big"), checksum, bytes.fromhex("4200004201000000")]

    def write_authenticity(self, record: bytes) -> None:
        """Table A.1: port 0 is not accepted."""
        sized(record, AUTHENTICITY.size)
        if Authenticity(*AUTHENTICITY.unpack(record)).port == 0:
            raise Refused(OUT_OF_RANGE)
        if not block_right(record):
            raise Refused(INCONSISTENT)
        if self.transfer == DOWNLOAD_START:
            self.taken[0x4200] = record
        else:
            self.authenticity = record

    def write_protocol(self, record: bytes) -> None:
        """Table A.1: version 1, the mode of the product, and a watchdog time. `verify` compares the structure."""
        sized(record, PROTOCOL.size)
        protocol = Protocol(*PROTOCOL.unpack(record))
        if protocol.version != 1 or protocol.mode != self.variant.mode or protocol.watchdog == 0:
            raise Refused(OUT_OF_RANGE)
        if not block_right(record):
            raise Refused(INCONSISTENT)
        if self.transfer == DOWNLOAD_START:
            self.taken[0x4201] = record
        else:
            self.protocol = record

    def verify(self, record: bytes) -> int | None:
        """The EventCode of the first deviation of an FSP_VerifyRecord (Annex B), or None.

        For another version, mode or valid watchdog time no code is defined; that of the block is taken.
        """
        first, second = record[: AUTHENTICITY.size], record[AUTHENTICITY.size :]
        sent, kept = (Authenticity(*AUTHENTICITY.unpack(octets)) for octets in (first, self.authenticity))
        protocol, kept_protocol = (Protocol(*PROTOCOL.unpack(octets)) for octets in (second, self.protocol))
        if sent[:2] != kept[:2] or sent[:2] == (0, 0):
            return 0xB003
        if sent.port != kept.port or sent.port == 0:
            return 0xB004
        if not block_right(first):
            return 0xB005
        if protocol.watchdog == 0:
            return 0xB009
        if protocol.io_structure_crc != self.variant.io_structure_crc:
            return 0xB008
        if protocol.technology_crc != kept_protocol.technology_crc:
            return 0xB007
        if not block_right(second) or second != self.protocol:
            return 0xB006
        return None


def sized(octets: bytes, size: int) -> None:
    if len(octets) != size:
        raise Refused(LENGTH_OVERRUN if len(octets) > size else LENGTH_UNDERRUN)


class FsDevice(Dut):
    """The product: supply, parameters in its memory, and the SCL once these are verified. Its clock is virtual."""

    def __init__(self) -> None:
        super().__init__()
        self.time = 0  # ns
        self.on = False
        self.configure(Edition.IEC2022, Mode.CRC16, 3, 3)

    def describe(self) -> Description:
        return Description(
            offers=[Offer(edition, mode, 0, most, 0, most) for edition in Edition for mode, most in MOST_PD.items()],
            pcos=Pco.POWER | Pco.LINK | Pco.ACYCLIC | Pco.APP | Pco.CLOCK,
            virtual_clock=True,
            product="fs_device.py",
            version="1.0",
        )

    def now(self) -> int:
        return self.time

    def configure(self, edition: int, mode: int, pd_out: int, pd_in: int) -> None:
        if self.on or edition not in list(Edition) or mode not in list(Mode):
            raise Unsupported
        if max(pd_out, pd_in) > MOST_PD[Mode(mode)]:
            raise Unsupported
        self.variant = Variant(Edition(edition), Mode(mode), pd_out, pd_in)
        self.parameters = Parameters(self.variant)
        self.start()

    def power(self, on: bool) -> None:
        if on == self.on:
            return
        self.on = on
        self.start()
        if on:
            self.show()

    def start(self) -> None:
        """What does not outlast the supply; the inputs of the application are 0 until they are set."""
        self.PDin_D = bytes(self.variant.pd_in)
        self.SDset_DS = 0
        self.operate = False
        self.deviation: int | None = None  # EventCode of the FSP_VerifyRecord that was not accepted
        self.scl: Scl | None = None
        self.parameters.transfer, self.parameters.taken = UPLOAD_END, {}
        self.shown: dict[Service, bytes | int] = {}

    def exchange(self, port: int, received: bytes | None) -> bytes | None:
        if port != PORT:
            raise Unsupported
        if not self.on:
            return None
        if not self.operate:
            self.to_operate()
        if self.scl is None:
            return bytes(self.variant.spdu_in)
        if received is not None and len(received) == self.variant.spdu_out:
            self.scl.receive(received, self.time)
            self.show()
        return self.scl.answer

    def to_operate(self) -> None:
        self.operate = True
        if self.scl is None and self.deviation is None and self.variant.edition is Edition.IEC2022:
            self.see.event(NO_VERIFY_RECORD, EVENT_APPEARS)

    def set(self, port: int, service: int, value: bytes) -> None:
        if port != PORT or not self.on:
            raise Unsupported
        if service == Service.PDin_D and len(value) == self.variant.pd_in:
            self.PDin_D = value
        elif service == Service.SDset_DS and value in (b"\0", b"\1"):
            self.SDset_DS = value[0]
        else:
            raise Unsupported
        self.feed_scl()

    def feed_scl(self) -> None:
        if self.scl:
            self.scl.PDin_D, self.scl.SDset_DS = self.PDin_D, self.SDset_DS

    def advance(self, ns: int) -> None:
        end = self.time + ns
        if end > MAX_TIME:
            raise Unsupported
        if self.scl and self.scl.expiry is not None and self.scl.expiry <= end:
            self.time = self.scl.expiry
            self.scl.expire(self.time)
            self.show()
            self.scl.repeat_expiry(end)
        self.time = end

    def show(self) -> None:
        """Reports the outputs that have changed; right after power-on all of them."""
        scl = self.scl
        outputs: dict[Service, bytes | int] = {
            Service.PDout_D: scl.PDout_D if scl else bytes(self.variant.pd_out),
            Service.setSD_DC: scl.setSD_DC if scl else 0,
            Service.ChFAckReq_DC: scl.ChFAckReq_DC if scl else 0,
            Service.SCL_Fault: 0,  # no transition sets it
        }
        for service, value in outputs.items():
            if self.shown.get(service) != value:
                self.see.service(PORT, service, value)
        self.shown = outputs

    def read(self, index: int, subindex: int) -> bytes:
        if index == 0x0003 and self.on and 2 <= subindex <= 5:
            return self.parameters.storage()[subindex - 2]
        record = self.objects().get(index)
        if record is None:
            raise Refused(ACCESS_DENIED if self.writes(index) else INDEX_NOT_AVAILABLE)
        if subindex == 0:
            return record
        layout = {0x4200: AUTHENTICITY, 0x4201: PROTOCOL}.get(index)
        items = items_of(layout, record) if layout else []
        if subindex > len(items):
            raise Refused(SUBINDEX_NOT_AVAILABLE)
        return items[subindex - 1]

    def objects(self) -> dict[int, bytes]:
        """What can be read (Table A.1)."""
        if not self.on:
            raise Unsupported
        records = {0x4200: self.parameters.authenticity, 0x4201: self.parameters.protocol}
        records[0x4212] = self.variant.description_crc
        records[0x000C], records[0x000D] = bytes(2), bytes.fromhex("4001")  # no Device Access Lock; IO-Link Safety
        if self.variant.edition is Edition.IEC2022:
            records.update(TIMING)
        return records

    def write(self, index: int, subindex: int, octets: bytes) -> None:
        """Records are written as a whole; a block with one item changed would have a wrong CRC."""
        readable = index in self.objects()
        write = self.writes(index)
        if write is None:
            raise Refused(ACCESS_DENIED if readable else INDEX_NOT_AVAILABLE)
        if subindex != (1 if index == 0x0003 else 0):
            raise Refused(SUBINDEX_NOT_AVAILABLE)
        write(octets)

    def writes(self, index: int) -> Callable[[bytes], None] | None:
        """What can be written (Table A.1); the passwords are those of V1.1."""
        table = {
            0x0002: self.command,
            0x0003: self.parameters.storage_command,
            0x4200: self.parameters.write_authenticity,
            0x4201: self.parameters.write_protocol,
            0x4202: self.verify,
        }
        if self.variant.edition is Edition.V1_1:
            table[0x4210] = table[0x4211] = lambda octets: sized(octets, 32)
        return table.get(index)

    def verify(self, record: bytes) -> None:
        """FSP_VerifyRecord, in PREOPERATE only: starts the SCL, or raises the Event of what deviates (10.4.3.1)."""
        sized(record, AUTHENTICITY.size + PROTOCOL.size)
        if self.operate:
            raise Refused(TEMPORARILY_UNAVAILABLE)
        if self.deviation is not None:
            self.see.event(self.deviation, EVENT_DISAPPEARS)
        self.deviation = self.parameters.verify(record)
        self.scl = None
        if self.deviation is not None:
            self.see.event(self.deviation, EVENT_APPEARS)
        else:
            self.scl = Scl(self.variant, record[8], int.from_bytes(record[13:15], "big") * NS_PER_MS)
            self.feed_scl()

    def command(self, octets: bytes) -> None:
        """System command: back to factory settings, in commissioning only (V1.1 Table E.2, IEC 61139-2 Table E.1)."""
        sized(octets, 1)
        edition = self.variant.edition
        reset = 0x82 if edition is Edition.V1_1 else 0x83
        if octets[0] == 0x81 and edition is Edition.IEC2022 and not self.parameters.armed:
            return  # application reset: there is nothing of the application to reset
        if octets[0] != reset:
            raise Refused(FUNCTION_NOT_AVAILABLE)
        if self.parameters.armed or self.scl:
            raise Refused(TEMPORARILY_UNAVAILABLE)
        self.parameters = Parameters(self.variant)


if __name__ == "__main__":
    serve(FsDevice, *sys.argv[1:])

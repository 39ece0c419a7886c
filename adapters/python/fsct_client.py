# SPDX-License-Identifier: MIT OR Apache-2.0
"""How a DUT talks to fsct: the messages of PROTOCOL.md, version 1, in one file to copy.

Derive from `Dut`, override `describe` and the stimuli you serve, and hand the class to `serve`. A stimulus that is not
overridden is answered *unsupported*. What your DUT shows by itself, such as outputs and Events, it tells `self.see`.

    class MyDevice(Dut):
        def describe(self) -> Description: ...
        def power(self, on: bool) -> None: ...
        def exchange(self, port: int, received: bytes | None) -> bytes | None: ...

    serve(MyDevice)                           # standard input and output: fsct run --dut 'exec:python3 my_device.py'
    serve(MyDevice, "tcp://127.0.0.1:7000")   # a socket:                  fsct run --dut tcp://127.0.0.1:7000

Nothing in here knows an SPDU; octets stay octets. A DUT calls `self.see` while it carries out a stimulus, not from a
thread of its own.
"""

from __future__ import annotations

import os
import socketserver
import struct
import sys
import time
import zlib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from enum import IntEnum, IntFlag
from typing import Any, NamedTuple

VERSION = 1  # of the messages
SYNC = b"\xf5\xc7"
HEAD, TAIL = struct.Struct(">2sBBH"), struct.Struct(">I")
HELLO, APPLY, DESCRIPTION, OBSERVED, ERROR = 0x01, 0x02, 0x81, 0x82, 0xFF
MAX_PAYLOAD = 0xFFFF  # octets in one frame
MAX_TIME = 0xFFFF_FFFF_FFFF_FFFF  # ns, greatest time stamp
PATIENCE = 0.5  # s without an answer after which a part of it is sent; fsct waits for 2 s


class Role(IntEnum):
    FS_DEVICE = 1
    FS_MASTER = 2


class Pco(IntFlag):
    """What a DUT really serves."""

    POWER = 1
    LINK = 2
    ACYCLIC = 4
    APP = 8
    LINE = 16
    CLOCK = 32


class Edition(IntEnum):
    V1_1 = 1
    IEC2022 = 2


class Mode(IntEnum):
    """FSP_ProtMode."""

    CRC16 = 1
    CRC32 = 2


class Service(IntEnum):
    """Services of an application; one input or output each."""

    PDin_D = 1
    SDset_DS = 2
    PDout_D = 3
    setSD_DC = 4
    ChFAckReq_DC = 5
    SCL_Fault = 6
    OSSDe_demand = 7
    PDout_M = 17
    setSD_C = 18
    ChFAck_C = 19
    PDin_M = 20
    SDset_S = 21
    ChFAckReq_S = 22
    FAULTS_S = 23
    qualifier = 24
    FSCP_Authenticity = 25


class Offer(NamedTuple):
    """A variant the DUT can be configured to; least and greatest numbers of octets of FS process data."""

    edition: int
    mode: int
    least_out: int
    greatest_out: int
    least_in: int
    greatest_in: int


@dataclass(frozen=True)
class Description:
    """What a DUT says of itself; times in ns."""

    offers: Iterable[Offer]
    pcos: Pco
    role: Role = Role.FS_DEVICE
    ports: int = 1
    virtual_clock: bool = False
    resolution: int = 1
    uncertainty: int = 0
    vendor: str = ""
    product: str = ""
    version: str = ""
    max_payload: int = 512  # octets of payload the DUT takes in one frame
    max_requests: int = 1  # APPLY requests it can hold unanswered

    def encode(self) -> bytes:
        clock = struct.pack(">BQQ", 1 if self.virtual_clock else 2, self.resolution, self.uncertainty)
        tags = [(1, bytes([self.role])), (2, bytes([self.ports])), (3, bytes([self.pcos]))]
        tags += [(4, bytes(offer)) for offer in self.offers]
        tags += [(5, clock), (6, text(self.vendor)), (7, text(self.product)), (8, text(self.version))]
        tags += [(9, struct.pack(">HB", self.max_payload, self.max_requests))]
        return b"".join(tlv(tag, value) for tag, value in tags)


class SmiResult(NamedTuple):
    """Answer of an SMI service; `length` is the ArgBlockLength as the FS-Master states it."""

    positive: bool
    client: int
    reference: int  # RefArgBlockID
    length: int
    block: bytes


class Unsupported(Exception):
    """The DUT does not serve this stimulus, or not with this value."""


class Refused(Exception):
    """A read or write ended with this ErrorType of the base standard: ErrorCode, AdditionalCode."""

    def __init__(self, error_type: int) -> None:
        super().__init__(f"ErrorType 0x{error_type:04X}")
        self.error_type = error_type


class ProtocolError(Exception):
    """A message that makes no sense; its text goes to fsct."""


class Observations:
    """What was seen since the last answer, in the order it happened, each with the time of the DUT's clock."""

    def __init__(self, now: Callable[[], int]) -> None:
        self._now = now
        self._seen: list[bytes] = []
        self.stimulus = 0  # position of the stimulus that is being carried out

    def service(self, port: int, service: int, value: bytes | int) -> None:
        """An output of the application has this value now."""
        octets = bytes([value]) if isinstance(value, int) else value
        self._add(2, bytes([port, service]) + octets)

    def event(self, code: int, qualifier: int) -> None:
        """An FS-Device raises an Event."""
        self._add(6, struct.pack(">HB", code, qualifier))

    def mode(self, port: int, mode: int) -> None:
        """An FS-Master commands this mode: 0 INACTIVE, 1 STARTUP, 2 PREOPERATE, 3 OPERATE."""
        self._add(8, bytes([port, mode]))

    def request(self, port: int, write: bool, index: int, subindex: int, octets: bytes = b"") -> None:
        """An FS-Master reads from, or writes these octets to, the Device on the port."""
        self._add(9, struct.pack(">BBHB", port, write, index, subindex) + octets)

    def line(self, port: int, line: int, level: int) -> None:
        """The DUT has changed a line: 1 L+, 2 C/Q, 3 I/Q, 4 wake-up."""
        self._add(10, bytes([port, line, level]))

    def indication(self, port: int, source: int, qualifier: int, code: int) -> None:
        """An FS-Master indicates an Event of the Device (source 1) or of the port (2)."""
        self._add(12, struct.pack(">BBBH", port, source, qualifier, code))

    # What follows from what the methods of a `Dut` return or raise; a DUT does not call it.

    def _image(self, port: int, octets: bytes | None) -> None:
        self._add(1, bytes([port, 0]) if octets is None else bytes([port, 1]) + octets)

    def _smi(self, port: int, result: SmiResult) -> None:
        positive, client, reference, length, block = result
        self._add(11, struct.pack(">BBHHH", port, positive, client, reference, length) + block)

    def _add(self, kind: int, value: bytes = b"") -> None:
        self._seen.append(struct.pack(">HQ", self.stimulus, self._now()) + tlv(kind, value))

    def _take(self) -> list[bytes]:
        seen, self._seen = self._seen, []
        return seen


class Dut:
    """A DUT. Override what you serve; raise `Unsupported` for a value you cannot take. Ports count from 1."""

    def __init__(self) -> None:
        self.see = Observations(self.now)
        self._began = time.monotonic_ns()

    def describe(self) -> Description:
        raise NotImplementedError

    def now(self) -> int:
        """Time of the DUT's clock in ns."""
        return time.monotonic_ns() - self._began

    def configure(self, edition: int, mode: int, pd_out: int, pd_in: int) -> None:
        """Be this from the next power-on, fresh from the factory; octets of FS-PDout and FS-PDin."""
        raise Unsupported

    def power(self, on: bool) -> None:
        """Switch the supply."""
        raise Unsupported

    def exchange(self, port: int, received: bytes | None) -> bytes | None:
        """One exchange of process data: None = nothing received; returns the image, None = no process data."""
        raise Unsupported

    def read(self, index: int, subindex: int) -> bytes:
        """Returns the octets read, or raises `Refused`."""
        raise Unsupported

    def write(self, index: int, subindex: int, octets: bytes) -> None:
        """Returns when written, or raises `Refused`."""
        raise Unsupported

    def set(self, port: int, service: int, value: bytes) -> None:
        """An input of the application; process data, or one octet 0 or 1."""
        raise Unsupported

    def advance(self, ns: int) -> None:
        """Move the virtual clock."""
        raise Unsupported

    def plug(self, port: int, identity: bytes | None) -> None:
        """Connect the Device with these 10 octets of identity to the port of an FS-Master, or None: nothing."""
        raise Unsupported

    def respond(self, port: int, response: int, octets: bytes) -> None:
        """The Device answers the open request: 1 value, 2 written, 3 refused."""
        raise Unsupported

    def raise_event(self, port: int, code: int, qualifier: int) -> None:
        """The Device on the port raises an Event."""
        raise Unsupported

    def drive(self, port: int, line: int, level: int) -> None:
        """What is connected to the DUT drives C/Q (2) or I/Q (3)."""
        raise Unsupported

    def smi(self, service: int, port: int, client: int, expected: int, block: bytes) -> SmiResult:
        """A request through the SMI of an FS-Master; `expected` is the ExpArgBlockID."""
        raise Unsupported


class Frame(NamedTuple):
    type: int
    sequence: int
    payload: bytes

    def encode(self) -> bytes:
        body = HEAD.pack(SYNC, self.type, self.sequence, len(self.payload)) + self.payload
        return body + TAIL.pack(zlib.crc32(body[2:]))


class FrameReader:
    """Finds frames in a stream, whatever comes in front of them and however it is cut.

    A length beyond `most` octets of payload is none of a frame and not waited for.
    """

    def __init__(self, most: int = MAX_PAYLOAD) -> None:
        self._buffer = bytearray()
        self._most = most

    def feed(self, octets: bytes) -> Iterator[Frame]:
        self._buffer += octets
        while True:
            start = self._buffer.find(SYNC)
            if start < 0:
                start = len(self._buffer) - self._buffer.endswith(SYNC[:1])
            del self._buffer[:start]
            if len(self._buffer) < HEAD.size:
                return
            _, kind, sequence, length = HEAD.unpack_from(self._buffer)
            end = HEAD.size + length
            if length <= self._most and len(self._buffer) < end + TAIL.size:
                return
            if length > self._most or zlib.crc32(self._buffer[2:end]) != TAIL.unpack_from(self._buffer, end)[0]:
                del self._buffer[:1]  # no frame begins here
                continue
            payload = bytes(self._buffer[HEAD.size : end])
            del self._buffer[: end + TAIL.size]
            yield Frame(kind, sequence, payload)


class Session:
    """One connection: octets from fsct go in by `feed`, answers come out by `write`."""

    def __init__(self, dut: Dut, write: Callable[[bytes], Any]) -> None:
        self._dut = dut
        self._write = write
        self._reader = FrameReader(dut.describe().max_payload)
        self._greeted = False

    def feed(self, octets: bytes) -> None:
        for frame in self._reader.feed(octets):
            try:
                self._answer(frame)
            except ProtocolError as error:
                self._send(ERROR, frame.sequence, text(str(error)))

    def _send(self, kind: int, sequence: int, payload: bytes) -> None:
        self._write(Frame(kind, sequence, payload).encode())

    def _answer(self, frame: Frame) -> None:
        if frame.type == HELLO:
            self._hello(frame)
        elif frame.type != APPLY:
            raise ProtocolError(f"unknown message {frame.type:02X}")
        elif not self._greeted:
            raise ProtocolError("stimuli before hello")
        else:
            self._apply(frame)

    def _hello(self, frame: Frame) -> None:
        if len(frame.payload) < 2:
            raise ProtocolError("hello without versions")
        least, greatest = frame.payload[:2]
        self._greeted = least <= VERSION <= greatest
        tags = self._dut.describe().encode() if self._greeted else b""
        self._send(DESCRIPTION, frame.sequence, bytes([VERSION]) + tags)

    def _apply(self, frame: Frame) -> None:
        stimuli = list(tlvs(frame.payload[2:]))
        if len(frame.payload) < 2 or len(stimuli) != int.from_bytes(frame.payload[:2], "big"):
            raise ProtocolError("number of stimuli differs from those that are there")
        see, sent = self._dut.see, time.monotonic()
        for position, (kind, value) in enumerate(stimuli):
            see.stimulus = position
            carry_out(self._dut, kind, value)
            if time.monotonic() - sent > PATIENCE:
                self._observed(frame.sequence, see._take(), last=False)
                sent = time.monotonic()
        self._observed(frame.sequence, see._take(), last=True)
        see.stimulus = 0

    def _observed(self, sequence: int, seen: list[bytes], last: bool) -> None:
        payloads = list(packed(seen, MAX_PAYLOAD - 1)) or ([b""] if last else [])
        for number, payload in enumerate(payloads, 1):
            more = not last or number < len(payloads)
            self._send(OBSERVED, sequence, bytes([more]) + payload)


def carry_out(dut: Dut, kind: int, value: bytes) -> None:
    """Carries out one stimulus and tells what came of it; an exchange has an image at all events."""
    try:
        stimulate(dut, kind, value)
    except Unsupported:
        dut.see._add(7)
        if kind == 3:
            dut.see._image(value[0] if value else 1, None)
    except Refused as refused:
        dut.see._add(5, struct.pack(">H", refused.error_type))


def stimulate(dut: Dut, kind: int, value: bytes) -> None:
    """The table of stimuli."""
    if kind == 1:
        dut.configure(*whole(">BBBB", value))
    elif kind == 2 and value in (b"\0", b"\1"):
        dut.power(value == b"\1")
    elif kind == 3:
        port, present, octets = front(">BB", value, 32)
        if present > 1 or octets and not present:
            raise Unsupported
        dut.see._image(port, dut.exchange(port, octets if present else None))
    elif kind == 4:
        dut.see._add(3, dut.read(*whole(">HB", value)))
    elif kind == 5:
        dut.write(*front(">HB", value, 232))
        dut.see._add(4)
    elif kind == 6:
        dut.set(*front(">BB", value))
    elif kind == 7:
        dut.advance(*whole(">Q", value))
    elif kind == 8 and len(value) in (1, 11):
        dut.plug(value[0], value[1:] or None)
    elif kind == 9:
        dut.respond(*front(">BB", value))
    elif kind == 10:
        dut.raise_event(*whole(">BHB", value))
    elif kind == 11:
        dut.drive(*whole(">BBB", value))
    elif kind == 12:
        result = dut.smi(*front(">BBHH", value))
        dut.see._smi(value[1], result)
    else:
        raise Unsupported


def front(layout: str, value: bytes, most: int = MAX_PAYLOAD) -> tuple[Any, ...]:
    """The fields at the front of a value, then the octets behind them; a value of another length is unsupported."""
    size = struct.calcsize(layout)
    if not size <= len(value) <= size + most:
        raise Unsupported
    return *struct.unpack_from(layout, value), value[size:]


def whole(layout: str, value: bytes) -> tuple[Any, ...]:
    return front(layout, value, 0)[:-1]


def tlv(kind: int, value: bytes) -> bytes:
    return struct.pack(">BH", kind, len(value)) + value


def tlvs(octets: bytes) -> Iterator[tuple[int, bytes]]:
    """Kind and value of each TLV; they have to end where the octets end."""
    position = 0
    while position < len(octets):
        if len(octets) < position + 3:
            raise ProtocolError("a TLV is cut")
        kind, length = struct.unpack_from(">BH", octets, position)
        position += 3 + length
        if len(octets) < position:
            raise ProtocolError("a TLV is longer than what is left")
        yield kind, octets[position - length : position]


def text(words: str) -> bytes:
    """UTF-8 of at most 255 octets; no character is cut."""
    return words.encode("utf-8", "replace")[:255].decode("utf-8", "ignore").encode()


def packed(seen: Iterable[bytes], limit: int) -> Iterator[bytes]:
    """The observations, together as long as they fit into `limit` octets."""
    payload = b""
    for observation in seen:
        if payload and len(payload) + len(observation) > limit:
            yield payload
            payload = b""
        payload += observation
    if payload:
        yield payload


def serve(make_dut: Callable[[], Dut], address: str = "") -> None:
    """Serves `tcp://HOST:PORT`, or standard input and output without an address."""
    if address:
        host, _, port = address.removeprefix("tcp://").rpartition(":")
        serve_tcp(make_dut, host, int(port))
    else:
        serve_stdio(make_dut)


def serve_stdio(make_dut: Callable[[], Dut]) -> None:
    """Serves standard input and output until the input ends. What the DUT prints goes to standard error."""
    sink, sys.stdout = sys.stdout.buffer, sys.stderr

    def write(octets: bytes) -> None:
        sink.write(octets)
        sink.flush()

    serve_stream(make_dut(), lambda most: os.read(sys.stdin.fileno(), most), write)


def serve_tcp(make_dut: Callable[[], Dut], host: str, port: int) -> None:
    """Serves a socket for ever, each connection with a fresh DUT; port 0 chooses one. Prints the address."""

    class Connection(socketserver.StreamRequestHandler):
        disable_nagle_algorithm = True

        def handle(self) -> None:
            serve_stream(make_dut(), self.request.recv, self.request.sendall)

    class Server(socketserver.ThreadingTCPServer):
        allow_reuse_address = True
        daemon_threads = True

    with Server((host, port), Connection) as server:
        print("tcp://{}:{}".format(*server.server_address), flush=True)
        server.serve_forever()


def serve_stream(dut: Dut, read: Callable[[int], bytes], write: Callable[[bytes], Any]) -> None:
    """Serves one connection until it ends; `read` waits for some octets, at most so many."""
    session = Session(dut, write)
    try:
        while octets := read(0x10000):
            session.feed(octets)
    except ConnectionError:
        pass  # fsct has gone

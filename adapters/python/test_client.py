# SPDX-License-Identifier: MIT OR Apache-2.0
"""Tests of the client and of the small FS-Device: python3 -m unittest. The dumps are those of PROTOCOL.md itself."""

from __future__ import annotations

import re
import socket
import struct
import subprocess
import sys
import unittest
from pathlib import Path

import fs_device
import fsct_client
from fs_device import CRC16, CRC32, FsDevice, Variant
from fsct_client import (
    Description,
    Dut,
    Edition,
    Frame,
    FrameReader,
    Mode,
    Offer,
    Pco,
    Role,
    Service,
    Session,
    SmiResult,
    text,
    tlv,
)

HERE = Path(__file__).parent
PAGE = (HERE.parent / "PROTOCOL.md").read_text(encoding="utf-8")
MS = 1_000_000


def octets(dump: str) -> bytes:
    return bytes.fromhex("".join(line.partition("#")[0] for line in dump.splitlines()))


DUMPS = {name: octets(dump) for name, dump in re.findall(r"^```hex (\S+)\n(.*?)^```$", PAGE, re.M | re.S)}


class Connection:
    """A session whose answers can be looked at, after HELLO."""

    def __init__(self, dut: Dut, greet: bool = True) -> None:
        self.sent = b""
        self.session = Session(dut, self.write)
        if greet:
            self.raw(DUMPS["hello"])

    def write(self, answer: bytes) -> None:
        self.sent += answer

    def raw(self, request: bytes) -> bytes:
        """The octets answered."""
        self.sent = b""
        self.session.feed(request)
        return self.sent

    def ask(self, kind: int, payload: bytes = b"") -> list[Frame]:
        return list(FrameReader().feed(self.raw(Frame(kind, 9, payload).encode())))

    def apply(self, *stimuli: tuple[int, str]) -> list[tuple[int, int, str]]:
        """Position, kind and value of each observation."""
        payload = b"".join(tlv(kind, bytes.fromhex(value)) for kind, value in stimuli)
        answers = self.ask(fsct_client.APPLY, struct.pack(">H", len(stimuli)) + payload)
        assert [answer.payload[0] for answer in answers] == [1] * (len(answers) - 1) + [0]
        return [seen for answer in answers for seen in observations(answer.payload)]


def observations(payload: bytes) -> list[tuple[int, int, str]]:
    seen, rest = [], payload[1:]
    while rest:
        position, _, kind, length = struct.unpack_from(">HQBH", rest)
        seen.append((position, kind, rest[13 : 13 + length].hex()))
        rest = rest[13 + length :]
    return seen


class PageDevice(Dut):
    """The FS-Device of the worked examples."""

    time = 0

    def describe(self) -> Description:
        return Description(
            offers=[Offer(Edition.IEC2022, Mode.CRC16, 0, 3, 0, 3)],
            pcos=Pco.POWER | Pco.LINK | Pco.ACYCLIC | Pco.APP | Pco.CLOCK,
            virtual_clock=True,
            resolution=1000,
            vendor="Example",
            product="demo",
            version="1.0",
        )

    def now(self) -> int:
        return self.time

    def advance(self, ns: int) -> None:
        self.time += ns

    def exchange(self, port: int, received: bytes | None) -> bytes | None:
        assert port == 1 and received is not None
        self.see.service(1, Service.PDout_D, received[:3])
        return bytes.fromhex("445566FEC0B14D")


class PageMaster(Dut):
    """The FS-Master of the worked examples; `smi_result` is its next answer."""

    time = 0
    smi_result = SmiResult(True, 0, 0, 0, b"")
    verify_record = b""
    driven = 0

    def describe(self) -> Description:
        return Description(
            role=Role.FS_MASTER,
            ports=2,
            offers=[Offer(Edition.IEC2022, Mode.CRC16, 0, 3, 0, 3)],
            pcos=Pco.POWER | Pco.LINK | Pco.ACYCLIC | Pco.APP | Pco.LINE | Pco.CLOCK,
            virtual_clock=True,
            resolution=1000,
        )

    def now(self) -> int:
        return self.time

    def set(self, port: int, service: int, value: bytes) -> None:
        assert (port, service, value.hex()) == (0, Service.FSCP_Authenticity, "0000000100000002")

    def smi(self, service: int, port: int, client: int, expected: int, block: bytes) -> SmiResult:
        if service == 3:
            self.see.line(1, 1, 1)
            self.verify_record = block[16:39]
        return self.smi_result._replace(client=client)

    def plug(self, port: int, identity: bytes | None) -> None:
        assert identity is not None and identity.hex() == "11030a0707123456789a"

    def drive(self, port: int, line: int, level: int) -> None:
        self.driven += 1

    def advance(self, ns: int) -> None:
        begin = self.time
        if self.driven == 2 and ns == 2 * MS:
            self.time = begin + 50_000
            self.see.line(1, 4, 1)
            self.time += 250_000
            self.see.mode(1, 1)
            self.time += 1 * MS
            self.see.mode(1, 2)
            self.see.request(1, True, 0x4202, 0, self.verify_record)
        self.time = begin + ns

    def respond(self, port: int, response: int, octets: bytes) -> None:
        assert (port, response, octets) == (1, 2, b"")
        self.see.mode(1, 3)

    def raise_event(self, port: int, code: int, qualifier: int) -> None:
        self.see.indication(port, 1, qualifier, code)


class Page(unittest.TestCase):
    """What PROTOCOL.md prints is answered as it prints it."""

    def check(self, connection: Connection, request: str, answer: str) -> None:
        self.assertEqual(connection.raw(DUMPS[request]).hex(" "), DUMPS[answer].hex(" "), request)

    def test_every_dump_is_one_frame(self) -> None:
        self.assertTrue(DUMPS)
        for name, dump in DUMPS.items():
            (frame,) = FrameReader().feed(dump)
            self.assertEqual(frame.encode(), dump, name)

    def test_device(self) -> None:
        connection = Connection(PageDevice(), greet=False)
        self.check(connection, "hello", "description")
        self.check(connection, "apply", "observed")
        self.check(connection, "made-up", "unsupported")
        self.assertEqual(connection.raw(Frame(0x44, 3, b"").encode()), DUMPS["error"])

    def test_master(self) -> None:
        dut = PageMaster()
        connection = Connection(dut, greet=False)
        self.assertEqual(connection.raw(Frame(fsct_client.HELLO, 4, b"\1\1").encode()), DUMPS["master"])
        dut.smi_result = SmiResult(True, 0, 0x0100, 10, bytes.fromhex("01010000000100000002"))
        self.check(connection, "smi", "smi-result")
        dut.smi_result = SmiResult(False, 0, 0, 0, b"\0\2")
        self.check(connection, "smi", "smi-refused")
        dut.smi_result = SmiResult(True, 0, 0x8100, 2, b"\xff\xf0")
        self.check(connection, "configure-port", "port-configured")
        self.check(connection, "plug", "plugged")
        self.check(connection, "ready-pulse", "started")
        dut.time = 7_700_000
        self.check(connection, "respond", "operating")

    def test_versions(self) -> None:
        """Another version is answered with the own one and nothing else, as the dump does for a DUT of version 2."""
        connection = Connection(PageDevice(), greet=False)
        (answer,) = connection.ask(fsct_client.HELLO, b"\2\3")
        (printed,) = FrameReader().feed(DUMPS["version-2"])
        self.assertEqual((answer.type, answer.payload), (printed.type, b"\1"))
        (answer,) = connection.ask(fsct_client.HELLO, b"\0\xffmore")
        self.assertEqual(answer.payload[:4], b"\1\1\0\1")

    def test_signatures(self) -> None:
        """SPDUs and FSP parameters of the examples."""
        for spdu in "11223301 20A591", "445566FEC0B14D":
            self.assertEqual(CRC16.of_spdu(bytes.fromhex(spdu)[:-2]), bytes.fromhex(spdu)[-2:])
        record = DUMPS["started"][-27:-4]
        self.assertTrue(fs_device.block_right(record[:11]) and fs_device.block_right(record[11:]))
        self.assertEqual(Variant(Edition.IEC2022, Mode.CRC16, 3, 3).io_structure_crc, 0xB27A)
        self.assertEqual((CRC16.of(b"123456789", 1), CRC32.of(b"123456789", 1)), (0xA55C, 0x87D688F7))


class Stream(unittest.TestCase):
    """Frames are found again."""

    def check(self, noise: bytes, frames: int = 1) -> None:
        answer = Connection(PageDevice(), greet=False).raw(noise + DUMPS["hello"])
        self.assertEqual(answer, frames * DUMPS["description"])

    def test_cut_octet_by_octet(self) -> None:
        connection = Connection(PageDevice(), greet=False)
        answers = [connection.raw(bytes([octet])) for octet in DUMPS["hello"] * 2]
        once = [b""] * (len(DUMPS["hello"]) - 1) + [DUMPS["description"]]
        self.assertEqual(answers, once * 2)

    def test_noise(self) -> None:
        for noise in b"boot\r\n", b"\xf5", b"\xf5\xf5\xf5", b"\xc7\xf5", bytes(70000):
            self.check(noise)

    def test_wrong_crc(self) -> None:
        self.check(DUMPS["hello"][:-1] + b"\0")

    def test_false_sync(self) -> None:
        self.check(b"\xf5\xc7\1\0\0\4")  # the length reaches into the frame
        self.check(b"\xf5\xf5\xc7\xf5\xf5\0\4")
        self.check(DUMPS["hello"][:8])

    def test_false_sync_that_waits(self) -> None:
        self.check(b"\xf5\xc7\1\0\2\1")  # 513 octets of payload are more than the DUT takes
        connection = Connection(PageDevice(), greet=False)
        self.assertEqual(connection.raw(b"\xf5\xc7\1\0\2\0" + DUMPS["hello"]), b"")
        self.assertEqual(connection.raw(bytes(512)), DUMPS["description"])


class Messages(unittest.TestCase):
    """What makes no sense is an ERROR, what is not served is unsupported."""

    def error(self, connection: Connection, kind: int, payload: str) -> str:
        (answer,) = connection.ask(kind, bytes.fromhex(payload))
        self.assertEqual((answer.type, answer.sequence), (fsct_client.ERROR, 9))
        return answer.payload.decode()

    def test_errors(self) -> None:
        connection = Connection(FsDevice())
        self.assertEqual(self.error(connection, 0x82, ""), "unknown message 82")
        self.assertEqual(self.error(connection, 1, "01"), "hello without versions")
        self.assertEqual(self.error(connection, 2, "0001 02 0001"), "a TLV is longer than what is left")
        self.assertEqual(self.error(connection, 2, "0001 02 00"), "a TLV is cut")
        for payload in "", "00", "0000 02 0001 01", "0002 02 0001 01":
            self.assertIn("number of stimuli", self.error(connection, 2, payload))
        self.assertEqual(connection.apply((2, "00")), [])

    def test_stimuli_before_hello(self) -> None:
        connection = Connection(FsDevice(), greet=False)
        self.assertEqual(self.error(connection, 2, "0000"), "stimuli before hello")

    def test_unsupported(self) -> None:
        connection = Connection(FsDevice())
        connection.apply((2, "01"))
        for kind in 0, 8, 9, 10, 11, 12, 13, 199, 200, 255:
            self.assertEqual(connection.apply((kind, "01" * 7), (2, "01")), [(0, 7, "")], kind)
        bad = [(1, "02010303"), (2, "02"), (4, "4200"), (5, "4200"), (6, "0103"), (6, "010202"), (7, "00")]
        bad += [(kind, "") for kind in range(13) if kind != 3]
        for stimulus in bad:
            self.assertEqual(connection.apply(stimulus), [(0, 7, "")], stimulus)

    def test_nothing_is_served_by_default(self) -> None:
        class Silent(Dut):
            describe = PageDevice.describe

        connection = Connection(Silent())
        good = {1: "02010303", 2: "01", 4: "420000", 5: "420000", 6: "010200", 7: "0000000000000001"}
        good |= {8: "01", 9: "0102", 10: "01b002f4", 11: "010201", 12: "010012340000"}
        self.assertEqual(connection.apply(*good.items()), [(position, 7, "") for position in range(len(good))])

    def test_exchange_has_an_image_at_all_events(self) -> None:
        connection = Connection(FsDevice())
        connection.apply((2, "01"))
        for value in "0200", "", "03", "0102", "010000", "0101" + "55" * 33:
            self.assertEqual(connection.apply((3, value)), [(0, 7, ""), (0, 1, (value[:2] or "01") + "00")])

    def test_more_observations_than_fit(self) -> None:
        class Talker(PageDevice):
            def power(self, on: bool) -> None:
                for number in range(16):
                    self.see.service(1, Service.PDin_M, bytes([number] * 30))

        connection = Connection(Talker())
        payload = struct.pack(">H", 127) + tlv(2, b"\1") * 127
        answers = connection.ask(fsct_client.APPLY, payload)
        self.assertEqual([answer.payload[0] for answer in answers], [1, 0])
        seen = [one for answer in answers for one in observations(answer.payload)]
        self.assertEqual([position for position, _, _ in seen], [number // 16 for number in range(127 * 16)])

    def test_a_slow_request_is_answered_in_parts(self) -> None:
        self.addCleanup(setattr, fsct_client, "PATIENCE", fsct_client.PATIENCE)
        fsct_client.PATIENCE = -1
        connection = Connection(FsDevice())
        seen = connection.apply((2, "01"), (7, "00" * 8), (3, "0100"))
        self.assertEqual([position for position, _, _ in seen], [0] * 4 + [2, 2])

    def test_text(self) -> None:
        self.assertEqual(text("ä" * 200), "ä".encode() * 127)


def parameterize(connection: Connection, watchdog: int = 20, change: int | None = None) -> list[tuple[int, int, str]]:
    """Both records, then the FSP_VerifyRecord, of which one octet may be changed."""
    dut = connection.session._dut
    assert isinstance(dut, FsDevice)
    first = fs_device.with_crc(struct.pack(">IIB", 0x11223344, 0, 1))
    second = struct.pack(">BBHHI", 1, dut.variant.mode, watchdog, dut.variant.io_structure_crc, 0)
    second = fs_device.with_crc(second)
    verify = bytearray(first + second)
    if change is not None:
        verify[change] ^= 1
    return connection.apply((5, "420000" + first.hex()), (5, "420100" + second.hex()), (5, "420200" + verify.hex()))


class SmallFsDevice(unittest.TestCase):
    def setUp(self) -> None:
        self.connection = Connection(FsDevice())
        self.assertEqual(len(self.connection.apply((2, "01"))), 4)

    def spdu(self, secured: str) -> tuple[int, str]:
        return (3, "0101" + secured + CRC16.of_spdu(bytes.fromhex(secured)).hex())

    def test_start_up(self) -> None:
        self.assertEqual([kind for _, kind, _ in parameterize(self.connection)], [4, 4, 4])
        cycles = [self.spdu("1122330102"), *(self.spdu(f"11223301{MCount << 5:02x}") for MCount in (1, 2, 3))]
        images = [value for _, kind, value in self.connection.apply(*cycles) if kind == 1]
        self.assertEqual([image[10:12] for image in images], ["fe"] * 4)
        self.assertEqual([image[12:14] for image in images], ["e4", "c4", "a4", "80"])
        self.assertEqual(self.connection.apply(self.spdu("4455660180"))[0], (0, 2, "0103445566"))

    def test_a_long_advance_takes_no_time(self) -> None:
        parameterize(self.connection, watchdog=1)
        self.connection.apply(self.spdu("1122330102"))
        self.assertEqual(self.connection.apply((7, "f0" + "00" * 7)), [])
        self.assertEqual(self.connection.apply((7, "f0" + "00" * 7)), [(0, 7, "")])
        ((_, _, image),) = self.connection.apply((3, "0100"))
        self.assertEqual(image[12:14], "e5")

    def test_verify_record(self) -> None:
        codes = {0: "b003", 7: "b003", 8: "b004", 10: "b005", 11: "b006", 16: "b008", 20: "b007", 22: "b006"}
        for change, code in codes.items():
            self.setUp()
            seen = parameterize(self.connection, change=change)
            self.assertEqual(seen[2:], [(2, 6, code + "f4"), (2, 4, "")], change)
            self.assertEqual(self.connection.apply(self.spdu("1122330102")), [(0, 1, "0101" + "00" * 7)])

    def test_no_verify_record(self) -> None:
        self.assertEqual(self.connection.apply((3, "0100"))[0], (0, 6, "b00af4"))

    def test_refusals(self) -> None:
        answers = {
            (4, "000000"): "8011",
            (4, "420200"): "8023",
            (5, "421200"): "8023",
            (4, "420009"): "8012",
            (5, "420200" + "00" * 22): "8034",
            (5, "420200" + "00" * 24): "8033",
            (5, "420200" + "00" * 25): "8033",
            (5, "420201" + "00" * 4): "8012",
            (5, "420000" + "00" * 11): "8030",
            (5, "420000" + "01" * 11): "8041",
        }
        for stimulus, error_type in answers.items():
            self.assertEqual(self.connection.apply(stimulus), [(0, 5, error_type)], stimulus)

    def test_parameters_outlast_the_supply(self) -> None:
        parameterize(self.connection)
        self.connection.apply((2, "00"), (2, "01"))
        self.assertEqual(self.connection.apply((4, "420001")), [(0, 3, "11223344")])
        self.connection.apply((2, "00"), (1, "01020a19"), (2, "01"))
        self.assertEqual(self.connection.apply((4, "420001")), [(0, 3, "00000000")])


class Transport(unittest.TestCase):
    """The program itself."""

    def test_standard_input_and_output(self) -> None:
        program = [sys.executable, str(HERE / "fs_device.py")]
        done = subprocess.run(program, input=b"noise" + DUMPS["hello"], capture_output=True, timeout=10)
        self.assertEqual((done.returncode, done.stderr), (0, b""))
        (answer,) = FrameReader().feed(done.stdout)
        self.assertEqual(answer.type, fsct_client.DESCRIPTION)

    def test_socket(self) -> None:
        """A connection that sends nonsense harms no other."""
        program = [sys.executable, str(HERE / "fs_device.py"), "tcp://127.0.0.1:0"]
        with subprocess.Popen(program, stdout=subprocess.PIPE, text=True) as server:
            self.addCleanup(server.kill)
            assert server.stdout is not None
            port = int(server.stdout.readline().rpartition(":")[2])
            with socket.create_connection(("127.0.0.1", port)) as hostile:
                hostile.sendall(b"\xf5\xc7\xff" * 1000)
                for _ in range(2):
                    with socket.create_connection(("127.0.0.1", port), timeout=10) as good:
                        good.sendall(DUMPS["hello"])
                        self.assertEqual(good.recv(7)[:4], b"\xf5\xc7\x81\0")
            server.kill()


if __name__ == "__main__":
    unittest.main()

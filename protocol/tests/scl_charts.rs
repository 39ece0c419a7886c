//! The six sequence charts of 11.5.4 with both machines of the tables: every counter and flag, and the transitions behind
//! each line. `m` is an SPDU of the FS-Master on its way, `d` an answer of the FS-Device; lines read as in the charts.

use fsct_protocol::scl::device::{Readings, Received};
use fsct_protocol::scl::master::Answer;
use fsct_protocol::scl::{Device, Master, Path};

/// FS-Master and FS-Device on one line.
struct Line {
    master: Master,
    device: Device,
    /// Transitions of each side since its previous SPDU.
    by_master: String,
    by_device: String,
}

fn text(path: Path) -> String {
    path.iter().map(|t| t.to_string()).collect::<Vec<_>>().join(" ")
}

impl Line {
    /// Both just switched on; the FS-Device has its parameters.
    fn off() -> Line {
        let (mut master, mut device) = (Master::new(), Device::new(Readings::default()));
        let (by_master, by_device) = (text(master.start()), text(device.start()));
        Line { master, device, by_master, by_device }
    }

    /// In regular operation, the SPDU with this counter built and on its way.
    fn operating(mcount: u8) -> Line {
        let mut line = Line::off();
        for _ in 0..20 {
            if line.master.control().mcount == mcount && line.device.get(fsct_protocol::scl::Var::SdCycles) == 0 {
                break;
            }
            line.deliver(true);
            line.answer(true);
        }
        assert_eq!(line.master.control().mcount, mcount);
        line
    }

    fn deliver(&mut self, intact: bool) {
        let path = self.device.receive(Received { control: self.master.control(), intact });
        if !path.is_empty() {
            let before = if self.by_device == "T20" { "T20 " } else { "" };
            self.by_device = format!("{before}{}", text(path));
        }
    }

    fn answer(&mut self, intact: bool) {
        let path = self.master.receive(Answer { status: self.device.status(), intact });
        if !path.is_empty() {
            self.by_master = text(path);
        }
    }

    #[track_caller]
    fn check_m(&self, mcount: u8, set_sd: u8, ch_f_ack_req: u8, via: &str) {
        let control = self.master.control();
        let found = (control.mcount, u8::from(control.set_sd), u8::from(control.ch_f_ack_req));
        assert_eq!(found, (mcount, set_sd, ch_f_ack_req), "MCount, setSD, ChFAckReq");
        assert_eq!(self.by_master, via);
    }

    /// The FS-Master's SPDU arrives.
    #[track_caller]
    fn m(&mut self, mcount: u8, set_sd: u8, ch_f_ack_req: u8, via: &str) {
        self.check_m(mcount, set_sd, ch_f_ack_req, via);
        self.deliver(true);
    }

    /// The FS-Master's SPDU arrives with a wrong signature.
    #[track_caller]
    fn m_hit(&mut self, mcount: u8, set_sd: u8, ch_f_ack_req: u8, via: &str) {
        self.check_m(mcount, set_sd, ch_f_ack_req, via);
        self.deliver(false);
    }

    #[track_caller]
    fn check_d(&self, dcount_i: u8, sd_set: u8, d_comm_err: u8, d_timeout: u8, via: &str) {
        let status = self.device.status();
        let found = (status.dcount_i, u8::from(status.sd_set), u8::from(status.d_comm_err), u8::from(status.d_timeout));
        assert_eq!(found, (dcount_i, sd_set, d_comm_err, d_timeout), "DCount_i, SDset, DCommErr, DTimeout");
        assert_eq!(self.by_device, via);
    }

    /// The FS-Device's answer arrives.
    #[track_caller]
    fn d(&mut self, dcount_i: u8, sd_set: u8, d_comm_err: u8, d_timeout: u8, via: &str) {
        self.check_d(dcount_i, sd_set, d_comm_err, d_timeout, via);
        self.answer(true);
    }

    /// The FS-Device's answer arrives with a wrong signature.
    #[track_caller]
    fn d_hit(&mut self, dcount_i: u8, sd_set: u8, d_comm_err: u8, d_timeout: u8, via: &str) {
        self.check_d(dcount_i, sd_set, d_comm_err, d_timeout, via);
        self.answer(false);
    }

    /// A regular cycle, counter and mirror.
    #[track_caller]
    fn cycle(&mut self, mcount: u8) {
        self.m(mcount, 0, 0, "T6 T4 T5");
        self.d(7 - mcount, 0, 0, 0, "T24 T22 T23");
    }

    /// SD cycles at start, MCount 0 to 2, then two regular cycles.
    #[track_caller]
    fn start(&mut self) {
        self.m(0, 1, 0, "T1 T2");
        self.d(7, 1, 0, 0, "T20 T21 T22 T23");
        self.m(1, 0, 0, "T3 T4 T5");
        self.d(6, 1, 0, 0, "T24 T22 T23");
        self.m(2, 0, 0, "T6 T4 T5");
        self.d(5, 1, 0, 0, "T24 T22 T23");
        self.cycle(3);
        self.cycle(4);
        self.cycle(5);
    }

    fn switch_device_on(&mut self) {
        self.device = Device::new(Readings::default());
        self.by_device = text(self.device.start());
    }

    fn m_timer_expires(&mut self) {
        self.by_master = text(self.master.expire());
    }
}

#[test]
fn both_power_on() {
    let mut line = Line::off();
    line.start();
    line.cycle(6);
    line.cycle(7);
    line.cycle(1);
    line.cycle(2);
}

#[test]
fn fs_master_off_and_on() {
    let mut line = Line::operating(4);
    // The FS-Master is gone; DTimer expires after MCount 3.
    line.by_device = text(line.device.expire());
    line.check_d(4, 1, 0, 1, "T31 T26");
    let mut line = Line::off();
    line.start();
}

#[test]
fn fs_device_with_delayed_start() {
    let mut line = Line::off();
    for _ in 0..4 {
        // The black channel repeats the first SPDU; an image of all zero is no answer.
        line.check_m(0, 1, 0, "T1 T2");
        assert!(line.master.expire().is_empty(), "no timer runs in state 2");
    }
    line.start();
}

#[test]
fn fs_device_off_and_on() {
    let mut line = Line::operating(5);
    line.check_m(5, 0, 0, "T6 T4 T5");
    line.m_timer_expires();
    line.check_m(0, 1, 0, "T8 T9");
    line.m_timer_expires();
    line.switch_device_on();
    line.m(0, 1, 0, "T14 T9");
    line.d(7, 1, 0, 0, "T20 T21 T22 T23");
    line.m(1, 1, 1, "T10 T13 T9");
    line.d(6, 1, 0, 0, "T24 T22 T23");
    line.m(2, 1, 1, "T10 T13 T9");
    line.d(5, 1, 0, 0, "T24 T22 T23");
    line.m(3, 1, 1, "T10 T13 T9");
    line.master.set_ch_f_ack_c(true);
    line.d(4, 0, 0, 0, "T24 T22 T23");
    line.m(4, 0, 0, "T10 T11 T5");
    line.d(3, 0, 0, 0, "T24 T22 T23");
    line.cycle(5);
}

#[test]
fn fs_master_detects_a_crc_error() {
    let mut line = Line::operating(3);
    line.m(3, 0, 0, "T6 T4 T5");
    line.d_hit(4, 0, 0, 0, "T24 T22 T23");
    line.m(4, 1, 0, "T6 T7 T9");
    line.d(3, 0, 0, 0, "T24 T22 T23");
    line.m(5, 1, 1, "T10 T13 T9");
    line.d(2, 0, 0, 0, "T24 T22 T23");
    line.m(6, 1, 1, "T10 T13 T9");
    line.d(1, 0, 0, 0, "T24 T22 T23");
    line.m(7, 1, 1, "T10 T13 T9");
    line.master.set_ch_f_ack_c(true);
    line.d(0, 0, 0, 0, "T24 T22 T23");
    line.m(1, 0, 0, "T10 T11 T5");
    line.d(6, 0, 0, 0, "T24 T22 T23");
    line.cycle(2);
}

#[test]
fn fs_device_detects_a_crc_error() {
    let mut line = Line::operating(2);
    line.cycle(2);
    line.m_hit(3, 0, 0, "T6 T4 T5");
    line.d(4, 1, 1, 0, "T24 T25 T26");
    line.m(4, 1, 0, "T6 T7 T9");
    line.d(3, 1, 1, 0, "T27 T29 T26");
    line.m(5, 1, 0, "T10 T12 T9");
    line.d(2, 1, 0, 0, "T27 T29 T26");
    line.m(6, 1, 1, "T10 T13 T9");
    line.d(1, 1, 0, 0, "T27 T29 T26");
    line.m(7, 1, 1, "T10 T13 T9");
    line.master.set_ch_f_ack_c(true);
    line.d(0, 0, 0, 0, "T27 T28 T23");
    line.m(1, 0, 0, "T10 T11 T5");
    line.d(6, 0, 0, 0, "T24 T22 T23");
    line.cycle(2);
}

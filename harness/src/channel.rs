//! The way back: what reaches a conformant partner in place of what the DUT presents.

use crate::case::model::Back;
use crate::link::Link;
use crate::oracle::Setup;
use crate::tester::Tester;
use fsct_adapters::Octets;
use fsct_protocol::spdu::{Pd, View, Wire, succ};

/// The black channel from the DUT to the partner.
#[derive(Debug)]
pub struct Channel {
    back: Option<Back>,
    /// On the clock of the DUT; `None`: until one SPDU has been disturbed.
    until: Option<u64>,
    /// What comes late.
    held: Option<Octets>,
}

impl Channel {
    /// Disturbs the first SPDU that is new to the partner, or everything until this time; `None` disturbs nothing.
    pub const fn new(back: Option<Back>, until: Option<u64>) -> Channel {
        Channel { back, until, held: None }
    }

    /// What is wrong with the way back at this time, for the record.
    pub fn note(&self, now: u64) -> Option<String> {
        match self.back {
            Some(back) if self.until.is_none_or(|until| now < until) => {
                Some(format!("on the way back: {}", describe(back)))
            }
            _ => None,
        }
    }

    /// What the partner receives after this exchange. `own` is what it sends itself, `is_new` tells by its counter whether it
    /// has not yet taken an SPDU.
    pub fn pass(
        &mut self,
        now: u64,
        link: &Link,
        tester: &mut Tester,
        own: Option<Octets>,
        is_new: impl Fn(u8) -> bool,
    ) -> Option<Octets> {
        let (image, setup) = (link.image, link.oracle.setup());
        let Some(back) = self.back else { return image };
        let view = setup.view(image.as_ref());
        let fresh = view.is_some_and(|view| is_new(view.counter()));
        match self.until {
            Some(until) if now >= until => {
                self.back = None;
                return self.held.take().or(image);
            }
            None if !fresh => return image,
            None if back != Back::Late => self.back = None,
            None => self.until = Some(now),
            Some(_) => {}
        }
        match back {
            Back::Lost => None,
            Back::Late => {
                self.held = self.held.or(image.filter(|_| fresh));
                None
            }
            Back::Echo => own,
            Back::Ago(count) => link.earlier.get(count - 1).copied().flatten(),
            Back::Corrupt | Back::Counter | Back::Foreign | Back::Standard => {
                let (Some(view), Some(image)) = (view, image) else { return image };
                let octets = forged(back, view, setup, tester);
                let mut whole = image.as_slice().to_vec();
                whole.iter_mut().zip(octets).for_each(|(octet, forged)| *octet = forged);
                Octets::new(&whole)
            }
        }
    }
}

/// An SPDU made of the one there is.
fn forged(back: Back, view: View<'_>, setup: &Setup, tester: &mut Tester) -> Vec<u8> {
    let counter = |octet: u8| succ(succ(octet >> 5)) << 5 | octet & 0x1F;
    let port = setup.port.number();
    let other = if port == 255 { 254 } else { port + 1 };
    let (pd, mut port_num, mut octet) = (Pd::new(view.pd()), view.port_num(), view.octet());
    match back {
        Back::Counter => octet = counter(octet),
        Back::Foreign => port_num = if port_num == port { other } else { !other },
        Back::Standard => {
            let mut octets = tester.pattern(setup.mode.spdu_octets(view.pd().len()));
            if let Some(place) = octets.get_mut(view.pd().len() + 1) {
                *place = view.octet() & 0xE0 | *place & 0x1F;
            }
            return octets;
        }
        _ => {}
    }
    let signature = (back == Back::Corrupt).then_some(view.signature() ^ 1);
    let wire = Wire { pd: pd.unwrap_or(Pd::safe(view.pd().len())), port_num, octet, signature };
    wire.emit(setup.mode, setup.reading).octets().to_vec()
}

fn describe(back: Back) -> String {
    match back {
        Back::Corrupt => "a falsified signature".to_owned(),
        Back::Counter => "a counter two further".to_owned(),
        Back::Foreign => "the PortNum of another port".to_owned(),
        Back::Standard => "standard process data".to_owned(),
        Back::Echo => "the partner's own SPDU".to_owned(),
        Back::Lost => "lost".to_owned(),
        Back::Late => "held back".to_owned(),
        Back::Ago(count) => format!("the image {count} before"),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::oracle::Mask;
    use fsct_adapters::Role;
    use fsct_protocol::crc::Reading;
    use fsct_protocol::spdu::{InSpdu, Port, Status};
    use fsct_protocol::{Edition, ProtMode};
    use rand_pcg::Pcg64Mcg;
    use rstest::rstest;

    /// An FS-Device on port 1, two octets of process data each way, CRC-16.
    pub(crate) fn setup() -> Setup {
        Setup {
            role: Role::Device,
            edition: Edition::Iec2022,
            mode: ProtMode::Crc16,
            pd_out: 2,
            pd_in: 2,
            port: Port::new(1).expect("1 is a port"),
            reading: Reading::Preset,
            cycle_ns: 1,
            watchdog_ns: 20,
            tick_ns: 0,
            margin_ns: 2,
            uncertainty_ns: 0,
            latency: 0,
            scl_start_ns: 0,
            allowed: Mask::NONE,
            app: true,
        }
    }

    fn answer(dcount_i: u8) -> Option<Octets> {
        let status = Status { dcount_i, ..Status::default() };
        let spdu = InSpdu { pd: Pd::new(&[5, 6]).expect("two octets"), port: setup().port, status };
        Octets::new(spdu.wire().emit(ProtMode::Crc16, Reading::Preset).octets())
    }

    /// A link on which the answers 5, 4 and 3 were presented, 3 last.
    fn link() -> Link {
        let mut link = Link::new(1, setup());
        for dcount_i in [5, 4, 3] {
            // The oracle of a DUT without supply judges nothing.
            link.exchange(0, None, answer(dcount_i)).expect("nothing is judged");
        }
        link
    }

    fn tester() -> Tester {
        Tester::new(&setup(), Pcg64Mcg::new(1))
    }

    fn own() -> Option<Octets> {
        Octets::new(&[9; 6])
    }

    /// What a partner receives that waits for 3.
    fn passed(back: Back) -> Option<Octets> {
        Channel::new(Some(back), None).pass(0, &link(), &mut tester(), own(), |counter| counter == 3)
    }

    #[rstest]
    #[case::corrupt(Back::Corrupt, 3, 0xFE, false)]
    #[case::counter(Back::Counter, 5, 0xFE, true)]
    #[case::foreign(Back::Foreign, 3, 0xFD, true)]
    fn a_forged_spdu_differs_in_one_thing(
        #[case] back: Back,
        #[case] counter: u8,
        #[case] port_num: u8,
        #[case] right: bool,
    ) {
        let (setup, octets) = (setup(), passed(back));
        let view = setup.view(octets.as_ref()).expect("an SPDU");
        assert_eq!(
            (view.counter(), view.port_num(), view.signature_matches(Reading::Preset)),
            (counter, port_num, right)
        );
        assert_eq!(view.pd(), [5, 6]);
    }

    #[test]
    fn standard_process_data_read_as_the_awaited_counter() {
        let (setup, octets) = (setup(), passed(Back::Standard));
        let view = setup.view(octets.as_ref()).expect("as long as an SPDU");
        assert_eq!((view.counter(), view.signature_matches(Reading::Preset)), (3, false));
    }

    #[rstest]
    #[case::lost(Back::Lost, None)]
    #[case::late(Back::Late, None)]
    #[case::echo(Back::Echo, own())]
    #[case::the_one_before(Back::Ago(1), answer(4))]
    #[case::the_one_before_that(Back::Ago(2), answer(5))]
    fn something_else_comes_in_its_place(#[case] back: Back, #[case] octets: Option<Octets>) {
        assert_eq!(passed(back), octets);
    }

    #[test]
    fn only_the_first_spdu_that_is_new_is_disturbed() {
        let (mut back, mut tester) = (Channel::new(Some(Back::Lost), None), tester());
        let mut pass = |awaited| back.pass(0, &link(), &mut tester, None, |counter| counter == awaited);
        assert_eq!([pass(2), pass(3), pass(3)], [answer(3), None, answer(3)]);
    }

    #[test]
    fn for_a_time_everything_is_disturbed_and_what_was_held_back_comes_then() {
        let (mut back, mut tester, mut link) = (Channel::new(Some(Back::Late), Some(3)), tester(), link());
        let mut pass = |now, link: &Link| back.pass(now, link, &mut tester, None, |counter| counter == 3);
        assert_eq!([pass(1, &link), pass(2, &link)], [None, None]);
        link.exchange(3, None, answer(2)).expect("nothing is judged");
        assert_eq!([pass(3, &link), pass(4, &link)], [answer(3), answer(2)]);
    }
}

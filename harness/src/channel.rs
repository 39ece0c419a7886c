//! The way back: what reaches a conformant partner in place of what the DUT presents.

use crate::case::model::Back;
use crate::session::Session;
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
        session: &Session<'_>,
        tester: &mut Tester,
        own: Option<Octets>,
        is_new: impl Fn(u8) -> bool,
    ) -> Option<Octets> {
        let image = session.link().image;
        let Some(back) = self.back else { return image };
        let view = session.setup().view(image.as_ref());
        let fresh = view.is_some_and(|view| is_new(view.counter()));
        match self.until {
            Some(until) if session.now >= until => {
                self.back = None;
                return self.held.take().or(image);
            }
            None if !fresh => return image,
            None if back != Back::Late => self.back = None,
            None => self.until = Some(session.now),
            Some(_) => {}
        }
        match back {
            Back::Lost => None,
            Back::Late => {
                self.held = self.held.or(image.filter(|_| fresh));
                None
            }
            Back::Echo => own,
            Back::Ago(count) => session.link().earlier.get(count - 1).copied().flatten(),
            Back::Corrupt | Back::Counter | Back::Foreign | Back::Standard => {
                let (Some(view), Some(image)) = (view, image) else { return image };
                let octets = self.forged(back, view, session, tester);
                let mut whole = image.as_slice().to_vec();
                whole.iter_mut().zip(octets).for_each(|(octet, forged)| *octet = forged);
                Octets::new(&whole)
            }
        }
    }

    /// An SPDU made of the one there is.
    fn forged(&self, back: Back, view: View<'_>, session: &Session<'_>, tester: &mut Tester) -> Vec<u8> {
        let setup = session.setup();
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

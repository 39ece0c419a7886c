//! Lines that lose, repeat, change and hold back octets: what is answered is right, and what is not is no fault of the DUT.

use crate::board::*;
use crate::common::*;
use crate::{HASTY, apply};
use fsct_adapters::{Dut, DutError, Seen, connect};
use rstest::rstest;

const BATCHES: u8 = 20;

#[rstest]
#[case::healthy(Ailment::default())]
#[case::loses(Ailment { lost: 4, ..Ailment::default() })]
#[case::repeats(Ailment { repeated: 4, ..Ailment::default() })]
#[case::changes(Ailment { changed: 4, ..Ailment::default() })]
#[case::holds_back(Ailment { held: 4, ..Ailment::default() })]
#[case::is_noisy(Ailment { noise: 8, ..Ailment::default() })]
#[case::has_everything(Ailment { lost: 1, repeated: 1, changed: 1, held: 2, noise: 40 })]
fn no_answer_is_wrong_and_no_dut_is_blamed(#[case] ailment: Ailment) {
    let (port, path) = line();
    ailing_board(port, ailment, 0x10_11_15);
    let blameless = |error: &DutError| matches!(error, DutError::Timeout { .. } | DutError::Line { .. });
    let mut connection: Option<Box<dyn Dut>> = None;
    let (mut answered, mut lost) = (0, 0);
    for number in 1..=BATCHES {
        let outcome = match connection.take() {
            Some(dut) => Ok(dut),
            None => {
                let mut dut = connect(&address(&path, HASTY)).unwrap();
                dut.hello().map(|_| dut)
            }
        };
        let outcome = outcome.and_then(|mut dut| {
            let observed = apply(dut.as_mut(), &[exchange(&[number, 2]), exchange(&[number, 4])])?;
            // A mirror shows in the second exchange what came in the first.
            let image = Seen::Image { port: 1, octets: Some(octets(&[number, 2])) };
            assert_eq!(observed.last().map(|last| &last.seen), Some(&image));
            connection = Some(dut);
            Ok(())
        });
        match outcome {
            Ok(()) => answered += 1,
            Err(error) => {
                assert!(blameless(&error), "{error:?}");
                lost += 1;
            }
        }
    }
    assert!(answered >= BATCHES / 4, "{answered} answered, {lost} lost");
    let Ailment { lost: loses, repeated, changed, held, .. } = ailment;
    assert!(lost > 0 || loses + repeated + changed + held == 0, "the line does nothing to octets");
}

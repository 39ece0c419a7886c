//! Random faults of all classes between random inputs of the application.
//!
//! A campaign is cut into episodes: each switches the DUT on, brings it to operation and carries its own list of actions out.
//! So memory stays flat however long the campaign is, and what failed is repeated from its episode alone.

use super::action::{Action, Script};
use super::finding::Halt;
use super::stage::{Ran, Tally, Target};
use crate::campaign::Bench;
use crate::trace::hex;
use fsct_adapters::{Offer, Role, Variant};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Exchanges of an episode, about.
pub const EPISODE: u64 = 1_000;

/// What a random campaign is asked for.
#[derive(Clone, Debug)]
pub struct Campaign {
    /// Exchanges in all, at least.
    pub exchanges: u64,
    /// Faults among them.
    pub faults: u64,
    /// Seed of everything.
    pub seed: u64,
    /// What the DUT may be made; every episode takes one of them.
    pub offers: Vec<Offer>,
    /// FS process data to the DUT in octets, when not random.
    pub pd: Option<u8>,
    /// FSP_Watchdog in cycles.
    pub watchdog_cycles: u64,
}

impl Campaign {
    /// Episodes there will be.
    pub fn episodes(&self) -> u64 {
        self.exchanges.div_ceil(EPISODE).max(1)
    }

    /// The list of an episode.
    pub fn script(&self, role: Role, episode: u64) -> Option<Script> {
        let mut rng = Random(Pcg64Mcg::seed_from_u64(self.seed.rotate_left(17) ^ episode));
        let offer = *self.offers.get(rng.below(self.offers.len() as u64) as usize)?;
        let mut within = |range: (u8, u8)| range.0 + rng.below(u64::from(range.1 - range.0) + 1) as u8;
        let (mut pd_out, mut pd_in) = (within(offer.pd_out), within(offer.pd_in));
        match (role, self.pd) {
            (Role::Device, Some(pd)) => pd_out = pd,
            (Role::Master, Some(pd)) => pd_in = pd,
            _ => {}
        }
        let variant = Variant { edition: offer.edition, mode: offer.mode, pd_out, pd_in };
        let episodes = self.episodes();
        let share = |upto: u64| (u128::from(self.faults) * u128::from(upto) / u128::from(episodes)) as u64;
        let faults = share(episode + 1) - share(episode);
        let seed = rng.0.next_u64();
        let mut actions = Vec::new();
        let sent = if role == Role::Device { pd_out } else { pd_in };
        let length = offer.mode.spdu_octets(sent.into()) as u64;
        let gap = (EPISODE / (faults + 1)).max(1);
        for _ in 0..faults {
            if rng.below(4) == 0 {
                actions.push(set(role, variant, &mut rng));
            }
            let good = rng.below(2 * gap);
            if good > 0 {
                actions.push(Action::Good(good as u32));
            }
            actions.push(self.fault(length, &mut rng));
        }
        // Faults take cycles of their own; what is left of the episode is good.
        let done: u64 = actions.iter().map(cycles).sum();
        actions.push(Action::Good(EPISODE.saturating_sub(done).max(1) as u32));
        Some(Script { role, variant, seed, actions })
    }

    fn fault(&self, length: u64, rng: &mut Random) -> Action {
        // Mostly short, now and then beyond the watchdog.
        let long = |rng: &mut Random| {
            let most = if rng.below(8) == 0 { self.watchdog_cycles + 4 } else { 4 };
            (1 + rng.below(most)).min(10_000) as u16
        };
        match rng.below(9) {
            0 => {
                let mut bits: Vec<u16> = (0..1 + rng.below(5)).map(|_| rng.below(8 * length) as u16).collect();
                bits.sort_unstable();
                bits.dedup();
                Action::Corrupt(bits)
            }
            1 => Action::Repeat(rng.below(8) as u8),
            2 => Action::Sequence(1 + rng.below(6) as u8),
            3 => Action::Lose(long(rng)),
            4 => Action::Delay(long(rng)),
            5 => Action::Insert(hex(&rng.octets(length as usize))),
            6 => Action::Masquerade(rng.below(8) as u8),
            7 => Action::LoopBack,
            _ => Action::OtherPort(1 + rng.below(7) as u8),
        }
    }

    /// Carries the campaign out up to the first failure; `told` hears of every episode. The result is the list that did not
    /// come to its end.
    pub fn run(
        &self,
        target: &Target<'_>,
        bench: &mut Bench,
        tally: &mut Tally,
        mut told: impl FnMut(u64),
    ) -> Option<(Script, usize, Halt)> {
        for episode in 0..self.episodes() {
            let script = self.script(target.profile.role, episode)?;
            let Ran { tally: part, halt, .. } = target.perform(bench, &script);
            tally.add(&part);
            told(tally.exchanges);
            if let Some((at, halt)) = halt {
                return Some((script, at, halt));
            }
        }
        None
    }
}

fn cycles(action: &Action) -> u64 {
    match action {
        Action::Good(count) => u64::from(*count),
        Action::Lose(count) | Action::Delay(count) => u64::from(*count),
        Action::Set(..) => 0,
        _ => 1,
    }
}

fn set(role: Role, variant: Variant, rng: &mut Random) -> Action {
    let (data, length, force) = match role {
        Role::Device => ("PDin_D", variant.pd_in, "SDset_DS"),
        Role::Master => ("PDout_M", variant.pd_out, "setSD_C"),
    };
    let bit = hex(&[rng.below(2) as u8]);
    match rng.below(3) {
        0 => Action::Set(data.to_owned(), hex(&rng.octets(length.into()))),
        1 if role == Role::Master => Action::Set("ChFAck_C".to_owned(), bit),
        _ => Action::Set(force.to_owned(), bit),
    }
}

struct Random(Pcg64Mcg);

impl Random {
    /// From 0 to `limit` - 1; 0 when there is no room.
    fn below(&mut self, limit: u64) -> u64 {
        self.0.next_u64() % limit.max(1)
    }

    fn octets(&mut self, length: usize) -> Vec<u8> {
        (0..length).map(|_| self.below(256) as u8).collect()
    }
}

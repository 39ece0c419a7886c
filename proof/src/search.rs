//! Breadth first over every reachable state, so that the first violation met is a shortest one.

use crate::exchange::{Around, Joint, Step, World};
use crate::property::{Property, Seen, Watched};
use fsct_protocol::scl::State;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// A state of a search, packed: both machines, both timers, the disturbed exchanges left, the monitor.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
struct Key(u64);

/// No number of disturbed exchanges: any may follow. Above [`crate::Model::FAULTS`], and as they in four bits.
const UNLIMITED: u8 = 15;

impl Key {
    /// Machines have 18 bits each ([`World::MACHINES`]); timers stay below [`crate::Model::WATCHDOGS`] and have four.
    fn new(joint: Joint, left: u8, monitor: u16) -> Key {
        let machines = u64::from(joint.master) | u64::from(joint.device) << 18;
        let timers = u64::from(joint.mtimer) | u64::from(joint.dtimer) << 4;
        Key(machines | timers << 36 | u64::from(left) << 44 | u64::from(monitor) << 48)
    }

    fn open(self) -> (Joint, u8, u16) {
        let machine = |shift: u32| (self.0 >> shift) as u32 & (World::MACHINES as u32 - 1);
        let four = |shift: u32| (self.0 >> shift) as u8 & 0xF;
        let joint = Joint { master: machine(0), device: machine(18), mtimer: four(36), dtimer: four(40) };
        (joint, four(44), (self.0 >> 48) as u16)
    }
}

/// Keys are made by us, so a multiplication spreads them well enough, and the same on every machine.
#[derive(Default)]
pub(crate) struct Spread(u64);

impl Hasher for Spread {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, octets: &[u8]) {
        for octets in octets.chunks(8) {
            let mut word = [0; 8];
            word.iter_mut().zip(octets).for_each(|(to, octet)| *to = *octet);
            self.write_u64(u64::from_le_bytes(word));
        }
    }

    fn write_u8(&mut self, value: u8) {
        self.write_u64(value.into());
    }

    fn write_u32(&mut self, value: u32) {
        self.write_u64(value.into());
    }

    fn write_u64(&mut self, value: u64) {
        let product = u128::from(value ^ self.0) * 0x9E37_79B9_7F4A_7C15;
        self.0 = (product >> 64) as u64 ^ product as u64;
    }

    fn write_usize(&mut self, value: usize) {
        self.write_u64(value as u64);
    }

    fn write_isize(&mut self, value: isize) {
        self.write_u64(value as u64);
    }
}

/// A map whose keys are spread so.
pub(crate) type Table<K, V> = HashMap<K, V, BuildHasherDefault<Spread>>;

/// What a search found.
pub struct Found {
    /// States kept.
    pub states: usize,
    /// Exchanges tried.
    pub steps: u64,
    /// Most exchanges on a shortest way to a state.
    pub depth: usize,
    /// The largest measure met.
    pub worst: u8,
    /// How it ended.
    pub end: End,
    /// Octets its tables take.
    pub octets: usize,
}

/// How a search ended.
pub enum End {
    /// Everything reachable was seen, and the measure stayed within its bound.
    Complete,
    /// A shortest way beyond the bound, from the start.
    Beyond(Vec<Step>),
    /// More states than [`crate::Model::most_states`], or more machines than there are numbers for them.
    TooMany,
}

/// The states met in a search, in the order in which they were met.
pub(crate) struct States {
    keys: Vec<Key>,
    parents: Vec<u32>,
    numbers: Table<Key, u32>,
}

impl States {
    fn new(start: Key) -> States {
        let mut states = States { keys: Vec::new(), parents: Vec::new(), numbers: Table::default() };
        states.add(start, 0);
        states
    }

    fn add(&mut self, key: Key, parent: u32) {
        let number = self.keys.len() as u32;
        self.numbers.entry(key).or_insert_with(|| {
            self.keys.push(key);
            self.parents.push(parent);
            number
        });
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.keys.len()
    }

    /// Both machines of a state.
    pub(crate) fn joint(&self, number: usize) -> Joint {
        self.keys[number].open().0
    }

    /// The states from the start to this one.
    fn way(&self, number: usize) -> Vec<Key> {
        let mut way = vec![self.keys[number]];
        let mut at = number;
        while at != 0 {
            at = self.parents[at] as usize;
            way.push(self.keys[at]);
        }
        way.reverse();
        way
    }

    fn octets(&self) -> usize {
        self.keys.capacity() * size_of::<Key>()
            + self.parents.capacity() * size_of::<u32>()
            + self.numbers.capacity() * (size_of::<(Key, u32)>() + 1) * 8 / 7
    }
}

fn watch(world: &World, property: Option<&Property>, from: Joint, step: &Step, monitor: u16) -> Watched {
    let seen = Seen {
        model: world.model(),
        from,
        started: world.master(from.master).state() != State(2),
        step,
        master: world.master(step.to.master),
        device: world.device(step.to.device),
    };
    property.and_then(|property| property.watch).map_or(Watched::default(), |watch| watch(&seen, monitor))
}

/// What is behind a step: the measure of the property, and the keys; `None` where too many exchanges would be disturbed.
fn behind(world: &World, property: Option<&Property>, key: Key, step: &Step) -> Option<(u8, [Option<Key>; 2])> {
    let (from, left, monitor) = key.open();
    let left = match (step.disturbed(), left) {
        (false, _) | (true, UNLIMITED) => left,
        (true, left) => left.checked_sub(1)?,
    };
    let Watched { monitor, fork, measure } = watch(world, property, from, step, monitor);
    Some((measure, [Some(monitor), fork].map(|monitor| Some(Key::new(step.to, left, monitor?)))))
}

fn steps_on(world: &mut World, property: Option<&Property>, key: Key) -> Vec<Step> {
    let (from, _, monitor) = key.open();
    world.steps(from, property.map_or(Around::Free, |property| property.around(monitor)))
}

/// Explores a world, watched by a property.
pub fn search(world: &mut World, property: Option<&Property>) -> Found {
    explore(world, property).0
}

/// As [`search`], with the states.
pub(crate) fn explore(world: &mut World, property: Option<&Property>) -> (Found, States) {
    let bound = property.map_or(u8::MAX, |property| (property.bound)(world.model()));
    let most = world.model().most_states.min(u32::MAX as usize);
    let start = Key::new(world.start(), world.model().faults.unwrap_or(UNLIMITED), 0);
    let mut states = States::new(start);
    let (mut at, mut layer, mut depth, mut steps, mut worst) = (0, 1, 0, 0, 0);
    let mut end = End::Complete;
    'all: while at < states.len() {
        if at == layer {
            (layer, depth) = (states.len(), depth + 1);
        }
        let from = states.keys[at];
        let possible = steps_on(world, property, from);
        if world.is_full() {
            end = End::TooMany;
            break;
        }
        for step in possible {
            let Some((measure, keys)) = behind(world, property, from, &step) else { continue };
            steps += 1;
            worst = worst.max(measure);
            if measure > bound {
                let mut beyond = steps_of(world, property, &states.way(at));
                beyond.push(step);
                end = End::Beyond(beyond);
                break 'all;
            }
            keys.into_iter().flatten().for_each(|key| states.add(key, at as u32));
        }
        if states.len() > most || world.is_full() {
            end = End::TooMany;
            break;
        }
        at += 1;
    }
    let found = Found { states: states.len(), steps, depth, worst, end, octets: states.octets() };
    (found, states)
}

/// The steps along a way.
fn steps_of(world: &mut World, property: Option<&Property>, way: &[Key]) -> Vec<Step> {
    way.windows(2)
        .filter_map(|pair| {
            let [from, to] = pair else { return None };
            steps_on(world, property, *from)
                .into_iter()
                .find(|step| behind(world, property, *from, step).is_some_and(|(_, keys)| keys.contains(&Some(*to))))
        })
        .collect()
}

/// The steps from the start to a state of a search without a property.
pub(crate) fn steps_to(world: &mut World, states: &States, number: usize) -> Vec<Step> {
    steps_of(world, None, &states.way(number))
}

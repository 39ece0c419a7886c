//! Which cases run on a DUT, and which do not with the exact term that excluded them.

use crate::case::{Binding, Case};
use crate::library::{Library, needs};
use crate::problem::Problem;
use crate::profile::{Parameterization, Profile};
use crate::structure::{self, Declared};
use fsct_adapters::{ClockKind, Description, Offer, Pco, Role};
use fsct_protocol::Edition;
use std::borrow::Cow;

/// What tells the runs of one case apart in its key.
pub const REPEAT: &str = "run";
/// The longest FSP_Watchdog a case chooses on a real clock unless the user asks for more: it is lived through several times.
const LONG_MS: u16 = 1_000;

/// One expanded case.
#[derive(Clone, Debug)]
pub struct Planned<'l> {
    /// The case.
    pub case: &'l Case,
    /// The point of its sweep.
    pub binding: Binding,
    /// Unique key.
    pub key: String,
}

impl Planned<'_> {
    /// The profile the case is judged by: that of the run, with the FSP_Watchdog the case chooses.
    pub fn profile<'p>(&self, profile: &'p Profile, clock: ClockKind) -> Cow<'p, Profile> {
        match self.binding.watchdog_ms() {
            Some(ms) => Cow::Owned(profile.with_watchdog(ms, clock)),
            None => Cow::Borrowed(profile),
        }
    }
}

/// The feature of cases for gateways of a safety fieldbus, which need not be FS-Masters.
const GATEWAY: &str = "gateway";

/// What runs, in order.
#[derive(Debug, Default)]
pub struct Plan<'l> {
    /// Cases to run.
    pub cases: Vec<Planned<'l>>,
    /// Cases selected but not applicable: key, then the term.
    pub not_applicable: Vec<(String, String)>,
}

/// What the user asked for.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// Names of suites or of groups of suites; empty: all.
    pub suites: Vec<String>,
    /// Terms that all have to match: see [`Selection::matches`].
    pub filter: Vec<String>,
    /// One edition only.
    pub edition: Option<Edition>,
    /// Every n-th case from the i-th on, i from 1.
    pub shard: Option<(usize, usize)>,
    /// How often each case runs; [`REPEAT`] in the key tells them apart. 0 and 1: once, and the key stays as it is.
    pub repeat: u32,
    /// On a real clock: also cases with an FSP_Watchdog above 1 s.
    pub long: bool,
    /// How deep: cases that say a greater `depth` are left out.
    pub depth: u8,
}

impl Selection {
    /// Whether a case is selected. A term is `suite:NAME`, `req:R-...`, `covers:T25`, or a text that occurs in the key or
    /// title, with `*` for anything in between.
    pub fn matches(&self, planned: &Planned<'_>) -> bool {
        let Planned { case, key, binding } = planned;
        let group = case.group.as_ref();
        self.edition.is_none_or(|edition| binding.variant.edition == edition)
            && self.filter.iter().all(|term| match term.split_once(':') {
                Some(("suite", name)) => case.suite == name || group.is_some_and(|group| group == name),
                Some(("req", id)) => case.requirements.iter().any(|known| known == id),
                Some(("covers", t)) => case.covers.iter().any(|covered| covered.to_string() == t),
                _ => occurs(key, term) || occurs(&case.title, term),
            })
    }
}

fn occurs(text: &str, term: &str) -> bool {
    let mut rest = text;
    term.split('*').all(|part| match rest.find(part) {
        Some(at) => {
            rest = &rest[at + part.len()..];
            true
        }
        None => false,
    })
}

/// Plans a run on a DUT that offers and serves this.
///
/// # Errors
/// A [`Problem`] when a sweep is too large.
pub fn plan<'l>(
    library: &'l Library,
    selection: &Selection,
    profile: &Profile,
    description: &Description,
) -> Result<Plan<'l>, Problem> {
    let mut plan = Plan::default();
    // Whoever names nothing, or something for both roles, wants what the DUT is for; whoever names what is for the other role
    // alone is told why it does not apply.
    let asked: Vec<Vec<String>> = selection.suites.iter().map(|name| library.members(name)).collect();
    let names = |members: &Vec<String>, case: &Case| members.contains(&case.suite);
    let own = |case: &Case| case.role == description.role;
    let of_both = |members: &Vec<String>| library.cases().any(|case| own(case) && names(members, case));
    let wanted = |case: &&Case| {
        let mut by = asked.iter().filter(|members| names(members, case)).peekable();
        (asked.is_empty() || by.peek().is_some()) && (own(case) || !selection.filter.is_empty() || !by.all(of_both))
    };
    let mut deeper = Vec::new();
    for case in library.cases().filter(wanted) {
        if case.depth > selection.depth {
            let named = selection.filter.iter().any(|term| term.contains(&case.id));
            let term = format!("it takes its time: only with --depth {}", case.depth);
            deeper.extend((own(case) && (named || selection.filter.is_empty())).then(|| (case.id.clone(), term)));
            continue;
        }
        let offers = match profile.structure.filter(|_| of_structure(case)) {
            Some(structure) => structure.narrowed(&description.offers),
            None if case.complete.is_some() => of_edition(&description.offers, selection.edition),
            None => description.offers.clone(),
        };
        let expansion = case.expand(&offers)?;
        let times = selection.repeat.max(1);
        let points = expansion.points.into_iter();
        // What excludes one sequence of a complete suite excludes all: they differ in nothing a DUT could lack.
        let mut same: Option<Option<String>> = None;
        for binding in points.flat_map(|point| repeated(point, times)) {
            let key = format!("{}{}", case.id, binding.key());
            let planned = Planned { case, binding, key };
            if !selection.matches(&planned) {
                continue;
            }
            let term = match same.clone().filter(|_| case.complete.is_some()) {
                Some(term) => term,
                None => {
                    let long = too_long(selection, description, &planned.binding);
                    long.or_else(|| excluded(library, profile, description, &planned))
                }
            };
            same = Some(term.clone());
            match term {
                Some(term) => plan.not_applicable.push((planned.key, term)),
                None => plan.cases.push(planned),
            }
        }
        for (binding, term) in expansion.excluded {
            let term = unclaimed(profile, case).unwrap_or(term);
            let key = format!("{}{}", case.id, binding.key());
            let planned = Planned { case, binding, key };
            if selection.matches(&planned) {
                plan.not_applicable.push((planned.key, term));
            }
        }
    }
    if plan.cases.is_empty() {
        plan.not_applicable.extend(deeper);
    }
    if let Some((index, count)) = selection.shard {
        let mut position = 0;
        plan.cases.retain(|_| {
            position += 1;
            (position - 1) % count == index - 1
        });
    }
    Ok(plan)
}

/// Whether a case is for gateways, FS-Masters or not.
fn of_gateway(case: &Case) -> bool {
    case.features.iter().any(|feature| feature == GATEWAY)
}

/// Why nothing about an FS-Master applies to a product that does not claim to be one.
fn unclaimed(profile: &Profile, case: &Case) -> Option<String> {
    (profile.no_fs_port_mode && case.role == Role::Master && !of_gateway(case))
        .then(|| "the product claims no FS_PortMode: no SAFETYCOM, MIXEDSAFETYCOM or OSSDE, and no SCL".to_owned())
}

/// Whether a case is about the FS I/O structure, and so about the sizes it has.
fn of_structure(case: &Case) -> bool {
    case.features.iter().any(|feature| feature == structure::DECLARED)
}

/// The offers of one edition, or all.
fn of_edition(offers: &[Offer], edition: Option<Edition>) -> Vec<Offer> {
    offers.iter().filter(|offer| edition.is_none_or(|edition| offer.edition == edition)).copied().collect()
}

/// This point as often as asked, each with its number when that is more than once.
fn repeated(point: Binding, times: u32) -> impl Iterator<Item = Binding> {
    (1..=times).map(move |run| match times {
        1 => point.clone(),
        _ => point.with(REPEAT, run.to_string()),
    })
}

/// Why a case takes too long to be lived through unasked.
fn too_long(selection: &Selection, description: &Description, binding: &Binding) -> Option<String> {
    let ms = binding.watchdog_ms().filter(|ms| *ms > LONG_MS)?;
    (description.clock.kind == ClockKind::Real && !selection.long)
        .then(|| format!("FSP_Watchdog of {ms} ms in real time: only with --long"))
}

fn steps_of(case: &Case, binding: &Binding) -> Vec<crate::case::model::Step> {
    case.steps(binding, &mut Vec::new())
}

/// The term that excludes a case, if one does.
fn excluded(library: &Library, profile: &Profile, description: &Description, planned: &Planned<'_>) -> Option<String> {
    let Planned { case, binding, .. } = planned;
    if case.role != description.role {
        return Some(format!("the case is for a {}, the DUT is a {}", case.role, description.role));
    }
    if let Some(term) = unclaimed(profile, case) {
        return Some(term);
    }
    let edition = binding.variant.edition;
    let records: Vec<_> = case.requirements.iter().filter_map(|id| library.ledger.get(id)).collect();
    if !records.is_empty() && records.iter().all(|record| !record.exists_in(edition)) {
        return Some(format!("its requirements do not exist in {edition}"));
    }
    let most = steps_of(case, binding).iter().map(|step| step.port).max().unwrap_or(1);
    if most > description.ports {
        return Some(format!("it takes {most} ports, the DUT has {}", description.ports));
    }
    if let Some(ms) = binding.watchdog_ms()
        && (profile.parameterization == Parameterization::None || !description.pcos.contains(&Pco::Acyclic))
    {
        return Some(format!("the DUT cannot be given an FSP_Watchdog of {ms} ms"));
    }
    if let Some(ms) = binding.watchdog_ms()
        && description.clock.kind == ClockKind::Real
        && profile.with_watchdog(ms, ClockKind::Real).master_cycle_time_ns < profile.master_cycle_time_ns
    {
        let cycle_us = profile.master_cycle_time_ns / 1_000;
        return Some(format!(
            "FSP_Watchdog of {ms} ms is too short for the MasterCycleTime of {cycle_us} us in the profile"
        ));
    }
    if let Some(feature) = case.features.iter().find(|feature| !profile.features.contains(feature)) {
        let known = structure::term(feature).map(str::to_owned);
        return Some(known.unwrap_or_else(|| format!("the profile does not list the feature `{feature}`")));
    }
    let variant = binding.variant;
    if let Some((out, input)) = profile.structure.filter(|_| of_structure(case)).map(Declared::sizes)
        && (out, input) != (variant.pd_out.into(), variant.pd_in.into())
    {
        let mode = variant.mode;
        return Some(format!(
            "the profile declares {out} octets of FS-PDout and {input} of FS-PDin, which the DUT does not offer with {mode}"
        ));
    }
    if let Some(feature) =
        records.iter().filter_map(|record| record.applies.as_ref()).find(|f| !profile.features.contains(f))
    {
        return Some(format!("the profile does not list the feature `{feature}`"));
    }
    let always: &[Pco] = match description.role {
        Role::Device => &[Pco::Power, Pco::Link],
        // Without the gateway nobody can acknowledge.
        Role::Master if of_gateway(case) => &[Pco::Power, Pco::App, Pco::Line],
        Role::Master => &[Pco::Power, Pco::Link, Pco::App],
    };
    if let Some(pco) = always.iter().find(|pco| !description.pcos.contains(pco)) {
        return Some(format!("the DUT does not serve `{}`, so no start condition can be reached", pco.name()));
    }
    if profile.parameterization == Parameterization::None && case.needs.contains(&Pco::Acyclic) {
        return Some("the profile says that the product starts its SCL by itself".to_owned());
    }
    // Start conditions do without on-request data and application; the steps of a case cannot.
    let steps = steps_of(case, binding);
    let missing = case.needs.iter().copied().chain(needs(&steps)).find(|pco| !description.pcos.contains(pco));
    missing.map(|pco| format!("the DUT does not serve `{}`", pco.name()))
}

/// A stand-in for a DUT that could not be reached, so that every case can be recorded as not run.
pub fn unreached(role: Role) -> Description {
    Description {
        role,
        // No case needs more than this.
        ports: if role == Role::Master { 4 } else { 1 },
        pcos: Pco::ALL.to_vec(),
        offers: crate::library::EVERYTHING.to_vec(),
        clock: fsct_adapters::Clock { kind: ClockKind::Virtual, resolution_ns: 1, uncertainty_ns: 0 },
        vendor: String::new(),
        product: String::new(),
        version: String::new(),
    }
}

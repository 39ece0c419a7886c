//! IODD-54 to IODD-62: menus, roles and texts.

use super::{Check, events, maybe, quoted};
use crate::model::{Entry, Menu, Target, decimal_is};
use fsct_protocol::Edition;
use std::collections::{HashMap, HashSet};

/// The unit code of milliseconds.
const MILLISECONDS: &str = "1056";

/// The ends of the text ids of FSP variables and items, `TN_V_` and `TD_V_` before them.
const TEXTS: [&str; 18] = [
    "FSP_SafetyCode",
    "FSP_Authenticity",
    "FSP_Authenticity_1",
    "FSP_Authenticity_2",
    "FSP_Port",
    "FSP_AuthentCRC",
    "FSP_Protocol",
    "FSP_ProtVersion",
    "FSP_ProtMode",
    "FSP_Watchdog",
    "FSP_IO_StructCRC",
    "FSP_TechParCRC",
    "FSP_ProtParCRC",
    "FSP_ParamDescCRC",
    "FSP_TimeToReady",
    "FSP_MinShutDownTime",
    "FSP_WCDT",
    "FSP_OFDT",
];

pub(super) fn check(check: &mut Check<'_, '_>) {
    match check.edition {
        Edition::V1_1 => {
            headings_v1_1(check);
            read_only(check);
        }
        Edition::Iec2022 => {
            headings(check);
            existence(check);
            contents(check);
            roles(check);
            parameters(check, "M_OR_FSP_Param", true);
            parameters(check, "M_MSR_FSP_Param", false);
            auxiliary(check);
            texts(check);
        }
    }
}

fn menu<'c, 'a>(check: &Check<'c, 'a>, id: &str) -> Option<&'c Menu<'a>> {
    let iodd = check.iodd;
    iodd.menus.iter().find(|menu| menu.id == id)
}

/// Entries whose heading stands before one it has to follow.
fn misplaced<'m, 'a>(menu: &'m Menu<'a>, rank: impl Fn(&str) -> Option<u8>) -> Option<(&'m Entry<'a>, &'a str)> {
    let mut highest = 0;
    menu.entries.iter().find_map(|entry| {
        let id = entry.target.menu()?;
        let rank = rank(id)?;
        let late = rank < highest;
        highest = highest.max(rank);
        late.then_some((entry, id))
    })
}

fn headings(check: &mut Check<'_, '_>) {
    let iodd = check.iodd;
    let rank = |id: &str| match id.split_once("_FS") {
        Some((_, rest)) if rest.starts_with("T_Param") => Some(1),
        Some((_, rest)) if rest.starts_with("P_Param_Aux") => Some(3),
        Some((_, rest)) if rest.starts_with("P_Param") => Some(2),
        _ => None,
    };
    for menu in &iodd.menus {
        if let Some((entry, id)) = misplaced(menu, rank) {
            let expected = "FS Technology, FS Protocol, FS Auxiliary in this order";
            check.broken("IODD-54", entry.at, format!("{} in {} comes late", quoted(id), quoted(menu.id)), expected);
        }
    }
}

fn existence(check: &mut Check<'_, '_>) {
    let at = check.iodd.menus_at;
    for id in ["M_OR_FSP_Param", "M_MSR_FSP_Param", "M_OMSR_FSP_Param_Aux"] {
        if menu(check, id).is_none() {
            check.broken("IODD-55", at, format!("no menu {id}"), "the menu");
        }
    }
    for id in ["M_OR_FST_Param", "M_MSR_FST_Param"] {
        match (menu(check, id), check.has_fst()) {
            (None, true) => {
                check.broken("IODD-55", at, format!("no menu {id}"), "the menu, because there are V_FST_ variables")
            }
            (Some(menu), false) => {
                check.broken("IODD-55", menu.at, format!("menu {id}"), "none, because there are no V_FST_ variables");
            }
            _ => {}
        }
    }
}

/// `FST` of `M_OR_FST_Param`: which parameters a menu of iec2022 is for.
fn belongs(id: &str) -> Option<&'static str> {
    let (_, rest) = id.strip_prefix("M_")?.split_once('_')?;
    ["FST", "FSP"].into_iter().find(|kind| rest.starts_with(kind))
}

fn contents(check: &mut Check<'_, '_>) {
    let iodd = check.iodd;
    for menu in &iodd.menus {
        for entry in &menu.entries {
            let Some(variable) = entry.target.variable() else { continue };
            let kind = ["FST", "FSP"].into_iter().find(|kind| {
                variable
                    .strip_prefix("V_")
                    .and_then(|rest| rest.strip_prefix(kind))
                    .is_some_and(|rest| rest.starts_with('_'))
            });
            if kind != belongs(menu.id) {
                let expected = match kind {
                    Some(kind) => format!("it in menus M_..._{kind}_... alone"),
                    None => "FS parameters alone".to_owned(),
                };
                check.broken(
                    "IODD-56",
                    entry.at,
                    format!("{} in menu {}", quoted(variable), quoted(menu.id)),
                    expected,
                );
            }
        }
    }
}

fn roles(check: &mut Check<'_, '_>) {
    let iodd = check.iodd;
    for (set, prefix) in
        [("ObserverRoleMenuSet", "OR"), ("MaintenanceRoleMenuSet", "MSR"), ("SpecialistRoleMenuSet", "MSR")]
    {
        let Some(role) = iodd.roles.iter().find(|role| role.set == set) else {
            check.broken("IODD-57", iodd.menus_at, format!("no {set}"), "the menus of each role");
            continue;
        };
        let wanted = [
            ("IdentificationMenu", format!("M_{prefix}_Ident")),
            ("ParameterMenu", format!("M_{prefix}_Param")),
            ("ObservationMenu", "M_OMSR_Observe".to_owned()),
            ("DiagnosisMenu", format!("M_{prefix}_Diag")),
        ];
        for (kind, id) in wanted {
            let found = role.menus.iter().find(|(_, name, _)| *name == kind);
            let at = found.map_or(role.at, |(at, _, _)| *at);
            let named = found.map(|(_, _, id)| *id);
            let right = |named: &str| named == id || (kind == "ObservationMenu" && named.starts_with(&id));
            if !named.is_some_and(right) {
                check.broken("IODD-57", at, format!("{set}: {kind} {}", maybe(named)), quoted(&id));
            } else if let Some(named) = named.filter(|named| menu(check, named).is_none()) {
                check.broken("IODD-57", at, format!("no menu {}", quoted(named)), "the menu the role names");
            }
        }
    }
    for prefix in ["OR", "MSR"] {
        let Some(menu) = menu(check, &format!("M_{prefix}_Param")) else { continue };
        let technology = check.has_fst().then(|| format!("M_{prefix}_FST_Param"));
        let others = [format!("M_{prefix}_FSP_Param"), "M_OMSR_FSP_Param_Aux".to_owned()];
        for id in technology.into_iter().chain(others) {
            if !menu.entries.iter().any(|entry| entry.target == Target::Menu(&id)) {
                check.broken("IODD-57", menu.at, format!("{} without {id}", quoted(menu.id)), "a MenuRef to it");
            }
        }
    }
}

/// Whether an entry shows its value as a whole number of milliseconds, each step worth `gradient`.
fn in_ms(entry: &Entry<'_>, gradient: f64) -> bool {
    entry.unit == Some(MILLISECONDS)
        && entry.format == Some("Dec.0")
        && decimal_is(entry.gradient, gradient)
        && decimal_is(entry.offset, 0.0)
}

fn parameters(check: &mut Check<'_, '_>, id: &str, read_only: bool) {
    let Some(menu) = menu(check, id) else { return };
    let items = (1..=4).map(|subindex| ("V_FSP_Authenticity", subindex));
    let mut last = 0;
    for (variable, subindex) in items.chain((1..=6).map(|subindex| ("V_FSP_Protocol", subindex))) {
        let target = Target::Item(variable, Some(subindex));
        let Some((place, entry)) = menu.entries.iter().enumerate().find(|(_, entry)| entry.target == target) else {
            check.broken("IODD-58", menu.at, format!("{id}: no {variable} Subindex {subindex}"), "a RecordItemRef");
            continue;
        };
        if place < last {
            check.broken(
                "IODD-58",
                entry.at,
                format!("{id}: {variable} Subindex {subindex} comes late"),
                "the order of the Subindices",
            );
        }
        last = last.max(place);
        match (read_only, entry.restriction) {
            (true, Some("ro")) | (false, None) => {}
            (true, other) => {
                check.broken("IODD-58", entry.at, format!("{id}: accessRightRestriction {}", maybe(other)), "`ro`");
            }
            (false, other) => {
                check.broken("IODD-58", entry.at, format!("{id}: accessRightRestriction {}", maybe(other)), "none");
            }
        }
        if (variable, subindex) == ("V_FSP_Protocol", 3) && !in_ms(entry, 1.0) {
            let found = format!("{id}: unit {}, gradient {}", maybe(entry.unit), maybe(entry.gradient));
            check.broken("IODD-58", entry.at, found, "unit 1056 (ms), format Dec.0, gradient 1, offset 0");
        }
    }
}

fn auxiliary(check: &mut Check<'_, '_>) {
    let Some(menu) = menu(check, "M_OMSR_FSP_Param_Aux") else { return };
    let times =
        [("V_FSP_TimeToReady", 10.0), ("V_FSP_MinShutDownTime", 10.0), ("V_FSP_WCDT", 1.0), ("V_FSP_OFDT", 1.0)];
    for (variable, gradient) in times {
        match menu.entries.iter().find(|entry| entry.target == Target::Variable(variable)) {
            None => check.broken("IODD-59", menu.at, format!("no {variable}"), "a VariableRef"),
            Some(entry) if !in_ms(entry, gradient) => {
                let found = format!("{variable}: unit {}, gradient {}", maybe(entry.unit), maybe(entry.gradient));
                check.broken(
                    "IODD-59",
                    entry.at,
                    found,
                    format!("unit 1056 (ms), format Dec.0, gradient {gradient}, offset 0"),
                );
            }
            Some(_) => {}
        }
    }
}

fn texts(check: &mut Check<'_, '_>) {
    let iodd = check.iodd;
    let Some(language) = &iodd.language else {
        return check.broken("IODD-62", iodd.at, "no PrimaryLanguage", "English texts");
    };
    if language.name != "en" {
        check.broken("IODD-62", language.at, format!("primary language {}", quoted(language.name)), "`en`");
    }
    let technology = check.has_fst().then_some(("TN_M_FST_Param", "FS Technology Parameter"));
    let headings = [("TN_M_FSP_Param", "FS Protocol Parameter"), ("TN_M_FSP_Param_Aux", "FS Auxiliary Parameter")];
    let variables = TEXTS.iter().flat_map(|name| [format!("TN_V_{name}"), format!("TD_V_{name}")]);
    for id in variables.chain(events::texts()) {
        if !language.texts.contains_key(id.as_str()) {
            check.broken("IODD-62", language.at, format!("no text {id}"), "the text");
        }
    }
    for (id, wording) in technology.into_iter().chain(headings) {
        match language.texts.get(id) {
            None => check.broken("IODD-62", language.at, format!("no text {id}"), quoted(wording)),
            Some((at, text)) if *text != wording => {
                check.doubtful("IODD-62", *at, format!("{id} reads {}", quoted(text)), quoted(wording));
            }
            Some(_) => {}
        }
    }
}

/// The menus a role reaches from its parameter menu.
fn reached<'c, 'a>(check: &Check<'c, 'a>, sets: &[&str]) -> Vec<&'c Menu<'a>> {
    let iodd = check.iodd;
    let menus: HashMap<&str, &Menu<'_>> = iodd.menus.iter().map(|menu| (menu.id, menu)).collect();
    let roles = iodd.roles.iter().filter(|role| sets.contains(&role.set));
    let mut ahead: Vec<&str> =
        roles.flat_map(|role| role.menus.iter().filter(|menu| menu.1 == "ParameterMenu").map(|menu| menu.2)).collect();
    let (mut seen, mut found) = (HashSet::new(), Vec::new());
    while let Some(id) = ahead.pop() {
        if let Some(&menu) = menus.get(id)
            && seen.insert(id)
        {
            ahead.extend(menu.entries.iter().filter_map(|entry| entry.target.menu()));
            found.push(menu);
        }
    }
    found
}

/// `FSP` of `V_FSP_Protocol`.
fn safety_kind(variable: &str) -> Option<&'static str> {
    [("V_FST_", "FST"), ("V_FSP_", "FSP")]
        .into_iter()
        .find(|(begin, _)| variable.starts_with(begin))
        .map(|(_, kind)| kind)
}

fn headings_v1_1(check: &mut Check<'_, '_>) {
    let iodd = check.iodd;
    let rank = |id: &str| {
        [("Param_Standard", 1), ("Param_FST", 2), ("Param_FSP", 3)]
            .into_iter()
            .find(|(end, _)| id.ends_with(end))
            .map(|(_, rank)| rank)
    };
    for menu in &iodd.menus {
        if let Some((entry, id)) = misplaced(menu, rank) {
            let found = format!("{} in {} comes late", quoted(id), quoted(menu.id));
            check.broken("IODD-60", entry.at, found, "Standard, FST, FSP in this order");
        }
    }
    for menu in reached(check, &["ObserverRoleMenuSet", "MaintenanceRoleMenuSet", "SpecialistRoleMenuSet"]) {
        let shown = menu.entries.iter().filter_map(|entry| entry.target.variable()).find_map(safety_kind);
        // The text has ME_, the sample M_.
        let named = menu.id.starts_with("ME_") || menu.id.starts_with("M_");
        if let Some(kind) = shown.filter(|kind| !named || !menu.id.ends_with(&format!("Param_{kind}"))) {
            let found = format!("{kind} parameters in menu {}", quoted(menu.id));
            check.broken("IODD-60", menu.at, found, format!("a menu ME_..._Param_{kind}"));
        }
    }
}

fn read_only(check: &mut Check<'_, '_>) {
    for menu in reached(check, &["ObserverRoleMenuSet", "MaintenanceRoleMenuSet"]) {
        for entry in menu.entries.iter().filter(|entry| entry.restriction != Some("ro")) {
            if let Some(variable) = entry.target.variable().filter(|variable| safety_kind(variable).is_some()) {
                let found = format!("{} in {} can be written", quoted(variable), quoted(menu.id));
                check.broken("IODD-61", entry.at, found, "accessRightRestriction `ro`");
            }
        }
    }
}

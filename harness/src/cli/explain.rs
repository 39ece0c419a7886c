//! `fsct explain ID`: what a case, a requirement, a tolerance, a limit or a rule for IODDs says, and what hangs on it;
//! `fsct explain --matrix` and `--mapping`.

use super::{Cases, USAGE, fail, print};
use crate::library::Library;
use crate::mapping;
use crate::oracle::Tolerances;
use crate::oracle::readings::{HOLDS, REFUSED};
use crate::problem::suggestion;
use fsct_iodd::{Reach, Severity};
use fsct_lines::{Limit, Outside, Row, Subject, Unit};
use fsct_protocol::Edition;

/// Arguments of `fsct explain`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// FSD-0231, R-11.5.3-09, A19, t_RP or IODD-24
    #[arg(required_unless_present_any = ["matrix", "mapping"])]
    id: Option<String>,
    /// Print the error matrix: error class x state x direction, with the case that shows it
    #[arg(long, conflicts_with = "id")]
    matrix: bool,
    /// Print what a gateway that is no FS-Master shares with SDCI-FS, and where it deviates
    #[arg(long, conflicts_with_all = ["id", "matrix"])]
    mapping: bool,
    #[command(flatten)]
    cases: Cases,
}

/// Runs the command; the result is the exit code.
pub fn run(args: &Args) -> u8 {
    let library = match args.cases.load() {
        Ok(library) => library,
        Err(code) => return code,
    };
    if args.mapping {
        print(mapping::text(&library.ledger));
        return 0;
    }
    let Some(id) = args.id.as_deref() else {
        return match &library.matrix {
            Some(matrix) => {
                print(matrix.text());
                0
            }
            None => fail(USAGE, "these cases come without an error matrix"),
        };
    };
    if case(&library, id) || requirement(&library, id) || tolerance(&library, id) || limit(&library, id) || iodd(id) {
        return 0;
    }
    let symbols = library.limits.limits.iter().map(|limit| limit.symbol.as_str());
    let rules = fsct_iodd::RULES.iter().map(|rule| rule.id);
    let known: Vec<&str> =
        library.cases().map(|case| case.id.as_str()).chain(library.ledger.ids()).chain(symbols).chain(rules).collect();
    fail(USAGE, format!("there is no case, requirement, tolerance, limit or rule `{id}`; {}", suggestion(id, known)))
}

fn case(library: &Library, id: &str) -> bool {
    let Some(case) = library.cases().find(|case| case.id == id) else { return false };
    print(format!("{id}  {}\nsuite {}, {}", case.title, case.suite, case.place()));
    if let Some(start) = library.starts.iter().find(|start| start.name == case.start) {
        print(format!("begins at `{}`: {}", start.name, start.about));
    }
    for id in &case.requirements {
        if let Some(record) = library.ledger.get(id) {
            print(format!("judges {id} ({}, {}): {}", clauses(record), record.level.name(), record.text));
        }
    }
    if !case.strict.is_empty() {
        let strict: Vec<String> = case.strict.iter().map(|number| format!("A{number:02}")).collect();
        print(format!("not excused by {}", strict.join(" ")));
    }
    let covers: Vec<String> = case.covers.iter().map(|number| format!("T{number}")).collect();
    if !covers.is_empty() {
        print(format!("covers {}", covers.join(" ")));
    }
    if let Some(point) = case.expand(&crate::library::EVERYTHING).ok().and_then(|all| all.points.into_iter().next()) {
        print(format!("steps at {}", point.key()));
        case.steps(&point, &mut Vec::new()).iter().for_each(|step| print(format!("  - {}", step.text)));
    }
    true
}

fn requirement(library: &Library, id: &str) -> bool {
    let Some(record) = library.ledger.get(id) else { return false };
    print(format!("{id}  {} ({}, for {})", clauses(record), record.level.name(), record.dut));
    print(&record.text);
    print(format!("stimulus: {}\nexpected: {}\nclass: {}", record.stimulus, record.expect, record.class.name()));
    let more = [
        ("remark (shown, never failed)", &record.remark),
        ("printed by the base standard only, not judged", &record.base),
        ("applies to products with", &record.applies),
        ("doubt", &record.doubt),
        ("editions differ", &record.differs),
        ("why", &record.why),
    ];
    for (what, text) in more {
        if let Some(text) = text {
            print(format!("{what}: {text}"));
        }
    }
    for case in library.cases().filter(|case| case.requirements.iter().any(|known| known == id)) {
        print(format!("judged by {}  {}", case.id, case.title));
    }
    print(&record.place);
    true
}

fn tolerance(library: &Library, id: &str) -> bool {
    let Some(entry) = Tolerances::number(id).and_then(|number| library.tolerances.get(number)) else { return false };
    print(format!("{id}  {} ({})\n{}", entry.name, entry.stance, entry.text));
    for row in library.readings.of(entry.number) {
        let refused = row.refused.as_ref().map_or(String::new(), |why| format!(": {why}"));
        let verdict = if row.refused.is_none() { HOLDS } else { REFUSED };
        print(format!("proven for an {}: {} {verdict}{refused}", row.machine, row.reading));
    }
    true
}

fn limit(library: &Library, symbol: &str) -> bool {
    let Some(limit) = library.limits.limits.get(symbol) else { return false };
    let dut = match limit.dut {
        Subject::Device => "FS-Device",
        Subject::Master => "FS-Master port",
        Subject::Both => "FS-Device and FS-Master port",
        Subject::Line => "cable",
    };
    print(format!("{symbol}  {} ({dut}, {})", limit.about, limit.verify.name()));
    for edition in Edition::ALL {
        print(match limit.row(edition) {
            Some(row) => format!("{edition}: {}", values(limit, row)),
            None => format!("{edition}: no such limit"),
        });
    }
    let open = limit.open.join(", ");
    for (what, text) in [("why", limit.why.as_deref()), ("reading in force", Some(open.as_str()))] {
        if let Some(text) = text.filter(|text| !text.is_empty()) {
            print(format!("{what}: {text}"));
        }
    }
    for id in &limit.requirements {
        if let Some(record) = library.ledger.get(id) {
            print(format!("{id} ({}, {}): {}", clauses(record), record.level.name(), record.text));
        }
    }
    true
}

fn iodd(id: &str) -> bool {
    let Some(rule) = fsct_iodd::rule(id) else { return false };
    print(format!("{id}  {} ({})", rule.text, rule.clause));
    for edition in Edition::ALL {
        print(format!("{edition}: {}", rule.severity(edition).map_or("no such rule", Severity::name)));
    }
    print(match rule.reach {
        Reach::File => "checked by fsct iodd FILE".to_owned(),
        Reach::Others(why) => format!("follows: {why}"),
        Reach::Not(why) => format!("not checked: {why}"),
    });
    true
}

/// `500 us to 1000 us (5.4, Table 7)`.
fn values(limit: &Limit, row: &Row) -> String {
    let one = |value: Option<f64>, from: &Option<String>| {
        let value = value.map(|value| match limit.unit {
            Unit::One => value.to_string(),
            unit => format!("{value} {}", unit.name()),
        });
        match (value, from) {
            (Some(value), Some(from)) => Some(format!("{from} (else {value})")),
            (value, from) => value.or(from.clone()),
        }
    };
    let range = match (one(row.min, &row.min_from), one(row.max, &row.max_from)) {
        (Some(min), Some(max)) => format!("{min} to {max}"),
        (Some(min), None) => format!("at least {min}"),
        (None, Some(max)) => format!("at most {max}"),
        (None, None) => "no value".to_owned(),
    };
    let outside = match (row.base, row.outside) {
        (true, _) => "; base standard only, recorded and not judged",
        (_, Outside::Fail) => "",
        (_, Outside::Remark) => "; a value outside is a remark",
        (_, Outside::Recorded) => "; recorded, not judged",
    };
    format!("{range} ({}){outside}", row.clause)
}

fn clauses(record: &crate::ledger::Requirement) -> String {
    let of = |edition: Edition| record.clauses.get(edition.name()).map(|clause| format!("{edition} {clause}"));
    Edition::ALL.into_iter().filter_map(of).collect::<Vec<_>>().join(", ")
}

//! The kill matrix: which cases find which deliberate faults of the reference DUTs, as JSON and as one page.

use crate::text::{short, visible as clean};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io;
use std::path::Path;

/// Name of the file in its folder.
pub const FILE: &str = "gauntlet.json";
/// Version of the schema of [`Gauntlet`].
pub const SCHEMA: &str = "fsct-gauntlet/1";
const STYLE: &str = include_str!("style.css");
/// What the matrix needs beyond the style of the report.
const MATRIX: &str = "table.kills{border-collapse:collapse;font-size:.7rem}\
table.kills th.case{writing-mode:vertical-rl;font-weight:normal;padding:.2rem 0}\
table.kills td{text-align:center;min-width:.8em;border:1px solid #8883}\
table.kills th.mutant{text-align:left;white-space:nowrap;padding-right:.5rem}";

/// A gauntlet that was run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gauntlet {
    /// [`SCHEMA`].
    pub schema: String,
    /// Version of fsct.
    pub fsct: String,
    /// One matrix a role.
    pub roles: Vec<Matrix>,
    /// Wall time in seconds.
    pub seconds: f64,
}

/// The mutants of a reference DUT against the cases for its role.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Matrix {
    /// `device` or `master`.
    pub role: String,
    /// The mutants, in the order of their catalogue.
    pub mutants: Vec<Mutant>,
    /// The cases, in the order of their suites.
    pub cases: Vec<Case>,
}

/// A deliberate fault and what finds it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mutant {
    /// Its name.
    pub name: String,
    /// The clause it violates.
    pub clause: String,
    /// What is wrong, in one sentence.
    pub about: String,
    /// Cases whose own expectations fail, with the number of their points that do.
    pub killed_by: BTreeMap<String, usize>,
    /// Those of them that judge the clause.
    pub named_by: Vec<String>,
    /// Whether a run as for a user, oracle included, fails; looked at only when nothing names the clause.
    pub oracle: Option<bool>,
}

/// A case of the suites.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// Its id.
    pub id: String,
    /// Its suite.
    pub suite: String,
    /// What it shows.
    pub title: String,
    /// Mutants it kills by its own expectations.
    pub kills: usize,
}

impl Matrix {
    /// Mutants that no case kills by its own expectations and with the clause.
    pub fn survivors(&self) -> impl Iterator<Item = &Mutant> {
        self.mutants.iter().filter(|mutant| mutant.named_by.is_empty())
    }

    /// Cases that kill nothing.
    pub fn idle(&self) -> impl Iterator<Item = &Case> {
        self.cases.iter().filter(|case| case.kills == 0)
    }
}

impl Gauntlet {
    /// What this version of fsct found, and how long it took.
    pub fn new(roles: Vec<Matrix>, seconds: f64) -> Gauntlet {
        Gauntlet { schema: SCHEMA.to_owned(), fsct: env!("CARGO_PKG_VERSION").to_owned(), roles, seconds }
    }

    /// Whether every mutant is killed by a case that names its clause, and every case kills.
    pub fn is_clean(&self) -> bool {
        !self.roles.is_empty()
            && self.roles.iter().all(|matrix| matrix.survivors().count() + matrix.idle().count() == 0)
    }

    /// The matrix for programs.
    pub fn json(&self) -> String {
        let mut json = serde_json::to_string_pretty(self).unwrap_or_default();
        json.push('\n');
        json
    }

    /// Writes `gauntlet.json` and `gauntlet.html` into a folder, which is made if need be.
    ///
    /// # Errors
    /// What the file system says.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        std::fs::create_dir_all(folder)?;
        std::fs::write(folder.join(FILE), self.json())?;
        std::fs::write(folder.join("gauntlet.html"), self.html())
    }

    /// The matrix as one page, readable without script and without network.
    pub fn html(&self) -> String {
        let markup = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'";
                    title { "fsct: the gauntlet" }
                    style { (PreEscaped(STYLE)) (PreEscaped(MATRIX)) }
                }
                body {
                    main {
                        h1 { "Mutants against cases" }
                        p {
                            "Each mutant is a reference DUT with one deliberate fault. A case kills it when an expectation of the case \
                             itself fails; the oracle has no say here. ■ kills and judges the clause the mutant violates, ▪ kills, \
                             a blank lets it pass."
                        }
                        @for matrix in &self.roles { (role(matrix)) }
                    }
                }
            }
        };
        markup.into_string()
    }
}

fn role(matrix: &Matrix) -> Markup {
    let (survivors, idle) = (matrix.survivors().count(), matrix.idle().count());
    html! {
        h2 { "FS-" (if matrix.role == "device" { "Device" } else { "Master" }) }
        p {
            (matrix.mutants.len()) " mutants, " (survivors) " of them survive; "
            (matrix.cases.len()) " cases, " (idle) " of them kill nothing."
        }
        @if survivors > 0 {
            h3 { "Survivors" }
            ul {
                @for mutant in matrix.survivors() {
                    li {
                        span.word { (clean(&mutant.name)) } " (" (clean(&mutant.clause)) "): " (clean(&mutant.about))
                        @if !mutant.killed_by.is_empty() { " Killed, though by no case that judges the clause." }
                        @else if mutant.oracle == Some(true) { " Only the oracle finds it." }
                    }
                }
            }
        }
        @if idle > 0 {
            h3 { "Cases that kill nothing" }
            ul { @for case in matrix.idle() { li { span.word { (clean(&case.id)) } " " (short(&case.title, 160)) } } }
        }
        h3 { "Matrix" }
        div style="overflow-x:auto" {
            table.kills {
                thead {
                    tr { th {} @for case in &matrix.cases { th.case title=(clean(&case.title)) { (clean(&case.id)) } } }
                }
                tbody {
                    @for mutant in &matrix.mutants {
                        tr {
                            th.mutant title=(clean(&mutant.about)) { (clean(&mutant.name)) }
                            @for case in &matrix.cases { td { (mark(mutant, &case.id)) } }
                        }
                    }
                }
            }
        }
        h3 { "Catalogue" }
        ul {
            @for mutant in &matrix.mutants {
                li {
                    span.word { (clean(&mutant.name)) } " (" (clean(&mutant.clause)) "): " (clean(&mutant.about)) " "
                    (mutant.killed_by.len()) " cases kill it, " (mutant.named_by.len()) " judge the clause."
                }
            }
        }
    }
}

fn mark(mutant: &Mutant, id: &str) -> &'static str {
    match mutant.killed_by.contains_key(id) {
        true if mutant.named_by.iter().any(|name| name == id) => "■",
        true => "▪",
        false => "",
    }
}

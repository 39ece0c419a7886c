//! Everything under `testcases/`: carried in the binary, or read from a folder.

use crate::annex_i::{self, AnnexI};
use crate::case::model::{Action, Blocks, Starts, Step};
use crate::case::{self, Case, Covered, Start, Suite};
use crate::complete;
use crate::coverage::Coverage;
use crate::ledger::{Class, Ledger};
use crate::limits;
use crate::matrix::{self, Matrix};
use crate::oracle::{Readings, Tolerances};
use crate::problem::{Problem, Source, suggestion};
use crate::profile::Profile;
use crate::scenario::{self, Scenarios};
use crate::yaml;
use fsct_adapters::{Offer, Pco, Role};
use fsct_protocol::{Edition, ProtMode};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

static EMBEDDED: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/testcases.rs"));

fn embedded_sources() -> Vec<Arc<Source>> {
    let source = |(name, text): &(&str, &str)| Arc::new(Source { name: (*name).to_owned(), text: (*text).to_owned() });
    EMBEDDED.iter().map(source).collect()
}

/// Suites, start conditions, ledger, error matrix, scenarios, tolerances, limits and profiles.
#[derive(Debug)]
pub struct Library {
    /// Suites by name.
    pub suites: Vec<Suite>,
    /// Start conditions.
    pub starts: Vec<Start>,
    /// Ledger.
    pub ledger: Ledger,
    /// The error matrix; cases of one's own do without.
    pub matrix: Option<Matrix>,
    /// What Annex I asks for; cases of one's own do without.
    pub annex_i: Option<AnnexI>,
    /// The scenarios of Annex G; cases of one's own do without.
    pub scenarios: Option<Scenarios>,
    /// Tolerances.
    pub tolerances: Tolerances,
    /// Which readings of the SCL a product may follow.
    pub readings: Readings,
    /// Times and electrical limits; cases of one's own do without.
    pub limits: limits::Table,
    /// Profiles by name.
    pub profiles: BTreeMap<String, Profile>,
    /// What a DUT can be led through, by its role.
    pub coverage: BTreeMap<String, Coverage>,
}

impl Library {
    /// What the binary carries.
    ///
    /// # Errors
    /// Every problem of the files; none in a binary that passed its own tests.
    pub fn embedded() -> Result<Library, Vec<Problem>> {
        Library::from_sources(embedded_sources())
    }

    /// What the binary carries, without the suites and the parts of the ledger that a case has nothing to do with: for a
    /// process that runs this one case and is to begin soon.
    ///
    /// # Errors
    /// As [`Library::embedded`].
    pub fn embedded_for(id: &str) -> Result<Library, Vec<Problem>> {
        let mut sources = embedded_sources();
        sources.retain(|source| !source.name.contains("suites/") || source.text.contains(id));
        let suites = sources.iter().filter(|source| source.name.contains("suites/"));
        let cases = suites.filter_map(|source| case::suite(source).ok()).flat_map(|suite| suite.cases);
        let cited: Vec<String> = cases
            .filter(|case| case.id == id)
            .flat_map(|case| case.requirements)
            .map(|requirement| format!("id: {requirement}\n"))
            .collect();
        sources.retain(|source| {
            !source.name.contains("requirements/") || cited.iter().any(|record| source.text.contains(record))
        });
        Library::from_sources(sources)
    }

    /// A folder laid out like `testcases/`.
    ///
    /// # Errors
    /// Every problem of the files.
    pub fn from_folder(folder: &Path) -> Result<Library, Vec<Problem>> {
        let mut paths = Vec::new();
        collect(folder, &mut paths, 0);
        paths.sort();
        if paths.is_empty() {
            let message = "holds no YAML files; a folder like testcases/ is meant";
            return Err(vec![Problem::without_place(&folder.display().to_string(), message)]);
        }
        let mut problems = Vec::new();
        let mut sources = Vec::new();
        for path in paths {
            match yaml::load(&path) {
                Ok(source) => sources.push(source),
                Err(problem) => problems.push(problem),
            }
        }
        if !problems.is_empty() {
            return Err(problems);
        }
        Library::from_sources(sources)
    }

    fn from_sources(sources: Vec<Arc<Source>>) -> Result<Library, Vec<Problem>> {
        let mut problems = Vec::new();
        let mut suites = Vec::new();
        let mut starts = Vec::new();
        let mut ledger = Ledger::default();
        let mut matrix = None;
        let mut annex_i = None;
        let mut scenarios = None;
        let mut tolerances = None;
        let mut readings = None;
        let mut limits = limits::Table::default();
        let mut profiles = BTreeMap::new();
        let mut coverage = BTreeMap::new();
        for source in &sources {
            let parts: Vec<&str> = source.name.split(['/', '\\']).collect();
            let (folder, file) = match parts.as_slice() {
                [.., folder, file] => (*folder, *file),
                _ => ("", source.name.as_str()),
            };
            match (folder, file) {
                ("requirements", _) => ledger.read(source, &mut problems),
                ("suites", _) => gather(case::suite(source), &mut problems, |suite| suites.push(suite)),
                ("profiles", _) => gather(Profile::parse(source), &mut problems, |profile| {
                    profiles.insert(profile.name.clone(), profile);
                }),
                ("coverage", _) => gather(Coverage::parse(source), &mut problems, |goals| {
                    coverage.insert(goals.role.to_string(), goals);
                }),
                (_, "starts.yaml") => gather(case::starts(source), &mut problems, |found| starts = found),
                (_, "error-matrix.yaml") => {
                    gather(Matrix::parse(source), &mut problems, |found| matrix = Some(found));
                }
                (_, "annex-i.yaml") => gather(AnnexI::parse(source), &mut problems, |found| annex_i = Some(found)),
                (_, "scenarios.yaml") => {
                    gather(Scenarios::parse(source), &mut problems, |found| scenarios = Some(found));
                }
                (_, "tolerances.yaml") => {
                    gather(Tolerances::parse(source), &mut problems, |found| tolerances = Some((source, found)));
                }
                (_, "readings.yaml") => gather(Readings::parse(source), &mut problems, |found| readings = Some(found)),
                (_, "limits.yaml") => gather(limits::parse(source), &mut problems, |found| limits = found),
                _ => {
                    problems.push(Problem::without_place(&source.name, "is in no known place").help(
                        "known are requirements/, suites/, profiles/, coverage/, starts.yaml, error-matrix.yaml, annex-i.yaml, scenarios.yaml, tolerances.yaml, readings.yaml and limits.yaml",
                    ))
                }
            }
        }
        // Last, so that the first failure told is that of a suite about one thing.
        suites.sort_by_key(|suite: &Suite| match suite.group.as_deref() {
            Some(complete::GROUP) => 3,
            Some(matrix::GROUP) => 2,
            Some(scenario::GROUP) => 1,
            _ => 0,
        });
        match (&tolerances, &readings) {
            (Some((source, tolerances)), Some(readings)) => problems.extend(readings.check(source, tolerances)),
            (_, None) => problems.push(Problem::without_place("testcases/readings.yaml", "is missing")),
            (None, _) => problems.push(Problem::without_place("testcases/tolerances.yaml", "is missing")),
        }
        match tolerances.zip(readings) {
            Some(((_, tolerances), readings)) if problems.is_empty() => Ok(Library {
                suites,
                starts,
                ledger,
                matrix,
                annex_i,
                scenarios,
                tolerances,
                readings,
                limits,
                profiles,
                coverage,
            }),
            _ => Err(problems),
        }
    }

    /// Adds the suite of a single file, in place of one with the same name.
    ///
    /// # Errors
    /// Every problem of the file.
    pub fn add_suite(&mut self, path: &Path) -> Result<String, Vec<Problem>> {
        let suite = yaml::load(path).map_err(|problem| vec![problem]).and_then(|source| case::suite(&source))?;
        let name = suite.name.clone();
        self.suites.retain(|known| known.name != name);
        self.suites.push(suite);
        Ok(name)
    }

    /// The suites behind a name: a suite, the suites of a group, or all that support an item of Annex I.
    pub fn members(&self, name: &str) -> Vec<String> {
        let named = |suite: &&Suite| suite.name == name || suite.group.as_deref() == Some(name);
        match &self.annex_i {
            Some(annex) if name == annex_i::NAME => {
                let all: BTreeSet<String> = annex.suites().into_iter().flat_map(|name| self.members(name)).collect();
                all.into_iter().collect()
            }
            _ => self.suites.iter().filter(named).map(|suite| suite.name.clone()).collect(),
        }
    }

    /// Names of suites and of groups of suites, and that of Annex I.
    pub fn names(&self) -> std::vec::IntoIter<&str> {
        let names = self.suites.iter().map(|suite| suite.name.as_str());
        let groups: BTreeSet<&str> = self.suites.iter().filter_map(|suite| suite.group.as_deref()).collect();
        let annex = self.annex_i.is_some().then_some(annex_i::NAME);
        names.chain(groups).chain(annex).collect::<Vec<_>>().into_iter()
    }

    /// All cases.
    pub fn cases(&self) -> impl Iterator<Item = &Case> {
        self.suites.iter().flat_map(|suite| &suite.cases)
    }

    /// The steps that lead from a DUT without supply to a start condition.
    pub fn start_steps(&self, role: Role, name: &str, problems: &mut Vec<Problem>) -> Vec<Step> {
        let mut chain = Vec::new();
        let mut next = Some(name);
        while let Some(start) = next.and_then(|name| self.start(role, name)) {
            next = start.after.as_deref();
            chain.push(start);
        }
        chain.iter().rev().flat_map(|start| start.steps(problems)).collect()
    }

    fn start(&self, role: Role, name: &str) -> Option<&Start> {
        self.starts.iter().find(|start| start.role == role && start.name == name)
    }

    /// Checks everything against everything, without a DUT.
    pub fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        let mut ids: BTreeMap<&str, String> = BTreeMap::new();
        let mut cited = BTreeSet::new();
        for start in &self.starts {
            start.steps(&mut problems);
        }
        for case in self.cases() {
            if let Some(before) = ids.insert(&case.id, case.place()) {
                let message = format!("case id `{}` stands already at {before}", case.id);
                problems.push(Problem::new(&case.source, case.at.clone(), message));
            }
            for id in &case.requirements {
                cited.insert(id.as_str());
                if self.ledger.get(id).is_none() {
                    let message = format!("case {} judges an unknown requirement `{id}`", case.id);
                    let help = suggestion(id, self.ledger.ids());
                    problems.push(Problem::new(&case.source, case.at.clone(), message).help(help));
                }
            }
            self.check_case(case, &mut problems);
        }
        for role in [Role::Device, Role::Master] {
            match self.coverage.get(&role.to_string()) {
                None => problems.push(Problem::without_place(&format!("testcases/coverage/{role}.yaml"), "is missing")),
                Some(goals) => {
                    for id in goals.requirements.values().filter(|id| self.ledger.get(id).is_none()) {
                        let place = format!("testcases/coverage/{role}.yaml");
                        let message = format!("names an unknown requirement `{id}`");
                        problems.push(Problem::without_place(&place, message).help(suggestion(id, self.ledger.ids())));
                    }
                }
            }
        }
        match &self.matrix {
            Some(matrix) => matrix.check(&self.suites, &mut problems),
            None => {
                for suite in self.suites.iter().filter(|suite| suite.group.as_deref() == Some(matrix::GROUP)) {
                    let message = format!("suite `{}` belongs to an error matrix, but there is none", suite.name);
                    problems.push(Problem::without_place("testcases/error-matrix.yaml", message));
                }
            }
        }
        if let Some(annex) = &self.annex_i {
            annex.check(self.names(), &self.ledger, &mut problems);
        }
        match &self.scenarios {
            Some(scenarios) => scenarios.check(&self.suites, &mut problems),
            None => {
                for case in self.cases() {
                    let Some((id, at)) = &case.scenario else { continue };
                    let message = format!("case {} names the scenario `{id}`, but there are none", case.id);
                    let remedy = "scenarios stand in testcases/scenarios.yaml";
                    problems.push(Problem::new(&case.source, at.clone(), message).help(remedy));
                }
            }
        }
        self.limits.check(&self.ledger, &mut problems);
        for requirement in self.ledger.iter() {
            let cited = cited.contains(requirement.id.as_str());
            let message = match (requirement.class, cited) {
                (Class::Tested, false) => "is classed tested, but no case judges it",
                (class, true) if class != Class::Tested => "is judged by a case, but not classed tested",
                _ => continue,
            };
            problems.push(Problem::without_place(&requirement.place, format!("{} {message}", requirement.id)));
        }
        problems
    }

    fn check_case(&self, case: &Case, problems: &mut Vec<Problem>) {
        if self.start(case.role, &case.start).is_none() {
            let message = format!("case {} begins at an unknown start condition `{}`", case.id, case.start);
            let help = suggestion(
                &case.start,
                self.starts.iter().filter(|start| start.role == case.role).map(|start| start.name.as_str()),
            );
            problems.push(Problem::new(&case.source, case.at.clone(), message).help(help));
        }
        if case.complete.is_some() {
            // Its points and steps are made, not written.
            return;
        }
        let expansion = match case.expand(&EVERYTHING) {
            Ok(expansion) => expansion,
            Err(problem) => return problems.push(problem),
        };
        let mut found = Vec::new();
        let mut checks = false;
        let mut passwords = false;
        for point in &expansion.points {
            let steps = case.steps(point, &mut found);
            checks |= steps.iter().any(expects);
            passwords |= point.variant.edition == Edition::V1_1 && steps.iter().any(writes_password);
            if !found.is_empty() {
                break;
            }
        }
        let mut problem = |message: String| problems.push(Problem::new(&case.source, case.at.clone(), message));
        if expansion.points.is_empty() {
            let why = expansion.excluded.first().map_or("it has no points", |(_, term)| term.as_str());
            problem(format!("case {} can never run: {why}", case.id));
        } else if found.is_empty() && !checks {
            problem(format!("case {} expects nothing", case.id));
        }
        if passwords {
            let what = "writes 0x4210 or 0x4211, which are passwords in v1.1: it could lock the product";
            problem(format!("case {} {what}; limit it by `edition: [iec2022]`", case.id));
        }
        let foreign = |covered: &&Covered| match covered {
            Covered::Scl(number) => (*number < 20) == (case.role == Role::Device),
            Covered::Dl(number) => (*number == 13) != (case.role == Role::Device),
            Covered::Ossde(_) => case.role == Role::Device,
        };
        if let Some(covered) = case.covers.iter().find(foreign) {
            problem(format!("{covered} is no transition of a {}", case.role));
        }
        problems.extend(found);
    }
}

/// Offers of a DUT that can be everything, for checks without one.
pub static EVERYTHING: [Offer; 4] = [
    Offer { edition: Edition::V1_1, mode: ProtMode::Crc16, pd_out: (0, 3), pd_in: (0, 3) },
    Offer { edition: Edition::V1_1, mode: ProtMode::Crc32, pd_out: (0, 25), pd_in: (0, 25) },
    Offer { edition: Edition::Iec2022, mode: ProtMode::Crc16, pd_out: (0, 3), pd_in: (0, 3) },
    Offer { edition: Edition::Iec2022, mode: ProtMode::Crc32, pd_out: (0, 25), pd_in: (0, 25) },
];

/// Whether a step writes an Index that is a password in v1.1 and something else in iec2022.
fn writes_password(step: &Step) -> bool {
    matches!(step.action, Action::Write { index: 0x4210 | 0x4211, .. })
}

/// Whether a step judges anything.
fn expects(step: &Step) -> bool {
    let until = match &step.action {
        Action::Exchange(exchange) => !exchange.until.is_empty(),
        Action::Partner(_) | Action::Connect(_) => true,
        _ => false,
    };
    until || !step.expect.is_empty() || !step.remark.is_empty() || !step.measure.is_empty()
}

/// The points of control and observation that steps cannot do without.
pub fn needs(steps: &[Step]) -> impl Iterator<Item = Pco> + '_ {
    steps.iter().filter_map(|step| match step.action {
        Action::Power(_) => Some(Pco::Power),
        Action::App(_) => Some(Pco::App),
        Action::Parameterize(ref asked)
            if asked.starts != Starts::Yes || asked.blocks != Blocks::Written || asked.armed =>
        {
            Some(Pco::Acyclic)
        }
        Action::Read { .. }
        | Action::Write { .. }
        | Action::DataStorage(_)
        | Action::Technology(_)
        | Action::Smi(_)
        | Action::Raise { .. } => Some(Pco::Acyclic),
        Action::Drive(_) | Action::Wake(_) | Action::Pass { after: Some(_), .. } => Some(Pco::Line),
        _ => None,
    })
}

fn gather<T>(result: Result<T, Vec<Problem>>, problems: &mut Vec<Problem>, keep: impl FnOnce(T)) {
    match result {
        Ok(value) => keep(value),
        Err(found) => problems.extend(found),
    }
}

fn collect(folder: &Path, paths: &mut Vec<std::path::PathBuf>, depth: usize) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() && depth < 4 {
            collect(&path, paths, depth + 1);
        } else if path.extension().is_some_and(|extension| extension == "yaml") {
            paths.push(path);
        }
    }
}

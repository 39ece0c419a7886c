//! From the keys of the macro to tests.

use crate::guard::{Guarded, guarded, note_places};
use crate::test::{Outcome, Test};
use fsct_adapters::{Dut, DutError, Role};
use fsct_harness::campaign::{Bench, Judges, Run};
use fsct_harness::library::Library;
use fsct_harness::oracle::Mask;
use fsct_harness::plan::{Plan, Planned, Selection, plan};
use fsct_harness::problem::{Problem, Source, suggestion};
use fsct_harness::profile::{Profile, default_profile};
use libtest_mimic::{Arguments, Completion, Trial};
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Terms told when nothing applies.
const TOLD: usize = 10;

/// Makes a DUT that has said hello.
type Connect = Arc<dyn Fn() -> Result<Bench, DutError> + Send + Sync>;

/// The keys of [`conformance!`](crate::conformance), one function each.
pub struct Suite {
    role: Role,
    connect: Connect,
    target: String,
    profile: Option<Arc<Source>>,
    suites: Vec<String>,
    edition: Option<String>,
    filter: Vec<String>,
    seed: u64,
    strict: Vec<String>,
    tolerate: Vec<String>,
}

impl Suite {
    /// Cases for the FS-Devices that `make` makes.
    pub fn device<D: Dut + 'static>(make: impl Fn() -> D + Send + Sync + 'static) -> Suite {
        Suite::new(Role::Device, make)
    }

    /// Cases for the FS-Masters that `make` makes.
    pub fn master<D: Dut + 'static>(make: impl Fn() -> D + Send + Sync + 'static) -> Suite {
        Suite::new(Role::Master, make)
    }

    fn new<D: Dut + 'static>(role: Role, make: impl Fn() -> D + Send + Sync + 'static) -> Suite {
        Suite {
            role,
            connect: Arc::new(move || Bench::greet(Box::new(Guarded(guarded(|| Ok(make()))?)))),
            target: "--test conformance".to_owned(),
            profile: None,
            suites: Vec::new(),
            edition: None,
            filter: Vec::new(),
            seed: 1,
            strict: Vec::new(),
            tolerate: Vec::new(),
        }
    }

    /// Package and test target, for the line that runs a case again.
    #[must_use]
    pub fn target(self, package: &str, target: &str) -> Suite {
        Suite { target: format!("-p {package} --test {target}"), ..self }
    }

    /// A profile: name and text of its file.
    #[must_use]
    pub fn profile(self, name: &str, text: &str) -> Suite {
        Suite { profile: Some(Arc::new(Source { name: name.to_owned(), text: text.to_owned() })), ..self }
    }

    /// Only these suites or groups of suites.
    #[must_use]
    pub fn suites<const N: usize>(self, names: [&str; N]) -> Suite {
        Suite { suites: names.map(str::to_owned).to_vec(), ..self }
    }

    /// Only this edition.
    #[must_use]
    pub fn edition(self, name: &str) -> Suite {
        Suite { edition: Some(name.to_owned()), ..self }
    }

    /// Only cases that all these terms match.
    #[must_use]
    pub fn filter<const N: usize>(self, terms: [&str; N]) -> Suite {
        Suite { filter: terms.map(str::to_owned).to_vec(), ..self }
    }

    /// What everything random derives from.
    #[must_use]
    pub fn seed(self, seed: u64) -> Suite {
        Suite { seed, ..self }
    }

    /// Fail what these tolerances would let pass.
    #[must_use]
    pub fn strict<const N: usize>(self, ids: [&str; N]) -> Suite {
        Suite { strict: ids.map(str::to_owned).to_vec(), ..self }
    }

    /// Let pass what these tolerances describe.
    #[must_use]
    pub fn tolerate<const N: usize>(self, ids: [&str; N]) -> Suite {
        Suite { tolerate: ids.map(str::to_owned).to_vec(), ..self }
    }

    /// Runs what the command line of this process asks for, as libtest would.
    pub fn main(self) -> ExitCode {
        note_places();
        let arguments = Arguments::from_args();
        // nextest starts a process for each test: it reads the part of the library that this one case needs.
        let exact = arguments.filter.as_ref().filter(|name| arguments.exact && !name.starts_with("fsct::"));
        let id = exact.and_then(|name| name.split('[').next());
        let library = id.map_or_else(Library::embedded, Library::embedded_for);
        let tests = match library {
            // Kept until the process ends, as the tests are.
            Ok(library) => self.tests(Box::leak(Box::new(library)), id.is_none()),
            Err(problems) => vec![Test::broken("fsct::library", rendered(&problems))],
        };
        let listed = arguments.list || arguments.ignored;
        let trials = tests.into_iter().map(|test| trial(test, listed)).collect();
        libtest_mimic::run(&arguments, trials).exit_code()
    }

    /// The tests, or one that fails in place of all when none can be run; `whole`: the library holds every suite.
    pub fn tests(&self, library: &'static Library, whole: bool) -> Vec<Test> {
        self.planned(library, whole).unwrap_or_else(|broken| vec![broken])
    }

    fn planned(&self, library: &'static Library, whole: bool) -> Result<Vec<Test>, Test> {
        let no_plan = |why: String| Test::broken("fsct::plan", why);
        let profile = self.chosen(library).map_err(|why| Test::broken("fsct::profile", why))?;
        let allowed = profile.allowed(&library.tolerances, &self.strict, &self.tolerate).map_err(no_plan)?;
        let selection = self.selection(library, whole).map_err(no_plan)?;
        let hello = |why: String| Test::broken("fsct::hello", why);
        let description = (self.connect)().map_err(|error| hello(error.to_string()))?.description;
        profile.contradicts(&description).map_or(Ok(()), |said| Err(hello(said)))?;
        let plan =
            plan(library, &selection, &profile, &description).map_err(|problem| no_plan(problem.render(false)))?;
        let judge = Judge {
            library,
            profile,
            allowed,
            seed: self.seed,
            connect: self.connect.clone(),
            command: format!("cargo test {} -- --exact", self.target),
        };
        let judge = Arc::new(judge);
        let nothing = plan.cases.is_empty().then(|| no_plan(nothing_applies(&plan)));
        let cases = plan.cases.into_iter().map(|planned| {
            let judge = judge.clone();
            Test::case(planned.key.clone(), move || judge.outcome(planned))
        });
        let left_out = plan.not_applicable.into_iter().map(|(key, term)| Test::not_applicable(key, term));
        Ok(cases.chain(left_out).chain(nothing).collect())
    }

    /// The profile in force.
    fn chosen(&self, library: &Library) -> Result<Profile, String> {
        let profile = match &self.profile {
            Some(source) => Profile::parse(source).map_err(|problems| rendered(&problems))?,
            None => {
                let name = default_profile(self.role);
                library.profiles.get(&name).cloned().ok_or_else(|| format!("there is no profile `{name}`"))?
            }
        };
        if profile.role == self.role {
            Ok(profile)
        } else {
            Err(format!("profile `{}` is for a {}, the tests are for a {}", profile.name, profile.role, self.role))
        }
    }

    fn selection(&self, library: &Library, whole: bool) -> Result<Selection, String> {
        let unknown = self.suites.iter().find(|suite| whole && library.names().all(|known| known != *suite));
        if let Some(suite) = unknown {
            return Err(format!("there is no suite `{suite}`; {}", suggestion(suite, library.names())));
        }
        let edition = self.edition.as_ref().map(|name| name.parse());
        let edition = edition.transpose().map_err(|_| "`edition` is v1.1 or iec2022".to_owned())?;
        Ok(Selection { suites: self.suites.clone(), filter: self.filter.clone(), edition, ..Selection::default() })
    }
}

/// What all cases of a suite have in common.
struct Judge {
    library: &'static Library,
    profile: Profile,
    allowed: Mask,
    seed: u64,
    connect: Connect,
    command: String,
}

impl Judge {
    /// Runs a case on a DUT of its own.
    fn outcome(&self, planned: Planned<'static>) -> Outcome {
        let run = Run {
            library: self.library,
            profile: &self.profile,
            allowed: self.allowed,
            seed: self.seed,
            command: String::new(),
            interrupted: &AtomicBool::new(false),
            judges: Judges::default(),
        };
        let mut outcome = None;
        let replay = format!("{} '{}'", self.command, planned.key);
        let plan = Plan { cases: vec![planned], not_applicable: Vec::new() };
        let Ok(()) = run.execute(&plan, (self.connect)(), &*self.connect, |mut case| {
            case.replay.clone_from(&replay);
            outcome = Some(Outcome::of(&case));
            Ok::<(), Infallible>(())
        });
        outcome.unwrap_or_else(|| Outcome::Failed("tool-error: the case left no record".to_owned()))
    }
}

/// For libtest-mimic. Whoever lists gets the mark of an ignored test, as nextest needs it and does not read terms; whoever runs
/// gets the term. Whoever runs ignored tests is told that they do not apply, for nextest would take them as passed.
fn trial(test: Test, listed: bool) -> Trial {
    let ignored = test.ignored && listed;
    let run = move |test: Test| match test.run() {
        Outcome::Passed => Ok(Completion::Completed),
        Outcome::Remark(text) => {
            eprintln!("{text}");
            Ok(Completion::Completed)
        }
        Outcome::Failed(text) => Err(text.into()),
        Outcome::NotApplicable(term) if listed => Err(format!("not applicable: {term}").into()),
        Outcome::NotApplicable(term) => Ok(Completion::ignored_with(format!("not applicable: {term}"))),
    };
    Trial::ignorable_test(test.name.clone(), move || run(test)).with_ignored_flag(ignored)
}

fn nothing_applies(plan: &Plan<'_>) -> String {
    let mut terms: BTreeMap<&str, usize> = BTreeMap::new();
    plan.not_applicable.iter().for_each(|(_, term)| *terms.entry(term).or_default() += 1);
    let lines = terms.iter().take(TOLD).map(|(term, count)| format!("\n  {count} cases: {term}"));
    match terms.is_empty() {
        true => "nothing applies: no case matches `suites`, `edition` and `filter`".to_owned(),
        false => format!("nothing applies:{}", lines.collect::<String>()),
    }
}

fn rendered(problems: &[Problem]) -> String {
    problems.iter().map(|problem| problem.render(false)).collect::<Vec<_>>().join("\n\n")
}

//! The main scenarios and charts of Annex G, activity by activity, and whether the cases lead a DUT through all of them.
//!
//! Data: `testcases/scenarios.yaml`. A case names its scenario, each of its steps the activities it is about.

use crate::case::{Case, Suite};
use crate::library::EVERYTHING;
use crate::problem::{Problem, Source, suggestion};
use crate::tree::{self, Fields};
use crate::yaml::{self, Node};
use fsct_adapters::Role;
use fsct_protocol::Edition;
use fsct_reports::record::{ActivityInfo, ScenarioInfo};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

/// Group of the suites whose cases lead through scenarios.
pub const GROUP: &str = "annex-g";

/// Who takes part, as written; the charts of the reports draw them in this order.
const ACTORS: &[(&str, &str)] =
    &[("operator", "operator"), ("tool", "tool"), ("master", "master"), ("device", "device")];
const EDITIONS: &[(Edition, &str)] = &[(Edition::V1_1, "v1.1"), (Edition::Iec2022, "iec2022")];
const ROLES: [(Role, &str); 2] = [(Role::Device, "device"), (Role::Master, "master")];

/// Something that happens in a scenario.
#[derive(Clone, Debug)]
struct Activity {
    number: u16,
    /// The one edition that has it; `None`: both.
    edition: Option<Edition>,
    from: &'static str,
    /// `None`: it happens within `from`.
    to: Option<&'static str>,
    what: String,
    then: String,
    /// Why no case reaches it on a DUT of this role.
    out_of_reach: BTreeMap<&'static str, String>,
    at: Range<usize>,
}

impl Activity {
    fn is_in(&self, edition: Edition) -> bool {
        self.edition.is_none_or(|own| own == edition)
    }

    fn concerns(&self, role: &str) -> bool {
        self.from == role || self.to == Some(role)
    }
}

/// A scenario or chart.
#[derive(Clone, Debug)]
struct Scenario {
    id: String,
    title: String,
    clauses: Vec<(Edition, String)>,
    activities: Vec<Activity>,
}

/// All of them.
#[derive(Debug)]
pub struct Scenarios {
    source: Arc<Source>,
    list: Vec<Scenario>,
}

impl Scenarios {
    /// Reads the scenarios.
    ///
    /// # Errors
    /// Every problem that can be told without knowing the cases.
    pub fn parse(source: &Arc<Source>) -> Result<Scenarios, Vec<Problem>> {
        let root = yaml::parse(source).map_err(|problem| vec![problem])?;
        let mut problems = Vec::new();
        let mut list: Vec<Scenario> = Vec::new();
        for item in tree::list(source, &root, "the list of scenarios", &mut problems) {
            let Some(scenario) = scenario(source, item, &mut problems) else { continue };
            if list.iter().any(|known| known.id == scenario.id) {
                let message = format!("scenario `{}` stands already above", scenario.id);
                problems.push(Problem::new(source, item.at.clone(), message));
            }
            list.push(scenario);
        }
        if problems.is_empty() { Ok(Scenarios { source: source.clone(), list }) } else { Err(problems) }
    }

    /// Checks the scenarios against the cases: what a case names exists in its editions and comes in order, and every activity
    /// that a role takes part in is in a case for it or says why not.
    pub fn check(&self, suites: &[Suite], problems: &mut Vec<Problem>) {
        let mut touched: BTreeSet<(&str, &str, u16)> = BTreeSet::new();
        for case in suites.iter().flat_map(|suite| &suite.cases) {
            let Some((id, at)) = &case.scenario else { continue };
            let Some(scenario) = self.list.iter().find(|scenario| scenario.id == *id) else {
                let message = format!("case {} names an unknown scenario `{id}`", case.id);
                let help = suggestion(id, self.list.iter().map(|scenario| scenario.id.as_str()));
                problems.push(Problem::new(&case.source, at.clone(), message).help(help));
                continue;
            };
            let numbers = scenario.check(case, problems);
            let (_, role) = ROLES[usize::from(case.role == Role::Master)];
            touched.extend(numbers.into_iter().map(|number| (scenario.id.as_str(), role, number)));
        }
        for scenario in &self.list {
            for activity in &scenario.activities {
                for (_, role) in ROLES {
                    let number = activity.number;
                    let touched = touched.contains(&(scenario.id.as_str(), role, number));
                    let message = match (touched, activity.out_of_reach.contains_key(role)) {
                        (true, true) => format!(
                            "activity {number} of {} is out of reach of a {role}, but a case is about it",
                            scenario.id
                        ),
                        (false, false) if activity.concerns(role) => format!(
                            "no case for a {role} is about activity {number} of {}; `out_of_reach: {{{role}: why}}` says why",
                            scenario.id
                        ),
                        _ => continue,
                    };
                    problems.push(Problem::new(&self.source, activity.at.clone(), message));
                }
            }
        }
    }

    /// What a record says of the scenarios of these names.
    pub fn info(&self, wanted: &BTreeSet<&str>) -> Vec<ScenarioInfo> {
        self.list.iter().filter(|scenario| wanted.contains(scenario.id.as_str())).map(Scenario::info).collect()
    }
}

impl Scenario {
    /// The activities a case is about.
    fn check(&self, case: &Case, problems: &mut Vec<Problem>) -> Vec<u16> {
        let points = case.expand(&EVERYTHING).map(|expansion| expansion.points).unwrap_or_default();
        let Some(first) = points.first() else { return Vec::new() };
        let editions: Vec<Edition> =
            Edition::ALL.into_iter().filter(|edition| points.iter().any(|p| p.variant.edition == *edition)).collect();
        // What is wrong with the steps themselves is told where every case is checked.
        let steps = case.steps(first, &mut Vec::new());
        let mut problem = |at: &Range<usize>, message: String| {
            problems.push(Problem::new(&case.source, at.clone(), message));
        };
        for edition in &editions {
            if !self.clauses.iter().any(|(own, _)| own == edition) {
                problem(
                    &case.at,
                    format!("{} has no {}; give the case a `sweep: {{edition: [...]}}`", edition, self.id),
                );
            }
        }
        let (mut numbers, mut last) = (Vec::new(), 0);
        for step in &steps {
            for number in &step.activities {
                let known = |edition: &Edition| {
                    self.activities.iter().any(|activity| activity.number == *number && activity.is_in(*edition))
                };
                if let Some(edition) = editions.iter().find(|edition| !known(edition)) {
                    problem(&step.at, format!("{} has no activity {number} in {edition}", self.id));
                }
                if *number < last && !step.noted {
                    let message = format!(
                        "activity {number} of {} comes before {last}; a `note` at the step says why it is the other way round",
                        self.id
                    );
                    problem(&step.at, message);
                }
                last = *number;
                numbers.push(*number);
            }
        }
        if numbers.is_empty() {
            problem(&case.at, format!("case {} names {} but no step an `activity` of it", case.id, self.id));
        }
        numbers
    }

    fn info(&self) -> ScenarioInfo {
        let activity = |activity: &Activity| ActivityInfo {
            number: activity.number,
            edition: activity.edition.map(|edition| edition.name().to_owned()).unwrap_or_default(),
            from: activity.from.to_owned(),
            to: activity.to.unwrap_or_default().to_owned(),
            what: activity.what.clone(),
            then: activity.then.clone(),
            out_of_reach: activity.out_of_reach.iter().map(|(role, why)| ((*role).to_owned(), why.clone())).collect(),
        };
        ScenarioInfo {
            id: self.id.clone(),
            title: self.title.clone(),
            clauses: self.clauses.iter().map(|(edition, clause)| (edition.name().to_owned(), clause.clone())).collect(),
            activities: self.activities.iter().map(activity).collect(),
        }
    }
}

fn scenario(source: &Arc<Source>, node: &Node, problems: &mut Vec<Problem>) -> Option<Scenario> {
    let mut fields = Fields::new(source, node, "a scenario", problems);
    let id = fields.text("scenario");
    let title = fields.text("title");
    let clause = fields.get("clause");
    let items = fields.get("activities");
    fields.finish(problems);
    let mut clauses = Vec::new();
    if let Some(clause) = clause {
        let mut fields = Fields::new(source, clause, "`clause`", problems);
        for (edition, name) in EDITIONS {
            clauses.extend(fields.optional(name).map(|placed| (*edition, placed.0)));
        }
        fields.finish(problems);
    }
    if clauses.is_empty() {
        problems.push(Problem::new(source, node.at.clone(), "a scenario needs `clause: {v1.1: ..., iec2022: ...}`"));
    }
    let Some(items) = items else {
        problems.push(Problem::new(source, node.at.clone(), "a scenario needs `activities`"));
        return None;
    };
    let mut activities: Vec<Activity> = Vec::new();
    for item in tree::list(source, items, "`activities`", problems) {
        let Some(activity) = activity(source, item, problems) else { continue };
        let twice = Edition::ALL.into_iter().find(|edition| {
            let same = |known: &&Activity| known.number == activity.number && known.is_in(*edition);
            activity.is_in(*edition) && activities.iter().find(same).is_some()
        });
        if let Some(edition) = twice {
            let message = format!("activity {} stands twice in {edition}", activity.number);
            problems.push(Problem::new(source, item.at.clone(), message));
        }
        activities.push(activity);
    }
    Some(Scenario { id: id?.0, title: title?.0, clauses, activities })
}

fn activity(source: &Arc<Source>, node: &Node, problems: &mut Vec<Problem>) -> Option<Activity> {
    let mut fields = Fields::new(source, node, "an activity", problems);
    let number = fields.optional_number("n", 1..=99);
    let edition = fields.optional_word("edition", EDITIONS);
    let from = fields.word("from", ACTORS);
    let to = fields.optional_word("to", ACTORS);
    let what = fields.text("what");
    let then = fields.optional("then").map(|placed| placed.0).unwrap_or_default();
    let reasons = fields.get("out_of_reach");
    fields.finish(problems);
    let mut out_of_reach = BTreeMap::new();
    if let Some(reasons) = reasons {
        let mut fields = Fields::new(source, reasons, "`out_of_reach`", problems);
        for (_, role) in ROLES {
            out_of_reach.extend(fields.optional(role).map(|placed| (role, placed.0)));
        }
        fields.finish(problems);
    }
    let Some(number) = number else {
        problems.push(Problem::new(source, node.at.clone(), "an activity needs its number `n`"));
        return None;
    };
    let number = number as u16;
    Some(Activity { number, edition, from: from?, to, what: what?.0, then, out_of_reach, at: node.at.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::suite;
    use rstest::rstest;

    const SCENARIOS: &str = "
- scenario: CH-G9
  title: A chart
  clause: {v1.1: Figure G.9}
  activities:
    - {n: 1, from: tool, to: master, what: One}
    - {n: 2, from: master, to: device, what: Two, out_of_reach: {device: why}}
    - {n: 3, edition: iec2022, from: operator, what: Three}
";

    fn source(name: &str, text: String) -> Arc<Source> {
        Arc::new(Source { name: name.into(), text })
    }

    /// What is wrong with a case for an FS-Master that begins with this and has these steps.
    fn wrong(scenarios: &str, head: &str, steps: &str) -> Vec<String> {
        let scenarios = Scenarios::parse(&source("scenarios.yaml", scenarios.into())).expect("sound scenarios");
        let text = format!(
            "suite: s\nabout: a\ncases:\n  - {{id: MY-0001, title: t, requirements: [R-1-01], dut: master, {head}, start: idle, steps: {steps}}}\n"
        );
        let suite = suite(&source("my.yaml", text)).expect("a sound suite");
        let mut problems = Vec::new();
        scenarios.check(&[suite], &mut problems);
        problems.iter().map(|problem| problem.render(false).lines().next().unwrap_or_default().to_owned()).collect()
    }

    #[rstest]
    #[case::sound("scenario: CH-G9, sweep: {edition: [v1.1]}", "[{look: {}, activity: 1}, {look: {}, activity: [2]}]", &[])]
    #[case::both_at_once("scenario: CH-G9, sweep: {edition: [v1.1]}", "[{look: {}, activity: [1, 2]}]", &[])]
    #[case::noted("scenario: CH-G9, sweep: {edition: [v1.1]}", "[{look: {}, activity: 2}, {look: {}, activity: 1, note: so}]", &[])]
    #[case::backwards(
        "scenario: CH-G9, sweep: {edition: [v1.1]}",
        "[{look: {}, activity: 2}, {look: {}, activity: 1}]",
        &["error: activity 1 of CH-G9 comes before 2; a `note` at the step says why it is the other way round"]
    )]
    #[case::other_edition(
        "scenario: CH-G9, sweep: {edition: [v1.1]}",
        "[{look: {}, activity: [1, 2]}, {look: {}, activity: 3}]",
        &["error: CH-G9 has no activity 3 in v1.1"]
    )]
    #[case::no_such_edition(
        "scenario: CH-G9",
        "[{look: {}, activity: [1, 2]}]",
        &["error: iec2022 has no CH-G9; give the case a `sweep: {edition: [...]}`"]
    )]
    #[case::unknown(
        "scenario: CH-G8",
        "[{look: {}, activity: 1}]",
        &[
            "error: case MY-0001 names an unknown scenario `CH-G8`",
            "error: no case for a master is about activity 1 of CH-G9; `out_of_reach: {master: why}` says why",
            "error: no case for a master is about activity 2 of CH-G9; `out_of_reach: {master: why}` says why",
        ]
    )]
    #[case::left_out(
        "scenario: CH-G9, sweep: {edition: [v1.1]}",
        "[{look: {}, activity: 1}]",
        &["error: no case for a master is about activity 2 of CH-G9; `out_of_reach: {master: why}` says why"]
    )]
    fn cases_and_scenarios_are_held_against_each_other(
        #[case] head: &str,
        #[case] steps: &str,
        #[case] expected: &[&str],
    ) {
        assert_eq!(wrong(SCENARIOS, head, steps), expected);
    }

    #[test]
    fn a_reason_that_is_none_any_more_is_told() {
        let scenarios = SCENARIOS.replace("{device: why}", "{device: why, master: why}");
        let told = wrong(&scenarios, "scenario: CH-G9, sweep: {edition: [v1.1]}", "[{look: {}, activity: [1, 2]}]");
        assert_eq!(told, ["error: activity 2 of CH-G9 is out of reach of a master, but a case is about it"]);
    }

    #[rstest]
    #[case::twice(
        "- {scenario: A, title: t, clause: {v1.1: x}, activities: [{n: 1, from: tool, what: a}, {n: 1, edition: v1.1, from: tool, what: b}]}",
        "activity 1 stands twice in v1.1"
    )]
    #[case::no_clause("- {scenario: A, title: t, activities: []}", "a scenario needs `clause")]
    #[case::no_number(
        "- {scenario: A, title: t, clause: {v1.1: x}, activities: [{from: tool, what: a}]}",
        "an activity needs its number `n`"
    )]
    #[case::nobody(
        "- {scenario: A, title: t, clause: {v1.1: x}, activities: [{n: 1, from: robot, what: a}]}",
        "`robot` is no value of `from`"
    )]
    fn what_is_no_scenario_is_told(#[case] text: &str, #[case] expected: &str) {
        let problems = Scenarios::parse(&source("scenarios.yaml", text.into())).expect_err("it is not sound");
        assert!(
            problems.iter().any(|problem| problem.render(false).contains(expected)),
            "{}",
            problems[0].render(false)
        );
    }
}

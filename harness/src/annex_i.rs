//! What Annex I of v1.1 asks for, with what a run has to show for it and what it cannot show.
//!
//! Data: `testcases/annex-i.yaml`. `fsct run annex-i` runs every suite an item names, and the report sets the verdicts beside the
//! items.

use crate::ledger::{Class, Ledger};
use crate::problem::{Problem, Source, suggestion};
use crate::tree::{self, Fields, Placed};
use crate::yaml::{self, Node, Value};
use fsct_reports::dossier::CHAPTERS;
use fsct_reports::record::{Evidence, EvidenceItem};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// What is asked for on the command line to run everything that supports an item.
pub const NAME: &str = "annex-i";

/// Records of the ledger that an item has to be about.
const RECORDS: &str = "R-v11.I.";

/// The items, in the order of the annex.
#[derive(Debug)]
pub struct AnnexI {
    source: Arc<Source>,
    items: Vec<Item>,
}

#[derive(Debug)]
struct Item {
    chapter: String,
    clause: String,
    requirement: Placed,
    asks: Placed,
    cases: Vec<Placed>,
    figures: Vec<String>,
    documents: Vec<(String, String)>,
    gaps: Vec<String>,
}

impl AnnexI {
    /// Reads the items.
    ///
    /// # Errors
    /// Every problem that can be told without knowing suites and ledger.
    pub fn parse(source: &Arc<Source>) -> Result<AnnexI, Vec<Problem>> {
        let root = yaml::parse(source).map_err(|problem| vec![problem])?;
        let mut problems = Vec::new();
        let nodes = tree::list(source, &root, "Annex I", &mut problems);
        let items = nodes.iter().filter_map(|node| item(source, node, &mut problems)).collect();
        if problems.is_empty() { Ok(AnnexI { source: source.clone(), items }) } else { Err(problems) }
    }

    /// Checks the items: what they name exists, and every statement of the annex has one.
    pub fn check<'n>(
        &self,
        names: impl Iterator<Item = &'n str> + Clone,
        ledger: &Ledger,
        problems: &mut Vec<Problem>,
    ) {
        for (name, at) in self.items.iter().flat_map(|item| &item.cases) {
            if !names.clone().any(|known| known == name) {
                let message = format!("an item of Annex I names `{name}`, which is no suite and no group");
                let help = suggestion(name, names.clone());
                problems.push(Problem::new(&self.source, at.clone(), message).help(help));
            }
        }
        let mut about = BTreeSet::new();
        for (id, at) in self.items.iter().map(|item| &item.requirement) {
            about.insert(id.as_str());
            if ledger.get(id).is_none() {
                let message = format!("an item of Annex I names an unknown requirement `{id}`");
                problems.push(Problem::new(&self.source, at.clone(), message).help(suggestion(id, ledger.ids())));
            }
        }
        for id in ledger.ids().filter(|id| id.starts_with(RECORDS) && !about.contains(id)) {
            problems.push(Problem::without_place(&self.source.name, format!("has no item about {id}")));
        }
    }

    /// The suites and groups that support an item.
    pub fn suites(&self) -> BTreeSet<&str> {
        self.items.iter().flat_map(|item| &item.cases).map(|(name, _)| name.as_str()).collect()
    }

    /// What a record says of it. `members` gives the suites behind a name.
    pub fn evidence(&self, ledger: &Ledger, members: impl Fn(&str) -> Vec<String>) -> Evidence {
        let mut classes: BTreeMap<String, usize> = BTreeMap::new();
        for (class, name) in Class::ALL {
            let count = ledger.iter().filter(|requirement| requirement.class == class).count();
            classes.insert(name.to_owned(), count);
        }
        let items = self.items.iter().map(|item| EvidenceItem {
            chapter: item.chapter.clone(),
            clause: item.clause.clone(),
            asks: item.asks.0.clone(),
            cases: item.cases.iter().map(|(name, _)| (name.clone(), members(name))).collect(),
            figures: item.figures.clone(),
            documents: item.documents.clone(),
            gaps: item.gaps.clone(),
        });
        Evidence { items: items.collect(), classes }
    }
}

fn item(source: &Arc<Source>, node: &Node, problems: &mut Vec<Problem>) -> Option<Item> {
    let mut fields = Fields::new(source, node, "an item of Annex I", problems);
    let chapter = fields.word("chapter", &CHAPTERS.map(|chapter| (chapter.key, chapter.key)));
    let clause = fields.text("clause");
    let requirement = fields.text("requirement");
    let asks = fields.text("asks");
    let cases = fields.texts("cases");
    let figures = fields.texts("figures");
    let gaps = fields.texts("gaps");
    let documents = fields.get("documents").map_or(&[][..], |node| match &node.value {
        Value::Map(entries) => entries.as_slice(),
        _ => &[],
    });
    let documents: Vec<_> =
        documents.iter().filter_map(|(path, says)| Some((path.text.clone(), tree::scalar(says)?.0))).collect();
    if cases.is_empty() && figures.is_empty() && documents.is_empty() && gaps.is_empty() {
        fields.problem(node.at.clone(), "an item that nothing supports has to say so under `gaps`");
    }
    if let Some((_, at)) = cases.iter().find(|(name, _)| name == NAME) {
        fields.problem(at.clone(), format!("`{NAME}` is all of this and supports no item of it"));
    }
    fields.finish(problems);
    let text = |placed: Placed| placed.0;
    Some(Item {
        chapter: chapter?.to_owned(),
        clause: clause?.0,
        requirement: requirement?,
        asks: asks?,
        cases,
        figures: figures.into_iter().map(text).collect(),
        documents,
        gaps: gaps.into_iter().map(text).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::Library;

    fn parsed(text: &str) -> Result<AnnexI, Vec<Problem>> {
        AnnexI::parse(&Arc::new(Source { name: "annex-i.yaml".to_owned(), text: text.to_owned() }))
    }

    #[test]
    fn every_document_an_item_names_is_there() {
        let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
        let library = Library::embedded().expect("the files are sound");
        let annex = library.annex_i.expect("the binary carries it");
        for (path, _) in annex.items.iter().flat_map(|item| &item.documents) {
            assert!(std::path::Path::new(root).join(path).is_file(), "{path} is missing");
        }
    }

    #[test]
    fn an_item_without_support_names_its_gap() {
        let problems = parsed("- {clause: I.1, chapter: product, requirement: R-v11.I.1-01, asks: something}")
            .expect_err("no gap");
        assert!(problems[0].to_string().contains("has to say so under `gaps`"), "{}", problems[0]);
    }

    #[test]
    fn an_item_does_not_rest_on_all_items() {
        let problems =
            parsed("- {clause: I.1, chapter: product, requirement: R-v11.I.1-01, asks: x, cases: [annex-i]}");
        assert!(problems.expect_err("it is circular")[0].to_string().contains("supports no item"));
    }

    #[test]
    fn a_statement_without_an_item_and_an_unknown_suite_are_problems() {
        let library = Library::embedded().expect("the files are sound");
        let one = parsed("- {clause: I.1, chapter: product, requirement: R-v11.I.1-01, asks: x, cases: [scl-devise]}")
            .expect("sound");
        let mut problems = Vec::new();
        one.check(["scl-device"].into_iter(), &library.ledger, &mut problems);
        let said: Vec<String> = problems.iter().map(ToString::to_string).collect();
        assert!(said.iter().any(|text| text.contains("scl-devise")), "{said:?}");
        assert!(said.iter().any(|text| text.contains("no item about R-v11.I.4-01")), "{said:?}");
    }
}

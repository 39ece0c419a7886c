//! What is wrong with an input file, and where: one sentence, the line, the nearest known name.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// A text with a name, to point into.
#[derive(Debug)]
pub struct Source {
    /// Path as the user gave it, or the name of an embedded file.
    pub name: String,
    /// Its text.
    pub text: String,
}

impl Source {
    /// Line and column, both from 1, of an octet of the text.
    pub fn line_column(&self, at: usize) -> (usize, usize) {
        let before = self.text.get(..at).unwrap_or(&self.text);
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().map_or(0, |line| line.chars().count()) + 1;
        (line, column)
    }
}

/// Something wrong with an input.
#[derive(Clone, Debug)]
pub struct Problem {
    file: String,
    place: Option<(Arc<Source>, Range<usize>)>,
    message: String,
    help: Option<String>,
}

impl Problem {
    /// A problem at these octets of a text.
    pub fn new(source: &Arc<Source>, at: Range<usize>, message: impl Into<String>) -> Problem {
        let end = source.text.len();
        let at = at.start.min(end)..at.end.clamp(at.start.min(end), end);
        Problem { file: source.name.clone(), place: Some((source.clone(), at)), message: message.into(), help: None }
    }

    /// A problem with a file as a whole.
    pub fn without_place(file: &str, message: impl Into<String>) -> Problem {
        Problem { file: file.to_owned(), place: None, message: message.into(), help: None }
    }

    /// The same with a remedy.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Problem {
        self.help = Some(help.into());
        self
    }

    /// `file:line:column`, or the file alone.
    pub fn place(&self) -> String {
        match &self.place {
            Some((source, at)) => {
                let (line, column) = source.line_column(at.start);
                format!("{}:{line}:{column}", self.file)
            }
            None => self.file.clone(),
        }
    }

    /// The sentence alone.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Several lines with the text pointed at, as rustc prints them.
    pub fn render(&self, colour: bool) -> String {
        let Some((source, at)) = &self.place else {
            return format!("error: {self}");
        };
        // A snippet of one very long line would be printed whole.
        if source.text.lines().any(|line| line.len() > 2_000) {
            return format!("error: {self}");
        }
        let snippet = Snippet::source(&source.text)
            .path(&source.name)
            .fold(true)
            .annotation(AnnotationKind::Primary.span(at.clone()));
        let mut group = Level::ERROR.primary_title(self.message.as_str()).element(snippet);
        if let Some(help) = &self.help {
            group = group.element(Level::HELP.message(help.as_str()));
        }
        let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
        renderer.render(&[group]).to_string()
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place(), self.message)?;
        match &self.help {
            Some(help) => write!(f, "; {help}"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for Problem {}

/// The known name closest to `text`, when it is close enough to be what was meant.
pub fn nearest<'a>(text: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known
        .into_iter()
        .map(|name| (strsim::damerau_levenshtein(&name.to_lowercase(), &text.to_lowercase()), name))
        .filter(|(distance, name)| *distance <= 1 + name.chars().count() / 3)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

/// "did you mean `x`?" or, with nothing close, the list of what is known.
pub fn suggestion<'a>(text: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> String {
    match nearest(text, known.clone()) {
        Some(name) => format!("did you mean `{name}`?"),
        None => {
            let known: Vec<&str> = known.into_iter().take(24).collect();
            format!("known are {}", known.join(", "))
        }
    }
}

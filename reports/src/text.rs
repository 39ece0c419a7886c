//! Text that may come from a DUT, made harmless: what cannot be seen, what XML cannot carry and what reorders text becomes
//! an escape that can be read. Markup is escaped by the writers.

/// The text with every hostile character as an escape such as `\u{1b}`; line ends and tabs stay.
pub fn visible(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if is_hostile(c) { out.extend(c.escape_unicode()) } else { out.push(c) }
    }
    out
}

/// At most so many characters on one line, with a sign when some were left out, none of them hostile.
pub fn short(text: &str, most: usize) -> String {
    let line: String = text.chars().take(most + 1).map(|c| if c == '\n' { ' ' } else { c }).collect();
    let line = visible(&line);
    if line.chars().count() <= most {
        return line;
    }
    line.chars().take(most.saturating_sub(1)).chain(['…']).collect()
}

/// The text on at most so many lines of at most so many characters, with a sign when some was left out; no character is
/// hostile. There is one line at least. A word is broken only where a line would stay all but empty.
pub fn wrapped(text: &str, most: usize, lines: usize) -> Vec<String> {
    let mut rest = short(text, most.saturating_mul(lines));
    let mut out = Vec::new();
    while rest.chars().count() > most && out.len() + 1 < lines {
        let limit = rest.char_indices().nth(most).map_or(rest.len(), |(at, _)| at);
        let (head, tail) = match rest[..limit].rfind(' ').filter(|at| at * 3 > limit) {
            Some(at) => (&rest[..at], &rest[at + 1..]),
            None => rest.split_at(limit),
        };
        out.push(head.to_owned());
        rest = tail.to_owned();
    }
    out.push(short(&rest, most));
    out
}

const fn is_hostile(c: char) -> bool {
    match c {
        '\n' | '\t' => false,
        // Controls, among them the escape that begins terminal sequences.
        '\0'..='\u{1F}' | '\u{7F}'..='\u{9F}' => true,
        // Invisible, or reordering what follows.
        '\u{061C}'
        | '\u{200B}'..='\u{200F}'
        | '\u{2028}'..='\u{202E}'
        | '\u{2060}'..='\u{206F}'
        | '\u{FEFF}'
        | '\u{E0000}'..='\u{E007F}' => true,
        // No characters at all.
        '\u{FFFE}' | '\u{FFFF}' => true,
        _ => false,
    }
}

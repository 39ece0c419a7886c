//! The conditions of a machine and which way they decided, as a table of `report.html`.

use crate::asked::Asked;
use crate::record::{ConditionInfo, MachineInfo};
use crate::text::{short, visible as clean};
use maud::{Markup, html};

/// Characters of a text.
const TEXT: usize = 200;
/// Rows of the table.
const LISTED: usize = 120;

/// What was asked, and how often the answer was which.
pub fn table(asked: &Asked, machine: &MachineInfo) -> Markup {
    html! {
        p { (asked.said()) " · a side counts where it alone decided what was to be seen outside." }
        @for (kind, reached) in asked.kinds() {
            @for (name, said) in reached.contradicting.iter().take(LISTED) {
                p.fail { span.word { "✗ Seen although it cannot be: " } code { (short(name, TEXT)) } " of the " (kind) ", " (short(said, TEXT)) ". Either the goals or what was observed is wrong." }
            }
        }
        details open[asked.kinds().iter().any(|(_, reached)| !reached.missing.is_empty())] {
            summary { "Guards and timers, with the number of cases that saw them decide" }
            (conditions(asked, machine))
        }
    }
}

/// Every condition with how often each side of it decided.
pub fn conditions(asked: &Asked, machine: &MachineInfo) -> Markup {
    html! {
        div.scroll tabindex="0" role="group" aria-label="Guards and timers" {
            table {
                thead { tr { th { "State" } th { "Decides" } th { "Asked" } th { "true, expired" } th { "false, restarted" } th { "Clause" } } }
                tbody {
                    @for condition in machine.conditions.iter().take(LISTED) {
                        tr {
                            td { (short(&condition.state, TEXT)) }
                            td { (short(&condition.rows, TEXT)) }
                            td { code { (short(&condition.id, TEXT)) } " " (short(&condition.asks, TEXT)) }
                            @for words in [["true", "expired"], ["false", "restarted"]] {
                                (side(asked, machine, condition, words))
                            }
                            td { (short(&condition.clause, TEXT)) }
                        }
                    }
                }
            }
        }
    }
}

fn side(asked: &Asked, machine: &MachineInfo, condition: &ConditionInfo, words: [&str; 2]) -> Markup {
    let names = words.map(|word| format!("{} {word}", condition.id));
    let reason = || {
        let never = machine.guards.infeasible.iter().chain(&machine.timers.infeasible);
        never.filter(|(side, _)| names.contains(side)).map(|(_, reason)| reason.as_str()).next().unwrap_or("-")
    };
    match names.iter().find_map(|name| Some((name, asked.count(name)?))) {
        None => html! { td { span.soft { "cannot be: " (short(reason(), TEXT)) } } },
        Some((name, 0)) => html! {
            td.fail {
                span.word { "never" }
                @if let Some(key) = asked.nearest.get(name) { "; nearest is " code { (clean(&short(key, TEXT))) } }
            }
        },
        Some((_, count)) => html! { td { "in " (count) } },
    }
}

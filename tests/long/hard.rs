//! Hard cases: scenes that ask for trouble, each with the property that it must keep, on one, two and three ranks.
//!
//! The first line of a scene says what it is; lines below it what is promised of `summary.json`, by the path of a number,
//!
//! ```text
//! #> key value              at least            #= key value tolerance       this much
//! #< key value              at most             #~ scene key tolerance       as much as in another scene, relatively
//! #! code text              ends with this code and says this
//! ```
//!
//! With `TURBID_HARD_CASE=column` this one is run alone. `TURBID_HARD_TABLE=docs/hard.md cargo test --test long hard::the_table -- --ignored`
//! writes the table of cases there.

use std::{collections::BTreeMap, fmt::Write, fs, path::PathBuf};

use crate::common::{folder, number, root, said, turbid};
use serde_json::Value;

/// A scene, what it is, and its promises.
struct Case {
    name: String,
    path: PathBuf,
    about: String,
    promises: Vec<Promise>,
}

enum Promise {
    AtLeast(String, f64),
    AtMost(String, f64),
    Is(String, f64, f64),
    SameAs(String, String, f64),
    Refused(i32, String),
}

/// What a scene came to on some number of ranks.
enum CaseOutcome {
    Ended(Value),
    Refused(i32, String),
}

fn cases() -> Vec<Case> {
    let mut cases: Vec<Case> = fs::read_dir(root().join("tests/hard"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .map(|path| {
            let text = fs::read_to_string(&path).unwrap();
            let about = text.lines().next().unwrap().trim_start_matches("# ").to_owned();
            let promises = text.lines().filter_map(promise).collect();
            Case { name: path.file_stem().unwrap().to_str().unwrap().to_owned(), path, about, promises }
        })
        .collect();
    cases.sort_by(|one, two| one.name.cmp(&two.name));
    cases
}

fn promise(line: &str) -> Option<Promise> {
    let (sign, rest) = line.split_at_checked(2)?;
    let words: Vec<&str> = rest.split_whitespace().collect();
    let value = |place: usize| words[place].parse::<f64>().unwrap();
    match sign {
        "#>" => Some(Promise::AtLeast(words[0].to_owned(), value(1))),
        "#<" => Some(Promise::AtMost(words[0].to_owned(), value(1))),
        "#=" => Some(Promise::Is(words[0].to_owned(), value(1), value(2))),
        "#~" => Some(Promise::SameAs(words[0].to_owned(), words[1].to_owned(), value(2))),
        "#!" => Some(Promise::Refused(words[0].parse().unwrap(), words[1..].join(" "))),
        _ => None,
    }
}

fn outcome(case: &Case, ranks: usize) -> CaseOutcome {
    let out = folder(&format!("hard-{}-{ranks}", case.name));
    let output = turbid(ranks, &["run", case.path.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    match output.status.code() {
        Some(0) => CaseOutcome::Ended(serde_json::from_str(&fs::read_to_string(out.join("summary.json")).unwrap()).unwrap()),
        code => CaseOutcome::Refused(code.unwrap_or(-1), said(&output)),
    }
}

impl Case {
    /// Names of the cases with which it is compared.
    fn others(&self) -> Vec<String> {
        let other = |promise: &Promise| match promise {
            Promise::SameAs(scene, ..) => Some(scene.trim_end_matches(".toml").to_owned()),
            _ => None,
        };
        self.promises.iter().filter_map(other).collect()
    }
}

impl Promise {
    /// What is promised, and what was seen; fails if they differ.
    fn keep(&self, name: &str, outcome: &CaseOutcome, others: &BTreeMap<String, Value>) -> (String, String) {
        match (self, outcome) {
            (Promise::Refused(code, text), CaseOutcome::Refused(found, said)) => {
                assert!(code == found && said.contains(text), "{name}: ended with {found} instead of {code}: {said}");
                (format!("refused: `{text}`"), format!("exit code {found}"))
            }
            (Promise::Refused(..), CaseOutcome::Ended(_)) => panic!("{name} is not refused"),
            (_, CaseOutcome::Refused(code, said)) => panic!("{name}: ended with {code}: {said}"),
            (Promise::AtLeast(key, bound), CaseOutcome::Ended(summary)) => {
                let found = number(summary, key);
                assert!(found >= *bound, "{name}: {key} is {found}, promised at least {bound}");
                (format!("`{key}` >= {bound:e}"), format!("{found:.3e}"))
            }
            (Promise::AtMost(key, bound), CaseOutcome::Ended(summary)) => {
                let found = number(summary, key);
                assert!(found <= *bound, "{name}: {key} is {found}, promised at most {bound}");
                (format!("`{key}` <= {bound:e}"), format!("{found:.3e}"))
            }
            (Promise::Is(key, value, tolerance), CaseOutcome::Ended(summary)) => {
                let found = number(summary, key);
                assert!((found - value).abs() <= *tolerance, "{name}: {key} is {found}, promised {value} +- {tolerance}");
                (format!("`{key}` = {value} +- {tolerance:e}"), format!("{found}"))
            }
            (Promise::SameAs(scene, key, tolerance), CaseOutcome::Ended(summary)) => {
                let (found, other) = (number(summary, key), number(&others[scene.trim_end_matches(".toml")], key));
                assert!((found / other - 1.0).abs() <= *tolerance, "{name}: {key} is {found}, in {scene} {other}");
                (format!("`{key}` as in `{scene}` +- {tolerance:e}"), format!("{:.1e}", (found / other - 1.0).abs()))
            }
        }
    }
}

/// The cases, or the one that is asked for and those with which it is compared.
fn asked_for() -> Vec<Case> {
    let mut cases = cases();
    assert!(cases.len() >= 20);
    if let Ok(asked) = std::env::var("TURBID_HARD_CASE") {
        let others: Vec<String> = cases.iter().filter(|case| case.name == asked).flat_map(Case::others).collect();
        cases.retain(|case| case.name == asked || others.contains(&case.name));
        assert!(!cases.is_empty(), "there is no tests/hard/{asked}.toml");
    }
    cases
}

/// For each case what is promised and what was seen on some number of ranks; fails if they differ.
fn kept(cases: &[Case], ranks: usize) -> Vec<Vec<(String, String)>> {
    let outcomes: Vec<CaseOutcome> = cases.iter().map(|case| outcome(case, ranks)).collect();
    let ended = |(case, outcome): (&Case, &CaseOutcome)| match outcome {
        CaseOutcome::Ended(summary) => Some((case.name.clone(), summary.clone())),
        CaseOutcome::Refused(..) => None,
    };
    let others: BTreeMap<String, Value> = cases.iter().zip(&outcomes).filter_map(ended).collect();
    let of_case = |(case, outcome): (&Case, &CaseOutcome)| {
        assert!(!case.promises.is_empty(), "{} promises nothing", case.name);
        let name = format!("{} on {ranks} ranks", case.name);
        case.promises.iter().map(|promise| promise.keep(&name, outcome, &others)).collect()
    };
    cases.iter().zip(&outcomes).map(of_case).collect()
}

// one test for each number of ranks: they run side by side

#[test]
fn every_hard_case_keeps_its_promises_on_one_rank() {
    kept(&asked_for(), 1);
}

#[test]
fn every_hard_case_keeps_its_promises_on_two_ranks() {
    kept(&asked_for(), 2);
}

#[test]
fn every_hard_case_keeps_its_promises_on_three_ranks() {
    kept(&asked_for(), 3);
}

#[test]
#[ignore = "writes the table of the manual"]
fn the_table_of_hard_cases_is_written() {
    let path = std::env::var("TURBID_HARD_TABLE").expect("TURBID_HARD_TABLE is the file to write");
    let cases = asked_for();
    let seen = [1, 2, 3].map(|ranks| kept(&cases, ranks));
    fs::write(root().join(path), table(&cases, &seen)).unwrap();
}

/// The cases with what was promised and what was seen on one, two and three ranks.
fn table(cases: &[Case], seen: &[Vec<Vec<(String, String)>>; 3]) -> String {
    let mut text = fs::read_to_string(root().join("docs/parts/hard-head.md")).unwrap();
    text += "\n| case | promised | seen on 1, 2, 3 ranks |\n|-|-|-|\n";
    for (number, case) in cases.iter().enumerate() {
        for place in 0..case.promises.len() {
            let about = if place == 0 { format!("{} (`tests/hard/{}.toml`)", case.about, case.name) } else { String::new() };
            let values = seen.each_ref().map(|kept| kept[number][place].1.as_str());
            let same = values.iter().all(|value| *value == values[0]);
            let values = if same { values[0].to_owned() } else { values.join(", ") };
            writeln!(text, "| {about} | {} | {values} |", seen[0][number][place].0).unwrap();
        }
    }
    text + &fs::read_to_string(root().join("docs/parts/hard-fuzz.md")).unwrap()
}

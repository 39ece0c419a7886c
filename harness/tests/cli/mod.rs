//! Runs `fsct` as a user does, in a folder of its own.
#![allow(dead_code, reason = "not every test needs all of it")]

use assert_cmd::Command;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A folder of its own for a test, gone when the test ends.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("fsct-test-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("the folder for temporary files can be written");
        Folder(path)
    }

    pub fn file(&self, name: &str, text: &str) -> String {
        let path = self.0.join(name);
        std::fs::write(&path, text).expect("it can be written");
        path.display().to_string()
    }

    pub fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// What is recorded so far, line by line.
    pub fn lines(&self) -> Vec<Value> {
        let text = std::fs::read_to_string(self.0.join("run.jsonl")).unwrap_or_default();
        text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
    }

    /// How many cases were planned: a thousand at least, when nothing narrowed the run.
    pub fn planned(&self) -> usize {
        let planned = self.lines().first().and_then(|line| line["header"]["planned"].as_u64());
        let planned = usize::try_from(planned.expect("there is a header")).expect("it fits");
        assert!(planned > 1_000, "only {planned} cases were planned");
        planned
    }

    /// How many cases there are of each execution and verdict: "ok pass".
    pub fn counts(&self) -> BTreeMap<String, usize> {
        let mut counts = BTreeMap::new();
        for case in self.lines().iter().filter_map(|line| line.get("case")) {
            let word = |key: &str| case[key].as_str().unwrap_or_default().to_owned();
            *counts.entry(format!("{} {}", word("execution"), word("verdict"))).or_default() += 1;
        }
        counts
    }

    pub fn out(&self) -> String {
        self.0.display().to_string()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Runs the command as a user does.
pub fn fsct(args: &[&str]) -> Outcome {
    let output = Command::cargo_bin("fsct").expect("it is built").args(args).output().expect("it runs");
    Outcome {
        code: output.status.code().expect("it ends by itself"),
        out: String::from_utf8_lossy(&output.stdout).into_owned(),
        err: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

#[derive(Debug)]
pub struct Outcome {
    pub code: i32,
    pub out: String,
    pub err: String,
}

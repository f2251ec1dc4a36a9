//! Imports point down: no module imports from one that `lib.rs` lists after it, and siblings of floor 3 leave each other alone.

#![allow(clippy::unwrap_used)]

use std::{
    fs,
    path::{Path, PathBuf},
};

const FLOORS: [&[&str]; 7] = [
    &["error", "petsc", "parallel"],
    &["geometry", "grid"],
    &["body", "surface"],
    &["constraint", "contact", "flow"],
    &["scene", "simulation"],
    &["observe", "output", "study", "run"],
    &["cli"],
];

const SIBLINGS: [&str; 3] = ["constraint", "contact", "flow"];

fn floor(module: &str) -> Option<usize> {
    FLOORS.iter().position(|floor| floor.contains(&module))
}

fn sources(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, into);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            into.push(path);
        }
    }
}

/// Modules that a source names after `crate::`, also inside a braced list at the start of a `use`.
fn imports(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (place, _) in text.match_indices("crate::") {
        let rest = &text[place + "crate::".len()..];
        if let Some(list) = rest.strip_prefix('{') {
            let (mut depth, mut item) = (1, String::new());
            for character in list.chars() {
                match character {
                    '{' => depth += 1,
                    '}' => depth -= 1,
                    ',' if depth == 1 => found.push(std::mem::take(&mut item)),
                    _ if depth == 1 => item.push(character),
                    _ => {}
                }
                if depth == 0 {
                    break;
                }
            }
            found.push(item);
        } else {
            found.push(rest.to_owned());
        }
    }
    let word = |text: &String| text.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    found.iter().map(word).filter(|word| !word.is_empty()).collect()
}

#[test]
fn imports_point_down() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    let mut wrong = Vec::new();
    let mut checked = 0;
    for file in files {
        let relative = file.strip_prefix(&root).unwrap();
        let module = relative.components().next().unwrap().as_os_str().to_str().unwrap().trim_end_matches(".rs").to_owned();
        let Some(own) = floor(&module) else { continue };
        for import in imports(&fs::read_to_string(&file).unwrap()) {
            let Some(other) = floor(&import) else { continue };
            checked += 1;
            let sibling = import != module && SIBLINGS.contains(&module.as_str()) && SIBLINGS.contains(&import.as_str());
            if other > own || sibling {
                wrong.push(format!("{} imports {import}", relative.display()));
            }
        }
    }
    assert!(checked > 50, "only {checked} imports found: the test reads the wrong files");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_module_of_the_library_has_a_floor() {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs")).unwrap();
    let modules: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("pub mod ")).map(|name| name.trim_end_matches(';')).collect();
    let floors: Vec<usize> = modules.iter().map(|module| floor(module).unwrap_or_else(|| panic!("{module} has no floor"))).collect();
    assert!(floors.is_sorted(), "lib.rs lists modules in the order of their floors");
}

//! Imports point down: a module imports only from those that `lib.rs` lists before it, siblings leave each other alone, and no files import each
//! other in a circle.
//!
//! A name counts for the file that defines it, whatever modules hand it on; so re-exporting a name is not importing it. Tests may import
//! what they like.

use std::{
    collections::{BTreeMap, BTreeSet, VecDeque},
    fs, iter,
    path::Path,
};

use proc_macro2::{Delimiter, TokenStream, TokenTree};

const SIBLINGS: [&str; 3] = ["constraint", "contact", "flow"];

/// Segments of a path, from the root of the library on.
type Segments = Vec<String>;

/// A word, a sign, or what stands between brackets; literals are left out.
enum Token {
    Word(String),
    Sign(char),
    Group(Delimiter, Vec<Token>),
}

fn tokens(text: TokenStream) -> Vec<Token> {
    let token = |tree| match tree {
        TokenTree::Ident(word) => Some(Token::Word(word.to_string())),
        TokenTree::Punct(sign) => Some(Token::Sign(sign.as_char())),
        TokenTree::Group(group) => Some(Token::Group(group.delimiter(), tokens(group.stream()))),
        TokenTree::Literal(_) => None,
    };
    text.into_iter().filter_map(token).collect()
}

/// What a file says.
#[derive(Default)]
struct Source {
    /// Its place below `src`.
    file: String,
    /// Modules it declares.
    children: BTreeSet<String>,
    /// Items it defines.
    names: BTreeSet<String>,
    /// Names it brings in or hands on, and what they stand for.
    uses: BTreeMap<String, Segments>,
    /// Modules all of whose names it brings in.
    globs: Vec<Segments>,
    /// Names that it hands on.
    exports: BTreeSet<String>,
    /// Paths in its code, and single words.
    mentions: BTreeSet<Segments>,
}

impl Source {
    /// A path as written in a module, from the root on.
    fn absolute(module: &[String], path: &[String]) -> Segments {
        let mut base = if path[0] == "crate" { Vec::new() } else { module.to_vec() };
        let above = path.iter().take_while(|segment| *segment == "super").count();
        base.truncate(base.len().saturating_sub(above));
        let steps = path.iter().filter(|segment| !["crate", "self", "super"].contains(&segment.as_str()));
        base.into_iter().chain(steps.cloned()).collect()
    }

    fn read(&mut self, module: &[String], tokens: &[Token], top: bool) {
        let mut place = 0;
        while place < tokens.len() {
            let word = word(&tokens[place]);
            match (&tokens[place], word.as_deref()) {
                (Token::Sign('#'), _) if is_test(tokens.get(place + 1)) => place = end_of_item(tokens, place + 2),
                (_, Some("use")) => {
                    let end = end_of_item(tokens, place);
                    let shown = place > 0 && (is_word(&tokens[place - 1], "pub") || place > 1 && is_word(&tokens[place - 2], "pub"));
                    self.read_use(module, &tokens[place + 1..end], Vec::new(), shown);
                    place = end;
                }
                (_, Some("mod")) if top && tokens.get(place + 2).is_some_and(|token| is_sign(token, ';')) => {
                    self.children.extend(self::word(&tokens[place + 1]));
                    place += 2;
                }
                (_, Some("fn" | "struct" | "enum" | "trait" | "type" | "const" | "static" | "mod")) if top => {
                    self.names.extend(tokens.get(place + 1).and_then(self::word));
                }
                (_, Some("macro_rules")) => self.names.extend(tokens.get(place + 2).and_then(self::word)),
                (_, Some(first)) => {
                    let mut path = vec![first.to_owned()];
                    while let Some(next) = next_segment(&tokens[place + 1..]) {
                        path.push(next);
                        place += 3;
                    }
                    self.mentions.insert(path);
                }
                (Token::Group(_, group), _) => self.read(module, group, false),
                _ => {}
            }
            place += 1;
        }
    }

    /// The leaves of a tree after `use`.
    fn read_use(&mut self, module: &[String], tokens: &[Token], mut path: Segments, shown: bool) {
        for (place, token) in tokens.iter().enumerate() {
            match token {
                Token::Word(name) if name == "as" => return self.bring(module, path, word(&tokens[place + 1]).unwrap(), shown),
                Token::Word(name) => path.push(name.clone()),
                Token::Sign('*') => return self.globs.push(Self::absolute(module, &path)),
                Token::Group(_, inside) => {
                    // nothing follows a comma at the end
                    let leaves = inside.split(|token| is_sign(token, ',')).filter(|leaf| !leaf.is_empty());
                    leaves.for_each(|leaf| self.read_use(module, leaf, path.clone(), shown));
                    return;
                }
                _ => {}
            }
        }
        if path.last().is_some_and(|name| name == "self") {
            path.pop();
        }
        if let Some(name) = path.last().cloned() {
            self.bring(module, path, name, shown);
        }
    }

    fn bring(&mut self, module: &[String], path: Segments, name: String, shown: bool) {
        self.uses.insert(name.clone(), Self::absolute(module, &path));
        if shown {
            self.exports.insert(name);
        }
    }

    /// What it imports, as written, from the root on.
    fn imports(&self, module: &[String]) -> impl Iterator<Item = Segments> {
        let mentioned = |name: &String| self.mentions.iter().any(|path| path[0] == *name);
        let used = self.uses.iter().filter(move |(name, _)| !self.exports.contains(*name) || mentioned(name)).map(|(_, path)| path.clone());
        let rooted = |path: &&Segments| path.len() > 1;
        used.chain(self.mentions.iter().filter(rooted).map(|path| Self::absolute(module, path))).chain(self.globs.iter().cloned())
    }
}

fn word(token: &Token) -> Option<String> {
    if let Token::Word(word) = token { Some(word.clone()) } else { None }
}

fn is_word(token: &Token, wanted: &str) -> bool {
    word(token).is_some_and(|word| word == wanted)
}

fn is_sign(token: &Token, wanted: char) -> bool {
    matches!(token, Token::Sign(sign) if *sign == wanted)
}

/// The segment after `::`, if one follows.
fn next_segment(tokens: &[Token]) -> Option<String> {
    let [one, two, name, ..] = tokens else { return None };
    if is_sign(one, ':') && is_sign(two, ':') { word(name) } else { None }
}

/// Whether it is `[cfg(test)]`.
fn is_test(attribute: Option<&Token>) -> bool {
    let Some(Token::Group(Delimiter::Bracket, inside)) = attribute else { return false };
    let [cfg, Token::Group(Delimiter::Parenthesis, kind)] = &inside[..] else { return false };
    is_word(cfg, "cfg") && matches!(&kind[..], [test] if is_word(test, "test"))
}

/// The semicolon or the braces that end an item.
fn end_of_item(tokens: &[Token], start: usize) -> usize {
    let brace = |token: &Token| matches!(token, Token::Group(Delimiter::Brace, _));
    let import = tokens[start..].iter().take(3).any(|token| is_word(token, "use"));
    let ends = |token: &Token| is_sign(token, ';') || !import && brace(token);
    tokens[start..].iter().position(ends).map_or(tokens.len(), |length| start + length)
}

/// The sources of the library by module.
struct Library(BTreeMap<Segments, Source>);

impl Library {
    fn read() -> Library {
        let mut library = Library(BTreeMap::new());
        library.read_folder(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &[]);
        library
    }

    fn read_folder(&mut self, folder: &Path, module: &[String]) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let stem = path.file_stem().unwrap().to_str().unwrap().to_owned();
            let inside: Segments = module.iter().cloned().chain([stem.clone()]).collect();
            if stem == "tests" || stem == "main" {
                continue;
            }
            if path.is_dir() {
                self.read_folder(&path, &inside);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                let module = if stem == "mod" || stem == "lib" { module.to_vec() } else { inside };
                let file = path.strip_prefix(concat!(env!("CARGO_MANIFEST_DIR"), "/src")).unwrap().to_str().unwrap().to_owned();
                let mut source = Source { file, ..Source::default() };
                source.read(&module, &tokens(fs::read_to_string(&path).unwrap().parse().unwrap()), true);
                self.0.insert(module, source);
            }
        }
    }

    /// The module in whose file a path is defined, if it is in the library and no module itself.
    fn definer(&self, path: &[String], depth: usize) -> Option<Segments> {
        let mut module = Segments::new();
        for (place, segment) in path.iter().enumerate() {
            let (here, last) = (self.0.get(&module)?, place + 1 == path.len());
            if !last && here.children.contains(segment) {
                module.push(segment.clone());
            } else if here.names.contains(segment) {
                return Some(module);
            } else if depth == 0 {
                return None;
            } else if let Some(target) = here.uses.get(segment) {
                let target: Segments = target.iter().chain(&path[place + 1..]).cloned().collect();
                return self.definer(&target, depth - 1);
            } else {
                let through = |glob: &Segments| self.definer(&glob.iter().chain(&path[place..]).cloned().collect::<Segments>(), depth - 1);
                return here.globs.iter().find_map(through);
            }
        }
        None
    }

    /// The files that a file imports from.
    fn neighbours(&self, module: &[String]) -> BTreeSet<Segments> {
        let named = self.0[module].imports(module).filter_map(|path| self.definer(&path, 20));
        let whole = self.0[module].globs.iter().filter(|glob| self.0.get(*glob).is_some_and(|source| !source.names.is_empty())).cloned();
        named.chain(whole).filter(|other| other != module).collect()
    }

    fn file(&self, module: &[String]) -> &str {
        &self.0[module].file
    }
}

/// The shortest way from a module to another along imports, both included.
fn way(graph: &BTreeMap<Segments, BTreeSet<Segments>>, from: &Segments, to: &Segments) -> Option<Vec<Segments>> {
    let (mut came_from, mut queue) = (BTreeMap::new(), VecDeque::from([from]));
    while let Some(module) = queue.pop_front() {
        if module == to {
            let mut way: Vec<Segments> = iter::successors(Some(to), |module| came_from.get(*module).copied()).cloned().collect();
            way.reverse();
            return Some(way);
        }
        for next in &graph[module] {
            if next != from && !came_from.contains_key(next) {
                came_from.insert(next, module);
                queue.push_back(next);
            }
        }
    }
    None
}

#[test]
fn modules_import_from_those_before_them() {
    let library = Library::read();
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs")).unwrap();
    let order: Vec<&str> = text
        .lines()
        .filter_map(|line| line.strip_prefix("pub mod ").or_else(|| line.strip_prefix("mod ")))
        .map(|name| name.trim_end_matches(';'))
        .collect();
    let (mut wrong, mut checked) = (BTreeSet::new(), 0);
    for (module, source) in library.0.iter().filter(|(module, _)| !module.is_empty()) {
        let own = order.iter().position(|name| *name == module[0]).unwrap();
        let written = source.imports(module).filter(|path| path.len() > 1).map(|path| path[0].clone());
        for import in written.chain(library.neighbours(module).into_iter().map(|other| other[0].clone())) {
            let Some(other) = order.iter().position(|name| *name == import) else { continue };
            checked += 1;
            if other > own || other != own && SIBLINGS.contains(&order[other]) && SIBLINGS.contains(&order[own]) {
                wrong.insert(format!("{} imports from {import}", source.file));
            }
        }
    }
    assert!(checked > 500, "only {checked} imports found: the test reads the wrong files");
    assert!(wrong.is_empty(), "{}", wrong.into_iter().collect::<Vec<_>>().join("\n"));
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let library = Library::read();
    let graph: BTreeMap<Segments, BTreeSet<Segments>> =
        library.0.keys().map(|module| (module.clone(), library.neighbours(module))).collect();
    assert!(graph.values().map(BTreeSet::len).sum::<usize>() > 500, "the test reads the wrong files");
    let mut circles = BTreeSet::new();
    for (module, others) in &graph {
        for other in others.iter().filter(|other| other[0] == module[0]) {
            if let Some(mut way) = way(&graph, other, module) {
                // each circle once, from its first file on
                let first = way.iter().enumerate().min_by_key(|(_, module)| library.file(module)).unwrap().0;
                way.rotate_left(first);
                way.push(way[0].clone());
                circles.insert(way.iter().map(|module| library.file(module)).collect::<Vec<_>>().join(" -> "));
            }
        }
    }
    assert!(circles.is_empty(), "{} circles:\n{}", circles.len(), circles.into_iter().collect::<Vec<_>>().join("\n"));
}

/// Below each module the ones that it consists of; what these hold counts as theirs.
#[test]
fn no_folders_import_each_other_in_a_circle() {
    let library = Library::read();
    let mut graphs: BTreeMap<Segments, BTreeMap<Segments, BTreeSet<Segments>>> = BTreeMap::new();
    for module in library.0.keys() {
        for other in library.neighbours(module) {
            let shared = module.iter().zip(&other).take_while(|(one, two)| one == two).count();
            if shared == 0 || shared == module.len() || shared == other.len() {
                continue;
            }
            let graph = graphs.entry(module[..shared].to_vec()).or_default();
            graph.entry(module[..=shared].to_vec()).or_default().insert(other[..=shared].to_vec());
            graph.entry(other[..=shared].to_vec()).or_default();
        }
    }
    assert!(graphs.len() > 20, "the test reads the wrong files");
    let mut circles = BTreeSet::new();
    for graph in graphs.values() {
        for (module, others) in graph {
            for other in others {
                if let Some(mut way) = way(graph, other, module) {
                    let first = way.iter().enumerate().min_by_key(|(_, module)| module.join("/")).unwrap().0;
                    way.rotate_left(first);
                    circles.insert(way.iter().map(|module| module.join("/")).collect::<Vec<_>>().join(" -> "));
                }
            }
        }
    }
    assert!(circles.is_empty(), "{} circles:\n{}", circles.len(), circles.into_iter().collect::<Vec<_>>().join("\n"));
}

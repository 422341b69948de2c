//! Which file uses which, read from the text: `use` lines, and paths elsewhere.
//!
//! A name that a module only passes on (`pub use`) leads to the file that defines it, so a façade is no arrow; the
//! parent of a file is one only where the file uses what the parent itself defines.

use super::Source;
use std::collections::{BTreeMap, BTreeSet};

type Module = Vec<String>;

/// The arrows between the files of the crate, by module path.
pub(super) struct Graph(BTreeMap<Module, BTreeSet<Module>>);

impl Graph {
    pub(super) fn new(sources: &[Source]) -> Self {
        let modules: BTreeSet<Module> = sources.iter().map(|own| own.module.clone()).collect();
        let files: Vec<File> = sources.iter().map(|own| File::new(own, &modules)).collect();
        let passed_on: BTreeMap<Module, Module> = files.iter().flat_map(File::passed_on).collect();
        let definer = |path: &Module| definer(path.clone(), &passed_on, &modules);
        let arrows = files.iter().map(|file| {
            let ends = file.named(&modules);
            let ends = ends
                .iter()
                .filter_map(definer)
                .filter(|end| *end != file.module);
            (file.module.clone(), ends.collect())
        });
        Self(arrows.collect())
    }

    /// Whether a file uses another, perhaps by way of others.
    fn leads(&self, from: &Module, to: &Module) -> bool {
        let mut seen = BTreeSet::new();
        let mut next = vec![from];
        while let Some(module) = next.pop() {
            for end in self.0.get(module).into_iter().flatten() {
                if end == to {
                    return true;
                }
                if seen.insert(end) {
                    next.push(end);
                }
            }
        }
        false
    }

    /// The arrows that are part of a circle.
    pub(super) fn circles(&self) -> Vec<String> {
        let arrows = self
            .0
            .iter()
            .flat_map(|(from, ends)| ends.iter().map(move |to| (from, to)));
        let back = arrows.filter(|(from, to)| self.leads(to, from));
        back.map(|(from, to)| format!("{} -> {}", from.join("::"), to.join("::")))
            .collect()
    }

    /// The number of arrows.
    pub(super) fn arrows(&self) -> usize {
        self.0.values().map(BTreeSet::len).sum()
    }
}

/// All that a file names of the crate outside of comments, as paths from the root; `modules` are those that there are,
/// as far as children of the file matter.
pub(super) fn uses(source: &Source, modules: &BTreeSet<Module>) -> BTreeSet<Module> {
    let file = File::new(source, modules);
    let exported = file.exported.iter().cloned();
    file.named(modules).into_iter().chain(exported).collect()
}

struct File {
    module: Module,
    /// What is imported for its own use, from the root of the crate; and what is passed on.
    imported: Vec<Module>,
    exported: Vec<Module>,
    /// The rest of the text.
    body: String,
}

impl File {
    fn new(source: &Source, modules: &BTreeSet<Module>) -> Self {
        let own_code = source
            .text
            .split(
                "
mod tests {",
            )
            .next()
            .unwrap_or_default();
        let mut file = Self {
            module: source.module.clone(),
            imported: Vec::new(),
            exported: Vec::new(),
            body: String::new(),
        };
        let mut lines = own_code
            .lines()
            .filter(|line| !line.trim_start().starts_with("//"));
        while let Some(line) = lines.next() {
            let words = line.trim_start();
            let (is_public, rest) = match words.strip_prefix("pub") {
                Some(rest) => (true, rest.trim_start_matches(|c| c != ' ').trim_start()),
                None => (false, words),
            };
            let Some(tree) = rest.strip_prefix("use ") else {
                file.body.push_str(line);
                file.body.push('\n');
                continue;
            };
            let mut tree = tree.to_string();
            while !tree.contains(';') {
                tree.push_str(lines.next().unwrap_or(";"));
            }
            let paths = expanded(tree.trim_end_matches(';'));
            let paths = paths
                .iter()
                .filter_map(|path| absolute(path, &source.module, modules));
            let list = if is_public {
                &mut file.exported
            } else {
                &mut file.imported
            };
            list.extend(paths);
        }
        file
    }

    /// The names that are passed on, each with what it stands for.
    fn passed_on(&self) -> Vec<(Module, Module)> {
        let named = |path: &Module| {
            let name = path.last().cloned().unwrap_or_default();
            ([self.module.clone(), vec![name]].concat(), path.clone())
        };
        self.exported.iter().map(named).collect()
    }

    /// All that the file names of the crate, from the root.
    fn named(&self, modules: &BTreeSet<Module>) -> BTreeSet<Module> {
        let known = || self.imported.iter().chain(&self.exported);
        // An imported module is no use of it: what is named of it is.
        let items = self.imported.iter().filter(|path| !modules.contains(*path));
        let mut named: BTreeSet<Module> = items.cloned().collect();
        for path in paths(&self.body) {
            let local = known().find(|own| own.last() == path.first());
            // A single word is a name of the file's own, or one that it passes on; `pub(super)` and `mod x;` are no
            // uses.
            let absolute = absolute(&path, &self.module, modules).filter(|_| path.len() > 1);
            match (absolute, local) {
                (Some(path), _) => named.insert(path),
                (None, Some(local)) if path.len() > 1 => {
                    named.insert([local.clone(), path[1..].to_vec()].concat())
                }
                (None, Some(local)) => self.exported.contains(local) && named.insert(local.clone()),
                (None, None) => false,
            };
        }
        named
    }
}

/// The paths of a `use` tree, braces written out; renamed ones under their own names. A glob ends in `*`, which no
/// module defines, so it leads to the module itself.
fn expanded(tree: &str) -> Vec<Module> {
    let tree = tree.trim();
    let Some(open) = tree.find('{') else {
        let path = tree.split(" as ").next().unwrap_or_default();
        let names = path.split("::").map(|name| name.trim().to_string());
        let named = |name: &String| !name.is_empty() && (name != "self" || path == "self");
        return vec![names.filter(named).collect()];
    };
    let prefix: Module = expanded(tree[..open].trim_end_matches("::")).concat();
    let inside = &tree[open + 1..tree.rfind('}').unwrap_or(tree.len())];
    let (mut depth, mut parts) = (0, vec![String::new()]);
    for c in inside.chars() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(String::new());
                continue;
            }
            _ => {}
        }
        parts.last_mut().unwrap().push(c);
    }
    let written = parts.iter().filter(|part| !part.trim().is_empty());
    let ends = written.flat_map(|part| expanded(part));
    ends.map(|end| [prefix.clone(), end].concat()).collect()
}

/// A path from the root of the crate; none of another crate.
fn absolute(path: &[String], module: &Module, modules: &BTreeSet<Module>) -> Option<Module> {
    let first = path.first()?.as_str();
    let child = [module.clone(), path[..1].to_vec()].concat();
    match first {
        "crate" | "urts_mc" => Some(path[1..].to_vec()),
        "super" => {
            let ups = path.iter().take_while(|name| *name == "super").count();
            let parent = module[..module.len().saturating_sub(ups)].to_vec();
            Some([parent, path[ups..].to_vec()].concat())
        }
        _ if modules.contains(&child) => Some([module.clone(), path.to_vec()].concat()),
        _ => None,
    }
}

/// The module in which a path ends, what is passed on followed to where it is defined.
fn definer(
    mut path: Module,
    passed_on: &BTreeMap<Module, Module>,
    modules: &BTreeSet<Module>,
) -> Option<Module> {
    for _ in 0..4 {
        let longer =
            (1..=path.len()).find_map(|length| Some((length, passed_on.get(&path[..length])?)));
        let Some((length, target)) =
            longer.filter(|(length, _)| !modules.contains(&path[..*length]))
        else {
            break;
        };
        path = [target.clone(), path[length..].to_vec()].concat();
    }
    (1..=path.len())
        .rev()
        .map(|length| path[..length].to_vec())
        .find(|own| modules.contains(own))
}

/// Words joined by `::`, and single words, in a text.
fn paths(text: &str) -> BTreeSet<Module> {
    let part_of_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let written = text
        .split(|c| !part_of_path(c))
        .filter(|word| !word.is_empty());
    written
        .map(|word| {
            word.split("::")
                .map(|name| name.trim_matches(':').to_string())
        })
        .map(|names| names.filter(|name| !name.is_empty()).collect())
        .collect()
}

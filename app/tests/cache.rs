//! The cache as a user meets it: a second run finds the tree of the first.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Folder, Run, number, run, small_project, text};
use std::path::PathBuf;

/// A project of its own and an empty cache.
struct Place {
    folder: Folder,
    project: [String; 3],
}

impl Place {
    fn new() -> Self {
        let folder = Folder::new();
        let project = small_project(&folder);
        Self { folder, project }
    }

    fn trees(&self) -> PathBuf {
        self.folder.path("trees")
    }

    fn files(&self) -> Vec<PathBuf> {
        let Ok(listing) = std::fs::read_dir(self.trees()) else { return Vec::new() };
        listing.map(|entry| entry.unwrap().path()).collect()
    }

    fn run(&self, args: &[&str]) -> Run {
        run(common::command(args).env("TOPOUT_CACHE_DIR", self.trees()))
    }

    fn bake(&self, more: &[&str]) -> serde_json::Value {
        let project = self.project.iter().map(String::as_str);
        let args: Vec<&str> = ["bake"].into_iter().chain(project).collect();
        self.run(&[&args, more, &["--json", "-"]].concat()).good_json()
    }
}

#[test]
fn a_second_bake_takes_the_tree_from_the_cache_and_it_is_the_same() {
    let place = Place::new();
    let first = place.bake(&[]);
    assert_eq!(first["cache_hit"], false);
    assert_eq!(first["cache_folder"], text(&place.trees()));
    let bytes = std::fs::metadata(&place.files()[0]).unwrap().len();
    assert_eq!(number(&first, "cache_bytes"), bytes as f64);
    let second = place.bake(&[]);
    assert_eq!(second["cache_hit"], true);
    for same in ["clusters", "levels", "root_triangles", "level_table", "cache_bytes"] {
        assert_eq!(first[same], second[same], "{same}");
    }
    let paper = place.bake(&["--temporal", "paper"]);
    assert_eq!(paper["cache_hit"], false, "another promise is another tree");
    assert_eq!(place.files().len(), 2);
}

#[test]
fn no_cache_neither_takes_nor_keeps() {
    let place = Place::new();
    let without = place.bake(&["--no-cache"]);
    assert_eq!((&without["cache_hit"], number(&without, "cache_bytes")), (&false.into(), 0.0));
    assert!(without["cache_folder"].is_null() && place.files().is_empty());
    place.bake(&[]);
    assert_eq!(place.bake(&["--no-cache"])["cache_hit"], false);
}

#[test]
fn a_damaged_file_is_replaced() {
    let place = Place::new();
    let first = place.bake(&[]);
    let file = place.files().remove(0);
    let good = std::fs::read(&file).unwrap();
    std::fs::write(&file, &good[..good.len() / 2]).unwrap();
    let again = place.bake(&[]);
    assert_eq!(again["cache_hit"], false);
    assert_eq!(first["level_table"], again["level_table"]);
    assert_eq!(place.bake(&[])["cache_hit"], true);
}

#[test]
fn a_cache_that_cannot_be_written_costs_a_warning_and_nothing_else() {
    let place = Place::new();
    std::fs::write(place.trees(), "a file where the folder should be").unwrap();
    let model = place.project[0].as_str();
    let run = place.run(&["bake", model]);
    assert_eq!(run.code, 0);
    assert!(run.stderr.contains("not kept in the cache"), "{}", run.stderr);
    assert!(run.stdout.contains("not kept in"), "{}", run.stdout);
}

#[test]
fn list_names_what_lies_there_and_clear_removes_it() {
    let place = Place::new();
    let empty = place.run(&["cache", "list", "--json", "-"]).good_json();
    assert_eq!(empty["files"].as_array().unwrap().len(), 0);
    assert_eq!(number(&empty, "limit_bytes"), 2e9);
    let baked = place.bake(&[]);
    let list = place.run(&["cache", "list", "--json", "-"]).good_json();
    assert_eq!(list["bytes"], baked["cache_bytes"]);
    assert_eq!(list["files"][0]["project"], place.project[0]);
    assert_eq!(number(&list["files"][0], "elements"), 3.0);
    assert_eq!(list["files"][0]["temporal"], "tight");
    let said = place.run(&["cache", "list"]);
    assert!(said.stdout.contains(&text(&place.trees())), "{}", said.stdout);

    let cleared = place.run(&["cache", "clear", "--json", "-"]).good_json();
    assert_eq!(number(&cleared, "removed_files"), 1.0);
    assert_eq!(cleared["removed_bytes"], baked["cache_bytes"]);
    assert!(place.files().is_empty());
    assert_eq!(place.run(&["cache", "empty"]).code, 2);
}

#[test]
fn without_a_cache_there_is_nothing_to_list() {
    let run = common::topout(["cache", "list"]);
    assert_eq!(run.code, 1);
    assert!(run.stderr.contains("TOPOUT_CACHE_DIR"), "{}", run.stderr);
}

//! Files of the cache: what is kept comes back, and whatever else lies there does no harm.
#![allow(clippy::unwrap_used)]

use super::file::{self, read};
use super::*;
use crate::hdlod::tests::{built, scene};
use crate::hdlod::{Node, Settings, Simplifier, Temporal, select};
use crate::{BehaviourId, ElementId, Hdlod, Model, NamedView, Scene, View};
use glam::UVec2;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::fs;
use std::sync::Arc;
use std::time::{Duration, SystemTime};
use topout_schedule::{Behaviour, Time};

const TIGHT: Settings = Settings { temporal: Temporal::Tight, simplifier: Simplifier::Covers };

/// What is changed, and how.
type Change<'a, T> = (&'a str, &'a dyn Fn(&mut T));

/// Scenes that are the same in every run, with at least a dozen elements and some clusters.
fn scenes(n: usize) -> Vec<(Scene, Hdlod)> {
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    std::iter::from_fn(|| Some(scene().new_tree(&mut runner).unwrap().current()))
        .map(|scene| {
            let tree = built(&scene, Temporal::Tight);
            (scene, tree)
        })
        .filter(|(scene, tree)| scene.model.elements.len() > 12 && tree.clusters.len() > 2)
        .take(n)
        .collect()
}

fn bytes_of(key: &Key, tree: &Hdlod) -> Vec<u8> {
    let mut bytes = Vec::new();
    file::write(&mut bytes, key, &Info::default(), tree).unwrap();
    bytes
}

/// The checksum set right again after a change.
fn seal(bytes: &mut [u8]) {
    let mut hash = blake3::Hasher::new();
    hash.update(&bytes[..file::CHECKSUM_AT]);
    hash.update(&bytes[file::HEADER..]);
    bytes[file::CHECKSUM_AT..file::HEADER].copy_from_slice(hash.finalize().as_bytes());
}

/// A buffer at an address where a mapped file might lie.
fn aligned(bytes: &[u8], use_it: impl FnOnce(&[u8])) {
    let mut room = vec![0u64; bytes.len().div_ceil(8)];
    let room = &mut bytemuck::cast_slice_mut(&mut room)[..bytes.len()];
    room.copy_from_slice(bytes);
    use_it(room);
}

fn cache(limit_bytes: u64) -> (tempfile::TempDir, Cache) {
    let folder = tempfile::tempdir().unwrap();
    let cache = Cache::new(folder.path().join("trees"), limit_bytes);
    (folder, cache)
}

fn found(cache: &Cache, key: &Key, scene: &Scene) -> Option<Hdlod> {
    match cache.find(key, scene) {
        Found::Tree(tree, bytes) => {
            assert_eq!(bytes, fs::metadata(cache.path(key)).unwrap().len());
            Some(*tree)
        }
        Found::Nothing | Found::Unusable(_) => None,
    }
}

fn unusable(cache: &Cache, key: &Key, scene: &Scene) -> Unusable {
    match cache.find(key, scene) {
        Found::Unusable(why) => why,
        other => panic!("{other:?}"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn what_is_kept_comes_back(scene in scene(), paper in any::<bool>()) {
        let temporal = if paper { Temporal::Paper } else { Temporal::Tight };
        let tree = built(&scene, temporal);
        let key = Key::of(&scene, &Settings { temporal, ..TIGHT });
        let (_folder, cache) = cache(u64::MAX);
        prop_assert!(found(&cache, &key, &scene).is_none());
        let info = Info { project: "yard".into(), ..Info::default() };
        let bytes = cache.keep(&key, &info, &tree).unwrap();
        prop_assert_eq!(found(&cache, &key, &scene), Some(tree));
        let list = cache.list().unwrap();
        prop_assert_eq!(list.len(), 1);
        prop_assert_eq!((list[0].bytes, &list[0].info), (bytes, &Ok(info)));
    }
}

#[test]
fn the_key_depends_on_what_the_tree_depends_on_and_on_nothing_else() {
    let (scene, _) = scenes(1).remove(0);
    let key = Key::of(&scene, &TIGHT);
    let model: fn(&mut Scene) -> &mut Model = |s| Arc::make_mut(&mut s.model);
    let mut renamed = scene.clone();
    model(&mut renamed).name = "another".into();
    model(&mut renamed).elements[0].name = "another".into();
    model(&mut renamed).materials[0].name = "another".into();
    assert_eq!(key, Key::of(&renamed, &TIGHT));
    assert_ne!(key, Key::of(&scene, &Settings { temporal: Temporal::Paper, ..TIGHT }));

    let changes: [Change<Scene>; 12] = [
        ("vertex", &|s| model(s).meshes[1].vertices[3].position[0] += 1e-3),
        ("normal", &|s| model(s).meshes[1].vertices[3].normal[0] ^= 1),
        ("index", &|s| model(s).meshes[2].indices.swap(0, 1)),
        ("opaque", &|s| model(s).meshes[0].opaque -= 3),
        ("place", &|s| model(s).instances[0].world_from_mesh.translation.x += 1e-3),
        ("mesh", &|s| model(s).instances[0].mesh.0 ^= 1),
        ("element", &|s| model(s).elements[0].instances.end -= 1),
        ("colour", &|s| model(s).materials[1].color[2] += 1e-3),
        ("glass", &|s| model(s).materials[1].transparent ^= true),
        ("behaviour", &|s| s.behaviours[0] = Behaviour::new(true, vec![Time::MAX]).unwrap()),
        ("whose", &|s| s.element_behaviour[0].0 ^= 1),
        ("period", &|s| s.schedule.period.end = Time::from_seconds(101)),
    ];
    let mut keys = vec![key];
    for (what, change) in changes {
        let mut other = scene.clone();
        change(&mut other);
        let other = Key::of(&other, &TIGHT);
        assert!(!keys.contains(&other), "{what}");
        keys.push(other);
    }
}

#[test]
fn a_flipped_bit_anywhere_is_noticed() {
    let (scene, tree) = scenes(1).remove(0);
    let key = Key::of(&scene, &TIGHT);
    let good = bytes_of(&key, &tree);
    aligned(&good, |bytes| assert_eq!(read(bytes, &key, &scene), Ok(tree.clone())));
    let everywhere = (0..file::HEADER).chain((file::HEADER..good.len()).step_by(37));
    for (i, at) in everywhere.chain([good.len() - 1]).enumerate() {
        let mut bytes = good.clone();
        bytes[at] ^= 1 << (i % 8);
        aligned(&bytes, |bytes| {
            assert!(read(bytes, &key, &scene).is_err(), "byte {at} of {}", good.len());
        });
    }
}

#[test]
fn a_file_that_is_cut_off_or_runs_on_is_noticed() {
    let (scene, tree) = scenes(1).remove(0);
    let key = Key::of(&scene, &TIGHT);
    let good = bytes_of(&key, &tree);
    for length in (0..300).chain((300..good.len()).step_by(61)).chain([good.len() - 1]) {
        let why = read(&good[..length], &key, &scene).unwrap_err();
        let expected = if length < 8 { Unusable::Foreign } else { Unusable::Truncated };
        assert_eq!(why, expected, "{length} of {}", good.len());
    }
    let longer = [&good[..], &[0]].concat();
    assert_eq!(read(&longer, &key, &scene), Err(Unusable::Damaged));
}

#[test]
fn foreign_older_and_misplaced_files_are_replaced() {
    let mut two = scenes(2);
    let (other_scene, other_tree) = two.remove(1);
    let (scene, tree) = two.remove(0);
    let (_folder, cache) = cache(u64::MAX);
    let key = Key::of(&scene, &TIGHT);
    let other = Key::of(&other_scene, &TIGHT);
    let good = bytes_of(&key, &tree);
    let with = |at: usize, value: u32| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        seal(&mut bytes);
        bytes
    };
    let algorithm = crate::hdlod::ALGORITHM;
    let cases = [
        (b"A picture of the family.".to_vec(), Unusable::Foreign),
        (Vec::new(), Unusable::Foreign),
        (with(8, FORMAT - 1), Unusable::OtherVersion(FORMAT - 1, algorithm)),
        (with(12, algorithm + 1), Unusable::OtherVersion(FORMAT, algorithm + 1)),
        (bytes_of(&other, &other_tree), Unusable::OtherKey),
    ];
    fs::create_dir_all(cache.folder()).unwrap();
    for (bytes, expected) in cases {
        fs::write(cache.path(&key), bytes).unwrap();
        assert_eq!(unusable(&cache, &key, &scene), expected);
        assert_eq!(cache.list().unwrap().len(), 1, "{expected}");
        cache.keep(&key, &Info::default(), &tree).unwrap();
        assert_eq!(found(&cache, &key, &scene).as_ref(), Some(&tree), "{expected}");
    }
}

/// Whatever stands in a file with a right checksum: it is refused, or can be drawn.
#[test]
fn a_wrong_tree_with_a_right_checksum_is_refused_or_can_be_drawn() {
    for (scene, tree) in scenes(3) {
        let key = Key::of(&scene, &TIGHT);
        let good = bytes_of(&key, &tree);
        let (mut refused, mut taken) = (0, 0);
        for at in (48..file::CHECKSUM_AT).chain((file::HEADER..good.len()).step_by(11)) {
            for value in [0x00, 0x7f, 0xff, good[at].wrapping_add(1)] {
                let mut bytes = good.clone();
                bytes[at] = value;
                seal(&mut bytes);
                aligned(&bytes, |bytes| match read(bytes, &key, &scene) {
                    Ok(tree) => {
                        taken += 1;
                        draw(&scene, &tree);
                    }
                    Err(_) => refused += 1,
                });
            }
        }
        assert!(refused > 100 && taken > 10, "{refused} refused, {taken} taken");
    }
}

fn draw(scene: &Scene, tree: &Hdlod) {
    let (azimuth, elevation) = NamedView::Iso.angles();
    tree.stats();
    for factor in [0.1, 1.0, 30.0] {
        let focus = scene.model.bounds();
        let view = View::fit(&focus, azimuth, elevation, factor, UVec2::new(640, 480));
        for date in [-1, 3, 50, 99] {
            for span in select(scene, tree, &view, Time::from_seconds(date)).spans {
                let first = span.first_index as usize;
                for i in tree.indices.range(first..first + span.index_count as usize) {
                    assert!(span.base_vertex as usize + (i as usize) < tree.vertices.len());
                }
            }
        }
    }
}

#[test]
fn every_kind_of_wrong_reference_is_refused() {
    let (scene, good) = scenes(1).remove(0);
    assert_eq!(good.validate(&scene), Ok(()));
    let last = good.clusters.len() - 1;
    let inner = good.children.iter().position(|c| matches!(c, Node::Cluster(_))).unwrap();
    let changes: [Change<Hdlod>; 18] = [
        ("index", &|t| t.indices.short()[4] = u16::MAX),
        ("indices", &|t| _ = t.indices.short().pop()),
        ("vertices", &|t| _ = Arc::make_mut(&mut t.vertices).pop()),
        ("position", &|t| Arc::make_mut(&mut t.vertices)[2].position[1] = f32::NAN),
        ("material", &|t| Arc::make_mut(&mut t.vertices)[2].material = u16::MAX),
        ("child after parent", &|t| t.children[inner] = Node::Cluster(last as u32)),
        ("no such child", &|t| t.children[inner] = Node::Cluster(u32::MAX)),
        ("no such element", &|t| t.children[0] = Node::Leaf(ElementId(9999))),
        ("two parents", &|t| t.children[1] = t.children[0]),
        ("children", &|t| t.clusters[0].children = 0..u32::MAX),
        ("backwards", &|t| t.clusters[last].children = std::ops::Range { start: 3, end: 2 }),
        ("eps", &|t| t.clusters[0].eps = -1.0),
        ("box", &|t| t.clusters[0].bounds.max.x = f32::INFINITY),
        ("root", &|t| t.root = Some(Node::Cluster(0))),
        ("other dates", &|t| t.built[0].0 ^= 1),
        ("pair", &|t| t.clusters[0].pairs = [(t.built[0], BehaviourId(9999))].into()),
        ("no certificate", &|t| t.clusters[0].stale = true),
        ("loose", &|t| t.loose = vec![ElementId(9999)]),
    ];
    for (what, change) in changes {
        let mut tree = good.clone();
        change(&mut tree);
        assert!(tree.validate(&scene).is_err(), "{what}");
    }
    let mut fewer = scene.clone();
    fewer.behaviours.truncate(1);
    assert_eq!(good.validate(&fewer), Err("a cluster's runs"));
}

#[test]
fn many_writers_and_readers_at_once_see_whole_trees() {
    let (_folder, cache) = cache(u64::MAX);
    let projects = scenes(2);
    std::thread::scope(|scope| {
        for i in 0..8 {
            let (cache, (scene, tree)) = (&cache, &projects[i % 2]);
            let key = Key::of(scene, &TIGHT);
            scope.spawn(move || {
                for _ in 0..20 {
                    cache.keep(&key, &Info::default(), tree).unwrap();
                    assert_eq!(found(cache, &key, scene).as_ref(), Some(tree));
                }
            });
        }
    });
    assert_eq!(fs::read_dir(cache.folder()).unwrap().count(), 2, "nothing is left unfinished");
}

#[test]
fn what_was_not_used_for_longest_goes_first() {
    let projects = scenes(4);
    let keys: Vec<Key> = projects.iter().map(|(scene, _)| Key::of(scene, &TIGHT)).collect();
    let sizes: Vec<u64> =
        projects.iter().zip(&keys).map(|((_, t), k)| bytes_of(k, t).len() as u64).collect();
    // Room for all but the smallest, so that the last one pushes out one or two.
    let (_folder, cache) = cache(sizes.iter().sum::<u64>() - 1);
    let long_ago = SystemTime::now() - Duration::from_secs(9000);
    for (i, (key, (_, tree))) in keys.iter().zip(&projects).enumerate().take(3) {
        cache.keep(key, &Info::default(), tree).unwrap();
        let file = fs::File::open(cache.path(key)).unwrap();
        file.set_modified(long_ago + Duration::from_secs(i as u64)).unwrap();
    }
    assert!(found(&cache, &keys[0], &projects[0].0).is_some(), "which makes it the last used");
    cache.keep(&keys[3], &Info::default(), &projects[3].1).unwrap();
    assert!(!cache.path(&keys[1]).exists(), "the oldest");
    assert!(cache.path(&keys[2]).exists() && cache.path(&keys[0]).exists());
    assert_eq!(cache.list().unwrap()[0].path, cache.path(&keys[3]));
}

/// Every edit of the dates makes another tree of the same model: they push each other out, not the
/// trees of other projects.
#[test]
fn few_schedules_of_one_model_are_kept() {
    let (_folder, cache) = cache(u64::MAX);
    let projects = scenes(2);
    let long_ago = SystemTime::now() - Duration::from_secs(9000);
    let keep = |scene: &Scene, tree: &Hdlod, age: u64| {
        let key = Key::of(scene, &TIGHT);
        cache.keep(&key, &Info::default(), tree).unwrap();
        let file = fs::File::open(cache.path(&key)).unwrap();
        file.set_modified(long_ago + Duration::from_secs(age)).unwrap();
        key
    };
    let (other, other_tree) = &projects[1];
    let other_key = keep(other, other_tree, 0);
    let (scene, tree) = &projects[0];
    let paper = Key::of(scene, &Settings { temporal: Temporal::Paper, ..TIGHT });
    cache.keep(&paper, &Info::default(), tree).unwrap();
    let edited = |days: u64| {
        let mut scene = scene.clone();
        let period = scene.schedule.period;
        scene.schedule.period.end = period.end.plus_seconds(days as i64 * 86_400);
        scene
    };
    let most = MOST_SCHEDULES as u64;
    let keys: Vec<Key> = (0..most).map(|i| keep(&edited(i), tree, 10 + i)).collect();
    // Used again, so the second is the oldest.
    fs::File::open(cache.path(&keys[0])).unwrap().set_modified(SystemTime::now()).unwrap();
    let newest = keep(&edited(most), tree, 100);
    let there = |key: &Key| cache.path(key).exists();
    let left: Vec<bool> = keys.iter().map(there).collect();
    let expected: Vec<bool> = (0..keys.len()).map(|i| i != 1).collect();
    assert_eq!(left, expected);
    assert!(there(&newest) && there(&other_key) && there(&paper));
}

#[test]
fn a_tree_larger_than_the_limit_is_not_kept_and_pushes_nothing_out() {
    let (scene, tree) = scenes(1).remove(0);
    let key = Key::of(&scene, &TIGHT);
    let (_folder, roomy) = cache(u64::MAX);
    roomy.keep(&key, &Info::default(), &tree).unwrap();
    let tight = Cache::new(roomy.folder(), 100);
    let error = tight.keep(&key, &Info::default(), &tree).unwrap_err();
    assert!(matches!(error, StoreError::TooBig { limit_bytes: 100, .. }), "{error}");
    assert!(found(&roomy, &key, &scene).is_some());
    assert_eq!(fs::read_dir(roomy.folder()).unwrap().count(), 1);
}

#[test]
fn a_folder_that_cannot_be_written_is_an_error_and_finds_nothing() {
    let (scene, tree) = scenes(1).remove(0);
    let key = Key::of(&scene, &TIGHT);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "not a folder").unwrap();
    let cache = Cache::new(file.join("trees"), u64::MAX);
    assert!(matches!(cache.find(&key, &scene), Found::Nothing));
    let error = cache.keep(&key, &Info::default(), &tree).unwrap_err().to_string();
    assert!(error.contains("trees"), "{error}");
    assert!(cache.list().is_err());
}

#[test]
fn clearing_removes_trees_and_nothing_else() {
    let (_folder, cache) = cache(u64::MAX);
    assert_eq!(cache.clear().unwrap(), Total::default(), "no folder is an empty cache");
    let mut bytes = 0;
    for (scene, tree) in scenes(2) {
        bytes += cache.keep(&Key::of(&scene, &TIGHT), &Info::default(), &tree).unwrap();
    }
    let foreign = cache.folder().join("notes.hdlod");
    fs::write(&foreign, "mine").unwrap();
    let left = cache.folder().join(format!("{}.x7.unfinished", "a".repeat(64)));
    fs::write(&left, "half").unwrap();
    assert_eq!(cache.clear().unwrap(), Total { files: 3, bytes: bytes + 4 });
    assert!(foreign.exists() && !left.exists());
    assert_eq!(cache.list().unwrap(), []);
}

//! Edits of the schedule: the tree that is brought along against one that is worked out from
//! scratch, and against brute force.

use super::*;

/// Other dates for one element, or for all that share its dates, as one activity moves them.
#[derive(Clone, Debug)]
struct Change {
    element: usize,
    all_alike: bool,
    to: Behaviour,
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    let change = (0usize..90, prop::bool::weighted(0.7), behaviour())
        .prop_map(|(element, all_alike, to)| Change { element, all_alike, to });
    proptest::collection::vec(change, 1..4)
}

/// The scene after the changes, and the elements that they concern.
fn changed(scene: &Scene, changes: &[Change]) -> (Scene, Vec<ElementId>) {
    let mut after = scene.clone();
    for change in changes {
        let count = after.element_behaviour.len();
        let old = after.element_behaviour[change.element % count];
        let new = after.behaviours.iter().position(|b| *b == change.to).unwrap_or_else(|| {
            after.behaviours.push(change.to.clone());
            after.behaviours.len() - 1
        });
        for (i, own) in after.element_behaviour.iter_mut().enumerate() {
            if i == change.element % count || (change.all_alike && *own == old) {
                *own = BehaviourId(new as u32);
            }
        }
    }
    let differ = |i: &usize| scene.element_behaviour[*i] != after.element_behaviour[*i];
    let concerned =
        (0..scene.element_behaviour.len()).filter(differ).map(|i| ElementId(i as u32)).collect();
    (after, concerned)
}

/// Works out everything, not only what is above the changed elements.
fn from_scratch(tree: &Hdlod, scene: &Scene) -> Hdlod {
    let mut tree = tree.clone();
    tree.period.end = Time::MAX;
    let done = tree.restate(scene, &[]).unwrap();
    assert_eq!(done.clusters, tree.clusters.len());
    tree
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn an_edited_tree_equals_one_from_scratch_keeps_its_promise_and_can_be_undone(
        scene in scene(),
        edits in proptest::collection::vec(changes(), 1..4),
        times in proptest::collection::vec(0..END, 3),
        paper in prop::bool::weighted(0.2),
    ) {
        let original = built(&scene, if paper { Temporal::Paper } else { Temporal::Tight });
        let mut tree = original.clone();
        let mut now = scene.clone();
        for edit in &edits {
            let (after, concerned) = changed(&now, edit);
            let before = tree.clone();
            let done = tree.restate(&after, &concerned).unwrap();
            prop_assert_eq!(&tree, &from_scratch(&original, &after));
            check_report(&before, &tree, &done)?;
            now = after;
        }
        check_definitions(&tree, &now)?;
        for &second in &times {
            let time = Time::from_seconds(second);
            if !paper {
                check_promise(&tree, &now, time)?;
            }
            check_selection(&tree, &now, time)?;
        }

        let all: Vec<ElementId> = (0..scene.model.elements.len() as u32).map(ElementId).collect();
        let undone = Scene { behaviours: now.behaviours.clone(), ..scene.clone() };
        tree.restate(&undone, &all).unwrap();
        prop_assert_eq!(&tree, &original);
    }

    #[test]
    fn a_repaired_tree_holds_everywhere_within_the_same_thresholds(
        scene in scene(),
        first in changes(),
        second in changes(),
        times in proptest::collection::vec(0..END, 3),
    ) {
        let mut tree = built(&scene, Temporal::Tight);
        let (after, concerned) = changed(&scene, &first);
        tree.restate(&after, &concerned).unwrap();
        let mut tree = tree.repair(&after, &Progress::default()).unwrap();
        prop_assert_eq!(tree.stale_count(), 0);
        prop_assert_eq!(&from_scratch(&tree, &after), &tree);
        check_definitions(&tree, &after)?;
        for cluster in &tree.clusters {
            let level = tree.levels.iter().find(|l| l.level == cluster.level).unwrap();
            prop_assert!(cluster.eps <= cluster.covered_eps);
            prop_assert!(cluster.covered_eps <= level.eps_m * 1.001);
        }
        for &second in &times {
            check_promise(&tree, &after, Time::from_seconds(second))?;
        }
        // With the ids of a scene that was never edited it is a tree of that scene.
        let (fresh, ids) = after.renumbered();
        let renumbered = tree.clone().renumbered(&ids).unwrap();
        prop_assert_eq!(renumbered.validate(&fresh), Ok(()));
        prop_assert_eq!(&from_scratch(&renumbered, &fresh), &renumbered);
        for &second in &times {
            check_promise(&renumbered, &fresh, Time::from_seconds(second))?;
        }
        // What was repaired can be edited.
        let (again, concerned) = changed(&after, &second);
        tree.restate(&again, &concerned).unwrap();
        for &second in &times {
            check_promise(&tree, &again, Time::from_seconds(second))?;
            check_selection(&tree, &again, Time::from_seconds(second))?;
        }
    }
}

/// What was reported is what differs.
fn check_report(before: &Hdlod, after: &Hdlod, done: &Restated) -> Result<(), TestCaseError> {
    let dirty = |i: usize| done.dirty.iter().any(|r| r.contains(&i));
    for i in 0..before.indices.len() {
        prop_assert!(
            before.indices.at(i) == after.indices.at(i) || dirty(i),
            "index {i} is not told"
        );
    }
    for (i, (was, is)) in (0..).zip(before.clusters.iter().zip(&after.clusters)) {
        prop_assert_eq!(!was.stale && is.stale, done.invalidated.contains(&i));
        prop_assert_eq!(was.stale && !is.stale, done.revalidated.contains(&i));
    }
    prop_assert_eq!(&before.vertices, &after.vertices);
    Ok(())
}

/// At tolerance 0 exactly the present elements are drawn; at any, no cluster that does not hold.
fn check_selection(hdlod: &Hdlod, scene: &Scene, time: Time) -> Result<(), TestCaseError> {
    let mut view = View::fit(&scene.model.bounds(), 30.0, 20.0, 4.0, UVec2::new(640, 360));
    let far = select(scene, hdlod, &view, time);
    for stale in hdlod.clusters.iter().filter(|c| c.stale) {
        prop_assert!(far.spans.iter().all(|s| s.base_vertex != stale.base_vertex));
    }
    view.tolerance_px = 0.0;
    let drawn: BTreeSet<_> = select(scene, hdlod, &view, time).elements.into_iter().collect();
    let all = (0..scene.model.elements.len() as u32).map(ElementId);
    let present: BTreeSet<_> = all.filter(|id| scene.behaviour(*id).at(time)).collect();
    prop_assert_eq!(drawn, present);
    Ok(())
}

fn from(second: i64) -> Behaviour {
    Behaviour::new(false, vec![Time::from_seconds(second)]).unwrap()
}

/// Slabs that appear at second 10, each with a tile in it that appears at second 20.
fn slabs_with_tiles() -> Scene {
    let parts: Vec<Part> = (0..32)
        .flat_map(|i| {
            let center = Vec3::new((i % 8) as f32, 0.0, (i / 8) as f32);
            let slab =
                Part { center, size: Vec3::new(0.9, 0.1, 0.9), turn: 0.0, mesh: 0, behaviour: 0 };
            let tile = Part { size: Vec3::new(0.3, 0.1, 0.3), behaviour: 1, ..slab.clone() };
            [slab, tile]
        })
        .collect();
    scene_of(&parts, &[from(10), from(20)])
}

fn moved(scene: &Scene, element: usize, all_alike: bool, second: i64) -> (Scene, Vec<ElementId>) {
    changed(scene, &[Change { element, all_alike, to: from(second) }])
}

#[test]
fn certificates_survive_as_long_as_what_covers_comes_before_what_it_covers() {
    let scene = slabs_with_tiles();
    let original = built(&scene, Temporal::Tight);
    let relies = |c: &Cluster| c.pairs.contains(&(BehaviourId(0), BehaviourId(1)));
    let count = original.clusters.iter().filter(|c| relies(c)).count();
    assert!(count > 0, "slabs cover tiles");
    const SLABS: usize = 0;
    const TILES: usize = 1;
    for (element, second, holds) in [
        (SLABS, 15, true),
        (SLABS, 20, true),
        (SLABS, 21, false),
        (TILES, 10, true),
        (TILES, 9, false),
        (TILES, 90, true),
    ] {
        let (after, concerned) = moved(&scene, element, true, second);
        let mut tree = original.clone();
        let done = tree.restate(&after, &concerned).unwrap();
        let stale = tree.clusters.iter().filter(|c| c.stale).count();
        assert_eq!(stale == 0, holds, "{element} to {second}");
        assert_eq!(done.invalidated.len(), stale);
        let pairs_of = || tree.clusters.iter().zip(&original.clusters);
        assert!(pairs_of().all(|(a, b)| a.eps == b.eps || a.eps == b.covered_eps));
        for t in [8, 9, 12, 18, 20, 22, 95] {
            check_promise(&tree, &after, Time::from_seconds(t)).unwrap();
        }
    }
}

#[test]
fn one_of_several_that_are_alike_cannot_be_told_from_a_run() {
    let scene = slabs_with_tiles();
    let mut tree = built(&scene, Temporal::Tight);
    let (after, concerned) = moved(&scene, 0, false, 12);
    assert_eq!(concerned, [ElementId(0)]);
    let done = tree.restate(&after, &concerned).unwrap();
    assert!(!done.invalidated.is_empty());
    let repaired = tree.repair(&after, &Progress::default()).unwrap();
    assert_eq!(repaired.stale_count(), 0);
    for t in [9, 10, 11, 12, 30] {
        check_promise(&tree, &after, Time::from_seconds(t)).unwrap();
        check_promise(&repaired, &after, Time::from_seconds(t)).unwrap();
    }
}

/// The rule has a reason: without it the promise is broken.
#[test]
fn a_certificate_that_is_kept_wrongly_is_caught() {
    let scene = slabs_with_tiles();
    let mut tree = built(&scene, Temporal::Tight);
    tree.clusters.iter_mut().for_each(|c| c.pairs = Box::default());
    let (after, concerned) = moved(&scene, 0, true, 30);
    tree.restate(&after, &concerned).unwrap();
    assert_eq!(tree.stale_count(), 0, "nothing is known of what it relies on");
    assert!(check_promise(&tree, &after, Time::from_seconds(25)).is_err());
}

#[test]
fn what_was_never_there_is_drawn_once_it_is() {
    let scene = slabs_with_tiles();
    let (without, _) =
        changed(&scene, &[Change { element: 1, all_alike: true, to: Behaviour::never() }]);
    let mut tree = built(&without, Temporal::Tight);
    assert!(tree.loose.is_empty());
    let (after, concerned) = moved(&without, 1, true, 20);
    tree.restate(&after, &concerned).unwrap();
    assert_eq!(tree.loose.len(), 32);
    for t in [5, 15, 25] {
        check_selection(&tree, &after, Time::from_seconds(t)).unwrap();
    }
    let repaired = tree.repair(&after, &Progress::default()).unwrap();
    check_selection(&repaired, &after, Time::from_seconds(25)).unwrap();
    tree.restate(&without, &concerned).unwrap();
    assert!(tree.loose.is_empty());
}

/// A run that names a behaviour of the past belongs to a tree that was not repaired.
#[test]
fn a_tree_that_was_not_repaired_cannot_be_renumbered() {
    let scene = slabs_with_tiles();
    let (after, concerned) = moved(&scene, 0, true, 30);
    let mut tree = built(&scene, Temporal::Tight);
    tree.restate(&after, &concerned).unwrap();
    let (_, ids) = after.renumbered();
    assert_eq!(tree.clone().renumbered(&ids), Err(OtherScene));
    let repaired = tree.repair(&after, &Progress::default()).unwrap();
    assert!(repaired.renumbered(&ids).is_ok());
}

#[test]
fn another_scene_is_refused() {
    let mut tree = built(&slabs_with_tiles(), Temporal::Tight);
    assert_eq!(tree.restate(&Scene::default(), &[]), Err(OtherScene));
}

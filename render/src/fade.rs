//! Levels that follow each other without a jump: for a short time what was drawn and what is drawn now share
//! the pixels, in a pattern.
//!
//! When a cluster of the cut is refined, or gives way to one above it, the subtree between the two cuts fades.
//! Some of its pixels, of each square of 2 x 2 from none to three in four steps, show what is *coming*, the cut
//! of this frame; the others what is *going*: the cluster at the top of the subtree where it was refined, the
//! nodes below it where it was coarsened. So each pixel shows exactly one of the two.
//!
//! Both are within the tolerance all the time: while levels fade the cut is chosen for [`TOLERANCE`] of it, and
//! what is going is drawn only as long as it is within all of it. What appears or vanishes because of the date,
//! or enters the frame, does not fade: no node above or below it was drawn in the frame before.

use std::collections::{BTreeMap, HashSet};
use std::sync::{Arc, Weak};
use topout_scene::Hdlod;
use topout_scene::hdlod::{Node, Parents};

/// The share of the tolerance for which the cut is chosen while levels fade.
pub(crate) const TOLERANCE: f32 = 0.8;
/// Pixels of a square of 2 x 2, and so steps of a fade.
pub(crate) const STEPS: u32 = 4;

/// Which pixels show something that fades.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Share {
    /// The first so many of each square.
    Coming(u32),
    /// All but the first so many.
    Going(u32),
}

impl Share {
    /// How many there are.
    pub const COUNT: u32 = 2 * STEPS;

    /// Its number, as `shaders/common/fade.wgsl` reads it.
    pub fn code(self) -> u32 {
        match self {
            Self::Coming(step) => step,
            Self::Going(step) => STEPS + step,
        }
    }
}

/// A subtree in which the cut changed.
#[derive(Clone, PartialEq, Debug)]
struct Fade {
    /// Seconds.
    start: f64,
    /// What was drawn below its top before it was coarsened; `None` where the top itself was drawn.
    below: Option<Vec<Node>>,
}

/// Remembers the cut of the frame before, and which subtrees fade.
#[derive(Debug, Default)]
pub(crate) struct Fader {
    tree: Weak<Hdlod>,
    parents: Option<Parents>,
    cut: HashSet<Node>,
    /// By the cluster at the top; none is above another.
    fades: BTreeMap<u32, Fade>,
    now: f64,
    length: f64,
}

impl Fader {
    /// Forgets everything: the next cut is there at once.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Whether something fades.
    pub fn is_active(&self) -> bool {
        !self.fades.is_empty()
    }

    /// Subtrees that fade.
    pub fn count(&self) -> u32 {
        self.fades.len() as u32
    }

    /// Takes the cut of a frame at `now`, seconds; a fade takes `length`.
    pub fn step(&mut self, tree: &Arc<Hdlod>, cut: HashSet<Node>, now: f64, length: f64) {
        let known = self.tree.as_ptr() == Arc::as_ptr(tree);
        let parents = match self.parents.take().filter(|_| known) {
            Some(parents) => parents,
            None => {
                self.clear();
                self.tree = Arc::downgrade(tree);
                self.cut.clone_from(&cut);
                Parents::of(tree)
            }
        };
        (self.now, self.length) = (now, length);
        self.fades.retain(|_, fade| now - fade.start < length);
        self.refine(&parents, &cut);
        self.coarsen(&parents, &cut);
        // Where the top left the frame, or came back, nothing is left to fade.
        self.fades.retain(|&top, fade| fade.below.is_some() == cut.contains(&Node::Cluster(top)));
        self.cut = cut;
        self.parents = Some(parents);
    }

    /// Nodes that entered below one that was drawn.
    fn refine(&mut self, parents: &Parents, cut: &HashSet<Node>) {
        for &node in cut.difference(&self.cut) {
            let Some(top) = parents.above(node).find(|&c| self.cut.contains(&Node::Cluster(c)))
            else {
                continue;
            };
            if let Some(fade) = self.fades.get_mut(&top) {
                // It was coarsened just now: back again.
                if fade.below.take().is_some() {
                    fade.start = mirrored(fade.start, self.now, self.length);
                }
            } else if !parents.above(Node::Cluster(top)).any(|c| self.fades.contains_key(&c)) {
                self.fades.insert(top, Fade { start: self.now, below: None });
            }
        }
    }

    /// Nodes that left below one that is drawn now.
    fn coarsen(&mut self, parents: &Parents, cut: &HashSet<Node>) {
        let mut left: BTreeMap<u32, Vec<Node>> = BTreeMap::new();
        for &node in self.cut.difference(cut) {
            if let Some(top) = parents.above(node).find(|&c| cut.contains(&Node::Cluster(c))) {
                left.entry(top).or_default().push(node);
            }
        }
        for (top, mut below) in left {
            below.sort_unstable();
            if let Some(fade) = self.fades.get_mut(&top) {
                if fade.below.is_none() {
                    fade.start = mirrored(fade.start, self.now, self.length);
                    fade.below = Some(below);
                }
            } else if !parents.above(Node::Cluster(top)).any(|c| self.fades.contains_key(&c)) {
                let is_below = |c: u32| parents.above(Node::Cluster(c)).any(|a| a == top);
                self.fades.retain(|&c, _| !is_below(c));
                self.fades.insert(top, Fade { start: self.now, below: Some(below) });
            }
        }
    }

    /// Which pixels show a node of the cut; `None`: all.
    pub fn coming(&self, node: Node) -> Option<Share> {
        if let Node::Cluster(cluster) = node
            && let Some(fade) = self.fades.get(&cluster)
            && fade.below.is_some()
        {
            return Some(Share::Coming(self.step_of(fade)));
        }
        let fade = self.parents.as_ref()?.above(node).find_map(|c| self.fades.get(&c))?;
        Some(Share::Coming(self.step_of(fade)))
    }

    /// What is going, by the subtrees' tops, and which pixels show it.
    pub fn going(&self) -> impl Iterator<Item = (u32, Vec<Node>, Share)> + '_ {
        self.fades.iter().map(|(&top, fade)| {
            let nodes = fade.below.clone().unwrap_or_else(|| vec![Node::Cluster(top)]);
            (top, nodes, Share::Going(self.step_of(fade)))
        })
    }

    /// Ends a fade at once.
    pub fn end(&mut self, top: u32) {
        self.fades.remove(&top);
    }

    /// Ends all.
    pub fn end_all(&mut self) {
        self.fades.clear();
    }

    fn step_of(&self, fade: &Fade) -> u32 {
        let share = (self.now - fade.start) / self.length;
        ((share * f64::from(STEPS)) as u32).min(STEPS - 1)
    }
}

/// The start of a fade that goes the other way from where this one is.
fn mirrored(start: f64, now: f64, length: f64) -> f64 {
    now - (length - (now - start)).max(0.0)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;
    use std::sync::LazyLock;
    use topout_scene::{ElementId, Progress, demo, hdlod, link};

    static TREE: LazyLock<Arc<Hdlod>> = LazyLock::new(|| {
        let settings = demo::DemoSettings::for_elements(1000);
        let (model, schedule) = demo::generate(&settings, &Progress::default()).unwrap();
        let scene = link::link(model, schedule);
        let settings = hdlod::Settings::default();
        Arc::new(hdlod::build(&scene, &settings, &Progress::default()).unwrap())
    });

    fn children(node: Node) -> Vec<Node> {
        match node {
            Node::Leaf(_) => Vec::new(),
            Node::Cluster(c) => TREE.children_of(&TREE.clusters[c as usize]).to_vec(),
        }
    }

    fn root() -> Node {
        TREE.root.unwrap()
    }

    fn index(node: Node) -> u32 {
        let Node::Cluster(cluster) = node else { panic!("{node:?} is no cluster") };
        cluster
    }

    /// Steps through cuts, a second each, with fades of four.
    fn walk(cuts: &[&[Node]]) -> Fader {
        let mut fader = Fader::default();
        for (second, cut) in cuts.iter().enumerate() {
            fader.step(&TREE, cut.iter().copied().collect(), second as f64, 4.0);
        }
        fader
    }

    fn going(fader: &Fader) -> Vec<(u32, Vec<Node>, Share)> {
        fader.going().collect()
    }

    #[test]
    fn a_cluster_gives_way_to_those_below_it_and_back() {
        let (top, parts) = (root(), children(root()));
        assert!(!walk(&[&parts]).is_active(), "a first frame fades nothing");
        let fader = walk(&[&[top], &parts]);
        assert_eq!(going(&fader), [(index(top), vec![top], Share::Going(0))]);
        assert!(parts.iter().all(|&part| fader.coming(part) == Some(Share::Coming(0))));
        let fader = walk(&[&[top], &parts, &parts, &parts]);
        assert_eq!(fader.coming(parts[0]), Some(Share::Coming(2)));
        assert!(!walk(&[&[top], &parts, &parts, &parts, &parts, &parts]).is_active());

        let fader = walk(&[&parts, &[top], &[top]]);
        assert_eq!(fader.coming(top), Some(Share::Coming(1)));
        let mut below = parts.clone();
        below.sort_unstable();
        assert_eq!(going(&fader), [(index(top), below.clone(), Share::Going(1))]);

        // Turned round after three of four seconds: three quarters of the way are left.
        let fader = walk(&[&[top], &parts, &parts, &parts, &[top]]);
        assert_eq!(fader.coming(top), Some(Share::Coming(1)));
        assert_eq!(going(&fader), [(index(top), below, Share::Going(1))]);
    }

    #[test]
    fn what_changes_within_a_subtree_that_fades_does_not_begin_anew() {
        let (top, parts) = (root(), children(root()));
        let inner = *parts.iter().find(|node| children(**node).len() > 1).unwrap();
        let finer: Vec<Node> = parts
            .iter()
            .flat_map(|&part| if part == inner { children(part) } else { vec![part] })
            .collect();
        let fader = walk(&[&[top], &parts, &finer]);
        assert_eq!(fader.count(), 1);
        assert!(finer.iter().all(|&node| fader.coming(node) == Some(Share::Coming(1))));
        // Coarser than where it began, in one step.
        let fader = walk(&[&parts, &finer, &[top]]);
        assert_eq!((fader.count(), fader.coming(top)), (1, Some(Share::Coming(0))));
        assert_eq!(going(&fader)[0].1.len(), finer.len());
    }

    #[test]
    fn what_nothing_stood_for_is_there_at_once() {
        let parts = children(root());
        assert!(!walk(&[&parts[..1], &parts, &parts[1..]]).is_active());
        let mut fader = walk(&[&[root()], &parts]);
        fader.step(&Arc::new(Hdlod::clone(&TREE)), parts.iter().copied().collect(), 2.0, 4.0);
        assert!(!fader.is_active(), "another tree");
        let mut fader = walk(&[&[root()], &parts]);
        fader.end(index(root()));
        assert!(!fader.is_active() && fader.coming(parts[0]).is_none());
    }

    /// A cut of the whole tree: descends while the numbers say so.
    fn cut(finer: &[bool]) -> HashSet<Node> {
        let (mut open, mut cut) = (vec![root()], HashSet::new());
        while let Some(node) = open.pop() {
            let place = match node {
                Node::Leaf(_) => 0,
                Node::Cluster(c) => TREE.clusters.len() - 1 - c as usize,
            };
            match node {
                Node::Cluster(_) if *finer.get(place).unwrap_or(&false) => {
                    open.extend(children(node));
                }
                _ => _ = cut.insert(node),
            }
        }
        cut
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// Whatever cuts follow each other, every element is shown once at every pixel of a square.
        #[test]
        fn every_pixel_shows_everything_once(
            cuts in prop::collection::vec(prop::collection::vec(any::<bool>(), 0..60), 2..10),
            pace in 0.3f64..3.0,
        ) {
            let parents = Parents::of(&TREE);
            let mut fader = Fader::default();
            for (frame, finer) in cuts.iter().enumerate() {
                let cut = cut(finer);
                fader.step(&TREE, cut.clone(), frame as f64 * pace, 4.0);
                let going: Vec<_> = fader.going().collect();
                for pixel in 0..STEPS {
                    let shown = |share: Option<Share>| match share {
                        None => true,
                        Some(Share::Coming(step)) => pixel < step,
                        Some(Share::Going(step)) => pixel >= step,
                    };
                    let gone = going.iter().filter(|(.., share)| shown(Some(*share)));
                    let drawn: Vec<Node> = cut
                        .iter()
                        .copied()
                        .filter(|&node| shown(fader.coming(node)))
                        .chain(gone.flat_map(|(_, nodes, _)| nodes.iter().copied()))
                        .collect();
                    let known: HashSet<Node> = drawn.iter().copied().collect();
                    prop_assert_eq!(known.len(), drawn.len());
                    for element in (0..TREE.built.len() as u32).map(ElementId) {
                        let mut above = parents.above(Node::Leaf(element)).map(Node::Cluster).peekable();
                        if above.peek().is_none() {
                            continue;
                        }
                        let times = above
                            .chain([Node::Leaf(element)])
                            .filter(|node| known.contains(node))
                            .count();
                        prop_assert_eq!(times, 1, "frame {}, pixel {}, {:?}", frame, pixel, element);
                    }
                }
            }
        }
    }
}

//! The looks of a frame: which elements are drawn in other colours than their own.

use crate::gpu::Gpu;
use crate::pool::{LOOK_BYTES, Pool, look_word};
use std::sync::Arc;
use topout_scene::hdlod::{Marks, Parents};
use topout_scene::{ElementId, Hdlod, LookId, Looks, Scene};
use topout_schedule::{Look, Time};

/// More runs of words than this are sent as one.
const MOST_WRITES: usize = 64;

/// How something of a look is drawn.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
enum Drawn {
    /// As its materials say.
    #[default]
    Own,
    /// With the glass, in front of nothing.
    Through,
    /// Not at all.
    Not,
}

impl Drawn {
    fn of(look: Look) -> Self {
        match (look.is_hidden(), look.is_see_through()) {
            (true, _) => Self::Not,
            (false, true) => Self::Through,
            (false, false) => Self::Own,
        }
    }
}

/// What shines through, and what is hidden.
#[derive(Debug, Default)]
pub(crate) struct SeeThrough {
    looks: Vec<Drawn>,
    /// By element; empty where everything is drawn as its materials say.
    elements: Vec<Drawn>,
}

impl SeeThrough {
    pub fn look(&self, look: LookId) -> bool {
        self.looks.get(look.index()) == Some(&Drawn::Through)
    }

    pub fn element(&self, id: ElementId) -> bool {
        self.elements.get(id.index()) == Some(&Drawn::Through)
    }

    pub fn hides_look(&self, look: LookId) -> bool {
        self.looks.get(look.index()) == Some(&Drawn::Not)
    }

    pub fn hides(&self, id: ElementId) -> bool {
        self.elements.get(id.index()) == Some(&Drawn::Not)
    }
}

/// The looks of the scene, at the date of the last frame.
#[derive(Debug, Default)]
pub(crate) struct FrameLooks {
    looks: Option<Arc<Looks>>,
    through: SeeThrough,
    marks: Marks,
    /// The elements that look other than they are, in order.
    now: Vec<(ElementId, LookId)>,
    /// Of each instance.
    words: Vec<u32>,
    /// For which tree and date the marks are, and the way up in that tree.
    marked: Option<(Arc<Hdlod>, Parents, Option<Time>)>,
    /// For which date the words are.
    time: Option<Time>,
}

impl FrameLooks {
    pub fn new(looks: Option<Arc<Looks>>) -> Self {
        let Some(looks) = looks else { return Self::default() };
        let through = looks.palette().iter().map(|look| Drawn::of(*look)).collect();
        let through = SeeThrough { looks: through, elements: Vec::new() };
        Self { looks: Some(looks), through, ..Self::default() }
    }

    /// Works everything out anew for the next frame: the scene has other dates.
    pub fn forget_time(&mut self) {
        self.time = None;
        if let Some((_, _, at)) = &mut self.marked {
            *at = None;
        }
    }

    /// What shines through.
    pub fn see_through(&self) -> &SeeThrough {
        &self.through
    }

    /// The elements that are drawn although they are not there at the date that was set.
    pub fn previews(&self, scene: &Scene, time: Time) -> impl Iterator<Item = ElementId> {
        let looks = self.looks.as_ref();
        let now = if looks.is_some() { &self.now[..] } else { &[] };
        now.iter()
            .filter(move |(id, look)| {
                looks.is_some_and(|looks| looks.is_preview(*look)) && !scene.behaviour(*id).at(time)
            })
            .map(|(id, _)| *id)
    }

    /// `None` where everything looks as it is.
    pub fn marks(&self) -> Option<&Marks> {
        self.looks.is_some().then_some(&self.marks)
    }

    /// Brings everything to a date; `tree`: what a cut is made of.
    pub fn set_time(
        &mut self,
        gpu: &Gpu,
        scene: &Arc<Scene>,
        tree: Option<&Arc<Hdlod>>,
        pool: &Pool,
        time: Time,
    ) {
        let Some(looks) = &self.looks else { return };
        if self.time != Some(time) {
            self.time = Some(time);
            let before = std::mem::take(&mut self.now);
            looks.at(time, |element, look| self.now.push((element, look)));
            self.now.sort_unstable();
            self.now.dedup_by_key(|(element, _)| *element);
            if self.now != before {
                self.send(gpu, scene, pool, &before);
            }
        }
        let Some(tree) = tree else { return };
        if !self.marked.as_ref().is_some_and(|(known, ..)| Arc::ptr_eq(known, tree)) {
            self.marked = Some((Arc::clone(tree), Parents::of(tree), None));
            self.marks = Marks::default();
        }
        if let Some((tree, parents, at)) = &mut self.marked
            && *at != Some(time)
        {
            *at = Some(time);
            self.marks.set(scene, tree, parents, &self.now, time);
        }
    }

    /// Sends the words that changed.
    fn send(&mut self, gpu: &Gpu, scene: &Scene, pool: &Pool, before: &[(ElementId, LookId)]) {
        let Some(looks) = &self.looks else { return };
        let model = &scene.model;
        self.words.resize(model.instances.len(), 0);
        if self.through.looks.iter().any(|look| *look != Drawn::Own) {
            self.through.elements.resize(model.elements.len(), Drawn::Own);
        }
        let mut dirty = Vec::new();
        let own = before.iter().map(|&(element, _)| (element, LookId::OWN));
        for (element, look) in own.chain(self.now.iter().copied()) {
            let word = looks.palette().get(look.index()).map_or(0, look_word);
            let instances = model.elements[element.index()].instances.clone();
            let words = instances.start as usize..instances.end as usize;
            self.words[words.clone()].fill(word);
            dirty.push(words);
            if let Some(drawn) = self.through.elements.get_mut(element.index()) {
                *drawn = self.through.looks.get(look.index()).copied().unwrap_or_default();
            }
        }
        dirty.sort_unstable_by_key(|range| range.start);
        dirty.dedup_by(|next, last| {
            let joined = next.start <= last.end;
            if joined {
                last.end = last.end.max(next.end);
            }
            joined
        });
        if dirty.len() > MOST_WRITES
            && let (Some(first), Some(last)) = (dirty.first(), dirty.last())
        {
            let all = first.start..last.end;
            dirty.clear();
            dirty.push(all);
        }
        for range in dirty.into_iter().filter(|range| !range.is_empty()) {
            let offset = range.start as u64 * LOOK_BYTES;
            let words = bytemuck::cast_slice(&self.words[range]);
            gpu.queue.write_buffer(&pool.looks, offset, words);
        }
    }
}

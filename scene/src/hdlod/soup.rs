//! Triangles that carry the behaviour of what they stand for, and the geometry of one cluster.

use super::presence::{Hull, PresenceTable};
use crate::{BehaviourId, Instance, Layer, Mesh, Vertex, decode_normal, encode_normal};
use glam::{Mat3, Vec3};
use std::collections::HashMap;
use std::ops::Range;
use topout_schedule::{Behaviour, Time};

/// One triangle of a soup (H1) in local space, with the behaviour of the leaves it stands for.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Triangle {
    pub corners: [Vec3; 3],
    pub normals: [[i8; 2]; 3],
    pub material: u16,
    pub layer: Layer,
    pub behaviour: BehaviourId,
}

impl Triangle {
    /// Twice the area times the unit normal.
    pub fn cross(&self) -> Vec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a)
    }

    pub fn area(&self) -> f32 {
        self.cross().length() * 0.5
    }

    /// Distance of the longest edge from the corner opposite; 0 for a point or a line.
    pub fn height(&self) -> f32 {
        let longest = self.diameter();
        if longest > 0.0 { self.cross().length() / longest } else { 0.0 }
    }

    /// Length of the longest edge.
    pub fn diameter(&self) -> f32 {
        let [a, b, c] = self.corners;
        a.distance(b).max(b.distance(c)).max(c.distance(a))
    }
}

/// Appends the triangles of a placed mesh.
pub(crate) fn append_instance(
    instance: &Instance,
    mesh: &Mesh,
    behaviour: BehaviourId,
    out: &mut Vec<Triangle>,
) {
    let transform = &instance.world_from_mesh;
    let linear = Mat3::from(transform.matrix3);
    // Cofactors: the inverse transpose up to scale, also where the transform flattens.
    let (x, y, z) = (linear.x_axis, linear.y_axis, linear.z_axis);
    let normal_from_mesh = Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    for (i, corners) in mesh.triangles().enumerate() {
        let vertices = corners.map(|index| mesh.vertices[index as usize]);
        out.push(Triangle {
            corners: vertices.map(|v| transform.transform_point3(Vec3::from(v.position))),
            normals: vertices.map(|v| encode_normal(normal_from_mesh * decode_normal(v.normal))),
            material: vertices[0].material,
            layer: if i * 3 < mesh.opaque as usize { Layer::Opaque } else { Layer::Transparent },
            behaviour,
        });
    }
}

/// Triangles of one behaviour in a cluster's index table, `end` being one past the last.
#[derive(Clone, Copy, PartialEq, Eq, Debug, serde::Serialize, serde::Deserialize)]
pub struct Run {
    /// When these triangles are drawn: exactly while this behaviour is present (R11).
    pub behaviour: BehaviourId,
    /// What it was when the tree was built.
    pub built: BehaviourId,
    /// First instant of presence.
    pub on: Time,
    /// First instant after the last presence.
    pub off: Time,
    /// One past the run's last index, relative to the cluster's first.
    pub end: u32,
}

/// Runs of one layer, sorted so that the usual behaviours need no look at each run.
///
/// Rule: runs `[..installed]` stay to the end once they came and are sorted by `on` rising, so
/// those present at t are a prefix; runs `[installed..removed]` were there from the beginning
/// and are sorted by `off` falling, again a prefix; the rest is sorted by `on` and asked one by
/// one, up to the first that is still to come.
#[derive(Clone, PartialEq, Eq, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct LayerRuns {
    pub runs: Vec<Run>,
    pub installed: usize,
    pub removed: usize,
    /// First index of the layer, relative to the cluster's first.
    pub start: u32,
}

impl LayerRuns {
    /// Whether the rule above holds and the runs follow each other from `first` on in whole
    /// triangles. Returns one past the last index.
    pub fn check(&self, first: u32, behaviours: usize) -> Option<u32> {
        let ordered = self.installed <= self.removed && self.removed <= self.runs.len();
        let mut end = first;
        let known = self.runs.iter().all(|run| {
            let follows = end <= run.end && (run.end - end).is_multiple_of(3);
            end = run.end;
            follows && run.behaviour.index() < behaviours && run.built == run.behaviour
        });
        let sorted = ordered
            && self.runs[..self.installed].is_sorted_by_key(|r| r.on)
            && self.runs[self.installed..self.removed].is_sorted_by(|a, b| a.off >= b.off)
            && self.runs[self.removed..].is_sorted_by_key(|r| r.on);
        (self.start == first && known && sorted).then_some(end)
    }

    fn start_of(&self, run: usize) -> u32 {
        if run == 0 { self.start } else { self.runs[run - 1].end }
    }

    /// One past the layer's last index.
    pub fn end(&self) -> u32 {
        self.start_of(self.runs.len())
    }

    /// Gives every run the behaviour that its built one has become, and brings the runs into the
    /// order of the rule above, with them their part of `indices`, which starts at the cluster's
    /// first. Returns the range in which indices moved.
    pub fn restate<T: Copy>(
        &mut self,
        indices: &mut [T],
        behaviours: &[Behaviour],
        now: impl Fn(BehaviourId) -> BehaviourId,
    ) -> Option<Range<u32>> {
        if self.runs.iter().all(|run| now(run.built) == run.behaviour) {
            return None;
        }
        let runs = (0..self.runs.len()).map(|i| {
            let (start, old) = (self.start_of(i), self.runs[i]);
            let behaviour = now(old.built);
            let hull = Hull::of(&behaviours[behaviour.index()]);
            (hull.order(), start, Run { behaviour, on: hull.on, off: hull.off, ..old })
        });
        let mut runs: Vec<_> = runs.collect();
        runs.sort_by_key(|(order, _, run)| (*order, run.behaviour, run.built));

        let before = indices[self.start as usize..self.end() as usize].to_vec();
        let mut moved: Option<Range<u32>> = None;
        let mut end = self.start;
        self.installed = 0;
        self.removed = 0;
        for (slot, ((class, _), start, mut run)) in runs.into_iter().enumerate() {
            let from = (start - self.start) as usize..(run.end - self.start) as usize;
            let to = end..end + from.len() as u32;
            if to.start != start {
                indices[to.start as usize..to.end as usize].copy_from_slice(&before[from]);
                moved = Some(moved.map_or(to.start, |m| m.start)..to.end);
            }
            end = to.end;
            run.end = end;
            self.installed += usize::from(class == 0);
            self.removed += usize::from(class <= 1);
            self.runs[slot] = run;
        }
        moved
    }

    /// Calls `emit(start, end)` for the index ranges present at `time`, neighbours joined.
    pub fn present(&self, behaviours: &[Behaviour], time: Time, mut emit: impl FnMut(u32, u32)) {
        let came = self.runs[..self.installed].partition_point(|r| r.on <= time);
        let mut pending = (self.start, self.start_of(came));
        let mut add = |from: u32, to: u32| {
            if from == pending.1 {
                pending.1 = to;
            } else {
                if pending.0 < pending.1 {
                    emit(pending.0, pending.1);
                }
                pending = (from, to);
            }
        };
        let stay = self.installed
            + self.runs[self.installed..self.removed].partition_point(|r| r.off > time);
        if stay > self.installed {
            add(self.start_of(self.installed), self.start_of(stay));
        }
        for (i, run) in (self.removed..).zip(&self.runs[self.removed..]) {
            if run.on > time {
                break;
            }
            if time < run.off && behaviours[run.behaviour.index()].at(time) {
                add(self.start_of(i), run.end);
            }
        }
        add(u32::MAX, u32::MAX);
    }
}

/// What a cluster draws, ready for the tables of [`super::Hdlod`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Geometry {
    pub vertices: Vec<Vertex>,
    pub indices: Vec<u32>,
    pub layers: [LayerRuns; 2],
}

impl Geometry {
    /// Sorts triangles into runs and shares equal vertices.
    pub fn new(mut triangles: Vec<Triangle>, presence: &PresenceTable) -> Self {
        // (layer, class, time, behaviour): the order that `LayerRuns` promises.
        let key = |t: &Triangle| {
            let (class, order) = presence.hull(t.behaviour).order();
            (t.layer, class, order, t.behaviour, t.material)
        };
        triangles.sort_by_cached_key(key);
        let mut result =
            Self { indices: Vec::with_capacity(triangles.len() * 3), ..Self::default() };
        let mut known: HashMap<([u32; 3], [i8; 2], u16), u32> = HashMap::new();
        let mut next = 0;
        for (slot, layer) in [Layer::Opaque, Layer::Transparent].into_iter().enumerate() {
            let mut runs = LayerRuns { start: result.indices.len() as u32, ..LayerRuns::default() };
            while let Some(first) = triangles.get(next).filter(|t| t.layer == layer) {
                let behaviour = first.behaviour;
                while let Some(t) =
                    triangles.get(next).filter(|t| t.layer == layer && t.behaviour == behaviour)
                {
                    for k in 0..3 {
                        let position = t.corners[k].to_array();
                        let id = (position.map(f32::to_bits), t.normals[k], t.material);
                        let index = *known.entry(id).or_insert_with(|| {
                            result.vertices.push(Vertex {
                                position,
                                normal: t.normals[k],
                                material: t.material,
                            });
                            result.vertices.len() as u32 - 1
                        });
                        result.indices.push(index);
                    }
                    next += 1;
                }
                let hull = presence.hull(behaviour);
                let class = key(first).1;
                runs.runs.push(Run {
                    behaviour,
                    built: behaviour,
                    on: hull.on,
                    off: hull.off,
                    end: result.indices.len() as u32,
                });
                runs.installed += usize::from(class == 0);
                runs.removed += usize::from(class <= 1);
            }
            result.layers[slot] = runs;
        }
        result
    }

    /// Appends the triangles again, as they were given.
    pub fn append_triangles(&self, out: &mut Vec<Triangle>) {
        let triangles =
            |range: Range<usize>| self.indices[range].chunks_exact(3).map(|t| [t[0], t[1], t[2]]);
        append_runs(&self.layers, &self.vertices, triangles, out);
    }
}

/// Appends the triangles of runs; `triangles` tells those of a range of the cluster's indices.
pub(crate) fn append_runs<T: Iterator<Item = [u32; 3]>>(
    layers: &[LayerRuns; 2],
    vertices: &[Vertex],
    triangles: impl Fn(Range<usize>) -> T,
    out: &mut Vec<Triangle>,
) {
    for (slot, layer) in [Layer::Opaque, Layer::Transparent].into_iter().enumerate() {
        let mut start = layers[slot].start;
        for run in &layers[slot].runs {
            for corners in triangles(start as usize..run.end as usize) {
                let v = corners.map(|index| vertices[index as usize]);
                out.push(Triangle {
                    corners: v.map(|v| Vec3::from(v.position)),
                    normals: v.map(|v| v.normal),
                    material: v[0].material,
                    layer,
                    behaviour: run.behaviour,
                });
            }
            start = run.end;
        }
    }
}

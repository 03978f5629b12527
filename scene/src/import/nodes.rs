//! The node hierarchy: where meshes stand, what is an element and what is a group.

use super::accessor::{Attribute, Kind};
use super::document::{Document, Node, NodeMore};
use super::extras::Extras;
use super::fault::Fault;
use super::source::Source;
use crate::properties::{self, Properties};
use crate::{Element, Group, GroupId};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use rayon::prelude::*;
use topout_schedule::{Diagnostics, Severity};

/// Instances that one file may place; far above any building, far below what memory holds.
const MOST_PLACEMENTS: usize = 1 << 26;

/// A mesh of the file at a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    /// Index into [`Hierarchy::elements`].
    pub element: usize,
    /// Index of the mesh in the file.
    pub mesh: usize,
    /// Index of the node in the file.
    pub node: usize,
    /// Mesh space to the file's world.
    pub world_from_mesh: DAffine3,
}

/// Nodes brought into elements and groups; elements have no instances yet.
#[derive(Debug, Default)]
pub(super) struct Hierarchy {
    pub elements: Vec<Element>,
    pub groups: Vec<Group>,
    /// In the order of the hierarchy.
    pub placements: Vec<Placement>,
    /// What the extras of elements and groups say.
    pub properties: Properties,
}

/// One node on the way down, parents before children.
struct Visit {
    node: usize,
    parent: Option<usize>,
    /// Nearest visit above that has a name or guid.
    anchor: Option<usize>,
}

/// What a visit hands down.
#[derive(Clone, Copy)]
struct Inherited {
    world: DAffine3,
    group: Option<GroupId>,
    element: Option<usize>,
    storey: Option<usize>,
}

/// How a node is called in messages.
pub(super) fn node_name(document: &Document, index: usize) -> String {
    match own_name(&document.nodes[index]) {
        Some(name) => name.to_owned(),
        None => format!("nodes[{index}]"),
    }
}

fn own_name(node: &Node) -> Option<&str> {
    node.name.as_deref().filter(|n| !n.trim().is_empty())
}

/// Reads the hierarchy of the default scene (of all root nodes where there is no scene).
pub(super) fn read(
    source: &Source<'_>,
    file: &str,
    diagnostics: &mut Diagnostics,
) -> Result<Hierarchy, Fault> {
    let document = source.document;
    let roots = roots(document)?;
    let extras: Vec<Extras> =
        document.more.par_iter().map(|n| Extras::read(n.extras.as_ref())).collect();
    let (visits, owners) = walk(document, &extras, &roots)?;
    let mut hierarchy = Hierarchy::default();
    let mut storeys: Vec<String> = Vec::new();
    // The nodes that became elements and those that became groups.
    let mut nodes: [Vec<usize>; 2] = Default::default();
    let mut handed: Vec<Inherited> = Vec::with_capacity(visits.len());
    let adopts = adopting(&visits, &owners);
    for (v, visit) in visits.iter().enumerate() {
        let node = &document.nodes[visit.node];
        let mut state = visit.parent.map_or(
            Inherited { world: DAffine3::IDENTITY, group: None, element: None, storey: None },
            |p| handed[p],
        );
        state.world *= local(&document.more[visit.node], visit.node, file, diagnostics)?;
        state.element = None;
        let said = &extras[visit.node];
        let identified = own_name(node).is_some() || said.guid.is_some();
        if said.is_storey() {
            let own = [said.label.as_str(), node.name.as_deref().unwrap_or("")];
            let name = own.into_iter().find(|n| !n.is_empty()).unwrap_or(&said.storey);
            storeys.push(name.to_owned());
            state.storey = Some(storeys.len() - 1);
        } else if !said.storey.is_empty() {
            storeys.push(said.storey.clone());
            state.storey = Some(storeys.len() - 1);
        }
        let owner = owners[v];
        if owner == Some(v) || adopts[v] {
            state.element = Some(hierarchy.elements.len());
            nodes[0].push(visit.node);
            hierarchy.elements.push(Element {
                name: node.name.clone().unwrap_or_default(),
                label: said.label.clone(),
                guid: said.guid.clone(),
                kind: said.kind.clone(),
                storey: state.storey.map(|s| storeys[s].clone()).unwrap_or_default(),
                group: state.group,
                ..Element::default()
            });
        } else if identified && node.mesh.is_none() {
            let id = GroupId(hierarchy.groups.len() as u32);
            nodes[1].push(visit.node);
            hierarchy.groups.push(Group {
                name: node.name.clone().unwrap_or_default(),
                label: said.label.clone(),
                kind: said.kind.clone(),
                guid: said.guid.clone(),
                parent: state.group,
            });
            state.group = Some(id);
        }
        handed.push(state);
        if let (Some(mesh), Some(owner)) = (node.mesh, owner) {
            let element = handed[owner].element.expect("owners are elements, and come first");
            let at = Placement {
                element,
                mesh: mesh.value(),
                node: visit.node,
                world_from_mesh: state.world,
            };
            place(source, at, &mut hierarchy.placements)?;
        }
    }
    hierarchy.properties = read_properties(document, &nodes, file, diagnostics);
    Ok(hierarchy)
}

/// What the extras of the nodes say that became elements and groups.
fn read_properties(
    document: &Document,
    [elements, groups]: &[Vec<usize>; 2],
    file: &str,
    diagnostics: &mut Diagnostics,
) -> Properties {
    let mut builder = properties::Builder::default();
    for node in elements {
        if let Some(extras) = &document.more[*node].extras {
            properties::flatten(extras, &mut |key, value| builder.say(key, value));
        }
        builder.end_element();
    }
    builder.end_elements();
    for node in groups {
        if let Some(extras) = &document.more[*node].extras {
            properties::flatten(extras, &mut |key, value| builder.say(key, value));
        }
        builder.end_group();
    }
    let (table, full) = builder.finish();
    if full.is_some() {
        properties::note_full(file, diagnostics);
    }
    table
}

/// Checks that nodes form a forest and finds where to start.
fn roots(document: &Document) -> Result<Vec<usize>, Fault> {
    let count = document.nodes.len();
    let mut parents: Vec<Option<usize>> = vec![None; count];
    for (i, node) in document.nodes.iter().enumerate() {
        for child in node.children.iter().flatten().map(|c| c.value()) {
            Fault::entry(&document.nodes, "nodes", child, format!("nodes[{i}].children"))?;
            if let Some(other) = parents[child].replace(i) {
                return Err(Fault::new(
                    format!("nodes[{child}] {:?}", node_name(document, child)),
                    format!("has two parents, nodes[{other}] and nodes[{i}]"),
                ));
            }
        }
        if let Some(mesh) = node.mesh {
            Fault::entry(&document.meshes, "meshes", mesh.value(), format!("nodes[{i}]"))?;
        }
    }
    // With one parent each, whatever no root reaches is a cycle.
    let mut reached = vec![false; count];
    let mut stack: Vec<usize> = (0..count).filter(|&i| parents[i].is_none()).collect();
    while let Some(i) = stack.pop() {
        reached[i] = true;
        stack.extend(document.nodes[i].children.iter().flatten().map(|c| c.value()));
    }
    if let Some(i) = reached.iter().position(|r| !r) {
        return Err(Fault::new(
            format!("nodes[{i}] {:?}", node_name(document, i)),
            "is its own ancestor (cyclic nodes)",
        ));
    }
    let scene = match document.scene {
        Some(scene) => {
            let scene = scene.value();
            Some((scene, Fault::entry(&document.scenes, "scenes", scene, "scene")?))
        }
        None => document.scenes.first().map(|s| (0, s)),
    };
    let Some((s, scene)) = scene else {
        return Ok((0..count).filter(|&i| parents[i].is_none()).collect());
    };
    let mut listed = vec![false; count];
    for node in scene.nodes.iter().map(|n| n.value()) {
        let place = format!("scenes[{s}]");
        Fault::entry(&document.nodes, "nodes", node, &place)?;
        if let Some(parent) = parents[node] {
            return Err(Fault::new(
                place,
                format!("lists nodes[{node}], which is a child of nodes[{parent}]"),
            ));
        }
        if std::mem::replace(&mut listed[node], true) {
            return Err(Fault::new(place, format!("lists nodes[{node}] twice")));
        }
    }
    Ok(scene.nodes.iter().map(|n| n.value()).collect())
}

/// All nodes below the roots, parents first, in the file's order; and for each node with a mesh
/// the visit that is its element.
fn walk(
    document: &Document,
    extras: &[Extras],
    roots: &[usize],
) -> Result<(Vec<Visit>, Vec<Option<usize>>), Fault> {
    let mut visits: Vec<Visit> = Vec::with_capacity(document.nodes.len());
    let mut owners: Vec<Option<usize>> = Vec::with_capacity(document.nodes.len());
    let mut stack: Vec<(usize, Option<usize>)> = roots.iter().rev().map(|&r| (r, None)).collect();
    while let Some((index, parent)) = stack.pop() {
        let node = &document.nodes[index];
        let above = parent.and_then(|p: usize| {
            let up = &visits[p];
            let named =
                own_name(&document.nodes[up.node]).is_some() || extras[up.node].guid.is_some();
            if named { Some(p) } else { up.anchor }
        });
        let me = visits.len();
        visits.push(Visit { node: index, parent, anchor: above });
        let owner: Option<usize> = node.mesh.map(|_| {
            let part = above.is_some_and(|a| {
                let a = visits[a].node;
                is_part(node, &extras[index], &document.nodes[a], &extras[a])
            });
            let anonymous = own_name(node).is_none() && extras[index].guid.is_none();
            // The node above may itself be a part of something.
            let owner: Option<usize> = above.map(|a| owners.get(a).copied().flatten().unwrap_or(a));
            if anonymous || part { owner.unwrap_or(me) } else { me }
        });
        owners.push(owner);
        stack.extend(node.children.iter().flatten().rev().map(|c| (c.value(), Some(me))));
    }
    Ok((visits, owners))
}

/// Whether a mesh node's name is no name of its own: converters call the meshes of an element
/// with a guid `<its name>.part`, `<its name>.geom`.
fn is_part(node: &Node, said: &Extras, above: &Node, above_said: &Extras) -> bool {
    let (Some(name), Some(owner)) = (own_name(node), own_name(above)) else {
        return false;
    };
    let suffix = name.strip_prefix(owner).and_then(|rest| rest.strip_prefix('.'));
    said.guid.is_none() && above_said.guid.is_some() && suffix.is_some_and(|s| !s.is_empty())
}

/// Visits without a mesh of their own that become elements because of meshes below.
fn adopting(visits: &[Visit], owners: &[Option<usize>]) -> Vec<bool> {
    let mut adopts = vec![false; visits.len()];
    for owner in owners.iter().flatten() {
        adopts[*owner] = true;
    }
    adopts
}

/// Mesh space of a node to the space of its parent.
fn local(
    node: &NodeMore,
    index: usize,
    file: &str,
    diagnostics: &mut Diagnostics,
) -> Result<DAffine3, Fault> {
    if let Some(m) = &node.matrix {
        let Ok(m) = <[f64; 16]>::try_from(m.as_slice()) else {
            return Err(Fault::new(
                format!("nodes[{index}].matrix"),
                format!("has {} numbers instead of 16", m.len()),
            ));
        };
        if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
            let place = format!("nodes[{index}]");
            diagnostics.add(Severity::Warning, "projective-matrix", place.clone(), || {
                format!(
                    "{file}: {place}: the matrix's last row is {:?}; only its affine part is used",
                    [m[3], m[7], m[11], m[15]]
                )
            });
        }
        let axis = |i: usize| DVec3::new(m[i], m[i + 1], m[i + 2]);
        return Ok(DAffine3 {
            matrix3: DMat3::from_cols(axis(0), axis(4), axis(8)),
            translation: axis(12),
        });
    }
    let rotation = rotation(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
    let scale = node.scale.map_or(DVec3::ONE, DVec3::from);
    let translation = node.translation.map_or(DVec3::ZERO, DVec3::from);
    Ok(DAffine3::from_scale_rotation_translation(scale, rotation, translation))
}

/// A quaternion made unit; one without direction turns nothing.
fn rotation(q: [f64; 4]) -> DQuat {
    let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    if length.is_finite() && length > 0.0 {
        DQuat::from_array(q.map(|c| c / length))
    } else {
        DQuat::IDENTITY
    }
}

/// Adds a node's mesh once, or once for each of its instances (EXT_mesh_gpu_instancing).
fn place(source: &Source<'_>, at: Placement, placements: &mut Vec<Placement>) -> Result<(), Fault> {
    let Some(instancing) = &source.document.more[at.node].instancing else {
        placements.push(at);
        return Ok(());
    };
    let name = format!("nodes[{}].extensions.EXT_mesh_gpu_instancing", at.node);
    let open = |index: Option<usize>, kind| {
        index.map(|i| Attribute::open(source, i, kind, &name)).transpose()
    };
    let translation = open(instancing.attributes.translation, Kind::Vec3)?;
    let rotations = open(instancing.attributes.rotation, Kind::Vec4)?;
    let scale = open(instancing.attributes.scale, Kind::Vec3)?;
    let mut counts = [&translation, &rotations, &scale].into_iter().flatten().map(|a| a.count);
    let Some(count) = counts.next() else {
        placements.push(at);
        return Ok(());
    };
    if let Some(other) = counts.find(|&c| c != count) {
        return Err(Fault::new(name, format!("has attributes of {count} and {other} instances")));
    }
    if count > MOST_PLACEMENTS.saturating_sub(placements.len()) {
        return Err(Fault::new(name, format!("{count} instances are too many")));
    }
    let vector = |a: &Option<Attribute<'_>>, i: usize, none: DVec3| {
        a.as_ref().map_or(none, |a| DVec3::from(a.floats::<3>(i).map(f64::from)))
    };
    for i in 0..count {
        let turn = rotations
            .as_ref()
            .map_or(DQuat::IDENTITY, |a| rotation(a.floats::<4>(i).map(f64::from)));
        let node_from_mesh = DAffine3::from_scale_rotation_translation(
            vector(&scale, i, DVec3::ONE),
            turn,
            vector(&translation, i, DVec3::ZERO),
        );
        placements.push(Placement { world_from_mesh: at.world_from_mesh * node_from_mesh, ..at });
    }
    Ok(())
}

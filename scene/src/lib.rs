//! Objects, their geometry and behaviour, and the structures that make them cheap to draw.
//!
//! Data flow: files -> [`Model`] -> [`Scene`] (linked to a schedule) -> [`Hdlod`] -> [`Selection`].
//! Nothing here touches wgpu or egui.

mod ahead_looks;
pub mod cache;
mod category_looks;
pub mod check;
mod clip;
pub mod demo;
mod edit;
mod explode;
pub mod export;
mod geometry;
pub mod hdlod;
pub mod import;
pub mod link;
mod looks;
mod optimizer;
mod outliers;
pub mod paths;
pub mod pick;
mod progress;
pub mod properties;
#[allow(clippy::module_inception)]
mod scene;
mod slip_looks;
mod solid;
mod storeys;
mod view;

pub use ahead_looks::MOST_WEEKS;
pub use category_looks::{Category, LegendRow};
pub use clip::Clip;
pub use edit::{EditError, Edited, Renumbering};
pub use geometry::{Aabb, Layer, Mesh, Vertex, decode_normal, encode_normal};
pub use hdlod::{Hdlod, Selection};
pub use looks::{LookId, Looks};
pub use outliers::{Outlier, outliers};
pub use progress::{Cancelled, Progress};
pub use properties::Properties;
pub use scene::{
    BehaviourId, Element, ElementId, Group, GroupId, Instance, Material, MeshId, Model, Scene,
};
pub use slip_looks::slip_color;
pub use solid::{Solidity, Solids};
pub use storeys::{Storey, storeys};
pub use view::{Containment, Frustum, Lens, NamedView, Projection, View};

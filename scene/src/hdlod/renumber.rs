//! Other ids for the behaviours that a tree names.

use super::{Hdlod, OtherScene};
use crate::Renumbering;

impl Hdlod {
    /// The tree for a scene that differs in the ids of its behaviours alone
    /// ([`crate::Scene::renumbered`]). For trees whose certificates are those of the dates now: as they
    /// were built, or after [`Hdlod::repair`].
    ///
    /// # Errors
    /// When it names a behaviour that no element has now.
    pub fn renumbered(mut self, ids: &Renumbering) -> Result<Hdlod, OtherScene> {
        let now = |id| ids.now(id).ok_or(OtherScene);
        for id in &mut self.built {
            *id = now(*id)?;
        }
        for cluster in &mut self.clusters {
            for run in cluster.layers.iter_mut().flat_map(|layer| &mut layer.runs) {
                (run.behaviour, run.built) = (now(run.behaviour)?, now(run.built)?);
            }
            for pair in &mut cluster.pairs {
                *pair = (now(pair.0)?, now(pair.1)?);
            }
            cluster.pairs.sort_unstable();
        }
        Ok(self)
    }
}

//! A whole run as bytes, with what it is made of.

use super::{EpisodeLog, LoadError, Trainer};
use crate::checkpoint::{Checkpoint, CheckpointError, EpisodeProgress, Persist, RunIdentity};
use crate::learners::Learner;
use crate::random::Rng;
use crate::tasks::Task;

/// The first bytes of a saved run.
const MAGIC: [u8; 8] = *b"qtab run";
/// The number of the format that this version writes, and the last one that it reads.
const FORMAT: u32 = 1;

impl<T: Task, L: Learner<T::Active>, R: Rng + Clone + Persist> Trainer<T, L, R> {
    /// Adds a part to what the run is made of, such as a parameter of the environment:
    /// [`load`](Self::load) refuses the checkpoint of a run in which it differs.
    ///
    /// The types of the task and of the learner, the shape of the tables, the seeds and the settings of a
    /// [builder](crate::TrainerBuilder) are known without it.
    pub fn identify(&mut self, name: &str, value: impl std::fmt::Display) {
        self.identity.add(name, value);
    }

    /// The whole run as bytes: the tables, the finished episodes, and everything else that [`load`](Self::load) needs to
    /// continue it as if it had never stopped. The run does not change; it is mutable because one description of the
    /// data both saves and restores it.
    ///
    /// # Errors
    /// `OutOfMemory`.
    pub fn save(&mut self) -> Result<Vec<u8>, CheckpointError> {
        let mut bytes = Vec::new();
        let mut checkpoint = Checkpoint::save(&mut bytes);
        let (mut magic, mut format) = (MAGIC, FORMAT);
        let mut version = env!("CARGO_PKG_VERSION").as_bytes().to_vec();
        (&mut magic, &mut format).persist(&mut checkpoint)?;
        checkpoint.values(&mut version)?;
        self.full_identity().persist(&mut checkpoint)?;
        let mut episodes = std::mem::take(&mut self.episodes);
        let saved = persist_results(&mut episodes, &mut checkpoint);
        self.episodes = episodes;
        saved?;
        let mut tables: Vec<Vec<f64>> = self.learner.tables().into_iter().map(<[f64]>::to_vec).collect();
        tables.iter_mut().try_for_each(|table| checkpoint.values(table))?;
        self.persist(&mut checkpoint)?;
        let mut hash = fnv_1a(&bytes);
        hash.persist(&mut Checkpoint::save(&mut bytes))?;
        Ok(bytes)
    }

    /// Continues the run that [`save`](Self::save) saved. This must be a new run of the same task, learner and seed. An
    /// episode that the task cannot resume in the middle is [abandoned](EpisodeProgress::Abandoned).
    ///
    /// # Errors
    /// `OtherRun` names the first part in which the runs differ. After any error but `Damaged` this run is unchanged.
    pub fn load(&mut self, bytes: &[u8]) -> Result<EpisodeProgress, LoadError> {
        if !self.episodes.is_empty() || self.episode.is_some() {
            return Err(LoadError::AlreadyStarted);
        }
        let mut checkpoint = Checkpoint::restore(bytes);
        let (mut magic, mut format) = (MAGIC, FORMAT);
        let read = (&mut magic, &mut format).persist(&mut checkpoint);
        if read.is_err() || magic != MAGIC {
            return Err(LoadError::NotACheckpoint);
        }
        let mut version = Vec::new();
        checkpoint.values(&mut version)?;
        if format > FORMAT {
            return Err(LoadError::LaterVersion { version: String::from_utf8_lossy(&version).into_owned() });
        }
        let Some((content, hash)) = bytes.split_last_chunk() else { return Err(LoadError::NotACheckpoint) };
        if fnv_1a(content) != u64::from_le_bytes(*hash) {
            return Err(CheckpointError::Invalid("checksum").into());
        }
        let mut identity = RunIdentity::default();
        identity.persist(&mut checkpoint)?;
        if let Some((part, saved, expected)) = identity.difference(&self.full_identity()) {
            return Err(LoadError::OtherRun { part, saved, expected });
        }
        let mut episodes = EpisodeLog::default();
        persist_results(&mut episodes, &mut checkpoint)?;
        let mut tables = vec![Vec::new(); self.learner.tables().len()];
        tables.iter_mut().try_for_each(|table| checkpoint.values(table))?;
        let tables: Vec<&[f64]> = tables.iter().map(Vec::as_slice).collect();
        self.restore(episodes, &tables)?;
        let progress = self.persist(&mut checkpoint)?;
        let mut hash = [0_u8; 8];
        hash.persist(&mut checkpoint)?;
        checkpoint.finish()?;
        Ok(progress)
    }

    /// Everything that distinguishes this run from others.
    fn full_identity(&self) -> RunIdentity {
        let mut identity = self.identity.clone();
        let (rows, actions) = self.learner.shape();
        self.learner.identify(&mut identity);
        identity.add("number of rows", rows);
        identity.add("number of actions", actions);
        identity.add("number of tables", self.learner.tables().len());
        self.task.identify(&mut identity);
        if let Some(fingerprint) = self.rng.seed_fingerprint() {
            identity.add("seed of the agent's generator, as a fingerprint", format_args!("{fingerprint:016x}"));
        }
        identity
    }
}

fn persist_results(episodes: &mut EpisodeLog, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
    checkpoint.values(&mut episodes.returns)?;
    checkpoint.values(&mut episodes.lengths)?;
    checkpoint.values(&mut episodes.terminated)?;
    let count = episodes.returns.len();
    checkpoint.check(episodes.lengths.len() == count && episodes.terminated.len() == count, "number of episodes")
}

/// The 64-bit FNV-1a hash (G. Fowler, L. C. Noll and K.-P. Vo, 1991).
fn fnv_1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_that_of_its_authors() {
        assert_eq!(fnv_1a(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv_1a(b"foobar"), 0x8594_4171_f739_67e8);
    }
}

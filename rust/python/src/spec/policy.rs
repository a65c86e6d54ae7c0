//! How actions are chosen.

use pyo3::prelude::*;
use qtab_core::policies::TieBreaking;

use super::ScheduleSpec;
use super::fields::Fields;

#[derive(Clone, Copy, Debug)]
pub(crate) enum PolicySpec {
    EpsilonGreedy { epsilon: ScheduleSpec, ties: TieBreaking },
    Softmax { temperature: f64 },
}

type Parser = fn(&Fields<'_>, u64) -> PyResult<PolicySpec>;

impl PolicySpec {
    pub(crate) fn parse(fields: &Fields<'_>, episodes: u64) -> PyResult<Self> {
        let parsers: [(&str, Parser); 2] = [("epsilon_greedy", Self::epsilon_greedy), ("softmax", Self::softmax)];
        fields.word("type", &parsers)?(fields, episodes)
    }

    fn epsilon_greedy(fields: &Fields<'_>, episodes: u64) -> PyResult<Self> {
        let epsilon = ScheduleSpec::parse(&fields.nested("epsilon")?, episodes)?;
        let ties = fields.word("ties", &[("first", TieBreaking::First), ("random", TieBreaking::Random)])?;
        Ok(Self::EpsilonGreedy { epsilon, ties })
    }

    fn softmax(fields: &Fields<'_>, _episodes: u64) -> PyResult<Self> {
        Ok(Self::Softmax { temperature: fields.get("temperature")? })
    }
}

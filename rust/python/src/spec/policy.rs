//! How actions are chosen.

use pyo3::prelude::*;
use qtab_core::policies::TieBreaking;

use super::ScheduleSpec;
use super::fields::Fields;

#[derive(Clone, Copy, Debug)]
pub(crate) enum PolicySpec {
    EpsilonGreedy { epsilon: ScheduleSpec, ties: TieBreaking },
    Softmax { temperature: f64 },
    Ucb { confidence: f64, ties: TieBreaking },
}

type Parser = fn(&Fields<'_>, u64) -> PyResult<PolicySpec>;

impl PolicySpec {
    pub(crate) fn parse(fields: &Fields<'_>, episodes: u64) -> PyResult<Self> {
        let parsers: [(&str, Parser); 3] =
            [("epsilon_greedy", Self::epsilon_greedy), ("softmax", Self::softmax), ("ucb", Self::ucb)];
        fields.word("type", &parsers)?(fields, episodes)
    }

    fn epsilon_greedy(fields: &Fields<'_>, episodes: u64) -> PyResult<Self> {
        let epsilon = ScheduleSpec::parse(&fields.nested("epsilon")?, episodes)?;
        Ok(Self::EpsilonGreedy { epsilon, ties: Self::ties(fields)? })
    }

    fn softmax(fields: &Fields<'_>, _episodes: u64) -> PyResult<Self> {
        Ok(Self::Softmax { temperature: fields.get("temperature")? })
    }

    fn ucb(fields: &Fields<'_>, _episodes: u64) -> PyResult<Self> {
        Ok(Self::Ucb { confidence: fields.get("confidence")?, ties: Self::ties(fields)? })
    }

    fn ties(fields: &Fields<'_>) -> PyResult<TieBreaking> {
        fields.word("ties", &[("first", TieBreaking::First), ("random", TieBreaking::Random)])
    }
}

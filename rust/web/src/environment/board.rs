//! Which states a map of numbered states shows, and where.

/// The cells of a map, counted row by row, with the states that they show.
#[derive(Clone, Debug)]
pub(crate) struct Board {
    pub(crate) columns: usize,
    /// The state of each cell; `None` where there is none, such as a wall.
    pub(crate) states: Vec<Option<u32>>,
    /// The cell of each state. Those that the map does not show have the cell of a similar one.
    pub(crate) cells: Vec<usize>,
}

impl Board {
    /// A map with these states in its cells. States that are not shown have the first cell.
    pub(crate) fn new(columns: usize, states: Vec<Option<u32>>, num_states: usize) -> Self {
        let mut cells = vec![0; num_states];
        for (cell, state) in states.iter().enumerate() {
            if let Some(place) = state.and_then(|state| cells.get_mut(state as usize)) {
                *place = cell;
            }
        }
        Self { columns, states, cells }
    }

    /// A map whose cells are the states in order, except for walls.
    pub(crate) fn of_states(columns: usize, walls: &[bool]) -> Self {
        let states = (0..).zip(walls).map(|(state, &wall)| (!wall).then_some(state)).collect();
        Self { columns, states, cells: (0..walls.len()).collect() }
    }
}

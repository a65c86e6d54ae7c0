//! The macros that make a type part of a checkpoint.

/// Implements [`Persist`](crate::checkpoint::Persist) for a struct. All of its fields must be named; those of a tuple
/// struct by any names.
///
/// ```
/// #[derive(Clone, Copy, Debug, PartialEq)]
/// struct State {
///     position: f64,
///     steps: i32,
/// }
/// qtab_core::persist_struct!(State { position, steps });
///
/// #[derive(Clone, Copy)]
/// struct Cell(usize, usize);
/// qtab_core::persist_struct!(Cell(row, column));
/// ```
#[macro_export]
macro_rules! persist_struct {
    (@body $checkpoint:ident, $pattern:pat, $this:ident, $($field:ident),*) => {{
        let $pattern = $this;
        $($crate::checkpoint::Persist::persist($field, $checkpoint)?;)*
        Ok(())
    }};
    ($name:ident { $($field:ident),* $(,)? }) => {
        impl $crate::checkpoint::Persist for $name {
            fn persist(
                &mut self,
                checkpoint: &mut $crate::checkpoint::Checkpoint<'_>,
            ) -> ::core::result::Result<(), $crate::checkpoint::CheckpointError> {
                $crate::persist_struct!(@body checkpoint, Self { $($field),* }, self, $($field),*)
            }
        }
    };
    ($name:ident ( $($field:ident),* $(,)? )) => {
        impl $crate::checkpoint::Persist for $name {
            fn persist(
                &mut self,
                checkpoint: &mut $crate::checkpoint::Checkpoint<'_>,
            ) -> ::core::result::Result<(), $crate::checkpoint::CheckpointError> {
                $crate::persist_struct!(@body checkpoint, Self($($field),*), self, $($field),*)
            }
        }
    };
}

/// Implements [`Persist`](crate::checkpoint::Persist) for an enum without fields, whose variants must all be named. Their
/// order decides the bytes.
///
/// ```
/// #[derive(Clone, Copy)]
/// enum Light {
///     Red,
///     Green,
/// }
/// qtab_core::persist_enum!(Light { Red, Green });
/// ```
#[macro_export]
macro_rules! persist_enum {
    ($name:ident { $($variant:ident),+ $(,)? }) => {
        impl $crate::checkpoint::Persist for $name {
            fn persist(
                &mut self,
                checkpoint: &mut $crate::checkpoint::Checkpoint<'_>,
            ) -> ::core::result::Result<(), $crate::checkpoint::CheckpointError> {
                // The compiler checks that no variant is missing.
                match self {
                    $(Self::$variant => {})+
                }
                let variants = [$(Self::$variant),+];
                let is_current = |variant: &Self| {
                    ::core::mem::discriminant(variant) == ::core::mem::discriminant(&*self)
                };
                let mut index = variants.iter().position(is_current).unwrap_or(0);
                let count = variants.len();
                checkpoint.index(&mut index, count, "variant of an enum")?;
                if let Some(variant) = variants.into_iter().nth(index) {
                    *self = variant;
                }
                Ok(())
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use crate::checkpoint::{Checkpoint, CheckpointError, Persist};

    #[derive(Clone, Copy, Debug, PartialEq)]
    enum Light {
        Red,
        Green,
    }
    persist_enum!(Light { Red, Green });

    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Cell(usize, isize);
    persist_struct!(Cell(row, column));

    #[derive(Clone, Copy, Debug, PartialEq)]
    struct State {
        cell: Cell,
        light: Light,
        levels: [i8; 3],
    }
    persist_struct!(State { cell, light, levels });

    fn bytes(mut state: State) -> Vec<u8> {
        let mut bytes = Vec::new();
        state.persist(&mut Checkpoint::save(&mut bytes)).expect("memory suffices");
        bytes
    }

    #[test]
    fn a_state_is_restored_from_its_bytes() {
        let state = State { cell: Cell(7, -3), light: Light::Green, levels: [1, -1, 0] };
        let mut restored = State { cell: Cell(0, 0), light: Light::Red, levels: [0; 3] };
        let saved = bytes(state);
        let mut checkpoint = Checkpoint::restore(&saved);
        restored.persist(&mut checkpoint).expect("the bytes are complete");
        assert_eq!((restored, checkpoint.finish()), (state, Ok(())));
    }

    #[test]
    fn a_variant_that_does_not_exist_is_refused() {
        let mut bytes = Vec::new();
        2_u64.persist(&mut Checkpoint::save(&mut bytes)).expect("memory suffices");
        let refused = Light::Red.persist(&mut Checkpoint::restore(&bytes));
        assert_eq!(refused, Err(CheckpointError::Invalid("variant of an enum")));
    }
}

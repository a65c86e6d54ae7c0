//! A macro for the methods of [`Simd`](super::Simd), one per line.

/// Defines operations in `K` lanes: `name(operand: Type, …) -> Type = value;`, where `Type` is a type of
/// [`Simd`](super::Simd). With `$each |index|`, `value` is for one register or lane, and the macro `$each` computes all
/// of them.
macro_rules! operations {
    ($self:ident, $each:ident |$index:ident|;
     $($(#[$doc:meta])* $name:ident($($operand:ident: $type:ident),+) -> $result:ident = $value:expr;)+) => {
        operations! {
            $self;
            $($(#[$doc])* $name($($operand: $type),+) -> $result = $each!(K, |$index| $value);)+
        }
    };
    ($self:ident;
     $($(#[$doc:meta])* $name:ident($($operand:ident: $type:ident),+) -> $result:ident = $value:expr;)+) => {
        $(
            $(#[$doc])*
            #[inline(always)]
            fn $name<const K: usize>($self, $($operand: Self::$type<K>),+) -> Self::$result<K> {
                $value
            }
        )+
    };
}

pub(super) use operations;

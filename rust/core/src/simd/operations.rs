//! The methods of [`Simd`](super::Simd), one a line.

/// Defines operations in `K` lanes: `name(operand: Type, …) -> Type = value;`, where `Type` is one of [`Simd`](super::Simd)'s.
/// With `$each |index|`, `value` is that of one register or lane, of which the macro `$each` makes all.
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

//! Macros for the methods of [`Simd`](super::Simd), one per line.

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

/// Defines conversions and shifts in the same way, with the types of a function: `name(operand: type) -> type = value;`.
/// The number of bits of a shift is a parameter of the function.
macro_rules! conversions {
    ($self:ident; $($name:ident $(<$bits:ident>)? ($operand:ident: $type:ty) -> $result:ty = $value:expr;)+) => {
        $(
            #[inline(always)]
            fn $name<$(const $bits: i32,)? const K: usize>($self, $operand: $type) -> $result {
                $value
            }
        )+
    };
}

pub(super) use {conversions, operations};

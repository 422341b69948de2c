//! Tables whose parameters are looked up by name, and the blocks that override them for single agents.

use super::value::Value;

/// A table whose parameters are looked up by name.
pub(in crate::campaign) trait Parameters {
    /// All parameters that the table can hold.
    const NAMES: &'static [&'static str];
    /// The value of a parameter, if the table gives one.
    fn parameter(&self, name: &str) -> Option<&Value>;
}

/// A table and its block of one agent: what each has of its own, and the parameters, which both have.
macro_rules! table_and_block {
    (
        $(#[$table_doc:meta])*
        $table:ident { $($(#[$field_doc:meta])* $field:ident: $type:ty,)* }
        $(#[$block_doc:meta])*
        $block:ident { $($(#[$block_field_doc:meta])* $block_field:ident: $block_type:ty,)* }
        parameters { $($(#[$doc:meta])* $name:ident,)* }
    ) => {
        $(#[$table_doc])*
        #[derive(Debug, Clone, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $table {
            $($(#[$field_doc])* pub $field: $type,)*
            $($(#[$doc])* pub $name: Option<Value>,)*
            /// Blocks that override the keys above, one per agent.
            #[serde(default, deserialize_with = "some_tables")]
            pub agents: Option<Vec<$block>>,
        }

        $(#[$block_doc])*
        #[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $block {
            $($(#[$block_field_doc])* pub $block_field: $block_type,)*
            $($(#[$doc])* pub $name: Option<Value>,)*
        }

        table_and_block!(@looked_up $table: $($name),*);
        table_and_block!(@looked_up $block: $($name),*);
    };
    (@looked_up $table:ty: $($name:ident),*) => {
        impl Parameters for $table {
            const NAMES: &'static [&'static str] = &[$(stringify!($name)),*];
            fn parameter(&self, name: &str) -> Option<&Value> {
                match name {
                    $(stringify!($name) => self.$name.as_ref(),)*
                    _ => None,
                }
            }
        }
    };
}
pub(super) use table_and_block;

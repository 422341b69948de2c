//! Small helpers without knowledge of the domain: a list of fixed length, spelling suggestions, number formats.

pub mod fixed_list;
pub mod format;
pub(crate) mod suggest;
pub(crate) mod text_file;

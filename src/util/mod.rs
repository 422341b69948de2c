//! Small helpers without knowledge of the domain: a list of fixed length, spelling suggestions, number formats, hidden
//! characters.

pub mod fixed_list;
pub mod format;
pub mod hidden;
pub(crate) mod suggest;
pub(crate) mod text_file;

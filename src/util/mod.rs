//! Small helpers without knowledge of the domain: a list of fixed length, spelling suggestions, number formats, hidden
//! characters, words of a shell, JSON for people, the size of memory.

pub mod fixed_list;
pub mod format;
pub mod hidden;
pub mod json;
pub mod memory;
pub mod shell;
pub(crate) mod suggest;
pub(crate) mod text_file;

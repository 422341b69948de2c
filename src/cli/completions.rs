//! Scripts that complete the command line.

use super::arguments::Arguments;
use clap::CommandFactory;
use clap_complete::Shell;

/// The name of the program, as it is typed.
const NAME: &str = "urts-mc";

/// The script for a shell.
pub(super) fn completions(shell: Shell) -> String {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), NAME, &mut script);
    let script = String::from_utf8_lossy(&script);
    match shell {
        // In a name with a hyphen clap_complete takes what follows for a subcommand, but only in the labels of the
        // branches (clap issues 6421 and 6529): the script sets cmd="urts__mc__subcmd__run" and looks for
        // urts__subcmd__mc__subcmd__run, so nothing is completed after a subcommand. This may go when the labels are
        // right without it, which leaves nothing to replace.
        Shell::Bash => script.replace("urts__subcmd__mc", "urts__mc"),
        _ => script.into_owned(),
    }
}

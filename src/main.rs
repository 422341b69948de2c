//! The `urts-mc` program: a thin shell around the library.

mod cli;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    keep_mesa_quiet();
    let arguments = cli::Arguments::parse();
    match cli::execute(arguments) {
        Ok(code) => code.into(),
        Err(failure) => {
            cli::print_error(&failure);
            failure.code.into()
        }
    }
}

/// Mesa's device selection looks for a display, which no command needs, and complains on standard error if there is
/// none.
#[expect(
    unsafe_code,
    reason = "no other thread can read the environment: the program has just begun"
)]
fn keep_mesa_quiet() {
    const VARIABLE: &str = "NODEVICE_SELECT";
    if std::env::var_os(VARIABLE).is_none() {
        unsafe { std::env::set_var(VARIABLE, "1") };
    }
}

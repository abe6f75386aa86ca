//! Running other programs: quietly for an answer, or with their output streaming through.

use std::io::{BufRead, BufReader, Read};
use std::process::{Command, ExitStatus, Stdio};

/// Runs `command`, passing its standard output on line by line and handing each line to `see`; its errors go straight through.
pub fn stream(command: &mut Command, see: impl FnMut(&str)) -> Result<ExitStatus, String> {
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| unstartable(command, &error))?;
    let stdout = child.stdout.take().expect("stdout is piped");
    pass_on(stdout, see)?;
    child.wait().map_err(|error| error.to_string())
}

/// As [`stream`], with the lines of its standard error too.
pub fn stream_all(command: &mut Command, see: impl FnMut(&str)) -> Result<ExitStatus, String> {
    let pipe = std::io::pipe().and_then(|(reader, writer)| {
        command
            .stdin(Stdio::null())
            .stdout(writer.try_clone()?)
            .stderr(writer);
        Ok(reader)
    });
    let reader = pipe.map_err(|error| error.to_string())?;
    let child = command.spawn();
    // The command holds the pipe's other end; while it does, the pipe does not end.
    command.stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = child.map_err(|error| unstartable(command, &error))?;
    pass_on(reader, see)?;
    child.wait().map_err(|error| error.to_string())
}

/// Prints every line of `output` and hands it to `see`.
fn pass_on(output: impl Read, mut see: impl FnMut(&str)) -> Result<(), String> {
    let mut reader = BufReader::new(output);
    let mut bytes = Vec::new();
    loop {
        let read = reader.read_until(b'\n', &mut bytes);
        if read.map_err(|error| error.to_string())? == 0 {
            return Ok(());
        }
        let line = String::from_utf8_lossy(&bytes);
        let line = line.trim_end_matches(['\n', '\r']);
        println!("{line}");
        see(line);
        bytes.clear();
    }
}

/// Runs `command` with its output streaming through; whether it succeeded.
pub fn succeeds(command: &mut Command) -> Result<bool, String> {
    Ok(stream(command, |_| ())?.success())
}

/// Whether `command` starts and succeeds; nothing is printed.
pub fn quietly(command: &mut Command) -> bool {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

/// What `command` prints.
pub fn output(command: &mut Command) -> Result<String, String> {
    let output = command
        .stdin(Stdio::null())
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| unstartable(command, &error))?;
    if !output.status.success() {
        return Err(format!("{} failed: {}", shown(command), output.status));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The command as a person would type it.
pub fn shown(command: &Command) -> String {
    let program = std::path::Path::new(command.get_program());
    let name = program.file_stem().unwrap_or(program.as_os_str());
    std::iter::once(name)
        .chain(command.get_args())
        .map(|word| word.to_string_lossy())
        .collect::<Vec<_>>()
        .join(" ")
}

fn unstartable(command: &Command, error: &std::io::Error) -> String {
    format!("{:?} does not start: {error}", command.get_program())
}

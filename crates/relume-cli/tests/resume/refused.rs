//! What cannot be resumed, and bakes from which something is taken away.

use std::fs;

use super::bench::Bench;
use super::disturb::{Random, copy, counted, killed, partial, recorded, there};
#[cfg(unix)]
use super::disturb::{caught, ended, signal};
use super::{LINE, finish, undisturbed};

/// What is changed in [`LINE`] with `--resume`, to what, and what is said of it.
const CHANGES: [(&str, &str, &str); 8] = [
    (
        "--samples 128",
        "--samples 129",
        "--samples was 128, is 129",
    ),
    ("--bounces 2", "--bounces 3", "--bounces was 2, is 3"),
    ("--resume", "--resume --order 4", "--order was 5, is 4"),
    ("--resume", "--resume --seed 1", "--seed was 0, is 1"),
    (
        "--resume",
        "--resume --precision f16",
        "--precision was not given, is f16",
    ),
    ("--resume", "--resume --error 0.1", "--error was 0, is 0.1"),
    ("--resume", "--resume --albedo 1,1,1", "--albedo was none"),
    (
        "--max-edge 0.08",
        "--max-edge 0.09",
        "the scene has changed",
    ),
];

#[test]
fn what_has_changed_is_named_and_the_checkpoint_stays() {
    let bench = Bench::new();
    let (expected, tiles) = undisturbed(&bench);
    assert!(killed(&bench, LINE, || recorded(&bench, "direct") > 2));
    let resume = format!("{LINE} --resume");
    let refused = |line: &str, part: &str| {
        let output = bench.run(line);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "relume {line}\n{said}");
        let errors: Vec<&str> = said
            .lines()
            .filter(|line| !line.starts_with("warning: ") && !line.starts_with("edges split"))
            .collect();
        assert_eq!(errors.len(), 1, "relume {line}\n{said}");
        assert!(
            errors[0].starts_with("error: ") && errors[0].contains(part),
            "{said}"
        );
        assert!(
            errors[0].contains("without --resume to start afresh"),
            "{said}"
        );
    };
    for (old, new, part) in CHANGES {
        refused(&resume.replace(old, new), part);
    }
    let scene = fs::read_to_string(bench.path("scene.obj")).unwrap();
    fs::write(
        bench.path("scene.obj"),
        scene.replace("-0.5 1.2 -0.5", "-0.5 1.3 -0.5"),
    )
    .unwrap();
    refused(&resume, "source was ");
    fs::write(bench.path("scene.obj"), scene).unwrap();
    let header = partial(&bench).join("relume-checkpoint.json");
    let good = fs::read_to_string(&header).unwrap();
    let version = concat!("\"relume\": \"", env!("CARGO_PKG_VERSION"), "\"");
    assert!(good.contains(version));
    fs::write(&header, good.replace(version, "\"relume\": \"0.0.1\"")).unwrap();
    refused(&resume, "version 0.0.1 of relume wrote it");
    fs::write(&header, &good[..good.len() / 2]).unwrap();
    refused(&resume, "the checkpoint is damaged");
    // After all that, everything is still there.
    fs::write(&header, good).unwrap();
    assert!(there(&bench) > 2);
    finish(&bench, "", &expected, tiles);
}

#[cfg(unix)]
#[test]
fn a_second_bake_is_refused_and_ctrl_c_says_how_to_go_on() {
    let bench = Bench::new();
    let (expected, tiles) = undisturbed(&bench);
    let first = caught(&bench, LINE, || recorded(&bench, "direct") > 1).unwrap();
    signal(&first, "-STOP");
    for line in [LINE, &format!("{LINE} --resume")] {
        let output = bench.run(line);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{said}");
        let last = said.lines().next_back().unwrap();
        assert!(
            last.starts_with("error: ") && last.contains("another bake is at work on this output"),
            "{said}"
        );
        assert_eq!(
            said.lines()
                .filter(|line| line.starts_with("error: "))
                .count(),
            1
        );
    }
    signal(&first, "-CONT");
    signal(&first, "-INT");
    let (status, said) = ended(first);
    assert_eq!(status.code(), Some(130), "{said}");
    assert!(
        said.ends_with("interrupted: go on with the same command and --resume\n"),
        "{said}"
    );
    assert_eq!(bench.names(), ["out.glb.partial", "scene.mtl", "scene.obj"]);
    assert!(finish(&bench, "", &expected, tiles) > 1);
}

#[cfg(unix)]
#[test]
fn a_checkpoint_that_goes_away_during_the_bake_is_noticed() {
    let bench = Bench::new();
    let child = caught(&bench, LINE, || recorded(&bench, "direct") > 1).unwrap();
    signal(&child, "-STOP");
    fs::rename(partial(&bench), bench.path("elsewhere")).unwrap();
    signal(&child, "-CONT");
    let (status, said) = ended(child);
    assert_eq!(status.code(), Some(1), "{said}");
    let last = said.lines().next_back().unwrap();
    assert!(
        last.starts_with("error: ")
            && last.contains("was moved or removed while the bake was at work"),
        "{said}"
    );
    assert_eq!(bench.names(), ["elsewhere", "scene.mtl", "scene.obj"]);
    // Moved back, it is whole.
    fs::rename(bench.path("elsewhere"), partial(&bench)).unwrap();
    let reused = there(&bench);
    let (_, said) = bench.succeed(&format!("{LINE} --resume"));
    assert_eq!(counted(&said).unwrap().0, reused);
}

#[test]
fn streams_of_garbage_cost_work_and_nothing_else() {
    let bench = Bench::new();
    let (expected, tiles) = undisturbed(&bench);
    assert!(killed(&bench, LINE, || recorded(&bench, "bounce-1") > 2));
    let saved = bench.path("saved");
    copy(&partial(&bench), &saved);
    for (seed, end) in [".journal", ".tiles"].into_iter().enumerate() {
        let mut random = Random(seed as u64);
        for entry in fs::read_dir(partial(&bench)).unwrap() {
            let path = entry.unwrap().path();
            if path.to_string_lossy().ends_with(end) {
                let garbage: Vec<u8> = (0..5000).map(|_| random.below(256) as u8).collect();
                fs::write(path, garbage).unwrap();
            }
        }
        let (_, said) = bench.succeed(&format!("{LINE} --resume"));
        assert_eq!(counted(&said), None, "{said}");
        assert!(fs::read(bench.path("out.glb")).unwrap() == expected);
        fs::remove_file(bench.path("out.glb")).unwrap();
        copy(&saved, &partial(&bench));
    }
    fs::remove_dir_all(&saved).unwrap();
    assert!(finish(&bench, "", &expected, tiles) > tiles);
}

/// Files may have so many bytes, of which the program is told when it writes more: like a full disk, without a disk of one's own.
#[cfg(unix)]
fn limited(bench: &Bench, line: &str, bytes: u64) -> String {
    // Shells count blocks of 512 bytes, or of 1024: the larger of them decides what is asked for.
    let probe =
        "ulimit -f 1; trap '' XFSZ; head -c 1024 /dev/zero > probe; wc -c < probe; rm -f probe";
    let shell = |script: &str| {
        let mut shell = std::process::Command::new("sh");
        shell.args(["-c", script, env!("CARGO_BIN_EXE_relume")]);
        shell
            .args(line.split_whitespace())
            .current_dir(bench.folder.path());
        shell.output().unwrap()
    };
    let block: u64 = String::from_utf8(shell(probe).stdout)
        .unwrap()
        .trim()
        .parse()
        .unwrap();
    let script = format!(
        "trap '' XFSZ; ulimit -f {}; exec \"$0\" \"$@\"",
        bytes / block
    );
    let output = shell(&script);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    let last = said.lines().next_back().unwrap().to_owned();
    assert!(last.starts_with("error: "), "{said}");
    last
}

#[cfg(unix)]
#[test]
fn a_full_disk_keeps_what_is_baked_during_the_bake_and_the_final_write() {
    let bench = Bench::new();
    // One pass of one channel: no file of the checkpoint is as long as the asset, which holds the scene as well.
    let line = "bake scene.obj -o out.glb --samples 64 --max-edge 0.08";
    bench.succeed(line);
    let expected = fs::read(bench.path("out.glb")).unwrap();
    fs::remove_file(bench.path("out.glb")).unwrap();
    let transfer = 100
        * relume::asset::from_glb(&expected)
            .unwrap()
            .transfer
            .vertex_count() as u64;
    assert!((expected.len() as u64) > transfer + 4096);

    let error = limited(&bench, line, transfer / 2);
    assert!(error.contains("no room is left on the disk; what is finished stays: make room, and bake again with --resume"), "{error}");
    let first = there(&bench);
    let error = limited(&bench, &format!("{line} --resume"), transfer + 2048);
    assert!(
        error.contains("out.glb: ") && error.contains("bake again with --resume"),
        "{error}"
    );
    assert_eq!(bench.names(), ["out.glb.partial", "scene.mtl", "scene.obj"]);
    assert!(there(&bench) > first);
    let all = there(&bench);
    let (_, said) = bench.succeed(&format!("{line} --resume"));
    assert_eq!(counted(&said), Some((all, all)), "{said}");
    assert!(fs::read(bench.path("out.glb")).unwrap() == expected);
    assert_eq!(bench.names(), ["out.glb", "scene.mtl", "scene.obj"]);
}

#[cfg(unix)]
#[test]
fn a_folder_that_cannot_be_written_is_refused_before_the_bake() {
    use std::os::unix::fs::PermissionsExt;
    let bench = Bench::new();
    let closed = bench.path("closed");
    fs::create_dir(&closed).unwrap();
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o555)).unwrap();
    if fs::write(closed.join("probe"), "").is_ok() {
        println!(
            "skipped: a_folder_that_cannot_be_written_is_refused_before_the_bake: needs a user who is not root"
        );
        return;
    }
    // It would take minutes.
    let line = "bake scene.obj -o closed/out.glb --samples 100000 --max-edge 0.1";
    let output = bench.run(line);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("closed/out.glb.partial: cannot make the folder of the checkpoint"),
        "{said}"
    );
}

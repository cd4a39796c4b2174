//! Files of more triangles than the machine would bear: refused before they are read, unless the user says otherwise.

use std::fs::File;
use std::path::Path;

use crate::program::{Folder, coapt, stderr, stdout};

/// Ten million facets: half a gigabyte of which nothing but the header is there, nor read.
#[test]
fn a_file_of_ten_million_faces_is_answered_with_what_it_would_cost() {
    let folder = Folder::new("ten-million");
    let valve = folder.valve(&[]);
    let file = File::create(Path::new(&valve).join("leaflet_anterior.vtp")).unwrap();
    let mut head = vec![b' '; 80];
    head.extend(10_000_000_u32.to_le_bytes());
    std::io::Write::write_all(&mut &file, &head).unwrap();
    file.set_len(84 + 50 * 10_000_000).unwrap();
    let expected = "leaflet_anterior.vtp` of 10,000,000 triangles: closing them takes about 1.9 TB of memory and 48 hours; expected \
                    250,000 at most";
    let closure = coapt(&["closure", &valve]);
    assert_eq!(closure.status.code(), Some(2));
    assert!(stderr(&closure).contains(expected), "{}", stderr(&closure));
    let check = coapt(&["check", &valve]);
    assert_eq!(check.status.code(), Some(2));
    assert!(stdout(&check).contains(expected), "{}", stdout(&check));
}

#[test]
fn the_limit_of_faces_is_the_users() {
    let folder = Folder::new("limit-of-faces");
    let valve = folder.valve(&[]);
    let scene = Path::new(&valve).join("scene.toml");
    let text = std::fs::read_to_string(&scene).unwrap();
    assert!(text.contains("face_limit = 250000"), "{text}");
    std::fs::write(&scene, text.replace("face_limit = 250000", "face_limit = 200")).unwrap();
    for (arguments, status) in [
        (&["check", &valve][..], 2),
        (&["check", &valve, "--max-faces", "1000"], 0),
        (&["check", "healthy"], 0),
        (&["check", "healthy", "--max-faces", "600"], 2),
    ] {
        let output = coapt(arguments);
        assert_eq!(
            output.status.code(),
            Some(status),
            "{arguments:?} {}",
            stdout(&output)
        );
        assert!(
            status == 0 || stdout(&output).contains("of memory and"),
            "{}",
            stdout(&output)
        );
    }
}

#[test]
fn a_limit_of_no_faces_is_wrong_usage() {
    for arguments in [
        &["check", "healthy", "--max-faces", "0"][..],
        &["compare", "a.vtp", "b.vtp", "--max-faces", "0"],
    ] {
        let output = coapt(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let words = stderr(&output);
        assert!(
            words.contains("expected a whole number from 1 to 4294967295"),
            "{words}"
        );
    }
}

/// A negative number is a value, not an option that nobody knows; what is no such number is told with what is expected.
#[test]
fn numbers_that_cannot_be_are_told_with_what_is_expected() {
    let closure = "closure nowhere --record never.mcap";
    let study = "study nowhere --out never";
    for (command, option, [least, most]) in [
        (closure, "--threads", ["1", "1024"]),
        (closure, "--frames", ["2", "10000"]),
        (closure, "--max-faces", ["1", "4294967295"]),
        ("plan nowhere never", "--samples", ["1", "100000"]),
        ("plan nowhere never", "--seed", ["0", "18446744073709551615"]),
        (
            "plan nowhere never",
            "--max-alternatives",
            ["1", "18446744073709551615"],
        ),
        ("plan nowhere never", "--threads", ["1", "1024"]),
        ("compare nowhere never", "--max-faces", ["1", "4294967295"]),
        ("personalise nowhere never", "--threads", ["1", "1024"]),
        ("replay nowhere", "--threads", ["1", "1024"]),
        ("report nowhere", "--most", ["0", "18446744073709551615"]),
        (study, "--faces", ["100", "1000000"]),
        (study, "--reference-faces", ["100", "1000000"]),
        (study, "--repeats", ["1", "1000"]),
        (study, "--threads", ["1", "1024"]),
    ] {
        let expected = format!("expected a whole number from {least} to {most}");
        for (word, is_right) in [
            ("-3", false),
            ("3.5", false),
            ("many", false),
            ("", false),
            (least, true),
            (most, true),
        ] {
            let arguments: Vec<&str> = command.split(' ').chain([option, word]).collect();
            let output = coapt(&arguments);
            let told = stderr(&output);
            // What is right ends at the file that there is not.
            assert!(
                matches!(output.status.code(), Some(1 | 2))
                    && told.contains(&expected) != is_right
                    && !told.contains("tip:"),
                "{arguments:?} {told}"
            );
        }
    }
    for (arguments, expected) in [
        (
            &["study", "--tolerance", "-3"],
            "expected a number above 0 and below 1",
        ),
        (
            &["study", "--thickness", "-0.5"],
            "expected a number of mm above 0",
        ),
    ] {
        let told = stderr(&coapt(arguments));
        assert!(told.contains(expected) && !told.contains("tip:"), "{told}");
    }
}

#[test]
fn surfaces_to_compare_have_the_same_limit() {
    let folder = Folder::new("limit-of-compare");
    let valve = folder.valve(&[]);
    let surface = Path::new(&valve)
        .join("leaflet_anterior.vtp")
        .display()
        .to_string();
    let compare = |more: &[&str]| coapt(&[&["compare", &surface, &surface][..], more].concat());
    assert_eq!(compare(&[]).status.code(), Some(0));
    let refused = compare(&["--max-faces", "50"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        stderr(&refused).contains("triangles, expected 50 at most"),
        "{}",
        stderr(&refused)
    );
    // The header is enough where it tells: the rest is not there.
    let large = folder.path("large.stl");
    let file = File::create(&large).unwrap();
    let mut head = vec![b' '; 80];
    head.extend(10_000_000_u32.to_le_bytes());
    std::io::Write::write_all(&mut &file, &head).unwrap();
    file.set_len(84 + 50 * 10_000_000).unwrap();
    let refused = coapt(&["compare", &surface, &large]);
    assert_eq!(refused.status.code(), Some(2));
    let expected = "large.stl has 10,000,000 triangles, expected 250,000 at most";
    assert!(stderr(&refused).contains(expected), "{}", stderr(&refused));
}

/// The full size in a format that announces nothing, so that all of it is read: `cargo test -p coapt-cli --test cli -- --ignored`
#[test]
#[ignore = "writes half a gigabyte"]
fn a_file_of_ten_million_faces_without_a_header_is_read_and_refused() {
    use std::io::Write;
    let folder = Folder::new("ten-million-obj");
    let valve = folder.valve(&[]);
    let path = Path::new(&valve).join("leaflet_anterior.vtp");
    let mut file = std::io::BufWriter::new(File::create(&path).unwrap());
    let side = 2237_u32;
    for y in 0..side {
        for x in 0..side {
            writeln!(
                file,
                "v {} {} {}",
                f64::from(x) * 0.02,
                f64::from(y) * 0.02,
                (x * y) % 7
            )
            .unwrap();
        }
    }
    for y in 1..side {
        for x in 1..side {
            let corner = y * side + x;
            writeln!(file, "f {} {} {}", corner - side, corner + 1 - side, corner).unwrap();
            writeln!(file, "f {} {} {}", corner + 1 - side, corner + 1, corner).unwrap();
        }
    }
    file.flush().unwrap();
    let output = coapt(&["closure", &valve]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("of 9,999,392 triangles"),
        "{}",
        stderr(&output)
    );
}

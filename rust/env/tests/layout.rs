//! The types of this crate have the layout of those in `qtab_env.h`.

use std::mem::offset_of;
use std::path::{Path, PathBuf};
use std::process::Command;

use qtab_env::{
    ALIGNMENT, Bitgen, CONTINUES, ENV_VERSION, FAILED, FLOAT32, FLOAT64, INT64, TERMINATED, TRUNCATED, Table,
};

fn signed(size: usize) -> i64 {
    size.try_into().expect("a small size")
}

/// The names of numbers in C, with the same numbers here.
fn numbers() -> Vec<(String, i64)> {
    let mut numbers: Vec<(&str, i64)> = vec![
        ("QTAB_ENV_VERSION", ENV_VERSION.into()),
        ("QTAB_FLOAT32", FLOAT32.into()),
        ("QTAB_FLOAT64", FLOAT64.into()),
        ("QTAB_INT64", INT64.into()),
        ("QTAB_CONTINUES", CONTINUES.into()),
        ("QTAB_TERMINATED", TERMINATED.into()),
        ("QTAB_TRUNCATED", TRUNCATED.into()),
        ("QTAB_FAILED", FAILED.into()),
        ("sizeof(qtab_bitgen)", signed(size_of::<Bitgen>())),
        ("sizeof(qtab_env)", signed(size_of::<Table>())),
        ("_Alignof(qtab_env)", signed(align_of::<Table>())),
    ];
    macro_rules! offsets {
        ($name:literal, $type:ty: $($field:ident)*) => {
            $(numbers.push((
                concat!("offsetof(", $name, ", ", stringify!($field), ")"),
                signed(offset_of!($type, $field)),
            ));)*
        };
    }
    offsets!("qtab_bitgen", Bitgen: state next_uint64 next_uint32 next_double next_raw);
    offsets!(
        "qtab_env", Table: version struct_size state_size observation_type observation_size observation_low
        observation_high num_actions max_episode_steps has_action_mask reserved parameters reset step observe
    );
    numbers.into_iter().map(|(name, number)| (name.to_owned(), number)).collect()
}

/// Compiles a program in C that prints these numbers.
fn compile(names: &[String]) -> PathBuf {
    let print = |name: &String| ["    printf(\"%lld\\n\", (long long)(", name, "));\n"].concat();
    let prints: String = names.iter().map(print).collect();
    let source = format!(
        "#include <stddef.h>\n#include <stdio.h>\n#include \"qtab_env.h\"\nint main(void) {{\n{prints}    return 0;\n}}\n"
    );
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let (file, program) = (folder.join("layout.c"), folder.join("layout"));
    std::fs::write(&file, source).expect("the folder can be written");
    let include = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../python/qtab/include");
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    let status = Command::new(compiler).arg("-I").arg(include).arg(&file).arg("-o").arg(&program).status();
    assert!(status.expect("a C compiler").success(), "the header compiles");
    program
}

#[test]
#[cfg(unix)]
fn the_types_have_the_layout_of_the_header() {
    let numbers = numbers();
    let names: Vec<String> = numbers.iter().map(|(name, _)| name.clone()).collect();
    let output = Command::new(compile(&names)).output().expect("the program runs");
    let printed = String::from_utf8(output.stdout).expect("it prints numbers");
    let in_c: Vec<i64> = printed.lines().map(|line| line.parse().expect("a number")).collect();
    let here: Vec<i64> = numbers.iter().map(|&(_, number)| number).collect();
    assert_eq!(names.iter().zip(in_c).collect::<Vec<_>>(), names.iter().zip(here).collect::<Vec<_>>());
    assert_eq!(ALIGNMENT, 16, "the header promises it");
}

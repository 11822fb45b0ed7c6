//! Bytes that nobody meant as a mesh: no panic, and memory in step with the input.

#![allow(unsafe_code)] // an allocator that counts can be had in no other way

use std::{
    alloc::{GlobalAlloc, Layout, System},
    cell::Cell,
};

use eigenselect::mesh::{Format, read, survey};
use proptest::prelude::*;

use crate::{tetrahedron, write};

thread_local! {
    /// Bytes that this thread holds, and the most it held.
    static HELD: Cell<(isize, isize)> = const { Cell::new((0, 0)) };
}

/// The system's allocator, with a count for each thread.
struct Counting;

fn count(bytes: isize) {
    // A thread that ends has no count any more.
    let _ = HELD.try_with(|held| {
        let now = held.get().0 + bytes;
        held.set((now, held.get().1.max(now)));
    });
}

// SAFETY: every call goes to the system's allocator as it came.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: as the caller promised.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        // SAFETY: as the caller promised.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size as isize - layout.size() as isize);
        // SAFETY: as the caller promised.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Watches what this thread holds.
pub struct Memory(isize);

impl Memory {
    /// From now on.
    pub fn start() -> Self {
        Self(HELD.with(|held| {
            let now = held.get().0;
            held.set((now, now));
            now
        }))
    }

    /// The most bytes that were held at one time more than at the start.
    pub fn most(&self) -> usize {
        usize::try_from(HELD.with(|held| held.get().1) - self.0).unwrap_or(0)
    }
}

/// Reads bytes in a format, and does everything with the mesh that is done with meshes; fails if that takes more memory
/// than a small file may. Says whether there is a mesh.
pub fn digest(bytes: &[u8], format: Format) -> bool {
    let memory = Memory::start();
    let result = read(bytes, format);
    if let Ok(mesh) = &result {
        assert!(mesh.vertices().iter().flatten().all(|value| value.is_finite()));
        assert!(mesh.triangles().iter().flatten().all(|&vertex| (vertex as usize) < mesh.vertices().len()));
        let survey = survey(mesh);
        assert!(survey.defects.iter().all(|defect| !defect.to_string().is_empty()));
        assert_eq!(mesh.canonical().canonical(), mesh.canonical());
    } else if let Err(error) = &result {
        let message = error.to_string();
        assert!(message.len() < 400 && !message.contains(char::is_control), "{message:?}");
    }
    let (most, allowed) = (memory.most(), 100 * bytes.len() + 100_000);
    assert!(most < allowed, "{most} bytes for a file of {}: {result:?}", bytes.len());
    result.is_ok()
}

/// Files that are meshes, of all formats.
pub fn seeds() -> Vec<(Format, Vec<u8>)> {
    let mesh = tetrahedron();
    let polygons = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nv 1 3 0\nf 1 2 3 4\nf 1//1 2//1 3//2 5/7 -2\nl 1 2\n";
    let strips = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                  element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
                  0 0 0\n1 0 0\n0 1 0\n1 1 0\n6 0 1 2 3 -1 0\n";
    let colours = "STCNOFF\n4 2 0\n0 0 0 0 0 1 1 1 1 1 0 0\n1 0 0 0 0 1 1 1 1 1 0 0\n1 1 0 0 0 1 1 1 1 1 0 0\n\
                   0 1 0 0 0 1 1 1 1 1 0 0\n4 0 1 2 3 255 255 255\n5 0 1 2 3 2\n";
    vec![
        (Format::Obj, write::obj(&mesh)),
        (Format::Obj, polygons.into()),
        (Format::Off, write::off(&mesh)),
        (Format::Off, write::off_binary(&mesh)),
        (Format::Off, colours.into()),
        (Format::Ply, write::ply_ascii(&mesh)),
        (Format::Ply, write::ply_binary(&mesh, false, false)),
        (Format::Ply, write::ply_binary(&mesh, true, true)),
        (Format::Ply, strips.into()),
        (Format::Stl, write::stl_ascii(&mesh)),
        (Format::Stl, write::stl_binary(&mesh, b"solid")),
        (Format::Xyz, "3\n0 0 0 # a\n1,0,0,255\n0;1;-2e-3\n".into()),
    ]
}

/// A change of a file.
#[derive(Debug, Clone)]
pub enum Edit {
    Set(prop::sample::Index, u8),
    Insert(prop::sample::Index, Vec<u8>),
    Remove(prop::sample::Index, usize),
    Cut(prop::sample::Index),
    /// Replaces the word at a place.
    Word(prop::sample::Index, &'static str),
}

pub fn edit() -> impl Strategy<Value = Edit> {
    let place = any::<prop::sample::Index>;
    let words = vec![
        "",
        "0",
        "-1",
        "3",
        "4294967295",
        "4294967296",
        "18446744073709551615",
        "99999999999999999999",
        "1e999",
        "nan",
        "-inf",
        "1e-400",
        "#",
        "\n",
        "\r",
        "\\\n",
        "list",
        "OFF",
        "element x 4000000000\n",
        "property",
        "end_header\n",
        "facet",
        "endloop",
        "solid",
        "v",
        "f",
        "f 1 1 1 1 1 1\n",
        "4 0 0 0 0\n",
    ];
    prop_oneof![
        (place(), any::<u8>()).prop_map(|(at, byte)| Edit::Set(at, byte)),
        (place(), prop::collection::vec(any::<u8>(), 1..8)).prop_map(|(at, bytes)| Edit::Insert(at, bytes)),
        (place(), 1..40usize).prop_map(|(at, count)| Edit::Remove(at, count)),
        place().prop_map(Edit::Cut),
        (place(), prop::sample::select(words)).prop_map(|(at, word)| Edit::Word(at, word)),
    ]
}

pub fn apply(bytes: &mut Vec<u8>, edit: &Edit) {
    if bytes.is_empty() {
        return;
    }
    match edit {
        Edit::Set(at, byte) => *at.get_mut(bytes) = *byte,
        Edit::Insert(at, more) => {
            let at = at.index(bytes.len());
            bytes.splice(at..at, more.iter().copied());
        }
        Edit::Remove(at, count) => {
            let at = at.index(bytes.len());
            bytes.drain(at..(at + count).min(bytes.len()));
        }
        Edit::Cut(at) => bytes.truncate(at.index(bytes.len())),
        Edit::Word(at, word) => {
            let at = at.index(bytes.len());
            let space = |byte: &u8| byte.is_ascii_whitespace();
            let start = bytes[..at].iter().rposition(space).map_or(0, |space| space + 1);
            let end = bytes[at..].iter().position(space).map_or(bytes.len(), |space| at + space);
            bytes.splice(start..end.max(start), word.bytes());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn soup(bytes in prop::collection::vec(any::<u8>(), 0..300), start in 0..8usize) {
        let starts: [&[u8]; 8] = [
            b"", b"OFF ", b"OFF BINARY\n\0\0\0", b"solid x\n", b"v ", b"\xef\xbb\xbf",
            b"ply\nformat ascii 1.0\n",
            b"ply\nformat binary_big_endian 1.0\nelement vertex 2\nproperty float x\nproperty list uint int q\n\
              property char y\nproperty float z\nelement face 9\nproperty list char uchar vertex_indices\nend_header\n",
        ];
        let bytes = [starts[start], &bytes].concat();
        for format in Format::ALL {
            digest(&bytes, format);
        }
    }

    #[test]
    fn mutants(seed in prop::sample::select(seeds()), edits in prop::collection::vec(edit(), 1..6)) {
        let (format, mut bytes) = seed;
        for edit in &edits {
            apply(&mut bytes, edit);
        }
        digest(&bytes, format);
    }
}

#[test]
fn every_format_read_as_every_other() {
    for (_, bytes) in seeds() {
        for format in Format::ALL {
            digest(&bytes, format);
        }
    }
}

#[test]
fn counts_are_not_believed() {
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 4294967295\nproperty float x\nproperty float y\n\
                  property float z\nelement face 4294967295\nproperty list uint int vertex_indices\nend_header\n";
    let faces_first = "ply\nformat ascii 1.0\nelement face 1\nproperty list uint int vertex_indices\n\
                       element vertex 4294967295\nproperty float x\nproperty float y\nproperty float z\nend_header\n\
                       4294967295 1 2 3\n";
    let empty = "ply\nformat binary_little_endian 1.0\nelement junk 4294967295\nelement vertex 0\nproperty float x\n\
                 property float y\nproperty float z\nend_header\n";
    let mut stl = vec![b' '; 80];
    stl.extend([255; 100]);
    let mut off = b"OFF BINARY\n".to_vec();
    off.extend([0x7f, 255, 255, 255].repeat(3));
    for (format, bytes) in [
        (Format::Ply, header.as_bytes()),
        (Format::Ply, faces_first.as_bytes()),
        (Format::Ply, empty.as_bytes()),
        (Format::Stl, &stl),
        (Format::Off, &off),
        (Format::Off, b"OFF\n4294967295 4294967295 0\n0 0 0\n"),
        (Format::Off, b"OFF\n0 1 0\n4294967295 0\n"),
        (Format::Off, b"OFF\n1 1 0\n0 0 0\n4294967295 0 0 0\n"),
    ] {
        digest(bytes, format);
    }
}

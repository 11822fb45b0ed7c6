//! Entries that are not what the store wrote: always a miss, always healed by the next put.

use std::{fs, io::Write, path::Path};

use proptest::prelude::*;

use super::{Room, none, open};
use crate::store::{Key, codec, entry};

type Value = (Vec<f64>, String);

fn value() -> Value {
    (vec![0.0, 1.5, 2.25, 1e-300], "spectrum".to_owned())
}

/// Asserts a miss, then that putting the value heals it.
fn miss_then_healed(room: &Room, key: &Key, what: &str) {
    assert_eq!(room.store.get::<Value>(key), None, "{what}");
    room.store.put(key, &value());
    assert_eq!(room.store.get(key), Some(value()), "{what}");
}

#[test]
fn any_flipped_byte_is_a_miss() {
    let room = Room::new();
    let key = Key::new("spectrum").number(1);
    room.store.put(&key, &value());
    let path = room.path(&key);
    let good = fs::read(&path).unwrap();
    assert!(good.len() > 150);
    for at in 0..good.len() {
        for mask in (0..8).map(|bit| 1 << bit).chain([0xff]) {
            let mut bytes = good.clone();
            bytes[at] ^= mask;
            fs::write(&path, &bytes).unwrap();
            assert_eq!(room.store.get::<Value>(&key), None, "byte {at} ^ {mask:02x}");
        }
        miss_then_healed(&room, &key, "flipped");
        assert_eq!(fs::read(&path).unwrap(), good);
    }
    // However many entries were damaged, it is said once.
    let warnings = room.store.warnings();
    assert!(matches!(&warnings[..], [one] if one.contains("damaged")), "{warnings:?}");
}

#[test]
fn any_other_length_is_a_miss() {
    let room = Room::new();
    let key = Key::new("spectrum").number(1);
    room.store.put(&key, &value());
    let path = room.path(&key);
    let good = fs::read(&path).unwrap();
    for length in 0..good.len() {
        fs::write(&path, &good[..length]).unwrap();
        miss_then_healed(&room, &key, &format!("cut at {length}"));
    }
    for tail in [&[0_u8][..], &[0; 32], b"\n", &good] {
        fs::write(&path, [&good, tail].concat()).unwrap();
        miss_then_healed(&room, &key, &format!("followed by {} bytes", tail.len()));
    }
    for start in 1..good.len() {
        fs::write(&path, &good[start..]).unwrap();
        assert_eq!(room.store.get::<Value>(&key), None, "beginning at {start}");
    }
}

#[test]
fn a_foreign_file_is_a_miss() {
    let room = Room::new();
    let key = Key::new("spectrum").number(1);
    let path = room.path(&key);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    for foreign in [&b"PK\x03\x04"[..], b"hello\n", &[0; 4096], b""] {
        fs::write(&path, foreign).unwrap();
        miss_then_healed(&room, &key, &format!("{foreign:?}"));
    }
    // A file of a terabyte (of holes) is not read into memory.
    fs::File::create(&path).unwrap().set_len(1 << 40).unwrap();
    miss_then_healed(&room, &key, "huge");
}

#[cfg(unix)]
#[test]
fn a_pipe_is_not_waited_for() {
    let room = Room::new();
    let key = Key::new("spectrum").number(1);
    let path = room.path(&key);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    let made = std::process::Command::new("mkfifo").arg(&path).status();
    if !made.is_ok_and(|status| status.success()) {
        println!("skipped: no mkfifo here");
        return;
    }
    let (done, waits) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        miss_then_healed(&room, &key, "pipe");
        let _ = done.send(());
    });
    waits.recv_timeout(std::time::Duration::from_secs(20)).expect("the store waits for the pipe's writer");
}

#[test]
fn a_folder_in_place_of_an_entry_is_a_miss_and_left_alone() {
    let room = Room::new();
    let key = Key::new("spectrum").number(1);
    let inside = room.path(&key).join("inside");
    fs::create_dir_all(&inside).unwrap();
    assert_eq!(room.store.get::<Value>(&key), None);
    room.store.put(&key, &value());
    assert_eq!(room.store.get::<Value>(&key), None);
    assert!(inside.is_dir());
    assert_eq!(room.temporaries(), 0);
    assert_eq!(room.store.warnings().len(), 2, "{:?}", room.store.warnings());
}

#[test]
fn another_keys_entry_is_a_miss() {
    let room = Room::new();
    let (key, other) = (Key::new("spectrum").number(1), Key::new("spectrum").number(2));
    room.store.put(&key, &value());
    room.store.put(&other, &(vec![9.0_f64], "another".to_owned()));
    fs::copy(room.path(&other), room.path(&key)).unwrap();
    miss_then_healed(&room, &key, "copied over");
    // The same hash under another kind, all else right.
    let mut bytes = fs::read(room.path(&key)).unwrap();
    bytes[12..16].copy_from_slice(b"mesh");
    reseal(&mut bytes);
    fs::write(room.path(&key), bytes).unwrap();
    miss_then_healed(&room, &key, "another kind");
}

#[test]
fn another_format_version_is_a_silent_miss() {
    let mut room = Room::new();
    let key = Key::new("spectrum").number(1);
    room.store.put(&key, &value());
    let mut bytes = fs::read(room.path(&key)).unwrap();
    for version in [0_u32, 2, u32::MAX] {
        bytes[8..12].copy_from_slice(&version.to_le_bytes());
        reseal(&mut bytes);
        fs::write(room.path(&key), &bytes).unwrap();
        room.reopen();
        miss_then_healed(&room, &key, "version");
        assert_eq!(room.store.warnings(), none());
    }
}

#[test]
fn a_payload_of_another_type_is_a_miss() {
    let room = Room::new();
    let key = Key::new("spectrum").number(1);
    // Sealed as the store seals it: only the payload's own form can tell.
    let write = |payload: &[u8]| {
        let path = room.path(&key);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, entry::wrap(&key, payload)).unwrap();
    };
    let good = codec::encode(&value()).unwrap();
    write(&good);
    assert_eq!(room.store.get(&key), Some(value()));
    write(&[&good[..], &[0]].concat());
    miss_then_healed(&room, &key, "trailing byte");
    write(&good[..good.len() - 1]);
    miss_then_healed(&room, &key, "one byte short");
    // A list of 2⁶⁴ − 1 numbers.
    write(&[0xff; 64]);
    miss_then_healed(&room, &key, "endless list");
    // Text that is no UTF-8.
    let mut bad = good;
    *bad.last_mut().unwrap() = 0xff;
    write(&bad);
    miss_then_healed(&room, &key, "no text");
}

#[test]
fn a_header_that_claims_any_length_is_a_miss() {
    let room = Room::new();
    let key = Key::new("spectrum").number(1);
    for length in [0, 1, u64::MAX, u64::MAX - entry::FRAME, u64::MAX - entry::FRAME + 1, 1 << 62] {
        room.store.put(&key, &value());
        let mut bytes = fs::read(room.path(&key)).unwrap();
        bytes[entry::HEADER - 8..entry::HEADER].copy_from_slice(&length.to_le_bytes());
        reseal(&mut bytes);
        fs::write(room.path(&key), bytes).unwrap();
        miss_then_healed(&room, &key, &format!("length {length}"));
    }
}

fn reseal(bytes: &mut [u8]) {
    let body = bytes.len() - 32;
    let checksum = blake3::hash(&bytes[..body]);
    bytes[body..].copy_from_slice(checksum.as_bytes());
}

/// How a disk or a careless copy changes a file.
#[derive(Debug, Clone)]
enum Harm {
    Overwrite(usize, Vec<u8>),
    Insert(usize, Vec<u8>),
    Remove(usize, usize),
    Zero(usize, usize),
}

fn harm() -> impl Strategy<Value = Harm> {
    let bytes = || proptest::collection::vec(any::<u8>(), 1..40);
    prop_oneof![
        (any::<usize>(), bytes()).prop_map(|(at, bytes)| Harm::Overwrite(at, bytes)),
        (any::<usize>(), bytes()).prop_map(|(at, bytes)| Harm::Insert(at, bytes)),
        (any::<usize>(), 1..99_usize).prop_map(|(at, count)| Harm::Remove(at, count)),
        (any::<usize>(), 1..5000_usize).prop_map(|(at, count)| Harm::Zero(at, count)),
    ]
}

fn inflict(path: &Path, harm: &Harm) {
    let mut bytes = fs::read(path).unwrap();
    let length = bytes.len();
    match harm {
        Harm::Overwrite(at, new) => {
            for (i, byte) in new.iter().enumerate() {
                bytes[(at % length + i) % length] = *byte;
            }
        }
        Harm::Insert(at, new) => {
            let at = at % (length + 1);
            bytes.splice(at..at, new.iter().copied());
        }
        Harm::Remove(at, count) => {
            let at = at % length;
            bytes.drain(at..(at + count).min(length));
        }
        Harm::Zero(at, count) => {
            let at = at % length;
            let end = (at + count).min(length);
            bytes[at..end].fill(0);
        }
    }
    fs::File::create(path).unwrap().write_all(&bytes).unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_harm_is_a_miss_or_no_harm(
        numbers in proptest::collection::vec(any::<u64>(), 0..600),
        harms in proptest::collection::vec(harm(), 1..4),
    ) {
        let mut room = Room::new();
        let key = Key::new("harmed");
        room.store.put(&key, &numbers);
        let good = fs::read(room.path(&key)).unwrap();
        for harm in &harms {
            if fs::metadata(room.path(&key)).unwrap().len() > 0 {
                inflict(&room.path(&key), harm);
            }
        }
        let unchanged = fs::read(room.path(&key)).unwrap() == good;
        room.reopen();
        prop_assert_eq!(room.store.get::<Vec<u64>>(&key), unchanged.then(|| numbers.clone()));
        room.store.put(&key, &numbers);
        prop_assert_eq!(room.store.get::<Vec<u64>>(&key), Some(numbers));
    }

    /// Bytes that pass the checksum and are no value: an answer or an error, no panic and no flood of memory.
    #[test]
    fn any_payload_decodes_or_not(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = codec::decode::<super::Odd>(&bytes);
        let _ = codec::decode::<Vec<Vec<String>>>(&bytes);
        let _ = codec::decode::<Option<std::collections::BTreeMap<u8, Vec<u128>>>>(&bytes);
    }

    #[test]
    fn any_bytes_are_an_entry_or_a_flaw(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(entry::check(&bytes).is_err());
        let _ = entry::header(&bytes);
    }
}

#[test]
fn two_stores_heal_each_others_entries() {
    let room = Room::new();
    let other = open(room.dir.path(), &room.disk);
    let key = Key::new("spectrum");
    room.store.put(&key, &value());
    fs::write(room.path(&key), b"garbage").unwrap();
    assert_eq!(room.store.get::<Value>(&key), None);
    other.put(&key, &value());
    assert_eq!(room.store.get(&key), Some(value()));
}

use super::{Key, Options, Store};

#[test]
fn what_was_put_is_got() {
    let room = tempfile::tempdir().unwrap();
    let store = Store::open(room.path(), Options::default());
    let key = Key::new("test").number(1);
    let value = vec![0.0_f64, -0.0, f64::MIN_POSITIVE, f64::INFINITY];
    assert_eq!(store.get::<Vec<f64>>(&key), None);
    store.put(&key, &value);
    let bits = |v: &[f64]| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(store.get::<Vec<f64>>(&key).map(|v| bits(&v)), Some(bits(&value)));
    assert_eq!(store.warnings(), Vec::<String>::new());
}

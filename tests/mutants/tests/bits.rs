//! The stored bits.

#[path = "../../bits/src/battery.rs"]
mod battery;

#[test]
fn the_bits_are_the_stored_ones() {
    let mut hashes = String::new();
    battery::write(&mut hashes, false).unwrap();
    assert_eq!(hashes, include_str!("../../bits/hashes.txt"));
}

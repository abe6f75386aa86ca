//! Assets whose surfaces are covered with a tile.

use serde_json::{Value, json};

use super::measured::{covered, headers, shaded};
use super::{glb, join, parts};
use crate::asset::{Asset, from_glb};
use crate::basis::Order;
use crate::brdf::{Reflection, Tile, TileShape};

fn tile() -> Tile {
    let shape = TileShape {
        width: 2,
        height: 3,
        views: 3,
        order: Order::new(2).unwrap(),
    };
    let values = (0..shape.count()).map(|i| ((i * 7) % 23) as f32 / 23.0);
    Tile::new(shape, values.collect()).unwrap()
}

fn asset() -> Asset {
    covered(Reflection::Tile {
        tile: tile().into(),
        repeat: 2.5,
    })
}

#[test]
fn a_tile_lies_in_the_asset_and_shades_as_it_did() {
    let asset = asset();
    let bytes = glb(&asset);
    let back = from_glb(&bytes).unwrap();
    assert_eq!(glb(&back), bytes);
    assert_eq!(shaded(&back), shaded(&asset));
    let Some(Reflection::Tile { tile: ours, repeat }) = &back.scene.reflection_override else {
        panic!("no tile");
    };
    assert!(**ours == tile() && *repeat == 2.5);
}

#[test]
fn tiles_that_lie_are_refused_with_what_is_wrong() {
    let bytes = glb(&asset());
    let (document, bin) = parts(&bytes);
    let refused = |key: &'static str, value: Value| {
        let mut document = document.clone();
        headers(&mut document).for_each(|header| header["brdf"][key] = value.clone());
        from_glb(&join(&document, bin)).unwrap_err().to_string()
    };
    assert!(refused("width", json!(3)).contains("whose table has"));
    assert!(refused("width", json!(0)).contains("a tile that is none"));
    assert!(refused("height", json!(u64::MAX)).contains("a tile that is none"));
    assert!(refused("views", json!(1_000_000)).contains("a tile that is none"));
    let more = |key| refused(key, json!(1024));
    assert!(
        more("width").contains("whose table has") && more("order").contains("tile that is none")
    );
    assert!(refused("order", json!(0)).contains("a tile that is none"));
    assert!(refused("repeat", json!(0.0)).contains("out of its range"));
    assert!(refused("repeat", json!(-1e30)).contains("out of its range"));
    assert!(refused("table", json!(1_000_000)).contains("not there"));
    let mut document = document.clone();
    let view = headers(&mut document).next().unwrap()["brdf"]["table"].clone();
    let view = &document["bufferViews"][view.as_u64().unwrap() as usize];
    let start = view["byteOffset"].as_u64().unwrap() as usize;
    let mut bin = bin.to_vec();
    bin[start + 4 * 5..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let said = from_glb(&join(&document, &bin)).unwrap_err().to_string();
    assert!(said.contains("value 5 is NaN"), "{said}");
}

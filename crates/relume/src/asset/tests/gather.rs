//! The gather operator in an asset.

use super::*;

/// An operator over all sides of an asset.
pub fn with_gather(mut asset: Asset, channels: usize) -> Asset {
    let backs = asset
        .transfer
        .back
        .as_ref()
        .map_or(0, |back| back.vertices.len());
    let sides = (asset.transfer.vertex_count() + backs) as u32;
    let mut gather = Gather {
        channels,
        starts: vec![0],
        ..Gather::default()
    };
    for side in 0..sides {
        // None, one or two columns.
        gather
            .columns
            .extend([0, 2, sides - 1].into_iter().take(side as usize % 3));
        gather.starts.push(gather.columns.len() as u64);
    }
    gather.weights = (0..gather.columns.len() * channels)
        .map(|i| i as f32 / 7.0)
        .collect();
    asset.transfer.gather = Some(gather);
    asset
}

#[test]
fn the_gather_operator_comes_back_and_leaves_nothing_behind_when_baked_again() {
    for channels in [1, 3] {
        let plain = samples::asset();
        let asset = with_gather(samples::asset(), channels);
        let bytes = glb(&asset);
        let read = from_glb(&bytes).unwrap();
        assert_eq!(read.transfer.gather, asset.transfer.gather);
        assert_eq!(glb(&read), bytes);
        // The document that was baked is the one without.
        let mut without = read;
        without.transfer.gather = None;
        assert_eq!(glb(&without), glb(&from_glb(&glb(&plain)).unwrap()));
    }
}

#[test]
fn a_gather_operator_that_is_none_is_refused() {
    let bytes = glb(&with_gather(samples::asset(), 1));
    let refusal = |change: &dyn Fn(&mut Value)| {
        let (mut json, bin) = parts(&bytes);
        change(&mut json["extensions"]["RELUME_transfer"]["gather"]);
        from_glb(&join(&json, bin)).unwrap_err().to_string()
    };
    assert!(refusal(&|gather| gather["rows"] = 3.into()).contains("3 rows"));
    assert!(refusal(&|gather| gather["channels"] = 2.into()).contains("channels"));
    assert!(refusal(&|gather| gather["entries"] = 1.into()).contains("bytes"));
    assert!(
        refusal(&|gather| gather["columns"] = gather["counts"].clone()).contains("buffer view")
    );
    assert!(refusal(&|gather| gather["weights"] = "all".into()).contains("words"));

    let broken = |change: &dyn Fn(&mut Gather)| {
        let mut asset = with_gather(samples::asset(), 1);
        change(asset.transfer.gather.as_mut().unwrap());
        to_glb(&asset).unwrap_err().to_string()
    };
    assert!(broken(&|gather| gather.columns[0] = 1 << 20).contains("no side"));
    assert!(broken(&|gather| gather.columns[2] = 0).contains("ascend"));
    assert!(broken(&|gather| gather.weights[0] = f32::NAN).contains("weight"));
    assert!(broken(&|gather| gather.starts.push(0)).contains("sides"));
}

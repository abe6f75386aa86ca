use super::*;

fn meaning() -> Meaning {
    Meaning {
        order: Order::new(5).unwrap(),
        channels: 3,
        kind: TransferKind::Shadowed { bounces: 2 },
        samples: 1024,
        seed: u64::MAX,
        made: Provenance {
            error: Some(0.005),
            tracer: Some("embree".to_owned()),
            bake: Some("5e".repeat(32)),
        },
        precision: Precision::F32,
        albedo: None,
        source_hash: String::new(),
        transfer_order: Some(Order::new(10).unwrap()),
        brdf: Some(Brdf::Phong {
            diffuse: [0.5, 0.25, 0.0],
            specular: [0.125; 3],
            exponent: 20.0,
        }),
        beside: None,
    }
}

fn primitives() -> Vec<Primitive> {
    let first = Primitive {
        count: Some(7),
        input_vertices: Some(4),
        transfer: Some(3),
        matrices: Some(5),
        back: Some(Back {
            count: 1,
            vertices: 4,
            transfer: 5,
            matrices: Some(6),
        }),
        ..Primitive::default()
    };
    let second = Primitive {
        same_as: Some(0),
        ..Primitive::default()
    };
    vec![first, second, Primitive::default()]
}

#[test]
fn a_header_comes_back_as_it_went() {
    let hash = "0123456789abcdef".repeat(4);
    for seed in [0, 1 << 53, (1 << 53) + 1, u64::MAX] {
        let written = Meaning {
            seed,
            precision: Precision::ALL[(seed % 2) as usize],
            albedo: Some([0.5, 0.25, 0.1]),
            source_hash: hash.clone(),
            beside: (seed > 0).then(|| Beside {
                byte_length: 1 << 40,
                crc32: "0123abcd".to_owned(),
            }),
            ..meaning()
        };
        let text = to_json(&written, &primitives()).to_string();
        let read = from_json(&serde_json::from_str(&text).unwrap()).unwrap();
        assert_eq!(read, (written, primitives()));
    }
}

#[test]
fn unknown_tokens_are_refused_by_name() {
    let changes = [
        ("basis", "haar"),
        ("convention", "real-cs"),
        ("quantity", "radiance"),
        ("colour", "srgb"),
        ("precision", "f64"),
        ("frame", "object"),
        ("kind", "glossy\u{1b}"),
        ("seed", "-1"),
        ("source", "sha256:12"),
        ("samples", "many"),
    ];
    for (key, value) in changes {
        let mut json = to_json(&meaning(), &[]);
        json[key] = value.into();
        let Err(HeaderError::Wrong(what)) = from_json(&json) else {
            panic!("{key} {value} was accepted");
        };
        assert!(!what.contains(['\u{1b}', '\n']), "{what}");
    }
    for (key, value) in [
        ("order", 0),
        ("order", 33),
        ("channels", 2),
        ("channels", 4),
        ("transferOrder", 0),
        ("transferOrder", 33),
    ] {
        let mut json = to_json(&meaning(), &[]);
        json[key] = value.into();
        assert!(matches!(from_json(&json), Err(HeaderError::Wrong(_))));
    }
}

#[test]
fn brdfs_out_of_range_and_unknown_ones_are_refused() {
    let phong = |diffuse: f64, exponent: f64| {
        serde_json::json!({
            "model": "phong", "diffuse": [diffuse, 0.0, 0.0], "specular": [0.5, 0.5, 0.5], "exponent": exponent
        })
    };
    for wrong in [
        phong(1.5, 2.0),
        phong(-0.1, 2.0),
        phong(0.5, -1.0),
        phong(0.5, 1e9),
        serde_json::json!({ "model": "ggx", "metallic": 0.5, "roughness": 2.0 }),
        serde_json::json!({ "model": "ggx", "metallic": 0.5 }),
        serde_json::json!({ "model": "velvet" }),
        serde_json::json!("phong"),
    ] {
        let mut json = to_json(&meaning(), &[]);
        json["brdf"] = wrong.clone();
        let refused = matches!(from_json(&json), Err(HeaderError::Wrong(_)));
        assert!(refused, "{wrong} was accepted");
    }
    let mut json = to_json(&meaning(), &[]);
    json["brdf"] = phong(0.5, 2.0);
    assert!(from_json(&json).is_ok());
}

#[test]
fn a_version_to_come_is_told_apart() {
    let mut json = to_json(&meaning(), &[]);
    json["version"] = 2.into();
    assert!(matches!(from_json(&json), Err(HeaderError::Newer(2))));
    json["version"] = "1".into();
    assert!(matches!(from_json(&json), Err(HeaderError::Wrong(_))));
}

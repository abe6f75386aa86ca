//! The shaders as the compiler reads them, against the structs of this side.

use std::mem::{offset_of, size_of};

use naga::valid::{Capabilities, ValidationFlags, Validator};

use relume::basis::Order;

use super::*;
use crate::cube::{CUBE, PROJECT};
use crate::glossy::source;
use crate::near_source;
use crate::pipelines::{MATRICES, RELIGHT, VIEW};

fn parsed(source: &str) -> naga::Module {
    naga::front::wgsl::parse_str(source).unwrap_or_else(|e| panic!("{}", e.emit_to_string(source)))
}

#[test]
fn every_shader_is_valid_without_any_extension() {
    let glossy = [1, 2, 5, 10].map(|n| source(Order::new(n).unwrap()));
    let near = [(1, 1), (2, 3), (3, 1), (4, 3), (10, 1)]
        .map(|(n, channels)| near_source::source(Order::new(n).unwrap(), channels));
    let plain = [RELIGHT, MATRICES, VIEW, CUBE, PROJECT].into_iter();
    let lamps = crate::lamps::source();
    let written = glossy.iter().chain(&near).chain([&lamps]);
    for source in plain.chain(written.map(String::as_str)) {
        let validated =
            Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&parsed(source));
        if let Err(error) = validated {
            panic!("{}", error.emit_to_string(source));
        }
    }
}

/// Asserts the members' names and offsets, and the size.
fn check(source: &str, name: &str, size: usize, members: &[(&str, usize)]) {
    let module = parsed(source);
    let types = module.types.iter();
    let found = types
        .map(|(_, ty)| ty)
        .find(|ty| ty.name.as_deref() == Some(name));
    let Some(naga::TypeInner::Struct {
        members: theirs,
        span,
    }) = found.map(|ty| &ty.inner)
    else {
        panic!("no struct {name}");
    };
    let theirs: Vec<(&str, usize)> = theirs
        .iter()
        .map(|member| (member.name.as_deref().unwrap(), member.offset as usize))
        .collect();
    assert_eq!(theirs, members, "{name}");
    assert_eq!(*span as usize, size, "{name}");
}

/// A struct's name, its size, and the names and offsets of its fields.
macro_rules! check {
    ($source:expr, $name:ident { $($field:ident),+ }) => {
        check($source, stringify!($name), size_of::<$name>(), &[$((stringify!($field), offset_of!($name, $field))),+]);
    };
}

#[test]
fn structs_lie_as_the_shaders_read_them() {
    check!(
        RELIGHT,
        Page {
            first_row,
            width_log2,
            unused
        }
    );
    check!(RELIGHT, DistantLight { quads });
    check!(MATRICES, DistantLight { quads });
    check!(
        MATRICES,
        MatrixPage {
            first_row,
            across,
            width_log2,
            objects_log2
        }
    );
    check!(
        VIEW,
        View {
            clip_from_offset,
            eye,
            scale,
            forward,
            surface,
            right,
            unused,
            up,
            width_log2,
            background_from_world
        }
    );
    check!(
        VIEW,
        Material {
            base_color,
            cutoff,
            metallic,
            roughness,
            normal_scale,
            tile
        }
    );
    assert_eq!(size_of::<Vertex>(), 40);
    assert_eq!(size_of::<GlossyVertex>(), 88);
    assert_eq!(size_of::<LampVertex>(), 44);
}

#[test]
fn numbers_have_the_shaders_names() {
    let module = parsed(&source(Order::new(3).unwrap()));
    let value = |name: &str| {
        let constants = module.constants.iter().map(|(_, constant)| constant);
        let constant = constants
            .into_iter()
            .find(|c| c.name.as_deref() == Some(name));
        match module.global_expressions[constant.expect(name).init] {
            naga::Expression::Literal(naga::Literal::U32(value)) => value,
            ref other => panic!("{name} is {other:?}"),
        }
    };
    for (name, number) in [
        ("SHADED", surface::SHADED),
        ("WHITE", surface::WHITE),
        ("SIGNED", surface::SIGNED),
        ("ALBEDO", surface::ALBEDO),
        ("RADIANCE", encoding::RADIANCE),
        ("LINEAR", encoding::LINEAR),
        ("ENCODED", encoding::ENCODED),
        ("NO_SIDE", NO_SIDE),
        ("DIFFUSE", reflection::DIFFUSE),
        ("METALLIC_ROUGHNESS", reflection::METALLIC_ROUGHNESS),
        ("FIXED", reflection::FIXED),
        ("TILE", reflection::TILE),
    ] {
        assert_eq!(value(name), number, "{name}");
    }
}

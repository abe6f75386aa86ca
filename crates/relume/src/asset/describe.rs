//! What is in a baked asset, in numbers and words.

use std::fmt;

use super::{Asset, Precision, TransferKind, header};
use crate::basis::Order;
use crate::brdf::{Brdf, Reflection};
use crate::files::printable;

/// Sizes and conventions of a baked asset. `Display` gives one line each.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// Order of the light that the transfer answers to.
    pub order: Order,
    /// 1, or 3 with interreflection.
    pub channels: usize,
    /// Order of transferred radiance, where there are transfer matrices for glossy surfaces.
    pub transfer_order: Option<Order>,
    /// How the bake let all surfaces reflect, in place of what materials say: the model's name in the file, and in words.
    pub brdf: Option<(&'static str, String)>,
    /// What light paths it counts.
    pub kind: TransferKind,
    /// Rays per vertex.
    pub samples: u32,
    /// The seed it was baked with.
    pub seed: u64,
    /// SHA-256 of the source file, hex; empty when unknown.
    pub source_hash: String,
    /// Vertices over all instances.
    pub vertices: usize,
    /// How many of them came from the source; the rest were added by tessellation.
    pub input_vertices: usize,
    /// Buried vertices, whose transfer was filled from their neighbours.
    pub invalid: usize,
    /// Vertices with a transfer of their back side too.
    pub back_vertices: usize,
    /// How the file stores coefficients.
    pub precision: Precision,
    /// Bytes of coefficients per vertex in the file.
    pub bytes_per_vertex: usize,
    /// Bytes of all coefficients in the file, back sides included.
    pub transfer_bytes: u64,
    /// Meshes placed in the scene.
    pub instances: usize,
    /// Triangles over all instances.
    pub triangles: usize,
    /// Materials of the scene.
    pub materials: usize,
    /// Decoded base colour textures.
    pub textures: usize,
    /// Names of materials that are used and have a metallic factor, which diffuse transfer ignores; fit to print.
    pub metallic: Vec<String>,
}

/// Counts what is in `asset`.
pub fn describe(asset: &Asset) -> Description {
    let Asset { scene, transfer } = asset;
    let meshes = || scene.instances.iter().map(|i| &scene.meshes[i.mesh]);
    let mut used = vec![false; scene.materials.len()];
    for group in meshes().flat_map(|mesh| &mesh.groups) {
        used[group.material] = true;
    }
    let materials = scene.materials.iter().zip(used);
    let metallic = materials.filter(|(material, used)| *used && material.metallic > 0.0);
    let back = transfer.back.as_ref();
    let matrices = transfer.matrices.as_ref();
    let coefficients = transfer.coefficients.len()
        + back.map_or(0, |b| b.coefficients.len())
        + matrices.map_or(0, |all| all.coefficients.len() + all.back.len());
    Description {
        order: transfer.order,
        channels: transfer.channels,
        transfer_order: matrices.map(|all| all.order),
        brdf: scene.reflection_override.as_ref().map(named),
        kind: transfer.kind,
        samples: transfer.samples,
        seed: transfer.seed,
        source_hash: scene.source_hash.clone(),
        vertices: transfer.vertex_count(),
        input_vertices: meshes().map(|mesh| mesh.input_vertices).sum(),
        invalid: transfer.valid.iter().filter(|&&valid| !valid).count(),
        back_vertices: back.map_or(0, |back| back.vertices.len()),
        precision: transfer.precision,
        bytes_per_vertex: transfer.precision.bytes()
            * (transfer.stride() + transfer.matrix_stride()),
        transfer_bytes: (transfer.precision.bytes() * coefficients) as u64,
        instances: scene.instances.len(),
        triangles: scene.triangle_count(),
        materials: scene.materials.len(),
        textures: scene.textures.len(),
        metallic: metallic
            .map(|(material, _)| printable(&material.name))
            .collect(),
    }
}

/// The name of a model in files, and what it is for people.
fn named(reflection: &Reflection) -> (&'static str, String) {
    match reflection {
        Reflection::Diffuse => ("lambert", "diffuse".to_owned()),
        Reflection::MetallicRoughness {
            metallic,
            roughness,
        } => (
            "ggx",
            format!("GGX in their base colour, metalness {metallic}, roughness {roughness}"),
        ),
        Reflection::Fixed(Brdf::Phong(phong)) => {
            let [diffuse, specular] = [phong.diffuse, phong.specular].map(|color| {
                let [r, g, b] = color.to_array();
                format!("{r},{g},{b}")
            });
            let exponent = phong.exponent;
            let words =
                format!("Phong, diffuse {diffuse}, specular {specular}, exponent {exponent}");
            ("phong", words)
        }
        Reflection::Fixed(Brdf::Measured(_)) => {
            let words = "as one that was measured (MERL), whose table is in the file";
            ("merl", words.to_owned())
        }
        Reflection::Tile { tile, repeat } => {
            let shape = tile.shape();
            let (width, height, views) = (shape.width, shape.height, shape.views);
            let words = format!(
                "as a tile of {width} × {height} texels, {views} × {views} views and order {}, {repeat} times for each texture coordinate of 1",
                shape.order
            );
            ("tile", words)
        }
        Reflection::Fixed(_) => ("other", "as one that files cannot hold".to_owned()),
    }
}

impl fmt::Display for Description {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (vertices, inputs) = (self.vertices, self.input_vertices);
        let added = vertices.saturating_sub(inputs);
        let (instances, triangles) = (self.instances, self.triangles);
        let (materials, textures) = (self.materials, self.textures);
        let (count, bytes) = (self.order.count(), self.bytes_per_vertex);
        let source = match self.source_hash.as_str() {
            "" => "unknown".to_owned(),
            hash => format!("sha256 {hash}"),
        };
        let lines = [
            ("transfer", self.kind_in_words()),
            ("matrices", self.matrices_in_words()),
            ("surfaces", self.surfaces_in_words()),
            (
                "basis",
                format!(
                    "spherical harmonics, order {} ({count} coefficients), {}",
                    self.order,
                    header::CONVENTION
                ),
            ),
            (
                "quantity",
                format!("{}, without the receiver's own albedo", header::QUANTITY),
            ),
            ("channels", self.channels_in_words().to_owned()),
            ("precision", self.precision_in_words().to_owned()),
            ("space", "the scene's root, right-handed, y up".to_owned()),
            (
                "vertices",
                format!("{vertices} ({inputs} of the source, {added} added)"),
            ),
            (
                "buried",
                format!("{} vertices, filled from their neighbours", self.invalid),
            ),
            ("back sides", format!("{} vertices", self.back_vertices)),
            (
                "size",
                format!(
                    "{bytes} bytes a vertex, {} bytes in all",
                    self.transfer_bytes
                ),
            ),
            (
                "sampling",
                format!("{} rays a vertex, seed {}", self.samples, self.seed),
            ),
            (
                "scene",
                format!(
                    "{instances} instances, {triangles} triangles, {materials} materials, {textures} textures"
                ),
            ),
            ("source", source),
        ];
        for (name, value) in lines {
            writeln!(f, "{name:<12} {value}")?;
        }
        self.write_note(f)
    }
}

impl Description {
    fn kind_in_words(&self) -> String {
        let surfaces = match self.transfer_order {
            Some(_) => "glossy",
            None => "diffuse",
        };
        match self.kind {
            TransferKind::Unshadowed => format!("{surfaces}, unshadowed (closed form)"),
            TransferKind::Shadowed { bounces: 0 } => format!("{surfaces}, shadowed direct light"),
            TransferKind::Shadowed { bounces: 1 } => format!("{surfaces}, shadowed, 1 bounce"),
            TransferKind::Shadowed { bounces } => {
                format!("{surfaces}, shadowed, {bounces} bounces")
            }
        }
    }

    fn matrices_in_words(&self) -> String {
        match self.transfer_order {
            Some(order) => format!("transferred radiance of order {order}, for glossy surfaces"),
            None => "none: surfaces are diffuse".to_owned(),
        }
    }

    fn surfaces_in_words(&self) -> String {
        match (&self.brdf, self.transfer_order) {
            (Some((_, words)), _) => format!("all reflect alike: {words}"),
            (None, Some(_)) => "as their materials say".to_owned(),
            (None, None) => "diffuse, of their base colour".to_owned(),
        }
    }

    fn channels_in_words(&self) -> &'static str {
        match self.channels {
            1 => "1, for every colour",
            _ => "3, linear Rec. 709",
        }
    }

    fn precision_in_words(&self) -> &'static str {
        match self.precision {
            Precision::F32 => "f32",
            Precision::F16 => "f16: rounded to half floats, f32 in memory",
        }
    }

    fn write_note(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(first) = self.metallic.first() else {
            return Ok(());
        };
        if self.transfer_order.is_some() {
            return Ok(());
        }
        let more = match self.metallic.len() - 1 {
            0 => String::new(),
            more => format!(" (and {more} more)"),
        };
        let note = format!("diffuse transfer ignores metalness: material \"{first}\"{more}");
        writeln!(f, "{:<12} {note}", "note")
    }
}

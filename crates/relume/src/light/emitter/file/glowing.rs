//! Emitters of the emissive surfaces of a glTF scene.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DVec3};

use super::super::{Emitter, EmitterMesh, Emitters, MAX_CORNERS, Pattern, Shape};
use super::{EmitterFileError, MAX_NAME, concerns_shape};
use crate::light::HdrImage;
use crate::scene::gltf::{Glow, emission};
use crate::scene::{Scene, SceneError, Texture, srgb_to_linear};

/// The emissive surfaces of a `.glb` or `.gltf`, in the space of its root.
pub(super) fn load(path: &Path) -> Result<(Emitters, Vec<String>), EmitterFileError> {
    let mut scene = read(path)?;
    let glows = emission(&mut scene, MAX_CORNERS as u64)?;
    let dark = scene.instances.len() - glows.len();
    if glows.is_empty() {
        return Err(EmitterFileError::Dark { primitives: dark });
    }
    let mut warnings = std::mem::take(&mut scene.warnings);
    warnings.retain(|warning| concerns_shape(warning));
    if dark > 0 {
        warnings.push(format!(
            "{dark} of {} primitives are not emissive; they neither shine nor block",
            scene.instances.len()
        ));
    }
    let mut images = BTreeMap::new();
    let emitters = glows
        .into_iter()
        .map(|glow| emitter(&scene, glow, &mut images));
    Ok((Emitters::new(emitters.collect())?, warnings))
}

#[cfg(feature = "import")]
fn read(path: &Path) -> Result<Scene, EmitterFileError> {
    let read = crate::scene::load(path, &crate::scene::ImportOptions::default());
    read.map_err(|error| match error {
        // Whoever asked says which file.
        SceneError::In { problem, .. } => (*problem).into(),
        other => other.into(),
    })
}

/// What stands alone is read with every feature off.
#[cfg(not(feature = "import"))]
fn read(path: &Path) -> Result<Scene, EmitterFileError> {
    use crate::files::{Unread, read_regular};

    let limit = u64::from(u32::MAX);
    let bytes = read_regular(path, limit).map_err(|unread| match unread {
        Unread::Io(source) => EmitterFileError::Read { source },
        Unread::NotAFile => EmitterFileError::NotAFile,
        Unread::TooLarge(bytes) => EmitterFileError::TooLarge { bytes, limit },
    })?;
    if !bytes.starts_with(b"glTF") {
        return Err(EmitterFileError::NotBuilt {
            what: ".gltf files",
            feature: "import",
        });
    }
    let scene: Result<Scene, SceneError> = crate::scene::gltf::from_glb(&bytes);
    Ok(scene?)
}

/// An instance that shines. Its vertices keep their order; where its node mirrors it, its triangles are turned back.
fn emitter(scene: &Scene, glow: Glow, images: &mut BTreeMap<usize, Arc<HdrImage>>) -> Emitter {
    let instance = &scene.instances[glow.instance];
    let mesh = &scene.meshes[instance.mesh];
    let pose = instance.world_from_object;
    let mirrors = pose.matrix3.determinant() < 0.0;
    let turned = |[a, b, c]: [u32; 3]| {
        if mirrors {
            vec![a, c, b]
        } else {
            vec![a, b, c]
        }
    };
    let (pattern, uvs) = match glow.texture {
        None => (Pattern::Uniform(glow.radiance), Vec::new()),
        Some((index, uvs)) => {
            let image = images
                .entry(index)
                .or_insert_with(|| Arc::new(linear(&scene.textures[index])));
            let pattern = Pattern::Texture {
                image: Arc::clone(image),
                factor: glow.radiance,
            };
            (pattern, uvs)
        }
    };
    let position = |p: &glam::Vec3| -> DVec3 { pose.transform_point3(p.as_dvec3()) };
    Emitter {
        name: glow.name.chars().take(MAX_NAME).collect(),
        shape: Shape::Mesh(EmitterMesh {
            positions: mesh.positions.iter().map(position).collect(),
            uvs,
            faces: mesh.triangles().map(turned).collect(),
        }),
        pattern,
        two_sided: glow.double_sided,
        exponent: 0,
        world_from_emitter: DAffine3::IDENTITY,
    }
}

/// Radiance of a texture encoded in sRGB.
fn linear(texture: &Texture) -> HdrImage {
    let rgb = |&[r, g, b, _]: &[u8; 4]| [r, g, b].map(srgb_to_linear);
    let (width, height) = (texture.width as usize, texture.height as usize);
    HdrImage::new(width, height, texture.texels.iter().map(rgb).collect())
        .expect("a decoded texture has a size that is read, and values of 0…1")
}

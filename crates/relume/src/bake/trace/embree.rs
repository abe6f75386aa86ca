//! Embree 4, where it is installed: an optional tracer and an independent check of ours.
//!
//! Loaded when asked for, by an absolute path or from the system's folders. What it answers may differ between processors and releases:
//! bakes made with it are not promised to be the same bytes anywhere.
#![allow(
    unsafe_code,
    reason = "a C library; the structures below are those of its header rtcore_ray.h"
)]

use std::ffi::{c_char, c_int, c_void};
use std::path::{Path, PathBuf};

use glam::Vec3;
use libloading::{Library, Symbol};
use thiserror::Error;

use super::rays::Rays;
use crate::scene::{AlphaMode, World};

/// Rays that travel together.
const WIDTH: usize = 16;

/// Why Embree cannot be used.
#[derive(Debug, Error)]
pub enum EmbreeError {
    /// Not there, or not to be opened.
    #[error(
        "cannot load Embree 4 ({0}): install it (libembree4) or name its file: --tracer embree:/path/to/libembree4.so"
    )]
    Load(String),
    /// A path that depends on where the program runs.
    #[error("{0}: Embree is only loaded from an absolute path")]
    Relative(PathBuf),
    /// A library that lacks what Embree 4 has.
    #[error("the library loaded is not Embree 4: {0}")]
    Foreign(String),
    /// Embree says no.
    #[error("Embree failed with error {0}")]
    Failed(c_int),
    /// Cut-out materials.
    #[error(
        "the scene has alpha-masked materials, which the Embree tracer does not look at: use --tracer auto"
    )]
    Masked,
}

type Handle = *mut c_void;

/// `RTCRay16`.
#[repr(C, align(64))]
#[derive(Clone, Copy)]
struct Ray16 {
    origin: [[f32; WIDTH]; 3],
    near: [f32; WIDTH],
    direction: [[f32; WIDTH]; 3],
    time: [f32; WIDTH],
    far: [f32; WIDTH],
    mask: [u32; WIDTH],
    id: [u32; WIDTH],
    flags: [u32; WIDTH],
}

/// `RTCHit16`, with room for the fields that only some builds have.
#[repr(C, align(64))]
#[derive(Clone, Copy)]
struct Hit16 {
    normal: [[f32; WIDTH]; 3],
    u: [f32; WIDTH],
    v: [f32; WIDTH],
    primitive: [u32; WIDTH],
    geometry: [u32; WIDTH],
    instances: [[u32; WIDTH]; 4],
}

#[repr(C, align(64))]
#[derive(Clone, Copy)]
struct RayHit16 {
    ray: Ray16,
    hit: Hit16,
}

/// `RTCIntersectArguments` and `RTCOccludedArguments`.
#[repr(C)]
struct Arguments {
    flags: c_int,
    feature_mask: c_int,
    context: Handle,
    filter: Handle,
    callback: Handle,
    spare: [usize; 2],
}

const COHERENT: c_int = 1 << 16;
const ROBUST: c_int = 1 << 2;
const HIGH_QUALITY: c_int = 2;
const TRIANGLES: c_int = 0;
const INDICES: c_int = 0;
const VERTICES: c_int = 1;
const UINT3: c_int = 0x5003;
const FLOAT3: c_int = 0x9003;

type Cast<T> = unsafe extern "C" fn(*const c_int, Handle, *mut T, *mut Arguments);

/// A scene of Embree's; the library stays loaded as long as it.
pub struct Embree {
    scene: Handle,
    device: Handle,
    occluded: Cast<Ray16>,
    intersect: Cast<RayHit16>,
    release_scene: unsafe extern "C" fn(Handle),
    release_device: unsafe extern "C" fn(Handle),
    /// What the scene reads; Embree may look a few bytes past the last vertex.
    _positions: Vec<[f32; 3]>,
    _triangles: Vec<[u32; 3]>,
    _library: Library,
}

// SAFETY: Embree's scenes may be asked from any thread once they are committed; nothing here changes afterwards.
unsafe impl Send for Embree {}
// SAFETY: as above.
unsafe impl Sync for Embree {}

/// What a scene is made with.
struct SetUp {
    new_device: unsafe extern "C" fn(*const c_char) -> Handle,
    new_scene: unsafe extern "C" fn(Handle) -> Handle,
    new_geometry: unsafe extern "C" fn(Handle, c_int) -> Handle,
    set_buffer: SetBuffer,
    attach: unsafe extern "C" fn(Handle, Handle) -> u32,
    commit_geometry: unsafe extern "C" fn(Handle),
    release_geometry: unsafe extern "C" fn(Handle),
    commit_scene: unsafe extern "C" fn(Handle),
    set_flags: unsafe extern "C" fn(Handle, c_int),
    set_quality: unsafe extern "C" fn(Handle, c_int),
    get_error: unsafe extern "C" fn(Handle) -> c_int,
}

/// Geometry, kind, slot, format, memory, offset, stride, count.
type SetBuffer =
    unsafe extern "C" fn(Handle, c_int, u32, c_int, *const c_void, usize, usize, usize);

impl SetUp {
    /// # Safety
    /// `library` is Embree 4.
    unsafe fn of(library: &Library) -> Result<Self, EmbreeError> {
        // SAFETY: promised by the caller; the signatures are those of Embree 4's rtcore headers.
        unsafe {
            Ok(Self {
                new_device: symbol(library, "rtcNewDevice")?,
                new_scene: symbol(library, "rtcNewScene")?,
                new_geometry: symbol(library, "rtcNewGeometry")?,
                set_buffer: symbol(library, "rtcSetSharedGeometryBuffer")?,
                attach: symbol(library, "rtcAttachGeometry")?,
                commit_geometry: symbol(library, "rtcCommitGeometry")?,
                release_geometry: symbol(library, "rtcReleaseGeometry")?,
                commit_scene: symbol(library, "rtcCommitScene")?,
                set_flags: symbol(library, "rtcSetSceneFlags")?,
                set_quality: symbol(library, "rtcSetSceneBuildQuality")?,
                get_error: symbol(library, "rtcGetDeviceError")?,
            })
        }
    }

    /// Puts all triangles into the new scene, and builds it.
    ///
    /// # Safety
    /// `new` holds a device and a scene of this library.
    unsafe fn fill(&self, new: &Embree) {
        let (positions, triangles) = (&new._positions, &new._triangles);
        let (vertices, indices) = (positions.as_ptr().cast(), triangles.as_ptr().cast());
        // One position is there only to be looked past.
        let (vertex_count, triangle_count) = (positions.len() - 1, triangles.len());
        // SAFETY: promised by the caller; the buffers are as long as said and live as long as the scene.
        unsafe {
            (self.set_flags)(new.scene, ROBUST);
            (self.set_quality)(new.scene, HIGH_QUALITY);
            let geometry = (self.new_geometry)(new.device, TRIANGLES);
            (self.set_buffer)(geometry, VERTICES, 0, FLOAT3, vertices, 0, 12, vertex_count);
            (self.set_buffer)(geometry, INDICES, 0, UINT3, indices, 0, 12, triangle_count);
            (self.commit_geometry)(geometry);
            (self.attach)(new.scene, geometry);
            (self.release_geometry)(geometry);
            (self.commit_scene)(new.scene);
        }
    }
}

impl Embree {
    /// A robust scene of high quality over all triangles of `world`; `path` is absolute, or `None` for the system's own.
    pub fn new(world: &World, path: Option<&Path>) -> Result<Self, EmbreeError> {
        let masked = |m: &crate::scene::Material| matches!(m.alpha, AlphaMode::Mask(_));
        if world.materials.iter().any(masked) {
            return Err(EmbreeError::Masked);
        }
        let library = load(path)?;
        let mut positions: Vec<[f32; 3]> = world.positions.iter().map(Vec3::to_array).collect();
        positions.push([0.0; 3]);
        let triangles = world.triangles.clone();
        // SAFETY: the signatures are those of Embree 4's rtcore headers.
        unsafe { Self::commit(library, positions, triangles) }
    }

    /// # Safety
    /// `library` is Embree 4.
    unsafe fn commit(
        library: Library,
        positions: Vec<[f32; 3]>,
        triangles: Vec<[u32; 3]>,
    ) -> Result<Self, EmbreeError> {
        // SAFETY: promised by the caller; buffers outlive the scene because `Self` keeps both.
        unsafe {
            let set_up = SetUp::of(&library)?;
            let device = (set_up.new_device)(std::ptr::null());
            if device.is_null() {
                return Err(EmbreeError::Failed((set_up.get_error)(device)));
            }
            let built = Self {
                scene: (set_up.new_scene)(device),
                device,
                occluded: symbol(&library, "rtcOccluded16")?,
                intersect: symbol(&library, "rtcIntersect16")?,
                release_scene: symbol(&library, "rtcReleaseScene")?,
                release_device: symbol(&library, "rtcReleaseDevice")?,
                _positions: positions,
                _triangles: triangles,
                _library: library,
            };
            set_up.fill(&built);
            match (set_up.get_error)(device) {
                0 => Ok(built),
                error => Err(EmbreeError::Failed(error)),
            }
        }
    }

    /// As [`super::Tracer::open_from`].
    pub fn open_from(&self, origin: Vec3, rays: &Rays, open: &mut [u64]) {
        open.fill(0);
        for start in (0..rays.len()).step_by(WIDTH) {
            let mut packet = packet(origin, rays, start);
            let valid = Valid::first(rays.len() - start);
            // SAFETY: the scene is committed, and the packet has Embree's layout.
            unsafe {
                (self.occluded)(
                    valid.0.as_ptr(),
                    self.scene,
                    &raw mut packet,
                    &mut arguments(),
                );
            };
            for (lane, (&far, &valid)) in packet.far.iter().zip(&valid.0).enumerate() {
                let sees = valid != 0 && far >= 0.0;
                open[start / 64] |= u64::from(sees) << (start % 64 + lane);
            }
        }
    }

    /// The triangle (or [`super::Hit::NONE`]) and distance along each ray.
    pub fn closest_from(&self, origin: Vec3, rays: &Rays, mut found: impl FnMut(usize, u32, f32)) {
        for start in (0..rays.len()).step_by(WIDTH) {
            let hit = Hit16 {
                normal: [[0.0; WIDTH]; 3],
                u: [0.0; WIDTH],
                v: [0.0; WIDTH],
                primitive: [u32::MAX; WIDTH],
                geometry: [u32::MAX; WIDTH],
                instances: [[u32::MAX; WIDTH]; 4],
            };
            let mut packet = RayHit16 {
                ray: packet(origin, rays, start),
                hit,
            };
            let valid = Valid::first(rays.len() - start);
            // SAFETY: as above.
            unsafe {
                (self.intersect)(
                    valid.0.as_ptr(),
                    self.scene,
                    &raw mut packet,
                    &mut arguments(),
                );
            };
            for lane in 0..WIDTH.min(rays.len() - start) {
                found(
                    start + lane,
                    packet.hit.primitive[lane],
                    packet.ray.far[lane],
                );
            }
        }
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // SAFETY: both were made by the library, which is still loaded, and are released once.
        unsafe {
            (self.release_scene)(self.scene);
            (self.release_device)(self.device);
        }
    }
}

fn load(path: Option<&Path>) -> Result<Library, EmbreeError> {
    let names: Vec<PathBuf> = match path {
        Some(path) if path.is_absolute() => vec![path.to_owned()],
        Some(path) => return Err(EmbreeError::Relative(path.to_owned())),
        None => SYSTEM_NAMES.iter().map(PathBuf::from).collect(),
    };
    let mut why = String::new();
    for name in names {
        match open(&name) {
            Ok(library) => return Ok(library),
            Err(error) => why = error.to_string(),
        }
    }
    Err(EmbreeError::Load(crate::files::printable(&why)))
}

/// A bare name: the dynamic loader then looks in the system's folders, not in the working directory.
const SYSTEM_NAMES: &[&str] = if cfg!(windows) {
    &["embree4.dll"]
} else if cfg!(target_os = "macos") {
    &[
        "/opt/homebrew/lib/libembree4.dylib",
        "/usr/local/lib/libembree4.dylib",
    ]
} else {
    &["libembree4.so.4", "libembree4.so"]
};

#[cfg(not(windows))]
fn open(name: &Path) -> Result<Library, libloading::Error> {
    // SAFETY: Embree's initialisers do nothing but set up the library.
    unsafe { Library::new(name) }
}

#[cfg(windows)]
fn open(name: &Path) -> Result<Library, libloading::Error> {
    use libloading::os::windows::{
        LOAD_LIBRARY_SEARCH_DLL_LOAD_DIR, LOAD_LIBRARY_SEARCH_SYSTEM32, Library as Windows,
    };
    // An absolute path may bring its neighbours along; a bare name is the system's.
    let flags = if name.is_absolute() {
        LOAD_LIBRARY_SEARCH_DLL_LOAD_DIR | LOAD_LIBRARY_SEARCH_SYSTEM32
    } else {
        LOAD_LIBRARY_SEARCH_SYSTEM32
    };
    // SAFETY: as above.
    unsafe { Windows::load_with_flags(name, flags).map(Into::into) }
}

/// # Safety
/// `T` is the type of the function `name`.
unsafe fn symbol<T: Copy>(library: &Library, name: &str) -> Result<T, EmbreeError> {
    // SAFETY: promised by the caller.
    let symbol: Result<Symbol<T>, _> = unsafe { library.get(name.as_bytes()) };
    symbol
        .map(|symbol| *symbol)
        .map_err(|error| EmbreeError::Foreign(error.to_string()))
}

fn arguments() -> Arguments {
    Arguments {
        flags: COHERENT,
        feature_mask: -1,
        context: std::ptr::null_mut(),
        filter: std::ptr::null_mut(),
        callback: std::ptr::null_mut(),
        spare: [0; 2],
    }
}

/// Which lanes hold a ray, as Embree wants it: −1 or 0, aligned like the packet.
#[repr(C, align(64))]
struct Valid([c_int; WIDTH]);

impl Valid {
    /// The first `left` lanes.
    fn first(left: usize) -> Self {
        Self(std::array::from_fn(|lane| if lane < left { -1 } else { 0 }))
    }
}

fn packet(origin: Vec3, rays: &Rays, start: usize) -> Ray16 {
    let part = |values: &[f32]| std::array::from_fn(|lane| values[start + lane]);
    Ray16 {
        origin: origin.to_array().map(|x| [x; WIDTH]),
        // A surface at the start itself is none, as for our own tracer.
        near: [f32::MIN_POSITIVE; WIDTH],
        direction: [part(&rays.x), part(&rays.y), part(&rays.z)],
        time: [0.0; WIDTH],
        far: [f32::INFINITY; WIDTH],
        mask: [u32::MAX; WIDTH],
        id: [0; WIDTH],
        flags: [0; WIDTH],
    }
}

//! Numbers out of the binary buffer. No length is believed before it is checked against the bytes that are there.

use super::super::SceneError;
use super::super::error::MAX_VERTICES;
use super::json::{Accessor, Root, Sparse, get};

/// The document and its one buffer.
pub(super) struct Data<'a> {
    pub(super) root: &'a Root,
    pub(super) bin: &'a [u8],
}

/// An accessor without a buffer view is all zeros (sparse values aside), so no bytes bound its length.
const MAX_UNBACKED: u64 = 1 << 24;

/// The type of one component.
#[derive(Clone, Copy)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn new(code: u32, place: &str) -> Result<Self, SceneError> {
        Ok(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => {
                let problem = format!("component type {code} is unknown; re-export");
                return Err(SceneError::gltf(place, problem));
            }
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// One component as a float; `normalized` maps whole numbers to 0…1 or −1…1 (glTF 2.0, §3.6.2.2).
    fn float(self, bytes: &[u8], normalized: bool) -> f32 {
        let (value, largest) = match self {
            Self::I8 => (f32::from(bytes[0] as i8), 127.0),
            Self::U8 => (f32::from(bytes[0]), 255.0),
            Self::I16 => (f32::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32767.0),
            Self::U16 => (f32::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65535.0),
            Self::U32 => (word(bytes) as f32, u32::MAX as f32),
            Self::F32 => return f32::from_bits(word(bytes)),
        };
        if normalized {
            (value / largest).max(-1.0)
        } else {
            value
        }
    }

    /// One component as an index, if it is of an unsigned type.
    fn index(self, bytes: &[u8]) -> Option<u32> {
        match self {
            Self::U8 => Some(u32::from(bytes[0])),
            Self::U16 => Some(u32::from(u16::from_le_bytes([bytes[0], bytes[1]]))),
            Self::U32 => Some(word(bytes)),
            _ => None,
        }
    }
}

fn word(bytes: &[u8]) -> u32 {
    u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])
}

/// Equally spaced elements in bytes that are long enough for them.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    count: usize,
}

impl<'a> Elements<'a> {
    fn iter(&self) -> impl Iterator<Item = &'a [u8]> {
        let (bytes, stride, size) = (self.bytes, self.stride, self.size);
        (0..self.count).map(move |i| &bytes[i * stride..][..size])
    }
}

impl<'a> Data<'a> {
    /// The bytes of a buffer view.
    pub(super) fn view(&self, index: usize, place: &str) -> Result<&'a [u8], SceneError> {
        let view = get(&self.root.buffer_views, index, "buffer view", place)?;
        let place = || format!("bufferViews[{index}]");
        let buffer = get(&self.root.buffers, view.buffer, "buffer", &place())?;
        let end = view.byte_offset.checked_add(view.byte_length);
        let available = buffer.byte_length.min(self.bin.len() as u64);
        match end {
            Some(end) if end <= available && view.buffer == 0 => {
                Ok(&self.bin[view.byte_offset as usize..end as usize])
            }
            _ => Err(SceneError::gltf(
                place(),
                format!("goes past the {available} bytes of its buffer; re-export"),
            )),
        }
    }

    /// `count` elements of `size` bytes, `offset` bytes into a buffer view.
    fn elements(
        &self,
        (view, offset): (usize, u64),
        (count, size): (u64, usize),
        place: &str,
    ) -> Result<Elements<'a>, SceneError> {
        let bytes = self.view(view, place)?;
        let stride = match self.root.buffer_views[view].byte_stride {
            None => size as u64,
            Some(stride) if stride >= size as u64 && stride <= 252 => stride,
            Some(stride) => {
                let problem = format!("byteStride is {stride} for elements of {size} bytes");
                return Err(SceneError::gltf(place, problem + "; re-export"));
            }
        };
        let needed = count
            .saturating_sub(1)
            .checked_mul(stride)
            .and_then(|n| n.checked_add(size as u64))
            .and_then(|n| n.checked_add(offset))
            .filter(|&n| n <= bytes.len() as u64);
        if needed.is_none() || count == 0 {
            let length = bytes.len();
            return Err(SceneError::gltf(
                place,
                format!(
                    "{count} elements do not lie in the {length} bytes of buffer view {view}; re-export"
                ),
            ));
        }
        Ok(Elements {
            bytes: &bytes[offset as usize..],
            stride: stride as usize,
            size,
            count: count as usize,
        })
    }

    /// The accessor an index names.
    pub(super) fn accessor(&self, index: usize, place: &str) -> Result<&'a Accessor, SceneError> {
        let accessor = get(&self.root.accessors, index, "accessor", place)?;
        if accessor.count > MAX_VERTICES * 8 {
            let problem = format!("count is {}; re-export", accessor.count);
            return Err(SceneError::gltf(format!("accessors[{index}]"), problem));
        }
        Ok(accessor)
    }

    /// An accessor of `N` components as floats. Whole numbers are taken as normalised when the accessor or the caller says so.
    pub(super) fn floats<const N: usize>(
        &self,
        index: usize,
        normalized: bool,
        place: &str,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        let accessor = self.accessor(index, place)?;
        let place = format!("accessors[{index}]");
        let shape = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        self.check_shape(accessor, shape, &place)?;
        let component = Component::new(accessor.component_type, &place)?;
        let normalized = normalized || accessor.normalized;
        let decode = |bytes: &[u8]| -> [f32; N] {
            std::array::from_fn(|i| component.float(&bytes[i * component.size()..], normalized))
        };
        self.read(accessor, (N * component.size(), [0.0; N]), decode, &place)
    }

    /// An accessor of indices of any unsigned type.
    pub(super) fn indices(&self, index: usize, place: &str) -> Result<Vec<u32>, SceneError> {
        let accessor = self.accessor(index, place)?;
        let place = format!("accessors[{index}]");
        self.check_shape(accessor, "SCALAR", &place)?;
        let component = Component::new(accessor.component_type, &place)?;
        check_index_type(component, &place)?;
        let decode = |bytes: &[u8]| component.index(bytes).unwrap_or_default();
        self.read(accessor, (component.size(), 0), decode, &place)
    }

    fn check_shape(&self, accessor: &Accessor, shape: &str, place: &str) -> Result<(), SceneError> {
        if accessor.shape == shape {
            return Ok(());
        }
        let found = crate::files::printable(&accessor.shape);
        let problem = format!("is of type {found} where {shape} is needed; re-export");
        Err(SceneError::gltf(place, problem))
    }

    fn read<T: Copy>(
        &self,
        accessor: &Accessor,
        (size, zero): (usize, T),
        decode: impl Fn(&[u8]) -> T,
        place: &str,
    ) -> Result<Vec<T>, SceneError> {
        let mut values: Vec<T> = match accessor.buffer_view {
            Some(view) => {
                let at = (view, accessor.byte_offset);
                let elements = self.elements(at, (accessor.count, size), place)?;
                elements.iter().map(&decode).collect()
            }
            None if accessor.count <= MAX_UNBACKED => vec![zero; accessor.count as usize],
            None => {
                let problem = format!("{} elements have no data; re-export", accessor.count);
                return Err(SceneError::gltf(place, problem));
            }
        };
        if let Some(sparse) = &accessor.sparse {
            self.replace_sparse(&mut values, sparse, size, &decode, place)?;
        }
        Ok(values)
    }

    fn replace_sparse<T>(
        &self,
        values: &mut [T],
        sparse: &Sparse,
        size: usize,
        decode: impl Fn(&[u8]) -> T,
        place: &str,
    ) -> Result<(), SceneError> {
        let component = Component::new(sparse.indices.component_type, place)?;
        check_index_type(component, place)?;
        let at = |part: &super::json::SparsePart| (part.buffer_view, part.byte_offset);
        let count = sparse.count;
        let indices = self.elements(at(&sparse.indices), (count, component.size()), place)?;
        let replacements = self.elements(at(&sparse.values), (count, size), place)?;
        let length = values.len();
        for (index, bytes) in indices.iter().zip(replacements.iter()) {
            let index = component.index(index).unwrap_or_default();
            let value = values.get_mut(index as usize).ok_or_else(|| {
                let problem = format!("sparse index {index} is outside its {length} elements");
                SceneError::gltf(place, problem + "; re-export")
            })?;
            *value = decode(bytes);
        }
        Ok(())
    }
}

fn check_index_type(component: Component, place: &str) -> Result<(), SceneError> {
    match component {
        Component::U8 | Component::U16 | Component::U32 => Ok(()),
        _ => Err(SceneError::gltf(
            place,
            "indices are not of an unsigned type; re-export",
        )),
    }
}

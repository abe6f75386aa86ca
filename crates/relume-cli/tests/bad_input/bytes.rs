//! Containers, made by hand so that each of their fields can be a lie.

use serde_json::{Value, json};

/// A `.glb` of a document and its binary chunk.
pub fn glb(json: &Value, bin: &[u8]) -> Vec<u8> {
    glb_of_text(json.to_string().as_bytes(), bin)
}

pub fn glb_of_text(json: &[u8], bin: &[u8]) -> Vec<u8> {
    let padded = |bytes: &[u8], with: u8| {
        let mut padded = bytes.to_vec();
        padded.resize(bytes.len().next_multiple_of(4), with);
        padded
    };
    let (json, bin) = (padded(json, b' '), padded(bin, 0));
    let mut out = b"glTF".to_vec();
    let word = |value: u32, out: &mut Vec<u8>| out.extend(value.to_le_bytes());
    word(2, &mut out);
    word((28 + json.len() + bin.len()) as u32, &mut out);
    word(json.len() as u32, &mut out);
    out.extend(b"JSON");
    out.extend(json);
    word(bin.len() as u32, &mut out);
    out.extend(b"BIN\0");
    out.extend(bin);
    out
}

/// The document and the binary chunk of a good `.glb`.
pub fn parts(glb: &[u8]) -> (Value, Vec<u8>) {
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let json = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    (json, glb[28 + length..].to_vec())
}

/// Numbers as a binary file holds them.
pub fn floats(values: &[f32]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

/// `bytes` with others written over them.
pub fn patched(bytes: &[u8], at: usize, new: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes[at..at + new.len()].copy_from_slice(new);
    bytes
}

/// One triangle: view and accessor 0 hold its positions, which begin the binary chunk.
pub fn triangle() -> (Value, Vec<u8>) {
    let json = json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"name": "tri", "primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36}]
    });
    (json, floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]))
}

/// Appends `data` as a view, and an accessor of so many elements on it; the accessor's index.
pub fn with_view(
    json: &mut Value,
    bin: &mut Vec<u8>,
    shape: &str,
    component: u32,
    count: usize,
    data: &[u8],
) -> usize {
    bin.resize(bin.len().next_multiple_of(4), 0);
    let views = json["bufferViews"].as_array_mut().unwrap();
    views.push(json!({"buffer": 0, "byteOffset": bin.len(), "byteLength": data.len()}));
    let view = views.len() - 1;
    bin.extend(data);
    json["buffers"][0]["byteLength"] = bin.len().into();
    let accessors = json["accessors"].as_array_mut().unwrap();
    accessors.push(
        json!({"bufferView": view, "componentType": component, "type": shape, "count": count}),
    );
    accessors.len() - 1
}

/// CRC-32 as PNG wants it.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            if crc & 1 == 1 {
                crc >> 1 ^ 0xedb8_8320
            } else {
                crc >> 1
            }
        })
    })
}

/// A PNG that claims this size, grey, and holds `data` as its compressed pixels.
pub fn png(width: u32, height: u32, data: &[u8]) -> Vec<u8> {
    let mut out = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut header = [width.to_be_bytes(), height.to_be_bytes()].concat();
    header.extend([8, 0, 0, 0, 0]);
    for (kind, data) in [
        (b"IHDR", header.as_slice()),
        (b"IDAT", data),
        (b"IEND", &[]),
    ] {
        out.extend((data.len() as u32).to_be_bytes());
        let chunk = [kind.as_slice(), data].concat();
        out.extend(&chunk);
        out.extend(crc(&chunk).to_be_bytes());
    }
    out
}

/// One grey pixel: a zlib stream that stores the row's filter and its value.
pub fn good_png() -> Vec<u8> {
    png(
        1,
        1,
        &[
            0x78, 0x01, 0x01, 2, 0, 0xfd, 0xff, 0, 0x80, 0, 0x82, 0, 0x81,
        ],
    )
}

/// A portable float map.
pub fn pfm(header: &str, values: &[f32]) -> Vec<u8> {
    [format!("PF\n{header}\n").into_bytes(), floats(values)].concat()
}

/// A DDS file with the newer header, of R32G32B32A32_FLOAT.
pub fn dds(side: u32, cube: bool, data: &[u8]) -> Vec<u8> {
    let mut words = [0_u32; 37];
    words[0] = u32::from_le_bytes(*b"DDS ");
    (words[1], words[2]) = (124, 0x1007);
    (words[3], words[4]) = (side, side);
    (words[19], words[20]) = (32, 4);
    words[21] = u32::from_le_bytes(*b"DX10");
    // Format, dimension, whether a cube, how many.
    words[32..36].copy_from_slice(&[2, 3, if cube { 4 } else { 0 }, 1]);
    let header: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    [&header, data].concat()
}

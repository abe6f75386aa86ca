//! Reading an array of numpy out of a file that may say anything.
//!
//! Headers are Python literals; those that numpy writes of plain arrays are all alike, and only such are taken: no nesting that a parser could
//! get lost in.

use std::io::{self, Read};

/// The longest header that is looked at; numpy's own are of 118 bytes and some.
const MOST_HEADER: usize = 1024;

/// What is wrong, as the end of a sentence about the array.
type Wrong = String;

/// Reads an array of float32 or float64 in C order, of [`MOST_VALUES`] at most: its shape and its values. Nothing may follow.
pub fn read(mut reader: impl Read) -> Result<(Vec<u64>, Vec<f32>), Wrong> {
    let text = header(&mut reader)?;
    let size = match between(&text, "'descr': '", "'") {
        Some("<f4") => 4,
        Some("<f8") => 8,
        Some(other) => {
            let other = super::printable(other);
            return Err(format!("is of {other}; save it as float32"));
        }
        None => return Err(unreadable()),
    };
    if between(&text, "'fortran_order': ", ",") != Some("False") {
        return Err("is in Fortran order; save numpy.ascontiguousarray of it".to_owned());
    }
    let shape = between(&text, "'shape': (", ")").and_then(sides);
    let shape = shape.ok_or_else(unreadable)?;
    let count = shape.iter().try_fold(1_u64, |n, &side| n.checked_mul(side));
    let count = count
        .filter(|&count| count <= MOST_VALUES)
        .ok_or_else(|| format!("is {shape:?}, more than {MOST_VALUES} values"))?;
    let values = values(&mut reader, count, size).map_err(|_| cut())?;
    // Reading on makes the archive compare its hash as well.
    match reader.read(&mut [0]) {
        Ok(0) => Ok((shape, values)),
        _ => Err("is damaged, or longer than its shape says".to_owned()),
    }
}

/// The most values of an array: 1 GiB of float32.
const MOST_VALUES: u64 = 1 << 28;

fn unreadable() -> Wrong {
    "has no header as numpy writes it; save it with numpy.savez".to_owned()
}

fn cut() -> Wrong {
    "ends before its shape does; it was cut off".to_owned()
}

/// The dictionary of a file of version 1 to 3.
fn header(reader: &mut impl Read) -> Result<String, Wrong> {
    let mut start = [0; 8];
    reader.read_exact(&mut start).map_err(|_| unreadable())?;
    let mut length = [0; 4];
    let digits = match start {
        [0x93, b'N', b'U', b'M', b'P', b'Y', 1, _] => 2,
        [0x93, b'N', b'U', b'M', b'P', b'Y', 2 | 3, _] => 4,
        _ => return Err(unreadable()),
    };
    let read = reader.read_exact(&mut length[..digits]);
    let length = u32::from_le_bytes(length) as usize;
    if read.is_err() || length > MOST_HEADER {
        return Err(unreadable());
    }
    let mut text = vec![0; length];
    reader.read_exact(&mut text).map_err(|_| unreadable())?;
    String::from_utf8(text).map_err(|_| unreadable())
}

fn between<'t>(text: &'t str, before: &str, after: &str) -> Option<&'t str> {
    let (_, rest) = text.split_once(before)?;
    Some(rest.split_once(after)?.0)
}

/// `3, 2, ` and the like.
fn sides(text: &str) -> Option<Vec<u64>> {
    let sides = text.split(',').map(str::trim);
    let sides = sides.filter(|side| !side.is_empty());
    sides.map(|side| side.parse().ok()).collect()
}

fn values(reader: &mut impl Read, count: u64, size: usize) -> io::Result<Vec<f32>> {
    // Room is taken for what is there, not for what the header says.
    let (mut values, mut left) = (Vec::new(), count);
    let mut bytes = vec![0; 1 << 16];
    while left > 0 {
        let here = left.min((bytes.len() / size) as u64);
        let bytes = &mut bytes[..here as usize * size];
        reader.read_exact(bytes)?;
        match size {
            4 => values.extend(bytes.as_chunks().0.iter().map(|&b| f32::from_le_bytes(b))),
            _ => {
                let doubles = bytes.as_chunks().0.iter().map(|&b| f64::from_le_bytes(b));
                values.extend(doubles.map(|value| value as f32));
            }
        }
        left -= here;
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array(header: &str, values: &[u8]) -> Vec<u8> {
        let length = (header.len() as u16).to_le_bytes();
        [
            &b"\x93NUMPY\x01\x00"[..],
            &length,
            header.as_bytes(),
            values,
        ]
        .concat()
    }

    fn plain(shape: &str) -> String {
        format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}\n")
    }

    #[test]
    fn arrays_as_numpy_writes_them_are_read() {
        let four = 1.5_f32.to_le_bytes().repeat(6);
        let (shape, values) = read(&array(&plain("(2, 3)"), &four)[..]).unwrap();
        assert_eq!((shape, values), (vec![2, 3], vec![1.5; 6]));
        let header = plain("(2,)").replace("<f4", "<f8");
        let eight = 2.5_f64.to_le_bytes().repeat(2);
        assert_eq!(
            read(&array(&header, &eight)[..]).unwrap(),
            (vec![2], vec![2.5; 2])
        );
        assert_eq!(read(&array(&plain("()"), &four[..4])[..]).unwrap().1, [1.5]);
        let two = array(&plain("(1,)"), &four[..4]);
        let two = [&two[..6], &[2, 0], &two[8..10], &[0, 0], &two[10..]].concat();
        assert_eq!(read(&two[..]).unwrap().1, [1.5]);
    }

    #[test]
    fn headers_are_not_believed() {
        let said = |bytes: &[u8]| read(bytes).unwrap_err();
        let four = [0; 4];
        for shape in [
            "(4294967296, 4294967296, 4)",
            "(18446744073709551615, 2)",
            "(99999999999,)",
        ] {
            assert!(
                said(&array(&plain(shape), &four)).contains("more than"),
                "{shape}"
            );
        }
        for shape in [
            "(-1,)",
            "(1.5,)",
            "(99999999999999999999999,)",
            "((1,),)",
            "[1]",
        ] {
            assert!(
                said(&array(&plain(shape), &four)).contains("no header"),
                "{shape}"
            );
        }
        for nested in ["[", "(", "{"] {
            assert!(said(&array(&nested.repeat(60_000), &four)).contains("no header"));
            assert!(said(&array(&nested.repeat(900), &four)).contains("no header"));
        }
        let huge = [&b"\x93NUMPY\x02\x00"[..], &[0xff; 4], &four].concat();
        assert!(said(&huge).contains("no header"));
        assert!(said(b"\x93NUMPY\x01").contains("no header"));
        assert!(said(b"PK and more of it").contains("no header"));
        assert!(said(&array(&plain("(2,)"), &four)).contains("cut off"));
        assert!(said(&array(&plain("(0,)"), &four)).contains("longer than its shape"));
        let other = plain("(1,)").replace("<f4", ">f4\u{1b}[2J");
        let told = said(&array(&other, &four));
        assert!(
            told.contains("save it as float32") && !told.contains('\u{1b}'),
            "{told}"
        );
        let fortran = plain("(1,)").replace("False", "True");
        assert!(said(&array(&fortran, &four)).contains("Fortran"));
    }
}

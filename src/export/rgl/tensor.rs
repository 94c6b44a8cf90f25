//! The container of the RGL: named arrays, little-endian (mitsuba3, `src/core/tensor.cpp`).

/// With what a file begins: magic and version 1.0.
const HEAD: &[u8] = b"tensor_file\0\x01\x00";
/// Codes of the types that are written.
const U8: u8 = 1;
const F32: u8 = 10;
/// Arrays start at multiples of this.
const ALIGNMENT: usize = 8;

/// A named array, the last index running fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Its name.
    pub name: &'static str,
    /// Lengths of its indices.
    pub shape: Vec<usize>,
    /// Its numbers.
    pub data: Data,
}

/// Numbers of a field.
#[derive(Clone, Debug, PartialEq)]
pub enum Data {
    /// Bytes.
    Bytes(Vec<u8>),
    /// 32-bit floats.
    Floats(Vec<f32>),
}

impl Field {
    /// An array of floats.
    pub fn floats(name: &'static str, shape: &[usize], data: Vec<f32>) -> Field {
        Field { name, shape: shape.to_vec(), data: Data::Floats(data) }
    }

    /// A list of bytes.
    pub fn bytes(name: &'static str, data: Vec<u8>) -> Field {
        Field { name, shape: vec![data.len()], data: Data::Bytes(data) }
    }
}

/// The bytes of a file.
pub fn write(fields: &[Field]) -> Vec<u8> {
    let header: usize = fields.iter().map(|field| 2 + field.name.len() + 2 + 1 + 8 + 8 * field.shape.len()).sum();
    let mut offset = (HEAD.len() + 4 + header).next_multiple_of(ALIGNMENT);
    let mut bytes = HEAD.to_vec();
    bytes.extend((fields.len() as u32).to_le_bytes());
    for Field { name, shape, data } in fields {
        let (code, length) = match data {
            Data::Bytes(data) => (U8, data.len()),
            Data::Floats(data) => (F32, 4 * data.len()),
        };
        bytes.extend((name.len() as u16).to_le_bytes());
        bytes.extend(name.bytes());
        bytes.extend((shape.len() as u16).to_le_bytes());
        bytes.push(code);
        bytes.extend((offset as u64).to_le_bytes());
        shape.iter().for_each(|length| bytes.extend((*length as u64).to_le_bytes()));
        offset = (offset + length).next_multiple_of(ALIGNMENT);
    }
    for Field { data, .. } in fields {
        bytes.resize(bytes.len().next_multiple_of(ALIGNMENT), 0);
        match data {
            Data::Bytes(data) => bytes.extend(data),
            Data::Floats(data) => data.iter().for_each(|value| bytes.extend(value.to_le_bytes())),
        }
    }
    bytes
}

/// The shape and the floats of a field of a file; none when it is not there, or no file of this kind.
pub fn floats(bytes: &[u8], wanted: &str) -> Option<(Vec<usize>, Vec<f32>)> {
    let mut rest = bytes.strip_prefix(HEAD)?;
    let mut take = |length: usize| -> Option<&[u8]> {
        let (front, back) = rest.split_at_checked(length)?;
        rest = back;
        Some(front)
    };
    let number = |bytes: &[u8]| bytes.iter().rev().fold(0, |number, byte| number << 8 | usize::from(*byte));
    for _ in 0..number(take(4)?) {
        let length = number(take(2)?);
        let name = take(length)?.to_vec();
        let dimensions = number(take(2)?);
        let code = take(1)?[0];
        let offset = number(take(8)?);
        let shape: Vec<usize> = (0..dimensions).map(|_| take(8).map(number)).collect::<Option<_>>()?;
        if name == wanted.as_bytes() && code == F32 {
            let data = bytes.get(offset..)?.get(..4 * shape.iter().product::<usize>())?;
            let floats = data.chunks_exact(4).map(|word| f32::from_le_bytes([word[0], word[1], word[2], word[3]]));
            return Some((shape, floats.collect()));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_lies_where_it_says() {
        let fields = [
            Field::bytes("description", b"odd".to_vec()),
            Field::floats("a", &[2, 3], (0..6).map(|i| i as f32).collect()),
            Field::floats("bc", &[1], vec![-1.5]),
        ];
        let bytes = write(&fields);
        assert_eq!(&bytes[..18], b"tensor_file\0\x01\x00\x03\x00\x00\x00");
        assert_eq!(floats(&bytes, "a"), Some((vec![2, 3], vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0])));
        assert_eq!(floats(&bytes, "bc"), Some((vec![1], vec![-1.5])));
        assert_eq!(floats(&bytes, "c"), None);
        assert_eq!(floats(&bytes[..bytes.len() - 1], "bc"), None);
        assert_eq!(floats(b"", "a"), None);
    }
}

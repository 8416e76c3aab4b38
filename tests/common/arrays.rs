//! Arrays in archives for `NumPy`.

/// The shape and the numbers of an array of 8-byte numbers in an archive without compression.
#[allow(clippy::unwrap_used, reason = "a failing test should panic")]
pub fn array_of(archive: &[u8], name: &str) -> (Vec<usize>, Vec<[u8; 8]>) {
    let name = format!("{name}.npy");
    let named = archive.windows(name.len()).position(|bytes| bytes == name.as_bytes()).unwrap();
    let magic = b"\x93NUMPY\x01\x00";
    let begin = named + archive[named..].windows(8).position(|bytes| bytes == magic).unwrap();
    let length = usize::from(u16::from_le_bytes([archive[begin + 8], archive[begin + 9]]));
    assert_eq!((10 + length) % 64, 0);
    let head = std::str::from_utf8(&archive[begin + 10..begin + 10 + length]).unwrap();
    let (_, shape) = head.split_once("'shape': (").unwrap();
    let shape: Vec<usize> =
        shape.split(')').next().unwrap().split(',').filter_map(|count| count.trim().parse().ok()).collect();
    let numbers = archive[begin + 10 + length..].as_chunks().0[..shape.iter().product()].to_vec();
    (shape, numbers)
}

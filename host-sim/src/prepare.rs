//! A checked job as bytes: what a sender sends, without the file that it came from.

use shared::piece::{Header, Piece};

use crate::path::Path;

/// The header and the pieces of a path in postcard's form: a [`Header<f32>`] and a `Vec<Piece<f32>>`.
pub fn prepare(path: &Path) -> postcard::Result<Vec<u8>> {
    let pieces: Vec<Piece<f32>> = path.wire().collect();
    postcard::to_stdvec(&(path.header, pieces))
}

/// Reads what [`prepare`] wrote.
pub fn read(bytes: &[u8]) -> postcard::Result<(Header<f32>, Vec<Piece<f32>>)> {
    postcard::from_bytes(bytes)
}

/// The factorisation of a block matrix.
#[derive(Debug, Default)]
pub struct Factor {}

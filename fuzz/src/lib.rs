//! What the fuzz targets do with an input. `adapters/tests/corpus.rs` includes this file and does the same with every file
//! of the corpus, so that it uses no more than `fsct_adapters`.

mod decoder;
mod input;
mod session;

pub use decoder::frame_decoder;
pub use session::session;

//! FSP records: authenticity, protocol and verify record with their signatures (Annex A).

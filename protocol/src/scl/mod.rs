//! The state machines of the safety communication layer as rows of data (11.5.2, 11.5.3).

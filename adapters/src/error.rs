//! What can go wrong between harness and DUT, told apart by whose fault it is.

use std::time::Duration;

/// Who has to look for the cause.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The DUT was reached and broke the contract.
    Dut,
    /// The DUT could not be reached, or not any more: cable, port, path, permission.
    Rig,
}

/// Why a DUT gave no usable answer. The connection is of no further use afterwards.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DutError {
    /// No connection.
    #[error("{url} cannot be reached: {why}; is the DUT running and the address right?")]
    Unreachable {
        /// Where.
        url: String,
        /// What the system said.
        why: String,
    },
    /// The DUT ended the connection, or its process ended.
    #[error("the DUT closed the connection{how}")]
    Closed {
        /// How, with a leading space: " (exit status 3)", or nothing.
        how: String,
    },
    /// No complete answer in time.
    #[error("the DUT gave no complete answer within {after:?}")]
    Timeout {
        /// The limit.
        after: Duration,
    },
    /// Octets that are no frame, or a frame that is no message.
    #[error("the DUT answered octets that are no message: {what}")]
    Garbage {
        /// What was wrong, with position where known.
        what: String,
    },
    /// The line between lost the answer, or itself.
    ///
    /// On a line that can lose and change octets, octets that are no message are no evidence against a DUT: a bad cable
    /// makes the same of a right answer. Nor is a port that goes away. What only a DUT can have made, a whole frame
    /// with the right CRC, is judged as everywhere. Silence stays [`DutError::Timeout`], which blames nobody: a request
    /// lost and a DUT that hangs look alike.
    #[error("the serial line failed: {what}; are cable and baud rate right?")]
    Line {
        /// What was seen of it.
        what: String,
    },
    /// Another version of the frame protocol.
    #[error("the DUT speaks version {theirs} of the frame protocol, this fsct speaks {ours}")]
    Version {
        /// Version of the DUT.
        theirs: u8,
        /// Version of this program.
        ours: u8,
    },
    /// More observations than the stimuli can have caused.
    #[error("the DUT answered more than {limit} observations to one batch")]
    Flood {
        /// The limit.
        limit: usize,
    },
    /// Answers that break the contract: a missing image, an observation out of order.
    #[error("the DUT broke the contract: {what}")]
    Contract {
        /// What was wrong.
        what: String,
    },
}

impl DutError {
    /// Who has to look for the cause.
    pub fn fault(&self) -> Fault {
        match self {
            DutError::Unreachable { .. } | DutError::Line { .. } => Fault::Rig,
            _ => Fault::Dut,
        }
    }
}

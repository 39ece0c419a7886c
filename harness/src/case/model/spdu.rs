//! The SPDU a case sends, and what becomes of it on the way.

use super::Expectation;

/// The SPDU of an exchange and how often it goes out.
#[derive(Clone, Debug)]
pub struct Exchange {
    /// MCount or DCount_i.
    pub count: Count,
    /// The bits of the control or status octet below the counter, reserved ones included.
    pub bits: u8,
    /// FS-PDout or FS-PDin.
    pub pd: Data,
    /// PortNum.
    pub port_num: PortNum,
    /// How the signature comes about.
    pub signature: Signature,
    /// Bits falsified after the signature has been made.
    pub corrupt: Corrupt,
    /// What takes the place of the SPDU.
    pub image: Image,
    /// How many SCL cycles.
    pub times: u32,
    /// SCL cycles go on until all of these hold.
    pub until: Vec<Expectation>,
    /// The most SCL cycles for `until`.
    pub within: u32,
    /// Octets without safety relevance behind the SPDU.
    pub nsr: Vec<u8>,
    /// Exactly this many link exchanges with the same octets, whatever the DUT answers.
    pub repeat: Option<u32>,
}

/// Which counter an SPDU carries.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Count {
    /// To an FS-Device the one after the SPDU sent last, 0 when none was sent; to an FS-Master the mirror of the MCount
    /// that stands.
    Next,
    /// That of the SPDU sent last.
    Same,
    /// As `Next`, counted on by this many more.
    Jump(u8),
    /// As `Next`, with this bit of the three inverted, 0 the least significant; the signature is made over it.
    Bit(u8),
    /// This one.
    Exactly(u8),
}

/// Process data.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Data {
    /// New octets other than 0 from the seed of the case.
    Pattern,
    /// All 0.
    Safe,
    /// Those sent last.
    Same,
    /// Octets for which the computed signature is 0.
    ZeroSignature,
    /// These octets, filled up with 0 in front.
    Exactly(Vec<u8>),
    /// A service of one bit.
    Bit(bool),
    /// What the profile says (FSCP_Authenticity).
    Profile,
}

/// The PortNum octet of an SPDU.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum PortNum {
    /// The right one: FSP_Port, inverted in an answer.
    Own,
    /// Its inverse.
    Inverted,
    /// Another port of the same FS-Master.
    Foreign,
    /// This octet.
    Exactly(u8),
}

/// How a signature comes about.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Signature {
    /// As the standard says.
    Good,
    /// All octets 0.
    Zero,
    /// Every bit inverted.
    Inverted,
    /// Start value 0.
    StartZero,
    /// Octets in reverse order.
    Reversed,
    /// Control or status octet before PortNum.
    Order,
}

/// Bits falsified on the way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Corrupt {
    /// None.
    Nothing,
    /// These bits; 0 is the most significant bit of the first octet.
    Bits(Vec<usize>),
    /// One bit of a field, chosen by the seed.
    Field(Field),
}

/// A field of an SPDU.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Field {
    /// FS process data; the signature where there are none.
    Data,
    /// PortNum.
    PortNum,
    /// The bits of the control or status octet beside the counter and the reserved ones.
    Control,
    /// Signature.
    Signature,
}

/// What the DUT receives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Image {
    /// The SPDU.
    Spdu,
    /// All octets 0.
    Zero,
    /// Nothing.
    Lost,
    /// The DUT's own answer (loop-back).
    Echo,
    /// Standard process data from the seed.
    Standard,
    /// The SPDU that was sent this many SPDUs before the last one, octet for octet.
    Ago(usize),
    /// These octets.
    Exactly(Vec<u8>),
}

/// What a partner receives in place of the SPDU the DUT has made for it.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Back {
    /// It, with one bit of the signature falsified.
    Corrupt,
    /// It, with a counter two further and a signature over it.
    Counter,
    /// It, with the PortNum of another port of the same FS-Master and a signature over it.
    Foreign,
    /// Standard process data whose octet in the place of the counter reads as the one awaited.
    Standard,
    /// What the partner sends itself (loop-back).
    Echo,
    /// Nothing.
    Lost,
    /// Nothing, and it afterwards.
    Late,
    /// The image the DUT presented this many images before it.
    Ago(usize),
}

/// Images and SPDUs that are kept for `N ago`.
pub const KEPT: usize = 8;

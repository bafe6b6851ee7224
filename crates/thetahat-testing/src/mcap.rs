//! Bags in MCAP as a recorder writes them, without chunks: <https://mcap.dev/spec>

const MAGIC: [u8; 8] = [0x89, b'M', b'C', b'A', b'P', b'0', b'\r', b'\n'];
const HEADER: u8 = 1;
const FOOTER: u8 = 2;
const SCHEMA: u8 = 3;
const CHANNEL: u8 = 4;
const MESSAGE: u8 = 5;
const DATA_END: u8 = 15;

/// A message in little-endian CDR.
pub struct Cdr {
    bytes: Vec<u8>,
}

impl Default for Cdr {
    fn default() -> Self {
        Self { bytes: vec![0, 1, 0, 0] }
    }
}

impl Cdr {
    fn aligned(mut self, size: usize) -> Self {
        self.bytes.resize(4 + (self.bytes.len() - 4).next_multiple_of(size), 0);
        self
    }

    /// An unsigned number of 8 bits.
    #[must_use]
    pub fn u8(mut self, value: u8) -> Self {
        self.bytes.push(value);
        self
    }

    /// An unsigned number of 32 bits, such as the length of a sequence.
    #[must_use]
    pub fn u32(self, value: u32) -> Self {
        let mut aligned = self.aligned(4);
        aligned.bytes.extend(value.to_le_bytes());
        aligned
    }

    /// A number of 32 bits.
    #[must_use]
    pub fn f32(self, value: f32) -> Self {
        self.u32(value.to_bits())
    }

    /// Numbers of 64 bits, of an array of fixed length.
    #[must_use]
    pub fn f64s(self, values: &[f64]) -> Self {
        values.iter().fold(self, |message, value| {
            let mut aligned = message.aligned(8);
            aligned.bytes.extend(value.to_le_bytes());
            aligned
        })
    }

    /// A text.
    #[must_use]
    pub fn text(self, text: &str) -> Self {
        let mut message = self.u32(text.len() as u32 + 1);
        message.bytes.extend(text.bytes().chain([0]));
        message
    }

    /// A `sensor_msgs/msg/JointState` at so many nanoseconds.
    #[must_use]
    pub fn joint_state(self, time_ns: u64, joints: &[&str], fields: [&[f64]; 3]) -> Self {
        let stamped = self.u32((time_ns / 1_000_000_000) as u32).u32((time_ns % 1_000_000_000) as u32).text("");
        let named = joints.iter().fold(stamped.u32(joints.len() as u32), |message, joint| message.text(joint));
        fields.iter().fold(named, |message, field| message.u32(field.len() as u32).f64s(field))
    }

    /// Its bytes.
    #[must_use]
    pub fn bytes(self) -> Vec<u8> {
        self.bytes
    }
}

/// A bag with one topic: the type of its messages and the definition of this type, and the messages with the recorder's times.
#[must_use]
pub fn mcap(topic: &str, kind: &str, definition: &str, messages: &[(u64, Vec<u8>)]) -> Vec<u8> {
    let schema = [&1_u16.to_le_bytes()[..], &text(kind), &text("ros2msg"), &text(definition)].concat();
    let channel = [&[1, 0, 1, 0][..], &text(topic), &text("cdr"), &[0; 4]].concat();
    let message = |(number, (time_ns, data)): (usize, &(u64, Vec<u8>))| {
        let time = time_ns.to_le_bytes();
        record(MESSAGE, &[&[1, 0][..], &(number as u32).to_le_bytes(), &time, &time, data].concat())
    };
    let messages: Vec<u8> = messages.iter().enumerate().flat_map(message).collect();
    let head = record(HEADER, &[text("ros2"), text("")].concat());
    [
        &MAGIC[..],
        &head,
        &record(SCHEMA, &schema),
        &record(CHANNEL, &channel),
        &messages,
        &record(DATA_END, &[0; 4]),
        &record(FOOTER, &[0; 20]),
        &MAGIC,
    ]
    .concat()
}

fn record(kind: u8, content: &[u8]) -> Vec<u8> {
    [&[kind][..], &(content.len() as u64).to_le_bytes(), content].concat()
}

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}

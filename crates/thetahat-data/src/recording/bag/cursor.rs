//! Numbers, times and texts from the bytes of a message.
//!
//! The common data representation (CDR) of DDS begins with four bytes that state the order of bytes; after them each number is aligned to
//! its size. ROS 1 writes little endian without alignment. In both a text is its length, then its bytes, in CDR with a final zero.
//! Sources: OMG DDSI-RTPS 2.2, section 10.2; wiki.ros.org, ROS/Technical Overview.

use super::schema::{Encoding, Number};

pub(super) struct Cursor<'a> {
    /// The bytes after the first four of CDR, or all.
    body: &'a [u8],
    at: usize,
    little: bool,
    encoding: Encoding,
}

impl<'a> Cursor<'a> {
    pub(super) fn of(message: &'a [u8], encoding: Encoding) -> Result<Self, String> {
        match (encoding, message.split_first_chunk()) {
            (Encoding::Ros1, _) => Ok(Self { body: message, at: 0, little: true, encoding }),
            (Encoding::Cdr, Some(([0, order @ (0 | 1), _, _], body))) => {
                Ok(Self { body, at: 0, little: *order == 1, encoding })
            }
            (Encoding::Cdr, Some((found, _))) => {
                Err(format!("expected plain CDR, which begins with 0 0 or 0 1, found {found:?}"))
            }
            (Encoding::Cdr, None) => Err("it has fewer than four bytes".to_owned()),
        }
    }

    /// Number of bytes that follow.
    pub(super) fn left(&self) -> usize {
        self.body.len().saturating_sub(self.at)
    }

    pub(super) fn number(&mut self, number: Number) -> Option<f64> {
        Some(match number {
            Number::I8 => f64::from(i8::from_le_bytes(self.bytes()?)),
            Number::U8 => f64::from(u8::from_le_bytes(self.bytes()?)),
            Number::I16 => f64::from(i16::from_le_bytes(self.bytes()?)),
            Number::U16 => f64::from(u16::from_le_bytes(self.bytes()?)),
            Number::I32 => f64::from(i32::from_le_bytes(self.bytes()?)),
            Number::U32 => f64::from(u32::from_le_bytes(self.bytes()?)),
            Number::I64 => i64::from_le_bytes(self.bytes()?) as f64,
            Number::U64 => u64::from_le_bytes(self.bytes()?) as f64,
            Number::F32 => f64::from(f32::from_le_bytes(self.bytes()?)),
            Number::F64 => f64::from_le_bytes(self.bytes()?),
        })
    }

    /// Passes over numbers that are not read.
    pub(super) fn skip(&mut self, number: Number, count: usize) -> Option<()> {
        if count == 0 {
            return Some(());
        }
        let end = self.start(number.size()).checked_add(count.checked_mul(number.size())?)?;
        self.body.get(..end)?;
        self.at = end;
        Some(())
    }

    pub(super) fn length(&mut self) -> Option<usize> {
        usize::try_from(u32::from_le_bytes(self.bytes()?)).ok()
    }

    /// A time in nanoseconds. ROS 1 counts its seconds without a sign.
    pub(super) fn time_ns(&mut self) -> Option<i64> {
        let seconds: [u8; 4] = self.bytes()?;
        let seconds = match self.encoding {
            Encoding::Cdr => i64::from(i32::from_le_bytes(seconds)),
            Encoding::Ros1 => i64::from(u32::from_le_bytes(seconds)),
        };
        let nanoseconds = u32::from_le_bytes(self.bytes()?);
        Some(seconds * 1_000_000_000 + i64::from(nanoseconds))
    }

    /// A duration in seconds. ROS 1 gives its nanoseconds a sign.
    pub(super) fn duration(&mut self) -> Option<f64> {
        let seconds = i32::from_le_bytes(self.bytes()?);
        let nanoseconds: [u8; 4] = self.bytes()?;
        let nanoseconds = match self.encoding {
            Encoding::Cdr => f64::from(u32::from_le_bytes(nanoseconds)),
            Encoding::Ros1 => f64::from(i32::from_le_bytes(nanoseconds)),
        };
        Some(f64::from(seconds) + nanoseconds * 1e-9)
    }

    /// The bytes of a text without the final zero.
    pub(super) fn text(&mut self) -> Option<&'a [u8]> {
        let length = self.length()?;
        let bytes = self.body.get(self.at..)?.get(..length)?;
        self.at += length;
        Some(bytes.strip_suffix(&[0]).unwrap_or(bytes))
    }

    /// Where a number of this size starts.
    fn start(&self, size: usize) -> usize {
        match self.encoding {
            Encoding::Cdr => self.at.next_multiple_of(size),
            Encoding::Ros1 => self.at,
        }
    }

    /// The bytes of a number, aligned to its size, in little-endian order.
    fn bytes<const N: usize>(&mut self) -> Option<[u8; N]> {
        let start = self.start(N);
        let mut bytes = *self.body.get(start..)?.first_chunk()?;
        self.at = start + N;
        if !self.little {
            bytes.reverse();
        }
        Some(bytes)
    }
}
